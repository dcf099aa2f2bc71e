//! The order of a method for forces of positions, from the conditions of Nyström's trees.

use libration_core::number::{Ratio, Wide};
use libration_core::{Elementary, Integrator, Scalar};

use super::Tableau;
use super::order_certificate::rounding_of_words;

/// The error of a method on `q̈ = a(q)`, order by order.
///
/// The step and the flow have series over the same trees: a vertex is the force, a child is a derivative of the force along a position
/// that another force moved, a leaf one along the velocity. The order is `p` if the coefficients of all trees of up to `p` vertices and
/// leaves agree in the velocities, and of up to `p − 1` in the positions: a statement about every such system at once (Hairer, Nørsett,
/// Wanner: Solving Ordinary Differential Equations I, 2nd ed., §II.14). A product of kicks and drifts may have a higher order here than
/// for two parts of any kind, because three kicks and a drift commute.
#[derive(Clone, Debug)]
pub struct NystromCertificate {
    /// The Euclidean norm of the differences of the coefficients in `Δt`, `Δt²`, …, of positions and velocities.
    pub residuals: Vec<Wide>,
    /// The largest difference of each power, in units of what the rounding of weights to `f64` may leave of it.
    excess: Vec<f64>,
}

impl NystromCertificate {
    /// Compares all coefficients up to `Δtᵈᵉᵍʳᵉᵉ`; none if the method evaluates its force too often for its tableau.
    pub fn new(integrator: impl Integrator, degree: usize) -> Option<Self> {
        let tableau = Tableau::new(integrator)?;
        let wide = |all: &[Ratio]| all.iter().map(|&x| Wide::from(x)).collect::<Vec<_>>();
        let (c, b, b_position) = (wide(&tableau.c), wide(&tableau.b), wide(&tableau.b_position));
        let a: Vec<Vec<Wide>> = tableau.a.iter().map(|row| wide(row)).collect();
        let trees = Tree::up_to(degree);
        let mut squares = vec![Wide::ZERO; degree];
        // The term without a force: the velocity moves the position for the time of the step.
        if let Some(sum) = squares.first_mut() {
            let off = Wide::from(tableau.time) - Wide::one();
            *sum = off * off;
        }
        let of_sizes = tableau.of_sizes();
        let b_sizes = [of_sizes.b, of_sizes.b_position];
        let mut excess = vec![0.0_f64; degree];
        // Of each tree that is a child of others: the position that its force has moved, at each evaluation, and its size.
        let mut moved: Vec<Vec<Wide>> = Vec::with_capacity(trees.len());
        let mut moved_sizes: Vec<Vec<f64>> = Vec::with_capacity(trees.len());
        for tree in &trees {
            let weight = |i: usize| {
                let leaves = (0..tree.leaves).fold(Wide::one(), |product, _| product * c[i]);
                tree.children.iter().fold(leaves, |product, &child| product * moved[child][i])
            };
            let weight: Vec<Wide> = (0..c.len()).map(weight).collect();
            let order = Wide::from_f64(tree.order as f64);
            let velocity = dot(&b, &weight) - tree.density * order.recip();
            let exact = tree.density * (order * (order + Wide::one())).recip();
            let position = dot(&b_position, &weight) - exact;
            let share = tree.symmetry.recip();
            let size = |i: usize| {
                let leaves = of_sizes.c[i].powi(tree.leaves as i32);
                leaves * tree.children.iter().map(|&child| moved_sizes[child][i]).product::<f64>()
            };
            let size: Vec<f64> = (0..c.len()).map(size).collect();
            for ((i, residual), b) in [velocity, position].into_iter().enumerate().zip(&b_sizes) {
                let power = tree.order + i;
                if let Some(sum) = squares.get_mut(power - 1) {
                    *sum = *sum + residual * residual * share * share;
                    // Each of as many coefficients as the power is rounded once.
                    let rounding = power as f64 * f64::EPSILON * dot_of_sizes(b, &size);
                    excess[power - 1] = excess[power - 1].max(residual.to_f64().abs() / rounding);
                }
            }
            if tree.order + 2 <= degree {
                moved.push(a.iter().map(|row| dot(row, &weight)).collect());
                let sizes = of_sizes.a.iter().map(|row| dot_of_sizes(row, &size));
                moved_sizes.push(sizes.collect());
            }
        }
        let residuals: Vec<Wide> = squares.into_iter().map(Wide::sqrt).collect();
        if tableau.word().is_some() {
            // Of a word these coefficients are sums of those of its words, without their factorial; its weights are rounded, not its tableau.
            let (path, mut factorial) = (path_of(&tableau), 1.0);
            for (i, (excess, residual)) in excess.iter_mut().zip(&residuals).enumerate() {
                factorial *= (i + 1) as f64;
                *excess = residual.to_f64() / (rounding_of_words(i + 1, path) / factorial);
            }
        }
        Some(NystromCertificate { residuals, excess })
    }

    /// The order: the number of leading powers whose residuals are rounding.
    pub fn order(&self) -> usize {
        self.excess.iter().take_while(|excess| **excess <= 1.0).count()
    }

    /// The norm of the leading error: the residual behind those of the [order](NystromCertificate::order); none if it was not computed.
    pub fn error_constant(&self) -> Option<f64> {
        self.residuals.get(self.order()).map(|residual| residual.to_f64())
    }
}

/// The way of the velocities and that of the positions, there and back.
fn path_of(tableau: &Tableau) -> f64 {
    let times = tableau.c.iter().copied().chain([tableau.time]).map(Ratio::to_f64);
    let (way, _) = times.fold((0.0, 0.0), |(way, last), c| (way + f64::abs(c - last), c));
    way + tableau.b.iter().map(|b| b.to_f64().abs()).sum::<f64>()
}

pub(super) fn dot(a: &[Wide], b: &[Wide]) -> Wide {
    a.iter().zip(b).fold(Wide::ZERO, |sum, (&a, &b)| sum + a * b)
}

/// A force with its derivatives: a root with leaves, which are velocities, and children, which are forces on positions.
#[derive(Debug)]
struct Tree {
    leaves: usize,
    /// Indices of trees, none smaller than the one before.
    children: Vec<usize>,
    /// The power of time of the velocity that it moves.
    order: usize,
    /// The factor of its power of time in the exact flow, before integration.
    density: Wide,
    /// The number of its symmetries.
    symmetry: Wide,
}

impl Tree {
    /// All trees of these orders, by rising order.
    fn up_to(most: usize) -> Vec<Tree> {
        let mut trees: Vec<Tree> = Vec::new();
        for order in 1..=most {
            let mut found = Vec::new();
            children(&trees, 0, order - 1, &mut Vec::new(), &mut found);
            trees.extend(
                found.into_iter().map(|all| Tree::new(order, all, &trees)).collect::<Vec<_>>(),
            );
        }
        trees
    }

    fn new(order: usize, children: Vec<usize>, trees: &[Tree]) -> Self {
        let taken: usize = children.iter().map(|&child| trees[child].order + 1).sum();
        let leaves = order - 1 - taken;
        let number = |n: usize| Wide::from_f64(n as f64);
        let factorial = |n: usize| (1..=n).fold(Wide::one(), |product, k| product * number(k));
        let (mut density, mut symmetry) = (Wide::one(), factorial(leaves));
        let mut alike = 0;
        for (i, &child) in children.iter().enumerate() {
            let Tree { order, density: of_child, symmetry: own, .. } = trees[child];
            density = density * of_child * (number(order) * number(order + 1)).recip();
            alike = if i > 0 && children[i - 1] == child { alike + 1 } else { 1 };
            symmetry = symmetry * own * number(alike);
        }
        Tree { leaves, children, order, density, symmetry }
    }
}

/// The lists of trees from `first` on whose orders, and one for each, sum to at most `rest`.
fn children(
    trees: &[Tree],
    first: usize,
    rest: usize,
    chosen: &mut Vec<usize>,
    found: &mut Vec<Vec<usize>>,
) {
    found.push(chosen.clone());
    for (i, tree) in trees.iter().enumerate().skip(first) {
        if let Some(rest) = rest.checked_sub(tree.order + 1) {
            chosen.push(i);
            children(trees, i, rest, chosen, found);
            chosen.pop();
        }
    }
}

pub(super) fn dot_of_sizes(a: &[f64], b: &[f64]) -> f64 {
    // A sum of nothing is −0.
    a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b)
}

#[cfg(test)]
mod tests {
    use libration_core::Method;
    use libration_core::integrator::RungeKuttaCoefficients::{General, Nystrom};
    use libration_core::integrator::RungeKuttaTable;

    use super::*;

    fn order(integrator: impl Integrator) -> Option<usize> {
        NystromCertificate::new(integrator, 6).map(|certificate| certificate.order())
    }

    #[test]
    fn there_are_as_many_trees_of_each_order_as_hairer_norsett_and_wanner_count() {
        // Table II.14.1 counts the special Nyström trees of each order.
        let trees = Tree::up_to(10);
        let count = |order: usize| trees.iter().filter(|tree| tree.order == order).count();
        let counts: Vec<usize> = (1..=10).map(count).collect();
        assert_eq!(counts, [1, 1, 2, 3, 6, 10, 20, 36, 72, 137]);
    }

    #[test]
    fn every_shipped_method_has_its_order_for_forces_of_positions() {
        for method in Method::ALL {
            assert_eq!(order(method), Some(method.order() as usize), "{}", method.name());
        }
    }

    #[test]
    fn rk4_misses_order_five_by_what_its_stability_polynomial_lacks() {
        // On an oscillator the only tall tree of order five is q⁗: 1/120 is missing from the velocities.
        let certificate = NystromCertificate::new(Method::Rk4, 5).unwrap();
        assert!(certificate.error_constant().unwrap() > 1.0 / 120.0);
    }

    fn runge_kutta() -> impl Iterator<Item = &'static RungeKuttaTable> {
        RungeKuttaTable::ALL.into_iter().flatten()
    }

    #[test]
    fn every_published_runge_kutta_method_has_the_order_and_the_summary_of_its_table() {
        for table in runge_kutta() {
            let order = table.order as usize;
            let own = NystromCertificate::new(table, order + 1).expect(table.name);
            assert_eq!(own.order(), order, "{}: {:?}", table.name, own.residuals);
            let scope = match table.coefficients {
                General { .. } => "",
                Nystrom { .. } => "; forces of positions",
            };
            let stages = table.coefficients.stages();
            let wanted = format!("order {order}; not symplectic; {stages} evaluations{scope}");
            assert_eq!(table.summary, wanted, "{}", table.name);
        }
    }

    #[test]
    fn a_wrong_digit_in_any_coefficient_of_a_nystrom_method_is_found() {
        // Far above the rounding of a weight.
        const WRONG: f64 = 1e-10;
        for table in runge_kutta() {
            let Nystrom { c, a, b_position, b } = table.coefficients else { continue };
            let rows = a.iter().copied().chain([c, b_position, b]);
            let rows: Vec<Vec<f64>> = rows.map(<[f64]>::to_vec).collect();
            for row in 0..rows.len() {
                for column in (0..rows[row].len()).filter(|&column| rows[row][column] != 0.0) {
                    let mut wrong = rows.clone();
                    wrong[row][column] += WRONG;
                    let mut wrong: Vec<&'static [f64]> =
                        wrong.into_iter().map(|row| &*row.leak()).collect();
                    let [c, b_position, b] = wrong.split_off(a.len()).try_into().unwrap();
                    let coefficients = Nystrom { c, a: wrong.leak(), b_position, b };
                    let RungeKuttaTable { name, title, summary, source, order, .. } = *table;
                    let changed =
                        RungeKuttaTable { name, title, summary, source, order, coefficients };
                    let changed: &'static RungeKuttaTable = Box::leak(Box::new(changed));
                    // Most digits are in conditions of low orders, which are computed sooner.
                    let is_found = [5.min(order), 8.min(order), order].into_iter().any(|most| {
                        let found = NystromCertificate::new(changed, most as usize).unwrap();
                        found.order() < most as usize
                    });
                    assert!(is_found, "{name}: row {row}, column {column}");
                }
            }
        }
    }
}
