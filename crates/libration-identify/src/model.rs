//! A model of a response, and its likelihood as a function of coordinates.

use crate::effort::Effort;
use crate::hold::Hold;
use crate::noise::{Noise, NoiseKind};
use crate::recording::Recording;
use crate::regression::Regression;
use crate::response::ResponseKind;
use crate::start::Start;
use crate::whitening::{COMMAND, LOAD, Whitened, Window, whiten};

/// A form of the response and of its noise, with what is known of them.
#[derive(Clone, Debug)]
pub(crate) struct Model<'w> {
    pub(crate) response: ResponseKind,
    pub(crate) hold: Hold,
    pub(crate) noise: NoiseKind,
    /// The gain, if it is known.
    pub(crate) gain: Option<f64>,
    /// Known parameters of the response, in their order.
    pub(crate) known: Vec<Option<f64>>,
    /// The largest dead time, in s.
    pub(crate) longest: f64,
    /// The median interval of the responses, in s.
    pub(crate) interval: f64,
    /// What is assumed before the first response.
    pub(crate) start: Start,
    /// What the search may spend.
    pub(crate) effort: Effort<'w>,
}

/// A point of a model: parameters of the response in their order, and noise.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) shape: Vec<f64>,
    pub(crate) noise: Noise,
}

/// A time constant this much shorter than an interval of the responses cannot be told from none.
const SHORTEST_LAG: f64 = 1e-3;

impl<'w> Model<'w> {
    /// The number of free parameters of the response.
    pub(crate) fn free_shape(&self) -> usize {
        self.known.iter().filter(|known| known.is_none()).count()
    }

    /// The number of coordinates of a point.
    pub(crate) fn coordinates(&self) -> usize {
        self.free_shape() + self.noise_coordinates()
    }

    fn noise_coordinates(&self) -> usize {
        match self.noise {
            NoiseKind::White => 0,
            NoiseKind::Coloured => 2,
            NoiseKind::Disturbance => 1,
        }
    }

    /// The coordinates of noise at which a search begins, and its first steps.
    pub(crate) fn noise_start(&self) -> (Vec<f64>, Vec<f64>) {
        match self.noise {
            NoiseKind::White => (Vec::new(), Vec::new()),
            NoiseKind::Coloured => (vec![0.0, 1.5], vec![1.0, 0.7]),
            NoiseKind::Disturbance => (vec![0.0], vec![1.5]),
        }
    }

    /// The coordinates of a response at which a search begins.
    pub(crate) fn start(&self, shape: &[f64]) -> Vec<f64> {
        [self.free(shape), self.noise_start().0].concat()
    }

    /// First steps of a search in the free parameters of the response, around `shape`.
    pub(crate) fn shape_scales(&self, shape: &[f64], grid: f64) -> Vec<f64> {
        let all =
            self.response.parameters().iter().zip(shape).map(|(parameter, &value)| match parameter
                .key
            {
                "dead_time" => grid,
                "damping_ratio" => 0.2 * value.max(0.2),
                _ => 0.3 * value.max(self.interval),
            });
        let all: Vec<f64> = all.collect();
        self.free(&all)
    }

    /// The free ones among the parameters of the response.
    pub(crate) fn free(&self, shape: &[f64]) -> Vec<f64> {
        let free = shape.iter().zip(&self.known).filter(|(_, known)| known.is_none());
        free.map(|(&value, _)| value).collect()
    }

    /// The point of these coordinates; `None` outside of the model.
    pub(crate) fn point(&self, coordinates: &[f64]) -> Option<Point> {
        let mut free = coordinates.iter().copied();
        let mut shape = Vec::with_capacity(self.known.len());
        for (parameter, known) in self.response.parameters().iter().zip(&self.known) {
            // Reflected at zero, where the likelihood has no other side.
            let value = match known {
                Some(value) => *value,
                None => free.next()?.abs(),
            };
            let is_inside = match parameter.key {
                "dead_time" => value <= self.longest,
                "lag" => value <= 1e6 * self.interval,
                "time_constant" => (0.02 * self.interval..1e6 * self.interval).contains(&value),
                _ => value < 1e3,
            };
            if !is_inside {
                return None;
            }
            let vanishes = parameter.key == "lag" && value < SHORTEST_LAG * self.interval;
            shape.push(if vanishes { 0.0 } else { value });
        }
        let mut noise = Noise::WHITE;
        match self.noise {
            NoiseKind::White => {}
            NoiseKind::Coloured => {
                let (share, time) = (free.next()?, free.next()?);
                // Where neither error is alone, the covariance has an inverse.
                if !(share.abs() < 9.0 && (-1.2..16.0).contains(&time)) {
                    return None;
                }
                noise.coloured = 1.0 / (1.0 + (-share).exp());
                noise.white = 1.0 - noise.coloured;
                noise.correlation_time = self.interval * time.exp();
            }
            NoiseKind::Disturbance => {
                let intensity = free.next()?;
                if intensity.abs() > 40.0 {
                    return None;
                }
                noise.disturbance = intensity.exp() * self.interval;
            }
        }
        Some(Point { shape, noise })
    }

    /// The innovations of a window at a point.
    pub(crate) fn whitened(&self, window: Window<'_>, point: &Point) -> Whitened {
        let plant = self.response.dynamics(&point.shape[1..]);
        whiten(window, &plant, point.shape[0], point.noise)
    }

    /// The regression of a window at a point.
    pub(crate) fn regression(&self, window: Window<'_>, point: &Point) -> Regression {
        let mut found = Regression::new(&self.whitened(window, point), self.gain);
        if window.is_at_rest && self.response.dynamics(&point.shape[1..]).integrates() {
            // An integral rests where the load balances the first command.
            found.coefficients[LOAD] = -found.coefficients[COMMAND] * window.recording.commands[0];
        }
        found
    }

    /// The negative log likelihood at these coordinates, infinite outside of the model.
    /// It is infinite too once the effort is spent or the work is stopped, which ends a search where it is.
    pub(crate) fn cost(&self, window: Window<'_>, coordinates: &[f64]) -> f64 {
        let count = window.recording.responses.len() - window.first;
        let Some(point) = self.point(coordinates).filter(|_| self.effort.spend(count)) else {
            return f64::INFINITY;
        };
        -self.regression(window, &point).log_likelihood()
    }

    /// The same model with another effort.
    pub(crate) fn with_effort<'v>(&self, effort: Effort<'v>) -> Model<'v> {
        Model {
            response: self.response.clone(),
            hold: self.hold,
            noise: self.noise,
            gain: self.gain,
            known: self.known.clone(),
            longest: self.longest,
            interval: self.interval,
            start: self.start,
            effort,
        }
    }

    /// What is assumed before the first response. A disturbance moves a plant also before its recording, so that it does not begin at rest.
    pub(crate) fn assumed_start(&self) -> Start {
        match (self.start, self.noise) {
            (Start::Rest, NoiseKind::Disturbance) => Start::Held,
            (start, _) => start,
        }
    }

    /// The part of a recording that every dead time of the model predicts from known or assumed commands.
    pub(crate) fn window<'a>(&self, recording: &'a Recording) -> Window<'a> {
        let start = self.assumed_start();
        let first = match start {
            Start::Unknown => recording.response_times.partition_point(|&time| time < self.longest),
            Start::Rest | Start::Held => 0,
        };
        let is_at_rest = start == Start::Rest;
        Window { recording, first, is_at_rest, hold: self.hold, interval: self.interval }
    }
}
