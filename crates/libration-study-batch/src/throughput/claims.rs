//! Claims of chapters 5 and 8 and of section 9.4.

use libration_report::notation::number;
use libration_report::record::{Judgement, Record, Ruling};

use super::comparison::gain_id;
use crate::bench::BenchFloat::{F32, F64};
use crate::bench::Implementation::{Fused, InPlace, OneStep, Scalar, Temporaries};
use crate::source_rollouts::SATURATED;

/// A billion.
const BILLION: f64 = 1e9;

/// Least factor for "several times as fast".
const SEVERAL: f64 = 2.0;

/// Least factor for a substantial increase.
const SUBSTANTIAL: f64 = 1.2;

/// Judges them from the findings of the record.
pub(super) fn judge(record: &mut Record) {
    rates(record);
    limits(record);
    bandwidth(record);
}

fn show(x: f64) -> String {
    number(x, 3)
}

/// Judges claims about rates.
fn rates(record: &mut Record) {
    let text = "Array operations update more than a billion particles a second.";
    let ids = ["throughput.best.in-place", "throughput.best.fused"];
    record.judge(Ruling { id: "C01", source: "Abstract, 9.4", text, findings: &ids }, |f| {
        let (passes, fused) = (f[0].measured, f[1].measured);
        let because = format!(
            "array operations like those of NumPy reach {}·10⁹ steps per second here if the arrays \
             fit in a cache. Fused steps reach {}·10⁹ on the same core",
            show(passes / BILLION),
            show(fused / BILLION)
        );
        match passes > BILLION {
            true => Judgement::conditional(because).only("the arrays fit in a cache"),
            false => Judgement::refuted(because),
        }
    });
    let text = "For small numbers of particles the throughput is constant.";
    let ids = ["throughput.growth.in-place.few", "throughput.growth.scalar.few"];
    record.judge(Ruling { id: "C37", source: "5.2", text, findings: &ids }, |f| {
        let (passes, lone) = (f[0].measured, f[1].measured);
        let because = format!(
            "from 1 to 100 trajectories the total rate of steps, the throughput of §5.1, grows \
             with the power {} of the number of trajectories for array operations, and with the \
             power {} for the scalar loop. If the power is near one, the rate of passes is \
             constant",
            show(passes),
            show(lone)
        );
        match passes > 0.5 {
            true => Judgement::conditional(because).only("the rate of passes is meant"),
            false => Judgement::confirmed(because),
        }
    });
    let ids = [gain_id(InPlace, Scalar, F32, 1.0), gain_id(InPlace, Scalar, F32, 1e5)];
    let ids = ids.each_ref().map(String::as_str);
    let text = "Operations on arrays improve throughput dramatically.";
    record.judge(Ruling { id: "C39", source: "5.3, 5.9", text, findings: &ids }, |f| {
        let (one, many) = (f[0].measured, f[1].measured);
        let because = format!(
            "array operations are {} times as fast as a compiled loop for 10⁵ trajectories and {} \
             times for one. Relative to an interpreted loop the first factor is larger, and the \
             second smaller",
            show(many),
            show(one)
        );
        match (many > SEVERAL, one < 1.0) {
            (true, true) => Judgement::conditional(because).only("there are many trajectories"),
            (true, false) => Judgement::confirmed(because),
            _ => Judgement::refuted(because),
        }
    });
    let many = [1e3, 1e5, 1e6];
    let ids = many.map(|count| gain_id(InPlace, Temporaries, F64, count));
    let ids = ids.each_ref().map(String::as_str);
    let text = "Updates in place raise throughput substantially.";
    record.judge(Ruling { id: "C40", source: "5.4", text, findings: &ids }, |f| {
        let gains = f.iter().map(|f| show(f.measured)).collect::<Vec<_>>().join(", ");
        let because = format!(
            "speed with results in existing arrays, relative to a new array per result (f64, N = \
             10³, 10⁵, 10⁶): {gains}. The code in the source gains less: `v += dt*a` still \
             allocates an array for `dt*a`"
        );
        match f.iter().all(|f| f.measured > SUBSTANTIAL) {
            true => Judgement::conditional(because).only("no array is allocated at all"),
            false => Judgement::refuted(because),
        }
    });
    let ids = ["in-place", "fused"].map(|name| format!("throughput.single-over-double.{name}.1e6"));
    let ids = ids.each_ref().map(String::as_str);
    let text = "Single precision halves the state and raises throughput for many particles.";
    record.judge(Ruling { id: "C42", source: "5.5", text, findings: &ids }, |f| {
        let (passes, fused) = (f[0].measured, f[1].measured);
        let because = format!(
            "speed in f32 relative to f64 at N = 10⁶: {} for array operations, {} for fused steps, \
             since a register holds twice as many f32",
            show(passes),
            show(fused)
        );
        Judgement::holds_if(passes > 1.5 && fused > 1.5, because)
    });
}

/// Judges claims about limits.
fn limits(record: &mut Record) {
    let at_1e5 = gain_id(Fused, InPlace, F32, 1e5);
    let text = "At the numbers of particles that were tried the work is bound by the memory.";
    let ids = [at_1e5.as_str()];
    record.judge(Ruling { id: "C02", source: "Abstract, 5.1, 5.7", text, findings: &ids }, |f| {
        let gain = f[0].measured;
        let because = format!(
            "10⁵ trajectories take 0.8 MB in f32, which fits in a cache. On the same memory fused \
             steps are {} times as fast as array operations",
            show(gain)
        );
        Judgement::holds_if(gain < SEVERAL, because)
    });
    let text = "From one to 10⁵ particles execution goes from overhead to memory bandwidth.";
    let ids = ["throughput.overhead.in-place.f32", at_1e5.as_str()];
    record.judge(Ruling { id: "C36", source: "5.1", text, findings: &ids }, |f| {
        let because = format!(
            "the overhead is real: up to N = {} the fixed cost of a pass exceeds the cost of its \
             trajectories. But 10⁵ trajectories fit in a cache, where fused steps are {} times as \
             fast as array operations",
            show(f[0].measured),
            show(f[1].measured)
        );
        match f[1].measured > SEVERAL {
            true => Judgement::conditional(because).only("of overhead, not of bandwidth at 10⁵"),
            false => Judgement::confirmed(because),
        }
    });
    let text = "Between small and large numbers of particles allocation is the limit.";
    let ids = [1e3, 1e6].map(|count| gain_id(InPlace, Temporaries, F32, count));
    let ids = ids.each_ref().map(String::as_str);
    record.judge(Ruling { id: "C46", source: "5.7, 8.1", text, findings: &ids }, |f| {
        let (few, many) = (f[0].measured, f[1].measured);
        let because = format!(
            "without new arrays a step is {} times as fast at N = 10³ and {} times at 10⁶. The \
             source lists three limits in §5.7 and four in §5.8; allocation is not among the four",
            show(few),
            show(many)
        );
        match few.max(many) > SUBSTANTIAL {
            true => Judgement::conditional(because).only("as one cost among others"),
            false => Judgement::refuted(because),
        }
    });
    let ids = [gain_id(Fused, OneStep, F32, 1e6), "throughput.roofline".into()];
    let ids = ids.each_ref().map(String::as_str);
    let text = "Arithmetic intensity is low, so that a faster processor does not help.";
    record.judge(Ruling { id: "C47", source: "5.7, 8.2", text, findings: &ids }, |f| {
        let because = format!(
            "the intensity is that of a pass, not of the problem: trajectories do not interact, \
             and a block can take many steps while it is in registers. At N = 10⁶ this is {} times \
             as fast as one step per pass",
            show(f[0].measured)
        );
        match f[0].measured > SUBSTANTIAL {
            true => {
                Judgement::conditional(because).only("every pass over the memory takes one step")
            }
            false => Judgement::confirmed(because),
        }
    });
    let text = "A step takes a fixed number of operations and four accesses to memory.";
    let ids = ["throughput.arrays.one-step", "throughput.arrays.in-place"];
    record.judge(Ruling { id: "C69", source: "8.2", text, findings: &ids }, |f| {
        let because = format!(
            "a fused step reads and writes position and velocity, as the formula says; array passes \
             access {} times as many arrays",
            show(f[1].measured)
        );
        Judgement::conditional(because).only("all operations of a step are done in one pass")
    });
    let ids = [
        "throughput.growth.scalar.many",
        "throughput.growth.in-place.few",
        "throughput.growth.in-place.many",
    ];
    let text =
        "A loop saturates early, array operations scale, and large numbers are bound by memory.";
    record.judge(Ruling { id: "C82", source: "9.4", text, findings: &ids }, |f| {
        let [lone, few, many] = [0, 1, 2].map(|i| f[i].measured);
        let because = format!(
            "the rate of steps grows as a power of N, with the exponents: loop {} from 10³ to 10⁵; array \
             operations {} from 1 to 100 and {} from 10³ to 10⁵. Beyond that the memory traffic of \
             their own passes limits them",
            show(lone),
            show(few),
            show(many)
        );
        match lone < 0.5 && few > 0.5 {
            true => Judgement::conditional(because).only("true of the first two parts"),
            false => Judgement::refuted(because),
        }
    });
}

/// Judges claims about bandwidth.
fn bandwidth(record: &mut Record) {
    let text = "Bandwidth is particle-steps a second times four times the size of a float.";
    let ids = ["throughput.arrays.in-place", "throughput.arrays.temporaries"];
    record.judge(Ruling { id: "C44", source: "5.6", text, findings: &ids }, |f| {
        let over = f[0].measured;
        let because = format!(
            "the five array operations of a step access twelve arrays, {} times what the formula \
             counts. And if the arrays fit in a cache, the result is not a memory bandwidth",
            show(over)
        );
        Judgement::holds_if(over <= 1.0, because)
    });
    let ids = [
        "throughput.bandwidth.copy.one-core",
        "throughput.bandwidth.update.one-core",
        "throughput.formula.in-place.f32",
        "throughput.formula.in-place.f64",
    ];
    for (id, source, text) in [
        ("C45", "5.6, 9.4", "About 24 GB/s are reached, which is what the memory can do."),
        ("C68", "8.1", "The effective bandwidth comes near the limits of the hardware."),
    ] {
        record.judge(Ruling { id, source, text, findings: &ids }, |f| {
            let values = f.iter().map(|f| f.measured);
            let memory = values.clone().take(2).fold(0.0, f64::max);
            let formula = values.skip(2).fold(0.0, f64::max);
            let because = format!(
                "the source names no machine. Here loops that only move memory reach {} GB/s on \
                 one core, and array operations at the largest N reach {} GB/s by its formula, a \
                 share of {}. {} GB/s by a formula that counts a third of the traffic do not \
                 measure a memory",
                show(memory),
                show(formula),
                show(formula / memory),
                show(SATURATED)
            );
            Judgement::not_reproducible(because)
        });
    }
}
