//! The page in a real browser: a finished report, opened from a file in headless Chromium and used
//! as a reader uses it.
//!
//! Without Chromium these tests say so and pass, unless `LIBRATION_REQUIRE_BROWSER` is set, as
//! `.ci/run` does. `CHROME` names a program that is none of the usual ones.

#![allow(clippy::unwrap_used)]

mod chromium;
mod devtools;
mod figures;
mod live;
mod live_links;
mod loading;
mod page;
mod reading;
mod report;
