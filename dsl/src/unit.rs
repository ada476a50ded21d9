//! The table of units.
//!
//! A unit's factor is kept as a fraction of two numbers that binary floating point holds exactly
//! (degrees excepted), so that `39.8 mm` is `39.8 / 1000`: the closest number to 0.0398.

use crate::dimension::Dimension;
use std::f64::consts::PI;

/// A unit or a product of units: SI value = written value · `numerator` / `denominator`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Multiplies the written value.
    pub numerator: f64,
    /// Divides it.
    pub denominator: f64,
    /// What it measures.
    pub dimension: Dimension,
}

const fn unit(numerator: f64, denominator: f64, dimension: Dimension) -> Unit {
    Unit { numerator, denominator, dimension }
}

/// Every unit by name.
#[rustfmt::skip]
pub const UNITS: &[(&str, Unit)] = &[
    ("m", unit(1.0, 1.0, Dimension::LENGTH)),
    ("mm", unit(1.0, 1e3, Dimension::LENGTH)),
    ("cm", unit(1.0, 1e2, Dimension::LENGTH)),
    ("km", unit(1e3, 1.0, Dimension::LENGTH)),
    ("kg", unit(1.0, 1.0, Dimension::MASS)),
    ("g", unit(1.0, 1e3, Dimension::MASS)),
    ("mg", unit(1.0, 1e6, Dimension::MASS)),
    ("s", unit(1.0, 1.0, Dimension::TIME)),
    ("ms", unit(1.0, 1e3, Dimension::TIME)),
    ("us", unit(1.0, 1e6, Dimension::TIME)),
    ("min", unit(60.0, 1.0, Dimension::TIME)),
    ("rad", unit(1.0, 1.0, Dimension::NONE)),
    ("deg", unit(PI / 180.0, 1.0, Dimension::NONE)),
    ("N", unit(1.0, 1.0, Dimension::FORCE)),
    ("mN", unit(1.0, 1e3, Dimension::FORCE)),
    ("kN", unit(1e3, 1.0, Dimension::FORCE)),
    ("J", unit(1.0, 1.0, Dimension::ENERGY)),
    ("mJ", unit(1.0, 1e3, Dimension::ENERGY)),
    ("W", unit(1.0, 1.0, Dimension::POWER)),
    ("Pa", unit(1.0, 1.0, Dimension::PRESSURE)),
    ("kPa", unit(1e3, 1.0, Dimension::PRESSURE)),
    ("MPa", unit(1e6, 1.0, Dimension::PRESSURE)),
    ("GPa", unit(1e9, 1.0, Dimension::PRESSURE)),
    ("Hz", unit(1.0, 1.0, Dimension::ANGULAR_VELOCITY)),
];

impl Unit {
    /// The unit of plain numbers.
    pub const ONE: Unit = unit(1.0, 1.0, Dimension::NONE);

    /// The unit of this name.
    pub fn named(name: &str) -> Option<Unit> {
        UNITS.iter().find(|u| u.0 == name).map(|u| u.1)
    }

    /// This unit times `other` to the power `exponent`; `None` where it leaves the range of numbers.
    pub fn times_power(self, other: Unit, exponent: i32) -> Option<Unit> {
        let (up, down) = if exponent < 0 {
            (other.denominator, other.numerator)
        } else {
            (other.numerator, other.denominator)
        };
        let size = i32::try_from(exponent.unsigned_abs()).ok()?;
        let result = Unit {
            numerator: self.numerator * up.powi(size),
            denominator: self.denominator * down.powi(size),
            dimension: self.dimension.times(other.dimension.power(exponent)?)?,
        };
        let fine = |x: f64| x.is_finite() && x > 0.0;
        (fine(result.numerator) && fine(result.denominator)).then_some(result)
    }

    /// A value written in this unit, in SI.
    pub fn to_si(self, value: f64) -> f64 {
        value * self.numerator / self.denominator
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_exact_where_they_can_be() {
        let mm = Unit::named("mm").unwrap();
        assert_eq!(mm.to_si(9.0), 0.009);
        let inertia = Unit::named("g").unwrap().times_power(mm, 2).unwrap();
        assert_eq!(inertia.to_si(158.0), 158e-9);
        assert_eq!(inertia.dimension, Dimension::INERTIA);
        assert_eq!(Unit::named("deg").unwrap().to_si(30.0), 30f64.to_radians());
    }
}
