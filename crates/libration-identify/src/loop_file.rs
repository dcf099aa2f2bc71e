//! An identified loop as a file of `advise`.

use core::fmt::Write as _;

use libration_report::notation::number;

use crate::identification::Identification;
use crate::parameters::Estimated;
use crate::summary::{interval, seconds};

/// The file `loop.toml`: the identified plant with its latency, and a controller to edit.
pub fn loop_file(found: &Identification) -> String {
    let value = |key: &str| found.parameter(key).map(|parameter| parameter.value);
    let gain = value("gain").unwrap_or(1.0);
    let lag = value("lag").unwrap_or(0.0);
    let mut file = format!(
        "# Identified by `libration identify` from {} responses. Edit the controller.\n",
        found.responses
    );
    for warning in &found.warnings {
        let _ = writeln!(file, "# Warning: {warning}.");
    }
    let denominator = match (found.response, lag > 0.0) {
        ("second-order", _) => {
            let (time, zeta) =
                (value("time_constant").unwrap_or(1.0), value("damping_ratio").unwrap_or(1.0));
            format!("[{}, {}, 1]", text(time * time), text(2.0 * zeta * time))
        }
        ("integrated-lag", true) => format!("[{}, 1, 0]", text(lag)),
        ("integrated-lag", false) => "[1, 0]".to_owned(),
        ("lag", true) => format!("[{}, 1]", text(lag)),
        ("plant", true) => return part(found, &file, lag),
        ("plant", false) => return part(found, &file, 0.0),
        // `advise` needs a state: a lag that is short for the recording.
        _ => {
            let time = 0.1 * found.interval;
            let _ = writeln!(
                file,
                "# The response is a dead time alone. Its plant here is a lag of {}, which the recording does not tell from none.",
                seconds(time)
            );
            format!("[{}, 1]", text(time))
        }
    };
    let _ = write!(
        file,
        "\n[system.linear]\nnumerator = [{}]\ndenominator = {denominator}\ninputs = [\"command\"]\noutputs = [\"response\"]\n",
        text(gain)
    );
    let _ = write!(
        file,
        "\n# Weights of the states and of the command, for the controller of least cost.\n[controller.lqr]\nstates = [{}]\ninputs = [1]\n",
        vec!["1"; states(&denominator)].join(", ")
    );
    file + &timing(found)
}

/// A number of a file, with nine digits.
fn text(x: f64) -> String {
    let rounded: f64 = format!("{x:.8e}").parse().unwrap_or(x);
    format!("{rounded:?}")
}

/// The number of states of a denominator.
fn states(denominator: &str) -> usize {
    denominator.matches(',').count()
}

/// The lines for a loop whose plant is in a file already.
fn part(found: &Identification, head: &str, lag: f64) -> String {
    let mut file = format!("{head}# Add these tables to the file of the plant.\n");
    if lag > 0.0 {
        let _ = write!(
            file,
            "\n[[part]]\nname = \"identified lag\"\ninput = \"u1\"  # the name of the input\nlag = {}  # s\n",
            text(lag)
        );
    }
    file + &timing(found)
}

/// The table `[loop]`.
fn timing(found: &Identification) -> String {
    let commented = |parameter: &Estimated| match parameter.interval {
        Some(_) => format!("  # s; 95 % interval: {}", interval(parameter)),
        None => "  # s".to_owned(),
    };
    let mut table =
        format!("\n[loop]\nperiod = {}  # s, the median of the commands\n", text(found.period));
    if let Some(dead_time) = found.parameter("dead_time") {
        let _ = writeln!(table, "latency = {}{}", text(dead_time.value), commented(dead_time));
    }
    if let Some(loss) = found.parameter("loss") {
        let _ = writeln!(table, "loss = {}", text(loss.value));
    }
    if let Some(second) = found.parameter("second_dead_time") {
        let share = found.parameter("second_share").map_or(0.0, |share| share.value);
        let _ = writeln!(
            table,
            "# A share of {} of the commands arrives after {}.",
            number(share, 3),
            seconds(second.value)
        );
    }
    if let Some(jitter) = found.parameter("jitter") {
        let _ = writeln!(table, "# The latency varies by {} rms.", seconds(jitter.value));
    }
    table
}
