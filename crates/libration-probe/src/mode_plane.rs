//! The figure of the modes.

use core::f64::consts::TAU;

use libration_report::figure::{Axis, Figure, Mark, Panel};

use crate::rate_ranges::rate_ranges;
use crate::{ProbeReport, ProbedMode, Rates};

/// Points of the unit circle.
const CIRCLE: usize = 361;

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
