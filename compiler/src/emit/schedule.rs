//! The order of statements: depth first from each result, or each of its partial sums, in turn, so
//! that a value is made shortly before its first use.

use super::code::{Expression, Fused, Output, Statement};
use super::plan::Plan;
use crate::graph::{Binary, Node, Sym, Unary, node};
use std::collections::{HashMap, HashSet};

/// Statements in order, and for each the output that it was made for.
#[derive(Debug, Default)]
pub struct Schedule {
    /// Statements, definitions before uses.
    pub statements: Vec<Statement>,
    /// The number of the output during which each was made.
    pub made_for: Vec<usize>,
}

/// Orders the statements that compute `outputs`.
pub fn schedule(outputs: &[Output], plan: &Plan) -> Schedule {
    let mut scheduler = Scheduler {
        plan,
        weights: weights(plan),
        partners: partners(plan),
        done: HashSet::new(),
        result: Schedule::default(),
    };
    let mut places: HashMap<Sym, Vec<usize>> = HashMap::new();
    for (number, output) in outputs.iter().enumerate() {
        places.entry(output.value).or_default().push(number);
    }
    for &(sum, number) in plan.sums() {
        scheduler.make(sum, number);
        for number in places.remove(&sum).into_iter().flatten() {
            let value = scheduler.operand(sum);
            scheduler.push(Statement::Store(number, value), number);
        }
    }
    for (number, output) in outputs.iter().enumerate() {
        if places.contains_key(&output.value) {
            scheduler.make(output.value, number);
            let value = scheduler.operand(output.value);
            scheduler.push(Statement::Store(number, value), number);
        }
    }
    scheduler.result
}

/// How much stands below each node, as a tree and bounded: the heavier operand is made first, since
/// fewer values then wait.
fn weights(plan: &Plan) -> HashMap<Sym, u32> {
    let mut weights = HashMap::with_capacity(plan.nodes().len());
    for &symbol in plan.nodes() {
        let below = node(symbol)
            .operands()
            .fold(0u32, |sum, operand| sum.saturating_add(weights[&operand]));
        weights.insert(symbol, below.saturating_add(1));
    }
    weights
}

/// Sine for cosine, root for its reciprocal and the other way round, where both are needed.
fn partners(plan: &Plan) -> HashMap<Sym, Sym> {
    let mut sines = HashMap::new();
    let mut cosines = HashMap::new();
    for &symbol in plan.nodes() {
        match node(symbol) {
            Node::Unary(Unary::Sin, angle) => sines.insert(angle, symbol),
            Node::Unary(Unary::Cos, angle) => cosines.insert(angle, symbol),
            _ => None,
        };
    }
    let mut partners = HashMap::new();
    for &symbol in plan.nodes() {
        if let Some(partner) = plan.root_partner(symbol) {
            partners.insert(symbol, partner);
        }
    }
    for (angle, &sine) in &sines {
        if let Some(&cosine) = cosines.get(angle) {
            partners.insert(sine, cosine);
            partners.insert(cosine, sine);
        }
    }
    partners
}

struct Scheduler<'a> {
    plan: &'a Plan,
    weights: HashMap<Sym, u32>,
    partners: HashMap<Sym, Sym>,
    done: HashSet<Sym>,
    result: Schedule,
}

impl Scheduler<'_> {
    fn push(&mut self, statement: Statement, output: usize) {
        self.result.statements.push(statement);
        self.result.made_for.push(output);
    }

    /// Makes the variables that `target` needs, and itself if it is one. A list of open nodes takes
    /// the place of recursion, since graphs can be deep.
    fn make(&mut self, target: Sym, output: usize) {
        let mut open = vec![(target, false)];
        while let Some((symbol, operands_done)) = open.pop() {
            if self.done.contains(&symbol) {
                continue;
            }
            if operands_done {
                self.done.insert(symbol);
                if self.plan.is_variable(symbol) {
                    self.define(symbol, output);
                }
                continue;
            }
            open.push((symbol, true));
            let mut operands: Vec<Sym> = node(symbol).operands().collect();
            // The last one pushed is made first.
            operands.sort_by_key(|operand| self.weights[operand]);
            open.extend(operands.into_iter().map(|operand| (operand, false)));
        }
    }

    fn define(&mut self, symbol: Sym, output: usize) {
        let statement = match (node(symbol), self.partners.get(&symbol)) {
            (Node::Unary(function, operand), Some(&partner)) => {
                self.done.insert(partner);
                match function {
                    Unary::Sin => Statement::SinCos(symbol, partner, self.operand(operand)),
                    Unary::Cos => Statement::SinCos(partner, symbol, self.operand(operand)),
                    // The root is an operand of its reciprocal, and so is made first.
                    _ => Statement::SqrtRecip(symbol, partner, self.operand(operand)),
                }
            }
            _ => Statement::Let(symbol, self.expression(symbol)),
        };
        self.push(statement, output);
    }

    /// A node as an operand: its variable, or its expression. Expressions are small by plan, so
    /// that recursion is shallow.
    fn operand(&self, symbol: Sym) -> Expression {
        match self.plan.is_variable(symbol) {
            true => Expression::Variable(symbol),
            false => self.expression(symbol),
        }
    }

    fn boxed(&self, symbol: Sym) -> Box<Expression> {
        Box::new(self.operand(symbol))
    }

    fn pair(&self, a: Sym, b: Sym) -> Box<[Expression; 2]> {
        Box::new([self.operand(a), self.operand(b)])
    }

    /// The right-hand side that computes a node.
    fn expression(&self, symbol: Sym) -> Expression {
        match node(symbol) {
            Node::Constant(bits) => Expression::Constant(f64::from_bits(bits)),
            Node::Leaf(leaf) => Expression::Leaf(leaf),
            Node::Unary(Unary::Neg, a) => self.negation(a),
            Node::Unary(Unary::Recip, a) => {
                Expression::Div(Box::new([Expression::Constant(1.0), self.operand(a)]))
            }
            Node::Unary(function, a) => Expression::Call(function, self.boxed(a)),
            Node::Power(a, exponent) => Expression::Powi(self.boxed(a), exponent),
            Node::Select(comparison, four) => {
                Expression::Select(comparison, Box::new(four.map(|s| self.operand(s))))
            }
            Node::Binary(function, a, b) => match function {
                Binary::Add | Binary::Sub => self.sum(symbol, function, a, b),
                Binary::Mul => self.product(a, b),
                Binary::Powf => Expression::Powf(self.pair(a, b)),
                Binary::Atan2 => Expression::Atan2(self.pair(a, b)),
                Binary::Min => Expression::Min(self.pair(a, b)),
                Binary::Max => Expression::Max(self.pair(a, b)),
            },
        }
    }

    /// −a, with the sign moved to where it costs nothing.
    fn negation(&self, a: Sym) -> Expression {
        match self.operand(a) {
            Expression::Sub(two) => {
                let [x, y] = *two;
                Expression::Sub(Box::new([y, x]))
            }
            Expression::Fused(Fused::MulSub, three) => Expression::Fused(Fused::NegMulAdd, three),
            Expression::Fused(Fused::NegMulAdd, three) => Expression::Fused(Fused::MulSub, three),
            Expression::Mul(two) if matches!(two[0], Expression::Constant(_)) => {
                let [x, y] = *two;
                let x = match x {
                    Expression::Constant(value) => Expression::Constant(-value),
                    other => Expression::Neg(Box::new(other)),
                };
                Expression::Mul(Box::new([x, y]))
            }
            other => Expression::Neg(Box::new(other)),
        }
    }

    fn sum(&self, symbol: Sym, function: Binary, a: Sym, b: Sym) -> Expression {
        let plain = |two| match function {
            Binary::Add => Expression::Add(two),
            _ => Expression::Sub(two),
        };
        let Some(position) = self.plan.fused_operand(symbol) else {
            return plain(self.pair(a, b));
        };
        let (product, addend) = if position == 0 { (a, b) } else { (b, a) };
        let Node::Binary(Binary::Mul, x, y) = node(product) else {
            return plain(self.pair(a, b));
        };
        let kind = match (function, position) {
            (Binary::Add, _) => Fused::MulAdd,
            (_, 0) => Fused::MulSub,
            _ => Fused::NegMulAdd,
        };
        Expression::Fused(kind, Box::new([self.operand(x), self.operand(y), self.operand(addend)]))
    }

    fn product(&self, a: Sym, b: Sym) -> Expression {
        for (numerator, reciprocal) in [(a, b), (b, a)] {
            if self.plan.is_divisor(reciprocal)
                && let Node::Unary(Unary::Recip, divisor) = node(reciprocal)
                && !self.plan.is_variable(reciprocal)
            {
                return Expression::Div(self.pair(numerator, divisor));
            }
        }
        Expression::Mul(self.pair(a, b))
    }
}
