//! What `handc info` prints.

use handc_dsl::hir;
use handc_runtime::mechanism::Mechanism;

/// The model as text.
pub fn describe(_model: &hir::Model, _mechanism: Mechanism) -> String {
    String::new()
}
