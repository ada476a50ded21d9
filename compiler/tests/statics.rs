//! `atlas`, `pose` and `strength` through real processes: closed forms, vertices counted one by one,
//! there and back, and what is said of wrong input.

mod support;

use std::collections::BTreeMap;
use support::{Folder, folder, handc, table};

/// A lever that hangs on one tendon; the tendon's anchor is right above the hinge.
const LEVER: &str = "/// A lever on a tendon.
model lever {
    param k = 5e4 N/m;
    gravity = (0, 0, -9.81) m/s^2;
    joint q: revolute(y) in world { start = 20 deg; limits = (-60 deg, 80 deg); }
    mass bob in q { mass = 0.4 kg; at = (0.25, 0, 0) m; }
    frame end in q at (0.25, 0, 0) m;
    strand tendon { path = world (0, 0, 0.1) m -> q (0.08, 0, 0) m; stiffness = k; }
    scenario s {
        step = 1 ms;
        duration = 1 s;
        pose low { q = 50 deg; }
        pose high { q = -40 deg; }
    }
}
";

/// Two joints, two flexors, two extensors, gravity across.
const FINGER: &str = "/// A finger of two joints.
model two {
    gravity = (0, -9.81, 0) m/s^2;
    joint a: revolute(z) in world { start = -0.5; limits = (-1.5, 0.3); }
    mass m in a { mass = 0.03 kg; at = (20, 0, 0) mm; }
    joint b: revolute(z) in a at (40, 0, 0) mm { start = -0.7; limits = (-1.6, 0.1); }
    mass n in b { mass = 0.02 kg; at = (15, 0, 0) mm; }
    frame tip in b at (30, 0, 0) mm;
    strand deep { path = world (-30, -9, 0) mm -> a (8, -9, 0) mm -> a (33, -7, 0) mm -> b (6, -6, 0) mm; stiffness = 4e4 N/m; }
    strand shallow { path = world (-30, -11, 0) mm -> a (10, -10, 0) mm; stiffness = 4e4 N/m; }
    strand back { path = world (-30, 9, 0) mm -> a (4, 8, 0) mm; stiffness = 4e4 N/m; }
    strand far { path = world (-30, 10, 0) mm -> a (4, 9, 0) mm -> a (37, 7, 0) mm -> b (4, 6, 0) mm; stiffness = 4e4 N/m; }
}
";

/// A finger whose two end joints are coupled, and a loop of bars with a strand across.
const COUPLED: &str = "/// Coupled joints.
model coupled {
    joint a: revolute(z) in world { start = -0.5; limits = (-1.4, 0.2); }
    mass m in a { mass = 0.03 kg; at = (20, 0, 0) mm; }
    joint b: revolute(z) in a at (40, 0, 0) mm { start = -0.6; limits = (-1.5, 0); }
    mass n in b { mass = 0.02 kg; at = (10, 0, 0) mm; }
    joint c: revolute(z) in b at (25, 0, 0) mm { start = -0.4; }
    mass o in c { mass = 0.01 kg; at = (8, 0, 0) mm; }
    frame tip in c at (16, 0, 0) mm;
    constraint link: c == 0.6 * b;
    strand flexor { path = world (-30, -9, 0) mm -> a (8, -9, 0) mm -> a (33, -7, 0) mm -> b (6, -6, 0) mm
        -> b (20, -5, 0) mm -> c (4, -5, 0) mm; stiffness = 4e4 N/m; }
    strand short { path = world (-30, -11, 0) mm -> a (10, -10, 0) mm; stiffness = 4e4 N/m; }
    strand extensor { path = world (-30, 9, 0) mm -> a (4, 8, 0) mm -> a (37, 7, 0) mm -> b (4, 6, 0) mm; stiffness = 4e4 N/m; }
}
";

/// A muscle that branches at a node into two slips over two joints, against a spring.
const BRANCHED: &str = "/// A branching tendon.
model branched {
    joint a: revolute(z) in world { start = -0.4; limits = (-1.0, 0.2); stiffness = 0.05 N*m/rad; }
    mass m in a { mass = 0.03 kg; at = (20, 0, 0) mm; }
    joint b: revolute(z) in a at (40, 0, 0) mm { start = -0.3; limits = (-1.0, 0.2); stiffness = 0.04 N*m/rad; }
    mass n in b { mass = 0.02 kg; at = (10, 0, 0) mm; }
    frame tip in b at (30, 0, 0) mm;
    node hood at (18, 9, 0) mm in a { on = plane(z); }
    strand muscle { path = world (-40, 10, 0) mm -> world (-3, 11, 0) mm -> hood; stiffness = 3e3 N/m; rest = 57 mm; }
    strand slip { path = hood -> a (38, 7, 0) mm -> b (4, 6, 0) mm; stiffness = 8e3 N/m; rest = 25 mm; }
    strand side { path = hood -> a (14, -3, 0) mm; stiffness = 5e3 N/m; rest = 11 mm; }
}
";

/// The cells of a CSV whose first column is a name, by name and column.
fn cells(text: &str) -> BTreeMap<(String, String), f64> {
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut found = BTreeMap::new();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), head.len(), "{line}");
        for (name, cell) in head.iter().zip(&cells).skip(1) {
            let value = cell.parse().unwrap_or(f64::NAN);
            found.insert((cells[0].to_string(), (*name).to_string()), value);
        }
    }
    found
}

fn cell(cells: &BTreeMap<(String, String), f64>, row: &str, column: &str) -> f64 {
    cells[&(row.to_string(), column.to_string())]
}

/// Runs a command that must succeed.
fn done(folder: &Folder, arguments: &[&str]) -> String {
    let said = handc(folder, arguments);
    assert_eq!(said.code, 0, "{arguments:?}\n{}{}", said.out, said.err);
    said.out
}

/// Length of the lever's tendon and its arm at q, by the law of cosines: the angle at the hinge is
/// q + 90°.
fn lever(q: f64) -> (f64, f64) {
    let (a, b) = (0.1f64, 0.08f64);
    let length = (a * a + b * b + 2.0 * a * b * q.sin()).sqrt();
    (length, a * b * q.cos() / length)
}

#[test]
fn a_lever_is_held_by_its_closed_form() {
    let here = folder("lever");
    here.write("lever.hdl", LEVER);
    for (pose, degrees) in [("low", 50.0f64), ("high", -40.0)] {
        let said = done(&here, &["pose", "lever.hdl", "--pose", pose, "--hold", "--out", "h"]);
        assert!(said.contains("is held"), "{said}");
        let q = degrees.to_radians();
        let (length, arm) = lever(q);
        // The weight turns by m g l cos q, and so would a force at the end.
        let tension = 0.4 * 9.81 * 0.25 * q.cos() / arm;
        let strands = cells(&here.read("h.strands.csv"));
        let close = |column: &str, expected: f64| {
            let found = cell(&strands, "tendon", column);
            assert!(
                (found - expected).abs() < 1e-12 * expected.abs().max(1.0),
                "{column}: {found} {expected}"
            );
        };
        close("length", length);
        close("moment_arm.q", arm);
        close("tension", tension);
        close("natural_length", length - tension / 5e4);
        let load = ["--load", "end=0,0,-3"];
        done(
            &here,
            &[&["pose", "lever.hdl", "--pose", pose, "--hold", "--out", "h"], &load[..]].concat(),
        );
        let strands = cells(&here.read("h.strands.csv"));
        let more = tension + 3.0 * 0.25 * q.cos() / arm;
        assert!((cell(&strands, "tendon", "tension") - more).abs() < 1e-11);
        // Its strength straight up: what the limit leaves beside the weight.
        let strength =
            ["strength", "lever.hdl", "--pose", pose, "--at", "end", "--limit-all", "60"];
        let up = ["--direction", "0,0,2", "--out", "s"];
        done(&here, &[&strength[..], &up[..]].concat());
        let text = here.read("s.csv");
        assert!(
            text.starts_with("dx,dy,dz,force,fx,fy,fz,tension.tendon,at_limit\n0,0,"),
            "{text}"
        );
        let row: Vec<&str> = text.lines().nth(1).expect("a row").split(',').collect();
        let force = (60.0 - tension) * arm / (0.25 * q.cos());
        assert!((row[3].parse::<f64>().unwrap() - force).abs() < 1e-11, "{text} {force}");
        assert_eq!((row[7], row[8]), ("6.0000000000000000e1", "tendon"));
    }
}

#[test]
fn a_lever_cannot_be_held_by_what_does_not_pull_its_way() {
    let here = folder("lever_limits");
    here.write("lever.hdl", LEVER);
    let hold = |more: &[&str]| handc(&here, &[&["pose", "lever.hdl", "--hold"], more].concat());
    // Pushed up more than its weight: the tendon cannot push.
    let said = hold(&["--load", "end=0,0,5"]);
    assert_eq!(said.code, 3, "{}", said.out);
    assert!(said.out.contains("cannot be held"), "{}", said.out);
    assert!(said.out.contains("no strand turns it that way"), "{}", said.out);
    let missing = (5.0 - 0.4 * 9.81) * 0.25 * 20f64.to_radians().cos() * 1e3;
    assert!(said.out.contains(&format!("{missing:.4} N*mm")), "{} {missing}", said.out);
    // Too weak.
    let (_, arm) = lever(20f64.to_radians());
    let tension = 0.4 * 9.81 * 0.25 * 20f64.to_radians().cos() / arm;
    let said = hold(&["--limit-all", &format!("{}", tension - 1.0)]);
    assert_eq!(said.code, 3, "{}", said.out);
    assert!(said.out.contains("at their limit: tendon"), "{}", said.out);
    assert!(said.out.contains(&format!("{:.4} N*mm", arm * 1e3)), "{}", said.out);
    let said = hold(&["--limit", &format!("tendon={}", tension + 1e-6)]);
    assert_eq!(said.code, 0, "{}", said.out);
    // Too soft for a natural length.
    let said = hold(&["--set", "k=50"]);
    assert_eq!(said.code, 0, "{}", said.out);
    assert!(said.out.contains("too soft"), "{}", said.out);
}

#[test]
fn there_and_back() {
    let here = folder("back");
    here.write("two.hdl", FINGER);
    here.write("coupled.hdl", COUPLED);
    // The same with a toe region and slack, whose natural lengths have no closed form.
    let toe = "energy = 4e4 N/m * (x - x0)^2 / 2 + 3e6 N/m^2 * (x - x0)^3 / 3; slack = true; slack_width = 0.2 mm";
    here.write("toe.hdl", &FINGER.replace("stiffness = 4e4 N/m", toe));
    let cases: [(&str, &[&str], &[&str]); 3] = [
        ("toe.hdl", &["a", "b"], &["--load", "tip=0.5,1.5,0", "--start", "a=-40deg"]),
        ("two.hdl", &["a", "b"], &["--load", "tip=0.5,1.5,0", "--start", "a=-40deg"]),
        (
            "coupled.hdl",
            &["a", "b", "c"],
            &["--load", "tip=0.3,1.0,0", "--start", "b=-0.8", "--start", "c=-0.48"],
        ),
    ];
    for (file, joints, more) in cases {
        let out = done(&here, &[&["pose", file, "--hold", "--out", "h"], more].concat());
        assert!(out.contains("stable: it comes back"), "{out}");
        let strands = cells(&here.read("h.strands.csv"));
        let names: Vec<&str> = match file {
            "coupled.hdl" => vec!["flexor", "short", "extensor"],
            _ => vec!["deep", "shallow", "back", "far"],
        };
        let rests: Vec<String> = names
            .iter()
            .map(|name| format!("{name}={:e}", cell(&strands, name, "natural_length")))
            .collect();
        // From the pose of the model, not from the one that was held.
        let mut arguments = vec!["pose", file, "--out", "r"];
        arguments.extend_from_slice(&more[..2]);
        rests.iter().for_each(|rest| arguments.extend_from_slice(&["--rest", rest]));
        let said = done(&here, &arguments);
        assert!(said.contains("stable: it comes back"), "{said}");
        let held = cells(&here.read("h.coordinates.csv"));
        let found = cells(&here.read("r.coordinates.csv"));
        for joint in joints {
            let apart = (cell(&held, joint, "value") - cell(&found, joint, "value")).abs();
            assert!(apart < 1e-12, "{file} {joint}: {apart:.1e}\n{said}");
            assert!(
                (cell(&found, joint, "pose") - cell(&found, joint, "value")).abs() > 1e-3
                    || *joint == "b"
                    || file == "coupled.hdl"
            );
        }
        let again = cells(&here.read("r.strands.csv"));
        for name in names {
            let (a, b) = (cell(&strands, name, "tension"), cell(&again, name, "tension"));
            assert!((a - b).abs() < 1e-8 && a > -1e-12, "{name}: {a} {b}");
        }
    }
}

#[test]
fn commanded_tensions_bring_a_spring_to_its_closed_form() {
    let here = folder("commanded");
    let sprung = LEVER
        .replace("start = 20 deg;", "start = 20 deg; stiffness = 3 N*m/rad; rest = 0.2;")
        .replace(
            "stiffness = k;",
            "stiffness = k; damping = 3 N*s/m; slack = true; slack_width = 1 mm;",
        );
    here.write("lever.hdl", &sprung);
    let pose =
        ["pose", "lever.hdl", "--tension", "tendon=12N", "--load", "end=0,0,2", "--out", "c"];
    let said = done(&here, &pose);
    assert!(said.contains("commanded") && said.contains("12.0000 N"), "{said}");
    let found = cell(&cells(&here.read("c.coordinates.csv")), "q", "value");
    let force = |q: f64| (0.4 * 9.81 - 2.0) * 0.25 * q.cos() - 3.0 * (q - 0.2) - 12.0 * lever(q).1;
    let (mut low, mut high) = (-1.0, 1.5);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if force(middle) > 0.0 { low = middle } else { high = middle }
    }
    assert!((found - low).abs() < 1e-13, "{found} {low}");
    let wrong: [(&[&str], &str); 4] = [
        (&["--tension", "tendon=-1"], "cannot push"),
        (&["--tension", "tendon=1", "--rest", "tendon=0.1"], "a tension and a natural length"),
        (&["--tension", "tendon=1", "--hold"], "exclude each other"),
        (&["--tension", "tendom=1"], "did you mean `tendon`?"),
    ];
    for (more, part) in wrong {
        let said = handc(&here, &[&["pose", "lever.hdl"], more].concat());
        assert!(said.code == 2 && said.err.contains(part), "{more:?}: {}", said.err);
    }
}

#[test]
fn prescribed_lengths_are_held_by_their_multipliers() {
    let here = folder("prescribed");
    here.write("lever.hdl", &LEVER.replace("stiffness = k;", "drive = true;"));
    let said = done(&here, &["pose", "lever.hdl", "--pose", "low", "--out", "p"]);
    assert!(said.contains("nothing can move"), "{said}");
    let q = 50f64.to_radians();
    let tension = 0.4 * 9.81 * 0.25 * q.cos() / lever(q).1;
    let found = cell(&cells(&here.read("p.strands.csv")), "tendon", "tension");
    assert!((found - tension).abs() < 1e-12, "{found} {tension}");
    // What holds it is the same tension, and the joint can still be swept.
    done(&here, &["pose", "lever.hdl", "--pose", "low", "--hold", "--out", "h"]);
    let strands = cells(&here.read("h.strands.csv"));
    assert!((cell(&strands, "tendon", "tension") - tension).abs() < 1e-12);
    let said = handc(&here, &["atlas", "lever.hdl", "--points", "5", "--out", "a"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.err.contains("measured only"), "{}", said.err);
    for [q, length, arm, _] in &atlas(&here.read("a.csv"))[&("q".to_string(), "tendon".to_string())]
    {
        let expected = lever(*q);
        assert!((length - expected.0).abs() < 1e-15 && (arm - expected.1).abs() < 1e-15);
    }
}

#[test]
fn a_branch_balances_at_its_node() {
    let here = folder("branch");
    here.write("branched.hdl", BRANCHED);
    done(
        &here,
        &["pose", "branched.hdl", "--load", "tip=0,-0.3,0", "--pull", "muscle=1mm", "--out", "b"],
    );
    let (strands, q) = (cells(&here.read("b.strands.csv")), cells(&here.read("b.coordinates.csv")));
    // Virtual work over every coordinate, the node's among them: tensions, springs and the load.
    let (a, b) = (cell(&q, "a", "value"), cell(&q, "b", "value"));
    let tip = [0.04 * a.cos() + 0.03 * (a + b).cos(), 0.03 * (a + b).cos()];
    for (coordinate, stiffness, value, arm) in [
        ("a", 0.05, a, tip[0]),
        ("b", 0.04, b, tip[1]),
        ("hood.x", 0.0, 0.0, 0.0),
        ("hood.y", 0.0, 0.0, 0.0),
    ] {
        let pulled: f64 = ["muscle", "slip", "side"]
            .iter()
            .map(|s| {
                cell(&strands, s, "tension")
                    * cell(&strands, s, &format!("moment_arm.{coordinate}"))
            })
            .sum();
        let left = pulled + stiffness * value + 0.3 * arm;
        assert!(left.abs() < 1e-12, "{coordinate}: {left:.1e}");
    }
}

/// Largest F with Σ Tᵢ pᵢ + w = F j over two joints and bounds 0 ≤ T ≤ limit: every vertex is tried.
fn vertices(pull: &[[f64; 2]], weight: [f64; 2], tip: [f64; 2], limits: &[f64]) -> f64 {
    let count = pull.len();
    let columns: Vec<[f64; 2]> = pull.iter().copied().chain([[-tip[0], -tip[1]]]).collect();
    let mut best = f64::NAN;
    for first in 0..=count {
        for second in 0..first {
            let others: Vec<usize> = (0..count).filter(|&i| i != first && i != second).collect();
            for choice in 0..1 << others.len() {
                let mut right = [-weight[0], -weight[1]];
                for (bit, &i) in others.iter().enumerate() {
                    if choice >> bit & 1 == 1 {
                        (0..2).for_each(|k| right[k] -= limits[i] * pull[i][k]);
                    }
                }
                let (a, b) = (columns[first], columns[second]);
                let det = a[0] * b[1] - a[1] * b[0];
                if det.abs() < 1e-15 {
                    continue;
                }
                let x = (right[0] * b[1] - right[1] * b[0]) / det;
                let y = (a[0] * right[1] - a[1] * right[0]) / det;
                let fits = |i: usize, value: f64| {
                    let limit = limits.get(i).copied().unwrap_or(f64::INFINITY);
                    value >= -1e-9 && value <= limit + 1e-9
                };
                if fits(first, x) && fits(second, y) {
                    let force = if first == count { x } else { 0.0 };
                    best = if best >= force { best } else { force };
                }
            }
        }
    }
    best
}

#[test]
fn strength_is_the_best_of_all_vertices() {
    let here = folder("vertices");
    here.write("two.hdl", FINGER);
    let poses = [["a=-0.5", "b=-0.7"], ["a=-1.2", "b=-1.4"], ["a=0.1", "b=-0.2"]];
    let limits = [25.0, 18.0, 20.0, 9.0];
    let names = ["deep", "shallow", "back", "far"];
    let mut compared = 0;
    for [a, b] in poses {
        let pose = ["two.hdl", "--start", a, "--start", b];
        done(&here, &[&["pose"], &pose[..], &["--out", "p", "--rest", "deep=0.06"]].concat());
        // The arms are those of the pose that is held with no load, whatever holds it.
        done(&here, &[&["pose"], &pose[..], &["--hold", "--out", "p"]].concat());
        let strands = cells(&here.read("p.strands.csv"));
        let arms: Vec<[f64; 2]> = names
            .iter()
            .map(|name| ["moment_arm.a", "moment_arm.b"].map(|arm| -cell(&strands, name, arm)))
            .collect();
        let value = |text: &str| text[2..].parse::<f64>().unwrap();
        let (q, r) = (value(a), value(a) + value(b));
        // Weights of the two bodies at their joints.
        let g = 9.81;
        let at_b = -0.02 * g * 0.015 * r.cos();
        let at_a = -0.03 * g * 0.02 * q.cos() - 0.02 * g * 0.04 * q.cos() + at_b;
        let mut arguments = vec!["strength"];
        arguments.extend_from_slice(&pose);
        let limit: Vec<String> =
            names.iter().zip(limits).map(|(name, limit)| format!("{name}={limit}")).collect();
        limit.iter().for_each(|limit| arguments.extend_from_slice(&["--limit", limit]));
        let out = ["--at", "tip", "--plane", "xy", "--directions", "72", "--out", "s"];
        arguments.extend_from_slice(&out);
        done(&here, &arguments);
        let text = here.read("s.csv");
        let head = "angle,dx,dy,dz,force,fx,fy,fz,tension.deep,tension.shallow,tension.back,tension.far,at_limit";
        assert_eq!(text.lines().next(), Some(head));
        for line in text.lines().skip(1) {
            let row: Vec<&str> = line.split(',').collect();
            let number = |k: usize| row[k].parse::<f64>().unwrap();
            let (dx, dy) = (number(1), number(2));
            assert!((number(0).cos() - dx).abs() < 1e-15 && (number(0).sin() - dy).abs() < 1e-15);
            // Jᵀd of the tip.
            let b_arm = -0.03 * r.sin() * dx + 0.03 * r.cos() * dy;
            let a_arm = b_arm - 0.04 * q.sin() * dx + 0.04 * q.cos() * dy;
            let expected = vertices(&arms, [at_a, at_b], [a_arm, b_arm], &limits);
            let found = number(4);
            assert!((found - expected).abs() < 1e-9 * expected.max(1.0), "{line}: {expected}");
            // The tensions balance it and keep their limits.
            for (joint, (weight, tip)) in [(at_a, a_arm), (at_b, b_arm)].into_iter().enumerate() {
                let pulled: f64 = (0..4).map(|s| number(8 + s) * arms[s][joint]).sum();
                assert!((pulled + weight - found * tip).abs() < 1e-12, "{line}");
            }
            for s in 0..4 {
                assert!((0.0..=limits[s]).contains(&number(8 + s)), "{line}");
                let at = row[12].split(' ').any(|name| name == names[s]);
                assert!(!at || number(8 + s) == limits[s], "{line}");
            }
            assert!(found == 0.0 || !row[12].is_empty(), "{line}");
            compared += 1;
        }
    }
    assert_eq!(compared, 3 * 72);
}

#[test]
fn what_may_be_exerted_beside_the_direction_makes_stronger() {
    let here = folder("off_axis");
    here.write("two.hdl", FINGER);
    let force = |off_axis: &str| -> Vec<f64> {
        let strength = ["strength", "two.hdl", "--at", "tip", "--plane", "xy", "--limit-all", "20"];
        let more = ["--off-axis", off_axis, "--directions", "24", "--out", "s"];
        done(&here, &[&strength[..], &more[..]].concat());
        let text = here.read("s.csv");
        text.lines().skip(1).map(|l| l.split(',').nth(4).unwrap().parse().unwrap()).collect()
    };
    let (zero, free) = (force("zero"), force("free"));
    assert!(zero.iter().zip(&free).all(|(zero, free)| *free >= zero - 1e-9));
    assert!(zero.iter().zip(&free).any(|(zero, free)| *free > zero + 1.0));
    assert!(here.read("s.svg").contains("<svg") && here.size("s.png") > 1000);
    assert!(here.read("s.tensions.svg").contains("deep") && here.size("s.tensions.png") > 1000);
}

#[test]
fn what_the_joints_carry_alone_has_no_end() {
    let here = folder("no_end");
    here.write("two.hdl", FINGER);
    // Across the plane, and along a straight finger.
    let strength = ["strength", "two.hdl", "--at", "tip", "--limit-all", "20"];
    let said = handc(&here, &[&strength[..], &["--direction", "0,0,1"]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.out.contains("no end") && said.err.contains("carry the force"), "{}", said.out);
    let said = handc(&here, &["strength", "two.hdl", "--at", "world", "--limit-all", "20"]);
    assert_eq!(said.code, 2, "{}", said.err);
    assert!(said.err.contains("nothing moves `world`"), "{}", said.err);
}

/// Rows of an atlas by joint and strand: value, length, moment arm, tension.
fn atlas(text: &str) -> BTreeMap<(String, String), Vec<[f64; 4]>> {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("joint,value,strand,length,moment_arm,tension"));
    let mut found: BTreeMap<_, Vec<[f64; 4]>> = BTreeMap::new();
    for line in lines {
        let row: Vec<&str> = line.split(',').collect();
        let numbers = [1, 3, 4, 5].map(|k: usize| row[k].parse().expect("a number"));
        found.entry((row[0].to_string(), row[2].to_string())).or_default().push(numbers);
    }
    found
}

#[test]
fn moment_arms_are_the_slopes_of_lengths() {
    let here = folder("atlas");
    here.write("two.hdl", FINGER);
    here.write("coupled.hdl", COUPLED);
    here.write("lever.hdl", LEVER);
    done(&here, &["atlas", "lever.hdl", "--points", "31", "--rest", "tendon=100mm", "--out", "l"]);
    let found = atlas(&here.read("l.csv"));
    let rows = &found[&("q".to_string(), "tendon".to_string())];
    assert_eq!(rows.len(), 31);
    assert_eq!(rows[0][0], -60f64.to_radians());
    assert_eq!(rows[30][0], 80f64.to_radians());
    for [q, length, arm, tension] in rows {
        let expected = lever(*q);
        assert!((length - expected.0).abs() < 1e-15 && (arm - expected.1).abs() < 1e-15);
        assert!((tension - 5e4 * (length - 0.1)).abs() < 1e-9);
    }
    // Coupled joints and nodes move along: the slope along the sweep.
    here.write("branched.hdl", BRANCHED);
    for (file, sweeps) in [("two.hdl", 6), ("coupled.hdl", 5), ("branched.hdl", 6)] {
        done(&here, &["atlas", file, "--points", "2001", "--out", "x"]);
        let found = atlas(&here.read("x.csv"));
        assert_eq!(found.len(), sweeps, "{:?}", found.keys());
        for (name, rows) in &found {
            for three in rows.windows(3) {
                let slope = (three[2][1] - three[0][1]) / (three[2][0] - three[0][0]);
                assert!((slope - three[1][2]).abs() < 1e-7, "{file} {name:?} {three:?}");
            }
        }
        assert!(here.read("x.svg").contains("moment arm") && here.size("x.png") > 1000);
    }
}

#[test]
fn a_grid_holds_both_arms() {
    let here = folder("grid");
    here.write("two.hdl", FINGER);
    let grid =
        ["atlas", "two.hdl", "--grid", "a", "b", "--joint", "b=-60deg:0deg", "--points", "7"];
    done(&here, &[&grid[..], &["--strand", "deep", "--out", "g"]].concat());
    let text = here.read("g.csv");
    assert!(text.starts_with("a,b,strand,length,moment_arm.a,moment_arm.b,tension\n"), "{text}");
    assert_eq!(text.lines().count(), 1 + 49);
    assert!(here.read("g.svg").contains("moment arm about b") && here.size("g.png") > 1000);
    // A row of the grid is the sweep at that value of the other joint.
    done(
        &here,
        &[
            "atlas", "two.hdl", "--start", "b=0", "--joint", "a", "--points", "7", "--strand",
            "deep", "--out", "l",
        ],
    );
    let sweep = atlas(&here.read("l.csv"));
    let rows = &sweep[&("a".to_string(), "deep".to_string())];
    let last: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.replace("deep,", "").split(',').map(|c| c.parse().unwrap()).collect())
        .filter(|row: &Vec<f64>| row[1] == 0.0)
        .collect();
    assert_eq!(last.len(), rows.len());
    for (grid, line) in last.iter().zip(rows) {
        assert_eq!([grid[0], grid[2], grid[3]], [line[0], line[1], line[2]]);
    }
}

#[test]
fn a_rest_is_told_in_full() {
    let here = folder("rest");
    here.write("two.hdl", FINGER);
    let pose = ["pose", "two.hdl", "--pull", "deep=1mm", "--load", "tip=0,1N,0", "--out", "r"];
    let out = done(&here, &pose);
    for part in [
        "two, (0, 1, 0) N on tip, comes to rest",
        "coordinate",
        "natural length",
        "stable: it comes back from every small push",
        "stiffness (N*mm/rad)",
        "natural frequencies (Hz)",
        "strand Jacobian, singular values (mm/rad)",
        "tip at (",
        "mm/N along (",
    ] {
        assert!(out.contains(part), "{part}\n{out}");
    }
    let (_, rows) = table(
        &here
            .read("r.strands.csv")
            .replace("deep", "0")
            .replace("shallow", "1")
            .replace("back", "2")
            .replace("far", "3")
            .replace("strand", "s"),
    );
    assert_eq!(rows.len(), 4);
    assert!(here.read("r.svg").contains("at rest") && here.size("r.png") > 1000);
}

#[test]
fn all_that_is_wrong_is_told_at_once() {
    let here = folder("wrong");
    here.write("two.hdl", FINGER);
    here.write("lever.hdl", LEVER);
    let said = handc(
        &here,
        &[
            "pose",
            "two.hdl",
            "--rest",
            "deap=0.1",
            "--load",
            "tipp=1,2,3",
            "--load",
            "tip=1,2",
            "--start",
            "a=2",
            "--pull",
            "far=-1furlong",
        ],
    );
    assert_eq!(said.code, 2);
    for part in [
        "`two` has no strand `deap`: did you mean `deep`?",
        "`two` has no frame `tipp`: did you mean `tip`?",
        "`1,2` is not three numbers",
        "outside the limits of `a`: -1.5000 to 0.3000 rad",
        "`furlong` is not a unit",
    ] {
        assert!(said.err.contains(part), "{part}\n{}", said.err);
    }
    assert_eq!(said.err.lines().count(), 5, "{}", said.err);
    let cases: [(&[&str], &str); 22] = [
        (&["atlas", "two.hdl", "--joint", "a=0.2:-0.2"], "reversed"),
        (&["atlas", "two.hdl", "--joint", "a=0.2"], "a range is LO:HI"),
        (&["atlas", "two.hdl", "--joint", "x"], "it has `a`, `b`"),
        (&["atlas", "two.hdl", "--joint", "a=0mm:1mm"], "use `rad`, `deg`"),
        (&["atlas", "two.hdl", "--joint", "a", "--joint", "a"], "given twice"),
        (&["atlas", "two.hdl", "--strand", "dep"], "did you mean `deep`?"),
        (&["atlas", "two.hdl", "--grid", "a", "a"], "two joints"),
        (&["atlas", "two.hdl", "--points", "1"], "points"),
        (&["atlas", "two.hdl", "--pose", "fist"], "it has none"),
        (
            &["atlas", "lever.hdl", "--pose", "lo"],
            "`lever.s` has no pose `lo`: did you mean `low`?",
        ),
        (&["atlas", "lever.hdl", "--scenario", "t"], "has no scenario `t`"),
        (&["atlas", "lever.hdl", "--set", "kk=1"], "has no parameter `kk`"),
        (&["pose", "two.hdl", "--rest", "deep"], "NAME=VALUE"),
        (&["pose", "two.hdl", "--rest", "deep=-1mm"], "negative"),
        (&["pose", "two.hdl", "--pull", "deep=1m"], "is less"),
        (&["pose", "two.hdl", "--limit-all", "3"], "need `--hold`"),
        (&["pose", "two.hdl", "--hold", "--pull", "deep=1mm"], "exclude each other"),
        (&["pose", "two.hdl", "--hold", "--limit", "deep=-3"], "cannot have the limit"),
        (&["pose", "two.hdl", "--load", "tip=1,nan,0"], "finite"),
        (
            &["strength", "two.hdl", "--at", "tip", "--limit", "deep=3"],
            "no limit of tension for `shallow`, `back`, `far`",
        ),
        (
            &["strength", "two.hdl", "--at", "tip", "--limit-all", "3", "--direction", "0,0,0"],
            "points nowhere",
        ),
        (
            &[
                "strength",
                "two.hdl",
                "--at",
                "tip",
                "--limit",
                "deep=3",
                "--passive",
                "deep",
                "--limit-all",
                "3",
            ],
            "`--limit` and with `--passive`",
        ),
    ];
    for (arguments, part) in cases {
        let said = handc(&here, arguments);
        assert_eq!(said.code, 2, "{arguments:?}: {}{}", said.out, said.err);
        assert!(said.err.contains(part), "{arguments:?}: {}", said.err);
    }
    let said = handc(&here, &["atlas", "two.hdl", "--out", "no/such/folder/x"]);
    assert!(said.code == 3 && said.err.contains("cannot write"), "{}", said.err);
}

#[test]
fn models_without_strands_are_answered_too() {
    let here = folder("strandless");
    let text = "model bare {\n    gravity = (0, 0, -9.81) m/s^2;\n    joint q: revolute(y) in world { start = 0.3; }\n    mass m in q { mass = 1 kg; at = (0, 0, -0.5) m; }\n}\n";
    here.write("bare.hdl", text);
    assert!(done(&here, &["pose", "bare.hdl"]).contains("stable"));
    let said = handc(&here, &["pose", "bare.hdl", "--hold"]);
    assert_eq!(said.code, 3, "{}", said.err);
    assert!(said.out.contains("no strand turns it that way"), "{}", said.out);
    assert!(said.out.contains("nearest tensions: none"), "{}", said.out);
    done(&here, &["pose", "bare.hdl", "--hold", "--start", "q=0"]);
    for command in [&["atlas", "bare.hdl"][..], &["strength", "bare.hdl", "--at", "q"]] {
        let said = handc(&here, command);
        assert_eq!(said.code, 2);
        assert_eq!(said.err, "error: `bare` has no strands\n");
    }
}

#[test]
fn what_runs_away_is_told() {
    let here = folder("away");
    let loose = FINGER.replace("stiffness = 4e4 N/m", "stiffness = 0 N/m");
    here.write("loose.hdl", &loose.replace("gravity = (0, -9.81, 0)", "gravity = (0, 0, 0)"));
    // A turning load that nothing holds comes to rest along its line; one at the hinge's own frame
    // does nothing.
    let said = handc(&here, &["pose", "loose.hdl", "--load", "tip=0,1,0"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.out.contains("stable"), "{}", said.out);
    let said = handc(&here, &["pose", "loose.hdl"]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.out.contains("neutral: nothing holds it along"), "{}", said.out);
    here.write("slide.hdl", "model slide {\n    joint x: prismatic(x) in world;\n    mass m in x { mass = 1 kg; }\n    joint r: revolute(z) in x { stiffness = 1 N*m/rad; }\n    mass n in r { mass = 1 kg; at = (0.1, 0, 0) m; }\n    frame f in x;\n}\n");
    let said = handc(&here, &["pose", "slide.hdl", "--load", "f=1,0,0"]);
    assert_eq!(said.code, 3, "{}", said.out);
    assert!(
        said.err.contains("no equilibrium was found") && said.err.contains("holds `x`"),
        "{}",
        said.err
    );
}

/// The commands of the guide's page run, and its pictures and outputs are what they make.
#[test]
fn the_guide_shows_what_is_made() {
    let here = folder("guide");
    let repository = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = repository.join("docs/guide/src/statics.md");
    let text = std::fs::read_to_string(&page).expect("the page");
    let models = format!("{}/models/", repository.display());
    let (mut outputs, mut fence, mut ran) = (String::new(), "", 0);
    for line in text.lines() {
        if let Some(info) = line.strip_prefix("```") {
            fence = info;
        } else if fence == "sh" {
            let words: Vec<String> =
                line.split(' ').skip(1).map(|word| word.replace("models/", &models)).collect();
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let said = handc(&here, &words);
            assert!(matches!(said.code, 0 | 3), "{line}: {}{}", said.out, said.err);
            outputs.push_str(&said.out);
            ran += 1;
        }
    }
    assert!(ran >= 10, "{ran}");
    for block in text.split("```text\n").skip(1) {
        let shown = block.split("```").next().unwrap_or_default();
        assert!(outputs.contains(shown), "nothing prints this:\n{shown}");
    }
    let mut pictures = 0;
    for name in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        if name.ends_with(".svg") {
            let (made, path) = (here.read(name), page.with_file_name(name));
            if std::env::var_os("HANDC_UPDATE").is_some() {
                std::fs::write(&path, &made).expect("the picture is written");
            }
            let kept = std::fs::read_to_string(&path).unwrap_or_default();
            assert!(made == kept, "{name} differs; HANDC_UPDATE=1 rewrites it");
            pictures += 1;
        }
    }
    assert_eq!(pictures, 5);
}
