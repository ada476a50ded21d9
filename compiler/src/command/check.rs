//! `handc check`: every diagnostic.

use handc_dsl::Checked;
use handc_dsl::ast::DeclKind;
use std::path::Path;

/// Checks a model file, or a file of components alone.
pub fn check(file: &Path, root: Option<&Path>) -> u8 {
    let (mut checked, _) = super::load(file, root);
    let components = components(&checked);
    if components > 0 {
        // To be imported, not to be run.
        checked.diagnostics.retain(|d| d.code != "no-model");
    }
    super::report(&checked);
    if super::has_error(&checked.diagnostics) {
        return 1;
    }
    if checked.model.is_none() {
        let components = super::count(components, "component");
        super::print(&format!("{}: {components}, no model\n", file.display()));
    } else if checked.diagnostics.is_empty() {
        super::print(&format!("{}: no diagnostics\n", file.display()));
    }
    0
}

/// How many components the file itself declares.
fn components(checked: &Checked) -> usize {
    let items = checked.file.as_ref().map_or(&[][..], |file| &file.items);
    items.iter().filter(|item| matches!(item.kind, DeclKind::Component(_))).count()
}
