//! A browser process of our own, with a profile of its own.

use std::fs::{self, File};
use std::io::{Write, stderr};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, Once, PoisonError, Weak};
use std::thread::sleep;
use std::time::{Duration, Instant};
use std::{env, process};

/// Where to look on the path, unless `CHROME` names a program.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Quiet, reproducible, and awake: a window that nobody sees must not fall asleep.
const FLAGS: [&str; 15] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-background-networking",
    "--disable-component-update",
    // The tests follow more links in a second than a reader would.
    "--disable-ipc-flooding-protection",
    "--disable-sync",
    "--disable-renderer-backgrounding",
    "--disable-backgrounding-occluded-windows",
    "--disable-background-timer-throttling",
    "--remote-debugging-port=0",
];

/// A start that takes longer than this has failed, on any machine.
const START: Duration = Duration::from_secs(60);

/// A running browser; it ends with the last test that uses it.
pub(crate) struct Chromium {
    process: Child,
    profile: PathBuf,
    /// Where the DevTools of the whole browser listen, as `127.0.0.1:port` and a path.
    pub(crate) host: String,
    pub(crate) path: String,
}

/// The browser that all tests share; `None`, with a message, where there is none.
pub(crate) fn shared() -> Option<Arc<Chromium>> {
    static RUNNING: Mutex<Weak<Chromium>> = Mutex::new(Weak::new());
    let program = program()?;
    let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    let browser = running.upgrade().unwrap_or_else(|| Arc::new(Chromium::start(&program)));
    *running = Arc::downgrade(&browser);
    Some(browser)
}

fn program() -> Option<PathBuf> {
    if let Some(program) = env::var_os("CHROME") {
        return Some(program.into());
    }
    let path = env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = env::split_paths(&path).collect();
    let found = NAMES
        .iter()
        .flat_map(|name| folders.iter().map(move |f| f.join(name)))
        .find(|p| p.is_file());
    if found.is_none() {
        let message = format!("no browser: none of {} is on the path", NAMES.join(", "));
        assert!(env::var_os("LIBRATION_REQUIRE_BROWSER").is_none(), "{message}");
        static SAID: Once = Once::new();
        SAID.call_once(|| {
            // Not `eprintln!`, which a test that passes keeps to itself.
            let _ = writeln!(stderr(), "SKIPPED, {message}; install one, or name it in CHROME");
        });
    }
    found
}

impl Chromium {
    fn start(program: &Path) -> Chromium {
        // A browser that ends may run beside the next one, so each has a number.
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let profile = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
            .join(format!("profile-{}-{number}", process::id()));
        let _ = fs::remove_dir_all(&profile);
        fs::create_dir_all(&profile).unwrap();
        let log = File::create(profile.join("log")).unwrap();
        let process = Command::new(program)
            .args(FLAGS)
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(log)
            .spawn()
            .unwrap_or_else(|error| panic!("{} does not start: {error}", program.display()));
        let mut browser = Chromium { process, profile, host: String::new(), path: String::new() };
        (browser.host, browser.path) = browser.address();
        browser
    }

    /// Waits until the browser has written where it listens.
    fn address(&mut self) -> (String, String) {
        let started = Instant::now();
        loop {
            let file = fs::read_to_string(self.profile.join("DevToolsActivePort"));
            if let Some((port, path)) = file.as_deref().ok().and_then(|text| text.split_once('\n'))
            {
                return (format!("127.0.0.1:{port}"), path.trim().to_owned());
            }
            let ended = self.process.try_wait().unwrap();
            if ended.is_some() || started.elapsed() > START {
                let log = fs::read_to_string(self.profile.join("log")).unwrap_or_default();
                panic!("the browser did not start ({ended:?}):\n{log}");
            }
            sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        // Its helpers may still write for a moment.
        for _ in 0..50 {
            if fs::remove_dir_all(&self.profile).is_ok() || !self.profile.exists() {
                return;
            }
            sleep(Duration::from_millis(20));
        }
    }
}
