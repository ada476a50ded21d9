//! Constraints as equalities: what MJCF can say of them.

use super::Exporter;
use super::law::Affine;
use super::xml::Element;
use handc_core::model::Model;
use handc_runtime::expression::{Function, Variable};
use handc_runtime::mechanism::{Constraint, ConstraintKind, Point};
use handc_runtime::vector::{Transform, Vec3};

/// Poses at which a row is looked at.
const POSES: usize = 8;

/// A row that stays below this (m) at all of them holds by itself.
const HOLDS: f64 = 1e-9;

impl Exporter<'_> {
    /// Every constraint that can be said.
    pub(super) fn constraints(&mut self) {
        let mechanism = self.mechanism;
        for constraint in &mechanism.constraints {
            if let Err(reason) = self.constraint(constraint) {
                self.warn(format!("constraint `{}` is left out: {reason}", constraint.name));
            }
        }
    }

    fn constraint(&mut self, constraint: &Constraint) -> Result<(), &'static str> {
        let name = &constraint.name;
        let both = [format!("{name}.1"), format!("{name}.2")];
        match &constraint.kind {
            ConstraintKind::Coincident { first, second, axes } => {
                if !self.other_rows_hold(first, second, *axes) {
                    return Err("MJCF joins points in all three directions");
                }
                let sites = [self.site(&both[0], first), self.site(&both[1], second)];
                self.join("connect", name, sites);
            }
            ConstraintKind::Weld { first, first_from_frame, second, second_from_frame } => {
                let places =
                    [first_from_frame, second_from_frame].map(|t| self.numbers.transform(t));
                let sites = [
                    self.framed_site(&both[0], *first, &places[0]),
                    self.framed_site(&both[1], *second, &places[1]),
                ];
                self.join("weld", name, sites);
            }
            ConstraintKind::Distance { first, second, distance } => {
                let distance = self.numbers.number(*distance);
                let path = [(&both[0], first), (&both[1], second)].map(|(wanted, point)| {
                    let site = self.site(wanted, point);
                    Element::new("site").with("site", site)
                });
                let tendon = self.tendon_names.take(name);
                let poses = self.start.model.link_poses(&vec![0.0; self.start.q.len()]);
                let apart = self.world_point(&poses, first) - self.world_point(&poses, second);
                let spatial = Element::new("spatial").with("name", &tendon);
                self.tendons.push(spatial.with_children(path));
                let at_zero = apart.norm_squared().sqrt();
                self.relate("tendon", name, [&tendon, ""], [distance - at_zero, 0.0]);
            }
            ConstraintKind::OnPlane { .. } => return Err("MJCF cannot hold a point on a plane"),
            ConstraintKind::Length(_) => {
                return Err("MJCF cannot prescribe the length of a tendon");
            }
            ConstraintKind::Equation(function) => return self.equation(name, function),
        }
        Ok(())
    }

    fn join(&mut self, kind: &'static str, name: &str, sites: [String; 2]) {
        let [first, second] = sites;
        let name = self.equality_names.take(name);
        let element = Element::new(kind).with("name", name);
        self.equalities.push(element.with("site1", first).with("site2", second));
    }

    /// first = c₀ + c₁·second, both counted from their values at zero coordinates.
    fn relate(&mut self, kind: &'static str, name: &str, pair: [&str; 2], [c0, c1]: [f64; 2]) {
        let (first, second) =
            if kind == "joint" { ("joint1", "joint2") } else { ("tendon1", "tendon2") };
        let name = self.equality_names.take(name);
        let mut element = Element::new(kind).with("name", name).with(first, pair[0]);
        if !pair[1].is_empty() {
            element = element.with(second, pair[1]);
        }
        self.equalities.push(element.with_numbers("polycoef", &[c0, c1, 0.0, 0.0, 0.0]));
    }

    fn equation(&mut self, name: &str, function: &Function) -> Result<(), &'static str> {
        let Some(affine) = self.affine(function) else {
            return Err("it is not linear in coordinates and lengths");
        };
        let Affine { constant, varies, slopes } = affine;
        if varies {
            return Err("it depends on time or on an input");
        }
        let mechanism = self.mechanism;
        let coordinate = |variable: &Variable| match variable {
            Variable::Coordinate(i) => Some(mechanism.coordinates[*i as usize].name.as_str()),
            _ => None,
        };
        let named: Option<Vec<(&str, f64)>> =
            slopes.iter().map(|(v, slope)| Some((coordinate(v)?, *slope))).collect();
        let lengths: Option<Vec<(usize, f64)>> = slopes
            .iter()
            .map(|(variable, slope)| match variable {
                Variable::Length(i) => Some((*i as usize, *slope)),
                _ => None,
            })
            .collect();
        match (named.as_deref(), lengths.as_deref()) {
            (Some([]), _) => return Err("nothing that moves stands in it"),
            (Some([(one, a)]), _) => self.relate("joint", name, [one, ""], [-constant / a, 0.0]),
            (Some([(one, a), (two, b)]), _) => {
                self.relate("joint", name, [one, two], [-constant / a, -b / a]);
            }
            (Some(many), _) => {
                let tendon = self.tendon_names.take(name);
                let joints = many.iter().map(|(joint, slope)| {
                    Element::new("joint").with("joint", *joint).with_numbers("coef", &[*slope])
                });
                let fixed = Element::new("fixed").with("name", &tendon);
                self.tendons.push(fixed.with_children(joints.collect::<Vec<_>>()));
                self.relate("tendon", name, [&tendon, ""], [-constant, 0.0]);
            }
            (None, Some(&[(one, a), ref rest @ ..])) if rest.len() < 2 => {
                let mut at_zero = vec![0.0; mechanism.strands.len()];
                self.start.model.strand_lengths(&vec![0.0; self.start.q.len()], &mut at_zero);
                let first = mechanism.strands[one].name.as_str();
                let (second, c1, offset) = match rest {
                    [(two, b)] => {
                        (mechanism.strands[*two].name.as_str(), -b / a, -b / a * at_zero[*two])
                    }
                    _ => ("", 0.0, 0.0),
                };
                let c0 = -constant / a + offset - at_zero[one];
                self.relate("tendon", name, [first, second], [c0, c1]);
            }
            _ => return Err("it mixes coordinates and lengths, or more than two lengths"),
        }
        Ok(())
    }

    /// Whether the directions in which two points are not joined close by themselves, as the third
    /// one does in a planar loop: looked at on several poses.
    fn other_rows_hold(&mut self, first: &Point, second: &Point, axes: [bool; 3]) -> bool {
        let start = self.start.q.clone();
        (0..POSES).all(|pose| {
            let off = |i: usize| 0.4 * (1.7 * (i + 1) as f64 * pose as f64).sin();
            let q: Vec<f64> = start.iter().enumerate().map(|(i, q)| q + off(i)).collect();
            let poses = self.start.model.link_poses(&q);
            let apart = self.world_point(&poses, first) - self.world_point(&poses, second);
            (0..3).all(|i| axes[i] || apart.0[i].abs() < HOLDS)
        })
    }

    fn world_point(&self, poses: &[Transform<f64>], point: &Point) -> Vec3<f64> {
        let position = self.numbers.vector(&point.position);
        point.link.map_or(position, |link| poses[link as usize].point(position))
    }
}
