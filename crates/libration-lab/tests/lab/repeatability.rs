//! The same run on one thread and on several.

use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_lab::STUDIES;
use libration_report::Record;
use libration_study::{Config, Effort, Lab, Silent};
use libration_study_motion::{
    AdaptiveSettings, DriftSettings, EfficiencySettings, ErrorSettings, NonlinearSettings,
    PrecisionSettings, StabilitySettings,
};

/// Two methods, and horizons of a hundredth to a tenth of the default: each sweep still has several items.
fn short_config() -> Config {
    let defaults = EfficiencySettings::default();
    let splitting_methods = defaults.splitting_methods.iter().take(1).copied().collect();
    let systems = ["henon-heiles", "kepler"].map(String::from).to_vec();
    Config { integrators: vec![Method::VelocityVerlet, Method::Rk4], ..STUDIES.config() }
        .with(AdaptiveSettings { eccentricities: vec![0.9], steps: 400, periods: 100 })
        .with(DriftSettings { steps: 20_000, ..Default::default() })
        .with(EfficiencySettings { periods: vec![10, 1000], splitting_methods, ..defaults })
        .with(ErrorSettings { steps: 20_000, ..Default::default() })
        .with(NonlinearSettings { systems, turns: 100, ..Default::default() })
        .with(PrecisionSettings { steps: 20_000, ..Default::default() })
        .with(StabilitySettings { steps: vec![100, 1000, 10_000], ..Default::default() })
}

/// Findings without the time that `efficiency` measures, which does not repeat.
fn without_times(record: &Record) -> Vec<(&str, u64)> {
    let findings = record.findings.iter().filter(|finding| !finding.id.ends_with(".time"));
    findings.map(|finding| (finding.id.as_str(), finding.measured.to_bits())).collect()
}

#[test]
fn a_run_repeats_to_the_bit_on_one_thread_and_on_many() {
    let (config, stop) = (short_config(), AtomicBool::new(false));
    let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
    let pools =
        [1, 4].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap());
    // That ensembles of loops repeat on any number of threads the engine's tests show, and `determinism`; `throughput`,
    // `memory`, `rollout` and `storage` measure time.
    let others = [
        "latency",
        "jitter",
        "asynchrony",
        "hierarchy",
        "throughput",
        "memory",
        "rollout",
        "storage",
    ];
    let mut values = 0;
    for study in STUDIES.studies.iter().filter(|study| !others.contains(&study.name())) {
        let [a, b] = pools.each_ref().map(|pool| pool.install(|| study.run(&lab)).unwrap());
        if study.name() == "efficiency" {
            assert_eq!(without_times(&a), without_times(&b));
            continue;
        }
        assert_eq!(serde_json::to_string(&a).unwrap(), serde_json::to_string(&b).unwrap());
        // NaN marks missing values: columns are compared by their bits.
        assert_eq!(a.series.len(), b.series.len());
        for (a, b) in
            a.series.iter().zip(&b.series).flat_map(|(a, b)| a.columns.iter().zip(&b.columns))
        {
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&a.values), bits(&b.values), "{}", a.name);
            values += a.values.len();
        }
    }
    assert!(values > 10_000, "{values}");
}
