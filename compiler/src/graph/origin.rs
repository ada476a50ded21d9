//! Where a node came from: the strand, joint or body whose equations first made it.
//!
//! Labels serve names and comments of generated code only; nothing is decided by them.

use super::arena;
use super::symbol::Sym;

/// A label by number; the default one is empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Origin(u32);

/// The labels of a graph and the one that new nodes get.
#[derive(Default)]
pub(super) struct Labels {
    texts: Vec<String>,
    pub(super) current: Origin,
}

impl Labels {
    /// The number of a label; the empty label is number zero.
    fn number(&mut self, text: &str) -> Origin {
        if text.is_empty() {
            return Origin::default();
        }
        // Labels are few and mostly repeat the last one, so that the search from behind is short.
        let position = self.texts.iter().rposition(|t| t == text).unwrap_or_else(|| {
            self.texts.push(text.to_owned());
            self.texts.len() - 1
        });
        Origin(position as u32 + 1)
    }

    fn text(&self, origin: Origin) -> &str {
        match origin.0 {
            0 => "",
            number => &self.texts[number as usize - 1],
        }
    }
}

/// Labels the nodes that `action` makes, e.g. `index.fdp`.
pub fn with_origin<R>(label: &str, action: impl FnOnce() -> R) -> R {
    /// Puts the outer label back even when `action` panics.
    struct Restore(Origin);
    impl Drop for Restore {
        fn drop(&mut self) {
            arena::with(|graph| graph.labels.current = self.0);
        }
    }
    let _restore = arena::with(|graph| {
        let origin = graph.labels.number(label);
        Restore(std::mem::replace(&mut graph.labels.current, origin))
    });
    action()
}

/// The origin of a node.
pub fn origin_of(symbol: Sym) -> Origin {
    arena::with(|graph| graph.origins[symbol.index()])
}

/// The text of a node's label, empty if it has none.
pub fn label_of(symbol: Sym) -> String {
    arena::with(|graph| graph.labels.text(graph.origins[symbol.index()]).to_owned())
}
