//! Strands as spatial tendons with a spring.

use super::Exporter;
use super::law::{reads, varies};
use super::xml::Element;
use handc_runtime::mechanism::Law;

impl Exporter<'_> {
    /// Every strand; those with a natural length that changes get an actuator beside the spring.
    pub(super) fn strands(&mut self) {
        let mechanism = self.mechanism;
        let (mut changing, mut unsaid, mut rough) = (Vec::new(), Vec::new(), Vec::new());
        for (index, strand) in mechanism.strands.iter().enumerate() {
            let name = self.tendon_names.take(&strand.name);
            let numbers = &self.numbers.strands[index];
            let stiffness = numbers.stiffness.unwrap_or(0.0);
            if !matches!(strand.law, Law::Linear { .. }) {
                unsaid.push(strand.name.as_str());
            }
            if strand.friction.is_some() {
                rough.push(strand.name.as_str());
            }
            let (damping, is_slack) = (numbers.damping.unwrap_or(0.0), numbers.slack.is_some());
            let rest = self.start.rest[index];
            let mut path = Vec::new();
            for (number, point) in strand.points.iter().enumerate() {
                let site = self.site(&format!("{name}.{}", number + 1), point);
                path.push(Element::new("site").with("site", site));
            }
            // A length below zero would mean "the length at zero coordinates".
            let upper = rest.max(0.0);
            // Between two lengths nothing pulls: from zero, a tendon that goes slack.
            let range = [0.0, upper];
            let mut spatial = Element::new("spatial")
                .with("name", &name)
                .with_numbers("stiffness", &[stiffness])
                .with_numbers("springlength", if is_slack { &range } else { &range[1..] });
            if damping != 0.0 {
                spatial = spatial.with_numbers("damping", &[damping]);
            }
            let spatial = spatial.with_children(path);
            self.tendons.push(spatial);
            if rest < 0.0 {
                let pull = self.on_tendon(&format!("{name}.pull"), &name);
                self.actuators.push((pull.bias([stiffness * rest, 0.0, 0.0]), 0.0));
            }
            if self.rest_changes(index) {
                let change = self.on_tendon(&format!("{name}.rest"), &name);
                self.actuators.push((change.gain(stiffness), 0.0));
                changing.push(strand.name.as_str());
            }
        }
        self.warn_of("the tendon slides without friction", &rough);
        self.warn_of("the tendon is there, but not the law of its tension", &unsaid);
        self.warn_of(
            "the natural length changes; the control `.rest` is how much longer (m) it is than at \
             the start",
            &changing,
        );
    }

    /// Whether a strand's natural length depends on time or inputs.
    fn rest_changes(&self, strand: usize) -> bool {
        let mechanism = self.mechanism;
        if let Some(scenario) = self.start.scenario {
            let scenario = &mechanism.scenarios[scenario];
            let follows = |follow: &&(u32, Vec<u32>)| follow.1.contains(&(strand as u32));
            if let Some((motion, _)) = scenario.follow.iter().rev().find(follows) {
                let knots = &scenario.motions[*motion as usize].1;
                return knots.windows(2).any(|pair| pair[0].0 != pair[1].0);
            }
        }
        mechanism.strands[strand].rest.as_ref().is_some_and(|rest| varies(&reads(rest, 0)))
    }
}
