//! What an ensemble does as a whole: mean, deviation and quantiles of every column over the copies,
//! at every time of which rows are kept.
//!
//! Quantiles are exact: they need all numbers, which are kept until the end. Their number is known
//! before the first step, so that too many of them are refused at once rather than when memory is
//! full.

use crate::error::RunError;
use crate::trajectory::push_number;
use std::path::Path;

/// Quantiles in the file, and what they are called.
const QUANTILES: [(f64, &str); 7] = [
    (0.0, "min"),
    (0.05, "q05"),
    (0.25, "q25"),
    (0.5, "median"),
    (0.75, "q75"),
    (0.95, "q95"),
    (1.0, "max"),
];
/// Most bytes of numbers that are kept.
const ROOM: usize = 2 << 30;

/// The rows of all copies.
#[derive(Debug)]
pub(super) struct Summary {
    columns: Vec<String>,
    /// Rows of each copy, one after another; a copy that fails has fewer.
    copies: Vec<Vec<f64>>,
}

impl Summary {
    /// For copies that give `rows` rows each; an error if they are too many.
    pub(super) fn new(columns: &[String], rows: usize, copies: usize) -> Result<Self, RunError> {
        let bytes = copies.saturating_mul(rows).saturating_mul(8 * columns.len());
        if bytes > ROOM {
            let fewer = rows.saturating_mul(ROOM) / bytes;
            return Err(RunError::Usage(format!(
                "a summary of {copies} instances with {rows} rows of {} columns needs {:.1} GB: \
                 give `--every N` so that at most {fewer} rows are left",
                columns.len(),
                bytes as f64 * 1e-9
            )));
        }
        Ok(Summary { columns: columns.to_vec(), copies: vec![Vec::new(); copies] })
    }

    /// Takes the next row of a copy.
    pub(super) fn take(&mut self, copy: usize, row: &[f64]) {
        self.copies[copy].extend_from_slice(row);
    }

    /// The table: a row for each time, `t`, `instances` that have come so far, then mean, deviation
    /// and quantiles of each column.
    fn text(&self) -> String {
        let width = self.columns.len();
        let mut text = String::from("t,instances");
        for column in self.columns.iter().skip(1) {
            text.push_str(&format!(",{column}.mean,{column}.deviation"));
            QUANTILES.iter().for_each(|(_, name)| text.push_str(&format!(",{column}.{name}")));
        }
        text.push('\n');
        let rows = self.copies.iter().map(|copy| copy.len() / width).max().unwrap_or(0);
        let mut numbers = Vec::with_capacity(self.copies.len());
        for row in 0..rows {
            let here = || self.copies.iter().filter_map(|copy| copy.chunks_exact(width).nth(row));
            let times = here().map(|row| row[0]);
            push_number(&mut text, times.fold(f64::NEG_INFINITY, f64::max));
            text.push_str(&format!(",{}", here().count()));
            for column in 1..width {
                numbers.clear();
                numbers.extend(here().map(|row| row[column]));
                numbers.sort_unstable_by(f64::total_cmp);
                for number in statistics(&numbers) {
                    text.push(',');
                    push_number(&mut text, number);
                }
            }
            text.push('\n');
        }
        text
    }

    /// Writes the table.
    pub(super) fn write(&self, path: &Path) -> Result<(), RunError> {
        let fail = |error| RunError::Io(format!("cannot write `{}`: {error}", path.display()));
        std::fs::write(path, self.text()).map_err(fail)
    }
}

/// Mean, standard deviation of the sample, and quantiles of sorted numbers.
fn statistics(sorted: &[f64]) -> impl Iterator<Item = f64> {
    let count = sorted.len() as f64;
    let mean = sorted.iter().sum::<f64>() / count;
    let squares: f64 = sorted.iter().map(|x| (x - mean) * (x - mean)).sum();
    let deviation = (squares / (count - 1.0).max(1.0)).sqrt();
    [mean, deviation].into_iter().chain(QUANTILES.map(|(share, _)| quantile(sorted, share)))
}

/// The number below which a share of sorted numbers lies, with straight lines between them (type 7
/// of Hyndman and Fan, The American Statistician 50:361-365, 1996).
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * (sorted.len() - 1) as f64;
    let (below, part) = (place.floor() as usize, place.fract());
    let above = (below + 1).min(sorted.len() - 1);
    // Equal numbers stay as they are, whatever they are.
    if part == 0.0 || sorted[below] == sorted[above] {
        return sorted[below];
    }
    sorted[below] + part * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_by_hand() {
        let mut summary = Summary::new(&["t".into(), "x".into()], 2, 4).unwrap();
        for (copy, x) in [4.0, 1.0, 2.0, 3.0].into_iter().enumerate() {
            summary.take(copy, &[0.0, x]);
            if copy != 1 {
                summary.take(copy, &[0.5, 10.0 * x]);
            }
        }
        let text = summary.text();
        let table: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let column = |name: &str| table[0].iter().position(|n| *n == name).unwrap();
        let value = |row: usize, name: &str| table[row][column(name)].parse::<f64>().unwrap();
        assert_eq!(value(1, "t"), 0.0);
        assert_eq!(value(1, "instances"), 4.0);
        assert_eq!(value(1, "x.mean"), 2.5);
        assert!((value(1, "x.deviation") - (5.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(value(1, "x.min"), 1.0);
        assert_eq!(value(1, "x.q25"), 1.75);
        assert_eq!(value(1, "x.median"), 2.5);
        assert_eq!(value(1, "x.max"), 4.0);
        // One copy has failed before.
        assert_eq!((value(2, "t"), value(2, "instances")), (0.5, 3.0));
        assert_eq!(value(2, "x.median"), 30.0);
    }

    #[test]
    fn too_much_is_refused_before_it_begins() {
        let error = Summary::new(&["t".into(), "x".into()], 1 << 20, 1 << 20).unwrap_err();
        assert!(error.to_string().contains("--every"), "{error}");
    }
}
