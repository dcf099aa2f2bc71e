//! Windows of latencies that channels have together, against the eigenvalues of whole period matrices.

#![allow(clippy::unwrap_used)]

use libration_core::control::Latency;
use libration_linear::{
    ChannelPart, Channels, CostWeights, DiscreteController, LatencyWindow, LinearLoop,
    LinearLoopError, LinearPlant, LoopTiming, Matrix, eigenvalues, is_schur_stable,
};
use num_complex::Complex64;

/// Random numbers of a fixed sequence, from −1 to 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / (1_u64 << 30) as f64 - 1.0
    }

    fn matrix(&mut self, rows: usize, columns: usize, size: f64) -> Matrix {
        let mut matrix = Matrix::zeros(rows, columns);
        matrix.entries_mut().iter_mut().for_each(|x| *x = size * self.next());
        matrix
    }
}

/// A loop that is stable without latencies: with a static gain, an LQG or an LQR controller in turn; every other plant may be unstable.
fn random_loop(seed: u64) -> LinearLoop {
    let mut random = Numbers(seed + 1000);
    let [period, speed] = if seed.is_multiple_of(4) { [1.5, 2.0] } else { [0.2, 2.0] };
    for _ in 0..500 {
        let (n, m) = (2 + (seed % 5) as usize, 2 + (seed / 2 % 2) as usize);
        let mut a = random.matrix(n, n, speed);
        let decay = if seed.is_multiple_of(2) { 0.5 * speed } else { 0.1 * speed };
        (0..n).for_each(|i| a[(i, i)] -= decay);
        let [b, c] = [random.matrix(n, m, 1.0), random.matrix(2, n, 1.0)];
        let d = random.matrix(2, m, if seed % 5 == 1 { 0.3 } else { 0.0 });
        let mut plant = LinearPlant::new(a, b, c, d).unwrap();
        if seed % 7 == 3 {
            plant = plant.with_input_part(0, ChannelPart::Lag(0.3 * period), "motor").unwrap();
        }
        if seed % 7 == 5 {
            plant = plant.with_output_part(1, ChannelPart::Lag(0.3 * period), "sensor").unwrap();
        }
        let n = plant.states.len();
        plant = plant.with_noise(Matrix::identity(n)).unwrap();
        if seed % 3 == 2 {
            plant = plant.with_all_states_measured();
        }
        let p = plant.outputs.len();
        let weights = CostWeights {
            states: Matrix::identity(n),
            inputs: Matrix::identity(m).scaled(0.2 + random.next().abs()),
        };
        let controller = match seed % 3 {
            0 => Some(DiscreteController::gain(random.matrix(m, p, 2.0))),
            kind => plant.design_regulator(&weights, period).ok().and_then(|regulator| {
                let gain = regulator.gain;
                if kind == 2 {
                    return Some(DiscreteController::gain(gain.scaled(-1.0)));
                }
                let filter = plant.design_filter(&Matrix::identity(p).scaled(0.1), period).ok()?;
                Some(plant.estimated_feedback(&gain, &filter, period))
            }),
        };
        let Some(controller) = controller else { continue };
        let linear =
            LinearLoop::new(plant, controller, period, Matrix::identity(n + m), vec![0.0; p]);
        let linear = linear.unwrap();
        if is_schur_stable(&linear.period_matrix(&linear.ideal()).unwrap()) {
            return linear;
        }
    }
    panic!("no stable loop");
}

/// Latencies that the channels have already: none, whole periods, and parts of one.
fn random_timing(linear: &LinearLoop, seed: u64) -> LoopTiming {
    let mut random = Numbers(seed + 77);
    let mut timing = linear.ideal();
    for latency in timing.input_latency.iter_mut().chain(&mut timing.output_latency) {
        let size = match seed % 4 {
            0 => 0.0,
            1 => (1.5 + 1.5 * random.next()).floor(),
            _ => 0.6 * (1.0 + random.next()),
        };
        *latency = Latency::of_steps(size).unwrap();
    }
    timing
}

fn at(linear: &LinearLoop, timing: &LoopTiming, channels: &Channels, latency: f64) -> Matrix {
    let mut timing = timing.clone();
    let late = match channels {
        Channels::Inputs(_) => &mut timing.input_latency,
        Channels::Outputs(_) => &mut timing.output_latency,
    };
    for &i in channels.numbers() {
        late[i] = Latency::of_steps(late[i].steps() + latency).unwrap();
    }
    linear.period_matrix(&timing).unwrap()
}

fn ends_near(windows: &[LatencyWindow], latency: f64, distance: f64) -> bool {
    let near = |end: f64| (end - latency).abs() < distance;
    windows.iter().any(|w| near(w.from) || w.to.is_some_and(near))
}

/// Compares stability at latencies in steps of `step` up to `most`, and the eigenvalue at each end. Returns the ends.
fn compare(
    name: &str,
    linear: &LinearLoop,
    (timing, channels): (&LoopTiming, &Channels),
    [step, most]: [f64; 2],
) -> usize {
    let windows = linear.latency_windows(timing, channels, [most, most]).unwrap();
    let inside = |latency: f64| {
        let within = |w: &&LatencyWindow| w.from <= latency && w.to.is_none_or(|to| latency <= to);
        windows.iter().any(|window| within(&window))
    };
    let count = (most / step) as u32;
    for latency in (0..count).map(|i| step * f64::from(i) + 0.02 * step) {
        if !ends_near(&windows, latency, 1e-4) {
            let stable = is_schur_stable(&at(linear, timing, channels, latency));
            assert_eq!(inside(latency), stable, "{name} {channels:?} {latency}: {windows:?}");
        }
    }
    let mut ends = 0;
    for (to, angle) in windows.iter().filter_map(|window| window.to.zip(window.angle)) {
        ends += 1;
        let wanted = Complex64::from_polar(1.0, angle);
        let values = eigenvalues(&at(linear, timing, channels, to)).unwrap();
        let off = values.iter().map(|value| (value - wanted).norm()).fold(f64::MAX, f64::min);
        // Of a simple eigenvalue of a matrix of norm 10.
        assert!(off < 1e-8, "{name} {channels:?} {to}: {off}");
    }
    ends
}

/// Random loops of the test.
const LOOPS: u64 = 40;

#[test]
fn joint_windows_are_where_the_spectral_radius_of_the_whole_matrix_is_below_one() {
    let mut ends = 0;
    for seed in 0..LOOPS {
        let linear = random_loop(seed);
        let timing = random_timing(&linear, seed / 3);
        let (m, p) = (linear.plant().inputs.len(), linear.plant().outputs.len());
        for channels in [Channels::Inputs((0..m).collect()), Channels::Outputs((0..p).collect())] {
            let name = format!("loop {seed}");
            ends += compare(&name, &linear, (&timing, &channels), [0.05, 8.0]);
        }
    }
    assert!(ends > 40, "{ends}");
}

/// Axes with the same plant, whose gains are coupled by `coupling`.
fn axes(plant: &Matrix, gains: [f64; 2], coupling: &Matrix) -> LinearLoop {
    let count = coupling.rows();
    let mut a = Matrix::zeros(2 * count, 2 * count);
    let mut b = Matrix::zeros(2 * count, count);
    let mut feedback = Matrix::zeros(count, 2 * count);
    for i in 0..count {
        a.set_block((2 * i, 2 * i), plant);
        b[(2 * i + 1, i)] = 1.0;
        for j in 0..count {
            feedback[(i, 2 * j)] = -gains[0] * coupling[(i, j)];
            feedback[(i, 2 * j + 1)] = -gains[1] * coupling[(i, j)];
        }
    }
    let d = Matrix::zeros(2 * count, count);
    let plant = LinearPlant::new(a, b, Matrix::identity(2 * count), d).unwrap();
    let controller = DiscreteController::gain(feedback);
    let cost = Matrix::identity(3 * count);
    LinearLoop::new(plant, controller, 0.1, cost, vec![0.0; 2 * count]).unwrap()
}

#[test]
fn loci_of_equal_size_are_all_followed() {
    let integrators = Matrix::from_rows(&[[0.0, 1.0], [0.0, 0.0]]).unwrap();
    let springs = Matrix::from_rows(&[[0.0, 1.0], [-9.0, 0.0]]).unwrap();
    // Equal loci, loci of equal size with different phases, and loci of a defective matrix.
    let couplings = [
        Matrix::identity(2),
        Matrix::identity(3),
        Matrix::from_rows(&[[1.0, 0.4], [-0.4, 1.0]]).unwrap(),
        Matrix::from_rows(&[[1.0, 0.5], [0.0, 1.0]]).unwrap(),
        Matrix::from_rows(&[[0.9, 0.3, 0.0], [0.0, 1.0, 0.2], [0.1, 0.0, 1.1]]).unwrap(),
    ];
    let mut ends = 0;
    for plant in [&integrators, &springs] {
        for coupling in &couplings {
            let linear = axes(plant, [0.8, 1.2], coupling);
            let all = Channels::Inputs((0..coupling.rows()).collect());
            let name = format!("{plant:?} {coupling:?}");
            ends += compare(&name, &linear, (&linear.ideal(), &all), [0.05, 24.0]);
        }
    }
    assert!(ends >= 10, "{ends}");
}

#[test]
fn channels_that_a_loop_lacks_are_an_error() {
    let linear = random_loop(0);
    for given in [vec![], vec![0, 0], vec![5]] {
        let found =
            linear.latency_windows(&linear.ideal(), &Channels::Outputs(given.clone()), [1.0, 1.0]);
        let wanted = LinearLoopError::LateChannels { of: "outputs", given, count: 2 };
        assert_eq!(found, Err(wanted));
    }
}

#[test]
fn known_windows_are_those_of_another_program() {
    let rows = |rows: &[&[f64]]| Matrix::from_rows(rows).unwrap();
    // Of `tools/joint_window_reference.py`, with NumPy: plant, inputs, feedback; period, own latencies, largest stable latency.
    let cases = [
        (
            rows(&[
                &[0.0, 1.0, 0.0, 0.0],
                &[-9.0, 0.0, 2.0, 0.0],
                &[0.0, 0.0, 0.0, 1.0],
                &[1.0, 0.0, -4.0, 0.0],
            ]),
            rows(&[&[0.0, 0.0], &[1.0, 0.0], &[0.0, 0.0], &[0.3, 1.0]]),
            rows(&[&[0.8, 1.2, 0.1, -0.3], &[0.2, 0.4, 0.5, 0.9]]),
            (0.1, [0.0, 0.0], 3.255_928_695_667_459_6),
        ),
        (
            rows(&[&[0.0, 1.0, 0.0, 0.0], &[0.0; 4], &[0.0, 0.0, 0.0, 1.0], &[0.0; 4]]),
            rows(&[&[0.0, 0.0], &[1.0, 0.2], &[0.0, 0.0], &[-0.3, 1.0]]),
            rows(&[&[1.0, 1.5, 0.2, 0.0], &[0.0, 0.1, 2.0, 2.5]]),
            (0.05, [0.3, 1.6], 7.954_826_691_812_464),
        ),
        (
            rows(&[&[0.5, 1.0, 0.0], &[-1.0, 0.2, 0.5], &[0.0, 0.3, -1.0]]),
            rows(&[&[1.0, 0.0], &[0.0, 1.0], &[0.5, 0.5]]),
            rows(&[&[3.0, 0.5, 0.2], &[-0.4, 2.5, 0.3]]),
            (0.1, [0.7, 0.2], 3.186_503_551_388_619_7),
        ),
    ];
    for (a, b, gain, (period, own, wanted)) in cases {
        let (n, m) = (a.rows(), b.columns());
        let plant = LinearPlant::new(a, b, Matrix::identity(n), Matrix::zeros(n, m)).unwrap();
        let controller = DiscreteController::gain(gain.scaled(-1.0));
        let cost = Matrix::identity(n + m);
        let linear = LinearLoop::new(plant, controller, period, cost, vec![0.0; n]).unwrap();
        let input_latency = own.map(|steps| Latency::of_steps(steps).unwrap()).to_vec();
        let timing = LoopTiming { input_latency, ..linear.ideal() };
        let windows =
            linear.latency_windows(&timing, &Channels::Inputs(vec![0, 1]), [29.0, 29.0]).unwrap();
        let [LatencyWindow { from: 0.0, to: Some(to), .. }] = windows[..] else {
            panic!("{windows:?}")
        };
        // Roundings of simple eigenvalues of matrices of norm 10.
        assert!((to - wanted).abs() < 1e-10, "{to} {wanted}");
    }
}
