//! PNG: the same shapes as pixels.

use crate::canvas::{Anchor, Canvas, Color, Place, Stroke, TextStyle};
use crate::font;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform,
};
use ttf_parser::OutlineBuilder;

/// Pixels per point: about 216 dots per inch.
const SCALE: f64 = 3.0;

/// Most pixels of a picture; larger ones are drawn more coarsely.
const PIXELS: f64 = 6e7;

/// A page of pixels.
#[derive(Debug)]
pub struct Png {
    pixels: Pixmap,
    transform: Transform,
}

impl Png {
    /// An empty page of the given size (pt), white; `None` where the size is not a size.
    pub fn new(size: Place) -> Option<Self> {
        let [w, h] = size;
        let scale = SCALE.min((PIXELS / (w * h)).sqrt());
        let mut pixels = Pixmap::new((w * scale).ceil() as u32, (h * scale).ceil() as u32)?;
        pixels.fill(tiny_skia::Color::WHITE);
        Some(Png { pixels, transform: Transform::from_scale(scale as f32, scale as f32) })
    }

    /// The file's bytes.
    pub fn finish(self) -> Result<Vec<u8>, String> {
        self.pixels.encode_png().map_err(|error| error.to_string())
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.pixels.width(), self.pixels.height())
    }

    fn fill(&mut self, path: Option<Path>, color: Color, transform: Transform) {
        if let Some(path) = path {
            self.pixels.fill_path(&path, &paint(color), FillRule::Winding, transform, None);
        }
    }

    fn outline(&mut self, path: Option<&Path>, stroke: &Stroke) {
        let Some(path) = path else { return };
        let dash: Vec<f32> = stroke.dash.iter().map(|d| *d as f32).collect();
        let stroke_of_line = tiny_skia::Stroke {
            width: stroke.width as f32,
            line_join: LineJoin::Round,
            line_cap: if stroke.width > 2.0 { LineCap::Round } else { LineCap::Butt },
            dash: if dash.is_empty() { None } else { StrokeDash::new(dash, 0.0) },
            ..tiny_skia::Stroke::default()
        };
        let paint = paint(stroke.color);
        self.pixels.stroke_path(path, &paint, &stroke_of_line, self.transform, None);
    }
}

impl Canvas for Png {
    fn line(&mut self, points: &[Place], stroke: &Stroke) {
        self.outline(path(points, false).as_ref(), stroke);
    }
    fn polygon(&mut self, points: &[Place], fill: Color, outline: Option<&Stroke>) {
        let path = path(points, true);
        self.fill(path.clone(), fill, self.transform);
        if let Some(outline) = outline {
            self.outline(path.as_ref(), outline);
        }
    }
    fn disc(&mut self, center: Place, radius: f64, fill: Color, outline: Option<&Stroke>) {
        let [x, y] = center.map(|c| c as f32);
        let path = PathBuilder::from_circle(x, y, radius as f32);
        self.fill(path.clone(), fill, self.transform);
        if let Some(outline) = outline {
            self.outline(path.as_ref(), outline);
        }
    }
    fn text(&mut self, at: Place, text: &str, style: &TextStyle) {
        let mut pen = Pen { path: PathBuilder::new(), x: 0.0 };
        let em = font::outline(text, style.bold, &mut pen, |pen, x| pen.x = x as f32);
        let width = font::width(text, style.size, style.bold);
        let before = match style.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let turn = if style.upward { Transform::from_rotate(-90.0) } else { Transform::identity() };
        let scale = (style.size / em) as f32;
        let transform = self
            .transform
            .pre_translate(at[0] as f32, at[1] as f32)
            .pre_concat(turn)
            .pre_translate(-before as f32, 0.0)
            .pre_scale(scale, -scale);
        self.fill(pen.path.finish(), style.color, transform);
    }
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(color[0], color[1], color[2], 255);
    paint.anti_alias = true;
    paint
}

fn path(points: &[Place], close: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, point) in points.iter().enumerate() {
        let [x, y] = point.map(|c| c as f32);
        if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    if close {
        path.close();
    }
    path.finish()
}

/// Glyph outlines one after the other.
struct Pen {
    path: PathBuilder,
    x: f32,
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + x1, y1, self.x + x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.cubic_to(self.x + x1, y1, self.x + x2, y2, self.x + x, y);
    }
    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_lines_leave_ink() {
        let mut png = Png::new([40.0, 20.0]).expect("a page");
        assert_eq!(png.size(), (120, 60));
        png.text([2.0, 12.0], "ab", &TextStyle::new(9.0));
        png.line([[0.0, 18.0], [40.0, 18.0]].as_slice(), &Stroke::solid([200, 0, 0], 1.0));
        let dark = |p: &&tiny_skia::PremultipliedColorU8| p.green() < 80;
        assert!(png.pixels.pixels().iter().filter(dark).count() > 300);
        assert!(png.finish().expect("bytes").starts_with(b"\x89PNG"));
    }

    #[test]
    fn a_page_without_size_is_refused() {
        assert!(Png::new([0.0, 10.0]).is_none());
        assert!(Png::new([f64::NAN, 10.0]).is_none());
    }
}
