//! The mechanism: constant data of a model, parents first; the one contract between language,
//! interpreter and compiler.
//!
//! A joint of several coordinates is a chain of links with one coordinate each. Frames that do not
//! move against a link are folded into it: points are given in link axes, and the masses of a link
//! are kept one by one and lumped when numbers are resolved. A number is a constant or a function
//! of the parameters ([`Number`]), so geometry and masses may be parameters too.

use crate::expression::{Function, Own, Program, Variable};
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};
use std::fmt;

/// A constant, or an output of [`Mechanism::values`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum Number {
    /// Known now (SI).
    Constant(f64),
    /// Output of [`Mechanism::values`] by index: depends on parameters.
    Value(u32),
}

impl Default for Number {
    fn default() -> Self {
        Number::ZERO
    }
}

impl Number {
    /// Zero.
    pub const ZERO: Number = Number::Constant(0.0);
    /// Whether it is the constant zero.
    pub fn is_zero(self) -> bool {
        self == Number::ZERO
    }
}

/// Three numbers.
pub type NumberVector = [Number; 3];

/// A constant rigid transform, `parent_from_child`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct NumberTransform {
    /// Rotation by rows.
    pub rotation: [NumberVector; 3],
    /// Child origin in the parent (m).
    pub translation: NumberVector,
}

impl NumberTransform {
    /// The identity.
    pub const IDENTITY: NumberTransform = {
        let (o, l) = (Number::ZERO, Number::Constant(1.0));
        NumberTransform { rotation: [[l, o, o], [o, l, o], [o, o, l]], translation: [o, o, o] }
    };
}

/// A parameter.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Param {
    /// Name.
    pub name: String,
    /// Doc comment.
    pub doc: String,
    /// SI unit; empty where dimensionless.
    pub unit: String,
    /// Default.
    pub default: f64,
}

/// An external input.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Input {
    /// Name.
    pub name: String,
    /// Doc comment.
    pub doc: String,
    /// SI unit; empty where dimensionless.
    pub unit: String,
    /// Default as a function of time and parameters.
    pub default: Program,
}

/// The motion of a link in its joint frame; axes are of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum Motion {
    /// Rotation about the axis by the coordinate.
    Revolute {
        /// Unit axis.
        axis: NumberVector,
    },
    /// Translation along the axis by the coordinate.
    Prismatic {
        /// Unit axis.
        axis: NumberVector,
    },
    /// Rotation about the axis by the coordinate, and advance along it.
    Screw {
        /// Unit axis.
        axis: NumberVector,
        /// Advance per radian (m/rad).
        pitch: Number,
    },
}

/// What a coordinate is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum Role {
    /// A joint.
    #[default]
    Joint,
    /// A translation of a node.
    Node,
    /// The length of a muscle's fibres along its tendon; it moves no link.
    Fibre,
    /// The activation of a muscle; it moves no link.
    Activation,
}

/// A coordinate and what acts on it alone.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Coordinate {
    /// Name.
    pub name: String,
    /// Where it is declared, `file.hdl:line`; empty if unknown.
    pub source: String,
    /// Doc comment of its joint.
    pub doc: String,
    /// Whether it is a length (m) rather than an angle (rad) or a plain number.
    pub is_length: bool,
    /// Start (rad or m).
    pub start: Number,
    /// Initial rate.
    pub velocity: Number,
    /// Viscous coefficient c of −c·q̇.
    pub damping: Number,
    /// Stiffness k of ½k(q − rest)².
    pub stiffness: Number,
    /// Rest of the spring.
    pub rest: Number,
    /// Range of motion.
    pub limits: Option<[Number; 2]>,
    /// Stiffness of elastic limits; zero where limits are only a range.
    pub limit_stiffness: Number,
    /// Width (rad or m) over which elastic limits begin; zero where they begin at once.
    pub limit_width: Number,
    /// Path as a function of time and parameters: the coordinate is kinematic.
    pub drive: Option<Program>,
    /// What it is of.
    pub role: Role,
}

impl Coordinate {
    /// Its unit; empty for a plain number.
    pub fn unit(&self) -> &'static str {
        match (self.role, self.is_length) {
            (Role::Activation, _) => "",
            (_, true) => "m",
            (_, false) => "rad",
        }
    }
}

/// A moving body with one coordinate.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Link {
    /// The link it moves on; `None` is the world. Always an earlier link.
    pub parent: Option<u32>,
    /// Constant transform `parent_from_joint`.
    pub parent_from_joint: NumberTransform,
    /// Motion in the joint frame.
    pub motion: Motion,
    /// Its coordinate by index.
    pub coordinate: u32,
}

/// A rigid body fixed in a link or in the world.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Body {
    /// Name.
    pub name: String,
    /// Where it is declared, `file.hdl:line`; empty if unknown.
    pub source: String,
    /// The link that carries it; `None` is the world.
    pub link: Option<u32>,
    /// Mass (kg).
    pub mass: Number,
    /// Centre of mass in link axes (m).
    pub center: NumberVector,
    /// Inertia about the centre in link axes: xx yy zz xy xz yz (kg·m²).
    pub inertia: [Number; 6],
}

/// A named frame.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Frame {
    /// Name.
    pub name: String,
    /// The link it is fixed in; `None` is the world.
    pub link: Option<u32>,
    /// Constant transform `link_from_frame`.
    pub link_from_frame: NumberTransform,
}

/// A point fixed in a link.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Point {
    /// The link; `None` is the world.
    pub link: Option<u32>,
    /// Position in link axes (m).
    pub position: NumberVector,
}

/// The form of a surface that a strand wraps.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum SurfaceForm {
    /// A sphere about its centre.
    Sphere,
    /// A cylinder without ends about an axis through its centre.
    Cylinder {
        /// Unit axis in link axes.
        axis: NumberVector,
    },
}

/// A surface that a strand wraps on its way from one point to the next.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Wrap {
    /// Name of the frame that it stands in.
    pub frame: String,
    /// Where it is written, `file.hdl:line`; empty if unknown.
    pub source: String,
    /// Number of the strand's point before it; the next one stands behind it.
    pub gap: u32,
    /// Its form.
    pub form: SurfaceForm,
    /// Its centre.
    pub center: Point,
    /// Radius (m).
    pub radius: Number,
    /// Unit vector from the centre to the side on which the strand passes, in link axes; `None`: the
    /// shorter way.
    pub side: Option<NumberVector>,
    /// Unit normal, in link axes, of the plane through the centre of a sphere in which its strand
    /// stays, so that it has a side; `None` for other spheres and for cylinders.
    pub plane: Option<NumberVector>,
}

/// How a strand's tension follows from its length x and natural length x₀.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub enum Law {
    /// V = ½k(x − x₀)².
    Linear {
        /// Stiffness k (N/m).
        stiffness: Number,
    },
    /// V(x, x₀): outputs V, ∂V/∂x and ∂²V/∂x² over [`Own`] and parameters.
    Energy(Program),
    /// A commanded tension; its gradient is by the strand's own length and rate, by coordinates
    /// and by rates.
    Tension(Function),
    /// None: a constraint prescribes the length, and its multiplier is the tension.
    Prescribed,
    /// That of a muscle's tendon.
    Muscle(Box<Muscle>),
}

/// The numbers of a muscle; see [`crate::muscle`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Muscle {
    /// Coordinate of the length of its fibres along the tendon.
    pub fibre: u32,
    /// Coordinate of its activation.
    pub activation: u32,
    /// Input of its excitation.
    pub excitation: u32,
    /// Activation at the start; `None`: the excitation there.
    pub start: Option<Number>,
    /// Largest isometric force (N).
    pub max_force: Number,
    /// Fibre length at which it is reached (m).
    pub optimal_fibre: Number,
    /// Slack length of the tendon (m).
    pub tendon_slack: Number,
    /// Angle of the fibres to the tendon at their optimal length (rad).
    pub pennation: Number,
    /// Largest velocity of shortening, in optimal fibre lengths (1/s).
    pub max_velocity: Number,
    /// Strain of the tendon at the largest isometric force.
    pub tendon_strain: Number,
    /// Strain at which passive fibres pull as much.
    pub passive_strain: Number,
    /// Largest force of lengthening fibres, in parts of the isometric one.
    pub eccentric_force: Number,
    /// Damping of the fibres, in parts of the largest force at the largest velocity.
    pub fibre_damping: Number,
    /// Time constant of activation (s).
    pub activation_time: Number,
    /// Time constant of deactivation (s).
    pub deactivation_time: Number,
}

impl Muscle {
    /// All its numbers, in a fixed order.
    pub fn numbers_mut(&mut self) -> [&mut Number; 11] {
        [
            &mut self.max_force,
            &mut self.optimal_fibre,
            &mut self.tendon_slack,
            &mut self.pennation,
            &mut self.max_velocity,
            &mut self.tendon_strain,
            &mut self.passive_strain,
            &mut self.eccentric_force,
            &mut self.fibre_damping,
            &mut self.activation_time,
            &mut self.deactivation_time,
        ]
    }
}

/// Friction of a strand that slides over its points (Euler and Eytelwein): across a point where it
/// bends by θ the tension falls by exp(−μθ) against the way it slides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Friction {
    /// Coefficient μ.
    pub coefficient: Number,
    /// Speed (m/s) at which most of the friction is felt: the sign of sliding is smooth below it.
    pub speed: Number,
}

/// An elastic path; its length x is that of the way from point to point, over the surfaces between
/// them.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Strand {
    /// Name.
    pub name: String,
    /// Where it is declared, `file.hdl:line`; empty if unknown.
    pub source: String,
    /// Doc comment.
    pub doc: String,
    /// Points in order.
    pub points: Vec<Point>,
    /// Surfaces wrapped, in order, at most one between two points.
    pub wraps: Vec<Wrap>,
    /// Its tension.
    pub law: Law,
    /// Coefficient c of the damping force −c·ẋ along the strand (N·s/m).
    pub damping: Number,
    /// Width (m) over which it goes slack; `None` for one that can push.
    pub slack: Option<Number>,
    /// Whether the joints that it spans balance at every step, their inertia left out.
    pub quasi_static: bool,
    /// Friction where it slides over its points, if any.
    pub friction: Option<Friction>,
    /// Natural length as a function of time, parameters and inputs; `None`: the length at the start.
    /// Of a prescribed strand, the length that it is to have.
    pub rest: Option<Program>,
    /// The input that is its natural length where that is not left out, if it has one.
    pub actuator: Option<u32>,
}

impl Strand {
    /// Whether its tension depends on the rate of its length.
    pub fn has_rate(&self) -> bool {
        let in_law = match &self.law {
            Law::Tension(function) => function.gradient.contains(&Variable::Own(Own::Rate)),
            _ => false,
        };
        in_law || !self.damping.is_zero() || self.friction.is_some()
    }
}

/// What and where it is, as a message says it.
impl fmt::Display for Wrap {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let form = match self.form {
            SurfaceForm::Sphere => "sphere",
            SurfaceForm::Cylinder { .. } => "cylinder",
        };
        write!(f, "{form} in `{}`", self.frame)?;
        match self.source.as_str() {
            "" => Ok(()),
            source => write!(f, " ({source})"),
        }
    }
}

impl Wrap {
    /// Whether it is a cylinder.
    pub fn is_cylinder(&self) -> bool {
        matches!(self.form, SurfaceForm::Cylinder { .. })
    }
}

impl Strand {
    /// The muscle that it is, if it is one.
    pub fn muscle(&self) -> Option<&Muscle> {
        match &self.law {
            Law::Muscle(muscle) => Some(muscle),
            _ => None,
        }
    }
    /// The surface between point `gap` and the next, if there is one.
    pub fn wrap(&self, gap: usize) -> Option<&Wrap> {
        self.wraps.iter().find(|wrap| wrap.gap as usize == gap)
    }
}

/// The form of a constraint.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
// A model has few constraints; a box would only hide the numbers of a weld.
#[allow(missing_docs, clippy::large_enum_variant)]
pub enum ConstraintKind {
    /// p₁ − p₂ in world axes, one row per axis that is true.
    Coincident { first: Point, second: Point, axes: [bool; 3] },
    /// ‖p₁ − p₂‖² − d².
    Distance { first: Point, second: Point, distance: Number },
    /// n·(p − c) with n and c fixed in a link.
    OnPlane { point: Point, through: Point, normal: NumberVector },
    /// p₁ − p₂ in world axes, then x₁·y₂, y₁·z₂, z₁·x₂.
    Weld {
        first: Option<u32>,
        first_from_frame: NumberTransform,
        second: Option<u32>,
        second_from_frame: NumberTransform,
    },
    /// A function of coordinates, lengths, parameters and time.
    Equation(Function),
    /// Length of a strand by index, less the one that is prescribed.
    Length(u32),
}

/// A holonomic constraint.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Constraint {
    /// Name.
    pub name: String,
    /// Where it is declared, `file.hdl:line`; empty if unknown.
    pub source: String,
    /// Form.
    pub kind: ConstraintKind,
}

impl Constraint {
    /// Names of its rows: empty for a single row, else `.x`, `.xy`, ….
    pub fn row_suffixes(&self) -> Vec<&'static str> {
        match &self.kind {
            ConstraintKind::Coincident { axes, .. } => [".x", ".y", ".z"]
                .into_iter()
                .zip(axes)
                .filter_map(|(name, held)| held.then_some(name))
                .collect(),
            ConstraintKind::Weld { .. } => vec![".x", ".y", ".z", ".xy", ".yz", ".zx"],
            _ => vec![""],
        }
    }
}

/// A generalized force on one coordinate.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Torque {
    /// Name.
    pub name: String,
    /// Where it is declared, `file.hdl:line`; empty if unknown.
    pub source: String,
    /// The coordinate by index.
    pub coordinate: u32,
    /// Its value (N·m or N).
    pub value: Function,
}

/// A force at a point.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Force {
    /// Name.
    pub name: String,
    /// Where it is declared, `file.hdl:line`; empty if unknown.
    pub source: String,
    /// Where it acts.
    pub point: Point,
    /// Components (N) in the axes of the link `axes`.
    pub value: [Function; 3],
    /// The link whose axes the components refer to; `None` is the world.
    pub axes: Option<u32>,
}

/// An experiment.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Scenario {
    /// Name.
    pub name: String,
    /// Doc comment.
    pub doc: String,
    /// Step (s).
    pub step: Option<Number>,
    /// Duration (s).
    pub duration: Option<Number>,
    /// Relative tolerance.
    pub tolerance: Option<Number>,
    /// Parameters set.
    pub set: Vec<(u32, Number)>,
    /// Starts overridden, by coordinate.
    pub start: Vec<(u32, Number)>,
    /// Initial rates overridden, by coordinate.
    pub velocity: Vec<(u32, Number)>,
    /// Inputs as functions of time and parameters.
    pub inputs: Vec<(u32, Program)>,
    /// Coordinates driven, as functions of time and parameters.
    pub drives: Vec<(u32, Program)>,
    /// Lengths prescribed for strands, as functions of time and parameters.
    pub lengths: Vec<(u32, Program)>,
    /// Poses: name, and the values that differ from the start.
    pub poses: Vec<(String, Vec<(u32, Number)>)>,
    /// Motions: name, and pose and time of each knot.
    pub motions: Vec<(String, Vec<(u32, Number)>)>,
    /// Which strands' natural lengths follow which motion.
    pub follow: Vec<(u32, Vec<u32>)>,
    /// Extra columns.
    pub records: Vec<(String, Program)>,
}

/// A number that depends on parameters and must lie in a range when a run begins.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Requirement {
    /// What must be.
    pub text: String,
    /// `file:line` where the number is written.
    pub source: String,
    /// The number.
    pub number: Number,
    /// Least value that is allowed.
    pub least: f64,
    /// Largest.
    pub most: f64,
}

impl Requirement {
    /// Whether another is about the same number and range.
    pub fn is_as(&self, other: &Self) -> bool {
        (self.number, self.least, self.most) == (other.number, other.least, other.most)
    }
}

/// A whole model as constant data.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
pub struct Mechanism {
    /// Name.
    pub name: String,
    /// Doc comment.
    pub doc: String,
    /// Parameters.
    pub params: Vec<Param>,
    /// Numbers that depend on parameters; read by [`Number::Value`].
    pub values: Program,
    /// Inputs.
    pub inputs: Vec<Input>,
    /// Gravity in world axes (m/s²).
    pub gravity: NumberVector,
    /// Coordinates in declaration order.
    pub coordinates: Vec<Coordinate>,
    /// Links, parents first; one for every coordinate but those of muscles.
    pub links: Vec<Link>,
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Named frames.
    pub frames: Vec<Frame>,
    /// Strands.
    pub strands: Vec<Strand>,
    /// Constraints.
    pub constraints: Vec<Constraint>,
    /// Torques.
    pub torques: Vec<Torque>,
    /// Forces.
    pub forces: Vec<Force>,
    /// Scenarios.
    pub scenarios: Vec<Scenario>,
    /// Ranges of numbers that depend on parameters.
    pub requirements: Vec<Requirement>,
}
