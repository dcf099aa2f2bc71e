//! The exact motion at all times: polynomials through states of the reference flow.

use libration::number::TwoFloat;
use libration::{Elementary, Float, Scalar};
use libration_work::Work;

use super::ComparisonError;
use crate::reference_flow::{Point, Rates, piece};

/// Intervals between the nodes of a piece: the degree of its polynomial.
const DEGREE: usize = 15;

/// A piece is accepted if the polynomial is as near to the motion between its nodes as this part of the tolerance.
const PART: f64 = 0.02;

/// No more pieces than this.
const MOST_PIECES: usize = 20_000;

/// A piece shorter than this part of the motion shows that the motion ends, or that its forces jump.
const SHORTEST: f64 = 1e-9;

/// The motion of a system from its start.
pub(super) struct DenseReference {
    nodes: Nodes,
    pieces: Vec<Piece>,
    /// The largest size of each state, or 1 if it is always zero.
    pub(super) scales: Vec<f64>,
    /// What the motion may be wrong by: the largest of the states, relative to their scales.
    pub(super) error: f64,
}

/// A time, and the states at its nodes.
struct Piece {
    start: f64,
    length: f64,
    /// States at the nodes.
    states: Vec<Vec<f64>>,
}

/// A piece that was tried.
struct Trial {
    nodes: Vec<Point>,
    /// For each state, the distance of the polynomial from the motion between nodes, and what the flow may be wrong by.
    interpolation: Vec<f64>,
    flow: Vec<f64>,
}

/// Places in `[0, 1]` and barycentric weights of the nodes of Chebyshev and Lobatto (J.-P. Berrut, L. N. Trefethen, *SIAM Review* 46,
/// 2004).
#[derive(Clone, Copy)]
struct Nodes([(f64, f64); DEGREE + 1]);

impl Nodes {
    fn new() -> Self {
        Nodes(core::array::from_fn(|j| {
            let angle = core::f64::consts::PI * j as f64 / DEGREE as f64;
            let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
            let is_end = j == 0 || j == DEGREE;
            (0.5 - 0.5 * Elementary::cos(angle), if is_end { 0.5 * sign } else { sign })
        }))
    }

    fn place(&self, j: usize) -> f64 {
        self.0[j].0
    }

    /// Writes the polynomial through the states of the nodes, at a part of the piece, into `out`.
    fn interpolate(&self, at: f64, states: &[Vec<f64>], out: &mut [f64]) {
        out.fill(0.0);
        let mut total = 0.0;
        for (&(place, weight), state) in self.0.iter().zip(states) {
            if at == place {
                out.copy_from_slice(state);
                return;
            }
            let weight = weight / (at - place);
            total += weight;
            out.iter_mut().zip(state).for_each(|(out, x)| *out += weight * x);
        }
        out.iter_mut().for_each(|out| *out /= total);
    }
}

impl DenseReference {
    /// Pieces are at most `longest` seconds long. `sizes` are about the largest of the states in the motion.
    ///
    /// # Errors
    /// [`ComparisonError::NotFinite`], [`ComparisonError::NotSmooth`], [`ComparisonError::TooLong`], and [`ComparisonError::Interrupted`].
    pub(super) fn new(
        work: &Work<'_>,
        rates: &mut Rates<'_, TwoFloat>,
        start: &[f64],
        sizes: &[f64],
        horizon: f64,
        tolerance: f64,
        longest: f64,
    ) -> Result<Self, ComparisonError> {
        let nodes = Nodes::new();
        let mut state: Point = start.iter().map(|&x| TwoFloat::from_f64(x)).collect();
        let mut scales: Vec<f64> = start.iter().map(|x| x.abs()).collect();
        let mut lost = vec![0.0; start.len()];
        let (mut pieces, mut time, mut length) = (Vec::new(), 0.0, longest);
        while time < horizon {
            work.check()?;
            let is_last = time + length >= horizon * (1.0 - 1e-12);
            let own = if is_last { horizon - time } else { length };
            let trial = attempt(&nodes, rates, &state, own);
            let near = |trial: &Trial| {
                let mut worst = 0.0_f64;
                for (i, (scale, size)) in scales.iter().zip(sizes).enumerate() {
                    let sizes = trial.nodes.iter().map(|node| node[i].to_f64().abs());
                    let scale = sizes.fold(scale.max(*size), f64::max);
                    // What rests at zero has no size.
                    let relative = |off: f64| if off == 0.0 { 0.0 } else { off / scale };
                    let flow = relative(trial.flow[i]) * horizon / own;
                    let off = relative(trial.interpolation[i]).max(flow);
                    worst = if off > worst || off.is_nan() { off } else { worst };
                }
                worst / (PART * tolerance)
            };
            let off = trial.as_ref().map_or(f64::NAN, near);
            let Some(trial) = trial.filter(|_| off <= 1.0) else {
                length = 0.5 * own;
                if length < SHORTEST * horizon {
                    return Err(match off.is_finite() {
                        true => ComparisonError::NotSmooth { time, horizon },
                        false => ComparisonError::NotFinite { time, horizon },
                    });
                }
                continue;
            };
            for (i, scale) in scales.iter_mut().enumerate() {
                let sizes = trial.nodes.iter().map(|node| node[i].to_f64().abs());
                *scale = sizes.fold(*scale, f64::max);
                lost[i] += trial.flow[i];
            }
            let rounded = |node: &Point| node.iter().map(|x| x.to_f64()).collect();
            let states = trial.nodes.iter().map(rounded).collect();
            pieces.push(Piece { start: time, length: own, states });
            if pieces.len() > MOST_PIECES {
                return Err(ComparisonError::TooLong { time, horizon });
            }
            state.clone_from(&trial.nodes[DEGREE]);
            time = if is_last { horizon } else { time + own };
            // The error of a polynomial falls with its degree: far below the limit the next may be longer.
            length = if off < 1e-4 { (2.0 * own).min(longest) } else { own };
        }
        let scales: Vec<f64> =
            scales.iter().map(|&size| if size > 0.0 { size } else { 1.0 }).collect();
        let error = lost.iter().zip(&scales).map(|(off, scale)| off / scale).fold(0.0, f64::max);
        Ok(DenseReference { nodes, pieces, scales, error: error + PART * tolerance })
    }

    /// The largest difference from another reference at the ends of the pieces, relative to the scales, and its time.
    pub(super) fn largest_difference(&self, other: &Self) -> (f64, f64) {
        let (mut worst, mut at, mut hint) = (0.0, 0.0, 0);
        let mut state = vec![0.0; self.scales.len()];
        for piece in &self.pieces {
            other.write(piece.start, &mut hint, &mut state);
            for ((x, y), scale) in state.iter().zip(&piece.states[0]).zip(&self.scales) {
                let off = (x - y).abs() / scale;
                if off > worst {
                    (worst, at) = (off, piece.start);
                }
            }
        }
        (worst, at)
    }

    /// Whether no state ever leaves its start.
    pub(super) fn rests_at(&self, start: &[f64]) -> bool {
        self.pieces.iter().all(|piece| piece.states.iter().all(|state| state == start))
    }

    /// Writes the state at a time into `out`. `hint` is the piece of the last time, and is moved on.
    pub(super) fn write(&self, time: f64, hint: &mut usize, out: &mut [f64]) {
        let (piece, at) = self.place(time, hint);
        self.nodes.interpolate(at, &piece.states, out);
    }

    /// The piece of a time, and the part of it that has as many as a piece has intervals between nodes.
    pub(super) fn interval(&self, time: f64, hint: &mut usize) -> (usize, usize) {
        let (_, at) = self.place(time, hint);
        (*hint, (at * DEGREE as f64) as usize)
    }

    fn place(&self, time: f64, hint: &mut usize) -> (&Piece, f64) {
        while *hint + 1 < self.pieces.len() && time >= self.pieces[*hint + 1].start {
            *hint += 1;
        }
        let piece = &self.pieces[*hint];
        (piece, (time - piece.start) / piece.length)
    }
}

/// Nodes of a piece from `start`, with its errors; none if a state is not finite.
fn attempt(
    nodes: &Nodes,
    rates: &mut Rates<'_, TwoFloat>,
    start: &[TwoFloat],
    length: f64,
) -> Option<Trial> {
    let mut states: Vec<Point> = vec![start.to_vec()];
    let mut flow = vec![0.0; start.len()];
    let length = TwoFloat::from_f64(length);
    let mut advance = |from: &[TwoFloat], parts: [f64; 2]| -> Option<(Point, Vec<f64>)> {
        let time = length * (TwoFloat::from_f64(parts[1]) - TwoFloat::from_f64(parts[0]));
        let (end, off) = piece(rates, from, time);
        end.iter().all(|x| x.to_f64().is_finite()).then_some((end, off))
    };
    for j in 1..=DEGREE {
        let (end, off) = advance(&states[j - 1], [nodes.place(j - 1), nodes.place(j)])?;
        flow.iter_mut().zip(off).for_each(|(flow, off)| *flow += off);
        states.push(end);
    }
    let rounded: Vec<Vec<f64>> =
        states.iter().map(|state| state.iter().map(|x| x.to_f64()).collect()).collect();
    let mut interpolation = vec![0.0_f64; start.len()];
    let mut between = vec![0.0; start.len()];
    // Near both ends and in the middle.
    for j in [0, DEGREE / 2, DEGREE - 1] {
        let place = 0.5 * (nodes.place(j) + nodes.place(j + 1));
        let (exact, _) = advance(&states[j], [nodes.place(j), place])?;
        nodes.interpolate(place, &rounded, &mut between);
        for ((worst, exact), x) in interpolation.iter_mut().zip(&exact).zip(&between) {
            *worst = worst.max((exact.to_f64() - x).abs());
        }
    }
    Some(Trial { nodes: states, interpolation, flow })
}
