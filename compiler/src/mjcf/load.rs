//! Torques and forces as actuators.
//!
//! An actuator pushes with gain·control + b₀ + b₁·length + b₂·velocity. What a law has of that form
//! is written down; what it has beyond is left to the control.

use super::Exporter;
use super::law::Affine;
use super::xml::Element;
use handc_runtime::expression::{Function, Variable};
use handc_runtime::mechanism::{Force, Torque};

/// A `general` actuator in the making.
#[derive(Clone, Debug)]
pub(super) struct Actuator(Element);

impl Actuator {
    /// With a gain on the control (N or N·m per unit) and nothing else.
    pub(super) fn gain(self, gain: f64) -> Element {
        self.0.with_numbers("gainprm", &[gain])
    }
    /// With b₀ b₁ b₂ and no control.
    pub(super) fn bias(self, bias: [f64; 3]) -> Element {
        self.0
            .with_numbers("gainprm", &[0.0])
            .with("biastype", "affine")
            .with_numbers("biasprm", &bias)
    }
    /// With both.
    fn gain_and_bias(self, bias: [f64; 3]) -> Element {
        self.0
            .with_numbers("gainprm", &[1.0])
            .with("biastype", "affine")
            .with_numbers("biasprm", &bias)
    }
}

impl Exporter<'_> {
    fn actuator(&mut self, wanted: &str) -> Element {
        let name = self.actuator_names.take(wanted);
        Element::new("general").with("name", name)
    }

    /// An actuator that pulls along a tendon.
    pub(super) fn on_tendon(&mut self, wanted: &str, tendon: &str) -> Actuator {
        Actuator(self.actuator(wanted).with("tendon", tendon))
    }

    /// Every torque and force.
    pub(super) fn loads(&mut self) {
        let mechanism = self.mechanism;
        let (mut controlled, mut free) = (Vec::new(), Vec::new());
        for torque in &mechanism.torques {
            match self.torque(torque) {
                Law::Whole => {}
                Law::Control => controlled.push(torque.name.as_str()),
                Law::Left => free.push(torque.name.as_str()),
            }
        }
        for force in &mechanism.forces {
            match self.force(force) {
                Some(Law::Whole) => {}
                Some(Law::Control) => controlled.push(force.name.as_str()),
                Some(Law::Left) => free.push(force.name.as_str()),
                None => self.warn(format!(
                    "force `{}` is left out: MuJoCo's sites push along their own axes or the \
                     world's, not along another body's",
                    force.name
                )),
            }
        }
        self.warn_of(
            "changes with time or an input; the control of that name is its value (N or N m), in the \
             key `start` that of t = 0",
            &controlled,
        );
        self.warn_of(
            "MJCF cannot say how it depends on the state; the control of that name is its value (N \
             or N m), in the key `start` that of the start",
            &free,
        );
    }

    fn torque(&mut self, torque: &Torque) -> Law {
        let index = torque.coordinate;
        let joint = &self.mechanism.coordinates[index as usize].name;
        let actuator = Actuator(self.actuator(&torque.name).with("joint", joint));
        let own = |slopes: &[(Variable, f64)], variable| {
            slopes.iter().find(|(v, _)| *v == variable).map_or(0.0, |(_, slope)| *slope)
        };
        let (here, rate) = (Variable::Coordinate(index), Variable::Rate(index));
        match self.affine(&torque.value) {
            Some(Affine { constant, varies, slopes })
                if slopes.iter().all(|(v, _)| *v == here || *v == rate) =>
            {
                let (b1, b2) = (own(&slopes, here), own(&slopes, rate));
                if varies {
                    self.actuators.push((actuator.gain_and_bias([0.0, b1, b2]), constant));
                    return Law::Control;
                }
                self.actuators.push((actuator.bias([constant, b1, b2]), 0.0));
                Law::Whole
            }
            _ => {
                let value = self.at_start(&torque.value);
                self.actuators.push((actuator.gain(1.0), value));
                Law::Left
            }
        }
    }

    fn force(&mut self, force: &Force) -> Option<Law> {
        let Some(link) = force.point.link else { return Some(Law::Whole) };
        if force.axes.is_some_and(|axes| axes != link) {
            return None;
        }
        let site = self.site(&force.name, &force.point);
        let world = force.axes.is_none().then(|| self.world_site());
        let place = |element: Element, gear: [f64; 3]| {
            let element = element.with("site", &site);
            let element = match &world {
                Some(world) => element.with("refsite", world),
                None => element,
            };
            let [x, y, z] = gear;
            Actuator(element.with_numbers("gear", &[x, y, z, 0.0, 0.0, 0.0]))
        };
        let mut constant = [0.0; 3];
        let mut law = Law::Whole;
        for (axis, suffix) in ["x", "y", "z"].into_iter().enumerate() {
            let (value, kind) = self.component(&force.value[axis]);
            if kind == Law::Whole {
                constant[axis] = value;
                continue;
            }
            let mut gear = [0.0; 3];
            gear[axis] = 1.0;
            let element = self.actuator(&format!("{}.{suffix}", force.name));
            self.actuators.push((place(element, gear).gain(1.0), value));
            law = if law == Law::Left { law } else { kind };
        }
        if constant != [0.0; 3] {
            let element = self.actuator(&force.name);
            self.actuators.push((place(element, constant).bias([1.0, 0.0, 0.0]), 0.0));
        }
        Some(law)
    }

    fn component(&self, function: &Function) -> (f64, Law) {
        match self.affine(function) {
            Some(Affine { constant, varies, slopes }) if slopes.is_empty() => {
                (constant, if varies { Law::Control } else { Law::Whole })
            }
            _ => (self.at_start(function), Law::Left),
        }
    }

    /// A site at the world's origin, for world axes.
    fn world_site(&mut self) -> String {
        if self.world_site.is_empty() {
            let identity = handc_runtime::vector::Transform::identity();
            self.world_site = self.framed_site("world", None, &identity);
        }
        self.world_site.clone()
    }
}

/// How much of a load's law is in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Law {
    /// All of it.
    Whole,
    /// All but a part that changes with time or inputs: the control.
    Control,
    /// Nothing: the control is the value.
    Left,
}
