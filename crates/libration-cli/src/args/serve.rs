//! Arguments of `serve`.

use std::path::PathBuf;

use clap::Args;

use super::SystemArgs;

/// Arguments of `serve`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ServeArgs {
    #[command(flatten)]
    pub(crate) system: SystemArgs,
    /// Port on the loopback interface (0: a free one)
    #[arg(long, value_name = "PORT", default_value_t = 8765)]
    pub(crate) port: u16,
    /// Write the page to FILE and exit, for any web server or none
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    pub(crate) out: Option<PathBuf>,
    /// Open the page in the browser
    #[arg(long)]
    pub(crate) open: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration serve --open                      the systems of the catalogue and the examples
  libration serve --system mine.toml --open   your own system first
  libration serve --out page.html             one file without a server

Only this machine can reach the page, and pages of other origins are refused. Nothing leaves the browser: the
engine runs in it.";
