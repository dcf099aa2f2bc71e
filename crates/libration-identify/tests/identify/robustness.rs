//! Recordings of any numbers.

use std::sync::atomic::AtomicBool;

use libration_identify::{Recording, Request, identify, loop_file, page};
use libration_work::{Silent, Work};

use crate::loops::Draws;

#[test]
fn no_numbers_lead_to_a_panic_and_results_are_finite_or_refused() {
    let mut draws = Draws(99);
    let time_sizes = [1e-300, 1e-8, 0.01, 1.0, 1e6];
    let sizes = [1e-90, 1e-8, 1.0, 1e90, 1e300];
    let stop = AtomicBool::new(false);
    let mut identified = 0;
    for round in 0..8 {
        let count = 40 + (round * 7) % 60;
        let mut one_of = |sizes: &[f64; 5]| sizes[((draws.uniform() + 1.0) * 2.5) as usize % 5];
        let (time, command, response) = (one_of(&time_sizes), one_of(&sizes), one_of(&sizes));
        let mut now = 0.0;
        let mut times = Vec::new();
        for _ in 0..count {
            // Some stamps repeat.
            now += (draws.uniform() + 0.4).max(0.0) * time;
            times.push(now);
        }
        let commands: Vec<f64> =
            (0..count).map(|_| (2.0 * draws.uniform()).round() * command).collect();
        let responses: Vec<f64> = (0..count).map(|_| draws.uniform() * response).collect();
        let Ok(recording) = Recording::new(&times, &commands, &times, &responses) else { continue };
        let request = Request { bootstrap: 10, ..Request::default() };
        if let Ok(found) = identify(&recording, &request, &Work::new(&Silent, &stop)) {
            identified += 1;
            assert!(found.parameters.iter().all(|p| p.value.is_finite()), "{}", found.answer);
            assert!(page(&found).len() > 1000 && loop_file(&found).contains("[loop]"));
        }
    }
    assert!(identified > 1, "{identified}");
}
