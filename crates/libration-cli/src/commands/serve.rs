//! `libration serve`.

use std::io::Write as _;
use std::net::{Ipv4Addr, TcpListener};

use libration_report::live::{self, LiveSetting};
use libration_settings::live_settings;

use super::equation_file;
use super::page_server::{self, Limits};
use crate::args::{ServeArgs, SystemArgs};
use crate::error::Failure;
use crate::output_file::OutputFile;
use crate::terminal;

/// Serves the live page until it is interrupted, or writes it to a file.
pub(crate) fn run(args: &ServeArgs) -> Result<(), Failure> {
    let page = page(&args.system)?;
    if let Some(file) = &args.out {
        // A full disk leaves the file that was there.
        let failed = |error| Failure::run(format!("cannot write `{}`: {error}", file.display()));
        let mut output = OutputFile::create(file).map_err(failed)?;
        let written = output.write_all(page.as_bytes()).and_then(|()| output.keep());
        written.map_err(failed)?;
        if args.open {
            open(&file.to_string_lossy());
        }
        return Ok(());
    }
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).map_err(|error| {
        Failure::run(format!(
            "cannot listen on port {}: {error}; help: use another --port, or 0",
            args.port
        ))
    })?;
    let address = listener.local_addr().map_err(Failure::run)?;
    terminal::print(&format!("http://{address}/\n"))?;
    if args.open {
        open(&format!("http://{address}/"));
    }
    page_server::serve(&listener, address, page.as_bytes(), Limits::default());
    Ok(())
}

/// The page, with the system of the options first.
fn page(options: &SystemArgs) -> Result<String, Failure> {
    let mut settings = Vec::new();
    if options.system.is_some() || !options.force.is_empty() {
        settings.push(live_settings::of_system(&equation_file::any_system(options)?));
    } else if let Some(option) = first_of_start(options) {
        return Err(Failure::usage(format!(
            "{option} is given without a system; expected --system or --force"
        )));
    }
    settings.extend(live_settings::examples());
    let settings: Vec<LiveSetting> = settings
        .into_iter()
        .map(|own| LiveSetting { title: own.system.clone(), text: own.to_string() })
        .collect();
    Ok(live::page(
        &settings,
        "What an integrator, a time step, latency, jitter and skew do to a system",
    ))
}

/// The first option that changes a system, if there is one.
fn first_of_start(options: &SystemArgs) -> Option<&'static str> {
    let SystemArgs { set, q, v, start, .. } = options;
    [
        (!set.is_empty(), "--set"),
        (q.is_some(), "--q"),
        (v.is_some(), "--v"),
        (!start.is_empty(), "--start"),
    ]
    .into_iter()
    .find_map(|(given, name)| given.then_some(name))
}

fn open(address: &str) {
    if let Err(error) = open::that_detached(address) {
        terminal::warn(&format!("cannot open the browser: {error}"));
    }
}
