//! `handc compile` and the runners of the crates it writes, through real processes.

mod support;

use std::process::Command;
use support::{Folder, Said, figures, folder, handc, table};

const MODEL: &str = "model NAME {
    param k = 2 N*m/rad;
    gravity = (0, 0, -9.81) m/s^2;
    joint type: revolute(y) in world { start = 0.5; stiffness = k; }
    mass bob in type { mass = 1 kg; at = (0, 0, -0.3) m; }
    joint self: revolute(y) in type at (0, 0, -0.3) m { start = 0.1; }
    mass end in self { mass = 0.2 kg; at = (0, 0, -0.2) m; inertia = (1, 1, 1) g*m^2; }
    strand fn { path = world (0.2, 0, 0) m -> self; stiffness = 20 N/m; }
    scenario match { step = 1 ms; duration = 0.1 s; record length(fn) as length; }
    scenario crate { step = 1 ms; duration = 0.1 s; drive type = 0.5 + t / 1 s; }
}
";

/// Compiles a model of that name and returns how its runner is called.
fn runner(here: &Folder, name: &str) -> impl Fn(&[&str]) -> Said {
    here.write("m.hdl", &MODEL.replace("NAME", name));
    let said = handc(here, &["compile", "m.hdl"]);
    assert_eq!(said.code, 0, "{name}: {}", said.err);
    let manifest = here.0.join("generated").join(name).join("Cargo.toml");
    let folder = here.0.clone();
    move |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO"));
        command.args(["run", "--quiet", "--manifest-path"]).arg(&manifest).arg("--");
        command.args(arguments).current_dir(&folder);
        command.env("CARGO_TARGET_DIR", concat!(env!("CARGO_TARGET_TMPDIR"), "/runners"));
        command.env("RUSTFLAGS", "-D warnings");
        command.output().expect("cargo").into()
    }
}

#[test]
fn the_runner_does_as_the_interpreter_does() {
    let here = folder("runner");
    let run = runner(&here, "swing");
    for scenario in ["match", "crate"] {
        let options = ["--scenario", scenario, "--set", "k=3", "--every", "7", "--out"];
        let compiled = run(&[&options[..], &["compiled.csv"]].concat());
        assert_eq!(compiled.code, 0, "{}", compiled.err);
        let interpreted =
            handc(&here, &[&["run", "m.hdl"], &options[..], &["interpreted.csv"]].concat());
        assert_eq!(figures(&compiled), figures(&interpreted));
        let (header, rows) = table(&here.read("compiled.csv"));
        let (expected, numbers) = table(&here.read("interpreted.csv"));
        assert_eq!(header, expected);
        assert_eq!(rows.len(), numbers.len());
        for (a, b) in rows.iter().flatten().zip(numbers.iter().flatten()) {
            assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "{a} and {b}");
        }
    }
    assert_eq!(run(&[]).code, 2);
    assert_eq!(run(&["--scenario", "none"]).code, 2);
    assert_eq!(run(&["--scenario", "match", "--sett", "k=1"]).code, 2);
    assert_eq!(run(&["--scenario", "match", "--set", "kk=1"]).code, 2);
    // Out of its range: the same complaint, with the line.
    let options = ["--scenario", "match", "--set", "k=-1"];
    let (compiled, interpreted) =
        (run(&options), handc(&here, &[&["run", "m.hdl"], &options[..]].concat()));
    assert_eq!((compiled.code, interpreted.code), (3, 3));
    assert!(interpreted.err.ends_with(&compiled.err), "{}", interpreted.err);
    assert!(
        compiled.err.contains("cannot be negative, and is -1 at the start (m.hdl:4)"),
        "{}",
        compiled.err
    );
    assert_eq!(run(&["--scenario", "match", "--step=-1"]).code, 2);
    assert_eq!(run(&["--scenario", "match", "--out", "no/folder/a.csv"]).code, 3);
    assert_eq!(run(&["--help"]).code, 0);
    // Five copies: four together and one by itself.
    let spread = ["--scenario", "match", "--instances", "5", "--spread", "k=1:2", "--spread"];
    let spread = [&spread[..], &["start=1e-3", "--out"]].concat();
    let copies = run(&[&spread[..], &["compiled.csv"]].concat());
    assert_eq!((copies.code, figures(&copies)), (0, 500), "{}", copies.err);
    handc(&here, &[&["run", "m.hdl"], &spread[..], &["interpreted.csv"]].concat());
    let [(header, rows), (expected, numbers)] =
        ["compiled.csv", "interpreted.csv"].map(|file| table(&here.read(file)));
    assert_eq!((header, rows.len()), (expected, 5));
    for (a, b) in rows.iter().flatten().zip(numbers.iter().flatten()) {
        assert!((a - b).abs() < 1e-9 * b.abs().max(1.0), "copies: {a} and {b}");
    }
}

#[test]
fn odd_names_compile() {
    let here = folder("odd");
    for name in ["crate", "std", "test", "self", "core", "handc_core", "build", "Swing"] {
        let run = runner(&here, name);
        let said = run(&["--scenario", "match"]);
        assert_eq!(said.code, 0, "model {name}: {}", said.err);
    }
}

#[test]
fn foreign_folders_are_left_alone() {
    let here = folder("foreign");
    here.write("m.hdl", &MODEL.replace("NAME", "swing"));
    std::fs::create_dir(here.0.join("mine")).expect("a folder");
    here.write("mine/thesis.tex", "mine");
    let said = handc(&here, &["compile", "m.hdl", "--out", "mine"]);
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("--force"), "{}", said.err);
    assert_eq!(std::fs::read_dir(here.0.join("mine")).expect("a folder").count(), 1);
    assert_eq!(handc(&here, &["compile", "m.hdl", "--out", "mine", "--force"]).code, 0);
    assert_eq!(here.read("mine/thesis.tex"), "mine");
    // What was written by the command may be written again.
    assert_eq!(handc(&here, &["compile", "m.hdl", "--out", "mine"]).code, 0);
}

#[test]
fn no_name_leads_out_of_the_folder() {
    let here = folder("outside");
    for name in ["../../x", "/tmp/x", "a-b", "a.b", "\"x\""] {
        here.write("m.hdl", &MODEL.replace("NAME", name));
        let before = here.count();
        assert_eq!(handc(&here, &["compile", "m.hdl"]).code, 1, "{name}");
        assert_eq!(here.count(), before, "{name}");
    }
}
