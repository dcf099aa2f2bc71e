//! The chapter on one step.

use libration::Method;
use libration_report::figure::{Axis, ColorMap, Colors, Dash, Figure, Grid, Mark, Panel, Role};
use libration_report::notation::{list, number};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

use super::region::{IMAGINARY, REAL};
use crate::method_color::method_color;
use crate::subject::Symmetry;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "One step".into();
    let limit = |m: Method| record.finding(&format!("spectrum.{}.imaginary-limit", m.name())).ok();
    let shown: Vec<(Method, f64)> =
        Method::ALL.into_iter().filter_map(|m| Some((m, limit(m)?.measured))).collect();
    let described: Vec<String> = shown
        .iter()
        .map(|&(m, z)| match z {
            0.0 => format!("{} none", m.title()),
            z => format!("{} up to ωΔt = {}", m.title(), number(z, 6)),
        })
        .collect();
    page.answer = format!("Largest time step with bounded orbits: {}.", described.join("; "));
    if let Some((method, z)) = shown.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        page.highlights.push(Highlight {
            value: number(*z, 5),
            text: format!("largest stable ωΔt: {}", method.title()),
        });
    }
    page.paragraph(
        "An integrator is generic over its number type. With polynomials in z = ωΔt as numbers, \
         the shipped steps (the code that also runs the simulations) return their update matrices \
         in exact fractions:",
    );
    page.table(record.table("update matrices")?, 6);
    page.paragraph(
        "The numbers below come from the same steps with 1024 bits in place of 53, without \
         cancellation. A determinant of one preserves areas of phase space; a zero defect of \
         `M(−Δt)M(Δt) − 1` means time reversibility. These are different properties.",
    );
    page.table(record.table("one step")?, 4);
    page.figure(phase_errors(record)?);
    page.paragraph(
        "The stability of a step depends on the mode, damped or undamped. The maps show the \
         spectral radius of each shipped step on a mode with eigenvalues λ and λ̄. It is |R(λΔt)| \
         for a Runge–Kutta method; split steps have a spectral radius, but no stability function R. \
         Orbits decay inside the contour and grow outside it.",
    );
    page.figure(regions(record, &shown)?);
    actions(&shown, page);
    Ok(())
}

/// Which integrators to avoid, and the largest step of the reader's system.
fn actions(shown: &[(Method, f64)], page: &mut Page) {
    let usable = shown.iter().filter(|(_, z)| *z > 0.0).max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((method, _)) = usable {
        page.action(format!(
            "Find the largest stable step of {} for your system: `libration analyze --system FILE --integrator {} --dt 0.01`.",
            method.title(),
            method.name()
        ));
    }
    let never: Vec<&str> =
        shown.iter().filter(|(_, z)| *z == 0.0).map(|(m, _)| m.title()).collect();
    if !never.is_empty() {
        page.action(format!(
            "Do not use {} for motion without damping: no time step keeps it bounded.",
            list(&never)
        ));
    }
}

/// Phase error against the step, prediction over measurement.
fn phase_errors(record: &Record) -> Result<Figure, RecordError> {
    let mut panel =
        Panel::new(Axis::log("z = ωΔt"), Axis::log("|phase error| per step").unit("rad"));
    let mut shown = Vec::new();
    for series in record.series.iter().filter(|s| s.name.starts_with("sweep-")) {
        let name = &series.name["sweep-".len()..];
        let Some(method) = Method::from_name(name) else { continue };
        shown.push(method);
        let z = series.column("z")?;
        let size = |column: &str| -> Result<Vec<f64>, RecordError> {
            Ok(series.column(column)?.iter().map(|x| x.abs()).collect())
        };
        let line = Mark::line(z, size("phase_error_measured")?);
        panel = panel
            .mark(line.role(method_color(method)).label(method.title()))
            .mark(Mark::prediction(z, size("phase_error_predicted")?));
    }
    Ok(Figure::new("phase-error", "Phase error of one step against the size of the step")
        .caption(format!(
            "{}Lines: measured, from the angle after thousands of steps. Circles: predicted \
             from the step.",
            phases(&shown)
        ))
        .description(powers(&shown))
        .panel(panel))
}

/// Returns a sentence about the phase errors of the methods in the figure.
fn phases(shown: &[Method]) -> String {
    let mut words = String::new();
    if [Method::SymplecticEuler, Method::VelocityVerlet].iter().all(|m| shown.contains(m)) {
        words += "Symplectic Euler and velocity Verlet lead by z³/24: they have the \
                  same eigenvalues. ";
    }
    if shown.contains(&Method::Rk4) {
        words += "RK4 lags by z⁵/120. ";
    }
    words
}

/// The powers of `z` with which phase errors rise: the third for orders one and two, the fifth for
/// order four.
fn powers(shown: &[Method]) -> String {
    let of = |orders: std::ops::RangeInclusive<u32>| {
        let methods = shown.iter().filter(|m| orders.contains(&m.order()));
        list(&methods.map(|m| m.title()).collect::<Vec<_>>())
    };
    let rises = [(of(1..=2), "third"), (of(4..=4), "fifth")];
    let rises = rises.iter().filter(|(methods, _)| !methods.is_empty());
    let parts: Vec<String> =
        rises.map(|(methods, power)| format!("that of {methods} with the {power} power")).collect();
    format!("Log-log: the phase error against z. It rises: {}.", parts.join(", "))
}

/// Returns a sentence about the stable part of the imaginary axis, from the measured limits.
fn pieces(shown: &[(Method, f64)]) -> String {
    let mut words = "The contour is ρ = 1.".to_owned();
    if shown.iter().any(|&(m, z)| m == Method::ExplicitEuler && z == 0.0) {
        words += " The disc of explicit Euler touches the imaginary axis only at the origin.";
    }
    let up_to = |(m, z): &(Method, f64)| format!("{} up to ωΔt = {}", m.title(), number(*z, 4));
    let of = |symplectic: bool| {
        let some =
            shown.iter().filter(|(m, z)| Symmetry::of_method(*m).0 == symplectic && *z > 0.0);
        some.map(up_to).collect::<Vec<_>>().join(", ")
    };
    let (symplectic, others) = (of(true), of(false));
    if !others.is_empty() {
        words += &format!(" Non-symplectic, stable on part of the imaginary axis: {others}.");
    }
    if !symplectic.is_empty() {
        words += &format!(" Symplectic, with ρ = 1 on part of the imaginary axis: {symplectic}.");
    }
    if shown.iter().any(|&(_, z)| z > 0.0) {
        words += " The bar marks the stable part, measured by simulation.";
    }
    words
}

/// Maps of the spectral radius, one a method.
fn regions(record: &Record, shown: &[(Method, f64)]) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("stability-regions", "Stability regions")
        .caption(pieces(shown))
        .description("Maps of the spectral radius over the complex plane of λΔt.")
        .columns(2)
        .aspect((REAL[1] - REAL[0]) / (IMAGINARY[1] - IMAGINARY[0]));
    for &(method, limit) in shown {
        let series = record.series(&format!("region-{}", method.name()))?;
        let radius = series.column("radius")?;
        let side = (radius.len() as f64).sqrt() as usize;
        let x: Vec<f64> = series.column("re")?[..side].to_vec();
        let y: Vec<f64> = series.column("im")?.iter().step_by(side).copied().collect();
        let exact: Vec<f64> = radius.iter().map(|r| r.log10().clamp(-1.0, 1.0)).collect();
        // The contour needs all digits, the colours no more than can be seen.
        let seen = exact.iter().map(|r| (r * 100.0).round() / 100.0).collect();
        let raster = Grid { x: x.clone(), y: y.clone(), z: seen };
        let grid = Grid { x, y, z: exact };
        let mut panel = Panel::new(
            Axis::linear("Re λΔt").range(REAL[0], REAL[1]),
            Axis::linear("Im λΔt").range(IMAGINARY[0], IMAGINARY[1]),
        )
        .title(method.title())
        .mark(Mark::raster(
            raster,
            Colors::new("log₁₀ ρ").map(ColorMap::Diverging).range(-1.0, 1.0),
        ))
        .mark(Mark::contour(grid, [0.0]).role(Role::Theory))
        .mark(Mark::vertical(0.0).role(Role::Neutral).width(0.8));
        if limit > 0.0 {
            panel = panel.mark(
                Mark::line([0.0, 0.0], [-limit, limit])
                    .role(method_color(method))
                    .dash(Dash::Solid)
                    .width(3.4),
            );
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_speak_of_the_methods_that_are_shown_and_of_no_others() {
        let limits = [(Method::VelocityVerlet, 2.0), (Method::Yoshida4, 1.573_401_9)];
        let caption = pieces(&limits);
        assert!(caption.contains("velocity Verlet up to ωΔt = 2, Yoshida"), "{caption}");
        assert!(caption.contains("ωΔt = 1.573.") && !caption.contains("Euler"), "{caption}");
        assert!(!pieces(&[(Method::ExplicitEuler, 0.0)]).contains("bar"));
        assert_eq!(phases(&[Method::SymplecticEuler]), "");
        let both = powers(&[Method::Leapfrog, Method::Rk4]);
        assert!(
            both.ends_with(
                "that of leapfrog with the third power, that of RK4 with the fifth power."
            ),
            "{both}"
        );
    }
}
