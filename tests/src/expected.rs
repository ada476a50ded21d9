//! Expected texts, which are files: `HANDC_UPDATE=1` rewrites them.

use std::path::Path;

/// Compares a text with its file, or rewrites the file; answers what is wrong.
pub fn expected(path: &Path, found: &str) -> Result<(), String> {
    let shown = path.display();
    if std::env::var_os("HANDC_UPDATE").is_some() {
        return std::fs::write(path, found).map_err(|error| format!("{shown}: {error}"));
    }
    let expected = std::fs::read_to_string(path).map_err(|error| format!("{shown}: {error}"))?;
    if expected == found {
        return Ok(());
    }
    let line = expected.lines().zip(found.lines()).take_while(|(a, b)| a == b).count();
    let at = |text: &str| text.lines().nth(line).unwrap_or("(the end)").to_string();
    Err(format!(
        "{shown} differs from line {}:\nexpected {}\nfound    {}\nHANDC_UPDATE=1 rewrites it",
        line + 1,
        at(&expected),
        at(found)
    ))
}
