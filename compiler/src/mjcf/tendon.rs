//! Strands as spatial tendons with a spring.

use super::Exporter;
use super::law::{reads, varies};
use super::xml::Element;
use handc_runtime::mechanism::{Law, Strand, Wrap};
use handc_runtime::surface::Form;
use handc_runtime::vector::{Mat3, Transform};

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
                if let Some(wrap) = strand.wrap(number) {
                    path.push(self.wrap(&format!("{name}.{}", number + 1), strand, wrap));
                }
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

    /// A geom to be wrapped, with a site on the side on which the tendon passes.
    fn wrap(&mut self, name: &str, strand: &Strand, wrap: &Wrap) -> Element {
        let surface = self.numbers.surface(strand, wrap);
        let geom_name = self.geom_names.take(&format!("{name}.surface"));
        let radius = surface.radius;
        // It is only wrapped: nothing collides with it, and its mass is not read.
        let geom = Element::new("geom")
            .with("name", &geom_name)
            .with_numbers("pos", &surface.center.0)
            .with("contype", "0")
            .with("conaffinity", "0")
            .with("rgba", "0.6 0.6 0.7 0.4");
        let geom = match &surface.form {
            Form::Sphere | Form::Ring(_) => {
                geom.with("type", "sphere").with_numbers("size", &[radius])
            }
            // For the wrap it has no ends.
            Form::Cylinder(axis) => geom
                .with("type", "cylinder")
                .with_numbers("size", &[radius, radius])
                .with_numbers("zaxis", &axis.vector().0),
        };
        self.sites[wrap.center.link.map_or(0, |link| link as usize + 1)].push(geom);
        let element = Element::new("geom").with("geom", geom_name);
        let Some(side) = &wrap.side else { return element };
        let side = self.numbers.vector(side);
        // Inside the surface it would ask for a tendon that passes within.
        let mut toward = surface.form.flat(side);
        toward = toward.scale(2.0 * radius / toward.norm_squared().sqrt());
        let place = Transform { rotation: Mat3::identity(), translation: surface.center + toward };
        let site = self.framed_site(&format!("{name}.side"), wrap.center.link, &place);
        element.with("sidesite", site)
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
