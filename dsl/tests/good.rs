//! Right models, and what the checker makes of them.

use handc_dsl::format::format_text;
use handc_dsl::hir::{self, ExprKind, Model};
use handc_dsl::{check_file, check_text, diagnostic::render};
use std::path::{Path, PathBuf};

#[track_caller]
fn good(text: &str) -> Model {
    let checked = check_text("good.hdl", text);
    let said = render(&checked.diagnostics, &checked.sources, false);
    checked.model.unwrap_or_else(|| panic!("{said}"))
}

/// The model of a body.
#[track_caller]
fn model(body: &str) -> Model {
    good(&format!("model m {{\n{body}\n}}"))
}

#[track_caller]
fn value(expr: &hir::Expr) -> f64 {
    match expr.kind {
        ExprKind::Number(value) => value,
        ref other => panic!("not folded: {other:?}"),
    }
}

fn values(vector: &[hir::Expr]) -> Vec<f64> {
    vector.iter().map(value).collect()
}

fn frame<'m>(model: &'m Model, name: &str) -> &'m hir::Frame {
    model.frames.iter().find(|f| f.name.text == name).unwrap_or_else(|| panic!("no {name}"))
}

fn names<'m>(items: impl Iterator<Item = &'m hir::Name>) -> Vec<&'m str> {
    items.map(|n| n.text.as_str()).collect()
}

#[test]
fn the_model_on_top_of_the_page() {
    let model = good(include_str!("good/language.hdl"));
    assert_eq!(model.name.text, "finger");
    assert_eq!(model.name.doc, "Planar index finger: three flexion joints, four strands.");
    assert_eq!(names(model.coordinates.iter().map(|c| &c.name)), ["mcp", "pip", "dip"]);
    assert_eq!(value(&model.coordinates[0].start), -0.1);
    assert_eq!(value(model.coordinates[1].damping.as_ref().unwrap()), 1e-5);
    let limits = model.coordinates[0].limits.as_ref().unwrap();
    assert_eq!(values(limits), [-(100f64.to_radians()), 30f64.to_radians()]);
    assert_eq!(model.params[0].default, 200.0);
    let strand = &model.strands[0];
    assert_eq!(strand.name.doc, "Flexor digitorum profundus.");
    assert_eq!(strand.path.len(), 7);
    assert_eq!(values(&strand.path[0].offset), [-0.06, -0.01, 0.0]);
    let hir::Law::Stiffness(stiffness) = &strand.law else { panic!("{:?}", strand.law) };
    assert!(matches!(stiffness.kind, ExprKind::Param(_)) && strand.rest.is_none());
    let hir::MassKind::Explicit { inertia, .. } = &model.masses[1].kind else { panic!() };
    assert_eq!(values(&**inertia.as_ref().unwrap()), [158e-9, 286e-9, 286e-9, 0.0, 0.0, 0.0]);
    assert!(matches!(model.masses[0].kind, hir::MassKind::Capsule { .. }));
    let scenario = &model.scenarios[0];
    assert_eq!(value(scenario.step.as_ref().unwrap()), 0.01);
    assert_eq!(scenario.motions[0].name.text, "motion");
    let knots: Vec<_> = scenario.motions[0].knots.iter().map(|k| (k.0, value(&k.1))).collect();
    assert_eq!(knots, [(0, 0.0), (1, 4.0), (1, 8.0), (0, 12.0)]);
    assert_eq!(scenario.follow[0].strands.len(), 1);
}

#[test]
fn surfaces_are_wrapped_and_their_words_are_names() {
    let model = model(
        "joint via: revolute(z) in world; const wrap = (1, 2, 3) mm; frame sphere in via at wrap;\n\
         strand s { path = via wrap -> via wrap sphere(sphere wrap, radius = 2 mm) -> world -> via -> via wrap\n\
         cylinder(via, axis = -z, radius = 3 mm, side = wrap,) -> sphere; stiffness = 1 N/m; }",
    );
    let strand = &model.strands[0];
    let frames: Vec<_> = strand.path.iter().map(|p| p.frame.index()).collect();
    assert_eq!(frames, [1, 0, 1, 2]);
    assert_eq!(values(&strand.path[0].offset), [0.001, 0.002, 0.003]);
    let [first, second] = strand.wraps.as_slice() else { panic!("{:?}", strand.wraps) };
    assert_eq!((first.gap, second.gap), (0, 2));
    assert_eq!((first.surface.clone(), first.side.clone()), (hir::Surface::Sphere, None));
    assert_eq!(values(&first.center.offset), [0.001, 0.002, 0.003]);
    assert_eq!([value(&first.radius), value(&second.radius)], [0.002, 0.003]);
    let hir::Surface::Cylinder { axis } = &second.surface else { panic!() };
    assert_eq!(values(axis), [0.0, 0.0, -1.0]);
    assert_eq!(values(second.side.as_ref().unwrap()), [0.001, 0.002, 0.003]);
}

#[test]
fn everything_at_once() {
    let model = good(include_str!("good/everything.hdl"));
    let coordinates = names(model.coordinates.iter().map(|c| &c.name));
    let expected = [
        "s",
        "uni.a",
        "uni.b",
        "pl.u",
        "pl.v",
        "pl.r",
        "ball.tx",
        "ball.ty",
        "ball.tz",
        "ball.rx",
        "ball.ry",
        "ball.rz",
        "p",
        "dig.mcp",
        "dig.pip",
        "dig.deep.j",
    ];
    assert_eq!(coordinates, expected);
    for (index, frame) in model.frames.iter().enumerate() {
        assert!(
            frame.parent.is_none_or(|p| p.index() < index),
            "{} before its parent",
            frame.name.text
        );
    }
    assert_eq!(frame(&model, "dig.deep.base").joint, None);
    let scenario = &model.scenarios[0];
    assert_eq!(scenario.start.len(), 8);
    assert_eq!(scenario.records.len(), 5);
    assert!(matches!(scenario.records[0].value.kind, ExprKind::Multiplier(c, 1) if c.index() == 1));
    assert!(matches!(scenario.records[4].value.kind, ExprKind::Multiplier(_, 3)));
    assert_eq!(scenario.motions.len(), 2);
}

#[test]
fn units_bind_tighter_than_operators() {
    let model = model(
        "const a = 1/2 s; const b = (1 + 2) mm; const c = 2 m^2; const d = 2 m ^2; const e = -3 deg;\n\
         const f = 6 N*m*s/rad; const g = 5 g*mm^2; const h = 3 m * 2; const i = 10 m/s * 2 s;\n\
         const j = 2^3^2; const k = -2^2; const l = 7 - 2 - 1; const m = 1 / 2 / 2; const n = 2 m*pi;",
    );
    let found: Vec<f64> = model.consts.iter().map(|c| c.value).collect();
    let pi = std::f64::consts::PI;
    let expected = [
        0.5,
        0.003,
        2.0,
        4.0,
        -(3f64.to_radians()),
        6.0,
        5e-9,
        6.0,
        20.0,
        512.0,
        -4.0,
        4.0,
        0.25,
        2.0 * pi,
    ];
    assert_eq!(found, expected);
    assert_eq!(model.consts[0].dimension.to_string(), "rad/s");
    assert_eq!(model.consts[2].dimension, model.consts[3].dimension);
}

#[test]
fn unit_axis_and_function_names_are_names() {
    let model = model(
        "param m = 2; param x = 1; param sin = 3; param length = 4 m; param fn = 5;\n\
         joint s: revolute(x) in world rotate x m; joint floor: revolute((x, 0, 1)) in s;\n\
         joint N: prismatic(-z) in floor; torque g on N = 2 N * sin(sin) * fn;\n\
         strand match { path = N -> world (1, 0, 0) m; stiffness = 1 N/m; rest = length; }\n\
         constraint c: floor == 0.5 * s;",
    );
    assert_eq!(values(&model.coordinates[0].axis), [1.0, 0.0, 0.0]);
    assert!(matches!(model.coordinates[1].axis[0].kind, ExprKind::Param(_)));
    assert_eq!(values(&model.coordinates[2].axis), [0.0, 0.0, -1.0]);
}

#[test]
fn sugar_of_joints() {
    let model = model(
        "joint a: planar(z) in world; joint b: planar(x) in a; joint c: planar(y) in b;\n\
         joint d: universal(y, (0, 0, 2)) in c; joint e: free in d { start = (1, 2, 3, 0, 0, 0.5) ; }"
            .replace("(1, 2, 3, 0, 0, 0.5)", "(1 m, 2 mm, 0, 0, 0, 0.5)")
            .as_str(),
    );
    let axes = |joint: usize| -> Vec<Vec<f64>> {
        model.joints[joint]
            .coordinates
            .iter()
            .map(|c| values(&model.coordinates[c.index()].axis))
            .collect()
    };
    let (x, y, z) = (vec![1.0, 0.0, 0.0], vec![0.0, 1.0, 0.0], vec![0.0, 0.0, 1.0]);
    assert_eq!(axes(0), [x.clone(), y.clone(), z.clone()]);
    assert_eq!(axes(1), [y.clone(), z.clone(), x.clone()]);
    assert_eq!(axes(2), [z.clone(), x.clone(), y.clone()]);
    assert_eq!(axes(3), [y.clone(), vec![0.0, 0.0, 2.0]]);
    assert_eq!(axes(4), [x.clone(), y.clone(), z.clone(), x, y, z]);
    let starts: Vec<f64> = model.coordinates[11..].iter().map(|c| value(&c.start)).collect();
    assert_eq!(starts, [1.0, 0.002, 0.0, 0.0, 0.0, 0.5]);
}

#[test]
fn order_of_declarations_is_free() {
    let model = model(
        "strand s { stiffness = k; path = tip -> world; }\n\
         frame tip in b at (l, 0, 0); joint b: revolute(z) in a at (l, 0, 0); joint a: revolute(z) in world;\n\
         param k = 2 * base_k; param base_k = n * 1 N/m; const l = 2 * half; const half = 1 cm; const n = 3;",
    );
    assert_eq!(names(model.frames.iter().map(|f| &f.name)), ["world", "a", "b", "tip"]);
    assert_eq!(names(model.coordinates.iter().map(|c| &c.name)), ["b", "a"]);
    assert_eq!(model.params[0].default, 6.0);
    assert_eq!(value(&frame(&model, "tip").placement.at[0]), 0.02);
}

#[test]
fn components_keep_parameters_symbolic() {
    let model = good(
        "component Link(length: Length, k: N*m/rad = 1 N*m/rad) {\n\
             param own = 2 * k; const half = 0.5;\n\
             joint j: revolute(z) in base { stiffness = own; }\n\
             frame tip in j at (length * half, 0, 0);\n\
         }\n\
         model m { param size = 4 cm; place Link(length = size,) as one in world;\n\
             place Link(length = 2 cm, k = 3 N*m) as two in one.tip at (0, 0, 1) mm rotate x 90 deg;\n\
             frame end in two; frame end2 in two.base; constraint c: two.j == 0.5 * one.j; }",
    );
    assert_eq!(names(model.params.iter().map(|p| &p.name)), ["size", "one.own", "two.own"]);
    assert_eq!(model.params[2].default, 6.0);
    assert!(matches!(frame(&model, "one.tip").placement.at[0].kind, ExprKind::Binary(..)));
    assert_eq!(value(&frame(&model, "two.tip").placement.at[0]), 0.01);
    let base = model.frames.iter().position(|f| f.name.text == "two.base").unwrap();
    assert_eq!(frame(&model, "end").parent.unwrap().index(), base);
    assert_eq!(frame(&model, "end2").parent.unwrap().index(), base);
}

#[test]
fn a_constant_of_an_open_argument_is_open() {
    let model = good(
        "component Link(length: Length) {\n\
             const half = length / 2; const v = (half, 0, length);\n\
             frame tip in base at v;\n\
         }\n\
         component Idle(length: Length) { const twice = 2 * length; }\n\
         model m { param size = 4 cm; place Link(length = size) as one in world;\n\
             place Link(length = 2 * one.half) as two in world;\n\
             place Link(length = 2 cm) as three in world; }",
    );
    let at = |name: &str| frame(&model, name).placement.at.clone();
    assert!(matches!(at("one.tip")[0].kind, ExprKind::Binary(..)));
    assert!(matches!(at("two.tip")[2].kind, ExprKind::Binary(..)));
    assert_eq!(values(&at("three.tip")), [0.01, 0.0, 0.02]);
}

#[test]
fn names_may_differ_by_case_and_by_dots_alone() {
    let model = good(
        "component D { joint mcp: revolute(z) in base; }\n\
         model m { param k = 1; param K = 2; place D() as index in world; place D() as Index in world;\n\
             frame index_mcp in world; }",
    );
    assert_eq!(names(model.params.iter().map(|p| &p.name)), ["k", "K"]);
    assert_eq!(names(model.joints.iter().map(|j| &j.name)), ["index.mcp", "Index.mcp"]);
}

#[test]
fn zero_needs_no_unit() {
    model(
        "param a = 0; joint j: prismatic(x) in world at (0, 0, 0) { start = 0; damping = 0; limits = (0, 3 mm); }\n\
         torque f on j = if(t < 1 s, 0, 2 N) + max(0, 1 N) + 0; constraint c: j == 0;\n\
         gravity = 0;",
    );
}

#[test]
fn loose_punctuation_is_accepted() {
    good(
        "\u{feff}model m {\r\n joint a: revolute(z) in world { start = 0.1; };;\r\n\
         mass b in a = sphere { radius = 1 cm; mass = 1 g; };\r\n\
         scenario s { step = 1 ms; duration = 1 s; pose p { a = 1; }; }\r\n};",
    );
}

#[test]
fn scenarios_may_stand_beside_the_model() {
    let model = good("scenario a { step = 1 ms; }\nmodel m { scenario b { } }");
    assert_eq!(names(model.scenarios.iter().map(|s| &s.name)), ["b", "a"]);
}

fn temporary(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("handc-dsl-{}-{name}", std::process::id()));
    std::fs::create_dir_all(folder.join("parts")).unwrap();
    folder
}

#[test]
fn imports_are_read_once_and_stay_inside() {
    let folder = temporary("imports");
    let write = |path: &str, text: &str| std::fs::write(folder.join(path), text).unwrap();
    write("parts/a.hdl", "import \"shared.hdl\"; component A { place S() as s in base; }");
    write("parts/b.hdl", "import \"../parts/shared.hdl\"; component B { place S() as s in base; }");
    write("parts/shared.hdl", "component S { joint j: revolute(z) in base; }");
    write(
        "main.hdl",
        "import \"parts/a.hdl\"; import \"parts/b.hdl\"; model m { place A() as a in world; place B() as b in a; }",
    );
    let checked = check_file(&folder.join("main.hdl"), None);
    let said = render(&checked.diagnostics, &checked.sources, false);
    assert_eq!(
        names(checked.model.expect(&said).coordinates.iter().map(|c| &c.name)),
        ["a.s.j", "b.s.j"]
    );

    // A part by itself may not reach above its folder, unless the root is said to be there.
    write("above.hdl", "component X { }");
    write("parts/up.hdl", "import \"../above.hdl\"; model m { place X() as x in world; }");
    let inside = check_file(&folder.join("parts/up.hdl"), None);
    assert_eq!(inside.diagnostics[0].code, "import-outside");
    assert!(check_file(&folder.join("parts/up.hdl"), Some(&folder)).model.is_some());

    write("parts/c.hdl", "import \"d.hdl\"; model m { }");
    write("parts/d.hdl", "import \"c.hdl\";");
    let cycle = check_file(&folder.join("parts/c.hdl"), None);
    assert!(cycle.diagnostics[0].message.contains("c.hdl -> d.hdl -> c.hdl"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.join("above.hdl"), folder.join("parts/link.hdl"))
            .unwrap();
        write("parts/e.hdl", "import \"link.hdl\"; model m { }");
        let link = check_file(&folder.join("parts/e.hdl"), None);
        assert_eq!(link.diagnostics[0].code, "import-outside");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn unreadable_files_are_diagnostics() {
    let folder = temporary("unreadable");
    let path = folder.join("x.hdl");
    std::fs::write(&path, b"model m { \xff\xfe }").unwrap();
    assert_eq!(check_file(&path, None).diagnostics[0].code, "not-text");
    assert_eq!(check_file(&folder, None).diagnostics[0].code, "cannot-read");
    assert_eq!(check_file(&folder.join("none.hdl"), None).diagnostics[0].code, "cannot-read");
    std::fs::write(&path, vec![b'('; 10 << 20]).unwrap();
    assert_eq!(check_file(&path, None).diagnostics[0].code, "file-too-large");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// All right models: those of these tests and those of the project.
fn all_good() -> Vec<(PathBuf, String)> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in [here.join("tests/good"), here.join("../models")] {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|e| e == "hdl")
                && let Ok(text) = std::fs::read_to_string(&path)
            {
                files.push((path, text));
            }
        }
    }
    files
}

/// The model without its places in the text.
fn without_spans(text: &str) -> String {
    let shown = format!("{:?}", check_text("x.hdl", text).model);
    let mut out = String::new();
    let mut rest = shown.as_str();
    while let Some(start) = rest.find("Span {") {
        let end = start + rest[start..].find('}').unwrap();
        out.push_str(&rest[..start]);
        rest = &rest[end + 1..];
    }
    out.push_str(rest);
    out
}

#[test]
fn formatting_keeps_the_meaning() {
    for (path, text) in all_good() {
        let Ok(once) = format_text(&text) else { continue };
        let twice = format_text(&once).unwrap();
        assert_eq!(once, twice, "{} is not idempotent", path.display());
        let dense = |text: &str| text.split_whitespace().collect::<String>();
        assert_eq!(dense(&text), dense(&once), "{} loses tokens", path.display());
        assert_eq!(without_spans(&text), without_spans(&once), "{} changes", path.display());
    }
}
