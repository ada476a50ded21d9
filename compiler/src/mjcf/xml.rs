//! A small XML writer: elements with attributes and comments, indented, the same bytes every time.

use std::fmt::Write;

/// An element.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
    comment: Vec<String>,
}

impl Element {
    /// An element without attributes or children.
    pub(super) fn new(name: &'static str) -> Self {
        Element { name, ..Element::default() }
    }
    /// With an attribute.
    pub(super) fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }
    /// With an attribute of one or more numbers.
    pub(super) fn with_numbers(self, name: &'static str, values: &[f64]) -> Self {
        self.with(name, numbers(values))
    }
    /// With children after those it has.
    pub(super) fn with_children(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }
    /// With lines of a comment that stands before its children.
    pub(super) fn with_comment(mut self, lines: Vec<String>) -> Self {
        self.comment = lines;
        self
    }
    /// Whether it has children.
    pub(super) fn is_empty(&self) -> bool {
        self.children.is_empty()
    }
    /// Names of all elements of a kind within, in the order of the text.
    pub(super) fn named<'a>(&'a self, kind: &'a str) -> Vec<&'a str> {
        let mut names = Vec::new();
        let mut open = vec![self];
        while let Some(element) = open.pop() {
            if element.name == kind {
                let name = element.attributes.iter().find(|(key, _)| *key == "name");
                names.extend(name.map(|(_, value)| value.as_str()));
            }
            open.extend(element.children.iter().rev());
        }
        names
    }
    /// The text of a document with this root.
    pub(super) fn document(&self) -> String {
        let mut text = String::new();
        self.write(0, &mut text);
        text
    }

    fn write(&self, depth: usize, text: &mut String) {
        let indent = 2 * depth;
        // Writing to a string cannot fail.
        let _ = write!(text, "{:indent$}<{}", "", self.name);
        for (name, value) in &self.attributes {
            let _ = write!(text, " {name}=\"{}\"", escape(value));
        }
        if self.children.is_empty() && self.comment.is_empty() {
            text.push_str("/>\n");
            return;
        }
        text.push_str(">\n");
        if !self.comment.is_empty() {
            let _ = writeln!(text, "{:indent$}  <!--", "");
            for line in &self.comment {
                let line = format!("{:indent$}    {}", "", comment_line(line));
                let _ = writeln!(text, "{}", line.trim_end());
            }
            let _ = writeln!(text, "{:indent$}  -->", "");
        }
        for child in &self.children {
            child.write(depth + 1, text);
        }
        let _ = writeln!(text, "{:indent$}</{}>", "", self.name);
    }
}

/// Numbers with the fewest digits that read back as the same bits, with spaces between.
pub(super) fn numbers(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|&value| number(value)).collect();
    words.join(" ")
}

/// One number; −0 is written as 0.
pub(super) fn number(value: f64) -> String {
    let text = format!("{:?}", value + 0.0);
    text.strip_suffix(".0").map(str::to_string).unwrap_or(text)
}

fn escape(value: &str) -> String {
    let mut out = String::with_capacity(value.len());
    for c in value.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A comment may hold neither `--` nor control characters.
fn comment_line(line: &str) -> String {
    let line: String = line.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    line.replace("--", "- -")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        assert_eq!(numbers(&[1.0, -0.0, 0.1, 1e-15, -2.5e20]), "1 0 0.1 1e-15 -2.5e20");
        for value in [1.0 / 3.0, 6.62607015e-34, f64::MIN_POSITIVE, 1e16] {
            assert_eq!(number(value).parse(), Ok(value));
        }
    }

    #[test]
    fn text_is_escaped() {
        let root = Element::new("a")
            .with("n", "x<\"&\">")
            .with_comment(vec!["a -- b --> c".into()])
            .with_children([Element::new("b")]);
        let wanted = "<a n=\"x&lt;&quot;&amp;&quot;&gt;\">\n  <!--\n    a - - b - -> c\n  -->\n  \
                      <b/>\n</a>\n";
        assert_eq!(root.document(), wanted);
    }
}
