//! MuJoCo as a witness: strand lengths, moment arms, mass matrices and forces at rest of all models at
//! random poses.
//!
//! Models go out through the MJCF export, so the export is checked too. The comparison itself is
//! `tests/witness/compare.py`. It needs Python and network to PyPI once; without them the test says
//! so and passes. With `HANDC_WITNESS=1` a missing witness is a failure.
//!
//! A strand with a hint goes round its surface wherever handc puts it; MuJoCo's tendon jumps to the
//! straight line at some poses. Where one of them touches a surface and the other does not, where a
//! point is inside, or where the hint is unclear, that strand is left out at that pose; how often is
//! counted.

use handc::mjcf::export;
use handc_core::model::{Midpoint, Model};
use handc_core::simulation::{Settings, Simulation};
use handc_runtime::interpreter::Interpreter;
use handc_runtime::mechanism::{Mechanism, Point, Strand};
use handc_runtime::resolved::Resolved;
use handc_runtime::structure::Structure;
use handc_runtime::surface::Surface;
use handc_runtime::vector::{Transform, Vec3};
use handc_tests::chance::Chance;
use handc_tests::load::{mechanism, models, repository};
use handc_tests::python::environment;
use serde::Serialize;
use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

/// Folders whose models are compared.
const FOLDERS: [&str; 4] = ["models", "tests/fixtures", "tests/cases", "tests/mechanisms"];

/// Poses of each model.
const POSES: usize = 20;

/// Relative differences that are allowed.
const BOUND: &str = "1e-10";

/// What handc says of one pose.
#[derive(Serialize)]
struct Pose {
    q: Vec<f64>,
    /// Surfaces that each strand touches; `None` where it is not to be compared.
    bends: Vec<Option<usize>>,
    lengths: Vec<f64>,
    arms: Vec<f64>,
    mass: Vec<f64>,
    /// Generalized forces at rest; empty where MJCF cannot say one of them.
    force: Vec<f64>,
}

/// Beginnings of warnings that a force is not in the file as it is in handc.
const FORCES_DIFFER: [&str; 5] =
    ["MJCF cannot say how", "elastic limits", "force `", "not the law", "without friction"];

/// What a run begins with: the model with its scenario's parameters, natural lengths and inputs.
struct Beginning {
    model: Interpreter,
    rest: Vec<f64>,
    inputs: Vec<f64>,
}

/// The beginning of the first scenario, or of none where it has no start on the constraints.
fn beginning(mechanism: &Arc<Mechanism>) -> Beginning {
    let mut model = Interpreter::new(Arc::clone(mechanism));
    let settings = Settings {
        scenario: mechanism.scenarios.first().map(|s| s.name.clone()),
        step: Some(1e-3),
        duration: Some(1.0),
        ..Settings::default()
    };
    if let Ok(run) = Simulation::new(model.clone(), &settings) {
        let (rest, inputs) = (run.rest().to_vec(), run.inputs().to_vec());
        return Beginning { model: run.model, rest, inputs };
    }
    let layout = model.layout().clone();
    let (mut q, mut v) = (vec![0.0; layout.coordinates.len()], vec![0.0; layout.coordinates.len()]);
    model.start(&mut q, &mut v);
    let mut rest = vec![0.0; layout.strands.len()];
    model.strand_lengths(&q, &mut rest);
    let mut inputs = vec![0.0; layout.inputs.len()];
    model.inputs(0.0, &mut inputs);
    model.rests(0.0, &inputs, &mut rest);
    Beginning { model, rest, inputs }
}

/// A model for the witness.
#[derive(Serialize)]
struct Case {
    file: String,
    mjcf: String,
    coordinates: Vec<String>,
    kinematic: Vec<bool>,
    /// Numbers of the coordinates that move matter whose inertia is left out.
    without_inertia: Vec<usize>,
    strands: Vec<String>,
    poses: Vec<Pose>,
}

/// Lengths, moment arms, the whole mass matrix and the forces at a pose.
fn pose(at: &mut Beginning, q: Vec<f64>, with_force: bool) -> Pose {
    let model = &mut at.model;
    let layout = model.layout().clone();
    let (n, s) = (layout.coordinates.len(), layout.strands.len());
    let mut lengths = vec![0.0; s];
    model.strand_lengths(&q, &mut lengths);
    let mut arms = vec![0.0; s * n];
    model.moment_arms(&q, &mut arms);
    let mut packed = vec![0.0; layout.matrix_size()];
    model.mass_matrix(&q, &mut packed);
    let mut mass = vec![0.0; n * n];
    for block in &layout.blocks {
        let width = block.coordinates.len();
        for (i, &row) in block.coordinates.iter().enumerate() {
            for (j, &column) in block.coordinates.iter().enumerate() {
                mass[row * n + column] = packed[block.matrix_offset + i * width + j];
            }
        }
    }
    let (mut momentum, mut force) = (vec![0.0; n], vec![0.0; n]);
    let v = vec![0.0; n];
    let midpoint = Midpoint { q: &q, v: &v, t: 0.0, rest: &at.rest, inputs: &at.inputs };
    model.evaluate(&midpoint, &mut momentum, &mut force);
    let mechanism = Arc::clone(model.mechanism());
    let (poses, numbers) = (model.link_poses(&q), Resolved::new(&mechanism, model.params()));
    let bends: Vec<Option<usize>> =
        mechanism.strands.iter().map(|strand| bends(strand, &poses, &numbers)).collect();
    // What is not a number has no place in JSON.
    for (strand, _) in bends.iter().enumerate().filter(|(_, bends)| bends.is_none()) {
        lengths[strand] = 0.0;
        arms[strand * n..(strand + 1) * n].fill(0.0);
    }
    if !with_force || bends.contains(&None) {
        force.clear();
    }
    Pose { q, bends, lengths, arms, mass, force }
}

/// Whether a strand that touches a surface lies within 37 degrees of the hint, or goes the shorter way
/// without one: else MuJoCo, which knows nothing of the start, may take another way.
fn is_clear(surface: &Surface<f64>, side: Option<Vec3<f64>>, ends: [Vec3<f64>; 2]) -> bool {
    let flat = |v: Vec3<f64>| surface.form.flat(v);
    let unit = |v: Vec3<f64>| v.scale(1.0 / v.norm_squared().sqrt());
    let [_, middle, _] = surface.trace(ends, 3)[..] else { return true };
    let middle = unit(flat(middle - surface.center));
    match side {
        Some(side) => unit(flat(side)).dot(middle) > 0.8,
        None => {
            let [p, q] = ends.map(|end| unit(flat(end - surface.center)));
            middle.dot(p + q) > 0.0
        }
    }
}

/// How many surfaces a strand touches; `None` if a point is inside one, or its side is unclear.
fn bends(strand: &Strand, poses: &[Transform<f64>], numbers: &Resolved<f64>) -> Option<usize> {
    let place = |point: &Point| {
        let position = numbers.vector(&point.position);
        point.link.map_or(position, |link| poses[link as usize].point(position))
    };
    let mut count = 0;
    for wrap in &strand.wraps {
        let ends = [0, 1].map(|k| {
            let world = place(&strand.points[wrap.gap as usize + k]);
            wrap.center.link.map_or(world, |link| poses[link as usize].inverse_point(world))
        });
        let surface = numbers.surface(strand, wrap);
        let length = surface.length(ends);
        let chord = (ends[1] - ends[0]).norm_squared().sqrt();
        if length.is_nan() || !is_clear(&surface, wrap.side.map(|side| numbers.vector(&side)), ends)
        {
            return None;
        }
        count += usize::from(length > chord);
    }
    Some(count)
}

/// Exports a model into a folder and asks handc about poses around its start.
fn case(folder: &Path, path: &Path, label: &str) -> Option<Case> {
    let mechanism = Arc::new(mechanism(path).ok()?);
    let made = export(&mechanism, &Settings::default()).expect("an export");
    let mjcf = format!("{}.xml", label.replace('/', "-"));
    std::fs::write(folder.join(&mjcf), &made.text).expect("room for the export");
    let differs = |warning: &String| FORCES_DIFFER.iter().any(|text| warning.contains(text));
    // MuJoCo's tendons go slack at a kink.
    let slack = mechanism.strands.iter().any(|strand| strand.slack.is_some());
    let with_force = !slack && !made.warnings.iter().any(differs);
    let mut at = beginning(&mechanism);
    let layout = at.model.layout().clone();
    let n = layout.coordinates.len();
    let (mut start, mut rate) = (vec![0.0; n], vec![0.0; n]);
    at.model.start(&mut start, &mut rate);
    let mut chance = Chance::new(11);
    let poses = (0..POSES).map(|_| {
        let off = |i: usize, chance: &mut Chance| match mechanism.coordinates[i].is_length {
            true => chance.between(-0.05, 0.05),
            false => chance.between(-1.2, 1.2),
        };
        let q = (0..n).map(|i| start[i] + off(i, &mut chance)).collect();
        pose(&mut at, q, with_force)
    });
    Some(Case {
        file: label.to_string(),
        mjcf,
        poses: poses.collect(),
        coordinates: layout.coordinates.iter().map(|c| c.name.clone()).collect(),
        kinematic: layout.coordinates.iter().map(|c| c.kinematic).collect(),
        without_inertia: Structure::new(&mechanism).without_inertia(&mechanism),
        strands: layout.strands.iter().map(|s| s.name.clone()).collect(),
    })
}

#[test]
fn mujoco_agrees() {
    // Past the capture of the test's output, so that it is seen of a test that passes.
    let say = |text: &str| writeln!(std::io::stderr(), "{text}").expect("standard error");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("witness");
    std::fs::create_dir_all(&folder).expect("a folder");
    let witness = repository("tests/witness");
    let python = match environment(&folder.join("venv"), &witness.join("requirements.txt")) {
        Ok(python) => python,
        Err(reason) => {
            let wanted = std::env::var_os("HANDC_WITNESS").is_some();
            assert!(!wanted, "MuJoCo cannot be asked: {reason}");
            say(&format!("skipped: MuJoCo cannot be asked: {reason}"));
            return;
        }
    };
    let mut cases = Vec::new();
    for place in FOLDERS {
        for path in models(place) {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            cases.extend(case(&folder, &path, &format!("{place}/{name}")));
        }
    }
    assert!(cases.len() > 20, "only {} models", cases.len());
    let text = serde_json::to_string(&cases).expect("JSON");
    std::fs::write(folder.join("poses.json"), text).expect("room for the poses");
    let output = Command::new(python)
        .arg(witness.join("compare.py").canonicalize().expect("the comparison"))
        // MuJoCo writes its log where it runs.
        .current_dir(&folder)
        .args([folder.as_os_str(), BOUND.as_ref()])
        .output()
        .expect("Python");
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "MuJoCo disagrees\n{table}{errors}");
    println!("{table}");
}
