//! Families of models of any size: chains, and fingers side by side.

use std::fmt::Write;

/// A chain of hinged rods, slightly bent, that swings under gravity.
pub fn chain(links: usize) -> String {
    let mut text =
        format!("/// Hinged rods.\nmodel chain_{links} {{\n    gravity = (0, 0, -9.81) m/s^2;\n");
    for i in 0..links {
        let parent = if i == 0 { "world".into() } else { format!("j{} at (0, 0, -50) mm", i - 1) };
        let _ = writeln!(
            text,
            "    joint j{i}: revolute(y) in {parent} {{ start = 0.02 rad; }}\n    mass m{i} in j{i} = capsule \
             {{ from = (0, 0, 0) mm; to = (0, 0, -50) mm; radius = 5 mm; mass = 0.05 kg; }}"
        );
    }
    text + "    scenario fall { step = 1 ms; duration = 1 s; }\n}\n"
}

/// Planar fingers side by side, each with three joints and four strands.
pub fn fingers(count: usize) -> String {
    let mut text = FINGER.to_string();
    let _ = writeln!(text, "/// Fingers.\nmodel fingers_{count} {{");
    for i in 0..count {
        // Lengths differ a little, as those of a hand do.
        let size = 1.0 - 0.002 * i as f64;
        let _ = writeln!(
            text,
            "    place finger(s = {size}) as f{i} in world at (0, {}, 0) mm;",
            20 * i
        );
    }
    text + "    scenario sway { step = 1 ms; duration = 1 s; }\n}\n"
}

const FINGER: &str = "
/// Three flexion joints, four strands.
component finger(s: Number) {
    joint mcp: revolute(z) in base { start = -0.1 rad; velocity = -1 rad/s; }
    mass pp in mcp { mass = 11 g; at = (20 * s, 0, 0) mm; inertia = (0.45, 1.7, 1.7) kg*mm^2; }
    joint pip: revolute(z) in mcp at (40 * s, 0, 0) mm { start = -0.2 rad; }
    mass mp in pip { mass = 5 g; at = (11 * s, 0, 0) mm; inertia = (0.16, 0.29, 0.29) kg*mm^2; }
    joint dip: revolute(z) in pip at (22 * s, 0, 0) mm { start = -0.1 rad; velocity = 1 rad/s; }
    mass dp in dip { mass = 2.7 g; at = (8 * s, 0, 0) mm; inertia = (0.065, 0.089, 0.089) kg*mm^2; }
    strand fdp {
        path = base (-60, -10, 0) mm -> base (-8, -10, 0) mm -> mcp (10, -10, 0) mm -> mcp (34, -9, 0) mm
            -> pip (6, -8, 0) mm -> pip (18, -7, 0) mm -> dip (6, -6, 0) mm;
        stiffness = 200 N/m;
    }
    strand fds {
        path = base (-60, -12, 0) mm -> base (-8, -12, 0) mm -> mcp (10, -11, 0) mm -> mcp (34, -10, 0) mm
            -> pip (8, -8, 0) mm;
        stiffness = 200 N/m;
    }
    strand edc {
        path = base (-60, 10, 0) mm -> base (-6, 10, 0) mm -> mcp (10, 9.5, 0) mm -> mcp (36, 8, 0) mm
            -> pip (6, 7, 0) mm -> pip (20, 6, 0) mm -> dip (6, 5.5, 0) mm;
        stiffness = 150 N/m;
    }
    strand lum {
        path = base (-50, -7, 0) mm -> mcp (12, -5, 0) mm -> pip (4, 6, 0) mm -> dip (5, 5.5, 0) mm;
        stiffness = 100 N/m;
    }
}
";
