//! The natural length with which a strand has a wanted tension.

/// Halvings of an interval: more than a number has digits.
const HALVINGS: usize = 120;

/// The natural length x₀ for which `tension(x₀)`, that of a strand of the given length, is `wanted`.
/// A tension must not grow with x₀. `None` where no length above zero gives it.
pub(crate) fn natural_length(
    length: f64,
    wanted: f64,
    mut tension: impl FnMut(f64) -> f64,
) -> Option<f64> {
    // An interval with too much tension at its lower end and too little at its upper one.
    let mut low = length;
    let mut step = 1e-3 * length;
    while !(tension(low) >= wanted) {
        if low <= 0.0 {
            return None;
        }
        low = (low - step).max(0.0);
        step *= 2.0;
    }
    let mut high = length;
    step = 1e-3 * length;
    while !(tension(high) <= wanted) {
        if high > 1e3 * length {
            return None;
        }
        high += step;
        step *= 2.0;
    }
    for _ in 0..HALVINGS {
        // A secant through the ends, kept well inside, then a halving.
        let (above, below) = (tension(low) - wanted, tension(high) - wanted);
        if above == 0.0 {
            return Some(low);
        }
        if below == 0.0 {
            return Some(high);
        }
        let secant = low + (high - low) * (above / (above - below)).clamp(0.0, 1.0);
        for at in [secant, 0.5 * (low + high)] {
            if at > low && at < high {
                if tension(at) >= wanted { low = at } else { high = at }
            }
        }
        if high - low <= f64::EPSILON * length {
            break;
        }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_are_turned_around() {
        let linear = natural_length(0.1, 3.0, |rest| 200.0 * (0.1 - rest)).unwrap();
        assert!((linear - 0.085).abs() < 1e-16);
        // Zero tension: the length itself.
        assert_eq!(natural_length(0.1, 0.0, |rest| 200.0 * (0.1 - rest)), Some(0.1));
        // A toe region, quadratic and then steep.
        let toe = |rest: f64| {
            let strain: f64 = (0.1 - rest) / rest;
            if strain > 0.02 { 40.0 * (strain - 0.01) } else { 1e3 * strain.max(0.0).powi(2) }
        };
        let found = natural_length(0.1, 1.2, toe).unwrap();
        assert!((toe(found) - 1.2).abs() < 1e-12);
        // Too soft for it: the strand would have to be shorter than nothing.
        assert_eq!(natural_length(0.1, 30.0, |rest| 200.0 * (0.1 - rest)), None);
        assert_eq!(natural_length(0.1, 1.0, |_| 0.0), None);
    }
}
