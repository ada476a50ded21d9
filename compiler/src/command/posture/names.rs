//! Names and values of the command line against a mechanism. What does not fit is collected, so
//! that all of it is told at once.

use super::value;
use handc_core::simulation::find_name;
use handc_dsl::dimension::Dimension;
use handc_runtime::mechanism::{Mechanism, Role};

/// Reads options and collects what is wrong with them.
#[derive(Debug)]
pub(crate) struct Reader<'a> {
    pub(crate) mechanism: &'a Mechanism,
    pub(crate) complaints: Vec<String>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(mechanism: &'a Mechanism) -> Self {
        Reader { mechanism, complaints: Vec::new() }
    }

    /// Collects an error.
    pub(crate) fn complain(&mut self, message: String) {
        if !self.complaints.contains(&message) {
            self.complaints.push(message);
        }
    }

    /// A value, or a complaint that names the option.
    pub(crate) fn take<T>(&mut self, option: &str, found: Result<T, String>) -> Option<T> {
        found.map_err(|message| self.complain(format!("`{option}`: {message}"))).ok()
    }

    fn find(&mut self, kind: &str, name: &str, known: Vec<&str>) -> Option<usize> {
        let found = find_name(&self.mechanism.name, kind, name, known.into_iter());
        found.map_err(|error| self.complain(error.to_string())).ok()
    }

    /// A strand by name.
    pub(crate) fn strand(&mut self, name: &str) -> Option<usize> {
        self.find("strand", name, self.mechanism.strands.iter().map(|s| s.name.as_str()).collect())
    }

    /// A coordinate by name.
    pub(crate) fn coordinate(&mut self, name: &str) -> Option<usize> {
        let known = self.mechanism.coordinates.iter().map(|c| c.name.as_str()).collect();
        let found = self.find("coordinate", name, known)?;
        if matches!(self.mechanism.coordinates[found].role, Role::Fibre | Role::Activation) {
            self.complain(format!("`{name}` is of a muscle: it follows from its excitation"));
            return None;
        }
        Some(found)
    }

    /// A frame by name.
    pub(crate) fn frame(&mut self, name: &str) -> Option<usize> {
        self.find("frame", name, self.mechanism.frames.iter().map(|f| f.name.as_str()).collect())
    }

    /// Splits `NAME=VALUE`.
    pub(crate) fn split<'t>(&mut self, option: &str, text: &'t str) -> Option<(&'t str, &'t str)> {
        let parts = text.split_once('=').map(|(name, value)| (name.trim(), value.trim()));
        self.take(option, parts.ok_or_else(|| format!("NAME=VALUE is wanted, not `{text}`")))
    }

    /// `STRAND=VALUE` for each text; a strand that is named twice is an error.
    pub(crate) fn strand_values(
        &mut self,
        option: &str,
        texts: &[String],
        dimension: Dimension,
    ) -> Vec<(usize, f64)> {
        let mut found: Vec<(usize, f64)> = Vec::new();
        for text in texts {
            let Some((name, value)) = self.split(option, text) else { continue };
            let strand = self.strand(name);
            let value = self.take(option, value::number(value, dimension));
            let Some((strand, value)) = strand.zip(value) else { continue };
            if found.iter().any(|(other, _)| *other == strand) {
                self.complain(format!("`{option}` is given twice for `{name}`"));
            } else {
                found.push((strand, value));
            }
        }
        found
    }

    /// `JOINT=VALUE` for each text, within the joint's limits.
    pub(crate) fn coordinate_values(
        &mut self,
        option: &str,
        texts: &[String],
        limits: impl Fn(usize) -> Option<[f64; 2]>,
    ) -> Vec<(usize, f64)> {
        let mut found = Vec::new();
        for text in texts {
            let Some((name, value)) = self.split(option, text) else { continue };
            let Some(c) = self.coordinate(name) else { continue };
            let dimension = self.dimension(c);
            let Some(value) = self.take(option, value::number(value, dimension)) else { continue };
            if let Some(limits) = limits(c)
                && !within(value, limits)
            {
                let range = self.range(c, limits);
                self.complain(format!(
                    "`{option} {text}` is outside the limits of `{name}`: {range}"
                ));
            }
            found.push((c, value));
        }
        found
    }

    /// What a coordinate measures.
    pub(crate) fn dimension(&self, coordinate: usize) -> Dimension {
        let is_length = self.mechanism.coordinates[coordinate].is_length;
        if is_length { Dimension::LENGTH } else { Dimension::ANGLE }
    }

    /// A range of a coordinate as text.
    pub(crate) fn range(&self, coordinate: usize, [low, high]: [f64; 2]) -> String {
        if self.mechanism.coordinates[coordinate].is_length {
            format!("{:.4} to {:.4} mm", low * 1e3, high * 1e3)
        } else {
            let (low_deg, high_deg) = (low.to_degrees(), high.to_degrees());
            format!("{low:.4} to {high:.4} rad ({low_deg:.1} to {high_deg:.1} deg)")
        }
    }
}

/// Whether a value lies within limits, up to rounding.
pub(crate) fn within(value: f64, [low, high]: [f64; 2]) -> bool {
    let slack = 1e-9 * (high - low).abs();
    value >= low - slack && value <= high + slack
}
