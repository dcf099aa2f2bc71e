//! The report that is looked at.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use libration_lab::output::Output;
use libration_lab::{Config, Effort, Lab, Silent, session, studies};

/// The page of one quick run of all studies, made once.
pub(crate) fn file() -> &'static Path {
    static FILE: LazyLock<PathBuf> = LazyLock::new(|| {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("browser");
        let _ = fs::remove_dir_all(&folder);
        let (config, stop) = (Config::default(), AtomicBool::new(false));
        let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
        session::run(&lab, studies::ALL, &Output::open(&folder).unwrap()).unwrap();
        folder.join("report.html")
    });
    &FILE
}
