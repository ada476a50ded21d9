//! The graph of the current thread and the scope that gives it its life.

use super::node::Node;
use super::origin::{Labels, Origin};
use super::symbol::Sym;
use std::cell::RefCell;
use std::collections::HashMap;

/// Nodes in order of creation, each once.
#[derive(Default)]
pub(super) struct Graph {
    pub(super) nodes: Vec<Node>,
    pub(super) origins: Vec<Origin>,
    pub(super) labels: Labels,
    index: HashMap<Node, Sym>,
}

impl Graph {
    /// The handle of `node`, which is added if it is new.
    pub(super) fn intern(&mut self, node: Node) -> Sym {
        if let Some(&found) = self.index.get(&node) {
            return found;
        }
        let symbol = Sym::new(self.nodes.len());
        self.nodes.push(node);
        self.origins.push(self.labels.current);
        self.index.insert(node, symbol);
        symbol
    }

    /// The handle of `node` if it exists already.
    pub(super) fn find(&self, node: &Node) -> Option<Sym> {
        self.index.get(node).copied()
    }

    /// The node behind a handle.
    pub(super) fn node(&self, symbol: Sym) -> Node {
        self.nodes[symbol.index()]
    }
}

thread_local! {
    static GRAPH: RefCell<Graph> = RefCell::default();
}

/// Gives access to the current graph; not reentrant.
pub(super) fn with<R>(action: impl FnOnce(&mut Graph) -> R) -> R {
    GRAPH.with(|graph| action(&mut graph.borrow_mut()))
}

/// Runs `action` on a new, empty graph of this thread and drops that graph afterwards.
///
/// Scopes nest; a symbol must not leave the scope that made it.
pub fn with_new<R>(action: impl FnOnce() -> R) -> R {
    /// Puts the outer graph back even when `action` panics.
    struct Restore(Option<Graph>);
    impl Drop for Restore {
        fn drop(&mut self) {
            let outer = self.0.take().unwrap_or_default();
            GRAPH.with(|graph| *graph.borrow_mut() = outer);
        }
    }
    let _restore = Restore(Some(GRAPH.take()));
    action()
}

/// The node behind a handle.
pub fn node(symbol: Sym) -> Node {
    with(|graph| graph.node(symbol))
}

/// How many nodes the current graph holds.
pub fn node_count() -> usize {
    with(|graph| graph.nodes.len())
}
