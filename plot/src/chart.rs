//! Drawing a sheet of panels: where each panel stands, its axes and its curves.

use crate::canvas::{Anchor, Canvas, Color, GREY, LIGHT, Place, Stroke, TextStyle};
use crate::compose::{Panel, Row, Sheet, compose};
use crate::decimate;
use crate::font;
use crate::legend;
use crate::palette;
use crate::save::Picture;
use crate::ticks::{Axis, drawable, extent};
use crate::timeplot::TimePlot;

/// Width of a figure: a page's text (pt).
pub(crate) const WIDTH: f64 = 540.0;
/// Around everything.
pub(crate) const MARGIN: f64 = 8.0;
/// Height of the title's line.
pub(crate) const TITLE: f64 = 20.0;
/// Vertical axis with ticks and label.
pub(crate) const LEFT: f64 = 43.0;
/// Between panels that share an axis.
pub(crate) const BETWEEN: f64 = 11.0;
/// Heading of a panel.
const HEADING: f64 = 12.0;
/// Labels of the time axis.
pub(crate) const TIME: f64 = 24.0;
/// Between rows.
pub(crate) const GAP: f64 = 9.0;
/// Most samples of a band's end.
const BAND: usize = 600;
/// Size of ticks' labels.
const SMALL: f64 = 6.8;
/// Size of axes' labels.
const NORMAL: f64 = 7.6;

const AXIS: Stroke = Stroke::solid([60, 60, 60], 0.6);
const GRID: Stroke = Stroke::solid(LIGHT, 0.5);

/// A panel's place on paper.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) right: f64,
    pub(crate) top: f64,
    pub(crate) bottom: f64,
}

/// A row's heights.
struct Heights {
    head: f64,
    strip: f64,
    plot: f64,
    foot: f64,
}

impl Heights {
    fn total(&self) -> f64 {
        self.head + self.strip + self.plot + self.foot
    }
}

impl Picture for TimePlot {
    fn size(&self) -> Place {
        let sheet = compose(self);
        let rows: f64 = sheet.rows.iter().map(|row| sheet.heights(row).total()).sum();
        [WIDTH, 2.0 * MARGIN + TITLE + rows]
    }
    fn title(&self) -> String {
        self.title.clone()
    }
    fn draw(&self, canvas: &mut dyn Canvas) {
        compose(self).draw(canvas);
    }
}

/// Writes the title of a figure.
pub(crate) fn title(canvas: &mut dyn Canvas, text: &str) {
    let text = font::fit(text, 10.0, true, WIDTH - 2.0 * MARGIN);
    canvas.text([MARGIN, MARGIN + 9.0], &text, &TextStyle::new(10.0).bold());
}

impl Sheet<'_> {
    fn heights(&self, row: &Row) -> Heights {
        let width = self.frame_width(row);
        let panels = row.panels.iter().flatten();
        let lines = panels.map(|panel| legend::strip(panel, width).1).max().unwrap_or(0);
        Heights {
            head: if row.headed { HEADING } else { 0.0 },
            strip: if self.single { 0.0 } else { lines as f64 * legend::LEADING + 3.0 },
            plot: if self.single { 84.0 } else { 72.0 },
            foot: if row.timed { TIME } else { GAP },
        }
    }

    /// Room for names beside the panels.
    fn beside(&self) -> f64 {
        let panels = self.rows.iter().flat_map(|row| row.panels.iter().flatten());
        if self.single { panels.map(legend::beside_width).fold(0.0, f64::max) } else { 0.0 }
    }

    fn frame_width(&self, row: &Row) -> f64 {
        let n = row.panels.len().max(1) as f64;
        let gutters = if row.shared { LEFT + BETWEEN * (n - 1.0) } else { LEFT * n };
        // The last label of the time axis reaches past the frame by half.
        (WIDTH - 2.0 * MARGIN - 4.0 - self.beside() - gutters) / n
    }

    fn draw(&self, canvas: &mut dyn Canvas) {
        title(canvas, self.title);
        let mut y = MARGIN + TITLE;
        for row in &self.rows {
            let heights = self.heights(row);
            let width = self.frame_width(row);
            let top = y + heights.head + heights.strip;
            let pitch = width + if row.shared { BETWEEN } else { LEFT };
            for (k, panel) in row.panels.iter().enumerate() {
                let left = MARGIN + LEFT + k as f64 * pitch;
                let frame = Frame { left, right: left + width, top, bottom: top + heights.plot };
                let Some(panel) = panel else { continue };
                let leftmost = row.panels[..k].iter().all(Option::is_none);
                if row.headed {
                    let style = TextStyle::new(NORMAL).bold();
                    let heading = font::fit(&panel.heading, NORMAL, true, width);
                    canvas.text([left, y + 8.0], &heading, &style);
                }
                if !self.single {
                    legend::above(canvas, panel, left, width, top - 3.0);
                }
                self.panel(canvas, panel, &frame, !row.shared || leftmost, row.timed);
            }
            y += heights.total();
        }
    }

    fn panel(
        &self,
        canvas: &mut dyn Canvas,
        panel: &Panel,
        frame: &Frame,
        labelled: bool,
        timed: bool,
    ) {
        let time = self.time_axis(frame.right - frame.left);
        let x = |t: f64| frame.left + time.fraction(t) * (frame.right - frame.left);
        let y = |v: f64| frame.bottom - panel.axis.fraction(v) * (frame.bottom - frame.top);
        vertical(canvas, panel, frame, labelled);
        horizontal(canvas, &time, timed.then_some(self.time_label.as_str()), frame);
        for (k, ends) in panel.bands.iter().enumerate() {
            let color = palette::pale(0, 0.82 - 0.2 * k as f64);
            let place = |(t, value): (&f64, &f64)| {
                [x(t * self.time_scale.factor), y(value * panel.scale.factor)]
            };
            band(canvas, color, ends.each_ref().map(|end| self.time.iter().zip(end).map(place)));
        }
        let mut ends = Vec::new();
        for line in &panel.lines {
            let count = line.values.len().min(self.time.len());
            let place = |i: usize| {
                let t = self.time[i] * self.time_scale.factor;
                [x(t), y(line.values[i] * panel.scale.factor)]
            };
            curve(canvas, line.style, count, frame.right - frame.left, place);
            let last = (0..count).rev().map(place).find(|p| drawable(p[1]));
            ends.push(last.map_or(0.5 * (frame.top + frame.bottom), |p| p[1]));
        }
        if self.single && panel.named() {
            legend::beside(canvas, panel, [frame.right, frame.top, frame.bottom], &ends);
        }
    }

    fn time_axis(&self, width: f64) -> Axis {
        let factor = self.time_scale.factor;
        let (low, high) = extent(self.time).map_or((0.0, 1.0), |(l, h)| (l * factor, h * factor));
        let half = 0.5 * high - 0.5 * low;
        // A single instant stands in the middle.
        let (low, high) = if half > 1e-12 * high.abs() {
            (low, high)
        } else {
            (low - 0.5 * low.abs().max(1.0), high + 0.5 * high.abs().max(1.0))
        };
        Axis::new(low, high, (width / 34.0).clamp(2.0, 12.0) as usize, false)
    }
}

/// Fills the room between two curves; what is not finite is left out.
fn band(canvas: &mut dyn Canvas, color: Color, ends: [impl Iterator<Item = Place>; 2]) {
    let [low, high] = ends.map(|end| {
        let all: Vec<Place> = end.filter(|at| drawable(at[1])).collect();
        let last = all.last().copied();
        let mut some: Vec<Place> = all.iter().copied().step_by(all.len() / BAND + 1).collect();
        some.extend(last.filter(|last| some.last() != Some(last)));
        some
    });
    let outline: Vec<Place> = low.into_iter().chain(high.into_iter().rev()).collect();
    canvas.polygon(&outline, color, None);
}

/// A curve through samples that `place` puts on paper.
pub(crate) fn curve(
    canvas: &mut dyn Canvas,
    style: usize,
    count: usize,
    width: f64,
    place: impl Fn(usize) -> Place,
) {
    let stroke = palette::stroke(style);
    let (dots, lines): (Vec<_>, Vec<_>) =
        decimate::lines(count, width, place).into_iter().partition(|points| points.len() == 1);
    canvas.lines(&lines, &stroke);
    for dot in dots.iter().flatten() {
        canvas.disc(*dot, 1.3, stroke.color, None);
    }
}

/// A horizontal axis; without a label it has no numbers either.
pub(crate) fn horizontal(canvas: &mut dyn Canvas, axis: &Axis, label: Option<&str>, frame: &Frame) {
    canvas.line(&[[frame.left, frame.bottom], [frame.right, frame.bottom]], &AXIS);
    for (value, text) in &axis.ticks {
        let x = frame.left + axis.fraction(*value) * (frame.right - frame.left);
        canvas.line(&[[x, frame.bottom], [x, frame.bottom + 2.5]], &AXIS);
        if label.is_some() {
            let style = TextStyle::new(SMALL).anchor(Anchor::Middle);
            canvas.text([x, frame.bottom + 9.5], text, &style);
        }
    }
    if let Some(label) = label {
        let style = TextStyle::new(NORMAL).anchor(Anchor::Middle);
        let middle = 0.5 * (frame.left + frame.right);
        canvas.text([middle, frame.bottom + 18.5], label, &style);
    }
}

/// A vertical axis with its grid and label.
pub(crate) fn vertical(canvas: &mut dyn Canvas, panel: &Panel, frame: &Frame, labelled: bool) {
    let axis = &panel.axis;
    for (value, label) in &axis.ticks {
        let y = frame.bottom - axis.fraction(*value) * (frame.bottom - frame.top);
        let darker = Stroke::solid([190, 190, 190], 0.5);
        let stroke = if *value == 0.0 { &darker } else { &GRID };
        canvas.line(&[[frame.left, y], [frame.right, y]], stroke);
        if labelled {
            canvas.line(&[[frame.left - 2.5, y], [frame.left, y]], &AXIS);
            let style = TextStyle::new(SMALL).anchor(Anchor::End);
            canvas.text([frame.left - 4.0, y + 0.5 * font::CAP * SMALL], label, &style);
        }
    }
    canvas.line(&[[frame.left, frame.top], [frame.left, frame.bottom]], &AXIS);
    if labelled {
        for (k, text) in wrap(&panel.label, frame.bottom - frame.top + 6.0).iter().rev().enumerate()
        {
            let x = frame.left - LEFT + 14.5 - 8.5 * k as f64;
            let style = TextStyle::new(NORMAL).anchor(Anchor::Middle).upward().color(GREY);
            canvas.text([x, 0.5 * (frame.top + frame.bottom)], text, &style);
        }
    }
}

/// A label in one line, or in two where it is longer than `room`.
fn wrap(text: &str, room: f64) -> Vec<String> {
    if font::width(text, NORMAL, false) <= room {
        return vec![text.to_string()];
    }
    let blanks: Vec<usize> = text.match_indices(' ').map(|(at, _)| at).collect();
    let widest = |at: &usize| {
        let (first, second) = text.split_at(*at);
        font::width(first, NORMAL, false).max(font::width(second.trim_start(), NORMAL, false))
    };
    match blanks.into_iter().min_by(|a, b| widest(a).total_cmp(&widest(b))) {
        Some(at) => {
            [&text[..at], &text[at + 1..]].map(|part| font::fit(part, NORMAL, false, room)).to_vec()
        }
        None => vec![font::fit(text, NORMAL, false, room)],
    }
}
