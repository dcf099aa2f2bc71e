//! Analysis of integrators, derived from the shipped step.
//!
//! No formula is copied from a textbook: the step runs on dual numbers, on polynomials in the
//! time step, or with 1024 bits, and the results follow from its output.

mod complex;
mod conserved_sums;
mod cramers_rule;
mod data_flow;
mod drift_forecast;
mod eigenvalues;
mod energy_band;
mod equilibrium;
mod equilibrium_search;
mod error_forecast;
mod exponential;
mod factorisation;
mod langevin_formula;
mod langevin_mode;
mod largest_step;
mod linear_map;
mod linear_step;
mod linear_stepper;
mod linearisation;
mod neutral_steps;
mod nystrom_certificate;
mod operation_trace;
mod orbit_error;
mod orbit_start;
mod order_certificate;
mod oscillator_windows;
mod precision;
mod quadratic_form;
mod rate_rounding;
mod rational_step;
mod roots;
mod runge_kutta_certificate;
mod spectrum;
mod splitting_certificate;
mod stability_function;
mod stability_window;
mod stable_steps;
mod step_limits;
mod step_modes;
mod step_search;
mod step_window;
mod symbolic_step;
mod tableau;
mod timing;
mod update_matrix;

pub use complex::Complex;
pub use conserved_sums::{ConservedSum, ConservedSums, conserved_sums};
pub use data_flow::{DataFlow, Operation};
pub use drift_forecast::{DriftForecast, drift_keeps_within, forecast_drift};
pub use eigenvalues::{determinant, eigenvalues};
pub use energy_band::EnergyBand;
pub use equilibrium::{Equilibrium, jacobian, rate_derivative};
pub use error_forecast::ErrorForecast;
pub use langevin_formula::covariance_formulas;
pub use langevin_mode::{
    ModeCovariance, bias_orders, letters, mode_biases, mode_covariance, mode_memory,
    stability_margin,
};
pub use largest_step::{Criterion, LargestStep};
pub use linear_map::LinearMap;
pub use linear_step::StepOn;
pub use linear_stepper::{LinearStepper, positions_and_velocities};
pub use linearisation::Linearisation;
pub use nystrom_certificate::NystromCertificate;
pub use orbit_error::OrbitError;
pub use orbit_start::OrbitStart;
pub use order_certificate::OrderCertificate;
pub use oscillator_windows::oscillator_windows;
pub use precision::{Cycle, LocalRounding, float_clock};
pub use quadratic_form::QuadraticForm;
pub use rate_rounding::eigenvalue_rounding;
pub use rational_step::{RationalStep, UnknownImplicitStep};
pub use runge_kutta_certificate::RungeKuttaCertificate;
pub use spectrum::{Eigenvalues, Spectrum};
pub use splitting_certificate::SplittingCertificate;
pub use stability_function::StabilityFunction;
pub use stability_window::StabilityWindow;
pub use stable_steps::without_rounding;
pub use step_limits::StepLimits;
pub use step_modes::StepMode;
pub use step_window::StepWindow;
pub use symbolic_step::{SymbolicStep, UnknownStep};
pub use tableau::{Letter, Tableau};
pub use timing::{
    CostError, HiddenLatency, Imperfections, JitterMargin, LatencyWindows, LinearController,
    LqrError, MeanSquare, Mode, NotLinear, ObserverNoise, Plant, Regulator, Resonance, StepNoise,
    Switching, SwitchingError, ZohStep,
};
pub use update_matrix::UpdateMatrix;
