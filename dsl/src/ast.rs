//! The syntax tree: what a file says, before any name means anything.
//!
//! It is close to the text: dotted names are not resolved, units are not applied and options of a
//! block stand in the order written. Every node has its span. Anything the parser could not read is
//! a [`DeclKind::Broken`], so that the names it would have declared are known to be missing.

use crate::source::Span;
use serde::Serialize;

/// One word with its place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Ident {
    /// The word.
    pub text: String,
    /// Its place.
    pub span: Span,
}

/// A dotted name such as `index.mcp`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Path {
    /// One or more words.
    pub parts: Vec<Ident>,
    /// The whole name.
    pub span: Span,
}

/// One factor of a unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnitFactor {
    /// Its name.
    pub name: Ident,
    /// Its power; negative behind `/`.
    pub exponent: i32,
}

/// A unit such as `N*m*s/rad`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UnitExpr {
    /// Factors in order.
    pub factors: Vec<UnitFactor>,
    /// The whole unit.
    pub span: Span,
}

/// An expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Expr {
    /// Its form.
    pub kind: ExprKind,
    /// Its place.
    pub span: Span,
}

/// Operators of two operands, comparisons included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[allow(missing_docs)]
pub enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

/// The forms of an expression.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum ExprKind {
    /// A number without its unit.
    Number(f64),
    /// A name.
    Path(Path),
    /// `(e)`, kept since a unit may follow it.
    Paren(Box<Expr>),
    /// `(a, b, …)`.
    Tuple(Vec<Expr>),
    /// A number, tuple or parenthesis followed by a unit.
    WithUnit(Box<Expr>, UnitExpr),
    /// `-e`.
    Neg(Box<Expr>),
    /// `a op b`.
    Binary(Operator, Box<Expr>, Box<Expr>),
    /// `f(a, …)`.
    Call(Ident, Vec<Expr>),
}

/// `FRAME [offset]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// The frame.
    pub frame: Path,
    /// Where in the frame; its origin if left out.
    pub offset: Option<Expr>,
    /// The whole point.
    pub span: Span,
}

/// `rotate AXIS angle`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rotation {
    /// The axis: `x`, `y`, `z` or a tuple.
    pub axis: Expr,
    /// The angle.
    pub angle: Expr,
}

/// `in F [at v] [rotate …]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Placement {
    /// The parent.
    pub parent: Path,
    /// The translation.
    pub at: Option<Expr>,
    /// Rotations in order.
    pub rotations: Vec<Rotation>,
}

/// `name = value`, as an option of a block, an argument, or a setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// What is set.
    pub name: Path,
    /// Its value.
    pub value: Expr,
    /// The whole.
    pub span: Span,
}

/// An argument, named or by position.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Argument {
    /// Its name, if given.
    pub name: Option<Ident>,
    /// Its value.
    pub value: Expr,
}

/// A block of options `{ name = value; … }`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Block {
    /// The options that could be read.
    pub settings: Vec<Setting>,
    /// Whether some could not: then nothing is reported as missing.
    pub broken: bool,
}

/// `via wrap SURFACE(FRAME [offset], radius = e, …)`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Wrap {
    /// The surface: `sphere` or `cylinder`.
    pub surface: Ident,
    /// Where it stands.
    pub center: Point,
    /// What else is said of it.
    pub options: Vec<Argument>,
    /// The whole.
    pub span: Span,
}

/// What a path runs through.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Station {
    /// A point.
    Point(Point),
    /// A surface.
    Wrap(Wrap),
}

/// An option of a strand's block.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathOption {
    /// Points and surfaces in order.
    pub stations: Vec<Station>,
    /// The statement.
    pub span: Span,
}

/// The shape of a mass: `= capsule { … }`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// Its name.
    pub name: Ident,
}

/// The right side of a constraint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum ConstraintKind {
    /// `coincident(P, P [, axes = (x, z)])`.
    Coincident(Point, Point, Option<Expr>),
    /// `distance(P, P) = d`.
    Distance(Point, Point, Expr),
    /// `on_plane(P, F, normal = v [, through = v])`.
    OnPlane(Point, Path, Vec<Argument>),
    /// `weld(F, F)`.
    Weld(Path, Path),
    /// `left == right`.
    Equation(Expr, Expr),
}

/// A parameter of a component.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: Ident,
    /// `Length`, or a unit.
    pub dimension: UnitExpr,
    /// Its default.
    pub default: Option<Expr>,
}

/// A reusable subtree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Component {
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// Its declarations.
    pub body: Vec<Decl>,
}

/// A statement of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statement {
    /// `///` lines above it.
    pub doc: String,
    /// What it says.
    pub kind: StatementKind,
    /// The whole statement.
    pub span: Span,
}

/// The statements of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum StatementKind {
    /// `step = e`, `duration = e`, `tolerance = e`, or an unknown setting.
    Setting(Setting),
    /// `set PARAM = e`.
    Set(Setting),
    /// `start JOINT = e`.
    Start(Setting),
    /// `velocity JOINT = e`.
    Velocity(Setting),
    /// `input N = e`.
    Input(Setting),
    /// `drive JOINT = e`.
    Drive(Setting),
    /// `pose P { JOINT = e; … }`.
    Pose(Ident, Block),
    /// `motion [M] = P @ t -> …`.
    Motion(Ident, Vec<(Ident, Expr)>),
    /// `follow M [with S, …]`; no list means every strand.
    Follow(Ident, Option<Vec<Path>>),
    /// `record e as NAME`.
    Record(Expr, Ident),
    /// Could not be read; the name it would have declared, if one stands there.
    Broken(Option<Ident>),
}

/// A declaration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decl {
    /// `///` lines above it.
    pub doc: String,
    /// The name it declares; `gravity` and `import` stand for themselves.
    pub name: Ident,
    /// What it declares.
    pub kind: DeclKind,
    /// From its first word to the end of its head.
    pub span: Span,
}

/// The declarations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum DeclKind {
    /// `import "file";`
    Import(String),
    /// `model N { … }`
    Model(Vec<Decl>),
    /// `component N(…) { … }`
    Component(Component),
    /// `const N = e;`
    Const(Expr),
    /// `param N = e;`
    Param(Expr),
    /// `input N = e;`
    Input(Expr),
    /// `gravity = v;`
    Gravity(Expr),
    /// `frame N in F …;`
    Frame(Placement),
    /// `joint N: KIND in F … { … }`
    Joint(Ident, Vec<Argument>, Placement, Block),
    /// `mass N in F [= shape] { … }`
    Mass(Path, Option<Shape>, Block),
    /// `strand N { … }`
    Strand(Vec<PathOption>, Block),
    /// `node N at v in F { … }`
    Node(Placement, Block),
    /// `constraint N: …;`
    Constraint(ConstraintKind),
    /// `torque N on JOINT = e;`
    Torque(Path, Expr),
    /// `force N at P = v [in FRAME];`
    Force(Point, Expr, Option<Path>),
    /// `place C(…) as N in F …;`
    Place(Ident, Vec<Argument>, Placement),
    /// `scenario N { … }`
    Scenario(Vec<Statement>),
    /// Could not be read.
    Broken,
}

/// A whole file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct File {
    /// Its declarations.
    pub items: Vec<Decl>,
}
