//! Policies and their random words.

use libration::ensemble::Execution;
use libration::rl::policy::{
    ActionSequence, Activation, GaussianExploration, Linear, LinearPerEnvironment, Perceptron,
    PerceptronPerEnvironment, Random,
};
use libration::rl::{Environments, Plan, Policy, Rollout, World};

use crate::bits::{POLICY, told};
use crate::{executions, ideal, plain};

fn rollout<P: Policy<f32, 2, 1>>(policy: P, count: usize) -> Rollout<f32, 2, 1> {
    rollout_of(plain(), policy, count, Execution::serial())
}

fn rollout_of<E: World<f32, 2, 1>, P: Policy<f32, 2, 1>>(
    world: E,
    policy: P,
    count: usize,
    execution: Execution,
) -> Rollout<f32, 2, 1> {
    let mut all = Environments::new(world, count, 2, execution).unwrap();
    let mut rollout = Rollout::new(Plan::new(300, count).truncated().log_probabilities()).unwrap();
    all.rollout(policy, &mut rollout).unwrap();
    rollout
}

#[test]
fn actions_that_were_recorded_and_are_given_again_lead_to_the_same() {
    let first = rollout(POLICY, 70);
    let again = rollout(ActionSequence(first.action()), 70);
    assert_eq!(first.observation(), again.observation());
    assert_eq!(first.reward(), again.reward());
}

#[test]
fn weights_for_each_environment_act_as_the_same_for_all() {
    let weights: Vec<f32> = [-3.0, 0.5, 0.25].iter().flat_map(|&w| [w; 70]).collect();
    for execution in executions() {
        let each = rollout_of(ideal(), LinearPerEnvironment(&weights), 70, execution);
        let all = rollout(POLICY, 70);
        // The bias is added first here as there.
        assert_eq!(each.observation(), all.observation());
    }
    // Environment 40 alone is told to do nothing.
    let mut other = weights.clone();
    for at in [40, 110, 180] {
        other[at] = 0.0;
    }
    let other = rollout(LinearPerEnvironment(&other), 70);
    let all = rollout(POLICY, 70);
    for n in 0..70 {
        assert_eq!(other.done(5, n) == all.done(5, n), n != 40);
    }
    assert_eq!(other.done(5, 40), [0.0]);
}

#[test]
fn exploration_has_the_deviation_and_the_log_probability_that_it_says() {
    let sigma = 0.7;
    let found = rollout(GaussianExploration { policy: POLICY, sigma: [sigma] }, 256);
    let mean = Linear { weights: [[-3.0_f64, 0.5]], bias: [0.25] };
    let (mut sum, mut squares) = (0.0, 0.0);
    for t in 0..300 {
        for n in 0..256 {
            let seen = found.seen(t, n).map(f64::from);
            let mean = mean.bias[0] + mean.weights[0][0] * seen[0] + mean.weights[0][1] * seen[1];
            let z = (f64::from(found.done(t, n)[0]) - mean) / sigma;
            (sum, squares) = (sum + z, squares + z * z);
            let density = -0.5 * z * z - sigma.ln() - 0.5 * std::f64::consts::TAU.ln();
            let said = f64::from(found.log_probability()[t * 256 + n]);
            // Rounding of an action of some units to f32, times what it is multiplied with.
            assert!((said - density).abs() < 1e-5 * (1.0 + z.abs()), "{said} {density}");
        }
    }
    // Four standard errors of 76 800 draws: 1/√n, and √(2/n).
    let count = 300.0 * 256.0_f64;
    assert!((sum / count).abs() < 4.0 / count.sqrt());
    assert!((squares / count - 1.0).abs() < 4.0 * (2.0 / count).sqrt());
}

#[test]
fn random_actions_are_uniform_between_their_ends_and_equally_likely() {
    let found = rollout(Random::between([-1.0], [3.0]), 256);
    let mean = found.action().iter().map(|&a| f64::from(a)).sum::<f64>() / (300.0 * 256.0);
    assert!(found.action().iter().all(|a| (-1.0..=3.0).contains(a)));
    // Four standard errors: the deviation is 4/√12.
    assert!((mean - 1.0).abs() < 4.0 * (4.0 / 12.0_f64.sqrt()) / (300.0 * 256.0_f64).sqrt());
    assert!(found.log_probability().iter().all(|&log| (log + 4.0_f32.ln()).abs() < 1e-6));
}

#[test]
fn a_network_acts_alike_on_every_instruction_set_and_beside_any_number_of_others() {
    const COUNT: usize = Perceptron::<f32, 16>::parameters(2, 2, 1);
    let parameters: Vec<f32> = (0..COUNT).map(|k| ((k * 37 % 101) as f32 - 50.0) / 80.0).collect();
    for activation in [Activation::Tanh, Activation::Relu] {
        let network = Perceptron::<f32, 16> { parameters: &parameters, activation };
        let how = Default::default();
        let wanted = told(ideal(), network, 0..130, Execution::serial(), &[100], how);
        // Networks for each, which happen to be the same; and where one is not, it alone does something else.
        let mut copies: Vec<f32> = parameters.iter().flat_map(|&p| [p; 130]).collect();
        let each = PerceptronPerEnvironment::<f32, 16> { parameters: &copies, activation };
        assert_eq!(told(plain(), each, 0..130, Execution::serial(), &[100], how), wanted);
        copies[(COUNT - 1) * 130 + 77] += 0.5;
        let each = PerceptronPerEnvironment::<f32, 16> { parameters: &copies, activation };
        let found = told(plain(), each, 0..130, Execution::serial(), &[100], how);
        for n in 0..130 {
            assert_eq!(found[n] == wanted[n], n != 77);
        }
        for execution in executions() {
            let found = told(ideal(), network, 0..3, execution, &[60, 40], how);
            assert_eq!(found[..], wanted[..3]);
        }
        // It does something, and not always the same.
        assert!(wanted[0].iter().any(|now| now.action != wanted[0][0].action));
    }
}
