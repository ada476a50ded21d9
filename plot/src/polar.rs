//! A figure of sizes over directions in a plane, with the thing that they belong to in the middle.

use crate::canvas::{Anchor, BLACK, Canvas, GREY, LIGHT, Place, Stroke, TextStyle};
use crate::chart::{MARGIN, TITLE};
use crate::font;
use crate::legend;
use crate::palette;
use crate::save::Picture;
use crate::ticks::{Axis, drawable};
use crate::unit::{Scale, Unit};
use std::f64::consts::{PI, TAU};

/// Width of the figure (pt).
const WIDTH: f64 = 340.0;
/// Radius of the outermost circle.
const RADIUS: f64 = 122.0;
/// Above and below the circle: names of directions.
const RIM: f64 = 15.0;
/// Height of a line of the notes.
const NOTE: f64 = 9.6;
/// Size of small text.
const SMALL: f64 = 6.8;
/// Share of the outermost circle that the skeleton may fill.
const REACH: f64 = 0.86;
/// A curve that goes farther than this many times its upper quartile is cut off.
const CUT: f64 = 4.0;

const GRID: Stroke = Stroke::solid(LIGHT, 0.5);
const RIM_LINE: Stroke = Stroke::solid([150, 150, 150], 0.6);
const BONE: Stroke = Stroke::solid([196, 196, 196], 5.0);
const BONE_EDGE: Stroke = Stroke::solid([150, 150, 150], 0.6);

/// A closed curve around the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarCurve {
    /// Name; empty where there is one curve only.
    pub name: String,
    /// Directions (rad, against the clock from the first axis), ascending within one turn.
    pub angle: Vec<f64>,
    /// Size in each direction (SI); what is not finite is drawn as a gap.
    pub size: Vec<f64>,
}

/// A figure over directions.
#[derive(Clone, Debug, PartialEq)]
pub struct PolarPlot {
    /// Title.
    pub title: String,
    /// What the size is, without its unit.
    pub label: String,
    /// What it measures.
    pub unit: Unit,
    /// Names of the directions at 0 and at a right angle, as `x` and `y`.
    pub axes: [String; 2],
    /// The curves.
    pub curves: Vec<PolarCurve>,
    /// Lines of a skeleton in the plane (m), as seen from the middle.
    pub skeleton: Vec<Vec<Place>>,
    /// Lines of text below.
    pub notes: Vec<String>,
}

/// Sizes on paper.
struct Radial {
    scale: Scale,
    axis: Axis,
    /// Whether curves go beyond the outermost circle.
    is_cut: bool,
}

impl PolarPlot {
    fn radial(&self) -> Radial {
        let mut sizes: Vec<f64> = self.curves.iter().flat_map(|c| &c.size).copied().collect();
        sizes.retain(|size| drawable(*size) && *size > 0.0);
        sizes.sort_by(f64::total_cmp);
        let largest = sizes.last().copied().unwrap_or(1.0);
        let usual = sizes.get(sizes.len() * 3 / 4).copied().unwrap_or(largest);
        let is_cut = largest > CUT * usual;
        let most = if is_cut { 2.0 * usual } else { largest };
        let scale = self.unit.scale(most);
        let most = most * scale.factor;
        let mut axis = Axis::new(0.0, most, 5, false);
        // The outermost circle is a round one.
        if let [.., (before, _), (last, _)] = axis.ticks[..]
            && last < most * (1.0 - 1e-9)
        {
            axis = Axis::new(0.0, last + (last - before), 5, false);
        }
        let end = axis.ticks.last().map_or(most, |(value, _)| *value);
        if end > 0.0 {
            axis.high = end.max(most);
        }
        Radial { scale, axis, is_cut }
    }

    fn middle(&self) -> Place {
        [0.5 * WIDTH, MARGIN + TITLE + RIM + RADIUS]
    }

    fn notes(&self, radial: &Radial) -> Vec<String> {
        let mut notes = self.notes.clone();
        if radial.is_cut {
            let end = radial.axis.high;
            notes.push(format!("cut off at {end} {}", radial.scale.unit));
        }
        notes
    }

    /// Whether a legend is needed.
    fn named(&self) -> bool {
        self.curves.iter().any(|curve| !curve.name.is_empty())
    }

    fn circles(&self, canvas: &mut dyn Canvas, radial: &Radial) {
        for (value, _) in &radial.axis.ticks {
            let radius = RADIUS * radial.axis.fraction(*value);
            if radius > 0.0 {
                let is_rim = radius > RADIUS * 0.999;
                canvas.line(&circle(self.middle(), radius), if is_rim { &RIM_LINE } else { &GRID });
            }
        }
        for ray in 0..12 {
            let angle = f64::from(ray) * PI / 6.0;
            canvas.line(&[self.middle(), self.place(angle, RADIUS)], &GRID);
        }
    }

    fn place(&self, angle: f64, radius: f64) -> Place {
        let ([x, y], (s, c)) = (self.middle(), angle.sin_cos());
        [x + radius * c, y - radius * s]
    }

    fn directions(&self, canvas: &mut dyn Canvas) {
        for ray in 0..12 {
            let angle = f64::from(ray) * PI / 6.0;
            let [x, y] = self.place(angle, RADIUS + 5.0);
            let anchor = match ray {
                3 | 9 => Anchor::Middle,
                4..=8 => Anchor::End,
                _ => Anchor::Start,
            };
            let drop = 0.5 * font::CAP * SMALL * (1.0 - angle.sin());
            let quarter = ray / 3;
            let name = match ray % 3 {
                0 => {
                    let sign = if quarter < 2 { '+' } else { '−' };
                    format!("{}°  {sign}{}", ray * 30, self.axes[quarter as usize % 2])
                }
                _ => format!("{}°", ray * 30),
            };
            let style = TextStyle::new(SMALL).anchor(anchor);
            let style = if ray % 3 == 0 { style } else { style.color(GREY) };
            canvas.text([x, y + drop], &name, &style);
        }
    }

    /// Numbers of the circles, along the ray with the most room.
    fn numbers(&self, canvas: &mut dyn Canvas, radial: &Radial) {
        let reach = |angle: f64| {
            let near = |curve: &PolarCurve| {
                let apart = |a: f64| ((a - angle + PI).rem_euclid(TAU) - PI).abs();
                let sizes = curve.angle.iter().zip(&curve.size);
                let close = sizes.filter(|(a, _)| apart(**a) < PI / 12.0);
                close.map(|(_, size)| *size).filter(|s| drawable(*s)).fold(0.0, f64::max)
            };
            self.curves.iter().map(near).fold(0.0, f64::max)
        };
        let rays = (0..12).map(|k| PI / 12.0 + f64::from(k) * PI / 6.0);
        let quiet = rays.min_by(|a, b| reach(*a).total_cmp(&reach(*b))).unwrap_or(PI / 12.0);
        let count = radial.axis.ticks.len();
        for (k, (value, text)) in radial.axis.ticks.iter().enumerate().skip(1) {
            let at = self.place(quiet, RADIUS * radial.axis.fraction(*value));
            let text = match k + 1 == count {
                true => format!("{text} {}", radial.scale.unit),
                false => text.clone(),
            };
            let half = 0.5 * font::width(&text, SMALL, false) + 1.0;
            let (x, y) = (at[0], at[1]);
            let box_of = [
                [x - half, y - 4.0],
                [x + half, y - 4.0],
                [x + half, y + 4.0],
                [x - half, y + 4.0],
            ];
            canvas.polygon(&box_of, [255, 255, 255], None);
            let style = TextStyle::new(SMALL).anchor(Anchor::Middle).color(GREY);
            canvas.text([x, y + 0.5 * font::CAP * SMALL], &text, &style);
        }
    }

    fn skeleton(&self, canvas: &mut dyn Canvas) {
        let spots = self.skeleton.iter().flatten();
        let farthest = spots.map(|[x, y]| x.hypot(*y)).filter(|r| drawable(*r)).fold(0.0, f64::max);
        if farthest == 0.0 {
            return;
        }
        let ([cx, cy], factor) = (self.middle(), REACH * RADIUS / farthest);
        for line in &self.skeleton {
            let points: Vec<Place> =
                line.iter().map(|[x, y]| [cx + factor * x, cy - factor * y]).collect();
            if points.iter().flatten().any(|x| !drawable(*x)) {
                continue;
            }
            canvas.line(&points, &BONE);
            for point in &points {
                canvas.disc(*point, 3.4, [255, 255, 255], Some(&BONE_EDGE));
            }
        }
    }

    /// Pieces of a curve on paper, cut at the outermost circle; whether it is closed.
    fn pieces(&self, curve: &PolarCurve, radial: &Radial) -> (Vec<Vec<Place>>, bool) {
        let count = curve.angle.len().min(curve.size.len());
        let mut pieces: Vec<Vec<Place>> = vec![Vec::new()];
        for (angle, size) in curve.angle.iter().zip(&curve.size) {
            if drawable(*size) {
                let share = radial.axis.fraction(size * radial.scale.factor).clamp(0.0, 1.0);
                let at = self.place(*angle, RADIUS * share);
                if let Some(piece) = pieces.last_mut() {
                    piece.push(at);
                }
            } else if pieces.last().is_some_and(|piece| !piece.is_empty()) {
                pieces.push(Vec::new());
            }
        }
        let step = TAU / count.max(1) as f64;
        let (first, last) = (curve.angle.first(), curve.angle.last());
        let whole = first.zip(last).is_some_and(|(a, b)| b - a + 1.5 * step >= TAU);
        let closed = whole && pieces.len() == 1 && pieces[0].len() == count;
        if whole && !closed && pieces.len() > 1 {
            // The last piece goes on in the first where neither ends at a gap.
            let ends = [curve.size[0], curve.size[count - 1]];
            if ends.iter().all(|size| drawable(*size)) {
                let first = pieces.remove(0);
                if let Some(last) = pieces.last_mut() {
                    last.extend(first);
                }
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        (pieces, closed)
    }
}

/// Points of a circle.
fn circle([x, y]: Place, radius: f64) -> Vec<Place> {
    let angle = |k: i32| TAU * f64::from(k) / 96.0;
    (0..=96).map(|k| [x + radius * angle(k).cos(), y - radius * angle(k).sin()]).collect()
}

/// A colour in front of white, as if seen through.
fn pale(color: [u8; 3]) -> [u8; 3] {
    color.map(|c| (255.0 - 0.16 * (255.0 - f64::from(c))).round() as u8)
}

impl Picture for PolarPlot {
    fn size(&self) -> Place {
        let notes = self.notes(&self.radial()).len() + usize::from(self.named()) + 1;
        [WIDTH, MARGIN * 2.0 + TITLE + 2.0 * (RIM + RADIUS) + NOTE * notes as f64]
    }
    fn title(&self) -> String {
        self.title.clone()
    }
    fn draw(&self, canvas: &mut dyn Canvas) {
        let radial = self.radial();
        let title = font::fit(&self.title, 10.0, true, WIDTH - 2.0 * MARGIN);
        canvas.text([MARGIN, MARGIN + 9.0], &title, &TextStyle::new(10.0).bold());
        let drawn: Vec<_> = self.curves.iter().map(|curve| self.pieces(curve, &radial)).collect();
        if let [(pieces, true)] = &drawn[..] {
            canvas.polygon(&pieces[0], pale(palette::color(0)), None);
        }
        self.circles(canvas, &radial);
        self.skeleton(canvas);
        self.numbers(canvas, &radial);
        for (style, (pieces, closed)) in drawn.iter().enumerate() {
            let stroke = Stroke { width: 1.2, ..palette::stroke(style) };
            for piece in pieces {
                let mut points = piece.clone();
                if *closed {
                    points.extend(piece.first());
                }
                match points[..] {
                    [only] => canvas.disc(only, 1.6, stroke.color, None),
                    _ => canvas.line(&points, &stroke),
                }
            }
        }
        canvas.disc(self.middle(), 2.2, BLACK, None);
        self.directions(canvas);
        let mut y = MARGIN + TITLE + 2.0 * (RIM + RADIUS) + 6.0;
        let label = crate::compose::with_unit(&self.label, &radial.scale);
        canvas.text([MARGIN, y], &label, &TextStyle::new(SMALL));
        y += NOTE;
        if self.named() {
            let (places, _) = legend::flow(self.curves.iter().map(|c| c.name.as_str()), WIDTH);
            for ((style, curve), (x, _)) in self.curves.iter().enumerate().zip(places) {
                let label = curve.name.clone();
                let line = crate::compose::Line { label, style, values: &[] };
                legend::entry(canvas, &line, [MARGIN + x, y - 2.4], WIDTH);
            }
            y += NOTE;
        }
        for note in self.notes(&radial) {
            let note = font::fit(&note, SMALL, false, WIDTH - 2.0 * MARGIN);
            canvas.text([MARGIN, y], &note, &TextStyle::new(SMALL).color(GREY));
            y += NOTE;
        }
    }
}
