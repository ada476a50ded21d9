//! Ranges of numbers: a constant is looked at here, what depends on parameters when a run begins.

use super::depend::{May, is_allowed};
use super::{Checker, constant};
use crate::diagnostic::Diagnostic;
use crate::hir::{Expr, Requirement};
use std::ops::RangeInclusive;

/// Above zero.
pub(super) const POSITIVE: RangeInclusive<f64> = f64::MIN_POSITIVE..=f64::INFINITY;
/// Zero or above.
pub(super) const NOT_NEGATIVE: RangeInclusive<f64> = 0.0..=f64::INFINITY;

impl Checker<'_> {
    /// Complains about a constant out of its range; `message` says what must be.
    pub(super) fn must(&mut self, value: &Expr, range: RangeInclusive<f64>, message: &str) {
        match constant(value) {
            Some(x) if range.contains(&x) => {}
            Some(_) => self.report(Diagnostic::error("value", value.span, message)),
            None if is_allowed(value, May::PARAMS) => self.requirements.push(Requirement {
                text: message.to_string(),
                value: value.clone(),
                least: *range.start(),
                most: *range.end(),
            }),
            None => {}
        }
    }
}
