//! `handc new`: a starter model that runs.

use std::path::Path;

const TEMPLATE: &str = include_str!("starter.hdl");

/// Writes NAME.hdl.
pub fn new(name: &str) -> u8 {
    let name = name.strip_suffix(".hdl").unwrap_or(name);
    let is_identifier = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_identifier {
        eprintln!("error: `{name}` is not a model name: letters, digits and `_`, no digit first");
        return 2;
    }
    let file = format!("{name}.hdl");
    if Path::new(&file).exists() {
        eprintln!("error: `{file}` is there already");
        return 2;
    }
    if let Err(error) = std::fs::write(&file, TEMPLATE.replace("starter", name)) {
        eprintln!("error: cannot write `{file}`: {error}");
        return 2;
    }
    super::print(&format!("wrote {file}; run it with: handc run {file} --out {name}.csv\n"));
    0
}
