//! What a block would cost as straight lines, known before it is staged: the mechanics run on numbers
//! that count the operations they take part in.

use handc_core::scalar::{Comparison, Scalar};
use handc_runtime::mechanics::{At, Mechanics, Workspace};
use handc_runtime::mechanism::Mechanism;
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

thread_local! {
    static OPERATIONS: Cell<usize> = const { Cell::new(0) };
}

/// A number that is a constant, as far as folding would find out, or not.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tally {
    Constant(f64),
    Unknown,
}

use Tally::{Constant, Unknown};

/// Something that has to be computed.
fn operation() -> Tally {
    OPERATIONS.set(OPERATIONS.get() + 1);
    Unknown
}

fn unary(x: Tally, function: impl Fn(f64) -> f64) -> Tally {
    match x {
        Constant(x) => Constant(function(x)),
        Unknown => operation(),
    }
}

fn binary(x: Tally, y: Tally, function: impl Fn(f64, f64) -> f64) -> Tally {
    match (x, y) {
        (Constant(x), Constant(y)) => Constant(function(x, y)),
        _ => operation(),
    }
}

impl Add for Tally {
    type Output = Tally;
    fn add(self, other: Tally) -> Tally {
        match (self, other) {
            (Constant(0.0), x) | (x, Constant(0.0)) => x,
            (x, y) => binary(x, y, |x, y| x + y),
        }
    }
}

impl Sub for Tally {
    type Output = Tally;
    fn sub(self, other: Tally) -> Tally {
        match (self, other) {
            (x, Constant(0.0)) => x,
            (Constant(0.0), x) => -x,
            (x, y) => binary(x, y, |x, y| x - y),
        }
    }
}

impl Mul for Tally {
    type Output = Tally;
    fn mul(self, other: Tally) -> Tally {
        match (self, other) {
            (Constant(0.0), _) | (_, Constant(0.0)) => Constant(0.0),
            (Constant(1.0), x) | (x, Constant(1.0)) => x,
            (Constant(-1.0), x) | (x, Constant(-1.0)) => -x,
            (x, y) => binary(x, y, |x, y| x * y),
        }
    }
}

impl Div for Tally {
    type Output = Tally;
    fn div(self, other: Tally) -> Tally {
        match (self, other) {
            (Constant(0.0), Unknown) => Constant(0.0),
            (x, Constant(1.0)) => x,
            (x, y) => binary(x, y, |x, y| x / y),
        }
    }
}

impl Neg for Tally {
    type Output = Tally;
    /// A sign is carried along and costs nothing.
    fn neg(self) -> Tally {
        match self {
            Constant(x) => Constant(-x),
            Unknown => Unknown,
        }
    }
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Tally) {
        *self = *self + other;
    }
}

impl SubAssign for Tally {
    fn sub_assign(&mut self, other: Tally) {
        *self = *self - other;
    }
}

impl Scalar for Tally {
    fn constant(value: f64) -> Tally {
        Constant(value)
    }
    fn sin_cos(self) -> (Tally, Tally) {
        match self {
            Constant(x) => (Constant(x.sin()), Constant(x.cos())),
            Unknown => (operation(), Unknown),
        }
    }
    fn sqrt(self) -> Tally {
        unary(self, f64::sqrt)
    }
    fn recip(self) -> Tally {
        unary(self, f64::recip)
    }
    fn exp(self) -> Tally {
        unary(self, f64::exp)
    }
    fn log(self) -> Tally {
        unary(self, f64::ln)
    }
    fn tan(self) -> Tally {
        unary(self, f64::tan)
    }
    fn asin(self) -> Tally {
        unary(self, f64::asin)
    }
    fn acos(self) -> Tally {
        unary(self, f64::acos)
    }
    fn atan(self) -> Tally {
        unary(self, f64::atan)
    }
    fn atan2(self, x: Tally) -> Tally {
        binary(self, x, f64::atan2)
    }
    fn powi(self, exponent: i32) -> Tally {
        unary(self, |x| x.powi(exponent))
    }
    fn powf(self, exponent: Tally) -> Tally {
        binary(self, exponent, f64::powf)
    }
    fn floor(self) -> Tally {
        unary(self, f64::floor)
    }
    fn abs(self) -> Tally {
        unary(self, f64::abs)
    }
    fn min(self, other: Tally) -> Tally {
        binary(self, other, f64::min)
    }
    fn max(self, other: Tally) -> Tally {
        binary(self, other, f64::max)
    }
    fn select(_: Comparison, _: Tally, _: Tally, then: Tally, otherwise: Tally) -> Tally {
        if then == otherwise { then } else { operation() }
    }
    fn is_known_zero(self) -> bool {
        self == Constant(0.0)
    }
}

/// Operations of momentum, force and Newton matrix of a mechanism, before any two of them are found
/// to be the same.
pub(super) fn operations(mechanism: &Mechanism, structure: &Structure) -> usize {
    let numbers = Resolved::new(mechanism, &vec![Unknown; mechanism.params.len()]);
    let mechanics = Mechanics { mechanism, structure, numbers: &numbers };
    let unknown = |count: usize| vec![Unknown; count];
    let (q, v) = (unknown(structure.count), unknown(structure.count));
    let (rest, inputs) = (unknown(mechanism.strands.len()), unknown(mechanism.inputs.len()));
    let at = At { q: &q, v: &v, t: Unknown, rest: &rest, inputs: &inputs };
    let zeros = |count: usize| vec![Constant(0.0); count];
    let size = structure.blocks.iter().map(|b| b.coordinates.len().pow(2)).sum();
    let (mut momentum, mut force) = (zeros(structure.count), zeros(structure.count));
    let mut matrix = zeros(size);
    let mut workspace = Workspace::new(structure);
    OPERATIONS.set(0);
    let matrix = Some((Unknown, &mut matrix[..]));
    mechanics.evaluate(&mut workspace, &at, &mut momentum, &mut force, matrix);
    OPERATIONS.get()
}
