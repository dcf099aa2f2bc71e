//! Every method in single precision compared with exact arithmetic and with `f64`: energy, phase and state.

use std::f64::consts::TAU;

use libration::analysis::{OrbitError, SymbolicStep, forecast_drift};
use libration::number::TwoFloat;
use libration::{Float, Integrator, Method, Scalar, State, with_method};
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::record::{Cell, Finding, Relation, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::in_float::InFloat;
use super::mixed_precision::{between, nearest_turn};
use super::tag;
use super::types::ERRORS;
use crate::precision::PrecisionSettings;
use crate::rounding::{path_of_unit_step, rounding_of_run, slip_of_run};

/// Every method at every time step.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let settings: Vec<(Method, f64)> = config
        .get::<PrecisionSettings>()
        .dt
        .iter()
        .flat_map(|&dt| config.integrators.iter().map(move |&m| (m, dt)))
        .collect();
    let columns = [
        "Δt (s)",
        "integrator",
        "drift, exact",
        "in f64",
        "in f32",
        "phase error in f64 (rad)",
        "f32 ahead of f64 (rad)",
        "states apart",
    ];
    let mut table = Table::new("single and double precision", &columns);
    let found = lab.sweep("single and double precision", &settings, |&(method, dt)| {
        Ok(with_method!(method, |m| Compared::new(lab, method, m, dt)))
    })?;
    for compared in found.iter().flatten() {
        compared.findings().into_iter().flatten().for_each(|finding| record.find(finding));
        table.push(compared.row());
    }
    record.tables.push(table);
    Ok(())
}

/// A run in one precision.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// Largest relative drift of the energy.
    largest: f64,
    /// The last state, as `(ωq, v)`.
    end: (f64, f64),
    /// The same in the coordinates in which the step is a rotation.
    looked: (f64, f64),
    /// Angle in rad by which the orbit has turned, in those.
    turned: TwoFloat,
}

/// The run; none if it leaves the range of the float.
fn run<I: Integrator, F: Float>(one: &InFloat<I, F>, steps: u64) -> Option<Run> {
    let omega = one.model.omega2.sqrt();
    let point = |state: &State<F, 1>| (omega * state.q[0].to_f64(), state.v[0].to_f64());
    let energy = |(x, y): (f64, f64)| x * x + y * y;
    // Eight looks a turn tell how far it has gone; their sum must not be rounded itself.
    let stride = (TAU / (8.0 * one.angle)).max(1.0) as u64;
    let (mut state, mut looked) = (one.start, one.normal(&one.start));
    let initial = energy(point(&state));
    let (mut largest, mut turned) = (0.0_f64, TwoFloat::zero());
    for n in 1..=steps {
        state = one.step(state);
        let now = energy(point(&state));
        largest = largest.max((now / initial - 1.0).abs());
        if n % stride == 0 || n == steps {
            let here = one.normal(&state);
            turned = turned + TwoFloat::from_f64(between(looked, here));
            looked = here;
            // Neither infinite nor lost among the smallest floats.
            if !now.is_normal() {
                return None;
            }
        }
    }
    Some(Run { largest, end: point(&state), looked, turned })
}

/// The largest drift in exact arithmetic.
fn forecast<I: Integrator, F: Float>(one: &InFloat<I, F>, steps: u64) -> Option<f64> {
    let start = one.start.map(F::to_f64);
    Some(forecast_drift(one.model, &one.matrix, &start, steps)?.drift.to_f64())
}

/// A method in both precisions.
struct Compared {
    method: Method,
    dt: f64,
    omega: f64,
    steps: u64,
    single: Option<Run>,
    double: Option<Run>,
    /// The largest drift in exact arithmetic, of the `f32` step and of the `f64` step.
    exact: [f64; 2],
    /// Distance of these orbits from the edge of their bands.
    gap: [f64; 2],
    /// What rounding may leave in an `f32` energy, relative to it; none where steps do not round at random.
    rounding: Option<f64>,
    /// Angle in rad by which the `f32` run is ahead, by its rounded parameters.
    ahead: f64,
    /// Phase error of the `f64` run; none where the step does not turn.
    slip: Option<f64>,
}

/// Explanation of the bounds on a run in `f32`.
const ROUNDED: &str = "what the roundings of single steps leave, four times √n of their scatter, n times their mean, and four times the \
                       error of that; and how far the orbit stays off the edge of its band";

impl Compared {
    fn new<I: Integrator>(lab: &Lab<'_>, method: Method, i: I, dt: f64) -> Option<Self> {
        let (config, steps) = (lab.config, lab.config.get::<PrecisionSettings>().steps);
        let (single, double) =
            (InFloat::<_, f32>::new(i, config, dt)?, InFloat::<_, f64>::new(i, config, dt)?);
        let exact = [forecast(&single, steps)?, forecast(&double, steps)?];
        let edges = [single.truncation(), double.truncation()];
        let gap = [0, 1].map(|i| (edges[i] - exact[i]).max(0.0));
        let n = steps as f64;
        // The bias of the textbook's form changes along the orbit; it has a section of its own.
        let random =
            single.rounds_at_random(f32::UNIT_ROUNDOFF) && method != Method::TextbookVerlet;
        let local = single.rounding::<f64>(lab.effort.choose(1_000_000, 1_000_000, 8_000_000));
        let rounding = local.filter(|_| random).map(|local| {
            ERRORS * (local.spread * n).sqrt()
                + (local.bias().abs() + ERRORS * local.mean_error) * n
        });
        let omega = double.model.omega2.sqrt();
        let slip = SymbolicStep::new(i).and_then(|step| OrbitError::new(&step, omega * dt));
        let slip = slip.map(|slip| n * slip.phase);
        let ahead = n * (single.angle - double.angle);
        Some(Compared {
            method,
            dt,
            omega,
            steps,
            single: run(&single, steps),
            double: run(&double, steps),
            exact,
            gap,
            rounding,
            ahead,
            slip,
        })
    }

    /// Angle by which the `f32` run is ahead, and the distance of the two states relative to the amplitude.
    fn apart(&self) -> Option<(f64, f64)> {
        let (single, double) = (self.single?, self.double?);
        let ahead = nearest_turn(between(double.looked, single.looked), self.ahead);
        let (x, y) = double.end;
        let distance = (single.end.0 - x).hypot(single.end.1 - y);
        Some((ahead, distance / x.hypot(y)))
    }

    /// The phase error of the `f64` run.
    fn slipped(&self) -> Option<f64> {
        let exact = TwoFloat::from_f64(self.z()) * TwoFloat::from_f64(self.steps as f64);
        self.double.map(|run| (run.turned - exact).to_f64())
    }

    /// How much of `z·u` the roundings along the orbit have in common. Weights and sixths of a step are rounded
    /// alike every time, halves not at all.
    fn alike(&self) -> f64 {
        match self.method {
            Method::Rk4 => 1.0,
            Method::Yoshida4 | Method::Suzuki4 | Method::Splitting(_) => {
                2.0 * path_of_unit_step(self.method)
            }
            _ => 0.1,
        }
    }

    fn z(&self) -> f64 {
        self.dt * self.omega
    }

    fn findings(&self) -> [Option<Finding>; 4] {
        let id = |what: &str| format!("precision.{}.{}.{what}", self.method.name(), tag(self.dt));
        let text = |what: &str| {
            let (title, dt) = (self.method.title(), seconds(self.dt, 3));
            format!("{title} at Δt = {dt}, {} steps: {what}", count(self.steps))
        };
        let energy = self.single.map(|run| {
            let what = text("largest energy drift in f32, beside that of exact arithmetic");
            match self.rounding {
                Some(rounding) => {
                    let (exact, why) = (self.exact[0], ROUNDED);
                    let left = (1.0 + exact) * rounding + self.gap[0];
                    if left < exact {
                        let tolerance = Tolerance::absolute(left, why);
                        Finding::predicted(id("f32"), what, "1", exact, run.largest, tolerance)
                    } else {
                        // Rounding hides the rest, and is known up to a bound.
                        let (most, bound) = (exact + left, Relation::AtMost);
                        let tolerance =
                            Tolerance::exact(format!("the prediction is a bound: {why}"));
                        Finding::related(id("f32"), what, "1", bound, most, run.largest, tolerance)
                    }
                }
                None => Finding::measured(id("f32"), what, "1", run.largest),
            }
        });
        // Below that a step rounds alike for longer than the bound on a run knows of.
        let resolved = self.z() >= 4.0 * f64::UNIT_ROUNDOFF.sqrt();
        let double = self.double.filter(|_| resolved).map(|run| {
            let rounding = rounding_of_run(self.method, self.omega, self.dt, self.steps);
            Finding::predicted(
                id("f64"),
                text("largest energy drift in f64, beside that of exact arithmetic"),
                "1",
                self.exact[1],
                run.largest,
                Tolerance::absolute(
                    (1.0 + self.exact[1]) * rounding + self.gap[1],
                    "eᶻ(12√n + s·n) roundings, with s = z/10 for products of shears and z² for \
                     others, as in the study of drift; and how far the orbit stays off the edge of \
                     its band",
                ),
            )
        });
        let slip = self.slip.zip(self.slipped()).map(|(predicted, measured)| {
            Finding::predicted(
                id("phase"),
                text("phase error in f64"),
                "rad",
                predicted,
                measured,
                Tolerance::absolute(
                    slip_of_run(self.method, self.omega, self.dt, self.steps),
                    "what rounding may leave in the energy, and 8 roundings of the angle ωt",
                ),
            )
        });
        let ahead = self.apart().zip(self.rounding).map(|((measured, _), rounding)| {
            Finding::predicted(
                id("ahead"),
                text("angle by which the run in f32 is ahead of that in f64: by its rounded step"),
                "rad",
                self.ahead,
                measured,
                Tolerance::absolute(
                    rounding + self.alike() * self.z() * f32::UNIT_ROUNDOFF * self.steps as f64,
                    "what rounding may leave in the energy, and for roundings along the orbit that are \
                     alike a tenth of z·u a step, or all of it where coefficients are rounded",
                ),
            )
        });
        [energy, double, slip, ahead]
    }

    fn row(&self) -> Vec<Cell> {
        let left = || Cell::absent("overflows");
        let drift = |run: Option<Run>| run.map_or_else(left, |run| Cell::rounded(run.largest, 4));
        vec![
            self.dt.into(),
            self.method.title().into(),
            Cell::rounded(self.exact[1], 4),
            drift(self.double),
            drift(self.single),
            self.slipped().map_or_else(left, |slip| Cell::rounded(slip, 3)),
            self.apart().map_or_else(left, |(ahead, _)| Cell::rounded(ahead, 3)),
            self.apart().map_or_else(left, |(_, distance)| Cell::rounded(distance, 3)),
        ]
    }
}
