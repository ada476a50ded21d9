//! A segment over a surface, in the axes of the link that carries it.
//!
//! With u, b, κ and c of the way's ends ([`Way`]), w the (signed) axis of a joint and r the motion of
//! the end on its side by its coordinate,
//!
//! x_j = u·r_j,  x_jk = κ(r_j·r_k − x_j x_k) + (u × w_j)·r_k + c(b·r_j)(b·r_k)
//!
//! for joints on one side, j the one nearer the surface; for joints on both,
//! x_jk = `cross_straight`·(r_j·r_k + x_j x_k) + `cross_bent`·(b_p·r_j)(b_q·r_k).
//!
//! [`Way`]: crate::surface::Way

use super::segment::{Order, Segments};
use super::{Mechanics, Workspace};
use crate::structure::SegmentPath;
use crate::surface::Surface;
use crate::vector::Vec3;
use handc_core::passage::CLEARANCES;
use handc_core::scalar::Scalar;

impl<S: Scalar> Mechanics<'_, S> {
    /// Adds a segment over a surface; `points` are its ends in their links' axes.
    pub(crate) fn wrapped_segment(
        &self,
        sin_cos: &[(S, S)],
        q: &[S],
        path: &SegmentPath,
        (surface, points): (&Surface<S>, [Vec3<S>; 2]),
        order: Order,
        out: &mut Segments<S>,
    ) {
        let [first, second] = points;
        if order == Order::Length {
            let first = self.place_along(sin_cos, q, &path.first, first);
            let second = self.place_along(sin_cos, q, &path.second, second);
            out.length += surface.length([first, second]);
            return;
        }
        let crossings = &mut out.crossings;
        crossings.clear();
        let first = self.walk(sin_cos, q, &path.first, first, crossings, 0);
        let split = crossings.len();
        let second = self.walk(sin_cos, q, &path.second, second, crossings, split);
        let way = surface.way([first, second]);
        out.length += way.length;
        let side = |crossing: usize| usize::from(crossing >= split);
        let start = out.length_dq.len();
        for (i, crossing) in crossings.iter_mut().enumerate() {
            let end = &way.ends[side(i)];
            crossing.arrive(Vec3::zero());
            out.length_dq.push(end.direction.dot(crossing.motion));
        }
        if order != Order::Second {
            return;
        }
        let length_dq = &out.length_dq[start..];
        out.inverse.push(S::one());
        for (i, nearer) in crossings.iter().enumerate() {
            let end = &way.ends[side(i)];
            let bent = end.binormal.dot(nearer.motion);
            let turning = nearer.turning(end.direction) + nearer.motion.scale(end.curvature);
            for (j, outer) in crossings[..=i].iter().enumerate() {
                let other = &way.ends[side(j)];
                let bends = bent * other.binormal.dot(outer.motion);
                let product = length_dq[i] * length_dq[j];
                let square = if side(i) == side(j) {
                    turning.dot(outer.motion) - end.curvature * product + end.excess * bends
                } else {
                    way.cross_straight * (nearer.motion.dot(outer.motion) + product)
                        + way.cross_bent * bends
                };
                // A joint that moves both ends has two entries beside the diagonal, of which one is
                // visited.
                let is_twice = i != j && path.positions[i] == path.positions[j];
                out.squares.push(if is_twice { square.scale(2.0) } else { square });
            }
        }
    }

    /// How far every surface is from being impassable at q, [`CLEARANCES`] numbers each
    /// ([`Surface::clearances`]).
    pub fn clearances(&self, workspace: &mut Workspace<S>, q: &[S], clearances: &mut [S]) {
        self.prepare(workspace, q);
        self.world_links(workspace, q, |_| true);
        let strands = self.mechanism.strands.iter();
        let wraps = strands.flat_map(|s| s.wraps.iter().map(move |wrap| (s, wrap)));
        for ((strand, wrap), found) in wraps.zip(clearances.chunks_mut(CLEARANCES)) {
            let world_from_link = self.world_from(workspace, wrap.center.link);
            let points = [0, 1].map(|k| {
                let point = &strand.points[wrap.gap as usize + k];
                let world = self.world_from(workspace, point.link);
                world_from_link.inverse_point(world.point(self.numbers.vector(&point.position)))
            });
            found.copy_from_slice(&self.numbers.surface(strand, wrap).clearances(points));
        }
    }
}
