//! Curves against their published values, derivatives against dual numbers, corners against jumps.

use super::ResolvedMuscle;
use super::curves::{
    Curve, active, passive, passive_energy, tendon, tendon_energy, tendon_taut, velocity,
};
use crate::dual::Dual;
use handc_core::scalar::Scalar;

type Two = Dual<Dual<f64>>;

fn sweep(from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..=4000).map(move |i| from + (to - from) * f64::from(i) / 4000.0)
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
}

/// A curve's slope is its derivative, and neither that nor the curvature jumps anywhere: over a
/// small interval the curvature changes by no more than a few of its largest slopes.
fn is_smooth(name: &str, from: f64, to: f64, curve: impl Fn(Two) -> Curve<Two>) {
    let mut before: Option<(f64, f64)> = None;
    let mut steepest: f64 = 0.0;
    let mut jumps: f64 = 0.0;
    for x in sweep(from, to) {
        let x =
            Dual { value: Dual { value: x, slope: 1.0 }, slope: Dual { value: 1.0, slope: 0.0 } };
        let Curve { value, slope } = curve(x);
        let (first, second) = (value.slope.value, value.slope.slope);
        near(slope.value.value, first, 1e-12 * (1.0 + first.abs()));
        near(slope.value.slope, second, 1e-11 * (1.0 + second.abs()));
        if let Some((x0, curvature)) = before {
            let change = (second - curvature).abs();
            jumps = jumps.max(change);
            steepest = steepest.max(change / (x.value.value - x0));
        }
        before = Some((x.value.value, second));
    }
    // Ten times finer, a jump would stay and a slope shrink.
    let step = (to - from) / 4000.0;
    assert!(jumps <= 1.001 * steepest * step, "{name}");
    let fine = |x: f64| {
        let x =
            Dual { value: Dual { value: x, slope: 1.0 }, slope: Dual { value: 1.0, slope: 0.0 } };
        curve(x).value.slope.slope
    };
    let worst = sweep(from, to).map(|x| (fine(x + 1e-7 * step) - fine(x)).abs());
    let worst = worst.fold(0.0, f64::max);
    assert!(worst <= 1e-4 * jumps + 1e-9, "{name}: the curvature jumps by {worst}");
}

#[test]
fn curves_are_twice_differentiable() {
    let c = Two::constant;
    is_smooth("active", 0.2, 1.9, active);
    is_smooth("passive", 0.1, 1.7, |x| passive(x, c(1.0 / 0.6)));
    is_smooth("tendon", -0.5, 1.5, tendon);
    is_smooth("velocity", -1.2, 1.0, |x| velocity(x, c(1.4)));
    is_smooth("velocity, young", -1.2, 1.0, |x| velocity(x, c(1.8)));
}

#[test]
fn forces_are_derivatives_of_energies() {
    for x in sweep(-0.5, 1.5) {
        let at = Dual { value: x, slope: 1.0 };
        near(tendon_energy(at).slope, tendon(x).value, 1e-14);
        near(
            passive_energy(at + Dual::constant(0.5), Dual::constant(0.6)).slope,
            passive(x + 0.5, 1.0 / 0.6).value,
            1e-13,
        );
    }
    assert_eq!(tendon_energy(-0.2), 0.0);
    assert_eq!(passive_energy(0.7, 0.6), 0.0);
}

#[test]
fn active_fibres_pull_as_published() {
    near(active(1.0).value, 1.0, 0.0);
    near(active(1.3).value, (-0.09f64 / 0.45).exp(), 1e-15);
    near(active(0.55).value, (-0.2025f64 / 0.45).exp(), 1e-15);
}

#[test]
fn passive_fibres_pull_as_published() {
    near(passive(1.6, 1.0 / 0.6).value, 1.0, 1e-14);
    near(passive(1.3, 1.0 / 0.6).value, 2.5f64.exp_m1() / 5f64.exp_m1(), 1e-15);
    near(passive(0.8, 1.0 / 0.6).value, 0.0, 0.0);
    // Fully shortened fibres resist more than active ones pull.
    assert!(passive(0.0, 1.0 / 0.6).value < -1.0 && active(0.0).value < 0.2);
}

#[test]
fn tendon_pulls_as_published() {
    near(tendon(1.0).value, 1.0, 1e-15);
    near(tendon(1.0).slope, 1.712, 1e-3);
    near(tendon(0.3).value, 0.33 * (3.0 * 0.3 / 0.609f64).exp_m1() / 3f64.exp_m1(), 1e-4);
    near(tendon(1.3).value, 1.0 + 0.3 * tendon(1.0).slope, 1e-15);
    near(tendon(-0.2).value, 0.0, 0.0);
    assert_eq!((tendon_taut(-0.1), tendon_taut(0.0), tendon_taut(0.1)), (0.0, 0.5, 1.0));
    let mut before = 0.0;
    for x in sweep(-0.5, 1.5) {
        let slope = tendon(x).slope;
        assert!(slope >= before, "the tendon softens at {x}");
        before = slope;
    }
}

#[test]
fn velocity_acts_as_published() {
    near(velocity(-1.0, 1.4).value, 0.0, 1e-15);
    near(velocity(0.0, 1.4).value, 1.0, 1e-15);
    near(velocity(-0.25, 1.4).value, 0.75 / 2.0, 1e-15);
    // Thelen's equation 6 for lengthening, at a force of 1.2.
    let at = (1.2 - 1.0) * (1.4 - 1.0) / ((2.0 + 2.0 / 0.25) * (1.4 - 1.2));
    near(velocity(at, 1.4).value, 1.2, 1e-15);
    near(velocity(1e9, 1.4).value, 1.4, 1e-9);
    for x in sweep(-1.2, 1.0) {
        assert!(velocity(x, 1.4).slope > 0.0, "lengthening faster weakens at {x}");
        assert!(velocity(x, 1.05).slope > 0.0);
    }
}

fn muscle() -> ResolvedMuscle<f64> {
    ResolvedMuscle {
        max_force: 60.0,
        optimal_fibre: 0.066,
        per_optimal: 1.0 / 0.066,
        thickness: Some(0.12f64.sin().powi(2)),
        tendon_slack: 0.3,
        tendon_stretch: [0.0099, 1.0 / 0.0099],
        per_velocity: 0.1,
        passive_strain: [0.6, 1.0 / 0.6],
        eccentric: 1.4,
        damping: Some(0.05),
        per_time: [1.0 / 0.015, 1.0 / 0.05],
        action: 60.0 * 0.066 * 0.015,
    }
}

/// The same muscle over dual numbers.
fn muscle_dual() -> ResolvedMuscle<Dual<f64>> {
    let m = muscle();
    let c = Dual::constant;
    ResolvedMuscle {
        max_force: c(m.max_force),
        optimal_fibre: c(m.optimal_fibre),
        per_optimal: c(m.per_optimal),
        thickness: m.thickness.map(c),
        tendon_slack: c(m.tendon_slack),
        tendon_stretch: m.tendon_stretch.map(c),
        per_velocity: c(m.per_velocity),
        passive_strain: m.passive_strain.map(c),
        eccentric: c(m.eccentric),
        damping: m.damping.map(c),
        per_time: m.per_time.map(c),
        action: c(m.action),
    }
}

#[test]
fn fibres_have_their_derivatives() {
    for (s, v, a) in [(0.05, 0.1, 0.3), (0.07, -0.2, 0.9), (0.03, 0.001, 0.02), (0.1, -0.004, 0.5)]
    {
        for which in 0..3 {
            let mut at = [s, v, a].map(Dual::constant);
            at[which].slope = 1.0;
            let found = muscle().fibres(s, v, a).by[which];
            let expected = muscle_dual().fibres(at[0], at[1], at[2]).force.slope;
            near(found, expected, 1e-12 * expected.abs());
        }
        for u in [0.0, a - 0.02, a + 0.03, 1.0] {
            let found = muscle().activation(u, a);
            let expected = muscle_dual()
                .activation(Dual::constant(u), Dual { value: a, slope: 1.0 })
                .value
                .slope;
            near(found.slope, expected, 1e-12 * expected.abs());
        }
    }
}

#[test]
fn activation_has_two_time_constants() {
    let m = muscle();
    near(m.activation(1.0, 0.2).value, 0.8 / (0.015 * 0.8), 1e-12);
    near(m.activation(0.1, 0.6).value, -0.5 / (0.05 / 1.4), 1e-12);
    assert_eq!(m.activation(0.4, 0.4).value, 0.0);
}

#[test]
fn powers_are_forces_times_rates() {
    let m = muscle();
    let (s, v, a) = (0.06, -0.1, 0.7);
    let fibres = m.fibres(s, v, a);
    // What the fibres give along the tendon is what is active, less damping and passive work.
    let step = 1e-6;
    let stored = |s: f64| m.energy(0.2, s);
    let into_passive = v * (stored(s + step) - stored(s - step)) / (2.0 * step);
    near(-fibres.force * v, fibres.power - fibres.dissipation - into_passive, 1e-8);
}
