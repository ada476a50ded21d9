//! Whether the strand over a sphere stays in a plane, so that its side can be kept.

use crate::mechanism::{Mechanism, Number, NumberVector, Point, Strand, Wrap};
use crate::resolved::Resolved;
use crate::structure::{PathStep, segment_path};
use crate::vector::Vec3;

/// Rounding that is allowed of products of unit vectors, and beside the plane in radii.
pub(super) const EVEN: f64 = 1e-9;

/// The spheres with a hint, by strand and surface, each with the normal (in its link's axes) of the
/// plane through its centre in which its two points stay, with the parameters' defaults; `None` where
/// they do not.
pub fn planes(mechanism: &Mechanism) -> Vec<([usize; 2], Option<NumberVector>)> {
    let strands = mechanism.strands.iter().enumerate();
    let wraps = strands.flat_map(|(s, strand)| {
        strand.wraps.iter().enumerate().map(move |(w, wrap)| ([s, w], strand, wrap))
    });
    let mut wraps =
        wraps.filter(|(_, _, wrap)| wrap.side.is_some() && !wrap.is_cylinder()).peekable();
    if wraps.peek().is_none() {
        return Vec::new();
    }
    let defaults: Vec<f64> = mechanism.params.iter().map(|p| p.default).collect();
    let numbers = Resolved::new(mechanism, &defaults);
    wraps.map(|(place, strand, wrap)| (place, plane(mechanism, &numbers, strand, wrap))).collect()
}

fn plane(
    mechanism: &Mechanism,
    numbers: &Resolved<f64>,
    strand: &Strand,
    wrap: &Wrap,
) -> Option<NumberVector> {
    let unit = |v: Vec3<f64>| v.scale(1.0 / v.norm_squared().sqrt());
    let turned = |link: Option<u32>, v: Vec3<f64>| {
        link.map_or(v, |link| numbers.start[link as usize].rotation * v)
    };
    let place = |point: Point| {
        let position = numbers.vector(&point.position);
        point.link.map_or(position, |link| numbers.start[link as usize].point(position))
    };
    let gap = wrap.gap as usize;
    let points = [strand.points[gap], strand.points[gap + 1]];
    let center = place(wrap.center);
    let [p, q] = points.map(|point| unit(place(point) - center));
    let paths = segment_path(mechanism, points, Some(wrap)).unwrap_or_default();
    let joints: Vec<_> = paths
        .iter()
        .flatten()
        .map(|step: &PathStep| {
            let joint = &numbers.joints[step.link() as usize];
            (joint, turned(Some(step.link()), joint.axis.vector()))
        })
        .collect();
    // A hinge tells the plane exactly; without one the points do.
    let hinge = joints.iter().find(|(joint, _)| joint.rotates).map(|(_, axis)| *axis);
    let normal = hinge.unwrap_or_else(|| unit(p.cross(q)));
    let keeps = |joint: &crate::resolved::Joint<f64>, axis: Vec3<f64>| {
        let along = normal.dot(axis).abs();
        match (joint.rotates, joint.advance) {
            (true, None) => along > 1.0 - EVEN,
            (true, Some(_)) => false,
            (false, _) => along < EVEN,
        }
    };
    let stays = [p, q].iter().all(|arm| normal.dot(*arm).abs() < EVEN)
        && joints.iter().all(|(joint, axis)| keeps(joint, *axis));
    let back = match wrap.center.link {
        None => normal,
        Some(link) => numbers.start[link as usize].rotation.transpose_mul(normal),
    };
    // An axis of coordinates stays one.
    let even = |x: f64| if (x - x.round()).abs() < EVEN { x.round() + 0.0 } else { x };
    stays.then(|| back.0.map(|x| Number::Constant(even(x))))
}
