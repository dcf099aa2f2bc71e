//! The chapter on stable time steps.

use libration::Method;
use libration_report::figure::{Axis, Dash, Figure, Mark, Panel, Role};
use libration_report::notation::number;
use libration_report::page::{Highlight, Page};
use libration_report::record::{Cell, Record, RecordError, Series};

use crate::method_color::method_color;

/// Writes the chapter.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    page.title = "Stable time steps".into();
    summary(record, page)?;
    page.paragraph(
        "Without a tolerance, stable means that every orbit stays bounded. This follows from the polynomials of the \
         shipped step: by Jury’s criterion stability can change only at their roots, which \
         Sturm’s theorem isolates in exact arithmetic, however close they are. The last column has the \
         result of a sweep on a grid with short runs, which can miss narrow unstable ranges.",
    );
    page.table(record.table("windows")?, 15);
    page.figure(windows(record)?);
    page.paragraph(
        "With a tolerance, the largest step depends on the tolerance and on the horizon. The energy of a \
         symplectic step stays between two multiples of the form that it conserves; that of RK4 and \
         of explicit Euler changes by the determinant in every step. In both cases the largest step \
         is a root of a polynomial. The table also has the result of a search by simulation.",
    );
    page.figure(against_horizon(record)?.number("9.5"));
    page.table(record.table("largest steps")?, 5);
    page.paragraph(
        "The largest step of Verlet is independent of the horizon; that of RK4 falls with the \
         sixth root of the horizon. For every tolerance ε below one RK4 therefore allows the larger step up to \
         a number of steps N*(ε), and Verlet beyond it; from rest N* is about 9/(8ε²). \
         Per force evaluation (Verlet two, RK4 four) Verlet leads earlier.",
    );
    actions(record, page);
    Ok(())
}

/// The answer, from the windows and the longest horizon.
fn summary(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    let crossovers = record.series("crossovers");
    let Ok(series) = crossovers else { return Ok(()) };
    let tolerance = series.column("tolerance")?;
    let steps = series.column("steps")?;
    let ties: Vec<String> = tolerance
        .iter()
        .zip(steps)
        .map(|(e, n)| format!("{} steps for a drift of {}", number(*n, 3), number(*e, 2)))
        .collect();
    if ties.is_empty() {
        return Ok(());
    }
    page.answer = format!(
        "With an energy tolerance Verlet allows a larger step than RK4 in long runs: \
         the largest step of RK4 falls below that of Verlet after {}. Without a tolerance RK4 allows the larger step.",
        ties.join(", ")
    );
    if let (Some(e), Some(n)) = (tolerance.first(), steps.first()) {
        page.highlights.push(Highlight {
            value: format!("{} steps", number(*n, 3)),
            text: format!(
                "until Verlet allows a larger step than RK4, for a tolerated drift of {}",
                number(*e, 2)
            ),
        });
    }
    Ok(())
}

/// The step of the reader's system for a tolerance of the run, and what a short sweep misses.
fn actions(record: &Record, page: &mut Page) {
    let tags = record.series.iter().filter_map(|s| s.name.strip_prefix("limit-drift-"));
    if let Some(tolerance) = tags.filter_map(|tag| tag.parse::<f64>().ok()).next() {
        page.action(format!(
            "Choose the tolerated energy error and the length of the run before the time step: \
             `libration advise --system FILE --tolerance energy={tolerance} --horizon 100`."
        ));
    }
    let missed = record.findings.iter().find_map(|sweep| {
        let of = |end: &str| {
            let id = format!("{}.{end}", sweep.id.strip_suffix(".hasty")?);
            record.finding(&id).ok().map(|f| f.measured)
        };
        let (from, to) = (of("window-1-to")?, of("window-2-from")?);
        (sweep.measured > from).then_some([from, to])
    });
    if let Some([from, to]) = missed {
        page.action(format!(
            "Run the chosen time step for the whole duration. A short sweep misses the unstable steps from ωΔt = {} to {}.",
            number(from, 4),
            number(to, 4)
        ));
    }
}

/// The windows as bars.
fn windows(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("windows")?;
    let named = record.table("windows")?.rows.iter().filter_map(|row| match row.first()? {
        Cell::Text(name) => Some(name.clone()),
        Cell::Number(_) => None,
    });
    let names: Vec<String> = named.collect();
    let (rows, from, to) = (series.column("row")?, series.column("from")?, series.column("to")?);
    let last = to.iter().copied().filter(|x| x.is_finite()).fold(1.0, f64::max);
    let mut panel = Panel::new(
        Axis::linear("z = ωΔt").range(0.0, 1.04 * last),
        Axis::names("", names.iter().cloned()),
    );
    for (i, name) in names.iter().enumerate() {
        let y = -(i as f64);
        let of = |row: f64| row as usize == i;
        let colour = Method::ALL
            .into_iter()
            .find(|m| m.title() == name)
            .map_or(Role::Accent(3), method_color);
        for ((&row, &from), &to) in rows.iter().zip(from).zip(to) {
            if of(row) {
                let bar = Mark::line([from, to], [y, y]);
                panel = panel.mark(bar.role(colour).dash(Dash::Solid).width(7.0));
            }
        }
    }
    Ok(Figure::new("windows", "Time steps with bounded orbits")
        .caption(
            "Bars: windows of stability, isolated exactly. The composition of three nearly equal \
             Verlet steps is unstable in a very narrow range near z = 3, where a step turns by half a period. \
             A sweep misses this range; a long run inside it does not.",
        )
        .description("A bar for each interval of stable steps, a row for each integrator.")
        .aspect(2.6)
        .panel(panel))
}

/// The largest step against the horizon, a panel for each criterion.
fn against_horizon(record: &Record) -> Result<Figure, RecordError> {
    let mut figure = Figure::new("fig-9-5", "Largest time step against the length of the run")
        .caption(
            "Lines: roots of the criterion. Dots: search by simulation. With an \
             energy tolerance RK4 allows the larger step in short runs and Verlet in long ones; with an \
             amplitude limit, the usual test for instability, RK4 allows the largest step at every horizon.",
        )
        .description("Log-log: the largest step of each method against the number of steps.")
        .columns(2)
        .aspect(1.25);
    for series in record.series.iter().filter(|s| s.name.starts_with("limit-")) {
        figure = figure.panel(horizon(record, series)?);
    }
    Ok(figure)
}

fn horizon(record: &Record, series: &Series) -> Result<Panel, RecordError> {
    let tag = &series.name["limit-".len()..];
    let title = match tag.strip_prefix("drift-").and_then(|e| e.parse::<f64>().ok()) {
        Some(tolerance) => format!("Energy drift below {}", number(tolerance, 3)),
        None => "Amplitude below ten times the start".into(),
    };
    let mut panel = Panel::new(Axis::log("steps"), Axis::log("largest Δt").unit("s")).title(title);
    let steps = series.column("steps")?;
    for method in Method::ALL {
        let Ok(dt) = series.column(method.name()) else { continue };
        let prefix = format!("stability.{}.{tag}.steps-", method.name());
        let searched = record.findings.iter().filter_map(|f| {
            let steps: f64 = f.id.strip_prefix(&prefix)?.parse().ok()?;
            Some((steps, f.measured))
        });
        let (x, y): (Vec<f64>, Vec<f64>) = searched.unzip();
        panel = panel
            .mark(Mark::line(steps, dt).role(method_color(method)).label(method.title()))
            .mark(Mark::points(x, y).role(method_color(method)).radius(3.0));
    }
    Ok(panel)
}
