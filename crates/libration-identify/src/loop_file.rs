//! An identified loop as a file of `advise`.

use core::fmt::Write as _;

use libration_report::notation::number;
use libration_report::printable::printable;

use crate::identification::{Identification, StateSpace};
use crate::parameters::Estimated;
use crate::summary::{interval, seconds};

/// The file `loop.toml`: the identified plant with its latency, and a controller to edit.
pub fn loop_file(found: &Identification) -> String {
    let mut file = format!(
        "# Identified by `libration identify` from {} responses. Edit the controller.\n",
        found.responses
    );
    if !found.verdict.is_good() {
        let _ = writeln!(file, "# Verdict: {}.", printable(&found.verdict.to_string()));
    }
    for warning in &found.warnings {
        // Warnings have names of the recording; a new line would end the comment.
        let _ = writeln!(file, "# Warning: {}.", printable(warning));
    }
    let row = |values: &[f64]| {
        format!("[{}]", values.iter().map(|x| text(*x)).collect::<Vec<_>>().join(", "))
    };
    let plant = match found.state_space.a.is_empty() {
        false => found.state_space.clone(),
        // `advise` needs a state: a lag that is short for the recording.
        true => {
            let time = 0.1 * found.interval;
            let _ = writeln!(
                file,
                "# The response is a dead time alone. Its plant here is a lag of {}, which this recording cannot show.",
                seconds(time)
            );
            let rate = 1.0 / time;
            StateSpace {
                a: vec![vec![-rate]],
                b: vec![rate * found.state_space.d],
                c: vec![1.0],
                d: 0.0,
            }
        }
    };
    let rows: Vec<String> = plant.a.iter().map(|values| row(values)).collect();
    let inputs: Vec<String> = plant.b.iter().map(|b| row(&[*b])).collect();
    let _ = write!(
        file,
        "\n# The identified plant with its gain.\n[system.linear]\na = [{}]\nb = [{}]\nc = [{}]\nd = [[{}]]\ninputs = [\"command\"]\noutputs = [\"response\"]\n",
        rows.join(", "),
        inputs.join(", "),
        row(&plant.c),
        text(plant.d)
    );
    let _ = write!(
        file,
        "\n# Weights of the states and of the command, for the controller of least cost.\n[controller.lqr]\nstates = [{}]\ninputs = [1]\n",
        vec!["1"; plant.b.len()].join(", ")
    );
    file + &timing(found)
}

/// A number of a file, with nine digits.
fn text(x: f64) -> String {
    let rounded: f64 = format!("{x:.8e}").parse().unwrap_or(x);
    format!("{rounded:?}")
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
    if let Some([low, high]) = found.delay_range {
        let _ = writeln!(
            table,
            "# Range for the randomisation of environments: action_delay = ({}, {})",
            text(low),
            text(high)
        );
    }
    if let Some(jitter) = found.parameter("jitter") {
        let _ = writeln!(table, "# The latency varies by {} rms.", seconds(jitter.value));
    }
    table
}
