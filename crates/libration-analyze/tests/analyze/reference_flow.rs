//! The reference of errors against closed forms.

use libration::equations::Dynamics;
use libration::number::TwoFloat;
use libration::system::{Kepler, Oscillator};
use libration::{Elementary, Float, Scalar};
use libration_analyze::reference_flow::{Rates, distance, flow};

#[test]
fn the_oscillator_follows_its_closed_form() {
    let dynamics = Dynamics::of::<1>(&Oscillator { omega2: 10.0 }, None);
    let start = [0.3, -1.2].map(TwoFloat::from_f64);
    let (time, omega) = (TwoFloat::from_f64(1.7), TwoFloat::from_f64(10.0).sqrt());
    let (found, off) = flow(&mut Rates::new(&dynamics), &start, time);
    let (sin, cos) = ((omega * time).sin(), (omega * time).cos());
    let exact =
        [start[0] * cos + start[1] * sin * omega.recip(), start[1] * cos - start[0] * omega * sin];
    assert!(distance(&found, &exact) < 1e-27, "{:e}", distance(&found, &exact));
    assert!(off < 1e-27, "{off:e}");
}

/// `E − e sin E = t` gives the time of a place in closed form, without solving for it.
#[test]
fn kepler_follows_keplers_equation() {
    let dynamics = Dynamics::of::<2>(&Kepler { mu: 1.0 }, None);
    let constant = TwoFloat::from_f64;
    let (e, anomaly) = (constant(0.6), constant(2.0));
    let axis = constant(0.64).sqrt();
    let time = anomaly - e * anomaly.sin();
    let speed = ((TwoFloat::one() + e) * (TwoFloat::one() - e).recip()).sqrt();
    let perihelion = [TwoFloat::one() - e, TwoFloat::zero(), TwoFloat::zero(), speed];
    let (found, _) = flow(&mut Rates::new(&dynamics), &perihelion, time);
    // 1 − 0.6² and 0.64 differ by rounding of the constants.
    let exact = [anomaly.cos() - e, axis * anomaly.sin()];
    for (found, exact) in found.iter().zip(exact) {
        assert!((*found - exact).to_f64().abs() < 1e-15);
    }
    let energy = |state: &[TwoFloat]| {
        let energy = dynamics.energy().map(|energy| energy.on::<TwoFloat>().run(state).next());
        energy.flatten().unwrap()
    };
    let change = (energy(&found) - energy(&perihelion)).to_f64();
    assert!(change.abs() < 1e-27, "{change:e}");
}
