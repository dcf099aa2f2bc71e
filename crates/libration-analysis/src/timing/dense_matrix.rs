//! Square matrices of floats: products, exponentials and spectral radii.

/// A square matrix, row by row.
pub(super) type Matrix = Vec<Vec<f64>>;

/// The transpose.
pub(super) fn transpose(m: &Matrix) -> Matrix {
    (0..m.len()).map(|i| m.iter().map(|row| row[i]).collect()).collect()
}

/// The logarithm of the spectral radius: the growth of the norm of higher and higher powers (I. Gelfand, 1941), each the square of
/// the one before. After 50 of them what norm and radius differ by is divided by 2⁵⁰. Where several of the largest eigenvalues meet,
/// rounding parts them, and three digits may be all that are right.
pub(super) fn log_spectral_radius(mut power: Matrix) -> f64 {
    let (mut logarithm, mut share) = (0.0, 1.0);
    for _ in 0..50 {
        // Squares of it could overflow.
        let norm = power
            .iter()
            .flatten()
            .fold(0.0, |most: f64, x| if x.abs() > most || x.is_nan() { x.abs() } else { most });
        if norm == 0.0 {
            return f64::NEG_INFINITY;
        }
        logarithm += share * norm.ln();
        share /= 2.0;
        scale(&mut power, norm);
        power = product(&power, &power);
    }
    logarithm
}

/// Whether the spectral radius is below 1, which is known sooner than what it is: a power of norm below 1 says yes, and one whose
/// eigenvalues add up to more than there are of them says no.
pub(super) fn is_schur_stable(matrix: &Matrix) -> bool {
    let (mut power, mut logarithm) = (matrix.clone(), 0.0);
    for _ in 0..50 {
        let row_sum = |row: &Vec<f64>| row.iter().map(|x| x.abs()).sum::<f64>();
        let norm = power.iter().map(row_sum).fold(0.0, |most: f64, x| match x.is_nan() {
            true => x,
            false => most.max(x),
        });
        if norm == 0.0 || norm.ln() + logarithm < 0.0 {
            return true;
        }
        let trace: f64 = power.iter().enumerate().map(|(i, row)| row[i]).sum();
        if norm.is_nan() || trace.abs().ln() + logarithm > (power.len() as f64).ln() {
            return false;
        }
        scale(&mut power, norm);
        logarithm = 2.0 * (logarithm + norm.ln());
        power = product(&power, &power);
    }
    // Within a part of 10⁻¹⁵ of the edge.
    log_spectral_radius(matrix.clone()) < 0.0
}

/// Divides all entries; those that are nothing beside the largest become zero, since products of them would be numbers with which
/// processors take a hundred times as long.
pub(super) fn scale(power: &mut Matrix, norm: f64) {
    const NOTHING: f64 = 1e-150;
    for x in power.iter_mut().flatten() {
        *x /= norm;
        *x = if x.abs() < NOTHING { 0.0 } else { *x };
    }
}

/// The map of the products `xᵢxⱼ`, `i ≤ j`, under a matrix.
pub(super) fn symmetric_square(m: &Matrix) -> Matrix {
    let n = m.len();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).collect();
    let entry = |(i, j): (usize, usize), (k, l): (usize, usize)| match k == l {
        true => m[i][k] * m[j][k],
        false => m[i][k] * m[j][l] + m[i][l] * m[j][k],
    };
    pairs.iter().map(|&row| pairs.iter().map(|&column| entry(row, column)).collect()).collect()
}

/// The product of two matrices.
pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let row = |a: &Vec<f64>| {
        let mut row = vec![0.0; b.len()];
        for (&factor, b) in a.iter().zip(b).filter(|(factor, _)| **factor != 0.0) {
            row.iter_mut().zip(b).for_each(|(x, b)| *x += factor * b);
        }
        row
    };
    a.iter().map(row).collect()
}

/// `exp(a)`, by Taylor's series of a small part, squared as often as it takes.
pub(super) fn exponential(a: Matrix) -> Matrix {
    // A part of norm below ½ has terms that fall by a half and a factorial: 2⁻²⁰/20! is 4·10⁻²⁵.
    const TERMS: u32 = 20;
    let n = a.len();
    let norm = a.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    let halvings = if norm > 0.5 { (norm.log2().ceil() as i32 + 1).clamp(0, 1000) } else { 0 };
    let scale = 2.0_f64.powi(-halvings);
    let small: Matrix = a.iter().map(|row| row.iter().map(|x| x * scale).collect()).collect();
    let unit: Matrix =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    // Horner's rule: 1 + s(1 + s/2(1 + s/3(…))).
    let mut sum = unit.clone();
    for k in (1..=TERMS).rev() {
        sum = product(&small, &sum);
        for (row, unit) in sum.iter_mut().zip(&unit) {
            row.iter_mut().zip(unit).for_each(|(x, unit)| *x = *x / f64::from(k) + unit);
        }
    }
    (0..halvings).fold(sum, |power, _| product(&power, &power))
}
