//! Comments behind statements: those of neighbouring lines that stood in one column before stand in
//! one again, one space behind the longest of their lines. All others stand one space behind theirs.

/// A comment behind something on its line.
pub(super) struct Remark {
    /// Where the one space before it stands, in the new text.
    pub(super) at: usize,
    /// The column it had, in characters.
    pub(super) column: usize,
}

/// Widens the spaces before comments; `remarks` are in the order of the text.
pub(super) fn align(text: &str, remarks: &[Remark]) -> String {
    let mut out = String::with_capacity(text.len());
    let mut written = 0;
    let mut rest = remarks;
    while let Some(first) = rest.first() {
        let follows = |pair: &[Remark]| {
            pair[1].column == first.column
                && text[pair[0].at..pair[1].at].matches('\n').count() == 1
        };
        let count = 1 + rest.windows(2).take_while(|pair| follows(pair)).count();
        let width = |remark: &Remark| {
            let start = text[..remark.at].rfind('\n').map_or(0, |i| i + 1);
            text[start..remark.at].chars().count()
        };
        let widest = rest[..count].iter().map(width).max().unwrap_or(0);
        for remark in &rest[..count] {
            out.push_str(&text[written..remark.at]);
            out.push_str(&" ".repeat(widest - width(remark)));
            written = remark.at;
        }
        rest = &rest[count..];
    }
    out.push_str(&text[written..]);
    out
}
