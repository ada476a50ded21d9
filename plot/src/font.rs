//! The font of every figure: widths for the layout, outlines for the PNG.

use std::sync::LazyLock;
use ttf_parser::{Face, OutlineBuilder};

static REGULAR: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("../assets/DejaVuSansCondensed.ttf"), 0).ok());
static BOLD: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("../assets/DejaVuSansCondensed-Bold.ttf"), 0).ok());

/// Family for SVG: the same font where it is installed, else one of about the same widths.
pub(crate) const FAMILY: &str = "'DejaVu Sans Condensed', Helvetica, Arial, sans-serif";

/// Advance per em of a character that the font lacks.
const UNKNOWN: f64 = 0.6;

/// Height of capitals and digits per em; half of it centres a text on a line.
pub(crate) const CAP: f64 = 0.73;

fn face(bold: bool) -> Option<&'static Face<'static>> {
    if bold { BOLD.as_ref() } else { REGULAR.as_ref() }
}

/// Width of a text (pt).
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    let Some(face) = face(bold) else { return UNKNOWN * size * text.chars().count() as f64 };
    text.chars().map(|c| advance(face, c)).sum::<f64>() * size
}

/// Advance of a character per em.
fn advance(face: &Face, c: char) -> f64 {
    face.glyph_index(c)
        .and_then(|glyph| face.glyph_hor_advance(glyph))
        .map_or(UNKNOWN, |advance| f64::from(advance) / f64::from(face.units_per_em()))
}

/// The text, cut with `…` where it would be wider than `room` (pt).
pub(crate) fn fit(text: &str, size: f64, bold: bool, room: f64) -> String {
    if width(text, size, bold) <= room {
        return text.to_string();
    }
    let mut kept: String = text.to_string();
    while kept.pop().is_some() {
        let cut = format!("{}…", kept.trim_end());
        if width(&cut, size, bold) <= room {
            return cut;
        }
    }
    String::new()
}

/// Sends the outline of a text that begins at the origin to `pen`: x to the right and y upwards,
/// in units of which `scale` are returned per em. `moved` is called with each glyph's origin.
pub(crate) fn outline<P: OutlineBuilder>(
    text: &str,
    bold: bool,
    pen: &mut P,
    moved: fn(&mut P, f64),
) -> f64 {
    let Some(face) = face(bold) else { return 1.0 };
    let em = f64::from(face.units_per_em());
    let mut x = 0.0;
    for c in text.chars() {
        moved(pen, x);
        if let Some(glyph) = face.glyph_index(c) {
            face.outline_glyph(glyph, pen);
        }
        x += advance(face, c) * em;
    }
    em
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_in_use_is_in_the_font() {
        let signs = "aZ09°−×⁰¹²³⁴⁵⁶⁷⁸⁹⁻µλΔ·…()/–";
        for bold in [false, true] {
            let face = face(bold).expect("a font");
            for c in signs.chars() {
                assert!(face.glyph_index(c).is_some(), "{c}");
            }
        }
    }

    #[test]
    fn long_texts_are_cut() {
        let text = "a very long name of a strand";
        let cut = fit(text, 7.0, false, 40.0);
        assert!(cut.ends_with('…') && width(&cut, 7.0, false) <= 40.0);
        assert_eq!(fit("ab", 7.0, false, 40.0), "ab");
        assert_eq!(fit("ab", 7.0, false, 0.1), "");
    }
}
