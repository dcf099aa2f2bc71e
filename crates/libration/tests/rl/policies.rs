//! Policies and their random words.

use libration::ensemble::Execution;
use libration::rl::policy::{
    Activation, GaussianExploration, Linear, LinearPerEnvironment, Perceptron,
    PerceptronPerEnvironment,
};
use libration::rl::{Autoreset, Environments, Plan, Rollout};

use crate::any_policy::{AnyPolicy, sequence};
use crate::bits::{POLICY, told};
use crate::{executions, perturbed, plain};

const LINEAR: AnyPolicy<'_> = AnyPolicy::Linear(POLICY);

fn rollout(policy: AnyPolicy<'_>, count: usize) -> Rollout<f32, 2, 1> {
    let mut all = Environments::new(plain(), count, 2, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(300, count).truncated().log_probabilities()).unwrap();
    all.rollout(policy, &mut rollout).unwrap();
    rollout
}

#[test]
fn actions_that_were_recorded_and_are_given_again_lead_to_the_same() {
    let first = rollout(LINEAR, 70);
    let again = rollout(sequence(first.action()), 70);
    assert_eq!(first.observation(), again.observation());
    assert_eq!(first.reward(), again.reward());
}

#[test]
fn weights_for_each_environment_act_as_the_same_for_all() {
    let weights: Vec<f32> = [-3.0, 0.5, 0.25].iter().flat_map(|&w| [w; 70]).collect();
    let each = |weights| AnyPolicy::LinearPerEnvironment(LinearPerEnvironment(weights));
    for execution in executions() {
        let run = |policy| {
            let world = perturbed(Autoreset::SameStep);
            told(world, policy, 0..70, execution.clone(), &[300], Default::default())
        };
        // The bias is added first here as there.
        assert_eq!(run(each(&weights)), run(LINEAR));
    }
    // Environment 40 alone is told to do nothing.
    let mut other = weights.clone();
    for at in [40, 110, 180] {
        other[at] = 0.0;
    }
    let other = rollout(each(&other), 70);
    let all = rollout(LINEAR, 70);
    for n in 0..70 {
        assert_eq!(other.done(5, n) == all.done(5, n), n != 40);
    }
    assert_eq!(other.done(5, 40), [0.0]);
}

#[test]
fn exploration_has_the_deviation_and_the_log_probability_that_it_says() {
    let sigma = 0.7;
    let exploration = GaussianExploration { policy: POLICY, sigma: [sigma] };
    let found = rollout(AnyPolicy::Exploration(exploration), 256);
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
    let found = rollout(AnyPolicy::random(-1.0, 3.0), 256);
    let mean = found.action().iter().map(|&a| f64::from(a)).sum::<f64>() / (300.0 * 256.0);
    assert!(found.action().iter().all(|a| (-1.0..=3.0).contains(a)));
    // Four standard errors: the deviation is 4/√12.
    assert!((mean - 1.0).abs() < 4.0 * (4.0 / 12.0_f64.sqrt()) / (300.0 * 256.0_f64).sqrt());
    assert!(found.log_probability().iter().all(|&log| (log + 4.0_f32.ln()).abs() < 1e-6));
}

#[test]
fn a_network_acts_alike_on_every_instruction_set_and_beside_any_number_of_others() {
    const COUNT: usize = Perceptron::<f32, 8>::parameters(2, 2, 1);
    let parameters: Vec<f32> = (0..COUNT).map(|k| ((k * 37 % 101) as f32 - 50.0) / 80.0).collect();
    let run = |policy: AnyPolicy<'_>, count: usize, execution, horizons: &[usize]| {
        let world = perturbed(Autoreset::SameStep);
        told(world, policy, 0..count, execution, horizons, Default::default())
    };
    for activation in [Activation::Tanh, Activation::Relu] {
        let network = AnyPolicy::Network(Perceptron { parameters: &parameters, activation });
        let wanted = run(network, 130, Execution::serial(), &[100]);
        // Networks for each, which happen to be the same; and where one is not, it alone does something else.
        let mut copies: Vec<f32> = parameters.iter().flat_map(|&p| [p; 130]).collect();
        let each = |parameters: &[f32]| {
            let networks = PerceptronPerEnvironment { parameters, activation };
            run(AnyPolicy::NetworkPerEnvironment(networks), 130, Execution::serial(), &[100])
        };
        assert_eq!(each(&copies), wanted);
        copies[(COUNT - 1) * 130 + 77] += 0.5;
        let found = each(&copies);
        for n in 0..130 {
            assert_eq!(found[n] == wanted[n], n != 77);
        }
        for execution in executions() {
            assert_eq!(run(network, 3, execution, &[60, 40])[..], wanted[..3]);
        }
        // It does something, and not always the same.
        assert!(wanted[0].iter().any(|now| now.action != wanted[0][0].action));
    }
}
