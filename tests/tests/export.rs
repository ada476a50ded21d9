//! The export to MJCF: one small model word for word, all models without a complaint of their own.

use handc::mjcf::export;
use handc_core::simulation::Settings;
use handc_runtime::mechanism::{Coordinate, Role};
use handc_tests::expected::expected;
use handc_tests::load::{mechanism, mechanism_of_text, models, repository};
use std::path::Path;
use std::sync::Arc;

/// A little of everything that the export says or cannot say.
const SMALL: &str = "
/// A lever on a slide, held by a tendon & a spring <here>.
model small {
    param k = 500 N/m;
    input u = 0.1 N*m;
    gravity = (0, 0, -9.81) m/s^2;
    joint slide: prismatic(x) in world at (0, 0, 0.2) m { start = 0.1 m; damping = 2 N*s/m; }
    joint theta: revolute(y) in slide at (0.05, 0, 0) m rotate z 30 deg {
        start = 0.3; stiffness = 0.5 N*m/rad; rest = 0.1; limits = (-1, 1);
    }
    mass bob in theta { mass = 0.2 kg; at = (0, 0, -0.15) m; inertia = (2, 3, 4, 0, 0.1, 0) g*m^2; }
    frame tip in theta at (0, 0, -0.2) m;
    joint jack: screw(z, 5 mm) in world at (1, 0, 0) m;
    mass weight in jack { mass = 1 kg; at = (0.1, 0, 0) m; }
    joint crank: revolute(z) in world { drive = 2 rad/s * t; }
    mass wheel in crank = sphere { radius = 10 mm; mass = 0.1 kg; at = (0, 0.1, 0) m; }
    strand tendon { path = world (0.06, 0, 0.02) m -> theta (0.01, 0, -0.06) m -> tip; stiffness = k; }
    strand wire { path = world -> jack (0.1, 0, 0) m; stiffness = k; rest = 0.9 m + 0.01 m * sin(3 rad/s * t); }
    strand round {
        path = world (0, 0, 0.2) m -> via wrap cylinder(world (0.08, 0, 0.17) m, axis = y, radius = 20 mm, side = -x) -> theta (0.02, 0, -0.06) m
            -> via wrap sphere(tip, radius = 10 mm) -> world (0.2, 0, -0.1) m;
        stiffness = k;
    }
    constraint rod: distance(tip, world (0.6, 0, 0.1) m) = 0.5 m;
    constraint gear: theta == 0.5 * jack + 0.1;
    constraint wall: on_plane(jack (0.1, 0, 0) m, world, normal = y);
    torque brake on theta = -0.1 N*m*s * rate(theta) - 0.02 N*m;
    torque motor on jack = u;
    force wind at tip = (0.1, 0, 0.2) N;
    scenario run { step = 1 ms; duration = 1 s; velocity slide = 0.2 m/s; set k = 400 N/m; }
}
";

#[test]
fn small_model() {
    let mechanism = mechanism_of_text("small", SMALL).unwrap_or_else(|said| panic!("{said}"));
    let made = export(&Arc::new(mechanism), &Settings::default()).expect("an export");
    let path = repository("tests/tests/snapshots/exported_small.xml");
    expected(&path, &made.text).unwrap_or_else(|wrong| panic!("{wrong}"));
}

#[test]
fn all_models_export_in_one_way() {
    let mut count = 0;
    for folder in ["models", "tests/fixtures", "tests/cases", "tests/mechanisms"] {
        for path in models(folder) {
            let Ok(mechanism) = mechanism(&path) else { continue };
            let mechanism = Arc::new(mechanism);
            let name = path.display();
            let [first, second] = [0, 1].map(|_| {
                export(&mechanism, &Settings::default()).unwrap_or_else(|e| panic!("{name}: {e}"))
            });
            assert_eq!(first, second, "{name}");
            // Fibres and activations of muscles move no joint.
            let moves = |c: &&Coordinate| !matches!(c.role, Role::Fibre | Role::Activation);
            for coordinate in mechanism.coordinates.iter().filter(moves) {
                let joint = format!("<joint name=\"{}\"", coordinate.name);
                assert!(first.text.contains(&joint), "{name} lost `{}`", coordinate.name);
            }
            assert!(!first.text.contains("NaN") && !first.text.contains("inf"), "{name}");
            count += 1;
        }
    }
    assert!(count > 20, "only {count} models");
}

#[test]
fn a_scenario_that_is_not_there_is_an_error() {
    let path = handc_tests::load::repository("models/finger.hdl");
    let mechanism = Arc::new(mechanism(Path::new(&path)).expect("the finger"));
    let settings = Settings { scenario: Some("nowhere".into()), ..Settings::default() };
    let error = export(&mechanism, &settings).expect_err("no such scenario");
    assert!(error.to_string().contains("nowhere"), "{error}");
}
