//! What becomes of each node: a variable, a part of its user's expression, or half of a fused
//! product and sum.

use super::code::Output;
use crate::graph::{Binary, Node, Sym, Unary, node, reachable};
use std::collections::{HashMap, HashSet};

/// Expressions with more operations than this are cut into variables, for the reader's sake.
const LARGEST_EXPRESSION: u32 = 5;

/// Products with more uses than this become variables rather than being fused in every use.
const MOST_FUSED_USES: usize = 2;

/// Facts about a node that is reachable from the outputs.
#[derive(Clone, Copy, Debug, Default)]
struct Facts {
    /// How many expressions read it; a negation's uses count for its operand.
    uses: u32,
    /// Operations written inside its own statement or expression.
    size: u32,
    /// Becomes a variable.
    named: bool,
    /// Written inside the sums that use it.
    fused: bool,
    /// Which operand of this sum or difference is a fused product, plus one.
    fuses: u8,
}

/// In which order results are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// One after the other.
    OutputByOutput,
    /// Side by side, as the mechanics adds its terms to them: see [`Plan::sums`].
    TermByTerm,
}

/// The decisions for one list of outputs.
#[derive(Debug, Default)]
pub struct Plan {
    nodes: Vec<Sym>,
    facts: HashMap<Sym, Facts>,
    /// Roots that are needed together with their reciprocals: the one for the other, both ways round.
    roots: HashMap<Sym, Sym>,
    /// Results and the partial sums that they are made of, in the order in which the mechanics made
    /// them, each with the first output that needs it.
    sums: Vec<(Sym, usize)>,
}

impl Plan {
    /// Decides for everything that `outputs` need, which are made in the given order.
    pub fn new(outputs: &[Output], order: Order) -> Plan {
        let values: Vec<Sym> = outputs.iter().map(|output| output.value).collect();
        let nodes = reachable(&values);
        let facts = nodes.iter().map(|&symbol| (symbol, Facts::default())).collect();
        let mut plan = Plan { nodes, facts, roots: HashMap::new(), sums: Vec::new() };
        plan.count_uses(&values);
        plan.find_roots();
        plan.fuse();
        if order == Order::TermByTerm {
            plan.find_sums(&values);
        }
        plan.choose_variables(&values);
        plan
    }

    /// The nodes it decides for, ascending.
    pub fn nodes(&self) -> &[Sym] {
        &self.nodes
    }

    /// Whether the node becomes a variable.
    pub fn is_variable(&self, symbol: Sym) -> bool {
        self.facts[&symbol].named
    }

    /// Whether the node is needed at all.
    pub fn is_needed(&self, symbol: Sym) -> bool {
        self.facts.contains_key(&symbol)
    }

    /// Which operand of this sum or difference is a product to be fused with it.
    pub fn fused_operand(&self, symbol: Sym) -> Option<usize> {
        (self.facts[&symbol].fuses as usize).checked_sub(1)
    }

    /// What is made in turn, each with the first output that needs it: results, and before them the
    /// partial sums that they are made of. Empty where it goes output by output.
    ///
    /// The mechanics goes from term to term and adds each to all results that it touches. In this order
    /// what belongs to one term, such as a strand, stands together, as a reader looks for it. For the
    /// compiler behind it the order makes no difference.
    pub fn sums(&self) -> &[(Sym, usize)] {
        &self.sums
    }

    /// The reciprocal that is made together with this root, or the root with this reciprocal.
    pub fn root_partner(&self, symbol: Sym) -> Option<Sym> {
        self.roots.get(&symbol).copied()
    }

    /// Whether this reciprocal is written as a division by its only user, a product.
    pub fn is_divisor(&self, symbol: Sym) -> bool {
        matches!(node(symbol), Node::Unary(Unary::Recip, _))
            && !self.roots.contains_key(&symbol)
            && self.facts[&symbol].uses == 1
    }

    fn count_uses(&mut self, values: &[Sym]) {
        for &value in values {
            self.fact(value).uses += 1;
        }
        // From users to operands, so that a negation's count is complete when it is handed on.
        for index in (0..self.nodes.len()).rev() {
            let symbol = self.nodes[index];
            let of_this = node(symbol);
            let handed_on = match of_this {
                Node::Unary(Unary::Neg, _) => self.facts[&symbol].uses,
                _ => 1,
            };
            for operand in of_this.operands() {
                self.fact(operand).uses += handed_on;
            }
        }
    }

    fn find_sums(&mut self, values: &[Sym]) {
        let mut first = HashMap::new();
        for (output, &value) in values.iter().enumerate() {
            let mut open = vec![value];
            while let Some(symbol) = open.pop() {
                if first.contains_key(&symbol) {
                    continue;
                }
                let of_this = node(symbol);
                let is_sum = matches!(of_this, Node::Binary(Binary::Add | Binary::Sub, ..));
                if is_sum || symbol == value {
                    first.insert(symbol, output);
                }
                if is_sum || matches!(of_this, Node::Unary(Unary::Neg, _)) {
                    open.extend(of_this.operands());
                }
            }
        }
        self.sums = first.into_iter().collect();
        self.sums.sort_unstable_by_key(|(sum, _)| sum.index());
    }

    fn find_roots(&mut self) {
        for &reciprocal in &self.nodes {
            if let Node::Unary(Unary::Recip, root) = node(reciprocal)
                && matches!(node(root), Node::Unary(Unary::Sqrt, _))
                && self.facts[&root].uses > 1
            {
                self.roots.insert(root, reciprocal);
                self.roots.insert(reciprocal, root);
            }
        }
    }

    fn fact(&mut self, symbol: Sym) -> &mut Facts {
        self.facts.entry(symbol).or_default()
    }

    /// A product that is no division.
    fn is_product(&self, symbol: Sym) -> bool {
        match node(symbol) {
            Node::Binary(Binary::Mul, a, b) => !self.is_divisor(a) && !self.is_divisor(b),
            _ => false,
        }
    }

    fn fuse(&mut self) {
        // The sums that use each product with few uses, as (sum, operand).
        let mut users: HashMap<Sym, Vec<(Sym, usize)>> = HashMap::new();
        for &symbol in &self.nodes {
            if let Node::Binary(Binary::Add | Binary::Sub, a, b) = node(symbol) {
                for (position, operand) in [a, b].into_iter().enumerate() {
                    if self.is_product(operand) {
                        users.entry(operand).or_default().push((symbol, position));
                    }
                }
            }
        }
        // Products with one use first: fusing them always saves an operation.
        for most in 1..=MOST_FUSED_USES {
            for index in 0..self.nodes.len() {
                let product = self.nodes[index];
                let Some(sums) = users.get(&product) else { continue };
                let free = sums.iter().all(|(sum, _)| self.facts[sum].fuses == 0);
                let all_uses = self.facts[&product].uses as usize == sums.len();
                if sums.len() == most && free && all_uses {
                    self.fact(product).fused = true;
                    for &(sum, position) in sums {
                        self.fact(sum).fuses = position as u8 + 1;
                    }
                    // Every sum now reads the factors itself.
                    for factor in node(product).operands() {
                        self.fact(factor).uses += most as u32 - 1;
                    }
                }
            }
        }
    }

    fn choose_variables(&mut self, values: &[Sym]) {
        for index in 0..self.nodes.len() {
            let symbol = self.nodes[index];
            let of_this = node(symbol);
            let facts = self.facts[&symbol];
            let inside: u32 = of_this
                .operands()
                .map(|operand| &self.facts[&operand])
                .map(|operand| if operand.named { 0 } else { operand.size })
                .sum();
            let (own, named) = match of_this {
                Node::Constant(_) | Node::Leaf(_) => (0, false),
                Node::Unary(Unary::Neg, _) => (0, false),
                // Kept apart so that sine and cosine of an angle can be found together.
                Node::Unary(Unary::Sin | Unary::Cos, _) => (1, true),
                // So are a root and its reciprocal.
                _ if self.roots.contains_key(&symbol) => (1, true),
                _ => (1, facts.uses > 1 && !facts.fused),
            };
            let size = own + inside;
            let too_large = size >= LARGEST_EXPRESSION && own > 0 && !facts.fused;
            let facts = self.fact(symbol);
            facts.size = size;
            facts.named = named || too_large;
        }
        // A partial sum that waits while others are made is a variable.
        let results: HashSet<Sym> = values.iter().copied().collect();
        for pair in self.sums.windows(2) {
            let [(sum, _), (next, _)] = [pair[0], pair[1]];
            if !results.contains(&sum) && !node(next).operands().any(|operand| operand == sum) {
                self.facts.entry(sum).or_default().named = true;
            }
        }
        // A result of its own needs no variable, unless it is long or used again.
        for &value in values {
            let facts = self.facts.entry(value).or_default();
            if facts.uses == 1 && facts.named && facts.size <= 2 * LARGEST_EXPRESSION {
                let is_angle = matches!(node(value), Node::Unary(Unary::Sin | Unary::Cos, _));
                facts.named = is_angle || self.roots.contains_key(&value);
            }
        }
    }
}
