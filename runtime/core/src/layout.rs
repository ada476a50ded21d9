//! Names, units and shape of a model: what tools ask and what the integrator indexes by.

use std::ops::Range;

/// What a coordinate measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateKind {
    /// An angle (rad).
    Angle,
    /// A length (m).
    Length,
    /// A number without unit.
    Ratio,
}

/// A generalized coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Name as in the model.
    pub name: String,
    /// Angle or length.
    pub kind: CoordinateKind,
    /// Whether the model itself drives it, so that it has no momentum and no equation.
    pub kinematic: bool,
    /// Whether it is in static equilibrium: no mass moves with it and nothing depends on its rate.
    pub is_static: bool,
    /// Whether it is an internal variable: no mass moves with it, but its own equation depends on its
    /// rate ([`crate::internal`]).
    pub is_internal: bool,
}

/// A parameter or an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name as in the model.
    pub name: String,
    /// SI unit, empty where dimensionless.
    pub unit: String,
}

/// A strand.
#[derive(Clone, Debug, PartialEq)]
pub struct Strand {
    /// Name as in the model.
    pub name: String,
    /// Whether the model gives its natural length; if not it is the length at the start.
    pub has_rest: bool,
    /// Whether that changes with time or inputs.
    pub rest_varies: bool,
    /// Whether its length is prescribed by a constraint.
    pub is_prescribed: bool,
    /// The input that is its natural length, if it has one; an input that is not a number stands for
    /// the length at the start.
    pub actuator: Option<usize>,
    /// The muscle that it is, if it is one.
    pub muscle: Option<Muscle>,
}

/// Where the numbers of a muscle stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Muscle {
    /// Coordinate of its fibres' length along the tendon (m).
    pub fibre: usize,
    /// Coordinate of its activation.
    pub activation: usize,
    /// Input of its excitation.
    pub excitation: usize,
    /// Whether the model gives the activation at the start; if not it is the excitation there.
    pub has_start: bool,
}

/// A number that depends on parameters and must lie in a range when a run begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// What must be.
    pub text: String,
    /// `file:line` where the number is written.
    pub source: String,
    /// Least value that is allowed.
    pub least: f64,
    /// Largest.
    pub most: f64,
}

/// A surface that a strand wraps.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrap {
    /// The strand by index.
    pub strand: usize,
    /// What and where it is: "sphere in `knee` (leg.hdl:12)".
    pub surface: String,
}

/// A constraint row.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintRow {
    /// Column name without `lambda.`: `pin.x`, `rod`.
    pub name: String,
}

/// Coordinates that the step couples, solved together; a connected component of strands, bodies,
/// forces and constraints. Kinematic coordinates belong to none.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Coordinates by index, part by part, ascending in each.
    pub coordinates: Vec<usize>,
    /// Constraint rows by index, ascending.
    pub rows: Vec<usize>,
    /// How many coordinates, in order, the Newton matrix couples without the help of constraints.
    pub parts: Vec<usize>,
    /// Where the block's matrices start in packed storage.
    pub matrix_offset: usize,
    /// Where the block's constraint Jacobian starts in packed storage.
    pub constraint_offset: usize,
}

impl Block {
    /// The positions in `coordinates` of each part.
    pub fn part_ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.parts.iter().scan(0, |first, count| {
            *first += count;
            Some(*first - count..*first)
        })
    }

    /// The coordinates that are not driven: position in the block, index in the model.
    pub fn free(&self, driven: &[bool]) -> Vec<(usize, usize)> {
        let all = self.coordinates.iter().copied().enumerate();
        all.filter(|&(_, c)| !driven[c]).collect()
    }
}

/// Strands that follow a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Follow {
    /// Index of the motion.
    pub motion: usize,
    /// Strands by index.
    pub strands: Vec<usize>,
}

/// Names and shape of a scenario.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ScenarioLayout {
    /// Name as in the model.
    pub name: String,
    /// Coordinates that the scenario drives.
    pub driven: Vec<usize>,
    /// What follows a motion.
    pub follow: Vec<Follow>,
    /// Names of the recorded columns.
    pub records: Vec<String>,
}

/// Names, units and shape of a model.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Layout {
    /// Name of the model.
    pub name: String,
    /// Parameters in declaration order.
    pub params: Vec<Quantity>,
    /// Inputs in declaration order.
    pub inputs: Vec<Quantity>,
    /// Coordinates in declaration order.
    pub coordinates: Vec<Coordinate>,
    /// Strands in declaration order.
    pub strands: Vec<Strand>,
    /// Surfaces that strands wrap, strand by strand.
    pub wraps: Vec<Wrap>,
    /// Ranges of numbers that depend on parameters.
    pub requirements: Vec<Requirement>,
    /// Constraint rows in declaration order.
    pub rows: Vec<ConstraintRow>,
    /// Blocks of the step equations.
    pub blocks: Vec<Block>,
    /// Scenarios in declaration order.
    pub scenarios: Vec<ScenarioLayout>,
    /// A length typical of the model (m), for tolerances of coordinates that are lengths.
    pub length_scale: f64,
}

impl Layout {
    /// Coordinates in static equilibrium that are not driven, by index.
    pub fn statics(&self, driven: &[bool]) -> Vec<usize> {
        let is_static = |&c: &usize| self.coordinates[c].is_static && !driven[c];
        (0..self.coordinates.len()).filter(is_static).collect()
    }
    /// Internal coordinates that are not driven, by index.
    pub fn internals(&self, driven: &[bool]) -> Vec<usize> {
        let is_internal = |&c: &usize| self.coordinates[c].is_internal && !driven[c];
        (0..self.coordinates.len()).filter(is_internal).collect()
    }
    /// Coordinates that move no mass and are not driven, by index: in static equilibrium or internal.
    pub fn massless(&self, driven: &[bool]) -> Vec<usize> {
        let is_massless = |&c: &usize| {
            (self.coordinates[c].is_static || self.coordinates[c].is_internal) && !driven[c]
        };
        (0..self.coordinates.len()).filter(is_massless).collect()
    }
    /// Strands that are muscles: name and where their numbers stand.
    pub fn muscles(&self) -> impl Iterator<Item = (&str, &Muscle)> {
        self.strands.iter().filter_map(|s| Some((s.name.as_str(), s.muscle.as_ref()?)))
    }
    /// Numbers in a packed Newton matrix.
    pub fn matrix_size(&self) -> usize {
        self.blocks.iter().map(|b| b.coordinates.len() * b.coordinates.len()).sum()
    }
    /// Numbers in a packed constraint Jacobian.
    pub fn constraint_size(&self) -> usize {
        self.blocks.iter().map(|b| b.coordinates.len() * b.rows.len()).sum()
    }
}
