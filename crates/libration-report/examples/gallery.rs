//! A page with every kind of mark: `cargo run -p libration-report --example gallery -- gallery.html`.
//! With a second argument, each figure also becomes a file in that folder.

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::path::Path;

use libration_report::figure::{
    Axis, ColorMap, Colors, Envelope, Figure, Grid, Mark, Marker, Panel, Role, embed, scripts, svg,
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let page = arguments.next().ok_or("give the path of the page")?;
    let figures = [order(), drift(), portraits(), stability(), band(), sweep(), tiny()];
    let mut html = String::from(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <title>Gallery of figures</title><style>html{background:var(--page);color:var(--ink)}\
         body{margin:0 auto;max-width:880px;padding:24px}</style></head><body>\n",
    );
    for figure in &figures {
        html.push_str(&embed(figure));
    }
    write!(html, "{}</body></html>", scripts())?;
    std::fs::write(page, html)?;
    if let Some(folder) = arguments.next() {
        std::fs::create_dir_all(&folder)?;
        for figure in &figures {
            let file = Path::new(&folder).join(&figure.id).with_extension("svg");
            std::fs::write(file, svg::standalone(figure))?;
        }
    }
    Ok(())
}

fn even(from: f64, to: f64, count: u32) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * f64::from(i) / f64::from(count - 1)).collect()
}

fn decades(from: f64, to: f64, count: u32) -> Vec<f64> {
    even(from, to, count).into_iter().map(|e| 10_f64.powf(e)).collect()
}

/// Lines and points on two logarithmic axes: the order of each method.
fn order() -> Figure {
    let steps = decades(-4.0, -0.3, 60);
    let few = decades(-4.0, -0.5, 15);
    let methods = [
        ("explicit Euler", Role::ExplicitEuler, 1, 3.0),
        ("symplectic Euler", Role::SymplecticEuler, 1, 1.2),
        ("velocity Verlet", Role::VelocityVerlet, 2, 0.4),
        ("Yoshida 4", Role::Yoshida4, 4, 0.6),
        ("RK4", Role::Rk4, 4, 0.2),
    ];
    let error = |h: f64, p: i32, c: f64| c * h.powi(p) + 3e-16 / h;
    let lines = methods.map(|(name, ink, p, c)| {
        let y: Vec<f64> = steps.iter().map(|&h| error(h, p, c)).collect();
        Mark::line(steps.clone(), y).role(ink).label(name)
    });
    let predicted = methods.map(|(_, _, p, c)| {
        let y: Vec<f64> = few.iter().map(|&h| c * h.powi(p)).collect();
        Mark::prediction(few.clone(), y).label("predicted, without rounding")
    });
    let panel = Panel::new(
        Axis::log("time step Δt").unit("s"),
        Axis::log("position error after 10 s").unit("m").range(1e-16, 10.0),
    );
    Figure::new("fig-9-2", "RK4 stops gaining at Δt = 10⁻³ s, where rounding takes over.")
        .number("9.2")
        .caption(
            "Coloured: measured. Circles: the order of each method. ωΔt < 10^{-3} gains nothing.",
        )
        .description(
            "Log-log: five error curves with slopes one, two and four; rounding bends them up.",
        )
        .panel(panel.marks(lines).marks(predicted))
}

/// A line that leaves the frame, lines that end inside, close labels, a rule.
fn drift() -> Figure {
    let n = decades(0.0, 6.0, 200);
    let of = |f: &dyn Fn(f64) -> f64| n.iter().map(|&n| f(n)).collect::<Vec<f64>>();
    let methods = [
        ("explicit Euler", Role::ExplicitEuler, of(&|n| (1e-3 * n).exp() - 1.0 + 1e-3)),
        ("symplectic Euler", Role::SymplecticEuler, of(&|n| 1.6e-2 * (1.0 - (-n / 20.0).exp()))),
        ("velocity Verlet", Role::VelocityVerlet, of(&|n| 2.5e-4 * (1.0 - (-n / 20.0).exp()))),
        ("leapfrog", Role::Leapfrog, of(&|n| 2.2e-4 * (1.0 - (-n / 25.0).exp()))),
        ("textbook Verlet", Role::TextbookVerlet, of(&|n| 1.1e-4 * (1.0 - (-n / 15.0).exp()))),
        ("RK4", Role::Rk4, of(&|n| 1.4e-11 * n)),
    ];
    let panel = Panel::new(
        Axis::log("steps n (Δt = 0.01, ω² = 10)"),
        Axis::log("max |E − E₀| / E₀ so far").range(1e-12, 100.0),
    )
    .marks(methods.map(|(name, ink, y)| Mark::line(n.clone(), y).role(ink).label(name)))
    .mark(Mark::horizontal(1e-2).role(Role::Bad).label("1 % of the energy"));
    Figure::new("fig-9-1", "RK4 loses energy, but slower than Verlet's band for 18 million steps.")
        .number("9.1")
        .caption("Largest relative drift so far. Start (1, 0).")
        .description(
            "Explicit Euler explodes, three methods stay flat, RK4 grows in proportion to n.",
        )
        .panel(panel)
}

/// Four panels with equal scales; the marks share one legend.
fn portraits() -> Figure {
    let angle = even(0.0, 6.0 * TAU, 600);
    let spiral = |rate: f64, squeeze: f64| -> (Vec<f64>, Vec<f64>) {
        let radius = |a: f64| (rate * a).exp();
        let x = angle.iter().map(|&a| radius(a) * a.cos()).collect();
        (x, angle.iter().map(|&a| radius(a) * (squeeze * a.cos() - a.sin())).collect())
    };
    let exact = even(0.0, TAU, 60);
    let methods = [
        ("explicit Euler", Role::ExplicitEuler, 0.02, 0.0),
        ("symplectic Euler", Role::SymplecticEuler, 0.0, 0.35),
        ("velocity Verlet", Role::VelocityVerlet, 0.0, 0.03),
        ("RK4", Role::Rk4, -0.004, 0.0),
    ];
    let panels = methods.map(|(name, ink, rate, squeeze)| {
        let (x, y) = spiral(rate, squeeze);
        let circle: [Vec<f64>; 2] =
            [exact.iter().map(|a| a.cos()).collect(), exact.iter().map(|a| a.sin()).collect()];
        let [cx, cy] = circle;
        Panel::new(Axis::linear("position x").unit("m"), Axis::linear("velocity v/ω").unit("m"))
            .title(name)
            .equal()
            .mark(Mark::line(x, y).role(ink).width(1.6))
            .mark(Mark::prediction(cx, cy).radius(2.0).label("exact orbit"))
    });
    let mut figure = Figure::new("portraits", "Only the symplectic methods close their orbits.")
        .caption("Six turns at ωΔt = 0.3.")
        .description("Four phase portraits: one spirals out, two close, one spirals slowly in.")
        .columns(2)
        .aspect(1.25);
    figure.panels = panels.into();
    figure
}

/// A raster with a colour bar, contour lines over it, a note; beside it contours and a region.
fn stability() -> Figure {
    let (x, y) = (even(0.02, 3.0, 150), even(0.0, 1.5, 90));
    let growth = |z: f64, d: f64| {
        let (re, im) = (1.0 - d * z / 2.0 - z * z / 2.0 + z.powi(4) / 24.0, z - z.powi(3) / 6.0);
        re.hypot(im)
    };
    let grid = Grid::sample(x.clone(), y.clone(), growth);
    let blank = Grid::sample(x, y, |z, d| if z > 2.6 && d < 0.3 { f64::NAN } else { growth(z, d) });
    let colors = Colors::new("growth per step |λ|").log().range(0.5, 2.0).map(ColorMap::Diverging);
    let left = Panel::new(Axis::linear("ωΔt"), Axis::linear("damping ζ"))
        .title("growth per step")
        .mark(Mark::raster(blank, colors))
        .mark(Mark::contour(grid.clone(), [1.0]).role(Role::Theory).label("|λ| = 1"));
    let side = even(-1.6, 1.6, 65);
    let saddle = Grid::sample(side.clone(), side, |x, y| x * x * x - x - y * y + 0.3 * y);
    let right = Panel::new(Axis::linear("x"), Axis::linear("y"))
        .title("levels")
        .mark(
            Mark::region([-1.5, -0.3, -0.3, -1.5], [-1.5, -1.5, -0.9, -0.9])
                .role(Role::Bad)
                .label("forbidden"),
        )
        .mark(Mark::contour(saddle, [-2.0, -1.0, -0.5, 0.0, 0.3]).role(Role::Accent(0)))
        .mark(Mark::note(-0.9, 1.42, "x³ − x − y²"));
    Figure::new("stability", "Damping moves the limit of RK4 beyond 2√2 only a little.")
        .caption("White and the line: neither growth nor decay. Blank: not computed.")
        .description("A map of growth over step and damping, and contour lines of a saddle.")
        .columns(2)
        .aspect(1.1)
        .panel(left)
        .panel(right)
}

/// A million samples as an envelope, and what a hidden beat looks like.
fn band() -> Figure {
    let t: Vec<f64> = (0..1_000_000).map(|i| f64::from(i) * 0.01).collect();
    let slow = |t: f64| 1.0 + 0.4 * (t * TAU / 9000.0).sin();
    let beat: Vec<f64> = t
        .iter()
        .map(|&t| if (4000.0..4400.0).contains(&t) { f64::NAN } else { slow(t) * (3.1 * t).sin() })
        .collect();
    let mean: Vec<f64> = t.iter().step_by(5000).map(|&t| 0.3 * (t / 1500.0).cos()).collect();
    let panel =
        Panel::new(Axis::linear("time t").unit("s"), Axis::linear("energy error ΔE").unit("µJ"))
            .mark(
                Mark::envelope(Envelope::of(&t, &beat, 600))
                    .role(Role::SymplecticEuler)
                    .label("symplectic Euler"),
            )
            .mark(
                Mark::line(t.iter().step_by(5000).copied().collect::<Vec<f64>>(), mean)
                    .role(Role::Rk4)
                    .label("mean"),
            )
            .mark(Mark::vertical(7500.0).label("restart"))
            .mark(Mark::horizontal(0.0).width(0.8));
    Figure::new(
        "band",
        "The error of a million steps stays in a band that breathes with a period of 9000 s.",
    )
    .caption("Smallest and largest value in each of 600 intervals. The gap: no data.")
    .description("A band around zero whose width varies slowly, with a gap near 4000 s.")
    .aspect(2.4)
    .panel(panel)
}

/// Two panels with all markers and accents; labels in the legend and on lines.
fn sweep() -> Figure {
    let x = even(0.5, 10.0, 12);
    let markers = [
        (Marker::Circle, "f64"),
        (Marker::Square, "f32"),
        (Marker::Diamond, "f16"),
        (Marker::Triangle, "bf16"),
        (Marker::Cross, "double-double"),
        (Marker::Plus, "fixed point"),
    ];
    let points = markers.iter().zip(0..).map(|((marker, name), i)| {
        let y: Vec<f64> =
            x.iter().map(|x| f64::from(i) + (x / 2.0 + f64::from(i)).sin() * 0.4).collect();
        Mark::points(x.clone(), y).role(Role::Accent(i)).marker(*marker).radius(4.0).label(*name)
    });
    let phase = even(0.0, 2.0 * PI, 100);
    let lines = (0..5).map(|i| {
        let y: Vec<f64> = phase.iter().map(|p| p.sin() * (1.0 + f64::from(i) * 0.05)).collect();
        Mark::line(phase.clone(), y).role(Role::Accent(i)).label(format!("lane {i}"))
    });
    Figure::new("sweep", "Number formats and lanes can be told apart without colour.")
        .caption("A caption with </script> and <b>, which must stay text.")
        .description("Left: six kinds of points. Right: five dashed lines that end together.")
        .columns(2)
        .aspect(1.2)
        .panel(Panel::new(Axis::linear("load").unit("MB/s"), Axis::linear("offset")).marks(points))
        .panel(
            Panel::new(Axis::linear("phase φ").unit("rad"), Axis::linear("x").unit("m"))
                .marks(lines),
        )
}

/// A logarithmic axis over the whole range of f64.
fn tiny() -> Figure {
    let t = even(0.0, 100.0, 400);
    let y: Vec<f64> = t.iter().map(|t| (-6.9 * t).exp()).collect();
    let with_gap: Vec<f64> =
        t.iter().map(|&t| if (30.0..40.0).contains(&t) { 0.0 } else { (-1.5 * t).exp() }).collect();
    Figure::new("tiny", "Damped energy falls through 300 decades without a floor.")
        .caption("Zeros between 30 s and 40 s are a gap, not a floor.")
        .description("Two straight lines on a logarithmic axis that reaches 10 to the minus 300.")
        .panel(
            Panel::new(Axis::linear("time t").unit("s"), Axis::log("energy E").unit("J"))
                .mark(Mark::line(t.clone(), y).role(Role::VelocityVerlet).label("strong damping"))
                .mark(Mark::line(t, with_gap).role(Role::Rk4).label("weak damping")),
        )
}
