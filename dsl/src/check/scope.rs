//! Bodies walked once: instances opened, names entered.

use super::instance::{ComponentId, Definition, Env};
use super::{Checker, Item, Named, RawFrame, RawJoint, State};
use crate::ast::{self, Decl, DeclKind};
use crate::diagnostic::Diagnostic;
use crate::hir::{JointKind, Name};
use crate::source::Span;
use crate::suggest::nearest;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Most declarations of a model, over all instances.
const MAX_WALKED: usize = 200_000;

/// Index of a scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ScopeId(pub(super) usize);

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Entry {
    Const(usize),
    Param(usize),
    Input(usize),
    Argument(usize),
    Frame(usize),
    Joint(usize),
    Instance(ScopeId),
    Strand(usize),
    Constraint(usize),
    /// Declared, but not readable: what depends on it is not reported.
    Broken,
}

/// The names of the model or of one instance.
pub(super) struct Scope<'a> {
    /// `index.` or nothing.
    pub(super) prefix: String,
    /// Where the instance is placed.
    pub(super) outer: Option<ScopeId>,
    /// Frame of the instance's `base`.
    pub(super) base: Option<usize>,
    pub(super) names: BTreeMap<&'a str, Entry>,
    pub(super) constraints: BTreeMap<&'a str, Entry>,
}

/// Names already taken. What an expression or a frame position can mean is one space; masses,
/// loads and constraints are never mistaken for these and have spaces of their own.
#[derive(Default)]
pub(super) struct Taken(BTreeMap<(&'static str, String), Span>);

impl<'a> Checker<'a> {
    pub(super) fn open(
        &mut self,
        prefix: String,
        outer: Option<ScopeId>,
        base: Option<usize>,
    ) -> ScopeId {
        let (names, constraints) = (BTreeMap::new(), BTreeMap::new());
        self.scopes.push(Scope { prefix, outer, base, names, constraints });
        ScopeId(self.scopes.len() - 1)
    }

    /// Enters the declarations of a body; `inside` are the components being placed.
    pub(super) fn walk(
        &mut self,
        scope: ScopeId,
        body: &'a [Decl],
        env: &Rc<Env>,
        inside: &mut Vec<ComponentId>,
    ) {
        let nested: Vec<&Decl> =
            body.iter().filter(|d| matches!(d.kind, DeclKind::Component(_))).collect();
        let mut own = env.clone();
        if !nested.is_empty() {
            let mut names = BTreeMap::new();
            let from = self.components.len();
            for decl in nested {
                self.components.push(Definition { decl, env: env.clone() });
                self.define_name(&mut names, ComponentId(self.components.len() - 1));
            }
            own = Rc::new(Env { names, outer: Some(env.clone()) });
            for definition in &mut self.components[from..] {
                definition.env = own.clone();
            }
        }
        for decl in body {
            self.walked += 1;
            if self.walked == MAX_WALKED {
                let message = format!("the model has more than {MAX_WALKED} declarations");
                self.report(Diagnostic::error("too-large", decl.span, message));
            }
            if self.walked >= MAX_WALKED {
                return;
            }
            self.enter(scope, decl, &own, inside);
        }
    }

    fn enter(
        &mut self,
        scope: ScopeId,
        decl: &'a Decl,
        env: &Rc<Env>,
        inside: &mut Vec<ComponentId>,
    ) {
        let name = self.full_name(scope, decl);
        let item = Item { scope, decl, name: name.clone() };
        let named = |value: &'a ast::Expr| Named {
            scope,
            name: name.clone(),
            value: Some(value),
            dimension: None,
            state: State::Pending,
        };
        let entry = match &decl.kind {
            DeclKind::Const(value) => {
                self.consts.push(named(value));
                Entry::Const(self.consts.len() - 1)
            }
            DeclKind::Param(value) => {
                self.params.push(named(value));
                Entry::Param(self.params.len() - 1)
            }
            DeclKind::Input(value) => {
                self.inputs.push(named(value));
                Entry::Input(self.inputs.len() - 1)
            }
            DeclKind::Frame(placement) => {
                self.frames.push(RawFrame { scope, name, placement: Some(placement), joint: None });
                Entry::Frame(self.frames.len() - 1)
            }
            DeclKind::Joint(kind, _, placement, _) => {
                self.enter_joint(scope, item, kind, placement)
            }
            DeclKind::Mass(..) => {
                self.take("mass", &name);
                return self.masses.push(item);
            }
            DeclKind::Torque(..) => {
                self.take("load", &name);
                return self.torques.push(item);
            }
            DeclKind::Force(..) => {
                self.take("load", &name);
                return self.forces.push(item);
            }
            DeclKind::Constraint(_) => {
                if self.take("constraint", &name) {
                    let entry = Entry::Constraint(self.constraints.len());
                    self.scopes[scope.0].constraints.insert(&decl.name.text, entry);
                }
                return self.constraints.push(item);
            }
            DeclKind::Strand(_, block) => {
                self.strands.push(item);
                self.enter_strand(scope, decl, name, block);
                Entry::Strand(self.strands.len() - 1)
            }
            DeclKind::Place(component, arguments, placement) => {
                match self.place(scope, item, component, arguments, placement, env, inside) {
                    Some(instance) => Entry::Instance(instance),
                    None => Entry::Broken,
                }
            }
            DeclKind::Node(placement, block) => self.enter_node(scope, item, placement, block),
            DeclKind::Component(_) | DeclKind::Import(_) => return,
            DeclKind::Broken => {
                if !decl.name.text.is_empty() {
                    let names = &mut self.scopes[scope.0];
                    names.names.entry(&decl.name.text).or_insert(Entry::Broken);
                    names.constraints.entry(&decl.name.text).or_insert(Entry::Broken);
                }
                return;
            }
            DeclKind::Gravity(_) | DeclKind::Scenario(_) if inside.is_empty() => {
                return match decl.kind {
                    DeclKind::Gravity(_) => self.gravity.push(decl),
                    _ => self.scenarios.push(decl),
                };
            }
            DeclKind::Gravity(_) | DeclKind::Scenario(_) | DeclKind::Model(_) => {
                let what = match decl.kind {
                    DeclKind::Gravity(_) => "`gravity`",
                    DeclKind::Scenario(_) => "a `scenario`",
                    _ => "a `model`",
                };
                let place = if inside.is_empty() { "a model" } else { "a component" };
                let message = format!("{what} cannot stand in {place}");
                return self.report(Diagnostic::error("misplaced", decl.span, message));
            }
        };
        if self.take(
            "name",
            &Name {
                text: self.full_name(scope, decl).text,
                doc: String::new(),
                span: decl.name.span,
            },
        ) {
            self.scopes[scope.0].names.insert(&decl.name.text, entry);
        }
    }

    fn full_name(&self, scope: ScopeId, decl: &Decl) -> Name {
        let text = format!("{}{}", self.scopes[scope.0].prefix, decl.name.text);
        Name { text, doc: decl.doc.clone(), span: decl.name.span }
    }

    /// Takes a name in a space; `false`, with a diagnostic, if it is taken.
    pub(super) fn take(&mut self, space: &'static str, name: &Name) -> bool {
        let key = (space, name.text.clone());
        let Some(&span) = self.taken.0.get(&key) else {
            self.taken.0.insert(key, name.span);
            return true;
        };
        let message = format!("the name `{}` is given twice", name.text);
        let mut error = Diagnostic::error("duplicate", name.span, message);
        if span != name.span {
            error = error.also(span, "first given here");
        }
        self.report(error);
        false
    }

    fn enter_joint(
        &mut self,
        scope: ScopeId,
        item: Item<'a>,
        kind: &'a ast::Ident,
        placement: &'a ast::Placement,
    ) -> Entry {
        let known = JOINT_KINDS.iter().find(|k| k.0 == kind.text);
        if known.is_none() {
            let names: Vec<&str> = JOINT_KINDS.iter().map(|k| k.0).collect();
            let message = format!("unknown kind of joint `{}`", kind.text);
            let help = match nearest(&kind.text, names.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known are {}", names.join(", ")),
            };
            self.report(Diagnostic::error("unknown-joint", kind.span, message).help(help));
        }
        let parts = known.map_or(&[] as &[&str], |k| k.2);
        self.enter_moving(scope, item, known.map(|k| k.1), parts, placement)
    }

    /// Enters a joint or a node with the coordinates that `parts` name.
    pub(super) fn enter_moving(
        &mut self,
        scope: ScopeId,
        item: Item<'a>,
        kind: Option<JointKind>,
        parts: &[&str],
        placement: &'a ast::Placement,
    ) -> Entry {
        let (index, name) = (self.joints.len(), item.name.clone());
        let first = self.coordinate_names.len();
        for part in parts {
            let text = match part.is_empty() {
                true => name.text.clone(),
                false => format!("{}.{part}", name.text),
            };
            if !part.is_empty() {
                self.take(
                    "name",
                    &Name { text: text.clone(), doc: String::new(), span: name.span },
                );
            }
            self.coordinate_names.push(text);
        }
        self.frames.push(RawFrame { scope, name, placement: Some(placement), joint: Some(index) });
        self.joints.push(RawJoint {
            item,
            kind,
            frame: self.frames.len() - 1,
            coordinates: first..first + parts.len(),
        });
        Entry::Joint(index)
    }
}

/// Kinds of joints with the parts of their coordinates.
#[rustfmt::skip]
pub(super) const JOINT_KINDS: [(&str, JointKind, &[&str]); 6] = [
    ("revolute", JointKind::Revolute, &[""]),
    ("prismatic", JointKind::Prismatic, &[""]),
    ("screw", JointKind::Screw, &[""]),
    ("universal", JointKind::Universal, &["a", "b"]),
    ("planar", JointKind::Planar, &["u", "v", "r"]),
    ("free", JointKind::Free, &["tx", "ty", "tz", "rx", "ry", "rz"]),
];
