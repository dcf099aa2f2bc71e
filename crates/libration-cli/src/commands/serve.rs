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
        let mass = matches!(actuation, catalog::Actuation::Force { .. }).then(|| actuation.mass());
        settings.push(Setting::of_system(system, mass));
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
    let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
    if !field("host").is_some_and(|host| hosts.iter().any(|own| own.eq_ignore_ascii_case(host))) {
        return refused("403 Forbidden", "this page is for this machine alone\n");
    }
    let is_own = |origin: &str| hosts.iter().any(|own| origin == format!("http://{own}"));
    if field("origin").is_some_and(|origin| !is_own(origin)) {
        return refused("403 Forbidden", "pages of other origins are refused\n");
    }
    let mut words = head.first().map_or("", String::as_str).split(' ');
    match (words.next(), words.next()) {
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
            (&[get], "403 Forbidden"),
            (&[get, "Host: example.org"], "403 Forbidden"),
            (&[get, "Host: example.org:8765"], "403 Forbidden"),
            (&[get, "Host: localhost:8765", "Origin: https://example.org"], "403 Forbidden"),
            (&[get, "Host: localhost:8765", "Origin: null"], "403 Forbidden"),
            (&["GET /etc/passwd HTTP/1.1", "Host: localhost:8765"], "404 Not Found"),
            (&["POST / HTTP/1.1", "Host: localhost:8765"], "405 Method Not Allowed"),
            (&["", "Host: localhost:8765"], "405 Method Not Allowed"),
            (&[], "403 Forbidden"),
        ] {
            assert_eq!(status(lines), expected, "{lines:?}");
        }
    }
}
