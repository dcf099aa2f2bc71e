//! The audit of a step: its order, and what ends it early.

use crate::findings::{of_bits, of_report};
use crate::held_action::HeldAction;
use crate::memory_finding::{of_measured, of_memory};
use crate::operating_point_finding::of_operating_point;
use crate::prober::Prober;
use crate::{Bits, BlackBox, BlackBoxError, Finding, Memory, ProbeReport, Settling, Subject};

/// Rounding of results relative to them from which differences allow for it.
const ALLOWED_FOR: f64 = 1e-11;

/// Audits the step of a simulator.
///
/// # Errors
/// The simulator fails or returns numbers that are not finite.
pub fn probe(
    black_box: &mut dyn BlackBox,
    subject: &Subject,
) -> Result<ProbeReport, BlackBoxError> {
    let mut prober = Prober::new(black_box, subject);
    // Fails early where the simulator does.
    prober.step_one(&subject.state, &subject.action, subject.dt)?;
    let memory = Memory::measure(&mut prober)?;
    let calls = prober.calls;
    let filters_commands =
        |settling: &Settling| settling.is_of_commands == Some(true) && settling.is_settled;
    if memory.settling.as_ref().is_some_and(filters_commands) {
        let held = subject.with_held_action();
        let mut black_box = HeldAction { black_box, action: &subject.action };
        let mut report = examine(&mut Prober::new(&mut black_box, &held), memory, true)?;
        report.calls += calls;
        return Ok(report);
    }
    examine(&mut prober, memory, false)
}

/// The audit of a black box whose memory is known. `is_held`: with commands that are held, so that nothing else is remembered.
fn examine(
    prober: &mut Prober<'_>,
    memory: Memory,
    is_held: bool,
) -> Result<ProbeReport, BlackBoxError> {
    let subject = prober.subject;
    // A delay that grows later, by a step or two, is flushed as well.
    let calls = if is_held { 0 } else { memory.calls.unwrap_or(memory.tried) };
    prober.memory = if calls == 0 { 0 } else { calls + 2 };
    prober.has_state_memory = memory.state.last.unwrap_or(0) > 0;
    let mut findings: Vec<Finding> = Vec::new();
    let bits = Bits::check(prober)?;
    let rounding = bits.rounding.as_ref().map_or(0.0, |rounding| rounding.results);
    prober.coarseness = if rounding > ALLOWED_FOR { rounding } else { 0.0 };
    // What is remembered explains differences of bits.
    if memory.settling.is_none() || is_held {
        of_bits(&bits, &mut findings);
    }
    let mut report = ProbeReport::empty(subject, bits);
    let is_repeatable = report.bits.randomness.is_none() && subject.stray_results.is_none();
    let is_audited = is_repeatable && (is_held || memory.calls.is_some());
    if is_audited {
        report.audit(prober, &memory)?;
    }
    of_measured(subject, &report.delays, &mut findings);
    if is_repeatable || memory.settling.is_some() {
        of_memory(&memory, &report.delays, subject, &mut findings);
    }
    if is_audited {
        of_report(&report, subject, &mut findings);
    }
    report.memory = Some(memory);
    // Before all others: they are about this state.
    let of_point =
        report.operating_point.as_ref().and_then(|p| of_operating_point(p, &report.modes));
    if let Some(finding) = of_point {
        findings.insert(0, finding);
    }
    let longest_dt = report.largest_dt.as_ref().and_then(|limit| limit.dt);
    for finding in &mut findings {
        finding.help = finding.kind.help(subject.dt, longest_dt);
    }
    report.findings = findings;
    report.calls = prober.calls;
    report.verdict = report.judge(subject);
    report.answer = report.summary();
    Ok(report)
}
