//! Whole figures: a small one word for word, odd ones for not failing.

use handc_plot::pose::{Pose, PoseFigure, Solid};
use handc_plot::timeplot::energy;
use handc_plot::{
    Curve, MapAxis, MapPlot, MapRow, Picture, PolarCurve, PolarPlot, Quantity, Sweep, SweepPlot,
    SweepRow, TimePlot, Unit, table,
};
use std::path::Path;

/// Compares with a file in `tests/golden`; `HANDC_UPDATE=1` rewrites it.
fn check(name: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    if std::env::var_os("HANDC_UPDATE").is_some() {
        std::fs::write(&path, text).expect("the golden file is written");
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(text == expected, "{} differs; HANDC_UPDATE=1 rewrites it", path.display());
}

fn curve(name: &str, values: &[f64]) -> Curve {
    Curve { name: name.into(), values: values.to_vec() }
}

fn small() -> TimePlot {
    let angles = vec![curve("mcp", &[0.0, 0.5, 1.0]), curve("pip", &[0.1, 0.2, f64::NAN])];
    let mut quantities = vec![Quantity::new("joint angle", Unit::Angle, angles)];
    quantities.extend(energy(vec![1e-3, 1.000001e-3, 1e-3]));
    TimePlot { title: "small".into(), time: vec![0.0, 0.5, 1.0], quantities }
}

/// Every element is closed, and nothing is drawn at a place that is not a number.
fn well_formed(svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1).filter_map(|part| part.split_once('>')).map(|part| part.0) {
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name.to_string()));
        } else if !tag.ends_with('/') {
            open.push(tag.split(' ').next().unwrap_or_default().to_string());
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn a_small_figure_stays_as_it_is() {
    let svg = small().svg();
    well_formed(&svg);
    check("small.svg", &svg);
    let png = small().png().expect("a picture");
    assert!(png.starts_with(b"\x89PNG\r\n") && png.len() > 5_000);
    // Width and height stand after the header.
    assert_eq!(u32::from_be_bytes([png[16], png[17], png[18], png[19]]), 1620);
}

#[test]
fn poses_stay_as_they_are() {
    let pose = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let tip = [0.1 * c, 0.1 * s, 0.0];
        Pose {
            time: angle,
            solids: vec![
                Solid::Rod { from: [0.0; 3], to: tip, radius: 0.01 },
                Solid::Ball { center: tip, radius: 0.02 },
            ],
            joints: vec![[0.0; 3]],
            anchors: vec![[-0.05, 0.02, 0.0]],
            strands: vec![vec![[-0.05, 0.02, 0.0], tip]],
            ..Pose::default()
        }
    };
    let poses = [0.0, 0.5, 1.0].map(pose).to_vec();
    let strands = vec!["cable".to_string()];
    let figure = PoseFigure { title: "arm".into(), strands, up: [0.0, 0.0, 1.0], poses };
    well_formed(&figure.svg());
    check("arm.svg", &figure.svg());
    assert!(figure.png().expect("a picture").len() > 5_000);
}

fn fan() -> SweepPlot {
    let values: Vec<f64> = (0..5).map(|k| f64::from(k) * 0.3 - 0.6).collect();
    let curve = |factor: f64| values.iter().map(|v| factor * v.cos()).collect::<Vec<_>>();
    let column = |label: &str| Sweep {
        label: label.into(),
        unit: Unit::Angle,
        values: values.clone(),
        mark: Some(0.1),
    };
    SweepPlot {
        title: "fan".into(),
        names: vec!["deep".into(), "back".into()],
        mark: "the pose".into(),
        columns: vec![column("mcp"), column("pip")],
        rows: vec![SweepRow {
            label: "moment arm".into(),
            unit: Unit::Prefixed("m"),
            cells: vec![vec![(0, curve(0.01)), (1, curve(-0.008))], vec![(0, curve(0.006))]],
        }],
    }
}

fn rose(size: &[f64]) -> PolarPlot {
    let count = size.len();
    PolarPlot {
        title: "rose".into(),
        label: "largest force".into(),
        unit: Unit::Prefixed("N"),
        axes: ["x".into(), "y".into()],
        curves: vec![PolarCurve {
            name: String::new(),
            angle: (0..count).map(|k| std::f64::consts::TAU * k as f64 / count as f64).collect(),
            size: size.to_vec(),
        }],
        skeleton: vec![vec![[0.0, 0.0], [0.01, 0.02], [-0.02, 0.05]]],
        notes: vec!["up to 100 N".into()],
    }
}

#[test]
fn sweeps_stay_as_they_are() {
    well_formed(&fan().svg());
    check("fan.svg", &fan().svg());
    assert!(fan().png().expect("a picture").len() > 5_000);
}

#[test]
fn directions_stay_as_they_are() {
    let plot = rose(&[10.0, 20.0, 35.0, 20.0, 12.0, 5.0, 0.0, 5.0]);
    well_formed(&plot.svg());
    check("rose.svg", &plot.svg());
    assert!(plot.png().expect("a picture").len() > 5_000);
}

fn field(cells: Vec<f64>) -> MapPlot {
    let axis = |label: &str| MapAxis {
        label: label.into(),
        unit: Unit::Angle,
        values: vec![-0.5, 0.0, 0.5, 1.0],
    };
    MapPlot {
        title: "field".into(),
        across: axis("mcp"),
        up: axis("pip"),
        names: vec!["deep".into()],
        rows: vec![MapRow { label: "arm".into(), unit: Unit::Prefixed("m"), cells: vec![cells] }],
    }
}

#[test]
fn maps_stay_as_they_are() {
    let cells = (0..16).map(|k| 1e-3 * f64::from((k % 4) * 2 + k / 4 - 4)).collect();
    let plot = field(cells);
    well_formed(&plot.svg());
    check("field.svg", &plot.svg());
    assert!(plot.png().expect("a picture").len() > 5_000);
    for odd in [f64::NAN, f64::INFINITY, -1e300, 1e-310, 0.0] {
        for count in [0, 3, 16] {
            let plot = field(vec![odd; count]);
            well_formed(&plot.svg());
            assert!(plot.png().is_ok());
        }
        let mut cells = vec![1.0; 16];
        cells[5] = odd;
        well_formed(&field(cells).svg());
    }
}

#[test]
fn directions_without_a_size_are_gaps() {
    let odd = [f64::NAN, f64::INFINITY, 0.0, 1e-310];
    for sizes in [&odd[..], &odd[..1], &[], &[0.0; 8], &[1.0, 1e6, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]] {
        let plot = rose(sizes);
        well_formed(&plot.svg());
        assert!(plot.png().is_ok());
    }
    // One direction without end leaves the curve open there.
    let open = rose(&[1.0, 2.0, f64::INFINITY, 2.0, 1.0, 1.0, 1.0, 1.0]).svg();
    assert!(!open.contains("Z\" fill=\"#d6"), "{open}");
    // A peak far beyond the others is cut off, and that is told.
    assert!(rose(&[1.0, 1e6, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]).svg().contains("cut off at"));
}

#[test]
fn odd_numbers_do_no_harm() {
    let odd = [f64::NAN, f64::INFINITY, -1e300, 1e-310, 0.0];
    for unit in [Unit::Angle, Unit::Prefixed("m"), Unit::Plain("K".into())] {
        for values in [&odd[..], &odd[..1], &[1e200, -1e200, 1e200], &[5.0, 5.0 + 1e-13, 5.0]] {
            let time: Vec<f64> = (0..values.len()).map(|i| i as f64).collect();
            let curves = (0..20).map(|i| curve(&format!("a{i}.<b>"), values)).collect();
            let quantities = vec![
                Quantity::new("many", unit.clone(), curves),
                Quantity::new("one", unit.clone(), vec![curve("x", values)]),
            ];
            let plot = TimePlot { title: "odd & long ".repeat(30), time, quantities };
            well_formed(&plot.svg());
            assert!(plot.png().is_ok());
            let mut sweep = fan();
            sweep.rows[0].cells = vec![vec![(1, values.to_vec())]];
            sweep.columns[0].values = values.to_vec();
            sweep.columns[0].unit = unit.clone();
            sweep.rows[0].unit = unit.clone();
            well_formed(&sweep.svg());
            assert!(sweep.png().is_ok());
        }
    }
}

#[test]
fn empty_figures_do_no_harm() {
    let plot = TimePlot { title: String::new(), time: vec![], quantities: vec![] };
    well_formed(&plot.svg());
    let figure = PoseFigure { title: String::new(), strands: vec![], up: [0.0; 3], poses: vec![] };
    well_formed(&figure.svg());
    let broken = Pose { strands: vec![vec![[f64::NAN; 3], [1.0; 3]]], ..Pose::default() };
    let figure = PoseFigure { poses: vec![broken, Pose::default()], ..figure };
    well_formed(&figure.svg());
    assert!(figure.png().is_ok());
}

#[test]
fn tables_of_one_row_and_of_many_are_drawn() {
    let one = table::read("t,a,energy\n0,1,2\n".as_bytes()).expect("a table").plot("one");
    well_formed(&one.svg());
    assert!(one.svg().contains("<circle"));
    let mut text = String::from("t,a\n");
    for i in 0..200_000 {
        text.push_str(&format!("{},{}\n", f64::from(i) * 1e-3, (f64::from(i) * 0.7).sin()));
    }
    let many = table::read(text.as_bytes()).expect("a table").plot("many");
    assert!(many.svg().len() < 200_000, "{}", many.svg().len());
}
