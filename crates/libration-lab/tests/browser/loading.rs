//! Opening the page.

use serde_json::json;

use crate::page::{WIDTHS, visit};

/// Seconds of work until the page can be read.
const READY: f64 = 2.0;

#[test]
fn the_page_opens_without_an_error_and_asks_nobody_for_anything() {
    for width in WIDTHS {
        // `visit` itself insists on both; the page must be there for that to mean something.
        visit(width, |page| assert!(page.number("document.querySelectorAll('h2').length") > 0.0));
    }
}

/// What is measured is the time that the page's thread has worked, not the time that has passed: a
/// busy machine makes the latter as long as it likes. From a cold start to the load event and the
/// next painted frame, everything that the page does lies on that thread: parsing, style, layout,
/// scripts.
#[test]
fn the_page_is_ready_after_less_than_two_seconds_of_work() {
    for width in WIDTHS {
        visit(width, |page| {
            let first = "document.querySelector('figure[data-figure] svg')";
            assert!(page.number(&format!("{first}.getBoundingClientRect().height")) > 0.0);
            let metrics = page.ask("Performance.getMetrics", json!({}));
            let metrics = metrics["metrics"].as_array().unwrap();
            let of = |name: &str| {
                let metric = metrics.iter().find(|m| m["name"] == name).unwrap();
                metric["value"].as_f64().unwrap()
            };
            let (work, script) = (of("TaskDuration"), of("ScriptDuration"));
            println!("{width} pixels: {work:.3} s of work, {script:.3} s of it in scripts");
            assert!(work > 0.0 && work < READY, "{work} s at {width} pixels");
        });
    }
}
