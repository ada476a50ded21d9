//! Syntax trees to the checked model.
//!
//! First every body is walked once ([`scope`]): instances are opened and each name is entered with
//! what it stands for, so the order of declarations never matters. Then frames are ordered, and each
//! declaration is checked by the module of its kind. A function that answers `None` has reported why,
//! or met something that was reported before: callers stay silent.

mod argument;
mod constraint;
mod coordinate;
mod depend;
mod expect;
mod expr;
mod fold;
mod frame;
mod function;
mod instance;
mod joint;
mod load;
mod mass;
mod motion;
mod muscle;
mod name;
mod node;
mod options;
mod path;
mod range;
mod refer;
mod scenario;
mod scope;
mod strand;
mod value;

use crate::ast;
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{self, ExprKind, FrameId, Model};
use crate::source::{SourceMap, Span};
use instance::{ComponentId, Env};
use scope::{Scope, ScopeId};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// What to check: the files read, and what each sees.
pub(crate) struct Program<'a> {
    /// The model's declaration.
    pub(crate) model: Option<&'a ast::Decl>,
    /// Scenarios that stand beside the model.
    pub(crate) scenarios: Vec<&'a ast::Decl>,
    /// Components of all files.
    pub(crate) components: Vec<FileComponents<'a>>,
    /// Texts, to quote from.
    pub(crate) sources: &'a SourceMap,
}

/// The components one file declares and the files whose components it sees.
pub(crate) struct FileComponents<'a> {
    pub(crate) declared: Vec<&'a ast::Decl>,
    /// Indices into [`Program::components`].
    pub(crate) visible: Vec<usize>,
}

/// A value: one number or a vector.
#[derive(Clone, Debug)]
enum Value {
    Scalar(hir::Expr),
    Vector(Vec<hir::Expr>),
}

/// How far the lazy evaluation of a named value has come.
#[derive(Clone, Debug)]
enum State {
    Pending,
    Busy,
    Done(Option<Value>),
}

/// A declaration with the scope it stands in.
struct Item<'a> {
    scope: ScopeId,
    decl: &'a ast::Decl,
    name: hir::Name,
}

/// A `const`, `param`, `input`, or an argument of an instance.
struct Named<'a> {
    scope: ScopeId,
    name: hir::Name,
    /// What it is computed from; nothing where an argument is missing.
    value: Option<&'a ast::Expr>,
    /// Declared dimension and whether it was given, for arguments.
    dimension: Option<Dimension>,
    state: State,
}

struct RawFrame<'a> {
    scope: ScopeId,
    name: hir::Name,
    /// How it stands in its parent; `None` for `world`.
    placement: Option<&'a ast::Placement>,
    joint: Option<usize>,
}

struct RawJoint<'a> {
    item: Item<'a>,
    /// `None` if the kind is not known.
    kind: Option<hir::JointKind>,
    frame: usize,
    coordinates: std::ops::Range<usize>,
}

struct Checker<'a> {
    sources: &'a SourceMap,
    out: Vec<Diagnostic>,
    scopes: Vec<Scope<'a>>,
    components: Vec<instance::Definition<'a>>,
    placed: BTreeSet<ComponentId>,
    taken: scope::Taken,
    consts: Vec<Named<'a>>,
    params: Vec<Named<'a>>,
    inputs: Vec<Named<'a>>,
    arguments: Vec<Named<'a>>,
    frames: Vec<RawFrame<'a>>,
    frame_ids: Vec<FrameId>,
    joints: Vec<RawJoint<'a>>,
    coordinate_names: Vec<String>,
    masses: Vec<Item<'a>>,
    strands: Vec<Item<'a>>,
    constraints: Vec<Item<'a>>,
    torques: Vec<Item<'a>>,
    forces: Vec<Item<'a>>,
    /// Strands whose length is prescribed, and the constraints that do so.
    prescribed: Vec<(usize, usize)>,
    /// Strands with an input of their own, and the input.
    actuators: Vec<(usize, usize)>,
    /// Strands that are muscles.
    muscles: Vec<muscle::RawMuscle>,
    requirements: Vec<hir::Requirement>,
    /// Positions of nodes in their frames, by joint.
    node_positions: BTreeMap<usize, hir::Vector>,
    /// Whether an expression is part of a strand's law, where `x` is its length.
    in_law: bool,
    gravity: Vec<&'a ast::Decl>,
    scenarios: Vec<&'a ast::Decl>,
    param_values: Vec<f64>,
    /// Depth of the evaluation under way.
    depth: usize,
    /// Declarations walked, over all instances.
    walked: usize,
}

/// Checks a program; a model comes out whenever one was declared, even with errors.
pub(crate) fn check(program: &Program<'_>, out: &mut Vec<Diagnostic>) -> Option<Model> {
    let mut checker = Checker::new(program.sources);
    let env = checker.define(program);
    let model = program.model.and_then(|decl| checker.model(decl, &program.scenarios, &env));
    let mut placed = std::mem::take(&mut checker.placed);
    out.append(&mut checker.out);
    // What stands in a component that is never placed is checked too, with arguments of any value.
    for id in 0..checker.components.len() {
        if placed.contains(&ComponentId(id)) {
            continue;
        }
        let mut probe = Checker::new(program.sources);
        probe.components.clone_from(&checker.components);
        probe.probe(ComponentId(id));
        placed.append(&mut probe.placed);
        out.append(&mut probe.out);
    }
    model
}

impl<'a> Checker<'a> {
    fn new(sources: &'a SourceMap) -> Checker<'a> {
        Checker {
            sources,
            out: Vec::new(),
            scopes: Vec::new(),
            components: Vec::new(),
            placed: BTreeSet::new(),
            taken: scope::Taken::default(),
            consts: Vec::new(),
            params: Vec::new(),
            inputs: Vec::new(),
            arguments: Vec::new(),
            frames: Vec::new(),
            frame_ids: Vec::new(),
            joints: Vec::new(),
            coordinate_names: Vec::new(),
            masses: Vec::new(),
            strands: Vec::new(),
            constraints: Vec::new(),
            torques: Vec::new(),
            forces: Vec::new(),
            prescribed: Vec::new(),
            actuators: Vec::new(),
            muscles: Vec::new(),
            requirements: Vec::new(),
            node_positions: BTreeMap::new(),
            in_law: false,
            gravity: Vec::new(),
            scenarios: Vec::new(),
            param_values: Vec::new(),
            depth: 0,
            walked: 0,
        }
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.out.push(diagnostic);
    }

    fn world(&mut self, span: Span) {
        let name = hir::Name { text: "world".into(), doc: String::new(), span };
        self.frames.push(RawFrame { scope: ScopeId(0), name, placement: None, joint: None });
    }

    fn model(
        &mut self,
        decl: &'a ast::Decl,
        beside: &[&'a ast::Decl],
        env: &Rc<Env>,
    ) -> Option<Model> {
        let ast::DeclKind::Model(body) = &decl.kind else { return None };
        self.world(decl.name.span);
        let root = self.open(String::new(), None, None);
        self.walk(root, body, env, &mut Vec::new());
        self.scenarios.extend(beside);
        Some(self.finish(decl, root))
    }

    /// Checks a component by itself.
    fn probe(&mut self, id: ComponentId) {
        let decl = self.components[id.0].decl;
        self.world(decl.name.span);
        let root = self.open(String::new(), None, None);
        self.probe_instance(root, id);
        self.finish(decl, root);
    }

    /// Checks everything that was walked.
    fn finish(&mut self, decl: &'a ast::Decl, root: ScopeId) -> Model {
        let name =
            hir::Name { text: decl.name.text.clone(), doc: decl.doc.clone(), span: decl.name.span };
        let consts = self.finish_consts();
        let params = self.finish_params();
        let inputs = self.finish_inputs();
        self.finish_arguments();
        let order = self.order_frames();
        let gravity = self.finish_gravity(root, decl.name.span);
        let frames = self.finish_frames(&order);
        let (joints, coordinates) = self.finish_joints();
        let mut masses = self.finish_masses();
        masses.extend(self.finish_node_masses());
        let strands = self.finish_strands();
        let coordinates = in_order(coordinates, self.muscle_coordinates());
        let constraints = self.finish_constraints();
        let torques = self.finish_torques();
        let forces = self.finish_forces();
        let scenarios = self.finish_scenarios(root);
        Model {
            name,
            consts,
            params,
            inputs,
            gravity,
            frames,
            joints,
            coordinates,
            masses,
            strands,
            constraints,
            torques,
            forces,
            scenarios,
            requirements: std::mem::take(&mut self.requirements),
        }
    }

    fn finish_gravity(&mut self, root: ScopeId, span: Span) -> hir::Vector {
        let mut declared = std::mem::take(&mut self.gravity).into_iter();
        let first = declared.next();
        for again in declared {
            let first = first.map_or(again.span, |d| d.span);
            self.report(
                Diagnostic::error("duplicate", again.span, "gravity is given twice")
                    .also(first, "first given here"),
            );
        }
        let given = first.and_then(|decl| match &decl.kind {
            ast::DeclKind::Gravity(value) => {
                self.vector(root, value, Dimension::ACCELERATION, "gravity", depend::May::PARAMS)
            }
            _ => None,
        });
        given.unwrap_or_else(|| zero_vector(Dimension::ACCELERATION, span))
    }
}

/// All coordinates in the order in which they were entered.
fn in_order(
    of_joints: Vec<(usize, hir::Coordinate)>,
    of_muscles: Vec<(usize, hir::Coordinate)>,
) -> Vec<hir::Coordinate> {
    let mut all = of_joints;
    all.extend(of_muscles);
    all.sort_by_key(|(index, _)| *index);
    all.into_iter().map(|(_, coordinate)| coordinate).collect()
}

/// A constant.
fn number(value: f64, dimension: Dimension, span: Span) -> hir::Expr {
    hir::Expr { kind: ExprKind::Number(value), dimension, span }
}

fn zero_vector(dimension: Dimension, span: Span) -> hir::Vector {
    std::array::from_fn(|_| number(0.0, dimension, span))
}

/// The value of a constant.
fn constant(expr: &hir::Expr) -> Option<f64> {
    match expr.kind {
        ExprKind::Number(value) => Some(value),
        _ => None,
    }
}
