//! The largest step of an integrator that meets the tolerance.

use libration::analysis::NystromCertificate;
use libration::equations::StepProgram;
use libration::integrator::{RungeKuttaCoefficients, SUZUKI4, YOSHIDA4};
use libration::{Integrator, Method};
use libration_work::{Interrupted, Work};

use super::ComparedIntegrator;
use super::motion::Motion;

/// Integrators that are tried first: no other needs many times more evaluations than the best of them and is still worth the search.
const FIRST: [&str; 3] = ["rk4", "blanes-moan-srkn-6-4", "mclachlan-ss17-8"];

/// The search for an integrator ends at this multiple of the evaluations of the best of some common ones.
pub const MOST_OF_BEST: f64 = 64.0;

/// No integrator takes more evaluations than this.
pub const MOST_EVALUATIONS: f64 = 4_194_304.0;

/// Halvings of the range between a step that fails and one that meets the tolerance, on a scale of logarithms: to 1 %.
const HALVINGS: usize = 6;

/// The search on a motion.
pub(super) struct Search<'m> {
    motion: &'m Motion<'m>,
    is_positional: bool,
    /// The most force evaluations of the motion.
    most: f64,
}

impl<'m> Search<'m> {
    pub(super) fn new(
        work: &Work<'_>,
        motion: &'m Motion<'m>,
        is_positional: bool,
    ) -> Result<Self, Interrupted> {
        let mut search = Search { motion, is_positional, most: MOST_EVALUATIONS };
        let known = FIRST.iter().filter_map(|name| Method::from_name(name));
        for method in known.filter(|method| is_positional || !method.supposes_positional_forces()) {
            if let Some(evaluations) = search.of(work, method)?.evaluations {
                search.most = search.most.min(MOST_OF_BEST * evaluations);
            }
        }
        Ok(search)
    }

    /// The most force evaluations of the motion that an integrator is tried with.
    pub(super) fn most_evaluations(&self) -> f64 {
        self.most
    }

    /// The largest step of an integrator that meets the tolerance, and all about it.
    pub(super) fn of(
        &self,
        work: &Work<'_>,
        method: Method,
    ) -> Result<ComparedIntegrator, Interrupted> {
        let step = StepProgram::new(method, self.motion.dynamics());
        let stages = if self.is_positional { stages(method) } else { step.evaluations() };
        let certified = method.certified_order(false);
        let order = match certified.or(self.is_positional.then(|| method.order())) {
            Some(order) => order,
            None => self.motion.order(&step),
        };
        let certificate = match self.is_positional {
            true => NystromCertificate::new(method, order as usize + 1),
            false => None,
        };
        let mut found = ComparedIntegrator {
            integrator: method.name(),
            order,
            stages,
            error_constant: certificate.and_then(|certificate| certificate.error_constant()),
            dt: None,
            evaluations: None,
            predicted_evaluations: None,
            error: None,
            energy_error: None,
        };
        let (steps, error) = self.fewest_steps(work, method, stages)?;
        // An interrupted motion has an infinite error.
        work.check()?;
        found.error = error.is_finite().then_some(error);
        if let Some(steps) = steps {
            found.dt = Some(self.motion.request.horizon / steps as f64);
            found.evaluations = Some(steps as f64 * stages as f64);
            found.energy_error = self.motion.energy_error(method, steps);
            work.check()?;
        }
        Ok(found)
    }

    /// The fewest steps that meet the tolerance, so that twice as many do, too, and their error; without such, the smallest error.
    fn fewest_steps(
        &self,
        work: &Work<'_>,
        method: Method,
        stages: usize,
    ) -> Result<(Option<u64>, f64), Interrupted> {
        let tolerance = self.motion.request.tolerance;
        let (mut steps, mut least) = (1, f64::INFINITY);
        let mut candidate: Option<(u64, f64)> = None;
        let (mut low, mut error) = loop {
            work.check()?;
            if steps as f64 * stages as f64 > self.most {
                return Ok((None, least));
            }
            let error = self.motion.error(method, steps);
            least = least.min(error);
            candidate = match candidate {
                Some(found) if error <= tolerance => break found,
                _ if error <= tolerance => Some((steps, error)),
                _ => None,
            };
            steps *= 2;
        };
        // `low` meets the tolerance; half of it does not, unless it is the first.
        let mut high = low / 2;
        for _ in 0..HALVINGS {
            work.check()?;
            if high == 0 || high + 1 >= low {
                break;
            }
            let middle = (low as f64 * high as f64).sqrt().round() as u64;
            let middle = middle.clamp(high + 1, low - 1);
            let here = self.motion.error(method, middle);
            if here <= tolerance { (low, error) = (middle, here) } else { high = middle }
        }
        Ok((Some(low), error))
    }
}

/// Force evaluations of a step, where neighbouring steps share those at their ends.
fn stages(method: Method) -> usize {
    match method {
        Method::Splitting(table) => table.coefficients.stages(),
        Method::RungeKutta(table) => match table.coefficients {
            // The last force is that of the end of the step.
            RungeKuttaCoefficients::Nystrom { c: [.., 1.0], a: [.., last], b_position, .. }
                if b_position.split_last() == Some((&0.0, last)) =>
            {
                table.coefficients.stages() - 1
            }
            coefficients => coefficients.stages(),
        },
        Method::VelocityVerlet | Method::TextbookVerlet => 1,
        Method::Yoshida4 => YOSHIDA4.weights.len(),
        Method::Suzuki4 => SUZUKI4.weights.len(),
        method => method.evaluations(),
    }
}
