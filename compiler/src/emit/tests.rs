//! Emitted code computes what the graph means.

use super::code::{Expression, Fused, Output, Place, Statement};
use super::cut::cut;
use super::function::{Function, Naming};
use super::plan::{Order, Plan};
use super::schedule::schedule;
use crate::graph::{Leaf, Sym, Unary, with_new};
use handc_core::scalar::Scalar;
use proc_macro2::TokenStream;
use quote::quote;
use std::collections::HashMap;

struct Plain;

impl Naming for Plain {
    fn label(&self, leaf: Leaf) -> String {
        match leaf {
            Leaf::Q(i) => format!("q.finger.{i}"),
            other => format!("{other:?}"),
        }
    }
    fn index(&self, _: &str, index: usize) -> TokenStream {
        let index = super::literal::integer(index);
        quote!(#index)
    }
    fn array_type(&self, _: &str) -> TokenStream {
        quote!([f64; 4])
    }
}

fn q(index: u32) -> Sym {
    Sym::leaf(Leaf::Q(index))
}

fn outputs(values: Vec<Sym>) -> Vec<Output> {
    let output = |(index, value)| Output {
        place: Place::Element { array: "out", index },
        value,
        label: "finger.mcp".to_owned(),
    };
    values.into_iter().enumerate().map(output).collect()
}

/// Two links of a made-up chain: sums of products, shared reciprocals, sines and cosines.
fn sample() -> Vec<Sym> {
    let (s, c) = q(0).sin_cos();
    let (s1, c1) = (q(0) + q(1)).sin_cos();
    let x = c.scale(0.3) + c1 * q(2);
    let y = s.scale(0.3) - s1 * q(2);
    let length = (x * x + y * y).sqrt();
    let inverse = length.recip();
    let tension = Sym::constant(200.0) * (length - Sym::leaf(Leaf::Rest(0)));
    vec![
        tension * x * inverse,
        -(tension * y * inverse) + c * s1,
        q(3) / (x + q(3)),
        (-(x - y)).min(q(1)).exp(),
        x * y - c * c1,
        x * y + length,
    ]
}

/// Runs statements on numbers.
fn run(statements: &[Statement], count: usize) -> Vec<f64> {
    let mut variables = HashMap::new();
    let mut results = vec![f64::NAN; count];
    for statement in statements {
        let value = number(statement.expression(), &variables);
        match statement {
            Statement::Let(symbol, _) => drop(variables.insert(*symbol, value)),
            Statement::SinCos(sine, cosine, _) => {
                variables.insert(*sine, value.sin());
                variables.insert(*cosine, value.cos());
            }
            Statement::SqrtRecip(root, reciprocal, _) => {
                variables.insert(*root, value.sqrt());
                variables.insert(*reciprocal, 1.0 / value.sqrt());
            }
            Statement::Store(output, _) => results[*output] = value,
        }
    }
    results
}

fn value_of(leaf: Leaf) -> f64 {
    match leaf {
        Leaf::Q(i) => [0.3, -0.8, 0.21, 1.7][i as usize],
        Leaf::Rest(_) => 0.2,
        other => panic!("{other:?}"),
    }
}

fn number(expression: &Expression, variables: &HashMap<Sym, f64>) -> f64 {
    let list: Vec<f64> = expression.operands().iter().map(|e| number(e, variables)).collect();
    match expression {
        Expression::Constant(value) => *value,
        Expression::Leaf(leaf) => value_of(*leaf),
        Expression::Variable(symbol) => variables[symbol],
        Expression::Neg(_) => -list[0],
        Expression::Add(_) => list[0] + list[1],
        Expression::Sub(_) => list[0] - list[1],
        Expression::Mul(_) => list[0] * list[1],
        Expression::Div(_) => list[0] / list[1],
        Expression::Fused(Fused::MulAdd, _) => list[0] * list[1] + list[2],
        Expression::Fused(Fused::MulSub, _) => list[0] * list[1] - list[2],
        Expression::Fused(Fused::NegMulAdd, _) => list[2] - list[0] * list[1],
        Expression::Call(Unary::Sqrt, _) => list[0].sqrt(),
        Expression::Call(Unary::Exp, _) => list[0].exp(),
        Expression::Call(Unary::Sin, _) => list[0].sin(),
        Expression::Call(Unary::Cos, _) => list[0].cos(),
        Expression::Min(_) => list[0].min(list[1]),
        other => panic!("not in the sample: {other:?}"),
    }
}

#[test]
fn statements_compute_the_outputs() {
    with_new(|| {
        let values = sample();
        let outputs = outputs(values.clone());
        let expected: Vec<f64> = values.iter().map(|&value| direct(value)).collect();
        for order in [Order::OutputByOutput, Order::TermByTerm] {
            let code = schedule(&outputs, &Plan::new(&outputs, order));
            let found = run(&code.statements, values.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-13, "{found} instead of {expected}");
            }
        }
    });
}

/// A value straight from the graph.
fn direct(symbol: Sym) -> f64 {
    use crate::graph::{Binary, Node, node};
    match node(symbol) {
        Node::Constant(bits) => f64::from_bits(bits),
        Node::Leaf(leaf) => value_of(leaf),
        Node::Unary(function, a) => {
            let a = direct(a);
            match function {
                Unary::Neg => -a,
                Unary::Recip => 1.0 / a,
                Unary::Sqrt => a.sqrt(),
                Unary::Sin => a.sin(),
                Unary::Cos => a.cos(),
                Unary::Exp => a.exp(),
                other => panic!("not in the sample: {other:?}"),
            }
        }
        Node::Binary(function, a, b) => {
            let (a, b) = (direct(a), direct(b));
            match function {
                Binary::Add => a + b,
                Binary::Sub => a - b,
                Binary::Mul => a * b,
                Binary::Min => a.min(b),
                other => panic!("not in the sample: {other:?}"),
            }
        }
        other => panic!("not in the sample: {other:?}"),
    }
}

#[test]
fn parts_carry_values_across_the_cut() {
    with_new(|| {
        let outputs = outputs(sample());
        let code = schedule(&outputs, &Plan::new(&outputs, Order::TermByTerm));
        for limit in 1..code.statements.len() + 1 {
            let cut = cut(&code.statements, limit);
            let mut work: Vec<Option<Sym>> = vec![None; cut.workspace];
            let mut position = 0;
            for part in &cut.parts {
                assert_eq!(part.statements.start, position);
                assert!(part.statements.len() <= limit);
                position = part.statements.end;
                let mut known: Vec<Sym> = Vec::new();
                for &(symbol, place) in &part.loads {
                    assert_eq!(work[place], Some(symbol));
                    known.push(symbol);
                }
                for statement in &code.statements[part.statements.clone()] {
                    assert!(statement.reads().iter().all(|symbol| known.contains(symbol)));
                    known.extend(statement.defines());
                }
                for &(symbol, place) in &part.stores {
                    assert!(known.contains(&symbol));
                    work[place] = Some(symbol);
                }
            }
            assert_eq!(position, code.statements.len());
        }
    });
}

#[test]
fn text_is_stable_and_parses() {
    with_new(|| {
        for longest in [100, 4] {
            let function = Function {
                name: "evaluate".to_owned(),
                doc: vec!["A sample.".to_owned()],
                outputs: outputs(sample()),
                longest,
            };
            let text = |emitted: &super::Emitted| {
                let file = syn::parse2(emitted.tokens.clone()).expect("legal Rust");
                prettyplease::unparse(&file)
            };
            let first = function.emit(&Plain);
            assert_eq!(text(&first), text(&function.emit(&Plain)));
            assert_eq!(first.parts > 1, longest == 4);
            if longest == 100 {
                println!("{}", text(&first));
                assert!(
                    text(&first)
                        .contains("let (sin_finger_0, cos_finger_0) = sin_cos(q_finger_0);")
                );
                assert!(text(&first).contains("/// A sample."));
            }
        }
    });
}

#[test]
fn constants_are_short_and_exact() {
    for (value, text) in
        [(0.1, "0.1"), (1e-7, "1e-7"), (1e22, "1e22"), (-2.5, "- 2.5"), (3.0, "3.0")]
    {
        assert_eq!(super::literal::number(value).to_string().replace("-2", "- 2"), text);
    }
}

#[test]
fn names_are_legal_and_unique() {
    use super::name::{Taken, camel, snake, upper};
    assert_eq!(snake("index.FDP"), "index_fdp");
    assert_eq!(upper("index.fdp"), "INDEX_FDP");
    assert_eq!(camel("index_finger"), "IndexFinger");
    assert_eq!(camel("_"), "X");
    assert_eq!(snake("_1__a"), "n1_a");
    let mut taken = Taken::default();
    assert_eq!(
        taken.take_all(["a_b", "a_b", "crate", "a_b_2"]),
        ["a_b", "a_b_2", "crate_2", "a_b_2_2"]
    );
}
