//! Orders of splitting methods from order conditions, and a method whose order differs on the oscillator.

use libration::analysis::OrderCertificate;
use libration::integrator::Splitting;
use libration::number::TwoFloat;
use libration::simulation::Simulator;
use libration::system::{Oscillator, Pendulum};
use libration::{Elementary, Float, Integrator, Model, Scalar, State};
use libration_report::Record;
use libration_report::record::{Finding, Table, Tolerance};
use libration_study::{Fit, Lab, StudyError};

/// Letters up to which words are compared with the flow.
const LETTERS: usize = 6;

/// Of order 4 on every oscillator, of order 3 elsewhere.
///
/// On an oscillator a word with a repeated letter vanishes, since `K² = D² = 0`. The weights solve
/// the conditions of up to four letters on all words but KKKD and KDDD.
fn lookalike() -> Splitting<4> {
    let r = 105.0_f64.sqrt();
    Splitting {
        kicks: [0.5, -0.25, (3.0 + r) / 24.0, (15.0 - r) / 24.0],
        drifts: [(9.0 - r) / 12.0, (r - 3.0) / 12.0, 0.5, 0.0],
    }
}

/// Certifies the configured splitting methods and tries the lookalike.
pub(super) fn certify(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let columns = ["splitting method", "order by its word", "first residual", "letters"];
    let mut table = Table::new("words", &columns);
    let mut row = |title: &str, certificate: &OrderCertificate| {
        let order = certificate.order();
        let first = certificate.residuals.get(order).map_or(0.0, |r| r.to_f64());
        let cells = [title.into(), (order as u64).into(), first.into(), (order as u64 + 1).into()];
        table.push(cells);
    };
    for &method in &lab.config.integrators {
        let Some(certificate) = OrderCertificate::new(method, LETTERS) else {
            continue;
        };
        row(method.title(), &certificate);
        record.find(Finding::predicted(
            format!("convergence.{}.word-order", method.name()),
            format!("{}: order of its word of kicks and drifts, on every system", method.title()),
            "1",
            f64::from(method.order()),
            certificate.order() as f64,
            Tolerance::exact("coefficients agree to the rounding of the weights, or do not"),
        ));
    }
    if let Some(certificate) = OrderCertificate::new(lookalike(), LETTERS) {
        row("lookalike", &certificate);
        let start = State { q: [1.0], v: [0.5] };
        let promised = certificate.order() as f64;
        for (name, title, order, errors) in [
            ("oscillator", "an oscillator", 4.0, errors(Oscillator { omega2: 1.0 }, start)?),
            ("pendulum", "a pendulum", promised, errors(Pendulum { omega2: 1.0 }, start)?),
        ] {
            let Some(fit) = Fit::new(&errors.0, &errors.1) else { continue };
            record.find(Finding::predicted(
                format!("convergence.lookalike.{name}"),
                format!("a splitting method of order 4 on oscillators alone: its order on {title}"),
                "1",
                order,
                fit.exponent,
                fit.tolerance(),
            ));
        }
    }
    record.tables.push(table);
    Ok(())
}

/// Time steps, and what each changes when it is halved: the error, up to a factor that is the same
/// for all.
fn errors(model: impl Model<1>, start: State<f64, 1>) -> Result<(Vec<f64>, Vec<f64>), StudyError> {
    const TIME: f64 = 2.0;
    let end = |steps: u64| -> Result<State<TwoFloat, 1>, StudyError> {
        let (system, start) = (model.on::<TwoFloat>(), start.map(TwoFloat::from_f64));
        run(system, lookalike(), start, TIME / steps as f64, steps)
    };
    let mut errors = (Vec::new(), Vec::new());
    for steps in [32, 64, 128, 256, 512, 1024] {
        let (coarse, fine) = (end(steps)?, end(2 * steps)?);
        let (dq, dv) = (coarse.q[0] - fine.q[0], coarse.v[0] - fine.v[0]);
        errors.0.push(TIME / steps as f64);
        errors.1.push((dq * dq + dv * dv).sqrt().to_f64());
    }
    Ok(errors)
}

fn run<S: Float>(
    system: impl libration::System<S, 1> + Copy,
    integrator: impl Integrator,
    start: State<S, 1>,
    dt: f64,
    steps: u64,
) -> Result<State<S, 1>, StudyError> {
    let mut simulator = Simulator::new(system, integrator, start, S::from_f64(dt))?;
    simulator.run(steps, &mut ())?;
    Ok(simulator.sample().state)
}
