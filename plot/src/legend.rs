//! Names of curves outside of the curves: beside a wide panel, above a narrow one.

use crate::canvas::{Canvas, GREY, Place, Stroke, TextStyle};
use crate::compose::{Line, Panel};
use crate::font;
use crate::palette;

/// Size of names (pt).
pub(crate) const SIZE: f64 = 6.8;
/// Height of a line of names (pt).
pub(crate) const LEADING: f64 = 8.6;
/// Length of a sample of the line (pt).
pub(crate) const SAMPLE: f64 = 9.0;
/// From the sample to the name (pt).
pub(crate) const GAP: f64 = 2.0;
/// From a panel to the names beside it (pt).
const AWAY: f64 = 9.0;
/// Widest name beside a panel (pt).
const WIDEST: f64 = 110.0;

/// Room that names beside a panel need (pt).
pub(crate) fn beside_width(panel: &Panel) -> f64 {
    let widest = panel.lines.iter().map(|l| font::width(&l.label, SIZE, false)).fold(0.0, f64::max);
    if panel.named() { AWAY + SAMPLE + GAP + widest.min(WIDEST) } else { 0.0 }
}

/// Draws names beside a panel whose frame ends at `right`, each near the end of its curve.
/// `ends` are the heights at which the curves end.
pub(crate) fn beside(
    canvas: &mut dyn Canvas,
    panel: &Panel,
    [right, top, bottom]: [f64; 3],
    ends: &[f64],
) {
    let heights = spread(ends, top + 0.5 * LEADING, bottom - 0.5 * LEADING);
    for ((line, end), height) in panel.lines.iter().zip(ends).zip(heights) {
        let stroke = palette::stroke(line.style);
        let thin = Stroke::solid(stroke.color, 0.4);
        canvas.line(&[[right + 1.0, *end], [right + AWAY - 1.5, height]], &thin);
        entry(canvas, line, [right + AWAY, height], WIDEST);
    }
}

/// A sample of the line and its name.
pub(crate) fn entry(canvas: &mut dyn Canvas, line: &Line, [x, y]: Place, room: f64) {
    sample(canvas, &palette::stroke(line.style), &line.label, [x, y], room);
}

/// A sample of any line and its name.
pub(crate) fn sample(
    canvas: &mut dyn Canvas,
    stroke: &Stroke,
    name: &str,
    [x, y]: Place,
    room: f64,
) {
    canvas.line(&[[x, y], [x + SAMPLE, y]], stroke);
    let at = [x + SAMPLE + GAP, y + 0.5 * font::CAP * SIZE];
    canvas.text(at, &font::fit(name, SIZE, false, room), &TextStyle::new(SIZE).color(GREY));
}

/// Heights as near to the wanted ones as can be without two lines of text meeting.
fn spread(wanted: &[f64], top: f64, bottom: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    let leading = LEADING.min((bottom - top) / (wanted.len().max(2) - 1) as f64);
    // Texts that would meet form piles; a pile stands around the mean of what its texts want.
    let mut piles: Vec<(f64, usize)> = Vec::new();
    for &i in &order {
        piles.push((wanted[i].clamp(top, bottom), 1));
        while let [.., (above, n), (below, m)] = piles[..] {
            if below - above >= 0.5 * leading * (n + m) as f64 - 1e-9 {
                break;
            }
            let count = n + m;
            let half = 0.5 * leading * (count - 1) as f64;
            let mean = (above * n as f64 + below * m as f64) / count as f64;
            piles.truncate(piles.len() - 2);
            piles.push((mean.clamp(top + half, (bottom - half).max(top + half)), count));
        }
    }
    let mut heights = vec![0.0; wanted.len()];
    let mut next = order.into_iter();
    for (middle, count) in piles {
        for k in 0..count {
            if let Some(i) = next.next() {
                heights[i] = middle + leading * (k as f64 - 0.5 * (count - 1) as f64);
            }
        }
    }
    heights
}

/// Places of names above a panel of the given width: x and line of each, and the number of lines.
pub(crate) fn strip(panel: &Panel, width: f64) -> (Vec<(f64, usize)>, usize) {
    if !panel.named() {
        return (Vec::new(), 0);
    }
    let (mut places, rows) = strip_within(panel, width);
    // As even as the same number of lines allows.
    let mut narrower = width;
    while narrower > 20.0 && rows > 1 {
        narrower -= 4.0;
        match strip_within(panel, narrower) {
            (even, same) if same == rows => places = even,
            _ => break,
        }
    }
    (places, rows)
}

fn strip_within(panel: &Panel, width: f64) -> (Vec<(f64, usize)>, usize) {
    flow(panel.lines.iter().map(|line| line.label.as_str()), width)
}

/// Places of names one after another in lines of a width: x and line of each, and the number of
/// lines.
pub(crate) fn flow<'a>(
    names: impl Iterator<Item = &'a str>,
    width: f64,
) -> (Vec<(f64, usize)>, usize) {
    let (mut x, mut row) = (0.0, 0);
    let mut places = Vec::new();
    for name in names {
        let needed = SAMPLE + GAP + font::width(name, SIZE, false);
        if x > 0.0 && x + needed > width {
            (x, row) = (0.0, row + 1);
        }
        places.push((x, row));
        x += needed + 4.0;
    }
    (places, row + 1)
}

/// Draws names above a panel; the strip's lowest line ends at `bottom`.
pub(crate) fn above(canvas: &mut dyn Canvas, panel: &Panel, left: f64, width: f64, bottom: f64) {
    let (places, rows) = strip(panel, width);
    for (line, (x, row)) in panel.lines.iter().zip(places) {
        let y = bottom - LEADING * ((rows - row) as f64 - 0.5);
        entry(canvas, line, [left + x, y], width - x - SAMPLE - GAP);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_never_meet_nor_leave_the_panel() {
        for wanted in [
            vec![10.0, 10.5, 11.0, 60.0],
            vec![100.0, 100.0, 100.0],
            vec![-20.0, 0.0, 0.0, 50.0, 52.0, 120.0],
            vec![50.0; 8],
        ] {
            let heights = spread(&wanted, 5.0, 90.0);
            let mut sorted = heights.clone();
            sorted.sort_by(f64::total_cmp);
            assert!(sorted.windows(2).all(|w| w[1] - w[0] > LEADING - 1e-6), "{sorted:?}");
            assert!(sorted[0] >= 5.0 - 1e-6 && sorted[sorted.len() - 1] <= 90.0 + 1e-6);
        }
        assert_eq!(spread(&[30.0], 5.0, 90.0), [30.0]);
        assert!(spread(&[], 5.0, 90.0).is_empty());
    }
}
