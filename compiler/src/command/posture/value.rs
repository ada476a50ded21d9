//! Numbers of the command line: SI, or with a unit of the language.

use handc_dsl::dimension::Dimension;
use handc_dsl::unit::{UNITS, Unit};

/// Reads `0.35`, `20deg` or `5 mm`: a finite number, SI where no unit is given.
pub(crate) fn number(text: &str, dimension: Dimension) -> Result<f64, String> {
    let text = text.trim();
    if let Ok(value) = text.parse::<f64>() {
        return finite(value, text);
    }
    let fits = || {
        let names = UNITS.iter().filter(|(_, unit)| unit.dimension == dimension);
        names.map(|(name, _)| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    let split = text.find(|c: char| c.is_ascii_alphabetic() && !matches!(c, 'e' | 'E'));
    let (value, unit) = text.split_at(split.unwrap_or(text.len()));
    let (Ok(value), false) = (value.trim().parse::<f64>(), unit.is_empty()) else {
        return Err(format!("`{text}` is not a number"));
    };
    match Unit::named(unit) {
        Some(found) if found.dimension == dimension => finite(found.to_si(value), text),
        Some(_) => Err(format!("`{unit}` does not fit here: use {}", fits())),
        None => Err(format!("`{unit}` is not a unit: use {}", fits())),
    }
}

fn finite(value: f64, text: &str) -> Result<f64, String> {
    if value.is_finite() { Ok(value) } else { Err(format!("`{text}` is not a finite number")) }
}

/// Reads three numbers, `0,0,-5` or `0,-5mm,0`.
pub(crate) fn triple(text: &str, dimension: Dimension) -> Result<[f64; 3], String> {
    let parts: Vec<&str> = text.split(',').collect();
    let [x, y, z] = parts[..] else {
        return Err(format!("`{text}` is not three numbers with commas between them"));
    };
    Ok([number(x, dimension)?, number(y, dimension)?, number(z, dimension)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_may_have_units() {
        assert_eq!(number("-1.5e-3", Dimension::LENGTH), Ok(-1.5e-3));
        assert_eq!(number("5 mm", Dimension::LENGTH), Ok(0.005));
        assert_eq!(number("30deg", Dimension::ANGLE), Ok(30f64.to_radians()));
        assert_eq!(number("2e1N", Dimension::FORCE), Ok(20.0));
        assert_eq!(triple("1, -2N,0", Dimension::FORCE), Ok([1.0, -2.0, 0.0]));
    }

    #[test]
    fn wrong_numbers_are_told() {
        let said = |text, dimension| number(text, dimension).unwrap_err();
        assert!(said("5mm", Dimension::FORCE).contains("use `N`, `mN`, `kN`"));
        assert!(said("5furlong", Dimension::LENGTH).contains("`mm`"));
        assert!(said("nan", Dimension::FORCE).contains("finite"));
        assert!(said("1e999", Dimension::FORCE).contains("finite"));
        assert!(said("", Dimension::FORCE).contains("not a number"));
        assert!(said("mm", Dimension::LENGTH).contains("not a number"));
        assert!(triple("1,2", Dimension::FORCE).unwrap_err().contains("three numbers"));
    }
}
