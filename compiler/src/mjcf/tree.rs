//! The tree of bodies: joints, inertias, and sites for frames and points.

use super::Exporter;
use super::inertia::{Change, LEAST, accepted};
use super::xml::{Element, number};
use handc_runtime::mechanism::{Body, Point};
use handc_runtime::vector::{Mat3, Transform};

/// Bodies whose matter MuJoCo does not take as it is.
#[derive(Clone, Debug, Default)]
pub(super) struct Matter {
    without_mass: Vec<String>,
    points: Vec<String>,
    impossible: Vec<String>,
}

impl Exporter<'_> {
    /// A new site at a point (position in link axes, m); returns its name.
    pub(super) fn site(&mut self, wanted: &str, point: &Point) -> String {
        let transform = Transform {
            rotation: Mat3::identity(),
            translation: self.numbers.vector(&point.position),
        };
        self.framed_site(wanted, point.link, &transform)
    }

    /// A new site with axes of its own.
    pub(super) fn framed_site(
        &mut self,
        wanted: &str,
        link: Option<u32>,
        place: &Transform<f64>,
    ) -> String {
        let name = self.site_names.take(wanted);
        let site = placed(Element::new("site").with("name", &name), place);
        self.sites[link.map_or(0, |l| l as usize + 1)].push(site);
        name
    }

    /// Names of bodies, and sites for all other named frames.
    pub(super) fn name_frames(&mut self) {
        let mechanism = self.mechanism;
        let mut left_out = Vec::new();
        for frame in &mechanism.frames {
            let place = self.numbers.transform(&frame.link_from_frame);
            let is_identity = place == Transform::identity();
            match frame.link {
                None if is_identity => {}
                Some(link) if !self.is_body[link as usize] => {
                    if !is_identity {
                        left_out.push(frame.name.as_str());
                    }
                }
                Some(link) if is_identity && self.body_names[link as usize].is_empty() => {
                    self.body_names[link as usize] = self.body_taken.take(&frame.name);
                }
                link => {
                    self.framed_site(&frame.name, link, &place);
                }
            }
        }
        for link in (0..mechanism.links.len()).filter(|&link| self.is_body[link]) {
            if self.body_names[link].is_empty() {
                let coordinate = &mechanism.coordinates[mechanism.links[link].coordinate as usize];
                self.body_names[link] = self.body_taken.take(&coordinate.name);
            }
        }
        self.warn_of(
            "fixed between joints without mass, where MuJoCo has no body; the frame is left out",
            &left_out,
        );
    }

    /// The world with all that is in it.
    pub(super) fn world(&mut self) -> Element {
        let mechanism = self.mechanism;
        let mut world = std::mem::take(&mut self.sites[0]);
        for body in mechanism.bodies.iter().filter(|body| body.link.is_none()) {
            let name = self.body_taken.take(&body.name);
            let (mass, center, inertia) = self.body_matter(body);
            let element = Element::new("body").with("name", name);
            world.push(element.with_children([inertial(mass, center, inertia)]));
        }
        let roots = (0..self.bodies.len()).filter(|&i| self.bodies[i].parent.is_none());
        let roots: Vec<usize> = roots.collect();
        world.extend(roots.into_iter().map(|root| self.body(root)).collect::<Vec<_>>());
        self.tell_of_matter();
        Element::new("worldbody").with_children(world)
    }

    /// A body with all that hangs on it.
    fn body(&mut self, index: usize) -> Element {
        let plan = self.bodies[index].clone();
        let link = plan.link();
        let mut rest = Transform::identity();
        for &link in &plan.links {
            rest = rest
                * self.numbers.transform(&self.mechanism.links[link as usize].parent_from_joint);
        }
        let name = self.body_names[link as usize].clone();
        let mut children = self.joints(&plan);
        children.insert(0, self.link_inertial(link));
        children.append(&mut self.sites[link as usize + 1]);
        let below = (0..self.bodies.len()).filter(|&i| self.bodies[i].parent == Some(link));
        for child in below.collect::<Vec<_>>() {
            children.push(self.body(child));
        }
        placed(Element::new("body").with("name", name), &rest).with_children(children)
    }

    /// The matter of a link, at least as much as MuJoCo asks for.
    fn link_inertial(&mut self, link: u32) -> Element {
        let mechanism = self.mechanism;
        let bodies: Vec<&Body> =
            mechanism.bodies.iter().filter(|body| body.link == Some(link)).collect();
        let (mass, center, inertia) = match (&self.numbers.lumps[link as usize], &bodies[..]) {
            // As written, without the rounding of lumping.
            (_, [only]) => self.body_matter(only),
            (Some(lump), _) if lump.mass > 0.0 => {
                let d = &lump.deviator.0;
                let i = lump.isotropic;
                let entries = [d[0][0] + i, d[1][1] + i, d[2][2] + i, d[0][1], d[0][2], d[1][2]];
                (lump.mass, lump.center.0, entries)
            }
            _ => (0.0, [0.0; 3], [0.0; 6]),
        };
        let (entries, change) = accepted(inertia);
        let name = self.body_names[link as usize].clone();
        match change {
            _ if mass < LEAST => self.matter.without_mass.push(name),
            Change::None => {}
            Change::Least => self.matter.points.push(name),
            Change::Raised => self.matter.impossible.push(name),
        }
        inertial(mass.max(LEAST), center, entries)
    }

    fn tell_of_matter(&mut self) {
        let least = number(LEAST);
        let found = std::mem::take(&mut self.matter);
        self.warn_of(
            &format!("no mass; MuJoCo gets {least} kg and {least} kg m^2, the least it loads"),
            &found.without_mass,
        );
        self.warn_of(
            &format!("no inertia about some axis; MuJoCo gets {least} kg m^2, the least it loads"),
            &found.points,
        );
        self.warn_of(
            "no body has such an inertia and MuJoCo loads none; its smallest moment is raised",
            &found.impossible,
        );
        let bare = (0..self.mechanism.links.len())
            .filter(|&l| !self.structure.has_mass_below[l])
            .map(|l| self.mechanism.links[l].coordinate as usize)
            .filter(|&c| !self.start.driven[c])
            .map(|c| self.mechanism.coordinates[c].name.clone())
            .collect::<Vec<_>>();
        self.warn_of(
            "nothing that has mass moves with it; handc solves that within the step, MuJoCo cannot",
            &bare,
        );
        let still = self.structure.without_inertia(self.mechanism).into_iter();
        let still: Vec<String> =
            still.map(|c| self.mechanism.coordinates[c].name.clone()).collect();
        self.warn_of("without inertia in handc, since quasi-static strands hold it; MuJoCo keeps its inertia", &still);
    }

    fn body_matter(&self, body: &Body) -> (f64, [f64; 3], [f64; 6]) {
        let center = self.numbers.vector(&body.center).0;
        (self.numbers.number(body.mass), center, body.inertia.map(|i| self.numbers.number(i)))
    }
}

fn inertial(mass: f64, center: [f64; 3], entries: [f64; 6]) -> Element {
    let element =
        Element::new("inertial").with_numbers("pos", &center).with_numbers("mass", &[mass]);
    if entries[3..].iter().all(|&i| i == 0.0) {
        element.with_numbers("diaginertia", &entries[..3])
    } else {
        element.with_numbers("fullinertia", &entries)
    }
}

/// An element with a position and, where it turns, a quaternion.
pub(super) fn placed(element: Element, place: &Transform<f64>) -> Element {
    let element = element.with_numbers("pos", &place.translation.0);
    if place.rotation == Mat3::identity() {
        element
    } else {
        element.with_numbers("quat", &quaternion(&place.rotation))
    }
}

/// Unit quaternion w x y z of a rotation, from its largest component so that no digits are lost.
fn quaternion(rotation: &Mat3<f64>) -> [f64; 4] {
    let r = &rotation.0;
    let squares = [
        1.0 + r[0][0] + r[1][1] + r[2][2],
        1.0 + r[0][0] - r[1][1] - r[2][2],
        1.0 - r[0][0] + r[1][1] - r[2][2],
        1.0 - r[0][0] - r[1][1] + r[2][2],
    ];
    let largest = (0..4).max_by(|&a, &b| squares[a].total_cmp(&squares[b])).unwrap_or(0);
    let (x, y, z) = (r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]);
    let (xy, xz, yz) = (r[0][1] + r[1][0], r[0][2] + r[2][0], r[1][2] + r[2][1]);
    let s = squares[largest];
    let q = match largest {
        0 => [s, x, y, z],
        1 => [x, s, xy, xz],
        2 => [y, xy, s, yz],
        _ => [z, xz, yz, s],
    };
    let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
    q.map(|c| c / norm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quaternions_turn_as_their_rotations_do() {
        for (axis, angle) in
            [([0.0, 0.0, 1.0], 0.06), ([0.6, 0.0, 0.8], 3.1), ([0.0, 1.0, 0.0], -2.5)]
        {
            let (s, c) = f64::sin_cos(angle / 2.0);
            let [x, y, z] = axis.map(|a| a * s);
            let rotation = Mat3([
                [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - c * z), 2.0 * (x * z + c * y)],
                [2.0 * (x * y + c * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - c * x)],
                [2.0 * (x * z - c * y), 2.0 * (y * z + c * x), 1.0 - 2.0 * (x * x + y * y)],
            ]);
            let q = quaternion(&rotation);
            let sign = if q[0] * c < 0.0 { -1.0 } else { 1.0 };
            for (a, b) in q.iter().zip([c, x, y, z]) {
                assert!((a * sign - b).abs() < 1e-15, "{q:?}");
            }
        }
    }
}
