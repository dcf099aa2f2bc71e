//! The figure of the modes.

use core::f64::consts::TAU;

use libration_report::figure::{Axis, Figure, Mark, Panel};

use crate::{ProbeReport, ProbedMode, Rates};

/// Points of the unit circle.
const CIRCLE: usize = 361;

/// Least growth rate at the end of its axis relative to the fastest rate `|s|` of a mode: a damping ratio of 5 % fills the axis, and one
/// of 0.1 % can still be seen. Roundings are far below.
const LEAST_GROWTH: f64 = 0.05;

/// Least rate in units of `1/dt` that counts as the fastest one. That of a free mass is the root of a rounding, 1e-8.
const LEAST_RATE: f64 = 1e-4;

/// The modes in the complex plane, of the step and of the flow.
pub(crate) fn mode_plane(audit: &ProbeReport) -> Figure {
    let both = |z: [f64; 2]| [z, [z[0], -z[1]]];
    let step: Vec<[f64; 2]> = audit.modes.iter().flat_map(|mode| both(mode.factor)).collect();
    let of_flow = |mode: &ProbedMode| {
        let flow = mode.flow?;
        let angle = TAU * flow.frequency * audit.dt;
        let radius = (flow.growth_rate * audit.dt).exp();
        Some(both([radius * angle.cos(), radius * angle.sin()]))
    };
    let flow: Vec<[f64; 2]> = audit.modes.iter().filter_map(of_flow).flatten().collect();
    let part = |points: &[[f64; 2]], k: usize| points.iter().map(|z| z[k]).collect::<Vec<f64>>();
    let circle = |k: usize| -> Vec<f64> {
        let turn = |i: usize| TAU * i as f64 / (CIRCLE - 1) as f64;
        (0..CIRCLE).map(|i| if k == 0 { turn(i).cos() } else { turn(i).sin() }).collect()
    };
    let reach = step.iter().flatten().fold(1.15_f64, |most, x| most.max(1.1 * x.abs()));
    let axis = |label: &str| Axis::linear(label).range(-reach, reach);
    let mut panel = Panel::new(axis("Re z"), axis("Im z"))
        .mark(Mark::line(circle(0), circle(1)).label("unit circle"))
        .mark(Mark::points(part(&step, 0), part(&step, 1)).label("step"));
    if !flow.is_empty() {
        panel = panel.mark(Mark::prediction(part(&flow, 0), part(&flow, 1)).label("system"));
    }
    let of_step = rates(audit, |mode| Some(mode.step));
    let of_flow = rates(audit, |mode| mode.flow);
    let [growth, frequency] = rate_ranges(&[&of_step, &of_flow], audit.dt);
    let part = |rates: &[Rates], of: fn(&Rates) -> f64| rates.iter().map(of).collect::<Vec<f64>>();
    let both = |rates: &[Rates]| (part(rates, |r| r.growth_rate), part(rates, |r| r.frequency));
    let [low, high] = growth;
    let horizontal = Axis::linear("growth rate").unit("1/s").range(low, high);
    let [low, high] = frequency;
    let vertical = Axis::linear("frequency").unit("Hz").range(low, high);
    let (x, y) = both(&of_step);
    let mut slow = Panel::new(horizontal, vertical)
        .mark(Mark::vertical(0.0).label("neither grows nor decays"))
        .mark(Mark::points(x, y).label("step"));
    if !of_flow.is_empty() {
        let (x, y) = both(&of_flow);
        slow = slow.mark(Mark::prediction(x, y).label("system"));
    }
    let circles = if of_flow.is_empty() { "" } else { " Circles: the system." };
    Figure::new("modes-plane", "Modes of the step and of the system")
        .caption(format!(
            "Points: the step.{circles} Left: factors per step; outside the unit circle a mode grows. Right: the same as rates."
        ))
        .columns(2)
        .aspect(1.0)
        .panel(panel)
        .panel(slow)
}

/// The finite rates of all modes.
fn rates(audit: &ProbeReport, of: impl Fn(&ProbedMode) -> Option<Rates>) -> Vec<Rates> {
    audit.modes.iter().filter_map(of).filter(|rates| rates.growth_rate.is_finite()).collect()
}

/// Ranges of growth rates and of frequencies that show all rates, with a margin, but never roundings alone.
fn rate_ranges(all: &[&[Rates]], dt: f64) -> [[f64; 2]; 2] {
    const MARGIN: f64 = 0.08;
    let all = || all.iter().copied().flatten();
    let size = |rates: &Rates| rates.growth_rate.hypot(TAU * rates.frequency);
    let fastest = all().map(size).fold(LEAST_RATE / dt, f64::max);
    let least = LEAST_GROWTH * fastest;
    let low = all().map(|rates| rates.growth_rate).fold(0.0, f64::min);
    let high = all().map(|rates| rates.growth_rate).fold(0.0, f64::max);
    let margin = MARGIN * (high - low);
    let growth = [(low - margin).min(-least), (high + margin).max(least)];
    let top = all().map(|rates| rates.frequency).fold(least / TAU, f64::max);
    [growth, [-MARGIN / 2.0 * top, (1.0 + MARGIN) * top]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(growth_rate: f64, frequency: f64) -> Rates {
        Rates { growth_rate, frequency, damping_ratio: None }
    }

    #[test]
    fn an_axis_never_shows_roundings_alone() {
        // Nothing is damped: the axis shows a damping ratio of 5 %.
        let [[low, high], [_, top]] = rate_ranges(&[&[rate(1e-13, 2.0), rate(0.0, 0.5)]], 0.01);
        assert_eq!((low, high), (-LEAST_GROWTH * TAU * 2.0, LEAST_GROWTH * TAU * 2.0));
        assert!(top > 2.0 && top < 2.5, "{top}");
        // A free mass, whose factors are 1 up to the root of a rounding.
        let [[low, high], [_, top]] = rate_ranges(&[&[rate(1e-6, 2e-7)], &[]], 0.01);
        assert!(high >= 5e-4 && low == -high && top >= 5e-4 / TAU, "{low} {high} {top}");
        // A slow mode beside a fast one that decays: both are inside, and so is zero.
        let [[low, high], [bottom, top]] =
            rate_ranges(&[&[rate(-190.0, 50.0)], &[rate(-0.1, 1.4)]], 0.002);
        assert!(
            low < -190.0
                && low > -220.0
                && high > 10.0
                && high < 40.0
                && bottom < 0.0
                && top > 50.0
        );
    }
}
