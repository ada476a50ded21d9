//! Ranges of axes and round numbers on them.

/// An axis with its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    /// Lowest value shown.
    pub(crate) low: f64,
    /// Highest value shown.
    pub(crate) high: f64,
    /// Ticks: value and label.
    pub(crate) ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis over a range with at most `most` ticks; `degrees` prefers 15, 30, 45, 90.
    pub(crate) fn new(low: f64, high: f64, most: usize, degrees: bool) -> Self {
        let step = step((high - low) / most.max(1) as f64, degrees);
        let decimals = decimals(step);
        let first = (low / step - 1e-6).ceil();
        let count = ((high / step + 1e-6).floor() - first + 1.0).clamp(0.0, 100.0) as usize;
        let ticks = (0..count)
            .map(|k| (first + k as f64) * step)
            .map(|value| (value, label(value, decimals)))
            .collect();
        Axis { low, high, ticks }
    }

    /// Where a value lies: 0 at the low end, 1 at the high end.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// The smallest round step that is not less than `least`.
fn step(least: f64, degrees: bool) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    if degrees && (10.0..=360.0).contains(&least) {
        let round = [10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 180.0, 360.0];
        return round.into_iter().find(|step| *step >= least * 0.999).unwrap_or(360.0);
    }
    let decade = 10f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * decade >= least * 0.999);
    factor.unwrap_or(10.0) * decade
}

/// Decimals that tell multiples of a step apart.
fn decimals(step: f64) -> usize {
    (-(step.log10() + 1e-9).floor()).clamp(0.0, 12.0) as usize
}

fn label(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if zero { text.trim_start_matches('-').to_string() } else { text.replace('-', "−") }
}

/// Values beyond this are drawn as gaps.
pub(crate) const HUGE: f64 = 1e290;

/// Whether a value can be drawn.
pub(crate) fn drawable(value: f64) -> bool {
    value.abs() < HUGE
}

/// Lowest and highest of the values that can be drawn.
pub(crate) fn extent<'a>(values: impl IntoIterator<Item = &'a f64>) -> Option<(f64, f64)> {
    values.into_iter().filter(|v| drawable(**v)).fold(None, |range, v| match range {
        None => Some((*v, *v)),
        Some((low, high)) => Some((low.min(*v), high.max(*v))),
    })
}

/// A range with a margin around it; one without extent gets `least` (or a tenth of its value).
pub(crate) fn padded(range: Option<(f64, f64)>, least: f64) -> (f64, f64) {
    let Some((low, high)) = range else { return (-1.0, 1.0) };
    let middle = 0.5 * low + 0.5 * high;
    let size = low.abs().max(high.abs());
    let mut half = 0.5 * high - 0.5 * low;
    if half <= 1e-9 * size || half == 0.0 {
        half = if size > 0.0 { 0.1 * size } else { 1.0 };
    }
    let half = (1.08 * half).max(0.5 * least);
    (middle - half, middle + half)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, most: usize, degrees: bool) -> Vec<String> {
        Axis::new(low, high, most, degrees).ticks.into_iter().map(|t| t.1).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(0.0, 10.0, 5, false), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(labels(-0.31, 0.12, 5, false), ["−0.3", "−0.2", "−0.1", "0.0", "0.1"]);
        assert_eq!(labels(-7.0, 95.0, 4, true), ["0", "30", "60", "90"]);
        assert_eq!(labels(0.0, 0.0015, 3, false), ["0.0000", "0.0005", "0.0010", "0.0015"]);
        assert_eq!(labels(0.0, 30.0, 6, false), ["0", "5", "10", "15", "20", "25", "30"]);
    }

    #[test]
    fn odd_ranges_do_no_harm() {
        for (low, high) in [(0.0, 0.0), (1.0, 1.0), (-HUGE, HUGE), (1e-300, 2e-300), (5.0, -5.0)] {
            let (low, high) = padded(Some((low, high)), 0.0);
            let axis = Axis::new(low, high, 5, false);
            assert!(axis.high > axis.low && axis.ticks.len() < 20, "{axis:?}");
            assert!(axis.fraction(low).abs() < 1e-9);
        }
        assert_eq!(padded(None, 0.0), (-1.0, 1.0));
    }

    #[test]
    fn what_is_not_a_number_has_no_extent() {
        assert_eq!(extent(&[f64::NAN, 2.0, f64::INFINITY, -1.0]), Some((-1.0, 2.0)));
        assert_eq!(extent(&[f64::NAN]), None);
    }
}
