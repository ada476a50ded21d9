//! Pictures of strength: the force around a plane with the bones in the middle, and the tensions
//! that go with it.

use super::table::Row;
use handc_plot::{PolarCurve, PolarPlot, Sweep, SweepPlot, SweepRow, Unit};

/// Force over direction; `skeleton` is the chain of bones in the plane as seen from the point.
pub(super) fn polar(
    rows: &[Row],
    title: &str,
    axes: [String; 2],
    skeleton: Vec<[f64; 2]>,
    notes: Vec<String>,
) -> PolarPlot {
    PolarPlot {
        title: title.to_string(),
        label: "largest force".to_string(),
        unit: Unit::Prefixed("N"),
        axes,
        curves: vec![PolarCurve {
            name: String::new(),
            angle: rows.iter().filter_map(|row| row.angle).collect(),
            size: rows.iter().map(|row| row.found.force).collect(),
        }],
        skeleton: vec![skeleton],
        notes,
    }
}

/// Tensions over direction.
pub(super) fn tensions(rows: &[Row], title: &str, strands: &[&str], limits: &[f64]) -> SweepPlot {
    let column = |value: &dyn Fn(&Row) -> f64| rows.iter().map(value).collect::<Vec<_>>();
    let curves = |value: &dyn Fn(&Row, usize) -> f64| {
        (0..strands.len()).map(|s| (s, column(&|row| value(row, s)))).collect::<Vec<_>>()
    };
    let mut shown = vec![SweepRow {
        label: "tension".to_string(),
        unit: Unit::Prefixed("N"),
        cells: vec![curves(&|row, s| row.found.tensions[s])],
    }];
    let uneven = limits.windows(2).any(|pair| pair[0] != pair[1]);
    if uneven {
        shown.push(SweepRow {
            label: "part of its limit".to_string(),
            unit: Unit::Plain(String::new()),
            cells: vec![curves(&|row, s| row.found.tensions[s] / limits[s])],
        });
    }
    SweepPlot {
        title: title.to_string(),
        names: strands.iter().map(|name| (*name).to_string()).collect(),
        mark: String::new(),
        columns: vec![Sweep {
            label: "direction of the force".to_string(),
            unit: Unit::Angle,
            values: rows.iter().filter_map(|row| row.angle).collect(),
            mark: None,
        }],
        rows: shown,
    }
}
