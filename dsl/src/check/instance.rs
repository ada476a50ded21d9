//! Components: which a body sees, and their instances opened.

use super::scope::ScopeId;
use super::{Checker, Item, Program, RawFrame};
use crate::ast::{self, Decl, DeclKind};
use crate::diagnostic::Diagnostic;
use crate::hir::Name;
use crate::suggest::nearest;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Deepest nesting of instances.
const MAX_INSTANCES: usize = 64;

/// Index of a component's definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ComponentId(pub(super) usize);

/// A component and the components it sees.
#[derive(Clone)]
pub(super) struct Definition<'a> {
    pub(super) decl: &'a Decl,
    pub(super) env: Rc<Env>,
}

/// Components visible in a body; its own first, then those around it.
#[derive(Debug, Default)]
pub(super) struct Env {
    pub(super) names: BTreeMap<String, ComponentId>,
    pub(super) outer: Option<Rc<Env>>,
}

impl Env {
    fn find(&self, name: &str) -> Option<ComponentId> {
        match self.names.get(name) {
            Some(id) => Some(*id),
            None => self.outer.as_ref().and_then(|o| o.find(name)),
        }
    }

    fn all(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.names.keys().map(String::as_str).collect();
        if let Some(outer) = &self.outer {
            names.extend(outer.all());
        }
        names
    }
}

impl<'a> Checker<'a> {
    /// Registers the components of all files; answers what the first file sees.
    pub(super) fn define(&mut self, program: &Program<'a>) -> Rc<Env> {
        let mut ids: Vec<Vec<ComponentId>> = Vec::new();
        for file in &program.components {
            ids.push(
                file.declared
                    .iter()
                    .map(|decl| {
                        self.components.push(Definition { decl, env: Rc::default() });
                        ComponentId(self.components.len() - 1)
                    })
                    .collect(),
            );
        }
        let mut first = None;
        for (index, file) in program.components.iter().enumerate() {
            let mut names: BTreeMap<String, ComponentId> = BTreeMap::new();
            for &seen in std::iter::once(&index).chain(&file.visible) {
                for &id in &ids[seen] {
                    self.define_name(&mut names, id);
                }
            }
            let env = Rc::new(Env { names, outer: None });
            for id in &ids[index] {
                self.components[id.0].env = env.clone();
            }
            first.get_or_insert(env);
        }
        first.unwrap_or_default()
    }

    pub(super) fn define_name(
        &mut self,
        names: &mut BTreeMap<String, ComponentId>,
        id: ComponentId,
    ) {
        let name = &self.components[id.0].decl.name;
        match names.get(&name.text) {
            Some(&other) if other != id => {
                let first = self.components[other.0].decl.name.span;
                let message = format!("two components are called `{}`", name.text);
                let (a, b) = if name.span.file == first.file {
                    (name.span, first)
                } else {
                    (first, name.span)
                };
                self.report(Diagnostic::error("duplicate", a, message).also(b, "the other one"));
            }
            _ => {
                names.insert(name.text.clone(), id);
            }
        }
    }

    pub(super) fn place(
        &mut self,
        scope: ScopeId,
        item: Item<'a>,
        component: &'a ast::Ident,
        arguments: &'a [ast::Argument],
        placement: &'a ast::Placement,
        env: &Rc<Env>,
        inside: &mut Vec<ComponentId>,
    ) -> Option<ScopeId> {
        let Some(id) = env.find(&component.text) else {
            let message = format!("there is no component `{}`", component.text);
            let near = nearest(&component.text, env.all()).map(|n| format!("did you mean `{n}`?"));
            self.report(
                Diagnostic::error("unknown-component", component.span, message)
                    .help("declare it with `component`, or import the file that does")
                    .help_if(near),
            );
            return None;
        };
        self.placed.insert(id);
        if let Some(start) = inside.iter().position(|&i| i == id) {
            let mut chain: Vec<&str> =
                inside[start..].iter().map(|i| &*self.components[i.0].decl.name.text).collect();
            chain.push(&component.text);
            let message = format!("a component places itself: {}", chain.join(" -> "));
            self.report(Diagnostic::error("recursion", component.span, message));
            return None;
        }
        if inside.len() >= MAX_INSTANCES {
            let message = format!("components are placed more than {MAX_INSTANCES} deep");
            self.report(Diagnostic::error("too-deep", component.span, message));
            return None;
        }
        let base_name = Name { text: format!("{}.base", item.name.text), ..item.name.clone() };
        self.frames.push(RawFrame {
            scope,
            name: base_name,
            placement: Some(placement),
            joint: None,
        });
        let prefix = format!("{}.", item.name.text);
        let instance = self.open(prefix, Some(scope), Some(self.frames.len() - 1));
        self.bind_arguments(scope, instance, id, arguments, component.span);
        self.fill_instance(instance, id, inside);
        Some(instance)
    }

    fn fill_instance(&mut self, instance: ScopeId, id: ComponentId, inside: &mut Vec<ComponentId>) {
        let decl = self.components[id.0].decl;
        let env = self.components[id.0].env.clone();
        if let DeclKind::Component(component) = &decl.kind {
            inside.push(id);
            self.walk(instance, &component.body, &env, inside);
            inside.pop();
        }
    }

    /// Opens an instance whose arguments have no value, to check a component that is never placed.
    pub(super) fn probe_instance(&mut self, root: ScopeId, id: ComponentId) {
        self.placed.insert(id);
        let decl = self.components[id.0].decl;
        let name = Name { text: "base".into(), doc: String::new(), span: decl.name.span };
        self.frames.push(RawFrame { scope: root, name, placement: None, joint: None });
        let instance = self.open(String::new(), None, Some(1));
        self.bind_probe(instance, id);
        self.fill_instance(instance, id, &mut Vec::new());
    }
}
