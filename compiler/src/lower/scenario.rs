//! Scenarios.

use super::Lowering;
use handc_dsl::hir;
use handc_runtime::mechanism::{Number, Scenario};

impl Lowering<'_> {
    pub(super) fn scenario(&mut self, scenario: &hir::Scenario) -> Scenario {
        let mut values = |pairs: &[(hir::CoordinateId, hir::Expr)]| -> Vec<(u32, Number)> {
            pairs.iter().map(|(id, expr)| (id.0, self.number(expr))).collect()
        };
        let start = values(&scenario.start);
        let velocity = values(&scenario.velocity);
        let poses = scenario
            .poses
            .iter()
            .map(|pose| (pose.name.text.clone(), values(&pose.values)))
            .collect();
        let mut number = |expr: &Option<hir::Expr>| expr.as_ref().map(|e| self.number(e));
        let (step, duration) = (number(&scenario.step), number(&scenario.duration));
        let tolerance = number(&scenario.tolerance);
        Scenario {
            name: scenario.name.text.clone(),
            doc: scenario.name.doc.clone(),
            step,
            duration,
            tolerance,
            set: scenario.set.iter().map(|(id, expr)| (id.0, self.number(expr))).collect(),
            start,
            velocity,
            inputs: scenario.inputs.iter().map(|(id, e)| (id.0, self.program(e))).collect(),
            drives: scenario.drives.iter().map(|(id, e)| (id.0, self.program(e))).collect(),
            lengths: scenario.lengths.iter().map(|(id, e)| (id.0, self.program(e))).collect(),
            poses,
            motions: scenario
                .motions
                .iter()
                .map(|motion| {
                    let knots = motion
                        .knots
                        .iter()
                        .map(|(pose, time)| (*pose as u32, self.number(time)))
                        .collect();
                    (motion.name.text.clone(), knots)
                })
                .collect(),
            follow: scenario
                .follow
                .iter()
                .map(|f| (f.motion as u32, f.strands.iter().map(|s| s.0).collect()))
                .collect(),
            records: scenario
                .records
                .iter()
                .map(|record| (record.name.text.clone(), self.program(&record.value)))
                .collect(),
        }
    }
}
