//! Whether a step responds to an action in proportion to it, over the range of the action.

use libration_report::notation::number;

use crate::BlackBoxError;
use crate::linearised_step::LinearisedStep;
use crate::prober::Prober;

/// Sizes of the change of an action, in units of its scale.
const LEVELS: [f64; 3] = [1.0 / 64.0, 1.0 / 8.0, 1.0 / 2.0];
/// Largest ratio of the slopes at two sizes: that of a square of an action beyond its own size is 1.7.
const RATIO: f64 = 2.0;
/// A slope below this in units of the scales is none: roundings are far below.
const NOTHING: f64 = 1e-12;

/// Why the effect of an action is not known; `None` if the step responds in proportion.
///
/// # Errors
/// Those of the simulator.
pub(crate) fn uneven_response(
    prober: &mut Prober<'_>,
    step: &LinearisedStep,
    input: usize,
) -> Result<Option<String>, BlackBoxError> {
    let subject = prober.subject;
    let (x, scale, name) = (&subject.state, &subject.state_scale, &subject.inputs[input].name);
    let unit = subject.action_scale[input];
    let slope_of = |change: &[f64]| {
        change.iter().zip(scale).fold(0.0_f64, |most, (y, scale)| most.max((y / scale).abs()))
    };
    let centre = prober.step_one(x, &subject.action, subject.dt)?;
    let column: Vec<f64> = (0..x.len()).map(|i| step.b[(i, input)] * unit).collect();
    let mut slopes = vec![("a change towards zero".to_owned(), slope_of(&column))];
    for level in LEVELS {
        for signed in [level, -level] {
            let mut action = subject.action.clone();
            action[input] += signed * unit;
            let Ok(moved) = prober.step_one(x, &action, subject.dt) else { continue };
            let change: Vec<f64> =
                moved.iter().zip(&centre).map(|(a, b)| (a - b) / level).collect();
            slopes.push((format!("a change by {}", number(signed * unit, 3)), slope_of(&change)));
        }
    }
    let order = |a: &&(String, f64), b: &&(String, f64)| a.1.total_cmp(&b.1);
    let (Some(least), Some(most)) = (slopes.iter().min_by(order), slopes.iter().max_by(order))
    else {
        return Ok(None);
    };
    if most.1 <= NOTHING {
        return Ok(Some(format!("no state responds to `{name}` within a step")));
    }
    Ok((most.1 > RATIO * least.1.max(NOTHING)).then(|| {
        format!(
            "the response to `{name}` is not proportional to it: per unit of the action, {} has {} of the effect of {}",
            least.0,
            number(least.1 / most.1, 2),
            most.0
        )
    }))
}
