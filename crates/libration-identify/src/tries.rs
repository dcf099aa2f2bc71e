use crate::estimate::*;
use crate::information::*;
use crate::interval::*;
use crate::model::*;
use crate::*;
use std::time::Instant;

fn recording(n: usize, dt: f64, dwell: usize) -> Recording {
    let t: Vec<f64> = (0..n).map(|i| i as f64 * dt).collect();
    let mut s = 12345u64;
    let mut u = Vec::new();
    let mut now = 1.0;
    for i in 0..n {
        if i % dwell == 0 {
            s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            now = if s >> 63 == 0 { 1.0 } else { -1.0 };
        }
        u.push(now);
    }
    Recording { command_times: t.clone(), commands: u, response_times: t.clone(), responses: vec![0.0; n] }
}

#[test]
fn coverage() {
    let loops: u64 = std::env::var("LOOPS").map_or(200, |s| s.parse().unwrap());
    for (tau, lag, dt, noise, dist, colour) in [
        (0.0334, 0.05, 0.01, 0.05, 0.0, 0.0), (0.03, 0.05, 0.01, 0.05, 0.0, 0.0), (0.0334, 0.005, 0.01, 0.05, 0.0, 0.0), (0.0334, 0.05, 0.01, 0.05, 0.0, 0.05), (0.0334, 0.05, 0.01, 0.02, 0.03, 0.0)] {
        let rec = recording(400, dt, 4);
        let mut sim = SimulatedLoop::new(ResponseKind::Lag, &[tau, lag]);
        sim.white = noise; sim.gain = 1.3; sim.load = 0.1; sim.disturbance = dist; sim.coloured = (colour, 0.04);
        let mut model = Model { response: ResponseKind::Lag, hold: Hold::Zero, noise: NoiseKind::White, jitter: None, gain: None, known: vec![None, None], longest: 0.2, interval: dt };
        let start = Instant::now();
        let mut hits = [0; 7]; let mut failed = 0; let mut se = [0.0f64; 4];
        for i in 0..loops {
            let y = sim.responses(&rec, 7, i);
            let r = rec.with_responses(y);
            model.noise = NoiseKind::White;
            let Some(mut e) = Estimate::search(&model, &r) else { failed += 1; continue };
            if dist > 0.0 { model.noise = NoiseKind::Disturbance; e = e.extended(&model, &r).unwrap(); }
            if colour > 0.0 { model.noise = NoiseKind::Coloured; e = e.extended(&model, &r).unwrap(); }
            let info = information(&e, &r);
            let d = |i: usize| info.as_ref().map(|f| f.covariance[(i, i)].sqrt());
            let truth = [tau, lag];
            for k in 0..2 {
                if let Some(d) = d(k) { if (e.coordinates[k].abs() - truth[k]).abs() < 1.968 * d { hits[k] += 1; } se[2*k] += d; se[2*k+1] += (e.coordinates[k].abs()-truth[k]).powi(2); }
                let p = profile_interval(&e, &r, Functional::Coordinate(k), d(k));
                if p.contains(truth[k]) { hits[2 + k] += 1; }
            }
            let p = profile_interval(&e, &r, Functional::Sum, d(1));
            if p.contains(tau + lag) { hits[4] += 1; }
            let off = model.coordinates();
            if let Some(d) = d(off) { if (e.regression.coefficients[0] - 1.3).abs() < 1.968 * d { hits[5] += 1; } }
            if i == 0 { eprintln!("{:?} {:?}", e.point, e.regression.coefficients); }
        }
        eprintln!("tau {tau} lag {lag}: fisher {:?} profile {:?} sum {} gain {} failed {failed} of {loops}; se {:?} {:?}; {:?} per loop", &hits[..2], &hits[2..4], hits[4], hits[5], (se[0]/loops as f64, (se[1]/loops as f64).sqrt()), (se[2]/loops as f64, (se[3]/loops as f64).sqrt()), start.elapsed() / loops as u32);
    }
}
