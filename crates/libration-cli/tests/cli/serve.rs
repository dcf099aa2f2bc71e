//! `serve` and live pages.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use libration::live::{Setting, answer};
use libration_settings::equations::EquationSystem;
use libration_settings::{EquationExample, live_settings};
use predicates::str::contains;

use super::advise::libration;

/// A running server.
struct Server(Child, String);

impl Server {
    fn start() -> Server {
        let mut child = Command::new(env!("CARGO_BIN_EXE_libration"))
            .args(["serve", "--port", "0"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let host = line.trim().strip_prefix("http://").unwrap().trim_end_matches('/').to_owned();
        Server(child, host)
    }

    fn reply(&self, request: &str) -> String {
        let mut stream = TcpStream::connect(&self.1).unwrap();
        stream.write_all(request.replace("HOST", &self.1).as_bytes()).unwrap();
        let mut reply = String::new();
        stream.read_to_string(&mut reply).unwrap();
        reply
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn serve_gives_its_page_to_this_machine_and_refuses_other_origins() {
    let server = Server::start();
    // A client that says nothing keeps nobody waiting.
    let silent = TcpStream::connect(&server.1).unwrap();
    let page = server.reply("GET / HTTP/1.1\r\nHost: HOST\r\n\r\n");
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.ends_with("</html>\n"), "{page:.80}");
    assert!(page.contains("id=\"live-engine\"") && page.contains("X-Frame-Options: DENY"));
    for request in [
        "GET / HTTP/1.1\r\nHost: example.org\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: HOST\r\nOrigin: https://example.org\r\n\r\n",
    ] {
        let refused = server.reply(request);
        assert!(refused.starts_with("HTTP/1.1 403 Forbidden\r\n"), "{refused:.80}");
    }
    drop(silent);
}

#[test]
fn serve_writes_a_page_that_begins_with_the_system_of_the_options() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    let page = page.to_str().unwrap();
    for (options, first) in [
        (&["--system", "pendulum", "--set", "omega2=4"][..], "system=pendulum\\ncoordinates=q"),
        (&["--force", "-k*q0", "--set", "k=3"], "acceleration.q0=-k*q0"),
        (&["--system", "oscillator", "--q", "1,2"], "system=oscillator\\ncoordinates=q0,q1"),
        (&[], "system=oscillator\\n"),
    ] {
        libration(&[&["serve", "--out", page], options].concat()).success();
        let text = fs::read_to_string(page).unwrap();
        let settings = text.split("id=\"live-settings\">").nth(1).unwrap();
        let own = settings.find(first).unwrap_or_else(|| panic!("{first}: {settings:.400}"));
        assert!(own < 60, "{first}: {settings:.200}");
    }
    libration(&["serve", "--system", "pendulum", "--set", "omega=1", "--out", page]).code(2);
    libration(&["serve", "--system", "pendulum", "--start", "foo=1", "--out", page])
        .code(2)
        .stderr(contains("--start foo=1: unknown state `foo`; help: the states are `q`, `q'`"));
    libration(&["serve", "--out", "/nowhere/page.html"])
        .code(1)
        .stderr(contains("cannot write `/nowhere/page.html`"));
}

#[cfg(unix)]
#[test]
fn a_page_that_does_not_fit_leaves_the_file_that_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("page.html");
    fs::write(&page, "before").unwrap();
    // A limit of files, as a full disk is one: 100 KiB of a page with an engine.
    let script = "ulimit -f 100; exec \"$0\" serve --out page.html";
    let output = Command::new("bash")
        .args(["-c", script, env!("CARGO_BIN_EXE_libration")])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert_eq!(fs::read_to_string(&page).unwrap(), "before");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

/// Writes the file of an example to a folder, and gives its setting.
fn example(folder: &Path, name: &str) -> (String, Setting) {
    let text = EquationExample::find(name).unwrap().text;
    let file = folder.join(format!("{name}.toml"));
    fs::write(&file, text).unwrap();
    let system = EquationSystem::parse(text, name, &[]).unwrap();
    (file.to_str().unwrap().to_owned(), live_settings::of_system(&system))
}

fn stdout(words: &[&str]) -> String {
    let done = libration(words).success();
    String::from_utf8(done.get_output().stdout.clone()).unwrap()
}

/// A column of CSV.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let place = lines.next().unwrap().split(',').position(|own| own == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap()).collect()
}

#[test]
fn motion_in_a_page_has_the_bits_of_simulate() {
    let folder = tempfile::tempdir().unwrap();
    for (name, integrator) in [
        ("double-pendulum", "rk4"),
        ("dc-motor", "velocity-verlet"),
        ("lorenz", "dormand-prince-8"),
        ("three-body", "gauss-legendre-4"),
    ] {
        let (file, setting) = example(folder.path(), name);
        let view = answer(&format!("view\n{setting}integrator={integrator}\ndt=0.01\nhorizon=1\n"));
        let csv = stdout(&[
            "simulate",
            "--system",
            &file,
            "--integrator",
            integrator,
            "--dt",
            "0.01",
            "--steps",
            "100",
        ]);
        for state in view.get_text("states").split(' ') {
            let (own, other) = (view.get(&format!("x.{state}")), column(&csv, state));
            assert_eq!(own.len(), 101);
            assert_eq!(own, other, "{name} {state}");
        }
    }
}

#[test]
fn a_loop_in_a_page_is_that_of_simulate() {
    let folder = tempfile::tempdir().unwrap();
    let (file, setting) = example(folder.path(), "cart-pole");
    let gain = "-1,-30,-2,-6";
    // A latency of a period and a half: two steps of 5 ms before a command arrives, and two behind it.
    let timing = "period=0.02\nlatency=0.03\n";
    let view = answer(&format!(
        "view\n{setting}integrator=rk4\ndt=0.005\nhorizon=2\ngain={gain}\n{timing}"
    ));
    let csv = stdout(&[
        "simulate",
        "--system",
        &file,
        "--gain=-1,-30,-2,-6",
        "--period",
        "0.02",
        "--latency",
        "0.03",
        "--integrator",
        "rk4",
        "--dt",
        "0.005",
        "--steps",
        "100",
    ]);
    for state in ["x", "theta", "x'", "theta'"] {
        let own: Vec<f64> = view.get(&format!("x.{state}")).iter().copied().step_by(4).collect();
        let other = column(&csv, state);
        assert_eq!(own.len(), 101);
        for (own, other) in own.iter().zip(&other) {
            // Both round each of some thousand operations.
            assert!((own - other).abs() < 1e-13, "{state}: {own} {other}");
        }
    }
}
