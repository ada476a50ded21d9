//! From quantities to panels in rows: small multiples by digit, then what stands alone.

use crate::group::{Group, groups, styles};
use crate::ticks::{Axis, HUGE, extent, padded};
use crate::timeplot::{Curve, Quantity, TimePlot};
use crate::unit::{Scale, Unit};

/// Most panels side by side.
const COLUMNS: usize = 6;
/// Most panels side by side that have axes of their own.
const WIDE: usize = 3;
/// Ticks of a vertical axis.
const TICKS: usize = 7;
/// Most characters of a tick's label.
const LONGEST: usize = 5;
/// Least range of an angle's axis (degrees).
const LEAST_ANGLE: f64 = 0.2;

/// A curve in a panel.
#[derive(Clone, Debug)]
pub(crate) struct Line<'a> {
    pub(crate) label: String,
    pub(crate) style: usize,
    pub(crate) values: &'a [f64],
}

/// One pair of axes.
#[derive(Clone, Debug)]
pub(crate) struct Panel<'a> {
    pub(crate) heading: String,
    /// Label of the vertical axis, with the unit.
    pub(crate) label: String,
    pub(crate) scale: Scale,
    pub(crate) axis: Axis,
    pub(crate) lines: Vec<Line<'a>>,
    /// Ranges about the first line, widest first.
    pub(crate) bands: &'a [[Vec<f64>; 2]],
}

impl Panel<'_> {
    /// Whether its curves need names.
    pub(crate) fn named(&self) -> bool {
        self.lines.iter().any(|line| !line.label.is_empty())
    }
}

/// Panels side by side.
#[derive(Clone, Debug)]
pub(crate) struct Row<'a> {
    /// `None` keeps a place empty.
    pub(crate) panels: Vec<Option<Panel<'a>>>,
    /// Whether all share one vertical axis, which then stands at the left only.
    pub(crate) shared: bool,
    /// Whether headings are shown.
    pub(crate) headed: bool,
    /// Whether the time axis is labelled.
    pub(crate) timed: bool,
}

/// Rows from top to bottom.
#[derive(Clone, Debug)]
pub(crate) struct Sheet<'a> {
    pub(crate) title: &'a str,
    pub(crate) time: &'a [f64],
    pub(crate) time_label: String,
    pub(crate) time_scale: Scale,
    pub(crate) rows: Vec<Row<'a>>,
    /// Whether every row is one panel, so that curves are named beside it.
    pub(crate) single: bool,
}

/// Quantities that share columns.
struct Block<'a> {
    columns: Vec<String>,
    members: Vec<(&'a Quantity, Vec<Group>)>,
}

/// Lays panels out in rows.
pub(crate) fn compose(plot: &TimePlot) -> Sheet<'_> {
    let time = extent(&plot.time).unwrap_or((0.0, 1.0));
    let time_scale = Unit::Prefixed("s").scale(time.0.abs().max(time.1.abs()));
    let mut blocks: Vec<Block> = Vec::new();
    let mut alone: Vec<&Quantity> = Vec::new();
    for quantity in plot.quantities.iter().filter(|q| !q.curves.is_empty()) {
        let names: Vec<&str> = quantity.curves.iter().map(|c| c.name.as_str()).collect();
        let groups = groups(&names);
        if groups.len() < 2 {
            alone.push(quantity);
            continue;
        }
        let related = |b: &&mut Block| groups.iter().any(|g| b.columns.contains(&g.name));
        if let Some(block) = blocks.iter_mut().find(related) {
            for group in &groups {
                if !block.columns.contains(&group.name) {
                    block.columns.push(group.name.clone());
                }
            }
            block.members.push((quantity, groups));
        } else {
            let columns = groups.iter().map(|g| g.name.clone()).collect();
            blocks.push(Block { columns, members: vec![(quantity, groups)] });
        }
    }
    let single = blocks.is_empty();
    let mut rows: Vec<Row> = blocks.iter().flat_map(Block::rows).collect();
    let across = match (single, alone.len()) {
        (true, _) => 1,
        (false, 4) => 2,
        (false, count) => count.clamp(1, WIDE),
    };
    for chunk in alone.chunks(across) {
        let panels = chunk.iter().map(|q| Some(lone_panel(q))).collect();
        rows.push(Row { panels, shared: false, headed: false, timed: false });
    }
    for i in 0..rows.len() {
        let next = rows.get(i + 1);
        rows[i].timed = next.is_none_or(|next| {
            next.headed
                || next.shared != rows[i].shared
                || next.panels.len() != rows[i].panels.len()
        });
    }
    Sheet {
        title: &plot.title,
        time: &plot.time,
        time_label: format!("time ({})", time_scale.unit),
        time_scale,
        rows,
        single,
    }
}

impl<'a> Block<'a> {
    fn rows(&self) -> Vec<Row<'a>> {
        let lines = self.columns.len().div_ceil(COLUMNS);
        let each = self.columns.len().div_ceil(lines.max(1)).max(1);
        let mut rows = Vec::new();
        for columns in self.columns.chunks(each) {
            for (k, (quantity, groups)) in self.members.iter().enumerate() {
                if groups.iter().any(|g| columns.contains(&g.name)) {
                    let headed = k == 0 || rows.is_empty();
                    rows.push(Row { headed, ..shared_row(quantity, groups, columns) });
                }
            }
        }
        rows
    }
}

fn shared_row<'a>(quantity: &'a Quantity, groups: &[Group], columns: &[String]) -> Row<'a> {
    let (scale, axis) = axis(quantity);
    let label = label(quantity, &scale);
    let styles = styles(groups, &mut Vec::new());
    let panel = |column: &String| {
        let at = groups.iter().position(|group| group.name == *column)?;
        let line = |((index, name), style): (&(usize, String), &usize)| Line {
            label: name.clone(),
            style: *style,
            values: &quantity.curves[*index].values,
        };
        Some(Panel {
            heading: column.clone(),
            label: label.clone(),
            scale: scale.clone(),
            axis: axis.clone(),
            lines: groups[at].curves.iter().zip(&styles[at]).map(line).collect(),
            bands: &[],
        })
    };
    let panels = columns.iter().map(panel).collect();
    Row { panels, shared: true, headed: false, timed: false }
}

fn lone_panel<'a>(quantity: &'a Quantity) -> Panel<'a> {
    let (scale, axis) = axis(quantity);
    let line = |(style, curve): (usize, &'a Curve)| Line {
        label: curve.name.clone(),
        style,
        values: &curve.values,
    };
    let lines = quantity.curves.iter().enumerate().map(line);
    Panel {
        heading: String::new(),
        label: label(quantity, &scale),
        axis,
        lines: lines.collect(),
        bands: &quantity.bands,
        scale,
    }
}

fn axis(quantity: &Quantity) -> (Scale, Axis) {
    let curves = quantity.curves.iter().flat_map(|c| &c.values);
    let bands = quantity.bands.iter().flatten().flatten();
    axis_over(extent(curves.chain(bands)), &quantity.unit)
}

/// The scale and the vertical axis for numbers of a range.
pub(crate) fn axis_over(range: Option<(f64, f64)>, unit: &Unit) -> (Scale, Axis) {
    let size = range.map_or(0.0, |(low, high)| low.abs().max(high.abs()));
    let scale = unit.scale(size);
    let scaled = range.map(|(low, high)| (low * scale.factor, high * scale.factor));
    let degrees = Unit::degrees(&scale);
    let (mut low, mut high) = padded(scaled, if degrees { LEAST_ANGLE } else { 0.0 });
    let mut axis = Axis::new(low, high, TICKS, degrees);
    // A small change of a large number needs long labels; a wider range makes them shorter.
    while axis.ticks.iter().any(|(_, label)| label.chars().count() > LONGEST) && low > -HUGE {
        let half = high - 0.5 * (low + high);
        (low, high) = (low - half, high + half);
        axis = Axis::new(low, high, TICKS, degrees);
    }
    (scale, axis)
}

fn label(quantity: &Quantity, scale: &Scale) -> String {
    with_unit(&quantity.label, scale)
}

/// A label with the unit of its scale in brackets.
pub(crate) fn with_unit(label: &str, scale: &Scale) -> String {
    if scale.unit.is_empty() { label.to_string() } else { format!("{label} ({})", scale.unit) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(label: &str, names: &[&str]) -> Quantity {
        let curve = |name: &&str| Curve { name: name.to_string(), values: vec![0.0, 1.0] };
        Quantity::new(label, Unit::Angle, names.iter().map(curve).collect())
    }

    #[test]
    fn groups_share_columns_and_the_rest_stands_below() {
        let fingers = ["i.a", "i.b", "i.c", "i.d", "t.a", "t.b", "t.c", "t.d"];
        let more = ["i.a", "i.b", "i.c", "t.a", "t.b", "t.c", "ball.x"];
        let plot = TimePlot {
            title: "hand".into(),
            time: vec![0.0, 2.0],
            quantities: vec![
                quantity("angle", &fingers),
                quantity("energy", &[""]),
                quantity("tension", &more),
                quantity("record", &["r"]),
            ],
        };
        let sheet = compose(&plot);
        let shape: Vec<_> = sheet
            .rows
            .iter()
            .map(|r| (r.panels.iter().flatten().count(), r.panels.len(), r.headed, r.timed))
            .collect();
        assert_eq!(shape, [(2, 3, true, false), (3, 3, false, true), (2, 2, false, true)]);
        assert!(!sheet.single);
        assert_eq!(sheet.time_label, "time (s)");
    }
}
