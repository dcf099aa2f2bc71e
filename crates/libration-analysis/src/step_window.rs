//! Intervals of time steps.

/// An interval of time steps in s, from 0 or above to a number that may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepWindow {
    /// Its lower end.
    pub from: f64,
    /// Its upper end; infinite if there is none.
    pub to: f64,
}

impl StepWindow {
    /// All time steps.
    pub const ALL: StepWindow = StepWindow { from: 0.0, to: f64::INFINITY };

    /// The window with both ends times `factor`.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        StepWindow { from: self.from * factor, to: self.to * factor }
    }

    /// The steps that are in a window of each list; both lists rise.
    pub(crate) fn intersections(left: &[StepWindow], right: &[StepWindow]) -> Vec<StepWindow> {
        let both = |a: &StepWindow, b: &StepWindow| StepWindow {
            from: a.from.max(b.from),
            to: a.to.min(b.to),
        };
        let pairs = left.iter().flat_map(|a| right.iter().map(move |b| both(a, b)));
        pairs.filter(|window| window.from < window.to).collect()
    }

    /// The cells between the ends `cuts` and beyond, where `holds` at a point within; neighbours are joined.
    pub(crate) fn of_cells(cuts: &[f64], holds: impl Fn(f64) -> bool) -> Vec<StepWindow> {
        let mut windows: Vec<StepWindow> = Vec::new();
        for i in 0..=cuts.len() {
            let from = if i == 0 { 0.0 } else { cuts[i - 1] };
            let to = cuts.get(i).copied().unwrap_or(f64::INFINITY);
            let within = match (i, to.is_finite()) {
                (0, false) => 1.0,
                (0, true) => 0.5 * to,
                (_, true) => 0.5 * (from + to),
                (_, false) => 2.0 * from,
            };
            match windows.last_mut() {
                _ if !holds(within) => {}
                Some(last) if last.to == from => last.to = to,
                _ => windows.push(StepWindow { from, to }),
            }
        }
        windows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_joined_and_intersected() {
        let window = |from, to| StepWindow { from, to };
        let all = StepWindow::of_cells(&[1.0, 2.0, 3.0], |x| !(2.0..3.0).contains(&x));
        assert_eq!(all, [window(0.0, 2.0), window(3.0, f64::INFINITY)]);
        let both = StepWindow::intersections(&all, &[window(1.0, 4.0), window(5.0, 6.0)]);
        assert_eq!(both, [window(1.0, 2.0), window(3.0, 4.0), window(5.0, 6.0)]);
    }
}
