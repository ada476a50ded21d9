//! Curves over quantities that are varied one at a time: a column for each, a row for each kind of
//! curve, one set of names for all.

use crate::canvas::{Canvas, Place, Stroke};
use crate::chart::{
    BETWEEN, Frame, GAP, LEFT, MARGIN, TIME, TITLE, WIDTH, curve, horizontal, title, vertical,
};
use crate::compose::{Line, Panel, axis_over, with_unit};
use crate::font;
use crate::legend;
use crate::palette;
use crate::save::Picture;
use crate::ticks::{Axis, extent};
use crate::unit::{Scale, Unit};

/// Most columns side by side.
const COLUMNS: usize = 4;
/// Height of a panel.
const HEIGHT: f64 = 92.0;
/// Widest panel: fewer columns are not drawn wider.
const WIDEST: f64 = 280.0;
/// The value that the others are held at.
const MARK: Stroke = Stroke { color: [130, 130, 130], width: 0.7, dash: &[2.0, 1.5] };

/// What is varied in a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// Name for the axis, without the unit.
    pub label: String,
    /// What it measures.
    pub unit: Unit,
    /// Its values (SI), ascending.
    pub values: Vec<f64>,
    /// The value that it has while others are varied.
    pub mark: Option<f64>,
}

/// Curves of one kind, over every column.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepRow {
    /// What is drawn, without its unit.
    pub label: String,
    /// What it measures.
    pub unit: Unit,
    /// For each column the curves in it: index of the name, and a number for each value (SI).
    pub cells: Vec<Vec<(usize, Vec<f64>)>>,
}

/// A figure of sweeps.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepPlot {
    /// Title.
    pub title: String,
    /// Names of the curves, in the order of their colours.
    pub names: Vec<String>,
    /// What the marked values are.
    pub mark: String,
    /// Columns from left to right.
    pub columns: Vec<Sweep>,
    /// Rows from top to bottom.
    pub rows: Vec<SweepRow>,
}

impl SweepPlot {
    /// Columns of each band, one band below the other.
    fn bands(&self) -> Vec<std::ops::Range<usize>> {
        let count = self.columns.len();
        let bands = count.div_ceil(COLUMNS).max(1);
        let each = count.div_ceil(bands).max(1);
        (0..bands).map(|band| band * each..((band + 1) * each).min(count)).collect()
    }

    /// Names of the curves, and of what marks the others' values.
    fn legend_names(&self) -> impl Iterator<Item = &str> {
        let is_marked = self.columns.iter().any(|column| column.mark.is_some());
        self.names.iter().map(String::as_str).chain(is_marked.then_some(self.mark.as_str()))
    }

    fn legend_lines(&self) -> usize {
        if self.names.iter().all(String::is_empty) {
            return 0;
        }
        legend::flow(self.legend_names(), self.width() - 2.0 * MARGIN - LEFT).1
    }

    fn names(&self, canvas: &mut dyn Canvas, top: f64) {
        let width = self.width() - 2.0 * MARGIN - LEFT;
        let (places, _) = legend::flow(self.legend_names(), width);
        for ((style, name), (x, line)) in self.legend_names().enumerate().zip(places) {
            let at = [MARGIN + LEFT + x, top + legend::LEADING * (line as f64 + 0.5)];
            let stroke = if style < self.names.len() { palette::stroke(style) } else { MARK };
            let room = width - x - legend::SAMPLE - legend::GAP;
            legend::sample(canvas, &stroke, name, at, room);
        }
    }

    fn panel(
        &self,
        canvas: &mut dyn Canvas,
        row: &SweepRow,
        column: usize,
        frame: &Frame,
        is_first: bool,
        is_last: bool,
    ) {
        let values = row.cells.iter().flatten().flat_map(|(_, values)| values);
        let (scale, axis) = axis_over(extent(values), &row.unit);
        let lines = row.cells.get(column).into_iter().flatten();
        let panel = Panel {
            heading: String::new(),
            label: with_unit(&row.label, &scale),
            axis,
            lines: lines
                .map(|(style, values)| Line { label: String::new(), style: *style, values })
                .collect(),
            scale,
            bands: &[],
        };
        let sweep = &self.columns[column];
        let (across_scale, across) = across(sweep, frame.right - frame.left);
        let x = |value: f64| {
            let fraction = across.fraction(value * across_scale.factor);
            frame.left + fraction * (frame.right - frame.left)
        };
        let y = |value: f64| {
            let fraction = panel.axis.fraction(value * panel.scale.factor);
            frame.bottom - fraction * (frame.bottom - frame.top)
        };
        vertical(canvas, &panel, frame, is_first);
        if let Some(mark) = sweep.mark.filter(|m| (frame.left..=frame.right).contains(&x(*m))) {
            canvas.line(&[[x(mark), frame.top], [x(mark), frame.bottom]], &MARK);
        }
        let label = with_unit(&sweep.label, &across_scale);
        horizontal(canvas, &across, is_last.then_some(label.as_str()), frame);
        for line in &panel.lines {
            let count = line.values.len().min(sweep.values.len());
            let place = |i: usize| [x(sweep.values[i]), y(line.values[i])];
            curve(canvas, line.style, count, frame.right - frame.left, place);
        }
    }
}

/// The horizontal axis of a column.
fn across(sweep: &Sweep, width: f64) -> (Scale, Axis) {
    let range = extent(&sweep.values);
    let size = range.map_or(0.0, |(low, high)| low.abs().max(high.abs()));
    let scale = sweep.unit.scale(size);
    let (low, high) = range.map_or((0.0, 1.0), |(l, h)| (l * scale.factor, h * scale.factor));
    let half = 0.5 * (high - low).max(1e-9 * size * scale.factor).max(1e-300);
    let middle = 0.5 * (low + high);
    let most = (width / 26.0).clamp(2.0, 12.0) as usize;
    (scale.clone(), Axis::new(middle - half, middle + half, most, Unit::degrees(&scale)))
}

impl SweepPlot {
    /// Width of a panel.
    fn panel_width(&self) -> f64 {
        let most = self.most();
        let room = WIDTH - 2.0 * MARGIN - LEFT - 4.0 - BETWEEN * (most - 1.0);
        (room / most).min(WIDEST)
    }

    /// Columns of the widest band.
    fn most(&self) -> f64 {
        self.bands().iter().map(ExactSizeIterator::len).max().unwrap_or(1).max(1) as f64
    }

    /// Width of the figure.
    fn width(&self) -> f64 {
        let most = self.most();
        let panels = 2.0 * MARGIN + LEFT + 4.0 + BETWEEN * (most - 1.0) + most * self.panel_width();
        let title = 2.0 * MARGIN + font::width(&self.title, 10.0, true);
        panels.max(title).min(WIDTH)
    }
}

impl Picture for SweepPlot {
    fn size(&self) -> Place {
        let legend = self.legend_lines() as f64 * legend::LEADING + 6.0;
        let band = self.rows.len() as f64 * (HEIGHT + GAP) - GAP + TIME;
        [self.width(), 2.0 * MARGIN + TITLE + legend + band * self.bands().len() as f64]
    }
    fn title(&self) -> String {
        self.title.clone()
    }
    fn draw(&self, canvas: &mut dyn Canvas) {
        title(canvas, &self.title);
        let mut y = MARGIN + TITLE;
        let lines = self.legend_lines();
        if lines > 0 {
            self.names(canvas, y - 2.0);
        }
        y += lines as f64 * legend::LEADING + 6.0;
        let width = self.panel_width();
        for band in self.bands() {
            for (k, row) in self.rows.iter().enumerate() {
                let is_last = k + 1 == self.rows.len();
                for (place, column) in band.clone().enumerate() {
                    let left = MARGIN + LEFT + place as f64 * (width + BETWEEN);
                    let frame = Frame { left, right: left + width, top: y, bottom: y + HEIGHT };
                    self.panel(canvas, row, column, &frame, place == 0, is_last);
                }
                y += HEIGHT + if is_last { TIME } else { GAP };
            }
        }
    }
}
