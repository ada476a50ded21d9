//! How copies of a run differ.

/// How copies differ.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// A parameter, evenly from low in the first copy to high in the last.
    Param {
        /// Name.
        name: String,
        /// Value in the first copy.
        low: f64,
        /// Value in the last copy.
        high: f64,
    },
    /// Every coordinate's start, normally distributed.
    Start {
        /// Standard deviation (rad or m).
        sigma: f64,
    },
}

impl Spread {
    /// Reads `PARAM=LO:HI` or `start=SIGMA`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("`--spread` needs PARAM=LO:HI or start=SIGMA, not `{text}`");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let number =
            |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong);
        match value.split_once(':') {
            Some((low, high)) => Ok(Spread::Param {
                name: name.trim().to_string(),
                low: number(low)?,
                high: number(high)?,
            }),
            None if name.trim() == "start" => Ok(Spread::Start { sigma: number(value)? }),
            None => Err(wrong()),
        }
    }
}

/// A small generator of fixed seed (splitmix64), so that an ensemble repeats.
pub(super) struct Random(u64);

impl Random {
    /// For one copy.
    pub(super) fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x6a09_e667_f3bc_c909)
    }
    /// Uniform in (0, 1).
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + f64::EPSILON * 0.25
    }
    /// Standard normal (Box and Muller).
    pub(super) fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (2.0 * std::f64::consts::PI * v).cos()
    }
}
