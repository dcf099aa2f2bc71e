//! `libration bodies`.

use std::fmt::{Display, Write as _};
use std::io::{self, BufWriter};
use std::path::Path;

use libration::bodies::{InitialConditions, PairPotential};
use libration::ensemble::Execution;
use libration::equations::Expression;
use libration_analyze::bodies::{
    BodiesAudit, BodiesRequest, ENCOUNTERS_AT_EACH_STEP, FEW_OSCILLATION_STEPS, FEW_STEPS,
    simulate, write,
};
use libration_analyze::export::{ExportError, Rows};
use libration_analyze::trajectory::TrajectoryError;
use libration_settings::bodies_file::{self, NamedBodies};
use libration_settings::equations::explanation;
use libration_settings::suggestions;

use super::simulate::{Watcher, failure, format_of};
use crate::args::BodiesArgs;
use crate::error::Failure;
use crate::interrupt;
use crate::output_file::OutputFile;
use crate::terminal;

/// Simulates bodies and prints the audit.
pub(crate) fn run(args: &BodiesArgs, quiet: bool) -> Result<(), Failure> {
    let execution = Execution::serial().threads(args.threads);
    let request = BodiesRequest {
        system: system(args)?,
        integrator: args.integrator,
        dt: args.dt,
        steps: args.steps,
        every: args.every,
        is_compensated: args.compensated,
        is_adaptive: args.adaptive,
        is_predicted: !args.no_prediction,
        execution: execution.map_err(|error| Failure::ensemble(&error))?,
    };
    let watcher = Watcher::new(quiet || args.json, args.steps, interrupt::listen());
    let audit = match &args.output {
        Some(path) => into_file(path, args, &request, &watcher),
        None => simulate(&request, &mut NoRows, &watcher).map_err(failed),
    };
    watcher.clear();
    let audit = audit?;
    let text = match args.json {
        true => serde_json::to_string_pretty(&audit).map_err(Failure::run)? + "\n",
        false => describe(&audit),
    };
    terminal::print(&text)?;
    match audit.stopped {
        Some(reason) => Err(Failure::run(reason)),
        None if audit.verdict.is_good() => Ok(()),
        None => Err(Failure::Disagreement),
    }
}

/// The bodies of the options.
fn system(args: &BodiesArgs) -> Result<NamedBodies, Failure> {
    let mut system = match InitialConditions::from_name(&args.system) {
        Some(published) => of_name(published, args)?,
        None => of_file(args)?,
    };
    let mut bodies = system.bodies;
    let wrong =
        |flag: &'static str| move |error: &dyn Display| Failure::usage(format!("{error} ({flag})"));
    if let Some(text) = &args.pair_potential {
        // Of the file, those that the expression has.
        let own = bodies.pairs().map(PairPotential::parameters).unwrap_or_default();
        let parsed = Expression::parse(text).ok();
        let has =
            |name: &str| parsed.iter().flat_map(Expression::names).any(|(known, _)| known == name);
        let parameters: Vec<_> = own.iter().filter(|(name, _)| has(name)).cloned().collect();
        let potential = PairPotential::new(text, &parameters).map_err(|error| {
            Failure::usage(format!("{} (--pair-potential)", explanation(&error)))
        })?;
        let names = &system.names;
        bodies = bodies
            .gravitational_constant(0.0)
            .and_then(|all| all.pair_potential(potential))
            .map_err(|error| {
            let named = error.with_names(|body| format!("`{}`", names[body]));
            Failure::usage(format!("{named} (--pair-potential)"))
        })?;
    }
    if let Some(constant) = args.gravitational_constant {
        let wrong = wrong("--gravitational-constant");
        bodies = bodies.gravitational_constant(constant).map_err(|error| wrong(&error))?;
    }
    if let Some(length) = args.softening {
        let wrong = wrong("--softening");
        bodies = bodies.softening(length).map_err(|error| wrong(&error))?;
    }
    system.bodies = bodies;
    Ok(system)
}

fn of_name(published: InitialConditions, args: &BodiesArgs) -> Result<NamedBodies, Failure> {
    let is_cluster = published == InitialConditions::Plummer;
    let count = match (is_cluster, args.count) {
        (true, None) => return Err(Failure::usage("plummer requires --count")),
        (true, Some(count)) => count,
        (false, None) if args.seed.is_none() => 0,
        (false, given) => {
            let flag = if given.is_some() { "--count" } else { "--seed" };
            return Err(Failure::usage(format!(
                "{flag} applies to plummer only; `{}` has fixed bodies",
                args.system
            )));
        }
    };
    let bodies = published.bodies(count, args.seed.unwrap_or(0)).map_err(Failure::usage)?;
    let names: Vec<String> = match published.body_names() {
        [] => (0..bodies.count()).map(|i| i.to_string()).collect(),
        names => names.iter().map(|&name| name.to_owned()).collect(),
    };
    Ok(NamedBodies { name: published.name().to_owned(), bodies, names })
}

fn of_file(args: &BodiesArgs) -> Result<NamedBodies, Failure> {
    let path = Path::new(&args.system);
    if path.extension().is_none() && !path.exists() {
        let known = InitialConditions::ALL.map(InitialConditions::name);
        let help = suggestions::suggest("initial conditions", &args.system, known);
        let message = format!("unknown system `{}`; {help}, or a file", args.system);
        return Err(Failure::usage(message));
    }
    let given = [("--count", args.count.is_some()), ("--seed", args.seed.is_some())];
    if let Some((flag, _)) = given.into_iter().find(|(_, given)| *given) {
        return Err(Failure::usage(format!("{flag} applies to plummer only, not to a file")));
    }
    let text = bodies_file::read_text(path)
        .map_err(|error| Failure::usage(format!("cannot read `{}`: {error}", path.display())))?;
    NamedBodies::parse(&text, &args.system).map_err(|error| Failure::Shown(error.render_styled()))
}

/// Keeps no rows.
struct NoRows;

impl Rows<f64> for NoRows {
    fn row(&mut self, _: &[u64], _: f64, _: &[f64]) -> Result<(), ExportError> {
        Ok(())
    }
}

fn into_file(
    path: &Path,
    args: &BodiesArgs,
    request: &BodiesRequest,
    watcher: &Watcher,
) -> Result<BodiesAudit, Failure> {
    let format = format_of(path, args.format)?;
    let unwritable =
        |error: io::Error| format!("cannot write `{}` (--output): {error}", path.display());
    let file = OutputFile::create(path).map_err(|error| Failure::usage(unwritable(error)))?;
    let mut out = BufWriter::new(file);
    let audit = write(request, format, &mut out, watcher).map_err(|error| match error {
        TrajectoryError::Export(ExportError::Io(error)) => Failure::run(unwritable(error)),
        error => failed(error),
    })?;
    let written = out.into_inner().map_err(io::IntoInnerError::into_error);
    written.and_then(OutputFile::keep).map_err(|error| Failure::run(unwritable(error)))?;
    Ok(audit)
}

fn failed(error: TrajectoryError) -> Failure {
    match error {
        TrajectoryError::Interrupted => Failure::Interrupted("interrupted".to_owned()),
        error => failure(error),
    }
}

// Writing into a string cannot fail.
fn describe(audit: &BodiesAudit) -> String {
    let mut text = format!(
        "{} {} of {} with {} (order {}): {} {} {} to t = {}\n\n",
        audit.bodies,
        if audit.bodies == 1 { "body" } else { "bodies" },
        audit.system,
        audit.integrator,
        audit.order,
        audit.steps,
        if audit.is_adaptive { "adaptive steps from" } else { "steps of" },
        short(audit.dt),
        short(audit.t),
    );
    let _ = writeln!(
        text,
        "  {:<18} {:>15} {:>20} {:>22}",
        "quantity", "largest change", "predicted by order", "predicted by rounding"
    );
    for one in &audit.conserved {
        let by_order = match one.predicted_by_order {
            None => "-".to_owned(),
            Some(0.0) => "0".to_owned(),
            Some(x) => format!("{x:.2e}"),
        };
        let _ = writeln!(
            text,
            "  {:<18} {:>15} {:>20} {:>22}",
            one.quantity,
            format!("{:.2e}", one.largest_change),
            by_order,
            format!("{:.2e}", one.predicted_by_rounding),
        );
    }
    let _ = writeln!(text);
    if let Some(encounter) = &audit.encounter {
        let [a, b] = &encounter.bodies;
        let _ = write!(
            text,
            "Closest encounter{}: {a} and {b} at a distance of {} at t = {}",
            if audit.bodies > ENCOUNTERS_AT_EACH_STEP { " at the samples" } else { "" },
            short(encounter.distance),
            short(encounter.t)
        );
        let (few, what) = match audit.pair_potential {
            Some(_) => (FEW_OSCILLATION_STEPS, "oscillation"),
            None => (FEW_STEPS, "orbit"),
        };
        let _ = match encounter.steps_per_orbit {
            Some(steps) if steps < few => writeln!(
                text,
                ", where an {what} has {} steps: the time step is too long",
                short(steps)
            ),
            Some(steps) => writeln!(text, ", where an {what} has {} steps", short(steps)),
            None => writeln!(text),
        };
    }
    let _ = writeln!(
        text,
        "Changes are the largest of {} samples, relative to {}, the sum of m|v| and the sum of m|r||v|.",
        audit.samples,
        energy_scale(audit),
    );
    let _ = writeln!(text, "verdict: {}", audit.verdict);
    text += "By order: the change with twice the time step, over the power of 2; 0 where rounding hides it.\n";
    text
}

/// The energy that its changes are relative to.
fn energy_scale(audit: &BodiesAudit) -> String {
    let size = audit.conserved.iter().find(|one| one.quantity == "energy").map(|one| one.size);
    let scale = format!("{} = {}", audit.energy_scale, short(size.unwrap_or(f64::NAN)));
    match audit.energy_scale {
        "the kinetic energy at the start" => {
            format!("{scale}, as |E| = {} is small beside it", short(audit.energy.abs()))
        }
        _ => scale,
    }
}

fn short(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        let text = format!("{x:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{x:.3e}")
    }
}
