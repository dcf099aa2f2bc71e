//! Tables of request files.

use std::collections::BTreeMap;

use libration_settings::latency_presets::LatencyValue;
use libration_settings::{Count, Number, StartTable, SystemTables, duration};
use serde::Deserialize;

/// A request file. Tables of other commands are ignored.
#[derive(Deserialize)]
#[serde(default)]
pub(super) struct RequestFile {
    pub(super) tolerance: BTreeMap<String, Number>,
    pub(super) request: RequestTable,
    pub(super) system: SystemTables,
    pub(super) start: StartTable,
    pub(super) controller: Option<ControllerTable>,
    #[serde(rename = "loop")]
    pub(super) looped: Option<LoopTable>,
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct RequestTable {
    #[serde(deserialize_with = "duration::number")]
    pub(super) horizon: Number,
    pub(super) rollout: [Count; 2],
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum ControllerTable {
    Pd(PdTable),
    Pid(PidTable),
    Lqr(LqrTable),
    Observer(ObserverTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PdTable {
    pub(super) position: Number,
    pub(super) velocity: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PidTable {
    pub(super) proportional: Number,
    pub(super) integral: Number,
    pub(super) derivative: Number,
    #[serde(default = "zero", deserialize_with = "duration::number")]
    pub(super) filter: Number,
    #[serde(default = "infinite")]
    pub(super) most: Number,
    #[serde(default = "one")]
    pub(super) tracking: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LqrTable {
    pub(super) weights: [Number; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObserverTable {
    pub(super) weights: Option<[Number; 3]>,
    pub(super) gains: Option<[Number; 2]>,
    pub(super) acceleration: Option<Number>,
    pub(super) position: Option<Number>,
    pub(super) correction: Option<[Number; 2]>,
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct LoopTable {
    #[serde(deserialize_with = "duration::number_of_period")]
    pub(super) period: Number,
    pub(super) latency: LatencyValue,
    pub(super) jitter: Number,
    pub(super) law: String,
    pub(super) skew: Number,
    pub(super) loss: Number,
    pub(super) time_stamps: String,
    pub(super) cost: Vec<Number>,
    pub(super) deviation: Number,
}

fn zero() -> Number {
    Number(0.0)
}

fn one() -> Number {
    Number(1.0)
}

fn infinite() -> Number {
    Number(f64::INFINITY)
}

impl Default for RequestFile {
    fn default() -> Self {
        RequestFile {
            tolerance: [("trajectory".to_owned(), Number(1e-3))].into(),
            request: RequestTable::default(),
            system: SystemTables::of("oscillator", &[("omega2", 10.0)]),
            start: StartTable::default(),
            controller: None,
            looped: None,
        }
    }
}

impl Default for RequestTable {
    fn default() -> Self {
        RequestTable { horizon: Number(10.0), rollout: [Count(4096), Count(1024)] }
    }
}

impl Default for LoopTable {
    fn default() -> Self {
        LoopTable {
            period: Number(0.01),
            latency: LatencyValue(0.0),
            jitter: zero(),
            law: "gaussian".into(),
            skew: zero(),
            loss: zero(),
            time_stamps: String::new(),
            cost: Vec::new(),
            deviation: Number(0.1),
        }
    }
}
