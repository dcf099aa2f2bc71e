//! Loops with filters of samples and with cascades against `tools/cascade_reference.py`, which was written from their definition alone.

use libration::linear::{Cascade, ControllerSchedule, DiscreteFilter};
use serde_json::Value;

use super::linear_reference::{compare, controller, number, read};

fn whole(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

/// The filters of some channels, each with its number.
fn filters(value: &Value) -> Vec<(usize, DiscreteFilter)> {
    let filter = |row: &Value| {
        let kind = match row[1].as_str().unwrap() {
            "difference" => DiscreteFilter::Difference,
            _ => DiscreteFilter::MovingAverage(whole(&row[2])),
        };
        (whole(&row[0]), kind)
    };
    value.as_array().unwrap().iter().map(filter).collect()
}

fn controllers(case: &Value) -> ControllerSchedule {
    let [inputs, outputs] = ["input_weights", "c"].map(|name| case[name].as_array().unwrap().len());
    let period = number(&case["period"]);
    let own: ControllerSchedule = match &case["cascade"] {
        Value::Null => controller(&case["controller"], outputs).into(),
        cascade => {
            let outer = controller(&cascade["outer"], outputs);
            let references = outer.commands();
            Cascade {
                inner: controller(&cascade["inner"], outputs + references),
                outer,
                inner_every: whole(&cascade["inner_every"]),
                outer_every: whole(&cascade["every"]),
                outer_latency: whole(&cascade["outer_latency"]),
            }
            .schedule()
            .unwrap()
        }
    };
    own.after(&DiscreteFilter::bank(outputs, &filters(&case["output_filters"]), period))
        .before(&DiscreteFilter::bank(inputs, &filters(&case["input_filters"]), period))
}

#[test]
fn filters_and_cascades_have_the_radius_growth_and_cost_of_a_program_from_the_definition() {
    let reference: Value =
        serde_json::from_str(include_str!("../reference/cascades.json")).unwrap();
    let cases = reference["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 24);
    for (i, case) in cases.iter().enumerate() {
        let (linear, timing) = read(case, controllers(case));
        compare(i, case, &linear, &timing);
    }
}
