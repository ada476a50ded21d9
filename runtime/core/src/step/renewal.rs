//! When factors are made anew.
//!
//! Factors of an earlier step still serve in a later one: the system has changed little, so that a
//! correction leaves a small part of the residual. Each step may then take a correction more than
//! with new factors. New ones are made when what has been spent on such corrections would have paid
//! for them, or within a step as soon as it converges too slowly. Costs are counted from the sizes
//! of the blocks, not measured, so that a run repeats bit by bit.

/// Corrections with the same factors that a step may be heading for, at most.
const PATIENCE: f64 = 12.0;
/// Where factors cost more corrections than this, one of them says too little of the next.
const MANY: f64 = 4.0;
/// Steps that begin with new factors at most before old ones are tried again.
const LONGEST_PAUSE: usize = 64;

/// Keeps count of what the factors at hand have cost.
#[derive(Clone, Debug)]
pub(crate) struct Renewal {
    /// Corrections that cost as much as new factors.
    price: f64,
    /// Step (s) for which the factors at hand were made; `None` without any.
    made_for: Option<f64>,
    /// Fewest corrections of a step with these factors.
    fewest: usize,
    /// Corrections beyond that, over all steps.
    spent: usize,
    /// Whether the step at hand began with old factors, and whether they served until now.
    is_trial: bool,
    serves: bool,
    /// Steps that begin with new factors before old ones are tried again, and how many are left.
    pause: usize,
    left: usize,
}

impl Renewal {
    /// Where new factors cost as much as so many corrections.
    pub(crate) fn new(price: f64) -> Self {
        Renewal {
            price,
            made_for: None,
            fewest: usize::MAX,
            spent: 0,
            is_trial: false,
            serves: true,
            pause: 0,
            left: 0,
        }
    }

    /// A step of size h begins. Returns whether it is to make new factors.
    pub(crate) fn begin(&mut self, h: f64) -> bool {
        let is_due = self.spent as f64 >= self.price || self.left > 0;
        self.is_trial = self.made_for == Some(h) && !is_due;
        self.serves = true;
        !self.is_trial
    }

    /// There are new factors, for steps of size h.
    pub(crate) fn made(&mut self, h: f64) {
        (self.made_for, self.fewest, self.spent) = (Some(h), usize::MAX, 0);
        self.serves = false;
    }

    /// The factors are not to be used again.
    pub(crate) fn forget(&mut self) {
        self.made_for = None;
    }

    /// The step ends; it took so many corrections with the factors at hand.
    pub(crate) fn end(&mut self, corrections: usize) {
        self.fewest = self.fewest.min(corrections);
        self.spent += corrections - self.fewest;
        if !self.is_trial {
            self.left = self.left.saturating_sub(1);
            return;
        }
        // Where old factors did not serve, or no better than new ones would have, trying them was a
        // waste: ever more steps go by before it is done again.
        let extra = (corrections - self.fewest) as f64;
        self.pause = if self.serves && extra < self.price {
            0
        } else {
            (2 * self.pause).clamp(1, LONGEST_PAUSE)
        };
        self.left = self.pause;
    }

    /// Whether going on with the factors at hand costs less than new ones. `merits` are the largest
    /// residuals, in units of their tolerance, before the last two corrections and now; not a number
    /// where there was but one.
    pub(crate) fn goes_on(&self, [first, before, now]: [f64; 3]) -> bool {
        if first.is_nan() && self.price > MANY {
            return now < 10.0 * before;
        }
        // Corrections still needed at this rate.
        let rate = (before / now).ln().max(0.5 * (first / now).ln());
        now.ln() <= (1.0 + self.price).min(PATIENCE) * rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Begins steps of 1 ms that take the given corrections; returns which made new factors.
    fn steps(renewal: &mut Renewal, corrections: &[usize]) -> Vec<bool> {
        let mut made = Vec::new();
        for &corrections in corrections {
            made.push(renewal.begin(1e-3));
            if made.last() == Some(&true) {
                renewal.made(1e-3);
            }
            renewal.end(corrections);
        }
        made
    }

    #[test]
    fn factors_serve_until_they_have_cost_as_much_as_new_ones() {
        let mut renewal = Renewal::new(2.0);
        let made = steps(&mut renewal, &[1, 1, 2, 2, 1, 1]);
        assert_eq!(made, [true, false, false, false, true, false]);
        assert!(renewal.begin(2e-3), "factors of another step");
        renewal.forget();
        assert!(renewal.begin(1e-3));
    }

    #[test]
    fn old_factors_that_do_not_serve_are_tried_less_and_less() {
        let mut renewal = Renewal::new(2.0);
        let mut tries = Vec::new();
        for step in 0..40 {
            if !renewal.begin(1e-3) {
                tries.push(step);
            }
            renewal.made(1e-3);
            renewal.end(1);
        }
        assert_eq!(tries, [1, 3, 6, 11, 20, 37]);
        assert_eq!(steps(&mut renewal, &[1; 34])[29..], [true, false, false, false, false]);
    }

    #[test]
    fn slow_convergence_wants_new_factors() {
        let renewal = Renewal::new(1.0);
        assert!(renewal.goes_on([f64::NAN, 1e6, 1e2]));
        assert!(!renewal.goes_on([f64::NAN, 1e6, 1e5]));
        assert!(renewal.goes_on([1e9, 1e5, 1e4]));
        assert!(!renewal.goes_on([1e6, 1e6, 1e7]));
        assert!(!renewal.goes_on([1e6, 1e6, f64::NAN]));
        let dear = Renewal::new(100.0);
        assert!(dear.goes_on([f64::NAN, 1e6, 9e5]));
        assert!(!dear.goes_on([f64::NAN, 1e6, 2e7]));
        assert!(!dear.goes_on([1e6, 9e5, 8e5]));
        assert!(dear.goes_on([1e6, 9e5, 2e5]));
    }
}
