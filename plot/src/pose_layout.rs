//! Drawing poses side by side at one scale, with a length to compare with, axes and names.

use crate::canvas::{Anchor, Canvas, Color, GREY, Place, Stroke, TextStyle};
use crate::chart::{MARGIN, TITLE, WIDTH, title};
use crate::font;
use crate::palette;
use crate::pose::{Pose, PoseFigure, Spot, instant};
use crate::pose_body::{draw_force, draw_pose};
use crate::save::Picture;
use crate::unit::Unit;
use crate::view::{View, dot};

/// Greatest height of all poses together (pt).
const HEIGHT: f64 = 350.0;
/// Part of the largest scale that is large enough.
const FAIR: f64 = 0.8;
/// Text under a pose.
const CAPTION: f64 = 14.0;
/// Between poses.
const GAP: f64 = 10.0;
/// Room for axes and length in the last line.
const KEY: f64 = 130.0;
/// Height of a line of names.
const LEADING: f64 = 9.5;
const SMALL: f64 = 6.8;

/// Where everything stands.
struct Layout {
    view: View,
    /// Left end and upper end of the picture on the projected plane (m).
    corner: [f64; 2],
    /// Points of paper per metre.
    scale: f64,
    /// A pose's room (pt).
    cell: Place,
    columns: usize,
    rows: usize,
    /// Colour of each strand.
    colors: Vec<Color>,
    /// Names with their colours.
    names: Vec<(String, Color)>,
    /// Lines that the names take.
    lines: usize,
    /// Metres on paper per newton of a force.
    force_scale: f64,
}

impl Layout {
    fn new(figure: &PoseFigure) -> Layout {
        let view = View::choose(figure);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut include = |spot: Spot, radius: f64| {
            let place = view.project(spot);
            for k in 0..2 {
                low[k] = low[k].min(place[k] - radius);
                high[k] = high[k].max(place[k] + radius);
            }
            (high[0] - low[0]).max(high[1] - low[1])
        };
        let mut largest = f64::NEG_INFINITY;
        for (spot, radius) in figure.poses.iter().flat_map(Pose::spots) {
            largest = include(spot, radius);
        }
        let force_scale = force_scale(figure, largest);
        for (from, force) in figure.poses.iter().flat_map(|pose| &pose.forces) {
            largest = include([0, 1, 2].map(|i| from[i] + force_scale * force[i]), 0.0);
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        // A lone point is shown with some space around it.
        let largest = if largest > 1e-9 { largest } else { 0.1 };
        // A line is given some room, and so is the width of strokes.
        let size = [0, 1].map(|k| (high[k] - low[k]).max(0.15 * largest) + 0.04 * largest);
        let corner = [0, 1].map(|k| {
            let middle = 0.5 * (low[k] + high[k]);
            if k == 0 { middle - 0.5 * size[0] } else { middle + 0.5 * size[1] }
        });
        let count = figure.poses.len().max(1);
        let choices: Vec<(f64, usize)> = (1..=count)
            .filter(|columns| count.is_multiple_of(*columns))
            .map(|columns| {
                let rows = count.div_ceil(columns) as f64;
                let across = (WIDTH - 2.0 * MARGIN + GAP) / columns as f64 - GAP;
                let down = (HEIGHT + GAP) / rows - GAP - CAPTION;
                ((across / size[0]).min(down / size[1]), columns)
            })
            .collect();
        // Fewer lines of poses are worth a somewhat smaller scale.
        let largest_scale = choices.iter().map(|(scale, _)| *scale).fold(0.0, f64::max);
        let fair = choices.iter().rev().find(|(scale, _)| *scale >= FAIR * largest_scale);
        let (scale, columns) = fair.copied().unwrap_or((1.0, 1));
        let (colors, names) = colors(&figure.strands);
        let mut layout = Layout {
            view,
            corner,
            scale,
            cell: size.map(|s| s * scale),
            columns,
            rows: count.div_ceil(columns),
            colors,
            names,
            lines: 0,
            force_scale,
        };
        layout.lines = layout.places().last().map_or(0, |(_, line)| line + 1);
        layout
    }

    /// x and line of each name.
    fn places(&self) -> Vec<(f64, usize)> {
        let (mut x, mut line) = (0.0, 0);
        let mut places = Vec::new();
        for (name, _) in &self.names {
            let needed = 14.0 + font::width(name, SMALL, false);
            if x > 0.0 && x + needed > WIDTH - 2.0 * MARGIN - KEY {
                (x, line) = (0.0, line + 1);
            }
            places.push((x, line));
            x += needed + 10.0;
        }
        places
    }

    /// Upper left corner of the room of pose `k`.
    fn origin(&self, k: usize) -> Place {
        let (column, row) = ((k % self.columns) as f64, (k / self.columns) as f64);
        let used = self.columns as f64 * (self.cell[0] + GAP) - GAP;
        let left = MARGIN + 0.5 * (WIDTH - 2.0 * MARGIN - used);
        let top = MARGIN + TITLE;
        [left + column * (self.cell[0] + GAP), top + row * (self.cell[1] + CAPTION + GAP)]
    }

    fn foot(&self) -> f64 {
        MARGIN + TITLE + self.rows as f64 * (self.cell[1] + CAPTION + GAP)
    }

    fn place(&self, origin: Place, spot: Spot) -> Place {
        let [x, y] = self.view.project(spot);
        [
            origin[0] + (x - self.corner[0]) * self.scale,
            origin[1] + (self.corner[1] - y) * self.scale,
        ]
    }
}

impl Picture for PoseFigure {
    fn size(&self) -> Place {
        let layout = Layout::new(self);
        [WIDTH, layout.foot() + (layout.lines as f64 * LEADING).max(30.0) + MARGIN]
    }
    fn title(&self) -> String {
        self.title.clone()
    }
    fn draw(&self, canvas: &mut dyn Canvas) {
        let layout = Layout::new(self);
        title(canvas, &self.title);
        let last = self.poses.last().map_or(0.0, |pose| pose.time);
        for (k, pose) in self.poses.iter().enumerate() {
            let origin = layout.origin(k);
            let place = |spot: Spot| layout.place(origin, spot);
            draw_pose(canvas, pose, &place, layout.scale, layout.view.near, &layout.colors);
            for (from, force) in &pose.forces {
                let to = [0, 1, 2].map(|i| from[i] + layout.force_scale * force[i]);
                draw_force(canvas, place(*from), place(to));
            }
            let at = [origin[0] + 0.5 * layout.cell[0], origin[1] + layout.cell[1] + 9.0];
            let style = TextStyle::new(7.6).anchor(Anchor::Middle);
            let caption = pose.caption.clone().unwrap_or_else(|| instant(pose.time, last));
            canvas.text(at, &caption, &style);
        }
        key(canvas, &layout);
    }
}

/// Length of the largest force against the size of the poses.
const FORCE: f64 = 0.2;

/// Metres per newton, so that the largest force is seen well.
fn force_scale(figure: &PoseFigure, size: f64) -> f64 {
    let forces = figure.poses.iter().flat_map(|pose| &pose.forces);
    let largest = forces.map(|(_, f)| dot(*f, *f).sqrt()).fold(0.0, f64::max);
    if largest > 0.0 && size > 0.0 { FORCE * size / largest } else { 0.0 }
}

/// Axes, a length to compare with, and the strands' names.
fn key(canvas: &mut dyn Canvas, layout: &Layout) {
    let top = layout.foot();
    let origin = [MARGIN + 14.0, top + 18.0];
    let axes = [([1.0, 0.0, 0.0], "x"), ([0.0, 1.0, 0.0], "y"), ([0.0, 0.0, 1.0], "z")];
    for (axis, name) in axes {
        let [x, y] = layout.view.project(axis);
        if x.hypot(y) < 0.1 {
            continue;
        }
        let end = |length: f64| [origin[0] + length * x, origin[1] - length * y];
        canvas.line(&[origin, end(13.0)], &Stroke::solid(GREY, 0.7));
        let at = end(13.0 + 4.5 / x.hypot(y));
        let style = TextStyle::new(SMALL).anchor(Anchor::Middle).color(GREY);
        canvas.text([at[0], at[1] + 2.3], name, &style);
    }
    let most = 60.0 / layout.scale;
    let decade = 10f64.powf(most.log10().floor());
    let length = [5.0, 2.0, 1.0].map(|f| f * decade).into_iter().find(|l| *l <= most);
    let length = length.unwrap_or(decade);
    let scale = Unit::Prefixed("m").scale(length);
    let (left, y) = (MARGIN + 42.0, top + 12.0);
    let right = left + length * layout.scale;
    let stroke = Stroke::solid([60, 60, 60], 0.8);
    canvas.line(&[[left, y - 2.0], [left, y + 2.0]], &stroke);
    canvas.line(&[[left, y], [right, y]], &stroke);
    canvas.line(&[[right, y - 2.0], [right, y + 2.0]], &stroke);
    let text = format!("{:.0} {}", length * scale.factor, scale.unit);
    let style = TextStyle::new(SMALL).anchor(Anchor::Middle);
    canvas.text([0.5 * (left + right), y + 9.5], &text, &style);
    for ((name, color), (x, line)) in layout.names.iter().zip(layout.places()) {
        let (x, y) = (MARGIN + KEY + x, top + 12.0 + line as f64 * LEADING);
        canvas.line(&[[x, y], [x + 11.0, y]], &Stroke::solid(*color, 1.4));
        let at = [x + 14.0, y + 0.5 * font::CAP * SMALL];
        canvas.text(at, name, &TextStyle::new(SMALL).color(GREY));
    }
}

/// Colours of strands and their meaning: each its own while there are few, else one per group.
fn colors(strands: &[String]) -> (Vec<Color>, Vec<(String, Color)>) {
    let key = |name: &String| {
        if strands.len() <= palette::MOST {
            return name.clone();
        }
        name.split_once('.').map_or("strands", |(first, _)| first).to_string()
    };
    let mut names: Vec<(String, Color)> = Vec::new();
    let mut colors = Vec::new();
    for strand in strands {
        let name = key(strand);
        let found = names.iter().find(|(other, _)| *other == name).map(|(_, color)| *color);
        let color = found.unwrap_or_else(|| {
            let color = palette::color(names.len());
            names.push((name, color));
            color
        });
        colors.push(color);
    }
    (colors, names)
}
