//! Pages of identifications whose numbers have no intervals.

use libration_identify::{Hold, Identification, NoiseKind, Recording, Request, ResponseKind, page};
use libration_report::Outcome;

use crate::loops::{Draws, commands, identified, lag_response, quick};

/// A lag under noise of a standard deviation of 0.05, which `decay` relates to the sample before, by a white model.
fn lag_with_noise(decay: f64) -> Identification {
    let (times, commands) = commands(260, 4, &mut Draws(3));
    let arrivals: Vec<(f64, f64)> =
        times.iter().zip(&commands).map(|(t, u)| (t + 0.0334, *u)).collect();
    let mut draws = Draws(1000);
    let mut error = 0.0;
    let mut responses = lag_response(&arrivals, 0.05, 1.3, &times);
    for response in &mut responses {
        error = decay * error + (1.0 - decay * decay).sqrt() * draws.normal();
        *response += 0.05 * error;
    }
    let request = Request {
        responses: vec![ResponseKind::Lag],
        noises: vec![NoiseKind::White],
        holds: vec![Hold::Zero],
        largest_dead_time: Some(0.1),
        arrivals: false,
        bootstrap: 10,
        details: true,
        ..quick()
    };
    identified(
        &Recording::new(&times, &commands, &times, &responses).expect("a recording"),
        &request,
    )
}

/// The sentences of a page about intervals, besides the one that there are none.
const OF_INTERVALS: [&str; 4] =
    ["95 % interval", "95 % region", "confirm the intervals", "Fisher's information"];

#[test]
fn a_page_without_intervals_shows_and_warns_of_none() {
    let found = lag_with_noise(0.8);
    assert_eq!(found.verdict.outcome, Outcome::Fault, "{}", found.answer);
    assert!(found.warnings.iter().any(|warning| warning.contains("residuals are correlated")));
    assert!(found.warnings.iter().all(|own| !own.contains("interval")), "{:?}", found.warnings);
    let text = page(&found);
    assert!(text.contains("The numbers have no intervals, as the verdict is “fault”."));
    for part in OF_INTERVALS {
        assert!(!text.contains(part), "{part}");
    }
    // White noise contradicts nothing.
    let found = lag_with_noise(0.0);
    assert_eq!(found.verdict.outcome, Outcome::NoFault, "{}", found.answer);
    let text = page(&found);
    for part in OF_INTERVALS {
        assert!(text.contains(part), "{part}");
    }
}

#[test]
fn a_response_that_does_not_depend_on_the_command_has_no_chosen_model_to_warn_of() {
    // With these draws another model fits noise as well as the one of least criterion.
    for seed in [4, 9, 28] {
        let mut draws = Draws(seed);
        let (times, commands) = commands(300, 5, &mut draws);
        let responses: Vec<f64> = times.iter().map(|_| draws.normal()).collect();
        let recording = Recording::new(&times, &commands, &times, &responses).unwrap();
        let request =
            Request { responses: vec![ResponseKind::Lag, ResponseKind::Delay], ..quick() };
        let found = identified(&recording, &request);
        assert!(!found.depends_on_command && !found.verdict.is_good(), "{}", found.answer);
        let is_of_model = |own: &String| own.contains("model fits") || own.contains("interval");
        assert!(!found.warnings.iter().any(is_of_model), "{:?}", found.warnings);
    }
}
