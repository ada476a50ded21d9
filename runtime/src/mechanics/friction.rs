//! Friction of strands that slide over their points.
//!
//! The law of a strand gives the tension T at its first point. Across a point where the path bends
//! by θ it changes by exp(−μθσ) (Euler and Eytelwein), where σ is 1 where the strand slides towards
//! its first point and −1 where it slides away, smooth in the speed w of sliding: σ = −w/√(w² + w₀²).
//! What lies beyond a point has the length that slides through it, so that w is the rate of that
//! length. With φ_k the product of these factors up to segment k, the force is −T·g with
//! g = Σ φ_k·∂d_k/∂q. It takes the power T·(g·v − ẋ) ≥ 0.
//!
//! The derivatives of g are taken by dual numbers over the scalar itself: the interpreter and the
//! compiler share them, and there is one formula.

use super::world::compose;
use super::{At, Mechanics, Terms, Workspace};
use crate::dual::Dual;
use crate::vector::{Transform, Vec3};
use handc_core::scalar::Scalar;

/// Bends are smooth below this angle (rad), where a straight path has no direction of bending.
const STRAIGHT: f64 = 1e-4;

/// A strand that slides.
struct Sliding<T> {
    /// Length x (m).
    length: T,
    /// Rate ẋ (m/s).
    rate: T,
    /// g by the coordinates of the path.
    gradient: Vec<T>,
}

/// A link between the points of a path and what carries all of them.
struct Carrier<T> {
    link: u32,
    transform: Transform<T>,
    angular: Vec3<T>,
    linear: Vec3<T>,
}

/// A segment: unit vector along it, its rate (m/s), and its slopes by the coordinates of the path.
struct Stretch<T> {
    direction: Vec3<T>,
    rate: T,
    slopes: Vec<T>,
}

impl<S: Scalar> Mechanics<'_, S> {
    /// Length, rate and gradient over a scalar to which numbers are lifted.
    fn sliding<T: Scalar>(
        &self,
        index: usize,
        lift: &impl Fn(S) -> T,
        q: impl Fn(usize) -> T,
        v: impl Fn(usize) -> T,
    ) -> Sliding<T> {
        let path = &self.structure.strands[index];
        // A point given twice has no direction to bend from.
        let mut points = self.mechanism.strands[index].points.clone();
        points.dedup();
        let friction = self.numbers.strands[index].friction;
        let (coefficient, speed) = friction.unwrap_or_else(|| (S::zero(), S::one()));
        let (coefficient, speed) = (lift(coefficient), lift(speed));
        let chains: Vec<Vec<u32>> = points.iter().map(|p| self.structure.chain(p.link)).collect();
        let carriers = self.carriers(&chains, lift, &q);
        let positions: Vec<Vec3<T>> = points
            .iter()
            .map(|point| {
                let position = Vec3(self.numbers.vector(&point.position).0.map(lift));
                place(&carriers, point.link).point(position)
            })
            .collect();
        let count = path.coordinates.len();
        let mut sliding =
            Sliding { length: T::zero(), rate: T::zero(), gradient: vec![T::zero(); count] };
        let mut stretches = Vec::with_capacity(points.len() - 1);
        for (k, pair) in positions.windows(2).enumerate() {
            let difference = pair[1] - pair[0];
            let length = difference.norm_squared().sqrt();
            let direction = difference.scale(length.recip());
            let (mut slopes, mut rate) = (vec![T::zero(); count], T::zero());
            for carrier in &carriers {
                let [first, second] = [k, k + 1].map(|i| chains[i].contains(&carrier.link));
                if first == second {
                    continue;
                }
                let arm = pair[usize::from(second)] - carrier.transform.translation;
                let along = direction.dot(carrier.angular.cross(arm) + carrier.linear);
                let slope = if second { along } else { -along };
                let coordinate = self.structure.coordinate_of[carrier.link as usize];
                if let Ok(at) = path.coordinates.binary_search(&coordinate) {
                    slopes[at] = slope;
                }
                rate += slope * v(coordinate);
            }
            sliding.length += length;
            sliding.rate += rate;
            stretches.push(Stretch { direction, rate, slopes });
        }
        let (mut beyond, mut exponent) = (sliding.rate, T::zero());
        for (k, stretch) in stretches.iter().enumerate() {
            if k > 0 {
                let before = &stretches[k - 1];
                beyond -= before.rate;
                let towards = -(beyond / (beyond * beyond + speed * speed).sqrt());
                exponent -= coefficient * bend(before.direction, stretch.direction) * towards;
            }
            let factor = exponent.exp();
            for (sum, slope) in sliding.gradient.iter_mut().zip(&stretch.slopes) {
                *sum += factor * *slope;
            }
        }
        sliding
    }

    /// The links that move points of a path against each other, in the axes of what carries all.
    fn carriers<T: Scalar>(
        &self,
        chains: &[Vec<u32>],
        lift: &impl Fn(S) -> T,
        q: &impl Fn(usize) -> T,
    ) -> Vec<Carrier<T>> {
        let moves = |link: &u32| chains.iter().any(|chain| !chain.contains(link));
        let mut links: Vec<u32> = chains.iter().flatten().copied().filter(moves).collect();
        links.sort_unstable();
        links.dedup();
        let mut carriers = Vec::with_capacity(links.len());
        for &link in &links {
            let joint = self.numbers.joints[link as usize].over(lift);
            let angle = q(self.structure.coordinate_of[link as usize]);
            let turn = if joint.rotates { angle.sin_cos() } else { (T::zero(), T::one()) };
            let parent = place(&carriers, self.structure.parents[link as usize]);
            let transform = compose(&parent, &joint, turn, angle);
            let axis = transform.rotation * joint.axis.vector();
            carriers.push(Carrier {
                link,
                transform,
                angular: if joint.rotates { axis } else { Vec3::zero() },
                linear: joint.advance.map_or_else(Vec3::zero, |advance| axis.scale(advance)),
            });
        }
        carriers
    }

    /// Adds the force of a strand with friction, and its derivatives.
    pub(super) fn add_sliding(
        &self,
        workspace: &mut Workspace<S>,
        at: &At<S>,
        index: usize,
        terms: &mut Terms<S>,
    ) {
        let h = terms.matrix.as_ref().map(|(h, _)| *h);
        let found = self.sliding(index, &|x| x, |c| at.q[c], |c| at.v[c]);
        let pull = self.pull(workspace, at, index, (found.length, found.rate), h.is_some());
        let coordinates = &self.structure.strands[index].coordinates;
        for (&row, &g) in coordinates.iter().zip(&found.gradient) {
            terms.force[row] -= pull.tension * g;
        }
        let Some(h) = h else { return };
        let (quarter, half) = (h.scale(0.25), S::constant(0.5));
        for &column in coordinates {
            // (h/4)·∂/∂q_j + ½·∂/∂v_j in one direction.
            let seed = |value: S, c: usize, slope: S| match c == column {
                true => Dual { value, slope },
                false => Dual::fixed(value),
            };
            let q = |c: usize| seed(at.q[c], c, quarter);
            let v = |c: usize| seed(at.v[c], c, half);
            let moved = self.sliding(index, &Dual::fixed, q, v);
            let mut tension_slope = pull.length_slope * moved.length.slope;
            if let Some(slope) = pull.rate_slope {
                tension_slope += slope * moved.rate.slope;
            }
            for (&row, g) in coordinates.iter().zip(&moved.gradient) {
                let value = -(tension_slope * g.value + pull.tension * g.slope);
                self.add_entry(row, column, value, terms);
            }
        }
        for (column, slope) in self.others(&pull, h) {
            for (&row, &g) in coordinates.iter().zip(&found.gradient) {
                self.add_entry(row, column, -(slope * g), terms);
            }
        }
    }

    /// g·v − ẋ: the power that friction takes per unit of tension (m/s).
    pub(super) fn sliding_loss(&self, at: &At<S>, index: usize) -> S {
        let found = self.sliding(index, &|x| x, |c| at.q[c], |c| at.v[c]);
        let mut sum = -found.rate;
        for (&c, &g) in self.structure.strands[index].coordinates.iter().zip(&found.gradient) {
            sum += g * at.v[c];
        }
        sum
    }
}

/// Where a link is; the identity for what carries the whole path.
fn place<T: Scalar>(carriers: &[Carrier<T>], link: Option<u32>) -> Transform<T> {
    let carrier = carriers.iter().find(|carrier| Some(carrier.link) == link);
    carrier.map_or_else(Transform::identity, |carrier| carrier.transform)
}

/// The angle between two directions, 2·atan2(|e − e'|, |e + e'|), smooth where it is zero or π.
fn bend<T: Scalar>(first: Vec3<T>, second: Vec3<T>) -> T {
    let smooth = |v: Vec3<T>| (v.norm_squared() + T::constant(STRAIGHT * STRAIGHT)).sqrt();
    smooth(first - second).atan2(smooth(first + second)).scale(2.0)
}
