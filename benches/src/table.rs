//! Times of several rounds, rows of the table, and how they are printed.

/// Figures of one thing, one a round.
#[derive(Clone, Debug, Default)]
pub(crate) struct Series(pub(crate) Vec<f64>);

impl Series {
    /// The smallest.
    pub(crate) fn least(&self) -> f64 {
        self.0.iter().copied().fold(f64::INFINITY, f64::min)
    }
    /// The middle one.
    pub(crate) fn median(&self) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        match sorted.len() {
            0 => f64::NAN,
            n => 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
        }
    }
}

/// What a figure is held to.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Target {
    /// At most this.
    Most(f64),
    /// At least this.
    Least(f64),
}

/// A row.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// What is measured, with its unit.
    pub(crate) what: String,
    /// handc's figures, or why there are none.
    pub(crate) own: Result<Series, String>,
    /// The target.
    pub(crate) target: Option<Target>,
    /// How many times as long the first rival should take: a target that does not depend on the machine.
    pub(crate) ratio: Option<f64>,
    /// What was tried where the target is not met.
    pub(crate) tried: &'static str,
    /// Rivals and their figures.
    pub(crate) rivals: Vec<(String, Result<Series, String>)>,
}

impl Row {
    /// The best of several figures: the largest of a gain, the least of all else.
    fn best(&self, series: &Series) -> f64 {
        match self.target {
            Some(Target::Least(_)) => series.0.iter().copied().fold(f64::NAN, f64::max),
            _ => series.least(),
        }
    }

    /// Whether the best figure meets the target.
    fn verdict(&self) -> &'static str {
        let Some(target) = self.target else { return "" };
        let met = self.own.as_ref().is_ok_and(|own| match target {
            Target::Most(most) => self.best(own) <= most,
            Target::Least(least) => self.best(own) >= least,
        });
        if met { "met" } else { "not met" }
    }

    /// The ratio to the first rival, and whether it is what is asked.
    fn ratio_text(&self) -> String {
        let (Some(asked), Ok(own)) = (self.ratio, &self.own) else { return String::new() };
        let Some((_, Ok(rival))) = self.rivals.first() else { return String::new() };
        let found = self.best(rival) / self.best(own);
        let verdict = if found >= asked { "met" } else { "not met" };
        format!("{}x of {}x: {verdict}", figure(found), figure(asked))
    }

    fn target_text(&self) -> String {
        match self.target {
            Some(Target::Most(most)) => format!("<= {most}"),
            Some(Target::Least(least)) => format!(">= {least}"),
            None => String::new(),
        }
    }
}

/// The rows as markdown.
pub(crate) fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| what | best | median | target | | as a ratio | MuJoCo, best (median): times handc's best |\n\
         |---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let (best, median) = match &row.own {
            Ok(own) => (figure(row.best(own)), figure(own.median())),
            Err(reason) => (reason.clone(), String::new()),
        };
        let own = row.own.as_ref().map(|own| row.best(own)).unwrap_or(f64::NAN);
        let rivals: Vec<String> = row
            .rivals
            .iter()
            .map(|(name, series)| match series {
                Ok(s) => format!(
                    "{name} {} ({}): {}x",
                    figure(row.best(s)),
                    figure(s.median()),
                    figure(row.best(s) / own)
                ),
                Err(reason) => format!("{name}: {reason}"),
            })
            .collect();
        let (target, verdict, ratio) = (row.target_text(), row.verdict(), row.ratio_text());
        text.push_str(&format!(
            "| {} | {best} | {median} | {target} | {verdict} | {ratio} | {} |\n",
            row.what,
            rivals.join("; ")
        ));
    }
    for row in rows.iter().filter(|row| row.verdict() == "not met" && !row.tried.is_empty()) {
        text.push_str(&format!("\nNot met: {}. {}\n", row.what, row.tried));
    }
    text
}

/// Three digits that count.
pub(crate) fn figure(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        "-".into()
    } else if size != 0.0 && !(1e-3..1e5).contains(&size) {
        format!("{value:.1e}")
    } else {
        let digits = (2 - size.max(1e-3).log10().floor() as i32).clamp(0, 5) as usize;
        format!("{value:.digits$}")
    }
}
