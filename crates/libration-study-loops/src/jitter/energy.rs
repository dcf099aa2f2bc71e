//! Random walk of the energy with jitter.

use libration::analysis::Plant;
use libration::control::Jitter;
use libration::{Method, State};
use libration_report::notation::count;
use libration_report::record::{Cell, Finding, Record, Relation, Series, Table, Tolerance};
use libration_study::{Lab, StudyError, log_spaced_steps};

use super::setting::{FREE, Setting, Theory};
use super::{METHODS, free, start};
use crate::loop_ensemble::Snapshot;
use crate::sample::{ERRORS, Sample, WHY_ERRORS};

/// The time steps, in s.
pub(super) const DT: [f64; 4] = [0.001, 0.01, 0.1, 0.3];

/// The standard deviations of a step, as parts of it.
pub(super) const RMS: [f64; 3] = [0.01, 0.05, 0.1];

/// Deviations of a random walk that none of some hundred exceeds on its way.
const FAR: f64 = 6.0;

/// Below this number of steps times `γ` the walk is small beside the energy.
pub(super) const FEW: f64 = 0.01;

/// Steps of a run.
pub(super) fn horizon(lab: &Lab<'_>) -> u64 {
    lab.effort.choose(10_000, 1_000_000, 1_000_000)
}

/// Runs all settings.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let methods = METHODS.into_iter().filter(|m| lab.config.integrators.contains(m));
    let all = methods.flat_map(|m| DT.map(|dt| RMS.map(|rms| (m, dt, rms))).concat());
    // Steps of RK4 commute: they are looked at where they would show most.
    let all = all.filter(|&(m, dt, rms)| m != Method::Rk4 || (dt > 0.05 && rms == RMS[2]));
    let settings: Vec<Setting> =
        all.map(|(m, dt, rms)| Setting::new(lab.config, m, dt, rms)).collect();
    let at = log_spaced_steps(horizon(lab), 4.0);
    let starts = vec![start(lab); lab.effort.choose(64, 64, 512)];
    let what = format!("energy under jitter over {} steps", count(horizon(lab)));
    let runs = lab.sweep(&what, &settings, |setting| {
        let Some(theory) = setting.theory() else { return Ok(None) };
        let seen = free(lab, setting, setting.model, &starts, &at)?;
        Ok(Some(Run::new(setting, theory, lab, &seen)))
    })?;
    let columns = [
        "integrator",
        "Δt (s)",
        "σ",
        "γ predicted",
        "γN",
        "mean of ln E/E₀",
        "predicted",
        "its deviation",
        "predicted",
        "largest |ln E/E₀|",
    ];
    let mut table = Table::new("energy under jitter", &columns);
    for run in runs.iter().flatten() {
        run.find(record);
        table.push(run.row());
        record.series.push(run.series());
    }
    record.tables.push(table);
    exact(lab, record);
    Ok(())
}

/// Exact steps of any length only turn.
fn exact(lab: &Lab<'_>, record: &mut Record) {
    let [dt, rms] = [DT[3], RMS[2]];
    let plant = Plant::exact(lab.config.oscillator.system(), State::origin(), dt);
    let Some(rate) = plant.lyapunov_exponent(FREE, Jitter::Gaussian(rms)) else { return };
    let why = "rounding of sums over 256 directions and 41 lengths";
    record.find(Finding::predicted(
        "jitter.exact.exponent",
        "exact steps, Δt = 0.3 s, σ = 10 %: growth of ln |y| in a step, by the transfer operator",
        "1",
        0.0,
        rate,
        Tolerance::absolute(1e-13, why),
    ));
}

/// A setting that was run.
struct Run {
    setting: Setting,
    theory: Theory,
    steps: Vec<f64>,
    /// Of the logarithm of the form that the steady step carries along, at each of the steps.
    walk: Vec<Sample>,
    /// The largest change of the logarithm of the energy, of all trajectories at all of the steps.
    largest: f64,
    /// By how much it may swing without any jitter.
    swing: f64,
}

impl Run {
    fn new(setting: &Setting, theory: Theory, lab: &Lab<'_>, seen: &[Snapshot]) -> Self {
        let omega2 = setting.model.omega2;
        let begin = start(lab);
        let energy = |s: &State<f64, 1>| omega2 * s.q[0] * s.q[0] + s.v[0] * s.v[0];
        let (form, first) = (theory.form, theory.form.at(&begin).ln());
        let walk = |s: &Snapshot| {
            let changes = s.logarithms(|y| form.at(y));
            Sample::of(&changes.iter().map(|x| x - first).collect::<Vec<_>>())
        };
        let largest = seen.iter().flat_map(|s| s.logarithms(energy));
        Run {
            setting: *setting,
            theory,
            steps: seen.iter().map(|s| s.step as f64).collect(),
            walk: seen.iter().map(walk).collect(),
            largest: largest.map(|x| (x - energy(&begin).ln()).abs()).fold(0.0, f64::max),
            swing: theory.swing(omega2),
        }
    }

    /// Steps of the whole run.
    fn horizon(&self) -> f64 {
        self.steps.last().copied().unwrap_or(0.0)
    }

    /// Returns the predicted mean and deviation of the logarithm of the energy after `n` steps.
    fn predicted(&self, steps: f64) -> [f64; 2] {
        let deviation = self.theory.deviation(self.setting.rms);
        [2.0 * self.theory.rate * steps, deviation * steps.sqrt()]
    }

    /// Mean and deviation at the end.
    fn last(&self) -> Option<&Sample> {
        self.walk.last()
    }

    fn find(&self, record: &mut Record) {
        let (Setting { method, .. }, Some(last)) = (self.setting, self.last()) else { return };
        let n = self.horizon();
        let steps = count(n as u64);
        let [mean, deviation] = self.predicted(n);
        let id = |what: &str| self.setting.id(what);
        let about = |what: &str| self.setting.text(&format!("{what} after {steps} steps"));
        let text = about("mean of ln E/E₀, twice the Lyapunov exponent a step");
        // The sum of roundings, which is no more than one each for some hundred thousand steps.
        let rounding = f64::EPSILON * n;
        let why =
            format!("{WHY_ERRORS}; and 3aσ²/sin θ, what a part of a turn leaves of terms in σ²");
        let wanted = ERRORS * last.error() + rounding + self.theory.unturned(self.setting.rms);
        let tolerance = Tolerance::absolute(wanted, &why);
        record.find(Finding::predicted(id("mean"), text, "1", mean, last.mean, tolerance));
        let symplectic = method != Method::Rk4;
        let what = match symplectic {
            true => "standard deviation of ln E/E₀, 2√(γn)",
            false => "standard deviation of ln E/E₀, which damping that depends on the step leaves",
        };
        let why = "four standard errors of a deviation, and twice the part by which the exponent differs from \
                   that of weak noise";
        let part = ERRORS * last.error_of_deviation() + 2.0 * self.theory.beyond_weak();
        let tolerance = Tolerance::relative(part, why);
        let (text, found) = (about(what), last.deviation);
        record.find(Finding::predicted(id("deviation"), text, "1", deviation, found, tolerance));
        let few = self.theory.rate.abs() * n < FEW;
        if few && symplectic {
            let text = about("largest |ln E/E₀| of all trajectories, on the way too");
            let why = "the swing of the energy along the ellipse of a steady step, and six deviations \
                       of the walk, which no trajectory of hundreds exceeds";
            let bound = self.swing + mean + FAR * deviation + rounding;
            let tolerance = Tolerance::absolute(0.0, why);
            let (id, found) = (id("bounded"), self.largest);
            record.find(Finding::related(id, text, "1", Relation::AtMost, bound, found, tolerance));
        }
    }

    fn row(&self) -> Vec<Cell> {
        let [mean, deviation] = self.predicted(self.horizon());
        vec![
            self.setting.method.title().into(),
            self.setting.dt.into(),
            self.setting.rms.into(),
            self.theory.rate.into(),
            (self.theory.rate * self.horizon()).into(),
            self.last().map(|s| s.mean).into(),
            mean.into(),
            self.last().map(|s| s.deviation).into(),
            deviation.into(),
            self.largest.into(),
        ]
    }

    /// The root mean square of `ln E/E₀` against steps, beside theory.
    fn series(&self) -> Series {
        let measured = self.walk.iter().map(|s| s.mean.hypot(s.deviation)).collect();
        let predicted = self.steps.iter().map(|&n| {
            let [mean, deviation] = self.predicted(n);
            mean.hypot(deviation)
        });
        let Setting { method, dt, rms, .. } = self.setting;
        Series::new(format!("energy-{}-{dt}-{rms}", method.name()))
            .with("steps", "1", self.steps.clone())
            .with("measured", "1", measured)
            .with("predicted", "1", predicted.collect())
    }
}
