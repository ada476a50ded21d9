//! Summaries of ensembles: the median of every column over time within the ranges of half and of nine
//! tenths of the copies.

use crate::table::Table;
use crate::timeplot::{Curve, Quantity, TimePlot};
use crate::unit::Unit;

/// The ranges, widest first.
const RANGES: [[&str; 2]; 2] = [["q05", "q95"], ["q25", "q75"]];

/// Whether a table is a summary.
pub(crate) fn is_summary(table: &Table) -> bool {
    table.names.get(1).is_some_and(|name| name == "instances")
        && table.names.iter().any(|name| name.ends_with(".median"))
}

/// A panel for every column that was summarised.
pub(crate) fn plot(table: Table, title: &str) -> TimePlot {
    let column = |name: &str, what: &str| {
        let at = table.names.iter().position(|n| n.strip_suffix(what) == Some(name))?;
        Some(table.columns[at].clone())
    };
    let names = table.names.iter().filter_map(|name| name.strip_suffix(".median"));
    let quantities = names.filter_map(|name| {
        let median = Curve { name: String::new(), values: column(name, ".median")? };
        let ends = |range: [&str; 2]| {
            let [low, high] = range.map(|end| column(name, &format!(".{end}")));
            Some([low?, high?])
        };
        // Units are not in a table, so numbers are drawn as they stand.
        Some(Quantity {
            bands: RANGES.into_iter().filter_map(ends).collect(),
            ..Quantity::new(name, Unit::Plain(String::new()), vec![median])
        })
    });
    let quantities = quantities.collect();
    let time = table.columns.into_iter().next().unwrap_or_default();
    TimePlot { title: format!("{title}: median, 25 to 75 %, 5 to 95 %"), time, quantities }
}

#[cfg(test)]
mod tests {
    use crate::table::read;

    #[test]
    fn a_summary_is_drawn_as_bands() {
        let text = "t,instances,x.mean,x.median,x.q05,x.q25,x.q75,x.q95,p.x.median\n\
                    0,9,1,2,0,1,3,4,5\n1,9,1,2,0,1,3,4,5\n";
        let plot = read(text.as_bytes()).expect("a table").plot("many");
        assert_eq!(plot.quantities.len(), 1);
        assert_eq!(plot.quantities[0].label, "x");
        assert_eq!(plot.quantities[0].curves[0].values, [2.0, 2.0]);
        assert_eq!(plot.quantities[0].bands[1], [vec![1.0, 1.0], vec![3.0, 3.0]]);
    }
}
