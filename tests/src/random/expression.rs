//! Random expressions: plain numbers made of what a place may read, and of every function.

use super::draft::Draft;

/// What an expression may read.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reads {
    pub(super) time: bool,
    pub(super) inputs: bool,
    pub(super) coordinates: bool,
    pub(super) lengths: bool,
    pub(super) rates: bool,
    /// Functions with kinks and jumps.
    pub(super) kinks: bool,
}

/// A given function of time.
pub(super) const TIME: Reads = Reads {
    time: true,
    inputs: false,
    coordinates: false,
    lengths: false,
    rates: false,
    kinks: true,
};
/// A natural length.
pub(super) const REST: Reads = Reads { inputs: true, ..TIME };
/// A torque or a force.
pub(super) const LOAD: Reads =
    Reads { coordinates: true, lengths: true, rates: true, kinks: false, ..REST };
/// A recorded column.
pub(super) const RECORD: Reads = Reads { kinks: true, ..LOAD };

/// A dimensionless expression of order one.
pub(super) fn plain(draft: &mut Draft, reads: Reads, depth: usize) -> String {
    if depth == 0 {
        return leaf(draft, reads);
    }
    let a = plain(draft, reads, depth - 1);
    let kind = draft.chance.below(if reads.kinks { 26 } else { 19 });
    if kind < 8 {
        return match kind {
            0 => format!("sin({a})"),
            1 => format!("cos({a})"),
            2 => format!("atan({a})"),
            3 => format!("exp(-({a})^2)"),
            4 => format!("log(2 + ({a})^2)"),
            5 => format!("sqrt(1 + ({a})^2)"),
            6 => format!("tan(0.4*sin({a}))"),
            _ => format!("-({a})"),
        };
    }
    let b = plain(draft, reads, depth - 1);
    let number = draft.chance.between(0.2, 0.9);
    match kind {
        8 => format!("({a} + {b})"),
        9 => format!("({a} - {number:.3} * {b})"),
        10 => format!("sin({a}) * {b}"),
        11 => format!("({a}) / (1 + ({b})^2)"),
        12 => format!("asin({number:.3} * sin({a}))"),
        13 => format!("acos({number:.3} * cos({a}))"),
        14 => format!("atan2({a}, 1.5 + sin({b}))"),
        15 => format!("sin({a})^3"),
        16 => format!("(1 + sin({a})^2)^-1.5"),
        17 => format!("smoothstep(-2, 2.5, {a})"),
        18 => format!("1/(3 + cos({a}))^2"),
        19 => format!("abs({a})"),
        20 => format!("min({a}, {b}, {number:.3})"),
        21 => format!("max({a}, {b})"),
        22 => format!("clamp({a}, -0.7, {number:.3})"),
        23 => format!("if({a} < {b}, {number:.3}, {b})"),
        24 => format!("floor(3 * ({a}))"),
        _ if reads.time => format!("ease(4 ms, 19 ms, {a}, {number:.3})"),
        _ => format!("if({a} >= {number:.3}, {a}, {b})"),
    }
}

fn leaf(draft: &mut Draft, reads: Reads) -> String {
    let number = draft.chance.between(0.3, 1.5);
    for _ in 0..6 {
        match draft.chance.below(6) {
            0 if reads.time => return format!("(t / {number:.3} s)"),
            1 if reads.inputs && !draft.inputs.is_empty() => {
                let (name, unit) = draft.chance.pick(&draft.inputs).clone();
                return ratio(&name, number, unit);
            }
            2 if reads.coordinates => {
                let c = draft.chance.pick(&draft.coordinates).clone();
                return ratio(&c.name, number, c.unit());
            }
            3 if reads.rates => {
                let c = draft.chance.pick(&draft.coordinates).clone();
                let unit = if c.is_length { "m/s" } else { "rad/s" };
                return ratio(&format!("rate({})", c.name), 3.0 * number, unit);
            }
            4 if reads.lengths && !draft.strands.is_empty() => {
                let name = draft.chance.pick(&draft.strands).clone();
                return ratio(&format!("length({name})"), number, "m");
            }
            5 if !draft.params.is_empty() => {
                let (name, unit) = draft.chance.pick(&draft.params).clone();
                return ratio(&name, number, unit);
            }
            _ => {}
        }
    }
    format!("{number:.4}")
}

fn ratio(what: &str, number: f64, unit: &str) -> String {
    format!("({what} / {number:.3} {unit})")
}
