//! The answer as text: tables for a reader, in degrees, millimetres and newtons.

use super::answer::Answer;
use crate::command::posture::Posture;
use handc_core::layout::CoordinateKind;
use handc_core::model::Model as _;
use handc_runtime::analysis::tangent::Stability;
use handc_runtime::mechanism::Law;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Most of a direction's shape that is named.
const NAMED: usize = 3;
/// Parts of a shape smaller than this are not named.
const PART: f64 = 0.15;

/// A table of text. Numbers are aligned to the right; words, in the first column and in those whose
/// head begins with `<`, to the left.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    rows: Vec<Vec<String>>,
    words: Vec<bool>,
}

impl Table {
    pub(super) fn new(head: &[&str]) -> Table {
        let words = head.iter().enumerate().map(|(c, cell)| c == 0 || cell.starts_with('<'));
        let cells = head.iter().map(|cell| cell.trim_start_matches('<').to_string());
        Table { rows: vec![cells.collect()], words: words.collect() }
    }
    pub(super) fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }
    /// The table, indented.
    pub(super) fn text(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |c: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(c));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::from(" ");
            for (c, cell) in row.iter().enumerate() {
                let width = widths[c];
                let gap = if c == 0 { " " } else { "  " };
                let _ = match self.words.get(c) {
                    Some(true) => write!(line, "{gap}{cell:<width$}"),
                    _ => write!(line, "{gap}{cell:>width$}"),
                };
            }
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text
    }
}

/// A number with a fixed count of decimals; zero has no sign.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
    if is_zero { text.trim_start_matches('-').to_string() } else { text }
}

/// An angle in degrees, a length in millimetres, with its unit, or a plain number.
pub(super) fn value(posture: &Posture, coordinate: usize, value: f64) -> String {
    match posture.kind(coordinate) {
        CoordinateKind::Length => format!("{} mm", fixed(value * 1e3, 3)),
        CoordinateKind::Angle => format!("{} deg", fixed(value.to_degrees(), 3)),
        CoordinateKind::Ratio => fixed(value, 4),
    }
}

/// A generalised force with its unit.
pub(super) fn force(posture: &Posture, coordinate: usize, value: f64) -> String {
    if posture.is_length(coordinate) {
        format!("{} N", fixed(value, 4))
    } else {
        format!("{} N*mm", fixed(value * 1e3, 4))
    }
}

/// Names of the largest parts of a shape: `pip +0.84, dip −0.31`.
pub(super) fn shape(posture: &Posture, shape: &[f64]) -> String {
    let layout = posture.model.layout();
    let scale = |i: usize| if posture.is_length(i) { layout.length_scale } else { 1.0 };
    let mut parts: Vec<(usize, f64)> =
        shape.iter().enumerate().map(|(i, x)| (i, x / scale(i))).collect();
    parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let largest = parts.first().map_or(0.0, |(_, x)| x.abs());
    let named = parts.iter().take(NAMED).filter(|(_, x)| x.abs() > PART * largest);
    let names = named.map(|(i, x)| {
        let part = if largest > 0.0 { x / largest } else { 0.0 };
        format!("{} {part:+.2}", layout.coordinates[*i].name)
    });
    names.collect::<Vec<_>>().join(", ")
}

/// Strands with their length, natural length and tension.
pub(super) fn strands(posture: &Posture, answer: &Answer) -> String {
    if answer.lengths.is_empty() {
        return String::new();
    }
    let layout = posture.model.layout();
    let mut table = Table::new(&["strand", "length", "natural length", "tension"]);
    for (s, strand) in layout.strands.iter().enumerate() {
        table.row(vec![
            strand.name.clone(),
            format!("{:.3} mm", answer.lengths[s] * 1e3),
            match posture.model.mechanism().strands[s].law {
                Law::Tension(_) => "commanded".to_string(),
                Law::Muscle(_) => "muscle".to_string(),
                _ => format!("{:.3} mm", answer.rest[s] * 1e3),
            },
            format!("{} N", fixed(answer.tensions[s], 4)),
        ]);
    }
    table.text()
}

/// Stiffness against small motions, and whether the rest is stable.
pub(super) fn stiffness(posture: &Posture, answer: &Answer) -> String {
    let tangent = &answer.tangent;
    if tangent.directions.is_empty() {
        return "  nothing can move\n".to_string();
    }
    let mut text = String::new();
    let _ = match tangent.stability() {
        Stability::Stable => writeln!(text, "stable: it comes back from every small push"),
        Stability::Neutral => writeln!(
            text,
            "neutral: nothing holds it along {}",
            shape(posture, &tangent.directions[0].shape)
        ),
        Stability::Unstable => writeln!(
            text,
            "not stable: it leaves along {}",
            shape(posture, &tangent.directions[0].shape)
        ),
    };
    let lengths = (0..answer.q.len()).filter(|&i| tangent.linear.free[i] && posture.is_length(i));
    let unit = match lengths.count() {
        0 => "N*mm/rad".to_string(),
        _ => format!(
            "N*mm/rad, lengths in units of {:.4} mm",
            posture.model.layout().length_scale * 1e3
        ),
    };
    let mut table = Table::new(&["direction", "stiffness", "<along"]);
    for (k, direction) in tangent.directions.iter().enumerate() {
        table.row(vec![
            format!("{}", k + 1),
            fixed(direction.stiffness * 1e3, 4),
            shape(posture, &direction.shape),
        ]);
    }
    let _ = write!(text, "stiffness ({unit}), softest first\n{}", table.text());
    let vibrations: Vec<String> =
        answer.frequencies.iter().map(|omega| hertz(omega / TAU)).collect();
    if !vibrations.is_empty() {
        let _ = writeln!(text, "natural frequencies (Hz): {}", vibrations.join(", "));
    }
    text
}

/// A frequency, or `-` where there is no vibration.
fn hertz(value: f64) -> String {
    if value.is_finite() { format!("{value:.3}") } else { "-".to_string() }
}

/// Singular values of the strands and of the points.
pub(super) fn reach(posture: &Posture, answer: &Answer) -> String {
    let mut text = String::new();
    let list = |values: &[f64]| {
        let values: Vec<String> = values.iter().map(|v| format!("{:.4}", v * 1e3)).collect();
        values.join(", ")
    };
    if !answer.excursion.is_empty() {
        let _ = writeln!(
            text,
            "strand Jacobian, singular values (mm/rad): {}",
            list(&answer.excursion)
        );
    }
    for tip in &answer.tips {
        let name = &posture.model.mechanism().frames[tip.frame].name;
        let [x, y, z] = tip.place.map(|x| fixed(x * 1e3, 3));
        let _ = writeln!(text, "{name} at ({x}, {y}, {z}) mm");
        let _ = writeln!(text, "  Jacobian, singular values (mm/rad): {}", list(&tip.reach));
        let directions = tip.compliance.iter().filter(|(c, _)| *c > 1e-9 * tip.compliance[0].0);
        for (compliance, direction) in directions {
            let [x, y, z] = direction.map(|d| fixed(d, 3));
            let mm = compliance * 1e3;
            let _ = writeln!(text, "  gives {mm:.4} mm/N along ({x}, {y}, {z})");
        }
    }
    text
}
