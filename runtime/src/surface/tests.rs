//! Ways against dual numbers, against the definition of a tangent, and through contact.

use super::*;
use crate::dual::Dual;

type Twice = Dual<Dual<f64>>;

/// A small deterministic generator over −1 … 1.
struct Noise(u64);
impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn vector(&mut self) -> Vec3<f64> {
        Vec3([self.next(), self.next(), self.next()])
    }
    fn unit(&mut self) -> Vec3<f64> {
        let v = self.vector();
        v.scale(v.norm_squared().sqrt().recip())
    }
}

fn of<S: Scalar>(surface: &Surface<f64>) -> Surface<S> {
    let vector = |v: Vec3<f64>| Vec3(v.0.map(S::constant));
    Surface {
        form: match surface.form.axis() {
            None => Form::Sphere,
            Some(axis) => Form::Cylinder(Axis::General(vector(axis.vector()))),
        },
        center: vector(surface.center),
        radius: S::constant(surface.radius),
        sense: surface
            .sense
            .map(|sense| Sense { sign: S::constant(sense.sign), cut: sense.cut.map(S::constant) }),
    }
}

/// A surface that was started elsewhere, and two points outside of it where its sense is kept.
fn draw(noise: &mut Noise, kind: usize) -> (Surface<f64>, [Vec3<f64>; 2]) {
    let is_sphere = kind & 1 == 0;
    let mut surface = Surface {
        form: if is_sphere { Form::Sphere } else { Form::Cylinder(Axis::General(noise.unit())) },
        center: noise.vector(),
        radius: 0.3 + 0.2 * noise.next(),
        sense: None,
    };
    let side = (kind & 2 != 0).then(|| noise.unit());
    loop {
        let [start, points] = [0, 1].map(|_| [0, 1].map(|_| surface.center + noise.vector()));
        surface.sense = Sense::new(&surface, side, start);
        let clearances = surface.clearances(points);
        if clearances[..2].iter().all(|c| *c > 0.05) && clearances[3] > 0.01 {
            return (surface, points);
        }
    }
}

/// Gradient and Hessian of the length by all six numbers, from a way.
fn assembled(way: &Way<f64>) -> ([f64; 6], [[f64; 6]; 6]) {
    let gradient = std::array::from_fn(|i| way.ends[i / 3].direction.0[i % 3]);
    let hessian = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let (end, other) = (&way.ends[i / 3], &way.ends[j / 3]);
            let one = if i % 3 == j % 3 { 1.0 } else { 0.0 };
            let directions = end.direction.0[i % 3] * other.direction.0[j % 3];
            let binormals = end.binormal.0[i % 3] * other.binormal.0[j % 3];
            if i / 3 == j / 3 {
                end.curvature * (one - directions) + end.excess * binormals
            } else {
                let both = way.cross_bent * binormals;
                way.cross_straight * (one + directions) + both
            }
        })
    });
    (gradient, hessian)
}

#[test]
fn derivatives_are_those_of_the_length() {
    let mut noise = Noise(5);
    let (mut touching, mut beyond, mut worst) = (0, 0, 0.0f64);
    for trial in 0..4000 {
        let (surface, points) = draw(&mut noise, trial % 4);
        let way = surface.way(points);
        let straight = (points[1] - points[0]).norm_squared().sqrt();
        assert_eq!(way.length, surface.length(points));
        touching += usize::from(way.length > straight);
        beyond += usize::from(surface.turn(points).sine < 0.0);
        if surface.clearances(points)[2] < 0.02 {
            // Near the pole of a sphere the second derivatives have no bound.
            continue;
        }
        let (gradient, hessian) = assembled(&way);
        let twice = of::<Twice>(&surface);
        for i in 0..6 {
            for j in 0..6 {
                let moved = [0, 1].map(|end| {
                    Vec3(std::array::from_fn(|k| {
                        let slope = |of: usize| if of == 3 * end + k { 1.0 } else { 0.0 };
                        let value = Dual { value: points[end].0[k], slope: slope(i) };
                        Dual { value, slope: Dual::fixed(slope(j)) }
                    }))
                });
                let length = twice.length(moved);
                let off = (length.value.slope - gradient[i]).abs();
                let bent = (length.slope.slope - hessian[i][j]).abs() / 100.0;
                for found in [off, bent] {
                    worst = if found <= worst { worst } else { found };
                }
            }
        }
    }
    eprintln!("{touching} touching, {beyond} by more than half a turn: {worst:.1e}");
    assert!(touching > 1000 && beyond > 300 && worst < 1e-12);
}

/// Tangents, by their own definition: from the point of contact the strand leaves at a right
/// angle to the radius, and the piece on a cylinder climbs at the slope of the tangents.
#[test]
fn tangents_touch() {
    let mut noise = Noise(9);
    let mut count = 0;
    for trial in 0..4000 {
        let (surface, points) = draw(&mut noise, trial % 4);
        let (way, turn) = (surface.way(points), surface.turn(points));
        if way.cross_straight != 0.0 || surface.clearances(points)[2] < 1e-3 {
            continue;
        }
        count += 1;
        for (k, end) in way.ends.iter().enumerate() {
            let slope = match &surface.form {
                Form::Sphere => 0.0,
                Form::Cylinder(axis) | Form::Ring(axis) => axis.dot(end.direction),
            };
            let level = (1.0 - slope * slope).sqrt();
            let contact =
                points[k] - surface.center - end.direction.scale(turn.tangents[k] / level);
            let radius = surface.form.flat(contact);
            assert!((radius.norm_squared().sqrt() - surface.radius).abs() < 1e-12);
            assert!(radius.dot(end.direction).abs() < 1e-12);
            assert!((end.direction.norm_squared() - 1.0).abs() < 1e-12);
            assert!((end.binormal.norm_squared() - 1.0).abs() < 1e-11);
            assert!(end.binormal.dot(end.direction).abs() < 1e-12);
        }
    }
    assert!(count > 1000);
}

/// Where the strand lifts off, length and directions are those of the straight line.
#[test]
fn contact_begins_without_a_jump() {
    let mut noise = Noise(3);
    let mut count = 0;
    for trial in 0..400 {
        let (mut surface, points) = draw(&mut noise, trial % 4);
        let chord = points[1] - points[0];
        let straight = chord.norm_squared().sqrt();
        if surface.way(points).length > straight {
            continue;
        }
        // Grown until it touches.
        let (mut low, mut high) = (surface.radius, surface.radius + 10.0);
        for _ in 0..200 {
            surface.radius = 0.5 * (low + high);
            let is_free = surface.length(points) == straight;
            *(if is_free { &mut low } else { &mut high }) = surface.radius;
        }
        surface.radius = high;
        let way = surface.way(points);
        if !(way.length >= straight) {
            // It reached a point before the line between them.
            continue;
        }
        count += 1;
        assert!(way.length - straight < 1e-14, "{}", way.length - straight);
        for (end, sign) in way.ends.iter().zip([-1.0, 1.0]) {
            let jump = end.direction - chord.scale(sign / straight);
            assert!(jump.norm_squared().sqrt() < 1e-6, "{jump:?}");
        }
    }
    assert!(count > 60, "{count}");
}

#[test]
fn a_line_may_point_at_the_centre() {
    let mut surface =
        Surface { form: Form::Sphere, center: Vec3::zero(), radius: 1.0, sense: None };
    for form in [Form::Sphere, Form::Cylinder(Axis::Z)] {
        surface.form = form;
        for points in [[2.0, 3.0], [3.0, 2.0]].map(|xs| xs.map(|x| Vec3([x, 0.0, 0.0]))) {
            let (gradient, hessian) = assembled(&surface.way(points));
            let sign = (points[0].0[0] - points[1].0[0]).signum();
            assert_eq!(gradient, [sign, 0.0, 0.0, -sign, 0.0, 0.0]);
            let (one, o) = (1.0, 0.0);
            assert_eq!(hessian[0], [o; 6]);
            assert_eq!(hessian[1], [o, one, o, o, -one, o]);
            assert_eq!(hessian[5], [o, o, -one, o, o, one]);
        }
    }
}

#[test]
fn inside_is_not_a_number() {
    let mut surface =
        Surface { form: Form::Sphere, center: Vec3::zero(), radius: 1.0, sense: None };
    let (inside, outside) = (Vec3([0.5, 0.2, 0.0]), Vec3([2.0, 3.0, 1.0]));
    for form in [Form::Sphere, Form::Cylinder(Axis::Z)] {
        for side in [None, Some(Vec3([1.0, 0.0, 0.0]))] {
            surface.form = form;
            surface.sense = Sense::new(&surface, side, [outside, -outside + inside]);
            for points in [[inside, outside], [outside, inside], [inside, inside]] {
                assert!(surface.length(points).is_nan() && surface.way(points).length.is_nan());
                assert!(surface.clearances(points)[..2].iter().any(|c| *c < 0.0));
            }
        }
    }
    (surface.form, surface.sense) = (Form::Sphere, None);
    let way = surface.way([outside, -outside]);
    assert!(way.length.is_finite() && way.ends[0].direction.0[0].is_nan());
    assert!(surface.clearances([outside, -outside])[2] < 0.0);
}

/// The pieces that are drawn add up to the length, and end where the last tangent begins.
#[test]
fn traces_follow_the_way() {
    let mut noise = Noise(21);
    let mut count = 0;
    for trial in 0..400 {
        let (surface, points) = draw(&mut noise, trial % 4);
        let trace = surface.trace(points, 2000);
        let (way, turn) = (surface.way(points), surface.turn(points));
        assert_eq!(trace.is_empty(), way.cross_straight != 0.0);
        if trace.is_empty() || surface.clearances(points)[2] < 1e-3 {
            continue;
        }
        count += 1;
        let distance = |a: Vec3<f64>, b: Vec3<f64>| (b - a).norm_squared().sqrt();
        let mut sum = distance(points[0], trace[0]) + distance(trace[1999], points[1]);
        sum += trace.windows(2).map(|pair| distance(pair[0], pair[1])).sum::<f64>();
        assert!((sum - way.length).abs() < 1e-5, "{sum} {}", way.length);
        let level = turn.length / way.length;
        let last = points[1] - way.ends[1].direction.scale(turn.tangents[1] / level);
        assert!(distance(last, trace[1999]) < 1e-9);
    }
    assert!(count > 100);
}
