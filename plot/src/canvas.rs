//! What a figure is drawn on: lines, filled shapes and text, in points, y downwards.

/// A colour, red, green and blue.
pub type Color = [u8; 3];

/// A place on paper (pt).
pub type Place = [f64; 2];

/// Black.
pub const BLACK: Color = [0, 0, 0];
/// Text that steps back.
pub const GREY: Color = [90, 90, 90];
/// Grid lines.
pub const LIGHT: Color = [228, 228, 228];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width (pt).
    pub width: f64,
    /// Lengths of dashes and gaps in turn (pt); empty for a solid line.
    pub dash: &'static [f64],
}

impl Stroke {
    /// A solid line.
    pub const fn solid(color: Color, width: f64) -> Self {
        Stroke { color, width, dash: &[] }
    }
}

/// Where a text stands against its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The place is the text's beginning.
    Start,
    /// The place is its middle.
    Middle,
    /// The place is its end.
    End,
}

/// How a text is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// Size of the font (pt).
    pub size: f64,
    /// Bold.
    pub bold: bool,
    /// Colour.
    pub color: Color,
    /// Against its place.
    pub anchor: Anchor,
    /// Read from below, for labels of vertical axes.
    pub upward: bool,
}

impl TextStyle {
    /// Plain black text from its beginning.
    pub const fn new(size: f64) -> Self {
        TextStyle { size, bold: false, color: BLACK, anchor: Anchor::Start, upward: false }
    }
    /// The same with another anchor.
    pub const fn anchor(self, anchor: Anchor) -> Self {
        TextStyle { anchor, ..self }
    }
    /// The same in another colour.
    pub const fn color(self, color: Color) -> Self {
        TextStyle { color, ..self }
    }
    /// The same in bold.
    pub const fn bold(self) -> Self {
        TextStyle { bold: true, ..self }
    }
    /// The same, read from below.
    pub const fn upward(self) -> Self {
        TextStyle { upward: true, ..self }
    }
}

/// A back end.
pub trait Canvas {
    /// A line through points, with round joins.
    fn line(&mut self, points: &[Place], stroke: &Stroke);
    /// Several lines with one stroke.
    fn lines(&mut self, lines: &[Vec<Place>], stroke: &Stroke) {
        lines.iter().for_each(|points| self.line(points, stroke));
    }
    /// A filled polygon with an outline, if any.
    fn polygon(&mut self, points: &[Place], fill: Color, outline: Option<&Stroke>);
    /// Several filled polygons of one look.
    fn polygons(&mut self, polygons: &[Vec<Place>], fill: Color, outline: Option<&Stroke>) {
        polygons.iter().for_each(|points| self.polygon(points, fill, outline));
    }
    /// A filled disc with an outline, if any.
    fn disc(&mut self, center: Place, radius: f64, fill: Color, outline: Option<&Stroke>);
    /// A line of text; the place is on its baseline.
    fn text(&mut self, at: Place, text: &str, style: &TextStyle);
}
