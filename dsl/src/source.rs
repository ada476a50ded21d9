//! Files and places in them.
//!
//! Every token, declaration and expression keeps a [`Span`], so any later stage can underline the
//! text that made a thing. A [`SourceMap`] owns the texts of one compilation: the file given and
//! those it imports.

use serde::Serialize;

/// A file of a [`SourceMap`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct FileId(pub u32);

/// A range of bytes in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Span {
    /// The file.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// A span from byte offsets.
    pub fn new(file: FileId, start: usize, end: usize) -> Span {
        Span { file, start: start as u32, end: end as u32 }
    }

    /// The smallest span that holds both; `self` if they lie in different files.
    pub fn to(self, other: Span) -> Span {
        if self.file != other.file {
            return self;
        }
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }

    /// The empty span at the end of this one.
    pub fn end_point(self) -> Span {
        Span { start: self.end, ..self }
    }

    /// As a range of byte offsets.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }
}

#[derive(Clone, Debug)]
struct Source {
    path: String,
    text: String,
    lines: Vec<u32>,
}

/// The texts of one compilation.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<Source>,
}

impl SourceMap {
    /// Adds a file and answers its id.
    pub fn add(&mut self, path: impl Into<String>, text: impl Into<String>) -> FileId {
        let text = text.into();
        let mut lines = vec![0];
        lines.extend(text.bytes().enumerate().filter(|b| b.1 == b'\n').map(|b| b.0 as u32 + 1));
        self.files.push(Source { path: path.into(), text, lines });
        FileId(self.files.len() as u32 - 1)
    }

    /// How many files there are.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Whether there is no file.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// The path under which the file was read; empty for an unknown file.
    pub fn path(&self, file: FileId) -> &str {
        self.files.get(file.0 as usize).map_or("", |f| &f.path)
    }

    /// The text of the file; empty for an unknown file.
    pub fn text(&self, file: FileId) -> &str {
        self.files.get(file.0 as usize).map_or("", |f| &f.text)
    }

    /// The text of a span; empty if the span does not fit its file.
    pub fn slice(&self, span: Span) -> &str {
        self.text(span.file).get(span.range()).unwrap_or("")
    }

    /// Line and column of the start of a span, both from one; the column counts characters.
    pub fn line_col(&self, span: Span) -> (usize, usize) {
        let Some(file) = self.files.get(span.file.0 as usize) else { return (1, 1) };
        let line = file.lines.partition_point(|&start| start <= span.start).max(1);
        let start = file.lines[line - 1] as usize;
        let column = file.text.get(start..span.start as usize).map_or(0, |s| s.chars().count());
        (line, column + 1)
    }

    /// Byte offset at which a line (from one) begins; the end of the text beyond the last line.
    pub fn line_start(&self, file: FileId, line: usize) -> usize {
        let Some(file) = self.files.get(file.0 as usize) else { return 0 };
        file.lines.get(line.max(1) - 1).map_or(file.text.len(), |&s| s as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one() {
        let mut map = SourceMap::default();
        let file = map.add("a.hdl", "one\ntwø x\n");
        assert_eq!(map.line_col(Span::new(file, 0, 1)), (1, 1));
        assert_eq!(map.line_col(Span::new(file, 9, 10)), (2, 5));
        assert_eq!(map.slice(Span::new(file, 9, 10)), "x");
        assert_eq!(map.line_start(file, 2), 4);
        assert_eq!(map.line_start(file, 99), 11);
    }
}
