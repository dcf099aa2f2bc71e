//! `libration serve`.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::thread;
use std::time::Duration;

use libration::catalog;
use libration::live::Setting;
use libration_report::live::{self, LiveSetting};
use libration_settings::live_settings;

use super::equation_file;
use crate::args::{ServeArgs, SystemArgs};
use crate::error::Failure;
use crate::terminal;

/// The most bytes of a request that are read.
const MOST_REQUEST: u64 = 64 << 10;

/// How long a client may take to send its request.
const PATIENCE: Duration = Duration::from_secs(5);

/// Serves the live page until it is interrupted, or writes it to a file.
pub(crate) fn run(args: &ServeArgs) -> Result<(), Failure> {
    let page = page(&args.system)?;
    if let Some(file) = &args.out {
        let failed = |error| Failure::run(format!("cannot write `{}`: {error}", file.display()));
        fs::write(file, &page).map_err(failed)?;
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
    let page = page.as_bytes();
    thread::scope(|scope| {
        for stream in listener.incoming().flatten() {
            // A client that leaves early harms nobody else.
            scope.spawn(move || drop(answer(&stream, address, page)));
        }
    });
    Ok(())
}

/// The page, with the system of the options first.
fn page(options: &SystemArgs) -> Result<String, Failure> {
    let mut settings = Vec::new();
    if let Some(system) = equation_file::system(options) {
        settings.push(live_settings::of_equations(&system?));
    } else if let Some(name) = &options.system {
        let (system, actuation) = catalog::build(name, &options.set).map_err(Failure::usage)?;
        let mut setting = Setting::of_system(system, actuation);
        begin_at(&mut setting, options)?;
        settings.push(setting);
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
    let SystemArgs { set, q, v, .. } = options;
    [(!set.is_empty(), "--set"), (q.is_some(), "--q"), (v.is_some(), "--v")]
        .into_iter()
        .find_map(|(given, name)| given.then_some(name))
}

/// Replaces the start by that of the options.
fn begin_at(setting: &mut Setting, options: &SystemArgs) -> Result<(), Failure> {
    let coordinates = setting.definitions.coordinates.clone();
    for (given, flag, prime) in [(&options.q, "--q", ""), (&options.v, "--v", "'")] {
        let Some(given) = given else { continue };
        let values = given.values();
        if values.len() != coordinates.len() {
            return Err(Failure::usage(format!(
                "{flag} has {} numbers; expected {} in a page of `{}`",
                values.len(),
                coordinates.len(),
                setting.system
            )));
        }
        for (name, value) in coordinates.iter().zip(values) {
            let key = format!("start.{name}{prime}");
            setting.set(&key, &value.to_string()).map_err(Failure::usage)?;
        }
    }
    Ok(())
}

fn open(address: &str) {
    if let Err(error) = open::that_detached(address) {
        terminal::warn(&format!("cannot open the browser: {error}"));
    }
}

/// Answers one request.
fn answer(stream: &TcpStream, address: SocketAddr, page: &[u8]) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut head = Vec::new();
    for line in BufReader::new(stream.take(MOST_REQUEST)).lines() {
        match line? {
            line if line.is_empty() => break,
            line => head.push(line),
        }
    }
    let (status, kind, body) = reply(&head, address.port(), page);
    let length = body.len();
    let mut stream = stream;
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {length}\r\nConnection: close\r\n\
         X-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Referrer-Policy: no-referrer\r\n\r\n"
    )?;
    if !head.first().is_some_and(|line| line.starts_with("HEAD ")) {
        stream.write_all(body)?;
    }
    stream.flush()
}

/// Status, type and body for the head of a request. A name that another machine chose to mean this one is refused.
fn reply<'p>(head: &[String], port: u16, page: &'p [u8]) -> (&'static str, &'static str, &'p [u8]) {
    let refused = |status, why: &'static str| (status, "text/plain", why.as_bytes());
    let field = |name: &str| {
        head.iter().skip(1).find_map(|line| {
            let (own, value) = line.split_once(':')?;
            own.trim().eq_ignore_ascii_case(name).then(|| value.trim())
        })
    };
    let mut hosts: Vec<String> =
        ["127.0.0.1", "localhost"].iter().map(|name| format!("{name}:{port}")).collect();
    // Browsers leave out the port of the protocol.
    if port == 80 {
        hosts.extend(["127.0.0.1".to_owned(), "localhost".to_owned()]);
    }
    let is_host = |line: &&String| {
        line.split_once(':').is_some_and(|(own, _)| own.trim().eq_ignore_ascii_case("host"))
    };
    if head.iter().skip(1).filter(is_host).count() != 1 {
        return refused("400 Bad Request", "expected one field `Host`\n");
    }
    if !field("host").is_some_and(|host| hosts.iter().any(|own| own.eq_ignore_ascii_case(host))) {
        return refused("403 Forbidden", "this page is for this machine alone\n");
    }
    let is_own = |origin: &str| hosts.iter().any(|own| origin == format!("http://{own}"));
    if field("origin").is_some_and(|origin| !is_own(origin)) {
        return refused("403 Forbidden", "pages of other origins are refused\n");
    }
    let mut words = head.first().map_or("", String::as_str).split(' ');
    let method = words.next();
    let path = words.next().map(|path| path.split('?').next().unwrap_or_default());
    match (method, path) {
        (Some("GET" | "HEAD"), Some("/" | "/index.html")) => ("200 OK", "text/html", page),
        (Some("GET" | "HEAD"), _) => refused("404 Not Found", "there is one page, at /\n"),
        _ => refused("405 Method Not Allowed", "expected GET\n"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(lines: &[&str]) -> &'static str {
        let head: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        reply(&head, 8765, b"page").0
    }

    #[test]
    fn only_requests_for_this_machine_of_its_own_page_are_answered() {
        let get = "GET / HTTP/1.1";
        for (lines, expected) in [
            (&[get, "Host: 127.0.0.1:8765"][..], "200 OK"),
            (&[get, "host:localhost:8765", "Origin: http://localhost:8765"], "200 OK"),
            (&["HEAD / HTTP/1.1", "Host: localhost:8765"], "200 OK"),
            (&[get], "400 Bad Request"),
            (&[get, "Host: localhost:8765", "Host: example.org"], "400 Bad Request"),
            (&["GET /?x=1 HTTP/1.1", "Host: localhost:8765"], "200 OK"),
            (&[get, "Host: example.org"], "403 Forbidden"),
            (&[get, "Host: example.org:8765"], "403 Forbidden"),
            (&[get, "Host: localhost:8765", "Origin: https://example.org"], "403 Forbidden"),
            (&[get, "Host: localhost:8765", "Origin: null"], "403 Forbidden"),
            (&["GET /etc/passwd HTTP/1.1", "Host: localhost:8765"], "404 Not Found"),
            (&["POST / HTTP/1.1", "Host: localhost:8765"], "405 Method Not Allowed"),
            (&["", "Host: localhost:8765"], "405 Method Not Allowed"),
            (&[], "400 Bad Request"),
        ] {
            assert_eq!(status(lines), expected, "{lines:?}");
        }
    }
}
