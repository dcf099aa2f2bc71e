//! Variants of RK4 with a mistake, compared with the value of the source.

use libration::analysis::{ErrorForecast, UpdateMatrix};
use libration::number::Wide;
use libration::system::Oscillator;
use libration::{Scalar, State, System};
use libration_report::record::Table;

use super::run::Setting;

/// A mistake in a hand-written RK4. Stages count from one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    /// None at all.
    Correct,
    /// The position at which the force of this stage is taken moves by the acceleration of the one
    /// before times `Δt`, where its dimension asks for `Δt²`.
    Dimension(usize),
    /// The force of this stage is that of the first.
    Frozen(usize),
    /// The half steps are taken full.
    FullSteps,
}

impl Mistake {
    const ALL: [(Mistake, &'static str); 7] = [
        (Mistake::Correct, "none"),
        (Mistake::Dimension(2), "stage 2: position moved by ½Δt·a as well"),
        (Mistake::Dimension(3), "stage 3: position moved by ½Δt·a as well"),
        (Mistake::Dimension(4), "stage 4: position moved by Δt·a as well"),
        (Mistake::Frozen(2), "stage 2 takes the force of stage 1"),
        (Mistake::Frozen(4), "stage 4 takes the force of stage 1"),
        (Mistake::FullSteps, "half steps taken full"),
    ];

    /// One step of RK4 with this slip.
    fn step(
        self,
        system: &impl System<Wide, 1>,
        start: State<Wide, 1>,
        dt: Wide,
    ) -> State<Wide, 1> {
        let half = if self == Mistake::FullSteps { dt } else { dt.ratio(1, 2) };
        let first = system.rate(start);
        let stage = |number: usize, before: State<Wide, 1>, h: Wide| {
            let mut at = start.plus(h, before);
            let v = at.v;
            if self == Mistake::Dimension(number) {
                at.q[0] = at.q[0] + h * before.v[0];
            }
            let force =
                if self == Mistake::Frozen(number) { first.v } else { system.acceleration(&at) };
            State { q: v, v: force }
        };
        let k2 = stage(2, first, half);
        let k3 = stage(3, k2, half);
        let k4 = stage(4, k3, dt);
        start.plus(dt.ratio(1, 6), first + k2.doubled() + k3.doubled() + k4)
    }
}

/// The errors of each suspect over the run of `setting`, in closed form.
pub(super) fn table(setting: &Setting) -> Table {
    let mut table = Table::new("suspects", &["slip in RK4", "one step late (m)", "aligned (m)"]);
    let system = Oscillator { omega2: Wide::from_f64(setting.oscillator.omega2) };
    let dt = Wide::from_f64(setting.dt);
    for (slip, words) in Mistake::ALL {
        let step = UpdateMatrix::from_map(|e| slip.step(&system, e, dt));
        if let Some(error) =
            ErrorForecast::new(setting.oscillator, &step, setting.dt, &setting.start)
        {
            let rms = |late| error.rms(setting.steps, late).to_f64();
            table.push([words.into(), rms(1).into(), rms(0).into()]);
        }
    }
    table
}
