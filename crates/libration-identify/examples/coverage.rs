//! How often 95 % intervals contain the truth, for noise that the model has and that it has not.
//!
//! `cargo run --release -p libration-identify --example coverage -- 1500`, with a part of the name of a noise for that noise alone.

use std::sync::atomic::AtomicBool;

use libration_identify::{
    Hold, Identification, IdentifyError, NoiseKind, Recording, Request, ResponseKind,
    SimulatedLoop, identify,
};
use libration_work::{Interrupted, Silent, Work};

/// A kind of loop.
struct Case {
    name: &'static str,
    noise: NoiseKind,
    dead_time: f64,
    lag: f64,
    simulated: fn(SimulatedLoop) -> SimulatedLoop,
    /// Noise that no model has.
    foreign: fn(f64, u64) -> f64,
    /// The time of a single step, in place of random ones, in s.
    step: Option<f64>,
    /// What acts of a command of random levels; of `None`, commands have two levels.
    acting: Option<fn(f64) -> f64>,
}

/// Dead times are those of the middle of a period, of a whole number of periods, and of a lag that is short for the samples.
const CASES: [Case; 15] = [
    Case {
        name: "white, part of a period",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: None,
    },
    Case {
        name: "white, whole periods",
        noise: NoiseKind::White,
        dead_time: 0.03,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: None,
    },
    Case {
        name: "white, short lag",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.005,
        simulated: |plain| SimulatedLoop { white: 0.05, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: None,
    },
    Case {
        name: "coloured",
        noise: NoiseKind::Coloured,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, coloured: (0.05, 0.04), ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: None,
    },
    Case {
        name: "disturbance",
        noise: NoiseKind::Disturbance,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.02, disturbance: 0.03, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: None,
    },
    Case {
        name: "coloured, fitted as white",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.03, coloured: (0.06, 0.04), ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: None,
    },
    Case {
        name: "hum of 7 Hz, which no model has",
        noise: NoiseKind::Coloured,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.03, ..plain },
        foreign: |time, seed| 0.08 * (44.0 * time + seed as f64).sin(),
        step: None,
        acting: None,
    },
    Case {
        name: "white, a step at 0.1 s",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.02, load: 0.0, ..plain },
        foreign: |_, _| 0.0,
        step: Some(0.1),
        acting: None,
    },
    Case {
        name: "white, a step at 1 s",
        noise: NoiseKind::White,
        dead_time: 0.03,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.02, load: 0.0, ..plain },
        foreign: |_, _| 0.0,
        step: Some(1.0),
        acting: None,
    },
    Case {
        name: "random levels, white",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: Some(|u| u),
    },
    Case {
        name: "random levels, coloured",
        noise: NoiseKind::Coloured,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, coloured: (0.05, 0.04), ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: Some(|u| u),
    },
    Case {
        name: "random levels, disturbance",
        noise: NoiseKind::Disturbance,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.02, disturbance: 0.03, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: Some(|u| u),
    },
    Case {
        name: "command in steps of 1/16",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: Some(|u| (16.0 * u).round() / 16.0),
    },
    Case {
        name: "dead zone of 0.05",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: Some(|u| u - u.clamp(-0.05, 0.05)),
    },
    Case {
        name: "limit of 0.8",
        noise: NoiseKind::White,
        dead_time: 0.0334,
        lag: 0.05,
        simulated: |plain| SimulatedLoop { white: 0.05, ..plain },
        foreign: |_, _| 0.0,
        step: None,
        acting: Some(|u| u.clamp(-0.8, 0.8)),
    },
];

fn main() -> Result<(), IdentifyError> {
    let count: u64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(200);
    let wanted = std::env::args().nth(2).unwrap_or_default();
    let stop = AtomicBool::new(false);
    let work = Work::new(&Silent, &stop);
    println!(
        "{:<34} {:>9} {:>9} {:>9} {:>9} {:>13} {:>9}",
        "noise", "dead time", "lag", "latency", "gain", "contradicted", "not good"
    );
    for case in CASES.iter().filter(|case| case.name.contains(&wanted)) {
        let trajectories: Vec<u64> = (0..count).collect();
        let found = work.sweep("loops", &trajectories, |&trajectory| {
            Ok::<_, Interrupted>(identified(case, trajectory).ok())
        })?;
        let found: Vec<Identification> = found.into_iter().flatten().collect();
        let truths = [
            ("dead_time", case.dead_time),
            ("lag", case.lag),
            ("latency", case.dead_time + case.lag),
            ("gain", GAIN),
        ];
        let shares = truths.map(|(key, truth)| {
            let holds = |one: &&Identification| {
                one.parameter(key)
                    .and_then(|p| p.likelihood_interval)
                    .is_some_and(|i| i.contains(truth))
            };
            100.0 * found.iter().filter(holds).count() as f64 / count as f64
        });
        let bad = found.iter().filter(|one| !one.verdict.is_good()).count();
        let contradicted = found.iter().filter(|one| one.is_contradicted).count();
        println!(
            "{:<34} {:>7.2} % {:>7.2} % {:>7.2} % {:>7.2} % {:>11.2} % {:>7.2} %",
            case.name,
            shares[0],
            shares[1],
            shares[2],
            shares[3],
            100.0 * contradicted as f64 / count as f64,
            100.0 * bad as f64 / count as f64
        );
    }
    Ok(())
}

const GAIN: f64 = 1.3;

/// The identification of one simulated loop.
fn identified(case: &Case, trajectory: u64) -> Result<Identification, IdentifyError> {
    let times: Vec<f64> = (0..400).map(|i| f64::from(i) * 0.01).collect();
    // Random steps, held for four periods.
    let mut word = 0x9e37_79b9_7f4a_7c15_u64;
    let mut commands = Vec::new();
    for i in 0..times.len() {
        if i % 4 == 0 {
            word = word
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
        }
        let level = (word >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        commands.push(if case.acting.is_some() { level } else { level.signum() });
    }
    if let Some(step) = case.step {
        commands = times.iter().map(|&time| if time < step - 1e-9 { 0.0 } else { 1.0 }).collect();
    }
    let blank = vec![0.0; times.len()];
    let blank = Recording {
        command_times: times.clone(),
        commands: commands.iter().map(|&u| case.acting.map_or(u, |acting| acting(u))).collect(),
        response_times: times.clone(),
        responses: blank,
    };
    let plain = SimulatedLoop {
        gain: GAIN,
        load: 0.1,
        ..SimulatedLoop::new(ResponseKind::Lag, &[case.dead_time, case.lag])
    };
    let mut responses = (case.simulated)(plain).responses(&blank, 1, trajectory);
    for (response, &time) in responses.iter_mut().zip(&times) {
        *response += (case.foreign)(time, trajectory);
    }
    let recording = Recording::new(&times, &commands, &times, &responses)?;
    let request = Request {
        responses: vec![ResponseKind::Lag],
        noises: vec![case.noise],
        holds: vec![Hold::Zero],
        largest_dead_time: if case.step.is_some() { None } else { Some(0.2) },
        arrivals: false,
        details: false,
        bootstrap: 0,
        ..Request::default()
    };
    let stop = AtomicBool::new(false);
    identify(&recording, &request, &Work::new(&Silent, &stop))
}
