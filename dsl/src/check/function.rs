//! Function calls.

use super::fold::{self, holds};
use super::name::Entity;
use super::scope::ScopeId;
use super::{Checker, constant};
use crate::ast::{self, ExprKind as Ast, Ident, Operator};
use crate::diagnostic::Diagnostic;
use crate::dimension::Dimension;
use crate::hir::{Compare, CoordinateId, Expr, ExprKind, Function, Own, StrandId, StrandQuantity};
use crate::source::Span;
use crate::suggest::nearest;

/// How the dimensions of a function's arguments and of its value go together.
#[derive(Clone, Copy, PartialEq)]
enum Rule {
    /// Plain numbers to a plain number.
    Plain,
    /// All alike, and the value like them.
    Alike,
    /// All alike, the value plain.
    Ratio,
    /// The square root of its argument's.
    Root,
    /// Two times, then two alike, and the value like these.
    Ease,
}

#[rustfmt::skip]
const FUNCTIONS: [(&str, Function, usize, Rule); 17] = [
    ("sin", Function::Sin, 1, Rule::Plain),
    ("cos", Function::Cos, 1, Rule::Plain),
    ("tan", Function::Tan, 1, Rule::Plain),
    ("asin", Function::Asin, 1, Rule::Plain),
    ("acos", Function::Acos, 1, Rule::Plain),
    ("atan", Function::Atan, 1, Rule::Plain),
    ("atan2", Function::Atan2, 2, Rule::Ratio),
    ("sqrt", Function::Sqrt, 1, Rule::Root),
    ("exp", Function::Exp, 1, Rule::Plain),
    ("log", Function::Log, 1, Rule::Plain),
    ("abs", Function::Abs, 1, Rule::Alike),
    ("min", Function::Min, 2, Rule::Alike),
    ("max", Function::Max, 2, Rule::Alike),
    ("floor", Function::Floor, 1, Rule::Plain),
    ("clamp", Function::Clamp, 3, Rule::Alike),
    ("smoothstep", Function::Smoothstep, 3, Rule::Ratio),
    ("ease", Function::Ease, 4, Rule::Ease),
];

/// Functions of a strand that only a recorded column may hold.
const RECORDED: [&str; 6] =
    ["tension", "taut", "dissipation", "fibre_length", "fibre_force", "fibre_power"];

impl<'a> Checker<'a> {
    pub(super) fn call(
        &mut self,
        scope: ScopeId,
        name: &'a Ident,
        arguments: &'a [ast::Expr],
        span: Span,
    ) -> Option<Expr> {
        match name.text.as_str() {
            "if" => return self.choice(scope, arguments, span),
            "length" => return self.length(scope, arguments, span),
            "rate" => return self.rate(scope, arguments, span),
            text if RECORDED.contains(&text) => {
                return self.strand_quantity(scope, text, arguments, span);
            }
            _ => {}
        }
        let Some(&(_, function, count, rule)) = FUNCTIONS.iter().find(|f| f.0 == name.text) else {
            let names =
                FUNCTIONS.iter().map(|f| f.0).chain(RECORDED).chain(["length", "rate", "if"]);
            let all: Vec<&str> = names.clone().collect();
            let help = match nearest(&name.text, names) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known are {}", all.join(", ")),
            };
            let message = format!("unknown function `{}`", name.text);
            self.report(Diagnostic::error("unknown-function", name.span, message).help(help));
            return None;
        };
        // `min` and `max` take two or more.
        let many = matches!(function, Function::Min | Function::Max) && arguments.len() > 2;
        if arguments.len() != count && !many {
            self.count(&name.text, count, arguments.len(), span);
            return None;
        }
        let values: Vec<Option<Expr>> = arguments.iter().map(|a| self.scalar(scope, a)).collect();
        let mut values: Vec<Expr> = values.into_iter().collect::<Option<_>>()?;
        let dimension = self.call_dimension(&name.text, rule, &mut values, arguments)?;
        let mut rest = values.into_iter();
        let mut current: Vec<Expr> = rest.by_ref().take(count).collect();
        loop {
            let done = self.fold_call(function, current, dimension, span)?;
            match rest.next() {
                Some(next) => current = vec![done, next],
                None => return Some(done),
            }
        }
    }

    fn fold_call(
        &mut self,
        function: Function,
        values: Vec<Expr>,
        dimension: Dimension,
        span: Span,
    ) -> Option<Expr> {
        let numbers: Option<Vec<f64>> = values.iter().map(constant).collect();
        match numbers.and_then(|n| fold::call(function, &n)) {
            Some(value) => self.finite(value, dimension, span),
            None => Some(Expr { kind: ExprKind::Call(function, values), dimension, span }),
        }
    }

    fn count(&mut self, name: &str, want: usize, found: usize, span: Span) {
        let plural = if want == 1 { "" } else { "s" };
        let message = format!("`{name}` takes {want} argument{plural}, not {found}");
        self.report(Diagnostic::error("argument-count", span, message));
    }

    fn call_dimension(
        &mut self,
        name: &str,
        rule: Rule,
        values: &mut Vec<Expr>,
        texts: &'a [ast::Expr],
    ) -> Option<Dimension> {
        let what = format!("the argument of `{name}`");
        match rule {
            Rule::Plain => {
                for (value, text) in values.iter_mut().zip(texts) {
                    *value = self.fit(value.clone(), Dimension::NONE, &what, Some(text))?;
                }
                Some(Dimension::NONE)
            }
            Rule::Root => {
                let dimension = values[0].dimension;
                let root = dimension.root();
                if root.is_none() {
                    let message = format!("{} has no square root here", dimension.describe());
                    self.report(Diagnostic::error("dimension", texts[0].span, message));
                }
                root
            }
            Rule::Alike => self.alike(name, values),
            Rule::Ratio => self.alike(name, values).map(|_| Dimension::NONE),
            Rule::Ease => {
                let mut ends = values.split_off(2);
                for (value, text) in values.iter_mut().zip(texts) {
                    let what = "a time of `ease`";
                    *value = self.fit(value.clone(), Dimension::TIME, what, Some(text))?;
                }
                let dimension = self.alike(name, &mut ends)?;
                values.append(&mut ends);
                if let (Some(from), Some(to)) = (constant(&values[0]), constant(&values[1]))
                    && from >= to
                {
                    let message = "`ease` must end after it begins";
                    self.report(Diagnostic::error("times", texts[1].span, message));
                    return None;
                }
                Some(dimension)
            }
        }
    }

    /// Makes all values agree in dimension.
    fn alike(&mut self, name: &str, values: &mut [Expr]) -> Option<Dimension> {
        let lead = values.iter().position(|v| !fold::bare_zero(v)).unwrap_or(0);
        let doing = format!("take `{name}` of");
        for index in 0..values.len() {
            if index != lead {
                let mut first = values[lead].clone();
                self.agree(&mut first, &mut values[index], &doing)?;
            }
        }
        values.get(lead).map(|v| v.dimension)
    }

    fn choice(&mut self, scope: ScopeId, arguments: &'a [ast::Expr], span: Span) -> Option<Expr> {
        let [condition, then, otherwise] = arguments else { return None };
        let Ast::Binary(operator, left, right) = &condition.kind else { return None };
        let compare = match operator {
            Operator::Less => Compare::Less,
            Operator::LessEqual => Compare::LessEqual,
            Operator::Greater => Compare::Greater,
            Operator::GreaterEqual => Compare::GreaterEqual,
            Operator::Equal => Compare::Equal,
            _ => Compare::NotEqual,
        };
        let left = self.scalar(scope, left);
        let right = self.scalar(scope, right);
        let then = self.scalar(scope, then);
        let otherwise = self.scalar(scope, otherwise);
        let (mut left, mut right) = (left?, right?);
        let (mut then, mut otherwise) = (then?, otherwise?);
        self.agree(&mut left, &mut right, "compare")?;
        let dimension = self.agree(&mut then, &mut otherwise, "choose between")?;
        if let (Some(a), Some(b)) = (constant(&left), constant(&right)) {
            let chosen = if holds(compare, a, b) { then } else { otherwise };
            return Some(Expr { span, ..chosen });
        }
        let kind = ExprKind::If {
            compare,
            left: Box::new(left),
            right: Box::new(right),
            then: Box::new(then),
            otherwise: Box::new(otherwise),
        };
        Some(Expr { kind, dimension, span })
    }

    fn length(&mut self, scope: ScopeId, arguments: &'a [ast::Expr], span: Span) -> Option<Expr> {
        let [argument] = arguments else {
            self.count("length", 1, arguments.len(), span);
            return None;
        };
        let Ast::Path(path) = &argument.kind else {
            let message = "`length` takes the name of a strand";
            self.report(Diagnostic::error("not-a-strand", argument.span, message));
            return None;
        };
        let index = self.strand(scope, path)?;
        let kind = ExprKind::Length(StrandId(index as u32));
        Some(Expr { kind, dimension: Dimension::LENGTH, span })
    }

    fn rate(&mut self, scope: ScopeId, arguments: &'a [ast::Expr], span: Span) -> Option<Expr> {
        let [argument] = arguments else {
            self.count("rate", 1, arguments.len(), span);
            return None;
        };
        let Ast::Path(path) = &argument.kind else {
            let message = "`rate` takes the name of a joint's coordinate or of a strand";
            self.report(Diagnostic::error("not-a-coordinate", argument.span, message));
            return None;
        };
        match self.peek(scope, path) {
            Some(Entity::Own(Own::Length)) => {
                let kind = ExprKind::Own(Own::Rate);
                return Some(Expr { kind, dimension: Dimension::VELOCITY, span });
            }
            Some(Entity::Strand(index)) => {
                let kind = ExprKind::Strand(StrandQuantity::Rate, StrandId(index as u32));
                return Some(Expr { kind, dimension: Dimension::VELOCITY, span });
            }
            _ => {}
        }
        let index = self.coordinate(scope, path)?;
        let dimension = self.coordinate_dimension(index)?.over(Dimension::TIME)?;
        let kind = ExprKind::Rate(CoordinateId(index as u32));
        Some(Expr { kind, dimension, span })
    }

    /// `tension(S)`, `taut(S)`, `dissipation(S)`, and what is of a muscle alone.
    fn strand_quantity(
        &mut self,
        scope: ScopeId,
        name: &str,
        arguments: &'a [ast::Expr],
        span: Span,
    ) -> Option<Expr> {
        let [argument] = arguments else {
            self.count(name, 1, arguments.len(), span);
            return None;
        };
        let Ast::Path(path) = &argument.kind else {
            let message = format!("`{name}` takes the name of a strand");
            self.report(Diagnostic::error("not-a-strand", argument.span, message));
            return None;
        };
        let index = self.strand(scope, path)?;
        if name.starts_with("fibre") && !self.muscles.iter().any(|m| m.strand == index) {
            let message =
                format!("`{name}` takes a muscle: `{}` is none", self.sources.slice(path.span));
            self.report(Diagnostic::error("not-a-muscle", argument.span, message));
            return None;
        }
        let strand = StrandId(index as u32);
        let (quantity, dimension) = match name {
            "tension" => (StrandQuantity::Tension, Dimension::FORCE),
            "taut" => (StrandQuantity::Taut, Dimension::NONE),
            "fibre_length" => (StrandQuantity::FibreLength, Dimension::LENGTH),
            "fibre_force" => (StrandQuantity::FibreForce, Dimension::FORCE),
            "fibre_power" => (StrandQuantity::FibrePower, Dimension::POWER),
            _ => (StrandQuantity::Dissipation, Dimension::POWER),
        };
        Some(Expr { kind: ExprKind::Strand(quantity, strand), dimension, span })
    }
}
