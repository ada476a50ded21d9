//! Joints: a hinge or a slide for every coordinate, and what acts on a coordinate alone.

use super::Exporter;
use super::bodies::BodyPlan;
use super::xml::{Element, number};
use handc_runtime::mechanism::Motion;
use handc_runtime::vector::{Transform, Vec3};

impl Exporter<'_> {
    /// The joints of a body, in order; they take their names from the coordinates.
    pub(super) fn joints(&mut self, plan: &BodyPlan) -> Vec<Element> {
        let mut joints = Vec::new();
        // Constant transform from the body to the joint's frame at zero coordinates, from the
        // innermost joint outwards.
        let mut body_from_joint = Transform::identity();
        for &index in plan.links.iter().rev() {
            let link = &self.mechanism.links[index as usize];
            let coordinate = link.coordinate as usize;
            let turned = |axis| (body_from_joint.rotation * self.numbers.vector(axis)).0;
            match &link.motion {
                Motion::Revolute { axis } => {
                    let axis = turned(axis);
                    joints.push(self.joint(coordinate, "hinge", axis, body_from_joint.translation));
                }
                Motion::Prismatic { axis } => {
                    let axis = turned(axis);
                    joints.push(self.joint(coordinate, "slide", axis, Vec3([0.0; 3])));
                }
                Motion::Screw { axis, pitch } => {
                    let (axis, pitch) = (turned(axis), self.numbers.number(*pitch));
                    let hinge = self.joint(coordinate, "hinge", axis, body_from_joint.translation);
                    joints.push(self.advance(coordinate, axis, pitch));
                    joints.push(hinge);
                }
            }
            let place =
                self.numbers.transform(&self.mechanism.links[index as usize].parent_from_joint);
            body_from_joint = body_from_joint * place.inverse();
        }
        joints.reverse();
        joints
    }

    fn joint(&mut self, index: usize, kind: &str, axis: [f64; 3], at: Vec3<f64>) -> Element {
        let coordinate = &self.mechanism.coordinates[index];
        let mut joint = Element::new("joint").with("name", &coordinate.name).with("type", kind);
        if at.0 != [0.0; 3] {
            joint = joint.with_numbers("pos", &at.0);
        }
        joint = joint.with_numbers("axis", &axis);
        let acting = self.numbers.coordinates.iter().find(|(of, _)| *of == index);
        let acting = acting.map(|(_, acting)| acting);
        if let Some((stiffness, rest)) = acting.and_then(|acting| acting.spring) {
            joint =
                joint.with_numbers("stiffness", &[stiffness]).with_numbers("springref", &[rest]);
        }
        if let Some(damping) = acting.and_then(|acting| acting.damping) {
            joint = joint.with_numbers("damping", &[damping]);
        }
        if let Some(limits) = coordinate.limits {
            let elastic = acting.is_some_and(|acting| acting.stops.is_some());
            if elastic {
                self.elastic_limits.push(coordinate.name.clone());
            }
            joint = joint
                .with("limited", if elastic { "true" } else { "false" })
                .with_numbers("range", &limits.map(|limit| self.numbers.number(limit)));
        }
        joint
    }

    /// The slide beside the hinge of a screw, coupled to it.
    fn advance(&mut self, index: usize, axis: [f64; 3], pitch: f64) -> Element {
        let name = &self.mechanism.coordinates[index].name;
        let slide = format!("{name}.advance");
        let equality = Element::new("joint")
            .with("name", self.equality_names.take(&slide))
            .with("joint1", &slide)
            .with("joint2", name)
            .with_numbers("polycoef", &[0.0, pitch, 0.0, 0.0, 0.0]);
        self.equalities.push(equality);
        self.screws.push(name.clone());
        let (q, v) = (self.start.q[index], self.start.v[index]);
        self.advances.push((slide.clone(), pitch * q, pitch * v));
        Element::new("joint").with("name", slide).with("type", "slide").with_numbers("axis", &axis)
    }

    /// Holds every coordinate whose path is given where it is at the start.
    pub(super) fn hold_driven(&mut self) {
        let mechanism = self.mechanism;
        let mut held = Vec::new();
        for (index, coordinate) in mechanism.coordinates.iter().enumerate() {
            if self.start.driven[index] {
                let at = self.start.q[index];
                let equality = Element::new("joint")
                    .with("name", self.equality_names.take(&format!("{}.drive", coordinate.name)))
                    .with("joint1", &coordinate.name)
                    .with_numbers("polycoef", &[at, 0.0, 0.0, 0.0, 0.0]);
                self.equalities.push(equality);
                held.push(format!("{} = {}", coordinate.name, number(at)));
            }
        }
        self.warn_of("driven; MJCF has no drives, so an equality holds it at its start", &held);
    }

    /// What joints have that MJCF says otherwise.
    pub(super) fn tell_of_joints(&mut self) {
        let screws = std::mem::take(&mut self.screws);
        self.warn_of(
            "a screw; MJCF has none, so there is a hinge and a slide `.advance`, coupled by an \
             equality",
            &screws,
        );
        let limits = std::mem::take(&mut self.elastic_limits);
        self.warn_of("elastic limits; MuJoCo's own soft limits stand in for them", &limits);
    }
}
