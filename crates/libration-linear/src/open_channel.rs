//! A loop opened at one channel.

use libration_core::control::Latency;
use num_complex::Complex64;

use crate::hessenberg::{HessenbergForm, Resolved};
use crate::{LinearLoop, LinearLoopError, LoopTiming, Matrix};

/// An input or an output of a loop, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// An input: its commands are late.
    Input(usize),
    /// An output: its measurements are late.
    Output(usize),
}

/// A loop that is opened at one channel, with all others closed.
///
/// The channel carries a number `s` per period, and the loop answers with the number `c` that enters the channel. With a latency of
/// `k + f` periods, `s = z⁻ᵏ c` and `c = G_f(z) s`: the response `G_f` depends on the part `f` of a period only, and no matrix holds
/// the numbers in transit. Eigenvalues of the closed loop solve `zᵏ = G_f(z)`.
pub(crate) struct OpenChannel<'a> {
    linear: &'a LinearLoop,
    timing: &'a LoopTiming,
    channel: Channel,
    /// Of the part of the loop that does not depend on the latency.
    form: HessenbergForm,
    driven: Vec<f64>,
}

/// The response `G_f(z) = r·x + d + (r'·x + d')/z` with the resolvent `x(z)`.
pub(crate) struct PartResponse {
    row: Vec<f64>,
    direct: f64,
    later: Option<(Vec<f64>, f64)>,
}

/// The coordinates of a period matrix in which the channel is a coordinate.
struct Cut {
    matrix: Matrix,
    /// The number in transit that is the next to leave the channel.
    transit: usize,
    /// The number that acts across the beginning of a period, or that was measured within it.
    between: Option<usize>,
    others: Vec<usize>,
}

impl<'a> OpenChannel<'a> {
    /// The loop with all latencies but that of `channel` as in `timing`, without jitter and losses.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub(crate) fn new(
        linear: &'a LinearLoop,
        timing: &'a LoopTiming,
        channel: Channel,
    ) -> Result<Self, LinearLoopError> {
        let cut = cut(linear, timing, channel, 0.0)?;
        let Cut { matrix, transit, others, .. } = &cut;
        let n = others.len();
        let inner = Matrix::from_fn(n, n, |i, j| matrix[(others[i], others[j])]);
        let (form, driven) = match channel {
            // The commands depend on the state alike whatever `f`: the resolvent of the transposed matrix.
            Channel::Input(_) => {
                let form = HessenbergForm::new(&inner.transposed());
                let sent: Vec<f64> = others.iter().map(|&j| matrix[(*transit, j)]).collect();
                let driven = form.column(&sent);
                (form, driven)
            }
            Channel::Output(_) => {
                let form = HessenbergForm::new(&inner);
                let driven: Vec<f64> = others.iter().map(|&i| matrix[(i, *transit)]).collect();
                let driven = form.column(&driven);
                (form, driven)
            }
        };
        Ok(OpenChannel { linear, timing, channel, form, driven })
    }

    /// The number of eigenvalues of the open loop, but for the part of a period.
    pub(crate) fn size(&self) -> usize {
        self.driven.len()
    }

    pub(crate) fn eigenvalues(&self) -> Vec<Complex64> {
        self.form.eigenvalues().unwrap_or_default()
    }

    pub(crate) fn resolved(&self, z: Complex64) -> Resolved {
        self.form.resolvent(z, &self.driven)
    }

    /// The response for a latency with this part of a period.
    pub(crate) fn response(&self, part: f64) -> Result<PartResponse, LinearLoopError> {
        let Cut { matrix, transit, between, others } =
            cut(self.linear, self.timing, self.channel, part)?;
        let row = |i: usize| -> Vec<f64> {
            self.form.row(&others.iter().map(|&j| matrix[(i, j)]).collect::<Vec<_>>())
        };
        let column = |j: usize| -> Vec<f64> {
            self.form.row(&others.iter().map(|&i| matrix[(i, j)]).collect::<Vec<_>>())
        };
        let direct = matrix[(transit, transit)];
        Ok(match (self.channel, between) {
            (Channel::Input(_), between) => PartResponse {
                row: column(transit),
                direct,
                later: between.map(|acting| (column(acting), matrix[(transit, acting)])),
            },
            (Channel::Output(_), None) => PartResponse { row: row(transit), direct, later: None },
            (Channel::Output(_), Some(taken)) => PartResponse {
                row: vec![0.0; others.len()],
                direct: 0.0,
                later: Some((row(taken), matrix[(taken, transit)])),
            },
        })
    }
}

impl PartResponse {
    /// `G_f(z)`.
    pub(crate) fn at(&self, z: Complex64, resolved: &Resolved) -> Complex64 {
        let along = |row: &[f64]| -> Complex64 {
            row.iter().zip(&resolved.solution).map(|(r, x)| x * r).sum()
        };
        let now = along(&self.row) + self.direct;
        match &self.later {
            Some((row, direct)) => now + (along(row) + direct) / z,
            None => now,
        }
    }
}

/// The period matrix for a latency of `1 + part` periods.
fn cut(
    linear: &LinearLoop,
    timing: &LoopTiming,
    channel: Channel,
    part: f64,
) -> Result<Cut, LinearLoopError> {
    let mut timing =
        LoopTiming { jitter: timing.jitter.with_rms(0.0), loss: 0.0, ..timing.clone() };
    let latency = Latency::of_steps(1.0 + part);
    let latency = latency.ok_or(LinearLoopError::Latency { periods: 1.0 + part })?;
    match channel {
        Channel::Input(i) => timing.input_latency[i] = latency,
        Channel::Output(j) => timing.output_latency[j] = latency,
    }
    let layout = linear.layout(&timing)?;
    let matrix = linear.period_matrix(&timing)?;
    let (transit, between) = match channel {
        Channel::Input(i) => {
            let acting = layout.acting(i);
            (layout.commands(i).start, (acting < layout.size()).then_some(acting))
        }
        Channel::Output(j) => {
            let places = layout.measurements(j);
            (places.end - 1, (places.len() > 1).then_some(places.start))
        }
    };
    let own = |k: &usize| *k != transit && Some(*k) != between;
    let others = (0..matrix.rows()).filter(own).collect();
    Ok(Cut { matrix, transit, between, others })
}
