//! Physical dimensions: what kind of quantity a number is.
//!
//! An angle is dimensionless here, so a torque and an energy share one dimension. All quantities
//! are kept in SI units of their dimension; the unit table lives in [`crate::unit`].

use serde::Serialize;
use std::fmt;

/// Exponents of length, mass and time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Dimension {
    /// Exponent of the metre.
    pub length: i8,
    /// Exponent of the kilogram.
    pub mass: i8,
    /// Exponent of the second.
    pub time: i8,
}

const fn dim(length: i8, mass: i8, time: i8) -> Dimension {
    Dimension { length, mass, time }
}

#[rustfmt::skip]
impl Dimension {
    /// A plain number or an angle.
    pub const NONE: Dimension = dim(0, 0, 0);
    /// A plain number or an angle.
    pub const ANGLE: Dimension = dim(0, 0, 0);
    /// m
    pub const LENGTH: Dimension = dim(1, 0, 0);
    /// kg
    pub const MASS: Dimension = dim(0, 1, 0);
    /// s
    pub const TIME: Dimension = dim(0, 0, 1);
    /// kg/m^3
    pub const DENSITY: Dimension = dim(-3, 1, 0);
    /// kg*m^2
    pub const INERTIA: Dimension = dim(2, 1, 0);
    /// m/s
    pub const VELOCITY: Dimension = dim(1, 0, -1);
    /// m/s^2
    pub const ACCELERATION: Dimension = dim(1, 0, -2);
    /// rad/s, also Hz
    pub const ANGULAR_VELOCITY: Dimension = dim(0, 0, -1);
    /// N
    pub const FORCE: Dimension = dim(1, 1, -2);
    /// N*m
    pub const TORQUE: Dimension = dim(2, 1, -2);
    /// J
    pub const ENERGY: Dimension = dim(2, 1, -2);
    /// W
    pub const POWER: Dimension = dim(2, 1, -3);
    /// Pa
    pub const PRESSURE: Dimension = dim(-1, 1, -2);
    /// N/m
    pub const STIFFNESS: Dimension = dim(0, 1, -2);
    /// N*s/m
    pub const DAMPING: Dimension = dim(0, 1, -1);
    /// N*m/rad
    pub const ANGULAR_STIFFNESS: Dimension = dim(2, 1, -2);
    /// N*m*s/rad
    pub const ANGULAR_DAMPING: Dimension = dim(2, 1, -1);
}

/// Names of the common dimensions: the unit to show, what to call it, units a person would write.
#[rustfmt::skip]
const NAMED: &[(Dimension, &str, &str, &[&str])] = &[
    (Dimension::NONE, "rad or none", "a plain number or an angle", &["rad", "deg"]),
    (Dimension::LENGTH, "m", "a length", &["mm", "m"]),
    (Dimension::MASS, "kg", "a mass", &["g", "kg"]),
    (Dimension::TIME, "s", "a time", &["ms", "s"]),
    (Dimension::DENSITY, "kg/m^3", "a density", &["kg/m^3"]),
    (Dimension::INERTIA, "kg*m^2", "a moment of inertia", &["g*mm^2", "kg*m^2"]),
    (Dimension::VELOCITY, "m/s", "a velocity", &["mm/s", "m/s"]),
    (Dimension::ACCELERATION, "m/s^2", "an acceleration", &["m/s^2"]),
    (Dimension::ANGULAR_VELOCITY, "rad/s", "an angular velocity", &["rad/s", "deg/s"]),
    (dim(0, 0, -2), "rad/s^2", "an angular acceleration", &["rad/s^2"]),
    (Dimension::FORCE, "N", "a force", &["N"]),
    (Dimension::TORQUE, "N*m", "a torque or an energy", &["N*m"]),
    (Dimension::POWER, "W", "a power", &["W"]),
    (Dimension::PRESSURE, "Pa", "a pressure", &["Pa", "kPa"]),
    (Dimension::STIFFNESS, "N/m", "a stiffness", &["N/m"]),
    (Dimension::DAMPING, "N*s/m", "a damping", &["N*s/m"]),
    (Dimension::ANGULAR_DAMPING, "N*m*s", "an angular damping", &["N*m*s/rad"]),
    (dim(2, 0, 0), "m^2", "an area", &["mm^2", "m^2"]),
    (dim(3, 0, 0), "m^3", "a volume", &["mm^3", "m^3"]),
    (dim(1, 1, -1), "N*s", "a momentum", &["N*s"]),
];

impl Dimension {
    /// Whether it is a plain number or an angle.
    pub fn is_none(self) -> bool {
        self == Dimension::NONE
    }

    /// The dimension of a product; `None` where an exponent leaves its range.
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        Some(Dimension {
            length: self.length.checked_add(other.length)?,
            mass: self.mass.checked_add(other.mass)?,
            time: self.time.checked_add(other.time)?,
        })
    }

    /// The dimension of a quotient; `None` where an exponent leaves its range.
    pub fn over(self, other: Dimension) -> Option<Dimension> {
        self.times(other.power(-1)?)
    }

    /// The dimension of an integer power; `None` where an exponent leaves its range.
    pub fn power(self, exponent: i32) -> Option<Dimension> {
        let scale = |e: i8| i8::try_from(i32::from(e).checked_mul(exponent)?).ok();
        Some(Dimension {
            length: scale(self.length)?,
            mass: scale(self.mass)?,
            time: scale(self.time)?,
        })
    }

    /// The dimension of a square root; `None` if an exponent is odd.
    pub fn root(self) -> Option<Dimension> {
        let half = |e: i8| (e % 2 == 0).then_some(e / 2);
        Some(Dimension {
            length: half(self.length)?,
            mass: half(self.mass)?,
            time: half(self.time)?,
        })
    }

    /// What a person calls it: `a length`, or its unit where it has no name.
    pub fn describe(self) -> String {
        match NAMED.iter().find(|n| n.0 == self) {
            Some(named) => named.2.to_string(),
            None => format!("a quantity in {self}"),
        }
    }

    /// Units a person would write for it, the likeliest first.
    pub fn usual_units(self) -> Vec<String> {
        match NAMED.iter().find(|n| n.0 == self) {
            Some(named) => named.3.iter().map(|u| (*u).to_string()).collect(),
            None => vec![self.to_string()],
        }
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(named) = NAMED.iter().find(|n| n.0 == *self) {
            return f.write_str(named.1);
        }
        let parts = [("kg", self.mass), ("m", self.length), ("s", self.time)];
        let mut first = true;
        for (unit, exponent) in parts.iter().filter(|p| p.1 > 0) {
            if !first {
                f.write_str("*")?;
            }
            first = false;
            write_power(f, unit, *exponent)?;
        }
        if first {
            f.write_str("1")?;
        }
        for (unit, exponent) in parts.iter().filter(|p| p.1 < 0) {
            f.write_str("/")?;
            write_power(f, unit, exponent.saturating_neg())?;
        }
        Ok(())
    }
}

fn write_power(f: &mut fmt::Formatter<'_>, unit: &str, exponent: i8) -> fmt::Result {
    if exponent == 1 { f.write_str(unit) } else { write!(f, "{unit}^{exponent}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shows_readable_units() {
        assert_eq!(Dimension::TORQUE.to_string(), "N*m");
        assert_eq!(Dimension::INERTIA.to_string(), "kg*m^2");
        assert_eq!(Dimension::NONE.to_string(), "rad or none");
        assert_eq!(dim(-1, 0, 0).to_string(), "1/m");
        assert_eq!(dim(4, 2, -3).to_string(), "kg^2*m^4/s^3");
    }

    #[test]
    fn exponents_do_not_wrap() {
        assert_eq!(Dimension::LENGTH.power(200), None);
        assert_eq!(Dimension::LENGTH.root(), None);
        assert_eq!(dim(2, 0, 0).root(), Some(Dimension::LENGTH));
        assert_eq!(dim(-128, 0, 0).power(-1), None);
    }
}
