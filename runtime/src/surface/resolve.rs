//! The numbers of a surface, and where its strand starts.

use super::{Form, Sense, Surface};
use crate::expression::Variable;
use crate::mechanics::world::compose;
use crate::mechanism::{Mechanism, Strand, SurfaceForm, Wrap};
use crate::resolved::Resolved;
use crate::vector::Transform;
use handc_core::scalar::{Comparison, Scalar};

impl<S: Scalar> Resolved<S> {
    /// A surface that a strand wraps, in the axes of the link that carries it.
    pub fn surface(&self, strand: &Strand, wrap: &Wrap) -> Surface<S> {
        // A radius below zero has no surface: what hangs on it is not a number.
        let (radius, zero, none) = (self.number(wrap.radius), S::zero(), S::constant(f64::NAN));
        let mut surface = Surface {
            form: match (&wrap.form, &wrap.plane) {
                (SurfaceForm::Sphere, None) => Form::Sphere,
                (SurfaceForm::Sphere, Some(normal)) => Form::Ring(self.axis(normal)),
                (SurfaceForm::Cylinder { axis }, _) => Form::Cylinder(self.axis(axis)),
            },
            center: self.vector(&wrap.center.position),
            radius: S::select(Comparison::LessEqual, zero, radius, radius, none),
            sense: None,
        };
        let link = wrap.center.link.map(|link| &self.start[link as usize]);
        let points = [0, 1].map(|k| {
            let point = &strand.points[wrap.gap as usize + k];
            let position = self.vector(&point.position);
            match (point.link, link) {
                (from, _) if from == wrap.center.link => position,
                (None, Some(link)) => link.inverse_point(position),
                (Some(from), None) => self.start[from as usize].point(position),
                (Some(from), Some(link)) => {
                    link.inverse_point(self.start[from as usize].point(position))
                }
                (None, None) => position,
            }
        });
        let side = wrap.side.as_ref().map(|side| self.vector(side));
        surface.sense = Sense::new(&surface, side, points);
        surface
    }

    /// `world_from_link` where the model itself starts; driven coordinates where their drive begins.
    pub(crate) fn start(&self, mechanism: &Mechanism) -> Vec<Transform<S>> {
        let mut poses: Vec<Transform<S>> = Vec::with_capacity(mechanism.links.len());
        for (link, joint) in mechanism.links.iter().zip(&self.joints) {
            let coordinate = &mechanism.coordinates[link.coordinate as usize];
            let q = match &coordinate.drive {
                None => self.number(coordinate.start),
                Some(drive) => drive.value(|variable| match variable {
                    Variable::Param(i) => self.params[i as usize],
                    _ => S::zero(),
                }),
            };
            let parent = link.parent.map(|parent| poses[parent as usize]);
            let parent = parent.unwrap_or_else(Transform::identity);
            poses.push(compose(&parent, joint, q.sin_cos(), q));
        }
        poses
    }
}
