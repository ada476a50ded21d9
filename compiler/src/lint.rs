//! Lints of the mechanics.

use handc_dsl::diagnostic::Diagnostic;
use handc_dsl::hir;
use handc_runtime::mechanism::Mechanism;

/// Everything a biomechanist would want to be told before the first step.
pub fn lint(_model: &hir::Model, _mechanism: &Mechanism) -> Vec<Diagnostic> {
    Vec::new()
}
