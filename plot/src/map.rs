//! Quantities over two variables: panels side by side, bands of colour between round levels.

use crate::canvas::{Anchor, Canvas, Color, GREY, Place, Stroke, TextStyle};
use crate::chart::{BETWEEN, Frame, GAP, LEFT, MARGIN, TIME, TITLE, WIDTH, horizontal, title};
use crate::compose::with_unit;
use crate::font;
use crate::save::Picture;
use crate::ticks::{Axis, drawable, extent};
use crate::unit::{Scale, Unit};
use std::collections::BTreeMap;

/// Most columns side by side.
const COLUMNS: usize = 4;
/// Height of a panel.
const HEIGHT: f64 = 104.0;
/// Widest panel.
const WIDEST: f64 = 150.0;
/// Name of a panel.
const HEADING: f64 = 12.0;
/// Room of the scale beside a row.
const BAR: f64 = 56.0;
/// Size of small text.
const SMALL: f64 = 6.8;
/// Most levels of a scale.
const LEVELS: usize = 18;
/// Numbers of a scale that fit beside it.
const CLOSE: usize = 11;
/// Colours at the two ends of a scale that goes through zero.
const ENDS: [Color; 2] = [[0, 98, 160], [200, 82, 0]];

const EDGE: Stroke = Stroke::solid([60, 60, 60], 0.6);
const ZERO: Stroke = Stroke::solid([40, 40, 40], 0.7);

/// One of the two variables.
#[derive(Clone, Debug, PartialEq)]
pub struct MapAxis {
    /// Name, without the unit.
    pub label: String,
    /// What it measures.
    pub unit: Unit,
    /// Its values (SI), ascending.
    pub values: Vec<f64>,
}

/// Panels of one kind, side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct MapRow {
    /// What is drawn, without its unit.
    pub label: String,
    /// What it measures.
    pub unit: Unit,
    /// For each column a number (SI) for every value of the first variable and, within it, every one
    /// of the second; what is not finite is left white.
    pub cells: Vec<Vec<f64>>,
}

/// A figure of maps.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPlot {
    /// Title.
    pub title: String,
    /// The variable to the right.
    pub across: MapAxis,
    /// The variable upwards.
    pub up: MapAxis,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Rows from top to bottom.
    pub rows: Vec<MapRow>,
}

/// Colours of a row.
struct Bands {
    scale: Scale,
    axis: Axis,
}

impl Bands {
    fn new(row: &MapRow) -> Bands {
        let range = extent(row.cells.iter().flatten());
        let size = range.map_or(0.0, |(low, high)| low.abs().max(high.abs()));
        let scale = row.unit.scale(size);
        let (low, high) = range.unwrap_or((0.0, 1.0));
        let (low, high) = (low * scale.factor, high * scale.factor);
        let room = (high - low).max(1e-9 * size * scale.factor).max(1e-300);
        let axis = Axis::new(low, low + room, LEVELS, false);
        // Levels around the whole range.
        let step = match axis.ticks[..] {
            [(a, _), (b, _), ..] => b - a,
            _ => room,
        };
        let (low, high) = ((low / step).floor() * step, ((low + room) / step).ceil() * step);
        Bands { scale, axis: Axis::new(low, high, ((high - low) / step).round() as usize, false) }
    }

    fn step(&self) -> f64 {
        match self.axis.ticks[..] {
            [(a, _), (b, _), ..] => b - a,
            _ => self.axis.high - self.axis.low,
        }
    }

    /// Number of the band of a drawn value.
    fn band(&self, value: f64) -> i64 {
        ((value - self.axis.low) / self.step()).floor() as i64
    }

    /// Colour of a band: by its middle, against the largest on either side of zero.
    fn color(&self, band: i64) -> Color {
        let middle = self.axis.low + (band as f64 + 0.5) * self.step();
        let largest = self.axis.low.abs().max(self.axis.high.abs());
        let part = (middle / largest).clamp(-1.0, 1.0);
        let end = ENDS[usize::from(part > 0.0)];
        end.map(|c| (255.0 + part.abs() * (f64::from(c) - 255.0)).round() as u8)
    }
}

impl MapPlot {
    fn bands(&self) -> Vec<std::ops::Range<usize>> {
        let count = self.names.len();
        let bands = count.div_ceil(COLUMNS).max(1);
        let each = count.div_ceil(bands).max(1);
        (0..bands).map(|band| band * each..((band + 1) * each).min(count)).collect()
    }

    fn most(&self) -> f64 {
        self.bands().iter().map(ExactSizeIterator::len).max().unwrap_or(1).max(1) as f64
    }

    fn panel_width(&self) -> f64 {
        let most = self.most();
        ((WIDTH - 2.0 * MARGIN - LEFT - BAR - BETWEEN * (most - 1.0)) / most).min(WIDEST)
    }

    /// Corners of the cell after value (i, j) on paper, with their drawn values.
    fn corners(
        &self,
        cells: &[f64],
        frame: &Frame,
        factor: f64,
        i: usize,
        j: usize,
    ) -> [Corner; 4] {
        let part = |values: &[f64], i: usize| {
            let (first, last) = (values[0], values[values.len() - 1]);
            (values[i] - first) / (last - first)
        };
        [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
            let x = frame.left + part(&self.across.values, i) * (frame.right - frame.left);
            let y = frame.bottom - part(&self.up.values, j) * (frame.bottom - frame.top);
            ([x, y], cells[i * self.up.values.len() + j] * factor)
        })
    }

    /// Whether there is anything between values.
    fn has_cells(&self, cells: &[f64]) -> bool {
        let (n, m) = (self.across.values.len(), self.up.values.len());
        n > 1 && m > 1 && cells.len() >= n * m
    }

    fn panel(&self, canvas: &mut dyn Canvas, cells: &[f64], bands: &Bands, frame: &Frame) {
        if !self.has_cells(cells) {
            return;
        }
        let mut patches = Patches::new();
        for j in 0..self.up.values.len() - 1 {
            // Neighbours of one band are one patch.
            let mut run: Option<(i64, [Corner; 4])> = None;
            for i in 0..self.across.values.len() - 1 {
                let corners = self.corners(cells, frame, bands.scale.factor, i, j);
                let is_drawable = corners.iter().all(|(_, value)| drawable(*value));
                let numbers = corners.map(|(_, value)| bands.band(value));
                let is_even = is_drawable && numbers.iter().all(|number| *number == numbers[0]);
                match &mut run {
                    Some((band, patch)) if is_even && *band == numbers[0] => {
                        (patch[1], patch[2]) = (corners[1], corners[2]);
                        continue;
                    }
                    _ => even(&mut patches, run.take()),
                }
                if is_even {
                    run = Some((numbers[0], corners));
                } else if is_drawable {
                    uneven(&mut patches, bands, corners);
                }
            }
            even(&mut patches, run);
        }
        for (band, polygons) in &patches {
            let color = bands.color(*band);
            // A thin outline closes the gaps between neighbours.
            canvas.polygons(polygons, color, Some(&Stroke::solid(color, 0.3)));
        }
        canvas.lines(&self.zero(cells, frame), &ZERO);
    }

    /// The line on which the quantity is zero, by marching squares.
    fn zero(&self, cells: &[f64], frame: &Frame) -> Vec<Vec<Place>> {
        let mut lines = Vec::new();
        if !self.has_cells(cells) {
            return lines;
        }
        for i in 0..self.across.values.len() - 1 {
            for j in 0..self.up.values.len() - 1 {
                let corners = self.corners(cells, frame, 1.0, i, j);
                if corners.iter().any(|(_, value)| !drawable(*value)) {
                    continue;
                }
                let mut crossed = Vec::new();
                for k in 0..4 {
                    let ((p, a), (q, b)) = (corners[k], corners[(k + 1) % 4]);
                    if (a < 0.0) != (b < 0.0) {
                        let share = a / (a - b);
                        crossed.push([0, 1].map(|c| p[c] + share * (q[c] - p[c])));
                    }
                }
                lines.extend(crossed.chunks_exact(2).map(<[Place]>::to_vec));
            }
        }
        lines
    }

    /// The axis to the right.
    fn axis(axis: &MapAxis, room: f64) -> (Scale, Axis) {
        let range = extent(&axis.values);
        let size = range.map_or(0.0, |(low, high)| low.abs().max(high.abs()));
        let scale = axis.unit.scale(size);
        let (low, high) = range.map_or((0.0, 1.0), |(l, h)| (l * scale.factor, h * scale.factor));
        let high = if high > low { high } else { low + 1.0 };
        let most = (room / 26.0).clamp(2.0, 12.0) as usize;
        let degrees = Unit::degrees(&scale);
        (scale, Axis::new(low, high, most, degrees))
    }

    fn vertical(&self, canvas: &mut dyn Canvas, frame: &Frame, is_labelled: bool) {
        let (scale, axis) = MapPlot::axis(&self.up, frame.bottom - frame.top);
        for (value, label) in &axis.ticks {
            let y = frame.bottom - axis.fraction(*value) * (frame.bottom - frame.top);
            canvas.line(&[[frame.left - 2.5, y], [frame.left, y]], &EDGE);
            if is_labelled {
                let style = TextStyle::new(SMALL).anchor(Anchor::End);
                canvas.text([frame.left - 4.0, y + 0.5 * font::CAP * SMALL], label, &style);
            }
        }
        if is_labelled {
            let style = TextStyle::new(7.6).anchor(Anchor::Middle).upward();
            let middle = 0.5 * (frame.top + frame.bottom);
            let label = with_unit(&self.up.label, &scale);
            canvas.text([frame.left - LEFT + 14.5, middle], &label, &style);
        }
    }

    /// The colours of a row and their values.
    fn bar(&self, canvas: &mut dyn Canvas, row: &MapRow, bands: &Bands, frame: &Frame) {
        let (left, right) = (frame.right + 10.0, frame.right + 17.0);
        let y = |value: f64| frame.bottom - bands.axis.fraction(value) * (frame.bottom - frame.top);
        let step = bands.step();
        let count = ((bands.axis.high - bands.axis.low) / step).round() as i64;
        for band in 0..count {
            let low = bands.axis.low + band as f64 * step;
            let (top, bottom) = (y(low + step), y(low));
            let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
            canvas.polygon(&corners, bands.color(band), None);
        }
        let rim = [
            [left, frame.top],
            [right, frame.top],
            [right, frame.bottom],
            [left, frame.bottom],
            [left, frame.top],
        ];
        canvas.line(&rim, &EDGE);
        // Every second number where they would meet, zero among them.
        let zero = bands.axis.ticks.iter().position(|(value, _)| *value == 0.0).unwrap_or(0);
        let each = if bands.axis.ticks.len() > CLOSE { 2 } else { 1 };
        for (k, (value, label)) in bands.axis.ticks.iter().enumerate() {
            if k % each == zero % each {
                let at = [right + 3.0, y(*value) + 0.5 * font::CAP * SMALL];
                canvas.text(at, label, &TextStyle::new(SMALL));
            }
        }
        let label = with_unit(&row.label, &bands.scale);
        let label = font::fit(&label, 7.6, false, HEIGHT + HEADING);
        let style = TextStyle::new(7.6).anchor(Anchor::Middle).upward().color(GREY);
        canvas.text([frame.right + BAR - 6.0, 0.5 * (frame.top + frame.bottom)], &label, &style);
    }
}

/// A corner of a cell on paper and its value.
type Corner = (Place, f64);

/// Polygons of each band.
type Patches = BTreeMap<i64, Vec<Vec<Place>>>;

/// Adds a patch of one band.
fn even(patches: &mut Patches, run: Option<(i64, [Corner; 4])>) {
    if let Some((band, corners)) = run {
        patches.entry(band).or_default().push(corners.map(|(place, _)| place).to_vec());
    }
}

/// Adds a cell of several bands, cut at the levels.
fn uneven(patches: &mut Patches, bands: &Bands, corners: [Corner; 4]) {
    let numbers = corners.map(|(_, value)| bands.band(value));
    let (low, high) = (numbers.iter().min(), numbers.iter().max());
    let (Some(&low), Some(&high)) = (low, high) else { return };
    for band in low..=high {
        let level = bands.axis.low + band as f64 * bands.step();
        let above = cut(&corners, level, 1.0);
        let between = cut(&above, level + bands.step(), -1.0);
        if between.len() > 2 {
            let points = between.iter().map(|(place, _)| *place).collect();
            patches.entry(band).or_default().push(points);
        }
    }
}

/// The part of a polygon on one side of a level.
fn cut(corners: &[Corner], level: f64, side: f64) -> Vec<Corner> {
    let mut kept = Vec::new();
    for (k, (p, a)) in corners.iter().enumerate() {
        let (q, b) = corners[(k + 1) % corners.len()];
        let (over, next) = (side * (a - level), side * (b - level));
        if over >= 0.0 {
            kept.push((*p, *a));
        }
        if (over >= 0.0) != (next >= 0.0) {
            let share = over / (over - next);
            kept.push(([0, 1].map(|c| p[c] + share * (q[c] - p[c])), level));
        }
    }
    kept
}

impl Picture for MapPlot {
    fn size(&self) -> Place {
        let most = self.most();
        let panels = LEFT + most * self.panel_width() + BETWEEN * (most - 1.0) + BAR;
        let text = font::width(&self.title, 10.0, true);
        let row = HEADING + HEIGHT + GAP;
        let height = self.rows.len() as f64 * row - GAP + TIME;
        let width = 2.0 * MARGIN + panels.max(text).min(WIDTH - 2.0 * MARGIN);
        [width, 2.0 * MARGIN + TITLE + height * self.bands().len() as f64]
    }
    fn title(&self) -> String {
        self.title.clone()
    }
    fn draw(&self, canvas: &mut dyn Canvas) {
        title(canvas, &self.title);
        let mut y = MARGIN + TITLE;
        let width = self.panel_width();
        let colors: Vec<Bands> = self.rows.iter().map(Bands::new).collect();
        for band in self.bands() {
            for (k, (row, bands)) in self.rows.iter().zip(&colors).enumerate() {
                let is_last = k + 1 == self.rows.len();
                let mut end = None;
                for (place, column) in band.clone().enumerate() {
                    let left = MARGIN + LEFT + place as f64 * (width + BETWEEN);
                    let top = y + HEADING;
                    let frame = Frame { left, right: left + width, top, bottom: top + HEIGHT };
                    let heading = font::fit(&self.names[column], 7.6, false, width);
                    canvas.text([left, top - 3.5], &heading, &TextStyle::new(7.6).color(GREY));
                    if let Some(cells) = row.cells.get(column) {
                        self.panel(canvas, cells, bands, &frame);
                    }
                    canvas.line(&[[left, top], [left, frame.bottom]], &EDGE);
                    self.vertical(canvas, &frame, place == 0);
                    let (scale, across) = MapPlot::axis(&self.across, width);
                    let label = with_unit(&self.across.label, &scale);
                    horizontal(canvas, &across, is_last.then_some(label.as_str()), &frame);
                    end = Some(frame);
                }
                if let Some(frame) = end {
                    self.bar(canvas, row, bands, &frame);
                }
                y += HEADING + HEIGHT + if is_last { TIME } else { GAP };
            }
        }
    }
}
