//! The report that is looked at.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use std::{env, fs};

use libration_lab::output::Output;
use libration_lab::{STUDIES, session};
use libration_study::{Effort, Lab, Silent};

/// The page of one quick run of all studies: made once, unless `LIBRATION_REPORT` names a folder that holds one.
pub(crate) fn file() -> &'static Path {
    static FILE: LazyLock<PathBuf> = LazyLock::new(|| {
        if let Some(folder) = env::var_os("LIBRATION_REPORT") {
            return Path::new(&folder).join("report.html");
        }
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("browser");
        let _ = fs::remove_dir_all(&folder);
        let (config, stop) = (STUDIES.config(), AtomicBool::new(false));
        let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
        session::run(&lab, STUDIES.studies, &Output::open(&folder).unwrap()).unwrap();
        folder.join("report.html")
    });
    &FILE
}
