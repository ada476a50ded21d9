//! Planar runs: chains of hinges about parallel axes at the end of a tree.
//!
//! In the absolute angles of its links, which are sums of coordinates, a run is cheap: turning one
//! link turns its own vectors and only shifts what it carries. All of that needs two constant
//! vectors and one constant inertia per link, with the masses carried lumped into its far joint.

use crate::mechanism::{Mechanism, Motion, NumberTransform};
use crate::resolved::{Axis, Joint, Lump, principal_axis};
use crate::structure::mass_below;
use crate::vector::{Mat3, Transform, Vec3};
use handc_core::scalar::Scalar;

/// Runs of at least two links, each from its base to its tip.
pub fn find_runs(mechanism: &Mechanism) -> Vec<Vec<u32>> {
    let has_mass_below = mass_below(mechanism);
    let count = mechanism.links.len();
    let mut heavy_children = vec![Vec::new(); count];
    for (link, l) in mechanism.links.iter().enumerate() {
        if let (true, Some(parent)) = (has_mass_below[link], l.parent) {
            heavy_children[parent as usize].push(link as u32);
        }
    }
    let hinge = |link: u32| match &mechanism.links[link as usize].motion {
        Motion::Revolute { axis } => principal_axis(axis),
        _ => None,
    };
    let is_tip =
        |link: &u32| has_mass_below[*link as usize] && heavy_children[*link as usize].is_empty();
    let mut runs = Vec::new();
    for tip in (0..count as u32).filter(is_tip) {
        let Some(axis) = hinge(tip) else { continue };
        let mut run = vec![tip];
        let mut link = tip;
        while let Some(parent) = mechanism.links[link as usize].parent {
            let turned = mechanism.links[link as usize].parent_from_joint.rotation
                != NumberTransform::IDENTITY.rotation;
            if turned || hinge(parent) != Some(axis) || heavy_children[parent as usize].len() > 1 {
                break;
            }
            run.push(parent);
            link = parent;
        }
        if run.len() > 1 {
            run.reverse();
            runs.push(run);
        }
    }
    runs
}

/// The numbers of a run, in axes of which the third is that of its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedRun<S> {
    /// The axes of the run, at its first joint, in the link that carries it.
    pub parent_from_run: Transform<S>,
    /// Mass of the whole run.
    pub mass: S,
    /// Its links from base to tip.
    pub links: Vec<RunLink<S>>,
}

/// A link that carries as a point, at its far joint, the mass of the links beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunLink<S> {
    /// From its joint to the next; zero for the tip.
    pub offset: Vec3<S>,
    /// Mass times centre.
    pub moment: Vec3<S>,
    /// Inertia about its joint: mean of xx and yy.
    pub mean: S,
    /// Half of xx − yy, and xy.
    pub deviator: [S; 2],
    /// xz and yz.
    pub tilt: [S; 2],
    /// zz.
    pub polar: S,
}

impl<S: Scalar> ResolvedRun<S> {
    /// From the joints and lumps of all links.
    pub(crate) fn new(run: &[u32], joints: &[Joint<S>], lumps: &[Option<Lump<S>>]) -> Self {
        let axis = &joints[run[0] as usize].axis;
        // Cyclic, so that the axes stay right-handed.
        let cycle = match axis {
            Axis::X => [1, 2, 0],
            Axis::Y => [2, 0, 1],
            _ => [0, 1, 2],
        };
        let mut axes = Mat3([[S::zero(); 3]; 3]);
        for (column, row) in cycle.into_iter().enumerate() {
            axes.0[row][column] = S::one();
        }
        let cycled = |v: Vec3<S>| Vec3(cycle.map(|i| v.0[i]));
        let mut mass = S::zero();
        let mut offset = Vec3::zero();
        let mut links = Vec::new();
        for &link in run.iter().rev() {
            let mut moment = offset.scale(mass);
            let mut inertia = point_inertia(mass, offset);
            if let Some(lump) = &lumps[link as usize] {
                let center = cycled(lump.center);
                moment += center.scale(lump.mass);
                let own = point_inertia(lump.mass, center);
                for i in 0..3 {
                    for j in 0..3 {
                        let deviator = lump.deviator.0[cycle[i]][cycle[j]];
                        inertia.0[i][j] += own.0[i][j] + deviator;
                    }
                    inertia.0[i][i] += lump.isotropic;
                }
                mass += lump.mass;
            }
            let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = inertia.0;
            links.push(RunLink {
                offset,
                moment,
                mean: (xx + yy).scale(0.5),
                deviator: [(xx - yy).scale(0.5), xy],
                tilt: [xz, yz],
                polar: zz,
            });
            offset = cycled(joints[link as usize].origin);
        }
        links.reverse();
        let joint = &joints[run[0] as usize];
        let rotation = joint.rotation.map_or(axes, |rotation| rotation * axes);
        let parent_from_run = Transform { rotation, translation: joint.origin };
        ResolvedRun { parent_from_run, mass, links }
    }
}

/// m(c²E − ccᵀ).
fn point_inertia<S: Scalar>(mass: S, center: Vec3<S>) -> Mat3<S> {
    let moment = center.scale(mass);
    let mut inertia = Mat3([[S::zero(); 3]; 3]);
    for i in 0..3 {
        for j in 0..3 {
            inertia.0[i][j] = -(moment.0[i] * center.0[j]);
        }
    }
    let [[xx, ..], [_, yy, _], [_, _, zz]] = inertia.0;
    // Written out, so that a centre on an axis leaves no difference of equals behind.
    inertia.0[0][0] = -(yy + zz);
    inertia.0[1][1] = -(xx + zz);
    inertia.0[2][2] = -(xx + yy);
    inertia
}
