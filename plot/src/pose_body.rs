//! Drawing one pose: bodies from far to near, then strands, joints and points of the world.

use crate::canvas::{Canvas, Color, GREY, Place, Stroke};
use crate::outline;
use crate::pose::{Pose, Solid, Spot};
use crate::view::dot;

/// How a solid is drawn.
struct Look {
    fill: Color,
    ball: Color,
    edge: Stroke,
}

const BODY: Look = Look {
    fill: [214, 214, 214],
    ball: [240, 236, 226],
    edge: Stroke::solid([150, 150, 150], 0.5),
};
/// A surface to be wrapped is told from bodies by its outline.
const SURFACE: Look =
    Look { fill: [226, 234, 242], ball: [226, 234, 242], edge: Stroke::solid([90, 115, 145], 0.6) };
const FORCE: Color = [180, 20, 30];
/// Length of an arrow's head.
const HEAD: f64 = 6.0;
const BAR: Stroke = Stroke::solid([170, 170, 170], 2.2);

/// Draws a pose. `place` takes space to paper, with `scale` points per metre, and `near` points to
/// the reader.
pub(crate) fn draw_pose(
    canvas: &mut dyn Canvas,
    pose: &Pose,
    place: &impl Fn(Spot) -> Place,
    scale: f64,
    near: Spot,
    colors: &[Color],
) {
    let finite = |spots: &[Spot]| spots.iter().flatten().all(|x| x.abs() < 1e30);
    for bar in pose.bars.iter().filter(|bar| finite(&bar[..])) {
        canvas.line(&bar.map(place), &BAR);
    }
    let depth = |solid: &Solid| {
        let spots = solid.spots();
        spots.iter().map(|s| dot(*s, near)).sum::<f64>() / spots.len().max(1) as f64
    };
    let bodies = pose.solids.iter().map(|solid| (solid, &BODY));
    let surfaces = pose.surfaces.iter().map(|surface| (surface, &SURFACE));
    let mut solids: Vec<(&Solid, &Look)> =
        bodies.chain(surfaces).filter(|(solid, _)| finite(&solid.spots())).collect();
    solids.sort_by(|a, b| depth(a.0).total_cmp(&depth(b.0)));
    for (solid, look) in solids {
        draw_solid(canvas, solid, look, place, scale);
    }
    for (path, color) in pose.strands.iter().zip(colors).filter(|(path, _)| finite(path)) {
        let points: Vec<Place> = path.iter().map(|spot| place(*spot)).collect();
        canvas.line(&points, &Stroke::solid(*color, 0.8));
    }
    for joint in pose.joints.iter().filter(|joint| finite(&[**joint])) {
        canvas.disc(place(*joint), 1.3, [255, 255, 255], Some(&Stroke::solid(GREY, 0.5)));
    }
    for anchor in pose.anchors.iter().filter(|anchor| finite(&[**anchor])) {
        let [x, y] = place(*anchor);
        canvas.polygon(
            &[[x - 1.0, y - 1.0], [x + 1.0, y - 1.0], [x + 1.0, y + 1.0], [x - 1.0, y + 1.0]],
            GREY,
            None,
        );
    }
}

/// Draws a force as an arrow.
pub(crate) fn draw_force(canvas: &mut dyn Canvas, from: Place, to: Place) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy);
    if !(length > 1e-6 && length < 1e30) {
        return;
    }
    let (ux, uy) = (dx / length, dy / length);
    let head = HEAD.min(length);
    let neck = [to[0] - head * ux, to[1] - head * uy];
    canvas.line(&[from, neck], &Stroke::solid(FORCE, 1.4));
    let side = 0.42 * head;
    let barbs = [1.0, -1.0].map(|sign| [neck[0] - sign * side * uy, neck[1] + sign * side * ux]);
    canvas.polygon(&[to, barbs[0], barbs[1]], FORCE, None);
}

fn draw_solid(
    canvas: &mut dyn Canvas,
    solid: &Solid,
    look: &Look,
    place: &impl Fn(Spot) -> Place,
    scale: f64,
) {
    let edge = Some(&look.edge);
    match solid {
        Solid::Rod { from, to, radius } if solid.is_wheel() => {
            let rim = outline::wheel(*from, *to, *radius).into_iter().map(place).collect();
            canvas.polygon(&outline::hull(rim), look.fill, edge);
        }
        Solid::Rod { from, to, .. } => {
            let radius = (solid.radius() * scale).max(1.0);
            canvas.polygon(&outline::capsule(place(*from), place(*to), radius), look.fill, edge);
        }
        Solid::Ball { center, .. } => {
            let radius = (solid.radius() * scale).max(1.0);
            canvas.disc(place(*center), radius, look.ball, edge);
        }
        Solid::Block(corners) => {
            for (i, j) in (0..8usize).flat_map(|i| [1, 2, 4].map(|bit| (i, i | bit))) {
                if i != j {
                    canvas.line(&[place(corners[i]), place(corners[j])], &look.edge);
                }
            }
        }
        Solid::Mass(at) => canvas.disc(place(*at), 2.2, [120, 120, 120], None),
    }
}
