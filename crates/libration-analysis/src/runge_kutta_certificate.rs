//! The order of a Runge–Kutta method for any differential equation, from the conditions of Butcher's trees.

use libration_core::number::{Ratio, Wide};
use libration_core::{Elementary, Integrator, Scalar};

use super::Tableau;
use super::nystrom_certificate::{dot, dot_of_sizes};

/// The order of a method on `ẏ = f(y)`, read off the step that simulates.
///
/// The step and the flow have series over rooted trees; the order is `p` if the coefficients of all trees of up to `p` vertices agree
/// (Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, 2nd ed., §II.2, theorem 2.13).
#[derive(Clone, Debug)]
pub struct RungeKuttaCertificate {
    /// The largest difference of a coefficient for trees of one vertex, of two, …
    pub residuals: Vec<f64>,
    /// The largest difference, in units of what the rounding of coefficients to `f64` may leave of it.
    excess: Vec<f64>,
}

impl RungeKuttaCertificate {
    /// Compares all coefficients of trees of up to `degree` vertices; none if positions do not move by the velocities of the stages, as they
    /// do in a Runge–Kutta method.
    pub fn new(integrator: impl Integrator, degree: usize) -> Option<Self> {
        let tableau = Tableau::new(integrator)?;
        if !tableau.is_runge_kutta() {
            return None;
        }
        let wide = |all: &[Ratio]| all.iter().map(|&x| Wide::from(x)).collect::<Vec<_>>();
        let a: Vec<Vec<Wide>> = tableau.a_velocity.iter().map(|row| wide(row)).collect();
        let b = wide(&tableau.b);
        let sizes_of = |all: &[Wide]| all.iter().map(|x| x.to_f64().abs()).collect::<Vec<_>>();
        let a_sizes: Vec<Vec<f64>> = a.iter().map(|row| sizes_of(row)).collect();
        let (mut residuals, mut excess) = (vec![0.0_f64; degree], vec![0.0_f64; degree]);
        // Of each tree, the factor of each stage, and the same with the sizes of coefficients.
        let mut factors: Vec<(Vec<Wide>, Vec<f64>)> = Vec::new();
        for tree in &trees(degree) {
            let inner = tree.children.iter().map(|&child| &factors[child]);
            let stage = |i: usize| {
                inner.clone().fold((Wide::one(), 1.0), |(exact, size), (x, sizes)| {
                    (exact * dot(&a[i], x), size * dot_of_sizes(&a_sizes[i], sizes))
                })
            };
            let (exact, sizes): (Vec<Wide>, Vec<f64>) = (0..b.len()).map(stage).unzip();
            let residual = (dot(&b, &exact) - tree.density.recip()).to_f64().abs();
            // Each of as many coefficients as vertices is rounded once, and the step adds them in exact arithmetic.
            let size = dot_of_sizes(&sizes_of(&b), &sizes);
            let rounding = tree.vertices as f64 * f64::EPSILON * size;
            let place = tree.vertices - 1;
            residuals[place] = residuals[place].max(residual);
            excess[place] = excess[place].max(residual / rounding);
            factors.push((exact, sizes));
        }
        Some(RungeKuttaCertificate { residuals, excess })
    }

    /// The order: the number of leading sizes of trees whose differences are rounding.
    pub fn order(&self) -> usize {
        self.excess.iter().take_while(|excess| **excess <= 1.0).count()
    }
}

/// A rooted tree.
struct Tree {
    vertices: usize,
    /// Indices of trees, none smaller than the one before.
    children: Vec<usize>,
    /// The product of the sizes of all subtrees, `γ`.
    density: Wide,
}

/// All trees of up to so many vertices, by rising size.
fn trees(most: usize) -> Vec<Tree> {
    let mut all: Vec<Tree> = Vec::new();
    for vertices in 1..=most {
        let mut found = Vec::new();
        forests(&all, 0, vertices - 1, &mut Vec::new(), &mut found);
        for children in found {
            let own = Wide::from_f64(vertices as f64);
            let density = children.iter().fold(own, |product, &child| product * all[child].density);
            all.push(Tree { vertices, children, density });
        }
    }
    all
}

/// The lists of trees from `first` on with exactly `vertices` vertices together.
fn forests(
    trees: &[Tree],
    first: usize,
    vertices: usize,
    chosen: &mut Vec<usize>,
    found: &mut Vec<Vec<usize>>,
) {
    if vertices == 0 {
        found.push(chosen.clone());
        return;
    }
    for (i, tree) in trees.iter().enumerate().skip(first) {
        if let Some(rest) = vertices.checked_sub(tree.vertices) {
            chosen.push(i);
            forests(trees, i, rest, chosen, found);
            chosen.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::Method;
    use libration_core::integrator::RungeKuttaCoefficients::General;
    use libration_core::integrator::{RungeKuttaCoefficients, RungeKuttaTable};

    use super::*;

    #[test]
    fn there_are_as_many_trees_of_each_size_as_butcher_counts() {
        // Hairer, Nørsett, Wanner, table II.2.2.
        let all = trees(9);
        let count = |vertices: usize| all.iter().filter(|tree| tree.vertices == vertices).count();
        assert_eq!([1, 2, 3, 4, 5, 6, 7, 8, 9].map(count), [1, 1, 2, 4, 9, 20, 48, 115, 286]);
    }

    #[test]
    fn runge_kutta_methods_have_their_order_for_any_equation_and_no_other_method_is_one() {
        let order = |method: Method| {
            RungeKuttaCertificate::new(method, method.order() as usize + 1)
                .map(|certificate| certificate.order())
        };
        for method in Method::all() {
            let is_general = match method {
                Method::ExplicitEuler | Method::Rk4 => true,
                Method::RungeKutta(table) => matches!(table.coefficients, General { .. }),
                _ => false,
            };
            let wanted = is_general.then_some(method.order() as usize);
            assert_eq!(order(method), wanted, "{method:?}");
        }
    }

    #[test]
    fn a_wrong_digit_in_any_coefficient_of_a_runge_kutta_method_is_found() {
        // Far above the rounding of a coefficient, with the sizes of the others in it.
        const WRONG: f64 = 1e-10;
        for table in RungeKuttaTable::ALL.into_iter().flatten() {
            let General { a, b } = table.coefficients else { continue };
            let rows: Vec<Vec<f64>> = a.iter().copied().chain([b]).map(<[f64]>::to_vec).collect();
            for row in 1..rows.len() {
                for column in (0..rows[row].len()).filter(|&column| rows[row][column] != 0.0) {
                    let mut wrong = rows.clone();
                    wrong[row][column] += WRONG;
                    let mut wrong: Vec<&'static [f64]> =
                        wrong.into_iter().map(|row| &*row.leak()).collect();
                    let b = wrong.pop().unwrap();
                    let coefficients = General { a: wrong.leak(), b };
                    let found = certified_with(table, coefficients);
                    assert!(found < table.order as usize, "{table:?}: row {row}, column {column}");
                }
            }
        }
    }

    fn certified_with(table: &RungeKuttaTable, coefficients: RungeKuttaCoefficients) -> usize {
        let RungeKuttaTable { name, title, summary, source, order, .. } = *table;
        let changed = RungeKuttaTable { name, title, summary, source, order, coefficients };
        let changed: &'static RungeKuttaTable = Box::leak(Box::new(changed));
        RungeKuttaCertificate::new(changed, order as usize).unwrap().order()
    }
}
