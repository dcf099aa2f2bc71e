//! The chapter on one step.

use libration::Method;

use super::region::{IMAGINARY, REAL};
use crate::figure::{Axis, ColorMap, Colors, Dash, Figure, Grid, Ink, Mark, Panel};
use crate::notation::number;
use crate::page::{Highlight, Page};
use crate::record::{Record, RecordError};
use crate::studies::ink::ink;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "One step".into();
    let limit = |m: Method| record.finding(&format!("spectrum.{}.imaginary-limit", m.name())).ok();
    let shown: Vec<(Method, f64)> =
        Method::ALL.into_iter().filter_map(|m| Some((m, limit(m)?.measured))).collect();
    let described: Vec<String> = shown
        .iter()
        .map(|&(m, z)| match z {
            0.0 => format!("{} none at all", m.title()),
            z => format!("{} up to ωΔt = {}", m.title(), number(z, 6)),
        })
        .collect();
    page.answer =
        format!("How large a step keeps an oscillator bounded: {}.", described.join("; "));
    if let Some((method, z)) = shown.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        page.highlights.push(Highlight {
            value: number(*z, 5),
            text: format!("largest stable ωΔt: {}", method.title()),
        });
    }
    page.paragraph(
        "An integrator is a function of a number type. Run on polynomials in z = ωΔt, the shipped \
         steps print their own update matrices, in exact fractions:",
    );
    page.table(record.table("update matrices")?, 6);
    page.paragraph(
        "With 1024 bits in place of 53 the same steps tell what follows from them, free of \
         cancellation. A determinant of one keeps areas of phase space, a defect of zero in \
         `M(−Δt)M(Δt) − 1` makes a method reversible; the two are not the same.",
    );
    page.table(record.table("one step")?, 4);
    page.figure(phase_errors(record)?);
    page.paragraph(
        "Where a step is stable is a question about modes, damped and undamped. The maps show the \
         spectral radius of each shipped step on a mode with eigenvalues λ and λ̄: it is |R(λΔt)| \
         for a Runge–Kutta method, and it exists as well for the split steps, which have no such \
         function. Orbits decay within the contour and grow outside it.",
    );
    page.figure(regions(record, &shown)?);
    Ok(())
}

/// Phase error against the step, prediction over measurement.
fn phase_errors(record: &Record) -> Result<Figure, RecordError> {
    let mut panel =
        Panel::new(Axis::log("z = ωΔt"), Axis::log("|phase error| of a step").unit("rad"));
    for series in record.series.iter().filter(|s| s.name.starts_with("sweep-")) {
        let name = &series.name["sweep-".len()..];
        let Some(method) = Method::from_name(name) else { continue };
        let z = series.column("z")?;
        let size = |column: &str| -> Result<Vec<f64>, RecordError> {
            Ok(series.column(column)?.iter().map(|x| x.abs()).collect())
        };
        let line = Mark::line(z, size("phase_error_measured")?);
        panel = panel
            .mark(line.ink(ink(method)).label(method.title()))
            .mark(Mark::prediction(z, size("phase_error_predicted")?));
    }
    Ok(Figure::new("phase-error", "Phase error of one step against the size of the step")
        .caption(
            "Symplectic Euler and velocity Verlet turn alike, by z³/24 too far: they have the same \
             eigenvalues. RK4 lags by z⁵/120. Lines are measured, from the angle after thousands of \
             steps; circles are predicted from the step.",
        )
        .description(
            "Log-log: the phase error of explicit Euler, symplectic Euler and velocity Verlet rises \
             with the third power of z, that of RK4 with the fifth.",
        )
        .panel(panel))
}

/// Maps of the spectral radius, one a method.
fn regions(record: &Record, shown: &[(Method, f64)]) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("stability-regions", "Where a step is stable")
        .caption(
            "The contour is ρ = 1. Explicit Euler’s disc touches the imaginary axis at the origin \
             alone; the region of RK4 takes in a piece of it, as those of the symplectic methods \
             do: on the axis they have ρ = 1 exactly, up to ωΔt = 2. The bar marks the stable piece \
             of the axis, measured by simulation.",
        )
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
        .mark(Mark::contour(grid, [0.0]).ink(Ink::Theory))
        .mark(Mark::vertical(0.0).ink(Ink::Neutral).width(0.8));
        if limit > 0.0 {
            panel = panel.mark(
                Mark::line([0.0, 0.0], [-limit, limit])
                    .ink(ink(method))
                    .dash(Dash::Solid)
                    .width(3.4),
            );
        }
        figure = figure.panel(panel);
    }
    Ok(figure)
}
