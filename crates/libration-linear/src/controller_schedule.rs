//! Schedules of controllers.

use crate::DiscreteController;

/// Controllers of equal size, one for each period, over and over.
///
/// They share one memory: what one remembers is what the next finds.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerSchedule {
    kinds: Vec<DiscreteController>,
    /// The number of the controller of each period.
    order: Vec<usize>,
}

impl ControllerSchedule {
    /// The schedule of these controllers; none without controllers, or if their sizes differ.
    pub fn new(controllers: Vec<DiscreteController>) -> Option<Self> {
        let size = |one: &DiscreteController| [one.memory(), one.measurements(), one.commands()];
        let first = size(controllers.first()?);
        if controllers.iter().any(|one| size(one) != first) {
            return None;
        }
        let mut kinds: Vec<DiscreteController> = Vec::new();
        let mut order = Vec::new();
        for one in controllers {
            order.push(kinds.iter().position(|known| *known == one).unwrap_or(kinds.len()));
            if order.last() == Some(&kinds.len()) {
                kinds.push(one);
            }
        }
        Some(ControllerSchedule { kinds, order })
    }

    /// The number of periods after which it repeats.
    pub fn periods(&self) -> usize {
        self.order.len()
    }

    /// The controller of period `k`, from 0.
    pub fn at(&self, k: usize) -> &DiscreteController {
        &self.kinds[self.order[k % self.order.len()]]
    }

    /// The different controllers.
    pub fn kinds(&self) -> &[DiscreteController] {
        &self.kinds
    }

    /// The number of the controller of each period.
    pub(crate) fn order(&self) -> &[usize] {
        &self.order
    }

    /// The schedule with `change` applied to each controller. All changed ones must have equal sizes.
    fn changed(&self, change: impl Fn(&DiscreteController) -> DiscreteController) -> Self {
        ControllerSchedule {
            kinds: self.kinds.iter().map(change).collect(),
            order: self.order.clone(),
        }
    }

    /// The schedule with all commands times `factor`.
    pub fn amplified(&self, factor: f64) -> Self {
        self.changed(|one| one.amplified(factor))
    }

    /// The schedule with `first` between the measurements and each controller. It runs once per period.
    pub fn after(&self, first: &DiscreteController) -> Self {
        self.changed(|one| first.then(one))
    }

    /// The schedule with `last` between each controller and the commands. It runs once per period.
    pub fn before(&self, last: &DiscreteController) -> Self {
        self.changed(|one| one.then(last))
    }
}

impl From<DiscreteController> for ControllerSchedule {
    fn from(controller: DiscreteController) -> Self {
        ControllerSchedule { kinds: vec![controller], order: vec![0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Matrix;

    #[test]
    fn equal_controllers_are_one_kind_and_unequal_sizes_are_refused() {
        let gain = |x: f64| DiscreteController::gain(Matrix::diagonal(&[x]));
        let all = vec![gain(1.0), gain(2.0), gain(2.0), gain(1.0)];
        let schedule = ControllerSchedule::new(all.clone()).unwrap();
        assert_eq!((schedule.periods(), schedule.kinds().len()), (4, 2));
        assert!((0..8).all(|k| *schedule.at(k) == all[k % 4]));
        let wide = DiscreteController::gain(Matrix::zeros(1, 2));
        assert_eq!(ControllerSchedule::new(vec![gain(1.0), wide]), None);
        assert_eq!(ControllerSchedule::new(Vec::new()), None);
    }
}
