//! Blank lines between items, which the pretty printer leaves out.

/// `text` with a blank line before every documented or attributed item that follows the end of
/// another one, and around the imports.
pub(super) fn spaced(text: &str) -> String {
    let mut spaced = String::with_capacity(text.len() + text.len() / 32);
    let mut before = "";
    for line in text.lines() {
        if needs_blank(before, line) {
            spaced.push('\n');
        }
        spaced.push_str(line);
        spaced.push('\n');
        before = line;
    }
    spaced
}

fn needs_blank(before: &str, line: &str) -> bool {
    if before.trim().is_empty() {
        return false;
    }
    let (indent, text) = split(line);
    let (indent_before, text_before) = split(before);
    if text_before.starts_with("//!") {
        return !text.starts_with("//!");
    }
    if indent != indent_before || is_header(text_before) {
        return false;
    }
    // Statements inside functions are deeper than any item.
    let is_item = is_header(text)
        || ["pub fn ", "fn ", "impl ", "pub struct ", "const "].iter().any(|w| text.starts_with(w));
    let ended = text_before == "}"
        || text_before.ends_with("};")
        || (indent == 0 && text_before.ends_with(';'));
    indent <= 4 && ended && is_item && !is_short(before, text)
        || (indent == 0 && is_use(text_before) && !text.starts_with("use "))
}

/// Documentation or an attribute: the beginning of an item.
fn is_header(text: &str) -> bool {
    text.starts_with("///") || text.starts_with("#[")
}

/// A whole import on one line.
fn is_use(text: &str) -> bool {
    text.starts_with("use ") && text.ends_with(';')
}

/// Constants that stand one a line stay together.
fn is_short(before: &str, text: &str) -> bool {
    before.starts_with("pub const ") && text.starts_with("///")
}

fn split(line: &str) -> (usize, &str) {
    let text = line.trim_start();
    (line.len() - text.len(), text)
}

#[cfg(test)]
mod tests {
    use super::spaced;

    #[test]
    fn items_are_set_apart() {
        let text = "//! Doc.\nuse a::b;\nuse a::{\n    c,\n};\n/// A.\npub fn a() {\n    let x = 1;\n    \
                    x\n}\n/// B.\nimpl B {\n    fn c() {\n    }\n    fn d() {\n    }\n}\n";
        let expected = "//! Doc.\n\nuse a::b;\nuse a::{\n    c,\n};\n\n/// A.\npub fn a() {\n    let \
                        x = 1;\n    x\n}\n\n/// B.\nimpl B {\n    fn c() {\n    }\n\n    fn d() {\n    \
                        }\n}\n";
        assert_eq!(spaced(text), expected);
    }
}
