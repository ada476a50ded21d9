//! The command line through real processes: exit codes, files, and what is said.

mod support;

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use support::{Said, figures, folder, handc, table};

const SWING: &str = "/// Swings.
model swing {
    param k = 2 N*m/rad;
    gravity = (0, 0, -9.81) m/s^2;
    joint type: revolute(y) in world { start = 0.5; stiffness = k; damping = 0.01 N*m*s/rad; }
    mass bob in type { mass = 1 kg; at = (0, 0, -0.3) m; }
    joint self: prismatic(x) in type { drive = 0.1 m * sin(2 rad/s * t); }
    joint fn: revolute(y) in type at (0, 0, -0.3) m { start = 0.25; }
    mass end in fn { mass = 0.2 kg; at = (0, 0, -0.2) m; inertia = (1, 1, 1) g*m^2; }
    constraint like: fn == 0.5 * type;
    scenario one { step = 1 ms; duration = 0.1 s; record type * 2 as twice; }
    scenario two { step = 1 ms; duration = 0.2 s; drive type = 0.5 + t / 1 s; }
}
";

/// A model whose torque is no number after 50 ms.
const FAILING: &str = "model failing {
    joint a: revolute(z) in world;
    mass m in a { mass = 1 kg; at = (0.1, 0, 0) m; }
    torque w on a = 0.01 N*m * sqrt(1 - t / 50 ms);
    scenario s { step = 1 ms; duration = 0.2 s; }
}
";

#[test]
fn check_tells_right_from_wrong() {
    let here = folder("check");
    here.write("swing.hdl", SWING);
    here.write("wrong.hdl", "model wrong { joint a: revolut(z) in world; }");
    assert_eq!(handc(&here, &["check", "swing.hdl"]).code, 0);
    let said = handc(&here, &["check", "wrong.hdl"]);
    assert_eq!(said.code, 1);
    assert!(said.err.contains("wrong.hdl:1:"), "{}", said.err);
    // A file of components is right by itself, but there is nothing to run.
    here.write("parts.hdl", "component A { frame f in base; }\ncomponent B(l: Length) { }\n");
    let said = handc(&here, &["check", "parts.hdl"]);
    assert_eq!((said.code, said.out.as_str()), (0, "parts.hdl: 2 components, no model\n"));
    let said = handc(&here, &["run", "parts.hdl"]);
    assert!(said.code == 1 && said.err.contains("declares no model"), "{}", said.err);
    here.write("broken.hdl", "component A { frame f in bse; }\n");
    assert_eq!(handc(&here, &["check", "broken.hdl"]).code, 1);
    // What cannot be read is told in one line.
    for (file, why) in
        [("missing.hdl", "no such file"), (".", "folder"), ("/dev/null", "plain file")]
    {
        let said = handc(&here, &["check", file]);
        assert_eq!(said.code, 1, "{file}");
        assert!(said.err.contains(&format!("cannot read `{file}`: ")), "{}", said.err);
        assert!(said.err.contains(why) && said.err.lines().count() == 1, "{}", said.err);
    }
    assert_eq!(handc(&here, &["chek"]).code, 2);
    assert_eq!(handc(&here, &["check"]).code, 2);
}

#[test]
fn names_may_differ_by_case_alone() {
    let here = folder("case");
    here.write("m.hdl", &SWING.replace(" fn", " Type"));
    let said = handc(&here, &["run", "m.hdl", "--scenario", "one", "--out", "m.csv"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let (header, _) = table(&here.read("m.csv"));
    assert_eq!(header, "t,type,self,Type,p.type,p.Type,lambda.like,energy,twice");
}

#[test]
fn a_run_writes_its_columns_and_its_figures() {
    let here = folder("run");
    here.write("swing.hdl", SWING);
    let said = handc(&here, &["run", "swing.hdl", "--scenario", "one", "--out", "one.csv"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(figures(&said), 100);
    let (header, rows) = table(&here.read("one.csv"));
    assert_eq!(header, "t,type,self,fn,p.type,p.fn,lambda.like,energy,twice");
    assert_eq!(rows.len(), 101);
    assert_eq!(rows[0][..2], [0.0, 0.5]);
    assert!((rows[100][0] - 0.1).abs() < 1e-15);
    rows.iter().for_each(|row| assert!((row[8] - 2.0 * row[1]).abs() < 1e-15));
    // A driven coordinate has no momentum.
    let two = ["run", "swing.hdl", "--scenario=two", "--every", "30", "--out", "two.csv"];
    let said = handc(&here, &two);
    assert_eq!(figures(&said), 200, "{}", said.err);
    let (header, rows) = table(&here.read("two.csv"));
    assert!(header.starts_with("t,type,self,fn,p.fn,lambda.like,energy"), "{header}");
    let times: Vec<f64> = rows.iter().map(|row| (row[0] * 1e3).round()).collect();
    assert_eq!(times, [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0]);
    // Nothing is written unasked.
    let before = here.count();
    assert_eq!(handc(&here, &["run", "swing.hdl", "--scenario", "one"]).code, 0);
    assert_eq!(here.count(), before);
}

#[test]
fn numbers_have_seventeen_digits() {
    let here = folder("digits");
    here.write("swing.hdl", SWING);
    handc(&here, &["run", "swing.hdl", "--scenario", "one", "--out", "a.csv"]);
    let text = here.read("a.csv");
    let last = text.lines().last().expect("a row");
    for cell in last.split(',').filter(|cell| *cell != "0") {
        let digits = cell.split('e').next().unwrap_or_default();
        let count = digits.chars().filter(char::is_ascii_digit).count();
        assert_eq!(count, 17, "{cell}");
    }
}

#[test]
fn wrong_options_are_told() {
    let here = folder("options");
    here.write("swing.hdl", SWING);
    let run = |more: &[&str]| handc(&here, &[&["run", "swing.hdl"], more].concat());
    for (more, hint) in [
        (&[][..], "`one`"),
        (&["--scenario", "three"], "`two`"),
        (&["--scenario", "one", "--set", "kk=3"], "`k`"),
        (&["--scenario", "one", "--set", "k"], "PARAM=VALUE"),
        (&["--scenario", "one", "--set", "k=nan"], "finite"),
        (&["--scenario", "one", "--set", "k=1e999"], "finite"),
        (&["--scenario", "ona"], "did you mean `one`?"),
        (&["--scenario", "one", "--instances", "3", "--spread", "k=1:inf"], "spread"),
        (&["--scenario", "one", "--set", "k=x"], "number"),
        (&["--scenario", "one", "--every", "0"], "every"),
        (&["--scenario", "one", "--step", "0"], "step"),
        (&["--scenario", "one", "--step=-1"], "step"),
        (&["--scenario", "one", "--duration", "nan"], "duration"),
        (&["--scenario", "one", "--threads", "2"], "instances"),
        (&["--scenario", "one", "--instances", "3", "--spread", "k"], "spread"),
        (&["--scenario", "one", "--instances", "3", "--spread", "kk=1:2"], "k"),
    ] {
        let said = run(more);
        assert_eq!(said.code, 2, "{more:?}: {}", said.err);
        assert!(said.err.contains(hint), "{more:?}: {}", said.err);
    }
    for out in ["no/such/folder/a.csv", "/dev/full", "."] {
        let said = run(&["--scenario", "one", "--out", out]);
        assert_eq!(said.code, 3, "{}", said.err);
        assert!(said.err.contains(&format!("cannot write `{out}`")), "{}", said.err);
    }
}

#[test]
fn parameters_and_copies() {
    let here = folder("copies");
    here.write("swing.hdl", SWING);
    let energy = |set: &str| {
        let run = ["run", "swing.hdl", "--scenario", "one", "--set", set, "--out", "a.csv"];
        assert_eq!(handc(&here, &run).code, 0);
        table(&here.read("a.csv")).1[0][7]
    };
    // ½(k₁ − k₀)q².
    assert!((energy("k=10") - energy("k=2") - 0.5 * 8.0 * 0.25).abs() < 1e-12);
    let spread = ["--instances", "4", "--threads", "2", "--spread", "k=1:3"];
    let output = ["--out", "ends.csv", "--summary", "summary.csv", "--every", "20"];
    let run = ["run", "swing.hdl", "--scenario", "one"];
    let said = handc(&here, &[&run[..], &spread, &output].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(figures(&said), 400);
    let (header, summary) = table(&here.read("summary.csv"));
    let (ends_header, ends) = table(&here.read("ends.csv"));
    assert_eq!((summary.len(), ends.len()), (6, 4));
    // The last row of the summary is that of the copies' ends, which are in order of k.
    let of = |what: &str| summary[5][header.split(',').position(|name| name == what).unwrap()];
    let twice = ends_header.split(',').position(|name| name == "twice").unwrap();
    let numbers: Vec<f64> = ends.iter().map(|row| row[twice]).collect();
    assert!((of("twice.mean") - numbers.iter().sum::<f64>() / 4.0).abs() < 1e-15);
    assert_eq!(of("twice.max"), numbers.iter().copied().fold(f64::MIN, f64::max));
    assert!((of("twice.median") - 0.5 * (numbers[1] + numbers[2])).abs() < 1e-15);
    assert_eq!((of("t"), of("instances")), (0.1, 4.0));
    // The first copies cannot start; the others are summarised, or nothing is.
    for (spread, rows) in [("k=-2:1", 6), ("k=-2:-1", 0)] {
        let spread = ["--instances", "4", "--spread", spread];
        let said = handc(&here, &[&run[..], &spread, &output].concat());
        assert!(said.code == 3 && said.err.contains("instance 0: "), "{}", said.err);
        let (header, summary) = table(&here.read("summary.csv"));
        assert!(header.starts_with("t,instances") && summary.len() == rows, "{header}");
    }
}

#[test]
fn a_failing_run_keeps_its_rows() {
    let here = folder("failing");
    here.write("failing.hdl", FAILING);
    let said = handc(&here, &["run", "failing.hdl", "--out", "a.csv"]);
    assert_eq!(said.code, 3, "{}", said.err);
    assert!(said.err.contains("error: ") && said.err.contains("step 51"), "{}", said.err);
    assert_eq!(figures(&said), 50);
    let (_, rows) = table(&here.read("a.csv"));
    assert_eq!(rows.len(), 51);
    assert!(rows.iter().flatten().all(|x| x.is_finite()));
}

#[test]
fn an_interrupted_run_leaves_a_valid_file() {
    let here = folder("interrupt");
    here.write("swing.hdl", SWING);
    let mut child = Command::new(env!("CARGO_BIN_EXE_handc"))
        .args(["run", "swing.hdl", "--scenario", "one", "--duration", "10000", "--out", "a.csv"])
        .current_dir(&here.0)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("handc");
    let began = Instant::now();
    while here.size("a.csv") == 0 && began.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(20));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().expect("kill").success());
    while child.try_wait().expect("a child").is_none() {
        assert!(began.elapsed() < Duration::from_secs(40), "it does not stop");
        std::thread::sleep(Duration::from_millis(20));
    }
    let said = Said::from(child.wait_with_output().expect("output"));
    assert!(said.err.contains("stopped at t = "), "{}", said.err);
    let (_, rows) = table(&here.read("a.csv"));
    assert_eq!(rows.len(), figures(&said) + 1);
}

#[test]
fn every_stage_is_dumped() {
    let here = folder("dump");
    here.write("swing.hdl", SWING);
    for stage in ["ast", "hir", "mechanism", "graph", "rust"] {
        let said = handc(&here, &["dump", "swing.hdl", "--stage", stage]);
        assert_eq!(said.code, 0, "{stage}: {}", said.err);
        assert!(said.out.len() > 1000, "{stage}");
    }
    assert_eq!(handc(&here, &["dump", "swing.hdl", "--stage", "llvm"]).code, 2);
}

#[test]
fn fmt_and_info_and_new() {
    let here = folder("small");
    here.write("swing.hdl", &SWING.replace("    ", " "));
    assert_eq!(handc(&here, &["fmt", "--check", "swing.hdl"]).code, 1);
    assert_eq!(handc(&here, &["fmt", "swing.hdl"]).code, 0);
    assert_eq!(handc(&here, &["fmt", "--check", "swing.hdl"]).code, 0);
    let said = handc(&here, &["info", "swing.hdl"]);
    assert_eq!(said.code, 0);
    assert!(said.out.contains("type") && said.out.contains("bob"), "{}", said.out);
    assert_eq!(handc(&here, &["new", "fresh"]).code, 0);
    assert_eq!(handc(&here, &["new", "fresh"]).code, 2, "it is there already");
    let said = handc(&here, &["run", "fresh.hdl"]);
    assert_eq!(said.code, 0, "{}", said.err);
    for name in ["../../x", "a/b", "", "3d", "ä"] {
        assert_eq!(handc(&here, &["new", name]).code, 2, "{name}");
    }
}

#[test]
fn plot_draws_a_model_and_a_table() {
    let here = folder("plot");
    here.write("swing.hdl", SWING);
    let said = handc(&here, &["plot", "swing.hdl", "--scenario", "one", "--out", "figure"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(here.read("figure.svg").contains("<svg") && here.size("figure.png") > 1000);
    here.write("broken.csv", "t,a\n0,x\n");
    assert_ne!(handc(&here, &["plot", "broken.csv"]).code, 0);
}
