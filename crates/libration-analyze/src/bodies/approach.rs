//! The nearest approach of two bodies within a step.

/// Bodies up to which all pairs are looked at in each step.
pub const ENCOUNTERS_AT_EACH_STEP: usize = 16;

/// A point or vector.
pub(super) type Vector = [f64; 3];

/// The relative error of a distance at which the search ends.
const CLOSE: f64 = 1e-4;

/// Halvings of a step after which the search ends: at a millionth of the step.
const MOST_HALVINGS: u32 = 20;

/// The least distance of two bodies within a step and the part of the step until then, if it is less than `below`.
///
/// From relative positions and velocities at both ends: the cubic Hermite curve, as a Bézier curve that is halved. A part of it is no
/// farther from its chord than ¾ of the largest distance of its inner control points from the thirds of the chord.
pub(super) fn nearest(
    [place, speed]: [Vector; 2],
    [last, last_speed]: [Vector; 2],
    length: f64,
    below: f64,
) -> Option<(f64, f64)> {
    let inner: Vector = core::array::from_fn(|k| place[k] + length / 3.0 * speed[k]);
    let outer: Vector = core::array::from_fn(|k| last[k] - length / 3.0 * last_speed[k]);
    // All of the curve is within its control points: most pairs are too far apart.
    let farthest = [inner, outer, last].map(|point| {
        let way = minus(point, place);
        dot(way, way)
    });
    let farthest = farthest.into_iter().fold(0.0, f64::max);
    if size(place) - farthest.sqrt() > below {
        return None;
    }
    let mut best = (below, f64::NAN);
    search(&[place, inner, outer, last], [0.0, 1.0], MOST_HALVINGS, &mut best);
    (best.0 < below).then_some(best)
}

fn search(curve: &[Vector; 4], [from, to]: [f64; 2], halvings: u32, best: &mut (f64, f64)) {
    let chord = |part: f64| between(curve[0], curve[3], part);
    let off = [1, 2].map(|k: usize| size(minus(curve[k], chord(k as f64 / 3.0))));
    let deviation = 0.75 * off[0].max(off[1]);
    let along = minus(curve[3], curve[0]);
    let square = dot(along, along);
    let part = if square > 0.0 { (-dot(curve[0], along) / square).clamp(0.0, 1.0) } else { 0.0 };
    let of_chord = size(chord(part));
    let least = of_chord - deviation;
    if least.is_nan() || least >= best.0 {
        return;
    }
    let at = size(halves(curve, part)[0][3]);
    if at < best.0 {
        *best = (at, from + part * (to - from));
    }
    if halvings == 0 || deviation <= CLOSE * of_chord {
        return;
    }
    let [first, second] = halves(curve, 0.5);
    let middle = 0.5 * (from + to);
    search(&first, [from, middle], halvings - 1, best);
    search(&second, [middle, to], halvings - 1, best);
}

/// The two parts of a Bézier curve (P. de Casteljau, 1959).
fn halves([a, b, c, d]: &[Vector; 4], part: f64) -> [[Vector; 4]; 2] {
    let [ab, bc, cd] = [between(*a, *b, part), between(*b, *c, part), between(*c, *d, part)];
    let [abc, bcd] = [between(ab, bc, part), between(bc, cd, part)];
    let middle = between(abc, bcd, part);
    [[*a, ab, abc, middle], [middle, bcd, cd, *d]]
}

fn between(a: Vector, b: Vector, part: f64) -> Vector {
    core::array::from_fn(|k| (1.0 - part) * a[k] + part * b[k])
}

pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    core::array::from_fn(|k| a[k] - b[k])
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn size(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_pass_has_its_impact_parameter_as_distance() {
        // From x = -1 with speed 2 over a length of 1.5: nearest to the origin at half of a unit of time, a third of the step.
        let ends = |x: f64| [[x, 0.03, 0.04], [2.0, 0.0, 0.0]];
        let (distance, part) = nearest(ends(-1.0), ends(2.0), 1.5, f64::INFINITY).unwrap();
        assert!(
            (distance - 0.05).abs() < 1e-12 && (part - 1.0 / 3.0).abs() < 1e-6,
            "{distance} {part}"
        );
        assert_eq!(nearest(ends(-1.0), ends(2.0), 1.5, 0.05 - 1e-9), None);
    }

    #[test]
    fn a_curved_pass_has_the_least_distance_of_its_cubic() {
        // x = t, y = a (t - 1/2)² - b on [0, 1]: a parabola is its own Hermite curve. By a fine grid.
        let (a, b) = (8.0, 0.3);
        let at = |t: f64| [t - 0.5, a * (t - 0.5).powi(2) - b, 0.0];
        let speed = |t: f64| [1.0, 2.0 * a * (t - 0.5), 0.0];
        let (distance, _) =
            nearest([at(0.0), speed(0.0)], [at(1.0), speed(1.0)], 1.0, f64::INFINITY).unwrap();
        let grid = (0..=100_000).map(|k| size(at(f64::from(k) * 1e-5))).fold(1.0, f64::min);
        // The search ends within a ten-thousandth, and the grid is within 1e-5 times the largest speed.
        assert!((distance - grid).abs() < 2e-4 * grid, "{distance} {grid}");
    }
}
