//! Units: what a number measures, and the prefix that makes it short.

/// What the numbers of a quantity measure. Numbers come in SI units.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unit {
    /// An angle, drawn in degrees.
    Angle,
    /// A unit that takes prefixes: `m`, `N`, `J`.
    Prefixed(&'static str),
    /// A unit as it stands, or none.
    Plain(String),
}

/// What numbers are multiplied by before they are drawn, and the unit that they then have.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scale {
    /// Drawn value per SI value.
    pub(crate) factor: f64,
    /// For the axis, without brackets; may be empty.
    pub(crate) unit: String,
}

const PREFIXES: [(f64, &str); 5] = [(1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];

impl Unit {
    /// The scale for numbers up to `size` (SI).
    pub(crate) fn scale(&self, size: f64) -> Scale {
        match self {
            Unit::Angle => {
                let degrees = 180.0 / std::f64::consts::PI;
                if size * degrees >= 1e5 {
                    return powers(size, "rad");
                }
                Scale { factor: degrees, unit: "°".into() }
            }
            Unit::Prefixed(unit) => {
                if size == 0.0 {
                    return Scale { factor: 1.0, unit: (*unit).into() };
                }
                // Whole units reach further down than the others: 0.5 N is not 500 mN; metres do
                // not, since parts of a hand are told in mm.
                let reach = if *unit == "m" { 1.0 } else { 0.3 };
                let found = PREFIXES
                    .into_iter()
                    .filter(|(_, prefix)| !(*prefix == "k" && *unit == "s"))
                    .find(|(value, prefix)| {
                        size >= value * if prefix.is_empty() { reach } else { 1.0 }
                    });
                match found {
                    Some((value, prefix)) if size < 1e5 * value => {
                        Scale { factor: 1.0 / value, unit: format!("{prefix}{unit}") }
                    }
                    _ => powers(size, unit),
                }
            }
            Unit::Plain(unit) if size == 0.0 || (1e-2..1e5).contains(&size) => {
                Scale { factor: 1.0, unit: unit.clone() }
            }
            Unit::Plain(unit) => powers(size, unit),
        }
    }

    /// Whether ticks should prefer parts of the circle.
    pub(crate) fn degrees(scale: &Scale) -> bool {
        scale.unit == "°"
    }
}

/// A power of ten in front of the unit.
fn powers(size: f64, unit: &str) -> Scale {
    let exponent = size.log10().floor();
    if !exponent.is_finite() {
        return Scale { factor: 1.0, unit: unit.into() };
    }
    let exponent = (3.0 * (exponent / 3.0).floor()).max(-300.0) as i32;
    let digits: String = exponent.to_string().chars().map(superscript).collect();
    let unit = format!("10{digits} {unit}");
    Scale { factor: 10f64.powi(-exponent), unit: unit.trim_end().into() }
}

fn superscript(c: char) -> char {
    match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_suit_the_size() {
        let unit = |unit: &'static str, size| Unit::Prefixed(unit).scale(size).unit;
        assert_eq!(unit("m", 0.13), "mm");
        assert_eq!(unit("m", 2.0), "m");
        assert_eq!(unit("N", 0.5), "N");
        assert_eq!(unit("N", 0.02), "mN");
        assert_eq!(unit("J", 3e-5), "µJ");
        assert_eq!(unit("J", 3e-17), "10⁻¹⁸ J");
        assert_eq!(unit("s", 3e4), "s");
        assert_eq!(unit("m", 1.5e11), "10⁹ m");
        assert_eq!(unit("J", 0.0), "J");
        assert_eq!(Unit::Plain(String::new()).scale(2e-7).unit, "10⁻⁹");
        assert_eq!(Unit::Angle.scale(2.0).unit, "°");
        assert_eq!(Unit::Angle.scale(1e6).unit, "10⁶ rad");
    }

    #[test]
    fn sizes_without_a_number_do_no_harm() {
        for size in [f64::NAN, f64::INFINITY, 1e-320, 1e300] {
            for unit in [Unit::Angle, Unit::Prefixed("m"), Unit::Plain("K".into())] {
                assert!(unit.scale(size).factor > 0.0);
            }
        }
    }
}
