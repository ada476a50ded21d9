//! A model while it is being drafted.

use crate::chance::Chance;

/// A coordinate that expressions may name.
#[derive(Clone, Debug)]
pub(super) struct Coordinate {
    pub(super) name: String,
    pub(super) is_length: bool,
    /// The model itself drives it.
    pub(super) driven: bool,
    /// Whether it can be named alone in `start`, `drive` and so on.
    pub(super) start: f64,
}

impl Coordinate {
    /// Unit of the coordinate.
    pub(super) fn unit(&self) -> &'static str {
        if self.is_length { "m" } else { "rad" }
    }
    /// Unit of the force on it.
    pub(super) fn force_unit(&self) -> &'static str {
        if self.is_length { "N" } else { "N*m" }
    }
}

/// What has been written so far.
#[derive(Clone, Debug)]
pub(super) struct Draft {
    pub(super) chance: Chance,
    pub(super) name: String,
    /// Declarations.
    pub(super) lines: Vec<String>,
    /// Frames by name, `world` first.
    pub(super) frames: Vec<String>,
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) strands: Vec<String>,
    /// Parameters and inputs: name and unit.
    pub(super) params: Vec<(String, &'static str)>,
    pub(super) inputs: Vec<(String, &'static str)>,
    /// Multiplier columns that records may name, with their units.
    pub(super) multipliers: Vec<(String, &'static str)>,
    names: usize,
}

/// Names that generated code might trip over.
const ODD: [&str; 40] = [
    "type", "self", "fn", "q", "v", "h", "p", "params", "rest", "momentum", "matrix", "values",
    "layout", "super", "crate", "sin", "x", "mm", "mul_add", "sin_cos", "f64", "Vec", "Model",
    "new", "default", "inputs", "Some", "u8", "loop", "match", "dyn", "x_", "__", "at_", "lambda_",
    "energy_", "sized", "Midpoint", "std", "Self_",
];

impl Draft {
    pub(super) fn new(name: &str, chance: Chance) -> Self {
        Draft {
            chance,
            name: name.to_string(),
            lines: Vec::new(),
            frames: vec!["world".into()],
            coordinates: Vec::new(),
            strands: Vec::new(),
            params: Vec::new(),
            inputs: Vec::new(),
            multipliers: Vec::new(),
            names: 0,
        }
    }

    /// A new name; now and then one that is a word of Rust or of generated code.
    pub(super) fn fresh(&mut self, stem: &str) -> String {
        self.names += 1;
        let odd = ODD[(self.chance.below(ODD.len()) + self.names) % ODD.len()];
        let taken = |text: &str| self.lines.iter().any(|line| words(line).any(|w| w == text));
        if !taken(odd) && self.chance.is(0.12) {
            return odd.to_string();
        }
        format!("{stem}{}", self.names)
    }

    /// A number or a parameter of the same value.
    pub(super) fn quantity(&mut self, value: f64, unit: &'static str) -> String {
        if self.chance.is(0.8) {
            return format!("{value:.6} {unit}");
        }
        let name = self.fresh("par");
        self.lines.insert(0, format!("param {name} = {value:.6} {unit};"));
        self.params.push((name.clone(), unit));
        name
    }

    /// A vector with one of its components a parameter now and then.
    pub(super) fn vector(&mut self, size: f64) -> String {
        let [x, y, z] = self.chance.vector(size);
        if self.chance.is(0.15) {
            let x = self.quantity(x, "m");
            return format!("({x}, {y:.6} m, {z:.6} m)");
        }
        format!("({x:.6}, {y:.6}, {z:.6}) m")
    }

    /// `at … rotate …`, or nothing.
    pub(super) fn placement(&mut self, size: f64) -> String {
        let mut text = String::new();
        if self.chance.is(0.8) {
            text.push_str(&format!(" at {}", self.vector(size)));
        }
        while self.chance.is(0.35) {
            let axis = self.axis();
            let angle = self.chance.between(-3.0, 3.0);
            let angle = self.quantity(angle, "rad");
            text.push_str(&format!(" rotate {axis} {angle}"));
        }
        text
    }

    /// An axis: along a coordinate axis or in any direction.
    pub(super) fn axis(&mut self) -> String {
        match self.chance.below(7) {
            0 | 1 => "x".into(),
            2 => "y".into(),
            3 => "z".into(),
            4 => "-z".into(),
            _ => {
                let [x, y, z] = self.chance.vector(1.0);
                format!("({x:.4}, {y:.4}, {:.4})", z + 1.2)
            }
        }
    }

    /// A frame and a point in it.
    pub(super) fn point(&mut self, size: f64) -> String {
        let frame = self.chance.pick(&self.frames).clone();
        if self.chance.is(0.1) {
            return frame;
        }
        format!("{frame} {}", self.vector(size))
    }

    /// The model's text.
    pub(super) fn text(&self) -> String {
        format!("model {} {{\n    {}\n}}\n", self.name, self.lines.join("\n    "))
    }
}

/// Identifiers of a line.
fn words(line: &str) -> impl Iterator<Item = &str> {
    line.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).filter(|word| !word.is_empty())
}
