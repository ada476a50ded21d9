//! Colours that colour-blind readers can tell apart, and dashes for what colours alone cannot.

use crate::canvas::{Color, Stroke};

/// The set of Okabe and Ito (2008) without yellow, which is too light for thin lines on white, and
/// a grey.
const COLORS: [Color; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [0, 0, 0],
    [230, 159, 0],
    [86, 180, 233],
    [120, 120, 120],
];

/// Dashes: four curves each.
const DASHES: [&[f64]; 4] = [&[], &[4.0, 1.8], &[1.2, 1.4], &[6.0, 1.6, 1.2, 1.6]];

/// Most curves that one panel shows.
pub(crate) const MOST: usize = 8;

/// The colour of curve `index`.
pub(crate) fn color(index: usize) -> Color {
    COLORS[index % COLORS.len()]
}

/// The colour of curve `index`, `whiter` by this share.
pub(crate) fn pale(index: usize, whiter: f64) -> Color {
    color(index).map(|part| (f64::from(part) + whiter * (255.0 - f64::from(part))).round() as u8)
}

/// The line of curve `index`.
pub(crate) fn stroke(index: usize) -> Stroke {
    Stroke { color: color(index), width: 0.8, dash: DASHES[index / 4 % DASHES.len()] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lines_of_a_panel_differ() {
        for i in 0..MOST {
            for j in 0..i {
                assert_ne!(stroke(i), stroke(j));
            }
        }
    }
}
