//! The data of a figure over time.

use crate::unit::Unit;

/// Numbers over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name, dotted where it belongs to a part; empty if the quantity's label says it all.
    pub name: String,
    /// One number per instant (SI); what is not finite is drawn as a gap.
    pub values: Vec<f64>,
}

/// Curves that share a vertical axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// What is drawn, without its unit.
    pub label: String,
    /// What it measures.
    pub unit: Unit,
    /// The curves.
    pub curves: Vec<Curve>,
    /// Ranges about the first curve, widest first: lower and upper ends, a number per instant.
    pub bands: Vec<[Vec<f64>; 2]>,
}

impl Quantity {
    /// A quantity of several curves.
    pub fn new(label: impl Into<String>, unit: Unit, curves: Vec<Curve>) -> Self {
        Quantity { label: label.into(), unit, curves, bands: Vec::new() }
    }
    /// A quantity of one curve that needs no name of its own.
    pub fn single(label: impl Into<String>, unit: Unit, values: Vec<f64>) -> Self {
        Quantity::new(label, unit, vec![Curve { name: String::new(), values }])
    }
}

/// Part of an energy below which its change is drawn by itself.
const SMALL_CHANGE: f64 = 0.02;

/// The energy, and its change since the start where that would be lost on the energy's own axis.
pub fn energy(values: Vec<f64>) -> Vec<Quantity> {
    let unit = Unit::Prefixed("J");
    let first = values.iter().copied().find(|e| e.is_finite()).unwrap_or(0.0);
    let largest =
        |v: &mut dyn Iterator<Item = f64>| v.filter(|e| e.is_finite()).fold(0.0, f64::max);
    let size = largest(&mut values.iter().map(|e| e.abs()));
    let change: Vec<f64> = values.iter().map(|e| e - first).collect();
    let moved = largest(&mut change.iter().map(|e| e.abs()));
    let mut quantities = vec![Quantity::single("energy", unit.clone(), values)];
    if moved > 0.0 && moved < SMALL_CHANGE * size {
        quantities.push(Quantity::single("energy change since start", unit, change));
    }
    quantities
}

/// Curves in groups of one unit that share an axis only where none would be flat on it.
pub fn by_size(label: &str, unit: &Unit, curves: Vec<Curve>) -> Vec<Quantity> {
    let mut groups: Vec<(f64, Vec<Curve>)> = Vec::new();
    for curve in curves {
        let finite = curve.values.iter().filter(|v| v.is_finite());
        let size = finite.fold(0.0f64, |size, v| size.max(v.abs()));
        let fits = |(other, _): &&mut (f64, Vec<Curve>)| {
            size == 0.0 || *other == 0.0 || (0.1..=10.0).contains(&(size / *other))
        };
        match groups.iter_mut().find(fits) {
            Some((other, group)) => {
                *other = other.max(size);
                group.push(curve);
            }
            None => groups.push((size, vec![curve])),
        }
    }
    let quantity = |(_, curves)| Quantity::new(label, unit.clone(), curves);
    groups.into_iter().map(quantity).collect()
}

/// A figure over time: what is drawn, not where.
#[derive(Clone, Debug, PartialEq)]
pub struct TimePlot {
    /// Title.
    pub title: String,
    /// Instants (s), ascending.
    pub time: Vec<f64>,
    /// Quantities from top to bottom.
    pub quantities: Vec<Quantity>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_change_of_energy_is_drawn_by_itself() {
        assert_eq!(energy(vec![1.0, 1.0 + 1e-9, 1.0]).len(), 2);
        assert_eq!(energy(vec![1.0, 2.0]).len(), 1);
        assert_eq!(energy(vec![1.0, 1.0]).len(), 1);
        assert_eq!(energy(vec![f64::NAN]).len(), 1);
    }

    #[test]
    fn curves_of_other_size_get_their_own_axis() {
        let curve = |size: f64| Curve { name: size.to_string(), values: vec![0.0, size] };
        let curves = [1.0, 1e-3, 2.0, 0.0].map(curve).to_vec();
        let found: Vec<usize> =
            by_size("r", &Unit::Angle, curves).iter().map(|q| q.curves.len()).collect();
        assert_eq!(found, [3, 1]);
    }
}
