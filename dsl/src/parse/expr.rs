//! Builds expressions, names and units from what the grammar matched.

use super::Rule;
use crate::ast::{Argument, Expr, ExprKind, Ident, Operator, Path, Placement, Point, Rotation};
use crate::ast::{Station, UnitExpr, UnitFactor, Wrap};
use crate::source::{FileId, Span};
use pest::iterators::{Pair, Pairs};
use pest::pratt_parser::{Assoc, Op, PrattParser};
use std::sync::LazyLock;

static PRECEDENCE: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    PrattParser::new()
        .op(Op::infix(Rule::add, Assoc::Left) | Op::infix(Rule::sub, Assoc::Left))
        .op(Op::infix(Rule::mul, Assoc::Left) | Op::infix(Rule::div, Assoc::Left))
        .op(Op::prefix(Rule::neg))
        .op(Op::infix(Rule::pow, Assoc::Right))
});

/// Turns matched pairs of one statement into nodes; `base` is where the statement begins.
#[derive(Clone, Copy)]
pub(super) struct Build {
    pub(super) file: FileId,
    pub(super) base: usize,
}

/// What matters inside a pair: punctuation left out.
pub(super) fn inner(pair: Pair<'_, Rule>) -> impl Iterator<Item = Pair<'_, Rule>> {
    pair.into_inner().filter(|p| {
        !matches!(
            p.as_rule(),
            Rule::equals
                | Rule::comma
                | Rule::open
                | Rule::close
                | Rule::colon
                | Rule::arrow
                | Rule::sign_at
                | Rule::both
                | Rule::axes
                | Rule::word_if
                | Rule::word_in
                | Rule::word_at
                | Rule::word_as
                | Rule::word_on
                | Rule::word_with
                | Rule::word_rotate
                | Rule::word_via
                | Rule::word_wrap
                | Rule::EOI
        )
    })
}

impl Build {
    pub(super) fn span(&self, pair: &Pair<'_, Rule>) -> Span {
        // A rule that ends in something optional may have taken blanks behind it.
        let start = self.base + pair.as_span().start();
        Span::new(self.file, start, start + pair.as_str().trim_end().len())
    }

    pub(super) fn ident(&self, pair: &Pair<'_, Rule>) -> Ident {
        Ident { text: pair.as_str().to_string(), span: self.span(pair) }
    }

    pub(super) fn path(&self, pair: &Pair<'_, Rule>) -> Path {
        let mut parts = Vec::new();
        let whole = self.span(pair);
        let mut start = whole.start as usize;
        for part in pair.as_str().split('.') {
            let span = Span::new(self.file, start, start + part.len());
            parts.push(Ident { text: part.to_string(), span });
            start += part.len() + 1;
        }
        Path { parts, span: whole }
    }

    pub(super) fn expr(&self, pair: Pair<'_, Rule>) -> Expr {
        match pair.as_rule() {
            Rule::expr => self.infix(pair.into_inner()),
            _ => self.primary(pair),
        }
    }

    fn infix(&self, pairs: Pairs<'_, Rule>) -> Expr {
        PRECEDENCE
            .map_primary(|pair| self.primary(pair))
            .map_prefix(|operator, operand: Expr| {
                let span = self.span(&operator).to(operand.span);
                Expr { kind: ExprKind::Neg(Box::new(operand)), span }
            })
            .map_infix(|left: Expr, operator, right: Expr| {
                let kind = match operator.as_rule() {
                    Rule::add => Operator::Add,
                    Rule::sub => Operator::Sub,
                    Rule::mul => Operator::Mul,
                    Rule::div => Operator::Div,
                    _ => Operator::Pow,
                };
                binary(kind, left, right)
            })
            .parse(pairs)
    }

    fn primary(&self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let kind = match pair.as_rule() {
            Rule::number => ExprKind::Number(pair.as_str().parse().unwrap_or(f64::NAN)),
            Rule::parens => {
                let trailing = pair.clone().into_inner().any(|p| p.as_rule() == Rule::comma);
                let mut items: Vec<Expr> = inner(pair).map(|p| self.expr(p)).collect();
                match items.pop() {
                    Some(only) if items.is_empty() && !trailing => ExprKind::Paren(Box::new(only)),
                    last => {
                        items.extend(last);
                        ExprKind::Tuple(items)
                    }
                }
            }
            Rule::quantity => {
                let mut parts = pair.into_inner();
                let value = parts.next().map(|p| self.primary(p));
                match (value, parts.next()) {
                    (Some(value), Some(unit)) => {
                        ExprKind::WithUnit(Box::new(value), self.unit(unit))
                    }
                    (Some(value), None) => return value,
                    (None, _) => ExprKind::Number(f64::NAN),
                }
            }
            Rule::call => {
                let mut parts = inner(pair);
                let name = parts.next().map(|p| self.ident(&p));
                let arguments = parts.map(|p| self.expr(p)).collect();
                let name = name.unwrap_or(Ident { text: String::new(), span });
                ExprKind::Call(name, arguments)
            }
            Rule::choice => {
                let word = Ident { text: "if".into(), span };
                let arguments = inner(pair)
                    .map(|p| match p.as_rule() {
                        Rule::condition => self.condition(p),
                        _ => self.expr(p),
                    })
                    .collect();
                ExprKind::Call(word, arguments)
            }
            Rule::expr => return self.expr(pair),
            Rule::offset | Rule::axis => return self.wrapped(pair),
            _ => ExprKind::Path(self.path(&pair)),
        };
        Expr { kind, span }
    }

    /// An axis with its sign, or the only child.
    fn wrapped(&self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let mut negative = false;
        let mut value = None;
        for part in inner(pair) {
            match part.as_rule() {
                Rule::neg => negative = true,
                _ => value = Some(self.primary(part)),
            }
        }
        let value = value.unwrap_or(Expr { kind: ExprKind::Number(f64::NAN), span });
        match negative {
            true => Expr { kind: ExprKind::Neg(Box::new(value)), span },
            false => value,
        }
    }

    fn condition(&self, pair: Pair<'_, Rule>) -> Expr {
        let span = self.span(&pair);
        let parts: Vec<_> = inner(pair).collect();
        match parts.as_slice() {
            [left, operator, right] => {
                let kind = match operator.as_str() {
                    "<" => Operator::Less,
                    "<=" => Operator::LessEqual,
                    ">" => Operator::Greater,
                    ">=" => Operator::GreaterEqual,
                    "==" => Operator::Equal,
                    _ => Operator::NotEqual,
                };
                binary(kind, self.expr(left.clone()), self.expr(right.clone()))
            }
            [only] => self.condition(only.clone()),
            _ => Expr { kind: ExprKind::Number(f64::NAN), span },
        }
    }

    /// A unit; behind `/` powers are negative.
    pub(super) fn unit(&self, pair: Pair<'_, Rule>) -> UnitExpr {
        let span = self.span(&pair);
        let mut factors = Vec::new();
        for part in pair.into_inner() {
            let mut sign = 1;
            let mut inside = part.clone();
            if part.as_rule() == Rule::next_factor {
                for piece in part.into_inner() {
                    match piece.as_rule() {
                        Rule::per => sign = -1,
                        _ => inside = piece,
                    }
                }
            }
            let mut name = None;
            let mut exponent = 1;
            for piece in inside.into_inner() {
                match piece.as_rule() {
                    Rule::exponent => exponent = piece.as_str().parse().unwrap_or(i32::MAX),
                    _ => name = Some(self.ident(&piece)),
                }
            }
            if let Some(name) = name {
                factors.push(UnitFactor { name, exponent: sign * exponent });
            }
        }
        UnitExpr { factors, span }
    }

    pub(super) fn placement(&self, pair: Pair<'_, Rule>) -> Placement {
        let span = self.span(&pair);
        let mut parent = Path { parts: Vec::new(), span };
        let mut at = None;
        let mut rotations = Vec::new();
        for part in inner(pair) {
            match part.as_rule() {
                Rule::dotted => parent = self.path(&part),
                Rule::rotation => {
                    let mut parts = inner(part);
                    if let (Some(axis), Some(angle)) = (parts.next(), parts.next()) {
                        rotations
                            .push(Rotation { axis: self.primary(axis), angle: self.expr(angle) });
                    }
                }
                _ => at = Some(self.expr(part)),
            }
        }
        Placement { parent, at, rotations }
    }

    pub(super) fn point(&self, pair: Pair<'_, Rule>) -> Point {
        let span = self.span(&pair);
        let mut frame = Path { parts: Vec::new(), span };
        let mut offset = None;
        for part in inner(pair) {
            match part.as_rule() {
                Rule::offset => offset = Some(self.primary(part)),
                _ => frame = self.path(&part),
            }
        }
        Point { frame, offset, span }
    }

    /// A point or a surface of a path.
    pub(super) fn station(&self, pair: Pair<'_, Rule>) -> Station {
        if pair.as_rule() != Rule::wrap {
            return Station::Point(self.point(pair));
        }
        let span = self.span(&pair);
        let mut surface = Ident { text: String::new(), span };
        let mut center = None;
        let mut options = Vec::new();
        for part in inner(pair) {
            match part.as_rule() {
                Rule::surface => surface = self.ident(&part),
                Rule::point => center = Some(self.point(part)),
                _ => options.extend(self.argument(part)),
            }
        }
        let nowhere = Point { frame: Path { parts: Vec::new(), span }, offset: None, span };
        Station::Wrap(Wrap { surface, center: center.unwrap_or(nowhere), options, span })
    }

    pub(super) fn arguments(&self, pair: Pair<'_, Rule>) -> Vec<Argument> {
        inner(pair).filter_map(|p| self.argument(p)).collect()
    }

    /// `name = value` or `value`.
    pub(super) fn argument(&self, pair: Pair<'_, Rule>) -> Option<Argument> {
        let mut name = None;
        let mut value = None;
        for part in inner(pair) {
            match part.as_rule() {
                Rule::any_word => name = Some(self.ident(&part)),
                _ => value = Some(self.expr(part)),
            }
        }
        value.map(|value| Argument { name, value })
    }
}

fn binary(operator: Operator, left: Expr, right: Expr) -> Expr {
    let span = left.span.to(right.span);
    Expr { kind: ExprKind::Binary(operator, Box::new(left), Box::new(right)), span }
}
