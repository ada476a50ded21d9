//! Each identity by itself.

use super::super::*;
use handc_core::scalar::{Comparison, Scalar};

fn x() -> Sym {
    Sym::leaf(Leaf::Q(0))
}
fn y() -> Sym {
    Sym::leaf(Leaf::Q(1))
}
fn c(value: f64) -> Sym {
    Sym::constant(value)
}

#[test]
fn sums() {
    with_new(|| {
        assert_eq!(x() + c(0.0), x());
        assert_eq!(x() - x(), c(0.0));
        assert_eq!(x() + (-y()), x() - y());
        assert_eq!(-(-x()), x());
        assert_eq!((-x()) - y(), -(x() + y()));
        assert_eq!(x() + y(), y() + x());
        assert_eq!(-(x() - y()), y() - x());
        assert_eq!(c(2.0) + (c(3.0) - x()), c(5.0) - x());
        assert_eq!((x() + c(1.0)) - c(1.0), x());
        assert_eq!(-(c(2.0) + x()), c(-2.0) - x());
        assert_eq!(x() + x(), c(2.0) * x());
        assert_eq!(c(3.0) * x() - x().scale(5.0), c(-2.0) * x());
        assert_eq!((x() + y()) - y(), x());
        assert_eq!(x() - (x() - y()), y());
    });
}

#[test]
fn a_common_factor_is_taken_out_where_the_rest_cancels() {
    with_new(|| {
        let [f, z] = [2, 3].map(|index| Sym::leaf(Leaf::Q(index)));
        // f·(x + (z − x)), and the other way round.
        assert_eq!(f * x() + f * (z - x()), f * z);
        assert_eq!((z - x()) * f + x() * f, f * z);
        // f·((x + y) − y), f·(x − (x + y)) and f·(x − (x − y)).
        assert_eq!(f * (x() + y()) - f * y(), f * x());
        assert_eq!(f * x() - f * (x() + y()), -(f * y()));
        assert_eq!(f * x() - f * (x() - y()), f * y());
        // f·((x − y) − x).
        assert_eq!(f * (x() - y()) - f * x(), -(f * y()));
    });
}

#[test]
fn a_common_factor_stays_where_nothing_cancels() {
    with_new(|| {
        let [f, z] = [2, 3].map(|index| Sym::leaf(Leaf::Q(index)));
        let (fx, fy) = (f * x(), f * y());
        assert_eq!(node(fx + fy), Node::Binary(Binary::Add, fx, fy));
        assert_eq!(node(fx - fy), Node::Binary(Binary::Sub, fx, fy));
        // The rest would be 2·x − z or x + y + y.
        let (less, more) = (f * (x() - z), f * (x() + y()));
        assert_eq!(node(fx + less), Node::Binary(Binary::Add, fx, less));
        assert_eq!(node(more + fy), Node::Binary(Binary::Add, fy, more));
        // Another factor.
        let other = z * (y() - x());
        assert_eq!(node(fx + other), Node::Binary(Binary::Add, fx, other));
    });
}

#[test]
fn products() {
    with_new(|| {
        assert_eq!(x() * c(0.0), c(0.0));
        assert_eq!(x() * c(1.0), x());
        assert_eq!(x() * c(-1.0), -x());
        assert_eq!((-x()) * y(), -(x() * y()));
        assert_eq!(c(2.0) * (c(3.0) * x()), c(6.0) * x());
        assert_eq!(x() / c(4.0), c(0.25) * x());
        assert_eq!(x() / y(), x() * y().recip());
        assert_eq!(x().powi(4), (x() * x()) * (x() * x()));
        assert_eq!(x().powi(-1), x().recip());
        assert!((x() * c(0.0)).is_known_zero());
        assert!(!x().is_known_zero());
    });
}

#[test]
fn functions() {
    with_new(|| {
        let ((s, co), (ms, mc)) = (x().sin_cos(), (-x()).sin_cos());
        assert_eq!((ms, mc), (-s, co));
        assert_eq!(s * s + co * co, c(1.0));
        assert_eq!(Sym::select(Comparison::Less, c(1.0), c(2.0), x(), y()), x());
        assert_eq!(Sym::select(Comparison::Less, x(), y(), x(), x()), x());
        assert_eq!(x().powf(c(0.5)), x().sqrt());
        assert_eq!((x() * x()).sqrt(), x().abs());
        assert_eq!(((x() * y()) * (x() * y())).sqrt(), (x() * y()).abs());
    });
}

#[test]
fn undefined_values_are_left_to_run_time() {
    with_new(|| {
        for symbol in [c(0.0).recip(), c(-1.0).sqrt(), c(-1.0).log(), c(1e4).exp()] {
            assert_eq!(symbol.as_constant(), None);
        }
        assert_eq!((c(1e300) * c(1e300)).as_constant(), None);
        assert_eq!((c(1.0) / c(0.0)).as_constant(), None);
    });
}

#[test]
fn graphs_do_not_leak() {
    with_new(|| {
        let outer = x();
        with_new(|| assert_eq!(node_count(), 0));
        assert_eq!(x(), outer);
    });
}

#[test]
fn origins_label_what_is_made_inside() {
    with_new(|| {
        let sum = with_origin("index.fdp", || {
            with_origin("inner", || ());
            x() + y()
        });
        let product = x() * y();
        assert_eq!(label_of(sum), "index.fdp");
        assert_eq!(label_of(product), "");
    });
}

#[test]
fn deep_expressions_need_no_stack() {
    with_new(|| {
        let mut sum = x();
        for index in 0..200_000 {
            sum = (sum + y()) * c(0.999) + Sym::leaf(Leaf::V(index % 7));
        }
        assert!(to_program(&[differentiate(sum, x())]).operations.len() < 10);
        assert!(to_program(&[sum]).operations.len() > 200_000);
    });
}
