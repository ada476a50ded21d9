//! Making like parts alike: numbers in which they differ become unknowns before staging.
//!
//! A finger whose tendon runs in its plane has a zero where its neighbours have an offset; staged as
//! it is, its equations lack terms and are no instance of theirs. Where parts have the same links,
//! bodies and strands, every number that is not the same in all of them is therefore staged as a
//! parameter of its own, whose value is put back when the parts' expressions have been compared.

use handc_runtime::expression::{Operation, Variable};
use handc_runtime::mechanism::{Law, Mechanism, Motion, Number, Param, SurfaceForm};
use handc_runtime::structure::Structure;

/// A mechanism with unknowns for the numbers in which like parts differ.
pub(super) struct Harmony {
    /// The mechanism; its parameters go on beyond those of the original.
    pub(super) mechanism: Mechanism,
    /// Values of the parameters that were added.
    pub(super) added: Vec<f64>,
}

/// An element that belongs to a part, by index.
#[derive(Clone, Copy)]
enum Element {
    Coordinate(usize),
    Link(usize),
    Body(usize),
    Strand(usize),
    Force(usize),
}

/// Replaces what differs; `None` where no two parts are alike.
pub(super) fn harmonise(mechanism: &Mechanism, structure: &Structure) -> Option<Harmony> {
    let parts: Vec<(Vec<Element>, Vec<i64>)> = super::parts(&structure.blocks)
        .iter()
        .map(|part| describe(mechanism, structure, part.coordinates))
        .collect();
    let mut groups: Vec<Vec<&(Vec<Element>, Vec<i64>)>> = Vec::new();
    for part in &parts {
        match groups.iter_mut().find(|group| group[0].1 == part.1) {
            Some(group) => group.push(part),
            None => groups.push(vec![part]),
        }
    }
    groups.retain(|group| group.len() > 1);
    if groups.is_empty() {
        return None;
    }
    let mut harmony = Harmony { mechanism: mechanism.clone(), added: Vec::new() };
    for group in groups {
        for place in 0..group[0].0.len() {
            let elements: Vec<Element> = group.iter().map(|(list, _)| list[place]).collect();
            harmony.elements(&elements);
        }
    }
    Some(harmony)
}

impl Harmony {
    /// One element of each part.
    fn elements(&mut self, elements: &[Element]) {
        let count = numbers(&mut self.mechanism, elements[0]).len();
        for place in 0..count {
            let all: Vec<Number> =
                elements.iter().map(|&e| *numbers(&mut self.mechanism, e)[place]).collect();
            if all.iter().all(|number| *number == all[0]) {
                continue;
            }
            for (&element, number) in elements.iter().zip(all) {
                if let Number::Constant(value) = number {
                    let unknown = self.unknown(value);
                    *numbers(&mut self.mechanism, element)[place] = unknown;
                }
            }
        }
    }

    fn unknown(&mut self, value: f64) -> Number {
        let param = self.mechanism.params.len() as u32;
        self.mechanism.params.push(Param {
            name: String::new(),
            doc: String::new(),
            unit: String::new(),
            default: value,
        });
        self.added.push(value);
        let values = &mut self.mechanism.values;
        values.operations.push(Operation::Read(Variable::Param(param)));
        values.outputs.push(values.operations.len() as u32 - 1);
        Number::Value(values.outputs.len() as u32 - 1)
    }
}

/// The elements of a part, and what must agree for two parts to be alike.
fn describe(
    mechanism: &Mechanism,
    structure: &Structure,
    coordinates: &[usize],
) -> (Vec<Element>, Vec<i64>) {
    // Links of the part by their place in it; others, which drives move, by their own index.
    let local = |link: Option<u32>| -> i64 {
        let Some(link) = link else { return -1 };
        let coordinate = mechanism.links[link as usize].coordinate as usize;
        match coordinates.iter().position(|&c| c == coordinate) {
            Some(place) => place as i64,
            None => 1_000_000 + i64::from(link),
        }
    };
    let is_own = |link: Option<u32>| {
        link.is_some_and(|l| {
            coordinates.contains(&(mechanism.links[l as usize].coordinate as usize))
        })
    };
    let (mut elements, mut signature) = (Vec::new(), vec![coordinates.len() as i64]);
    for &c in coordinates {
        let coordinate = &mechanism.coordinates[c];
        elements.push(Element::Coordinate(c));
        let Some(link) = structure.link_of[c] else {
            signature.extend([-6, coordinate.role as i64]);
            continue;
        };
        let link = link as usize;
        elements.push(Element::Link(link));
        let motion = match mechanism.links[link].motion {
            Motion::Revolute { .. } => 0,
            Motion::Prismatic { .. } => 1,
            Motion::Screw { .. } => 2,
        };
        let has_limits = i64::from(coordinate.limits.is_some());
        let parent = local(mechanism.links[link].parent);
        // A width of zero is no width.
        let is_smooth = i64::from(!coordinate.limit_width.is_zero());
        signature.extend([i64::from(coordinate.is_length), has_limits, is_smooth, motion, parent]);
    }
    for (b, body) in mechanism.bodies.iter().enumerate().filter(|(_, b)| is_own(b.link)) {
        elements.push(Element::Body(b));
        signature.extend([-2, local(body.link)]);
    }
    for (s, strand) in mechanism.strands.iter().enumerate() {
        if structure.strands[s].coordinates.iter().any(|c| coordinates.contains(c)) {
            elements.push(Element::Strand(s));
            let law = match strand.law {
                Law::Linear { .. } => 0,
                Law::Energy(_) => 1,
                Law::Tension(_) => 2,
                Law::Prescribed => 3,
                Law::Muscle(_) => 4,
            };
            let options = [strand.slack.is_some(), strand.friction.is_some()].map(i64::from);
            signature.extend([-3, law, options[0], options[1]]);
            signature.extend(strand.points.iter().map(|point| local(point.link)));
            for wrap in &strand.wraps {
                let form = match wrap.form {
                    SurfaceForm::Sphere => 0,
                    SurfaceForm::Cylinder { .. } => 1,
                };
                let given = [wrap.side.is_some(), wrap.plane.is_some()].map(i64::from);
                signature.extend([-5, i64::from(wrap.gap), form]);
                signature.extend(given);
                signature.push(local(wrap.center.link));
            }
        }
    }
    for (f, force) in mechanism.forces.iter().enumerate().filter(|(_, f)| is_own(f.point.link)) {
        elements.push(Element::Force(f));
        signature.extend([-4, local(force.point.link), local(force.axes)]);
    }
    (elements, signature)
}

/// The numbers of an element, in a fixed order.
fn numbers(mechanism: &mut Mechanism, element: Element) -> Vec<&mut Number> {
    let mut list: Vec<&mut Number> = Vec::new();
    match element {
        Element::Coordinate(index) => {
            let c = &mut mechanism.coordinates[index];
            list.extend([&mut c.damping, &mut c.stiffness, &mut c.rest]);
            list.extend([&mut c.limit_stiffness, &mut c.limit_width]);
            list.extend(c.limits.iter_mut().flatten());
        }
        Element::Link(index) => {
            let link = &mut mechanism.links[index];
            list.extend(link.parent_from_joint.rotation.iter_mut().flatten());
            list.extend(&mut link.parent_from_joint.translation);
            match &mut link.motion {
                Motion::Revolute { axis } | Motion::Prismatic { axis } => list.extend(axis),
                Motion::Screw { axis, pitch } => {
                    list.extend(axis);
                    list.push(pitch);
                }
            }
        }
        Element::Body(index) => {
            let body = &mut mechanism.bodies[index];
            list.push(&mut body.mass);
            list.extend(&mut body.center);
            list.extend(&mut body.inertia);
        }
        Element::Strand(index) => {
            let strand = &mut mechanism.strands[index];
            list.extend(strand.points.iter_mut().flat_map(|point| &mut point.position));
            for wrap in &mut strand.wraps {
                if let SurfaceForm::Cylinder { axis } = &mut wrap.form {
                    list.extend(axis);
                }
                list.extend(&mut wrap.center.position);
                list.push(&mut wrap.radius);
                list.extend(wrap.side.iter_mut().flatten());
                list.extend(wrap.plane.iter_mut().flatten());
            }
            match &mut strand.law {
                Law::Linear { stiffness } => list.push(stiffness),
                Law::Muscle(muscle) => list.extend(muscle.numbers_mut()),
                Law::Energy(_) | Law::Tension(_) | Law::Prescribed => {}
            }
            list.push(&mut strand.damping);
            list.extend(&mut strand.slack);
            if let Some(friction) = &mut strand.friction {
                list.extend([&mut friction.coefficient, &mut friction.speed]);
            }
        }
        Element::Force(index) => list.extend(&mut mechanism.forces[index].point.position),
    }
    list
}
