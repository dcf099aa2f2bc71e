//! The chapter on clocks of different rates.

use libration_report::figure::{Axis, Figure, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Record, RecordError};

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Clocks of different rates".into();
    let found = |id: &str| record.finding(id).ok().map(|f| f.measured);
    let foreseen = |id: &str| record.finding(id).ok().and_then(|f| f.predicted);
    if let Some((gaussian, uniform)) =
        foreseen("asynchrony.gaussian.steps").zip(foreseen("asynchrony.uniform.steps"))
    {
        page.answer = format!(
            "At Δt = 10 ms and clock rates with an rms of 1 % the mean of an ensemble falls to 1/e \
             in {} steps for Gaussian and {} steps for uniform rates (theory); measured: {} and \
             {}. The energy stays bounded. A trajectory is stable if the time step of its own \
             clock is stable.",
            number(gaussian, 4),
            number(uniform, 4),
            number(found("asynchrony.gaussian.steps").unwrap_or(f64::NAN), 3),
            number(found("asynchrony.uniform.steps").unwrap_or(f64::NAN), 3)
        );
        page.headline =
            "Different clock rates damp the mean of an ensemble; the stability of each trajectory depends on its own step only.".into();
        page.highlights.push(Highlight {
            value: number(gaussian, 4),
            text:
                "steps until the mean falls to 1/e (theory), Gaussian rates of 1 % rms, Δt = 10 ms"
                    .into(),
        });
    }
    if let Some(slower) = found("asynchrony.jitter.slower") {
        page.highlights.push(Highlight {
            value: format!("{}×", number(slower, 2)),
            text: "as many steps with independent jitter of the same rms".into(),
        });
    }
    page.paragraph(
        "A clock with a relative rate error δ has a phase error of nθ'δ after n steps, where θ' is the derivative of the \
         angle of a step with respect to its length. The mean over an ensemble is the characteristic function of the rates at nθ': a Gaussian \
         for Gaussian rates, a sinc for uniform ones. Rate errors add up, independent jitter partly cancels: with the same rms s, \
         jitter takes 2/(θ's)² steps to 1/e, and rates √2/(θ's).",
    );
    page.figure(dephasing(record)?);
    if let Ok(table) = record.table("falling apart") {
        page.table(table, 5);
    }
    page.figure(alone(record)?);
    page.action(
        "Compare the clocks of two topics of a log: `libration clock LOG --topic /joint_states --against /cmd`.",
    );
    if let Some(steps) = found("asynchrony.gaussian.steps") {
        page.action(format!(
            "Synchronize clocks with rates of 1 % rms well before {} steps if you use the mean of an ensemble.",
            number(steps, 3)
        ));
    }
    page.action(
        "Compute which rate error your loop tolerates: `libration advise --config loop.toml --skew 1e-4`.",
    );
    Ok(())
}

/// Amplitudes of means against steps.
fn dephasing(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("dephasing", "Mean over an ensemble with different clocks")
        .caption("Lines: amplitude of the mean over the ensemble, measured. Circles: predicted. Dashed: 1/e.")
        .description("Amplitude against steps: curves fall from one along their predictions.")
        .columns(2)
        .aspect(1.2);
    let panels = [
        ("Δt = 10 ms, rates of 1 %", [("gaussian", "Gaussian"), ("uniform", "uniform")], false),
        ("ωΔt = 0.3, 5 %", [("rates", "different rates"), ("jitter", "independent jitter")], true),
    ];
    for (title, ensembles, log) in panels {
        let steps = if log { Axis::log("steps") } else { Axis::linear("steps") };
        let mut panel = Panel::new(steps, Axis::linear("amplitude of the mean").range(0.0, 1.05));
        let mut any = false;
        for (i, (name, words)) in ensembles.into_iter().enumerate() {
            let Ok(series) = record.series(&format!("mean-{name}")) else { continue };
            let steps = series.column("steps")?;
            panel = panel
                .mark(
                    Mark::line(steps, series.column("measured")?)
                        .role(Role::Accent(i as u8))
                        .label(words),
                )
                .mark(Mark::prediction(sparse(steps), sparse(series.column("predicted")?)));
            any = true;
        }
        if any {
            let level = Mark::horizontal(std::f64::consts::E.recip()).role(Role::Neutral);
            figure = figure.panel(panel.mark(level).title(title));
        }
    }
    Ok(figure)
}

/// A few of many points, that one can see what they lie on.
fn sparse(values: &[f64]) -> Vec<f64> {
    values.iter().copied().step_by(5).collect()
}

/// Energies of all trajectories, and which are stable.
fn alone(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("asynchrony-alone", "Energy and stability of single trajectories")
        .caption(
            "Left: largest energy drift of 64 trajectories, below the bound of the fastest clock. Right: growth of \
             many trajectories at ωΔt = 1.9 and rates of 6 %, against the z of each.",
        )
        .description("Left: a line below a bound. Right: growth is zero up to 2 and rises beyond.")
        .columns(2)
        .aspect(1.2);
    if let Ok(series) = record.series("energy") {
        let bound = series.column("bound")?.first().copied().unwrap_or(f64::NAN);
        let line = Mark::line(series.column("steps")?, series.column("largest")?);
        figure = figure.panel(
            Panel::new(
                Axis::log("steps"),
                Axis::linear("largest |E/E₀ − 1|").range(0.0, 1.3 * bound),
            )
            .title("Energy at ωΔt = 0.3, rates of 5 %")
            .mark(line.role(Role::VelocityVerlet).label("measured"))
            .mark(Mark::horizontal(bound).role(Role::Theory).label("bound of the fastest clock")),
        );
    }
    if let Ok(series) = record.series("stable") {
        let points = Mark::points(series.column("z")?, series.column("growth")?);
        figure = figure.panel(
            Panel::new(Axis::linear("z(1 + δ)"), Axis::linear("growth of ln |y| per step"))
                .title("Stability at ωΔt = 1.9")
                .mark(points.role(Role::VelocityVerlet).radius(1.8).label("measured"))
                .mark(Mark::vertical(2.0).role(Role::Theory).label("limit")),
        );
    }
    Ok(figure)
}
