//! Which links share a body.
//!
//! handc has a link for every coordinate; MuJoCo asks every moving body for mass. A link without
//! matter to which nothing refers and that carries exactly one link becomes one more joint of the
//! body of the link it carries: MuJoCo applies the joints of a body one after the other, each in
//! the frame that the former made, which is what a chain of links does.

use handc_runtime::mechanism::{ConstraintKind, Mechanism, Motion};
use handc_runtime::resolved::constraint_points;
use handc_runtime::structure::Structure;

/// MuJoCo's limit on degrees of freedom of one body.
const MOST_FREEDOMS: usize = 6;

/// A body: the links whose joints it has, in order. Its frame is that of the last link.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BodyPlan {
    /// Links from the outermost joint to the body's own; the last one carries the matter.
    pub(super) links: Vec<u32>,
    /// The link of the body it hangs on; `None` is the world.
    pub(super) parent: Option<u32>,
}

impl BodyPlan {
    /// The link whose frame is the body's.
    pub(super) fn link(&self) -> u32 {
        self.links[self.links.len() - 1]
    }
}

/// All bodies, parents first, and for every link whether its frame is that of a body.
pub(super) fn plan(mechanism: &Mechanism, structure: &Structure) -> (Vec<BodyPlan>, Vec<bool>) {
    let count = mechanism.links.len();
    let mut children = vec![0; count];
    for link in &mechanism.links {
        if let Some(parent) = link.parent {
            children[parent as usize] += 1;
        }
    }
    let mut is_body: Vec<bool> = children.iter().map(|&n| n != 1).collect();
    for link in referred(mechanism) {
        is_body[link as usize] = true;
    }
    let mut groups: Vec<Vec<u32>> = Vec::with_capacity(count);
    for link in 0..count {
        let mut group = match structure.parents[link] {
            Some(parent) if !is_body[parent as usize] => groups[parent as usize].clone(),
            _ => Vec::new(),
        };
        let freedoms: usize = group.iter().map(|&l| freedoms(mechanism, l)).sum();
        if freedoms + self::freedoms(mechanism, link as u32) > MOST_FREEDOMS
            && let Some(parent) = structure.parents[link]
        {
            is_body[parent as usize] = true;
            group.clear();
        }
        group.push(link as u32);
        groups.push(group);
    }
    let bodies = groups.into_iter().enumerate().filter(|(link, _)| is_body[*link]);
    let bodies =
        bodies.map(|(_, links)| BodyPlan { parent: structure.parents[links[0] as usize], links });
    (bodies.collect(), is_body)
}

/// Degrees of freedom that a link takes in MuJoCo: a screw is a hinge and a slide.
fn freedoms(mechanism: &Mechanism, link: u32) -> usize {
    match mechanism.links[link as usize].motion {
        Motion::Screw { .. } => 2,
        _ => 1,
    }
}

/// Links that carry matter or a point or axes that something refers to.
fn referred(mechanism: &Mechanism) -> Vec<u32> {
    let mut links: Vec<Option<u32>> = mechanism.bodies.iter().map(|body| body.link).collect();
    links.extend(mechanism.strands.iter().flat_map(|s| &s.points).map(|p| p.link));
    let wraps = mechanism.strands.iter().flat_map(|s| &s.wraps);
    links.extend(wraps.map(|wrap| wrap.center.link));
    for constraint in &mechanism.constraints {
        links.extend(constraint_points(&constraint.kind).iter().map(|p| p.link));
        if let ConstraintKind::Weld { first, second, .. } = constraint.kind {
            links.extend([first, second]);
        }
    }
    links.extend(mechanism.forces.iter().flat_map(|f| [f.point.link, f.axes]));
    links.into_iter().flatten().collect()
}
