//! Curves as lines on paper: gaps where numbers are missing, and no more points than can be seen.

use crate::canvas::Place;
use crate::ticks::drawable;

/// Bins per point of paper: finer than a printer's dot matters little, coarser shows.
const BINS: f64 = 2.0;
/// How far a line may run from a sample (points of paper): less than can be seen.
const FLAT: f64 = 0.06;

/// First, lowest, highest and last of a bin, as indices.
#[derive(Clone, Copy)]
struct Bin {
    at: i64,
    first: usize,
    low: usize,
    high: usize,
    last: usize,
}

/// Polylines through the samples. `place` maps an index to paper; more samples than bins are
/// reduced to each bin's first, lowest, highest and last, so that no peak is lost.
pub(crate) fn lines(count: usize, width: f64, place: impl Fn(usize) -> Place) -> Vec<Vec<Place>> {
    let dense = count as f64 > 4.0 * BINS * width;
    let mut lines = Vec::new();
    let mut line: Vec<Place> = Vec::new();
    let mut bin: Option<Bin> = None;
    for i in 0..count {
        let point = place(i);
        if !(drawable(point[0]) && drawable(point[1])) {
            flush(&mut line, bin.take(), &place);
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            continue;
        }
        if !dense {
            line.push(point);
            continue;
        }
        let at = (point[0] * BINS).floor() as i64;
        match &mut bin {
            Some(bin) if bin.at == at => {
                // Paper's y grows downwards.
                if point[1] > place(bin.low)[1] {
                    bin.low = i;
                }
                if point[1] < place(bin.high)[1] {
                    bin.high = i;
                }
                bin.last = i;
            }
            _ => {
                flush(&mut line, bin, &place);
                bin = Some(Bin { at, first: i, low: i, high: i, last: i });
            }
        }
    }
    flush(&mut line, bin, &place);
    if !line.is_empty() {
        lines.push(line);
    }
    lines.iter().map(|line| straighten(line)).collect()
}

/// Leaves out points that lie within [`FLAT`] of the line between those kept (Douglas and Peucker).
fn straighten(line: &[Place]) -> Vec<Place> {
    if line.len() < 3 {
        return line.to_vec();
    }
    let mut kept = vec![false; line.len()];
    kept[0] = true;
    kept[line.len() - 1] = true;
    let mut open = vec![(0, line.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let away = |i: usize| distance(line[i], line[from], line[to]);
        let farthest = (from + 1..to).max_by(|&a, &b| away(a).total_cmp(&away(b)));
        if let Some(middle) = farthest.filter(|&i| away(i) > FLAT) {
            kept[middle] = true;
            open.extend([(from, middle), (middle, to)]);
        }
    }
    line.iter().zip(kept).filter_map(|(&point, kept)| kept.then_some(point)).collect()
}

/// Distance of a point from the line piece between two others.
fn distance(p: Place, a: Place, b: Place) -> f64 {
    let along = [b[0] - a[0], b[1] - a[1]];
    let from = [p[0] - a[0], p[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let part = match square > 0.0 {
        true => ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0),
        false => 0.0,
    };
    (from[0] - part * along[0]).hypot(from[1] - part * along[1])
}

fn flush(line: &mut Vec<Place>, bin: Option<Bin>, place: &impl Fn(usize) -> Place) {
    let Some(bin) = bin else { return };
    let mut kept = [bin.first, bin.low, bin.high, bin.last];
    kept.sort_unstable();
    for (k, &i) in kept.iter().enumerate() {
        if k == 0 || kept[k - 1] != i {
            line.push(place(i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_samples_keep_their_peaks() {
        let n = 1_000_000;
        let spike = 345_678;
        let value = |i: usize| if i == spike { 50.0 } else { (i as f64 * 0.1).sin() };
        let found = lines(n, 100.0, |i| [i as f64 / n as f64 * 100.0, -value(i)]);
        assert_eq!(found.len(), 1);
        assert!(found[0].len() <= 804, "{}", found[0].len());
        assert!(found[0].iter().any(|p| p[1] == -50.0));
    }

    #[test]
    fn straight_pieces_need_no_points_and_corners_keep_theirs() {
        let corner = |i: usize| [i as f64 * 0.5, (i as f64 - 40.0).abs()];
        assert_eq!(lines(81, 100.0, corner), [vec![corner(0), corner(40), corner(80)]]);
        let wave = |i: usize| [i as f64 * 0.5, 2.0 * (i as f64 * 0.1).sin()];
        let found = lines(200, 100.0, wave).concat();
        assert!(found.len() < 80, "{}", found.len());
        for i in 0..200 {
            let near = |pair: &[Place]| distance(wave(i), pair[0], pair[1]);
            let best = found.windows(2).map(near).fold(f64::INFINITY, f64::min);
            assert!(best <= FLAT, "{i}: {best}");
        }
    }

    #[test]
    fn missing_numbers_break_the_line() {
        let values = [1.0, 2.0, f64::NAN, 3.0, f64::INFINITY, f64::INFINITY, 4.0];
        let found = lines(7, 100.0, |i| [i as f64, values[i]]);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1, 1]);
        assert!(lines(0, 100.0, |_| [0.0, 0.0]).is_empty());
    }
}
