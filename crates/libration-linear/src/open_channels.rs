//! A loop opened at some channels.

use core::cell::Cell;

use libration_core::control::Latency;
use num_complex::Complex64;

use crate::complex_eigenvalues::complex_eigenvalues;
use crate::hessenberg::{HessenbergForm, Resolved};
use crate::phases::same;
use crate::{LinearLoop, LinearLoopError, LoopTiming, Matrix};

/// Inputs or outputs of a loop, by their numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Channels {
    /// Inputs: their commands are late.
    Inputs(Vec<usize>),
    /// Outputs: their measurements are late.
    Outputs(Vec<usize>),
}

impl Channels {
    /// The numbers of the channels.
    pub fn numbers(&self) -> &[usize] {
        match self {
            Channels::Inputs(numbers) | Channels::Outputs(numbers) => numbers,
        }
    }

    /// Fails if there is none, one twice, or one that the loop lacks.
    fn check(&self, linear: &LinearLoop) -> Result<(), LinearLoopError> {
        let (of, count) = match self {
            Channels::Inputs(_) => ("inputs", linear.plant().inputs.len()),
            Channels::Outputs(_) => ("outputs", linear.plant().outputs.len()),
        };
        let numbers = self.numbers();
        let repeated = |(k, i): (usize, &usize)| numbers[..k].contains(i);
        let fits = numbers.iter().all(|i| *i < count) && !numbers.iter().enumerate().any(repeated);
        match fits && !numbers.is_empty() {
            true => Ok(()),
            false => Err(LinearLoopError::LateChannels { of, given: numbers.to_vec(), count }),
        }
    }
}

/// A loop that is opened at some channels, with all others closed.
///
/// Each channel carries a number `s` per period, and the loop answers with the number `c` that enters the channel. With a latency of
/// `k + f` periods, `s = z⁻ᵏ c` and `c = G_f(z) s`: the matrix of responses `G_f` depends on the part `f` of a period only, and no
/// matrix holds the numbers in transit. Eigenvalues of the closed loop solve `det(zᵏ − G_f(z)) = 0`. Latencies that the channels have
/// besides are part of `G_f`: the whole periods as powers of `z`.
pub(crate) struct OpenChannels<'a> {
    linear: &'a LinearLoop,
    timing: &'a LoopTiming,
    channels: &'a Channels,
    /// Of the part of the loop that does not depend on the latency.
    form: HessenbergForm,
    /// One column per channel.
    driven: Vec<Vec<f64>>,
    /// Responses and resolvents that were computed.
    work: [Cell<u64>; 2],
}

/// The most responses, and the most resolvents, of one search. Loops whose loci are known use a hundredth of them. Where loci are rounding,
/// as beside a plant that grows by many digits per period, every interval would be halved to its end.
const MOST_WORK: [u64; 2] = [1 << 16, 1 << 22];

/// The transposed response `G_f(z)`, or `G_f(z)` itself: entry `(i, j)` is the sum of all ways `i` with the resolvent `xⱼ(z)`.
pub(crate) struct PartResponse {
    ways: Vec<Vec<Way>>,
}

/// `(r·xⱼ + dⱼ) z⁻ᵖ`.
struct Way {
    row: Vec<f64>,
    direct: Vec<f64>,
    periods: u32,
}

/// The coordinates of a period matrix in which the channels are coordinates.
struct Cut {
    matrix: Matrix,
    ends: Vec<ChannelEnd>,
    others: Vec<usize>,
}

struct ChannelEnd {
    /// The number in transit that is the next to leave the channel.
    transit: usize,
    /// The number that acts across the beginning of a period, or that was measured within it.
    between: Option<usize>,
    /// The whole periods of the latency, but for those that all channels have more.
    periods: u32,
}

impl<'a> OpenChannels<'a> {
    /// The loop with all latencies as in `timing`, without jitter and losses.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing or channel.
    pub(crate) fn new(
        linear: &'a LinearLoop,
        timing: &'a LoopTiming,
        channels: &'a Channels,
    ) -> Result<Self, LinearLoopError> {
        channels.check(linear)?;
        linear.check_timing(timing)?;
        let Cut { matrix, ends, others } = cut(linear, timing, channels, 0.0)?;
        let n = others.len();
        let inner = Matrix::from_fn(n, n, |i, j| matrix[(others[i], others[j])]);
        let form = HessenbergForm::new(&match channels {
            // The commands depend on the state alike whatever `f`: the resolvent of the transposed matrix.
            Channels::Inputs(_) => inner.transposed(),
            Channels::Outputs(_) => inner,
        });
        let driven = |end: &ChannelEnd| {
            let entry = |&i: &usize| match channels {
                Channels::Inputs(_) => matrix[(end.transit, i)],
                Channels::Outputs(_) => matrix[(i, end.transit)],
            };
            form.column(&others.iter().map(entry).collect::<Vec<f64>>())
        };
        let driven = ends.iter().map(driven).collect();
        Ok(OpenChannels { linear, timing, channels, form, driven, work: Default::default() })
    }

    /// Whether a search has used all of its work.
    pub(crate) fn is_exhausted(&self) -> bool {
        self.work.iter().zip(MOST_WORK).any(|(used, most)| used.get() >= most)
    }

    /// The error of a search that has used all of its work.
    pub(crate) fn exhausted(&self) -> LinearLoopError {
        LinearLoopError::Search { responses: self.work[0].get() }
    }

    /// The number of eigenvalues of the open loop, but for the part of a period.
    pub(crate) fn size(&self) -> usize {
        self.form.h.rows()
    }

    /// The number of channels.
    pub(crate) fn channels(&self) -> usize {
        self.driven.len()
    }

    /// The longest latency that a channel has besides, in whole periods.
    pub(crate) fn most_periods(&self) -> u64 {
        own_latencies(self.timing, self.channels).map(Latency::whole).max().unwrap_or(0)
    }

    pub(crate) fn eigenvalues(&self) -> Vec<Complex64> {
        self.form.eigenvalues().unwrap_or_default()
    }

    pub(crate) fn resolved(&self, z: Complex64) -> Resolved {
        self.work[1].set(self.work[1].get() + 1);
        self.form.resolvent(z, &self.driven)
    }

    /// The parts of a period at which the response has kinks, in rising order from 0 on: the latency of a channel passes a whole number
    /// of periods, or a command and a measurement are at the same time. With a direct path of the plant it jumps there.
    pub(crate) fn breaks(&self) -> Vec<f64> {
        let LoopTiming { input_latency, output_latency, .. } = self.timing;
        let others = match self.channels {
            Channels::Inputs(_) => output_latency,
            Channels::Outputs(_) => input_latency,
        };
        let meets: Vec<f64> = others.iter().map(|latency| latency.part()).chain([0.0]).collect();
        let mut breaks = vec![0.0];
        for own in own_latencies(self.timing, self.channels) {
            let at = meets.iter().map(|part| (2.0 - own.part() - part).fract());
            breaks.extend(at.filter(|at| !same(*at, 1.0)));
        }
        breaks.sort_by(f64::total_cmp);
        breaks.dedup_by(|later, earlier| same(*later, *earlier));
        breaks
    }

    /// The response for an added latency with this part of a period.
    ///
    /// # Errors
    /// [`LinearLoopError`]: a latency that is too long, or [`LinearLoopError::Search`] if all work of a search is used.
    pub(crate) fn response(&self, part: f64) -> Result<PartResponse, LinearLoopError> {
        if self.is_exhausted() {
            return Err(self.exhausted());
        }
        self.work[0].set(self.work[0].get() + 1);
        let Cut { matrix, ends, others } = cut(self.linear, self.timing, self.channels, part)?;
        let row = |entry: &dyn Fn(usize) -> f64| -> Vec<f64> {
            self.form.row(&others.iter().map(|&i| entry(i)).collect::<Vec<_>>())
        };
        let direct = |entry: &dyn Fn(usize) -> f64| -> Vec<f64> {
            ends.iter().map(|end| entry(end.transit)).collect()
        };
        let ways = |end: &ChannelEnd| -> Vec<Way> {
            let entries = |place: usize, later: u32| {
                let entry = |i: usize| match self.channels {
                    Channels::Inputs(_) => matrix[(i, place)],
                    Channels::Outputs(_) => matrix[(place, i)],
                };
                let periods = end.periods + later;
                Way { row: row(&entry), direct: direct(&entry), periods }
            };
            match (self.channels, end.between) {
                (_, None) => vec![entries(end.transit, 0)],
                (Channels::Inputs(_), Some(acting)) => {
                    vec![entries(end.transit, 0), entries(acting, 1)]
                }
                (Channels::Outputs(_), Some(taken)) => vec![entries(taken, 1)],
            }
        };
        Ok(PartResponse { ways: ends.iter().map(ways).collect() })
    }
}

impl PartResponse {
    /// The characteristic loci of the loop at `z`: the eigenvalues of `G_f(z)`, from the largest on.
    ///
    /// A. G. J. MacFarlane, I. Postlethwaite, *The generalized Nyquist stability criterion and multivariable root loci*, International
    /// Journal of Control 25, 1977.
    pub(crate) fn loci(&self, z: Complex64, resolved: &Resolved) -> Vec<Complex64> {
        let back = z.inv();
        let mut entries = Vec::with_capacity(self.ways.len() * self.ways.len());
        for ways in &self.ways {
            for (j, solution) in resolved.solutions.iter().enumerate() {
                let value = |way: &Way| -> Complex64 {
                    let along: Complex64 = way.row.iter().zip(solution).map(|(r, x)| x * r).sum();
                    let now = along + way.direct[j];
                    if way.periods == 0 { now } else { now * back.powu(way.periods) }
                };
                entries.push(ways.iter().map(value).sum());
            }
        }
        let mut values = complex_eigenvalues(entries, self.ways.len());
        values.sort_by(|a, b| b.norm_sqr().total_cmp(&a.norm_sqr()));
        values
    }
}

fn own_latencies<'a>(
    timing: &'a LoopTiming,
    channels: &'a Channels,
) -> impl Iterator<Item = Latency> + 'a {
    let all = match channels {
        Channels::Inputs(_) => &timing.input_latency,
        Channels::Outputs(_) => &timing.output_latency,
    };
    channels.numbers().iter().map(|&i| all[i])
}

/// The period matrix in which each of the channels is one period late, and the part of a period that its latency has with `part`.
fn cut(
    linear: &LinearLoop,
    timing: &LoopTiming,
    channels: &Channels,
    part: f64,
) -> Result<Cut, LinearLoopError> {
    let mut late = LoopTiming { jitter: timing.jitter.with_rms(0.0), loss: 0.0, ..timing.clone() };
    let latencies = match channels {
        Channels::Inputs(_) => &mut late.input_latency,
        Channels::Outputs(_) => &mut late.output_latency,
    };
    let mut periods = Vec::with_capacity(channels.numbers().len());
    for &i in channels.numbers() {
        let own = latencies[i];
        let sum = own.part() + part;
        // No rounding makes a whole period a part of one.
        let carried = sum >= 1.0 || same(sum, 1.0);
        let part = if carried { (sum - 1.0).max(0.0) } else { sum };
        let whole = own.whole() + u64::from(carried);
        let long = || LinearLoopError::Latency { periods: own.steps() + 1.0 };
        periods.push(u32::try_from(whole).map_err(|_| long())?);
        latencies[i] = Latency::of_steps(1.0 + part).ok_or_else(long)?;
    }
    let layout = linear.layout(&late)?;
    let matrix = linear.period_matrix(&late)?;
    let end = |(&i, periods): (&usize, u32)| match channels {
        Channels::Inputs(_) => {
            let (transit, acting) = (layout.commands(i).start, layout.acting(i));
            let between = (acting < layout.size()).then_some(acting);
            ChannelEnd { transit, between, periods }
        }
        Channels::Outputs(_) => {
            let places = layout.measurements(i);
            let between = (places.len() > 1).then_some(places.start);
            ChannelEnd { transit: places.end - 1, between, periods }
        }
    };
    let ends: Vec<ChannelEnd> = channels.numbers().iter().zip(periods).map(end).collect();
    let own = |k: &usize| ends.iter().any(|end| *k == end.transit || Some(*k) == end.between);
    let others = (0..matrix.rows()).filter(|k| !own(k)).collect();
    Ok(Cut { matrix, ends, others })
}
