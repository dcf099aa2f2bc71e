//! Plants by their transfer functions.

use crate::{LinearPlant, Matrix, PlantError, Signal};

impl LinearPlant {
    /// The plant with a transfer function from each input to each output: polynomials by falling powers of `s`, outputs × inputs.
    ///
    /// Each has states of its own, in controllable canonical form; an output adds what its inputs cause.
    ///
    /// # Errors
    /// [`PlantError::TransferFunction`]: an improper transfer function, or no denominator; [`PlantError::Shape`].
    pub fn from_transfer_functions(
        numerators: &[Vec<Vec<f64>>],
        denominators: &[Vec<Vec<f64>>],
    ) -> Result<Self, PlantError> {
        let (p, m) = (numerators.len(), numerators.first().map_or(0, Vec::len));
        let [inputs, outputs] = [("u", m), ("y", p)].map(|(letter, n)| Signal::numbered(letter, n));
        for (matrix, all) in [("numerator", numerators), ("denominator", denominators)] {
            let columns = all.first().map_or(0, Vec::len);
            if all.len() != p || all.iter().any(|row| row.len() != m) {
                let expected = format!("{p} × {m} polynomials, outputs × inputs");
                return Err(PlantError::Shape { matrix, rows: all.len(), columns, expected });
            }
        }
        let mut d = Matrix::zeros(p, m);
        let mut parts: Vec<(usize, usize, Vec<f64>, Vec<f64>)> = Vec::new();
        for (j, (above, below)) in numerators.iter().zip(denominators).enumerate() {
            for (i, (above, below)) in above.iter().zip(below).enumerate() {
                let wrong = |why: &str| PlantError::TransferFunction {
                    input: inputs[i].name.clone(),
                    output: outputs[j].name.clone(),
                    why: why.to_owned(),
                };
                let (direct, own, feedback) = canonical(above, below).map_err(wrong)?;
                d[(j, i)] = direct;
                if own.iter().any(|x| *x != 0.0) {
                    parts.push((j, i, own, feedback));
                }
            }
        }
        let n = parts.iter().map(|(_, _, own, _)| own.len()).sum();
        let mut a = Matrix::zeros(n, n);
        let (mut b, mut c) = (Matrix::zeros(n, m), Matrix::zeros(p, n));
        let mut first = 0;
        for (j, i, own, feedback) in parts {
            let order = own.len();
            for k in 0..order {
                a[(first, first + k)] = -feedback[k];
                c[(j, first + k)] = own[k];
            }
            (1..order).for_each(|k| a[(first + k, first + k - 1)] = 1.0);
            b[(first, i)] = 1.0;
            first += order;
        }
        LinearPlant::new(a, b, c, d)
    }
}

/// The direct path, and the coefficients of a strictly proper rest over a monic denominator, without its leading 1.
fn canonical(
    numerator: &[f64],
    denominator: &[f64],
) -> Result<(f64, Vec<f64>, Vec<f64>), &'static str> {
    if numerator.iter().chain(denominator).any(|x| !x.is_finite()) {
        return Err("a coefficient that is not finite");
    }
    let leading = |polynomial: &[f64]| polynomial.iter().position(|x| *x != 0.0);
    let Some(first) = leading(denominator) else { return Err("a denominator of zero") };
    let below = &denominator[first..];
    let above = leading(numerator).map_or(&[][..], |first| &numerator[first..]);
    if above.len() > below.len() {
        return Err("a numerator of higher degree than its denominator");
    }
    let order = below.len() - 1;
    let feedback: Vec<f64> = below[1..].iter().map(|x| x / below[0]).collect();
    let mut own = vec![0.0; order + 1];
    own[order + 1 - above.len()..].copy_from_slice(above);
    own.iter_mut().for_each(|x| *x /= below[0]);
    let direct = own[0];
    let rest = own[1..].iter().zip(&feedback).map(|(x, y)| x - direct * y).collect();
    Ok((direct, rest, feedback))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_transfer_function_in_state_space_has_its_coefficients() {
        // (2s² + 3s + 4)/(2s² + 6s + 10) = 1 + (−1.5s − 3)/(s² + 3s + 5).
        let plant = LinearPlant::from_transfer_functions(
            &[vec![vec![2.0, 3.0, 4.0]]],
            &[vec![vec![2.0, 6.0, 10.0]]],
        )
        .unwrap();
        assert_eq!(plant.a.entries(), [-3.0, -5.0, 1.0, 0.0]);
        assert_eq!(plant.b.entries(), [1.0, 0.0]);
        assert_eq!(plant.c.entries(), [-1.5, -3.0]);
        assert_eq!(plant.d.entries(), [1.0]);
    }

    #[test]
    fn outputs_add_what_their_inputs_cause_and_improper_functions_are_refused() {
        let one = vec![vec![vec![1.0], vec![0.0]], vec![vec![1.0], vec![2.0]]];
        let below =
            vec![vec![vec![1.0, 1.0], vec![1.0]], vec![vec![1.0, 0.0], vec![1.0, 2.0, 3.0]]];
        let plant = LinearPlant::from_transfer_functions(&one, &below).unwrap();
        assert_eq!((plant.states.len(), plant.c.row(1)), (4, &[0.0, 1.0, 0.0, 2.0][..]));
        let wrong = LinearPlant::from_transfer_functions(
            &[vec![vec![1.0, 0.0, 0.0]]],
            &[vec![vec![0.0, 1.0, 1.0]]],
        );
        let message = wrong.unwrap_err().to_string();
        assert!(
            message.contains("from `u1` to `y1` has a numerator of higher degree"),
            "{message}"
        );
    }
}
