//! SVG: well-formed text, text as text, one element per shape.

use crate::canvas::{Anchor, Canvas, Color, Place, Stroke, TextStyle};
use crate::font;
use std::fmt::Write;

/// Collects SVG elements.
#[derive(Clone, Debug)]
pub struct Svg {
    text: String,
}

impl Svg {
    /// An empty page of the given size (pt), white.
    pub fn new(size: Place, title: &str) -> Self {
        let [w, h] = size.map(number);
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}pt\" \
             height=\"{h}pt\" font-family=\"{}\" fill=\"none\" stroke-linejoin=\"round\">\n",
            font::FAMILY
        );
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<title>{}</title>", escape(title));
        let _ = writeln!(text, "<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>");
        Svg { text }
    }

    /// The document.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }

    fn stroke(&mut self, stroke: &Stroke) {
        let (color, width) = (hex(stroke.color), number(stroke.width));
        let _ = write!(self.text, " stroke=\"{color}\" stroke-width=\"{width}\"");
        if !stroke.dash.is_empty() {
            let dashes: Vec<_> = stroke.dash.iter().map(|d| number(*d)).collect();
            let _ = write!(self.text, " stroke-dasharray=\"{}\"", dashes.join(" "));
        }
    }

    /// A polyline as steps from point to point, each rounded so that errors do not add up.
    fn path(&mut self, points: &[Place]) {
        let mut last = [0.0; 2];
        for (i, point) in points.iter().enumerate() {
            let place = point.map(|x| (x * STEPS).round());
            let [dx, dy] = [0, 1].map(|k| step(place[k] - last[k]));
            match i {
                0 => self.text.push('M'),
                1 => self.text.push('l'),
                _ if dx.starts_with('-') => {}
                _ => self.text.push(' '),
            }
            self.text.push_str(&dx);
            if !dy.starts_with('-') {
                self.text.push(' ');
            }
            self.text.push_str(&dy);
            last = place;
        }
    }
}

impl Canvas for Svg {
    fn line(&mut self, points: &[Place], stroke: &Stroke) {
        self.lines(&[points.to_vec()], stroke);
    }
    fn lines(&mut self, lines: &[Vec<Place>], stroke: &Stroke) {
        if lines.iter().all(|points| points.len() < 2) {
            return;
        }
        self.text.push_str("<path d=\"");
        lines.iter().filter(|points| points.len() > 1).for_each(|points| self.path(points));
        self.text.push('"');
        self.stroke(stroke);
        if stroke.width > 2.0 {
            self.text.push_str(" stroke-linecap=\"round\"");
        }
        self.text.push_str("/>\n");
    }
    fn polygon(&mut self, points: &[Place], fill: Color, outline: Option<&Stroke>) {
        self.polygons(&[points.to_vec()], fill, outline);
    }
    fn polygons(&mut self, polygons: &[Vec<Place>], fill: Color, outline: Option<&Stroke>) {
        if polygons.is_empty() {
            return;
        }
        self.text.push_str("<path d=\"");
        for points in polygons {
            self.path(points);
            self.text.push('Z');
        }
        let _ = write!(self.text, "\" fill=\"{}\"", hex(fill));
        if let Some(outline) = outline {
            self.stroke(outline);
        }
        self.text.push_str("/>\n");
    }
    fn disc(&mut self, center: Place, radius: f64, fill: Color, outline: Option<&Stroke>) {
        let ([x, y], r) = (center.map(number), number(radius));
        let _ = write!(self.text, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{}\"", hex(fill));
        if let Some(outline) = outline {
            self.stroke(outline);
        }
        self.text.push_str("/>\n");
    }
    fn text(&mut self, at: Place, text: &str, style: &TextStyle) {
        if text.is_empty() {
            return;
        }
        let [x, y] = at.map(number);
        let _ = write!(self.text, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"", number(style.size));
        let _ = write!(self.text, " fill=\"{}\"", hex(style.color));
        if style.bold {
            self.text.push_str(" font-weight=\"bold\"");
        }
        match style.anchor {
            Anchor::Start => {}
            Anchor::Middle => self.text.push_str(" text-anchor=\"middle\""),
            Anchor::End => self.text.push_str(" text-anchor=\"end\""),
        }
        if style.upward {
            let _ = write!(self.text, " transform=\"rotate(-90 {x} {y})\"");
        }
        let _ = writeln!(self.text, ">{}</text>", escape(text));
    }
}

/// Steps of a polyline in one point of paper.
const STEPS: f64 = 10.0;

/// A number of steps in points, as short as SVG allows.
fn step(count: f64) -> String {
    let text = number(count / STEPS);
    match text.strip_prefix("0.") {
        Some(rest) => format!(".{rest}"),
        None => text.replacen("-0.", "-.", 1),
    }
}

/// A coordinate with two decimals at most.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.to_string() }
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text as XML; what XML cannot hold is replaced.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(number(1.0), "1");
        assert_eq!(number(-0.001), "0");
        assert_eq!(number(12.345), "12.35");
        assert_eq!(number(100.0), "100");
    }

    #[test]
    fn polylines_are_short_and_do_not_drift() {
        let mut svg = Svg::new([10.0, 10.0], "line");
        let points: Vec<Place> = (0..101).map(|i| [f64::from(i) * 0.44, 1.0]).collect();
        svg.line(&points, &Stroke::solid([0, 0, 0], 1.0));
        let text = svg.finish();
        let path = text.split('"').find(|part| part.starts_with('M')).unwrap_or_default();
        assert!(path.starts_with("M0 1l.4 0 .5 0 .4 0"), "{path}");
        let steps = path.split(['l', ' ']).skip(2).step_by(2);
        let end: f64 = steps.filter_map(|x| x.parse::<f64>().ok()).sum();
        assert!((end - 44.0).abs() < 1e-9, "{end}");
    }

    #[test]
    fn names_cannot_break_the_document() {
        let mut svg = Svg::new([10.0, 10.0], "a<b & \"c\"");
        svg.text([1.0, 2.0], "</text>\u{1}", &TextStyle::new(7.0));
        let text = svg.finish();
        assert!(
            text.contains("&lt;/text&gt;\u{fffd}") && text.contains("a&lt;b &amp; &quot;c&quot;")
        );
    }
}
