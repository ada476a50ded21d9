//! Reading a trajectory: CSV with a header, one row per instant.

use crate::summary;
use crate::timeplot::{Curve, Quantity, TimePlot, by_size, energy};
use crate::unit::Unit;
use std::io::BufRead;

/// Columns of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names, as many as columns.
    pub names: Vec<String>,
    /// Numbers; momenta are left out.
    pub columns: Vec<Vec<f64>>,
    /// How many of the columns are coordinates; they follow the first, which is the time.
    pub coordinates: usize,
}

/// Whether a column is drawn.
fn drawn(name: &str) -> bool {
    !name.starts_with("p.")
}

/// Reads a table. The message of an error names line and column.
pub fn read(mut input: impl BufRead) -> Result<Table, String> {
    let mut line = String::new();
    let mut next = |line: &mut String, number: usize| {
        line.clear();
        input.read_line(line).map_err(|error| match error.kind() {
            std::io::ErrorKind::InvalidData => format!("line {number}: this is not text"),
            _ => error.to_string(),
        })
    };
    if next(&mut line, 1)? == 0 {
        return Err("the file is empty".into());
    }
    let header: Vec<String> =
        line.trim_start_matches('\u{feff}').split(',').map(|n| n.trim().to_string()).collect();
    if header[0] != "t" {
        return Err(format!("line 1: the first column must be `t`, not `{}`", short(&header[0])));
    }
    if let Some((i, name)) = header.iter().enumerate().find(|(i, n)| header[..*i].contains(n)) {
        return Err(format!("line 1: column {} repeats the name `{}`", i + 1, short(name)));
    }
    let kept: Vec<bool> = header.iter().map(|name| drawn(name)).collect();
    let mut columns = vec![Vec::new(); kept.iter().filter(|k| **k).count()];
    let mut number = 1;
    while next(&mut line, number + 1)? > 0 {
        number += 1;
        if line.trim().is_empty() {
            continue;
        }
        row(&line, &header, &kept, &mut columns).map_err(|e| format!("line {number}: {e}"))?;
    }
    if columns[0].is_empty() {
        return Err("there are no rows below the header".into());
    }
    let ends = |name: &&String| **name == "energy" || name.starts_with("lambda.") || !drawn(name);
    let coordinates = header[1..].iter().position(|name| ends(&name)).unwrap_or(header.len() - 1);
    let names = header.into_iter().zip(&kept).filter_map(|(name, kept)| kept.then_some(name));
    Ok(Table { names: names.collect(), columns, coordinates })
}

fn row(
    line: &str,
    header: &[String],
    kept: &[bool],
    columns: &mut [Vec<f64>],
) -> Result<(), String> {
    let cells = line.trim_end_matches(['\n', '\r']);
    let count = cells.split(',').count();
    if count != header.len() {
        return Err(format!("{count} cells where the header has {}", header.len()));
    }
    let kept_cells = cells.split(',').zip(header).zip(kept).filter(|(_, kept)| **kept);
    for (((cell, name), _), column) in kept_cells.zip(columns.iter_mut()) {
        let cell = cell.trim();
        let value = cell
            .parse()
            .map_err(|_| format!("column `{}`: `{}` is not a number", short(name), short(cell)))?;
        column.push(value);
    }
    let times = &columns[0];
    match times[..] {
        [.., t] if !t.is_finite() => Err(format!("column `t`: the time is `{t}`")),
        [.., before, t] if t < before => {
            Err(format!("column `t`: the time goes back from {before} to {t}"))
        }
        _ => Ok(()),
    }
}

/// A text from the file, cut for a message.
fn short(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    short
}

impl Table {
    /// A figure of the table. Units of coordinates and records are not in a table, so their numbers
    /// are drawn as they stand.
    pub fn plot(self, title: &str) -> TimePlot {
        if summary::is_summary(&self) {
            return summary::plot(self, title);
        }
        let mut columns = self.names.into_iter().zip(self.columns);
        let time = columns.next().map(|(_, values)| values).unwrap_or_default();
        let (mut coordinates, mut multipliers, mut records) = (Vec::new(), Vec::new(), Vec::new());
        let mut energies = None;
        for (i, (name, values)) in columns.enumerate() {
            if i < self.coordinates {
                coordinates.push(Curve { name, values });
            } else if let Some(row) = name.strip_prefix("lambda.") {
                multipliers.push(Curve { name: row.to_string(), values });
            } else if name == "energy" && energies.is_none() {
                energies = Some(values);
            } else {
                records.push(Curve { name, values });
            }
        }
        let si = || Unit::Plain("rad or m".into());
        let mut quantities = vec![Quantity::new("coordinate", si(), coordinates)];
        let impulse = Unit::Plain("SI".into());
        quantities.push(Quantity::new("constraint impulse λ", impulse, multipliers));
        quantities.extend(energies.map(energy).unwrap_or_default());
        quantities.extend(by_size("recorded", &Unit::Plain("SI".into()), records));
        TimePlot { title: title.to_string(), time, quantities }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(text: &str) -> String {
        read(text.as_bytes()).expect_err("must be refused")
    }

    #[test]
    fn a_trajectory_is_read() {
        let text = "t,a,b,p.a,lambda.pin.x,energy,reach\n0,1,2,x,4,5,6\r\n\n0.1,NaN,-inf,3,4,5,6\n";
        let table = read(text.as_bytes()).expect("a table");
        assert_eq!(table.names, ["t", "a", "b", "lambda.pin.x", "energy", "reach"]);
        assert_eq!(table.columns[2], [2.0, f64::NEG_INFINITY]);
        let plot = table.plot("x");
        let labels: Vec<_> = plot.quantities.iter().map(|q| q.label.as_str()).collect();
        assert_eq!(labels, ["coordinate", "constraint impulse λ", "energy", "recorded"]);
    }

    #[test]
    fn columns_may_be_missing() {
        let plot = read("t\n0\n".as_bytes()).expect("a table").plot("x");
        assert!(plot.quantities.iter().all(|q| q.curves.is_empty()));
        let plot = read("t,x\n0,1".as_bytes()).expect("a table").plot("x");
        assert_eq!(plot.quantities[0].curves[0].values, [1.0]);
    }

    #[test]
    fn bad_files_are_refused_with_the_line() {
        assert_eq!(message(""), "the file is empty");
        assert_eq!(message("t,a\n"), "there are no rows below the header");
        assert_eq!(message("a,t\n"), "line 1: the first column must be `t`, not `a`");
        assert_eq!(message("t,a,a\n"), "line 1: column 3 repeats the name `a`");
        assert_eq!(message("t,a\n0,1\n1,\n"), "line 3: column `a`: `` is not a number");
        assert_eq!(message("t,a\n0,1\n\n1,x\n"), "line 4: column `a`: `x` is not a number");
        assert_eq!(message("t,a\n0,1,2\n"), "line 2: 3 cells where the header has 2");
        assert_eq!(
            message("t,a\n0,1\n-1,2\n"),
            "line 3: column `t`: the time goes back from 0 to -1"
        );
        assert_eq!(message("t,a\nNaN,1\n"), "line 2: column `t`: the time is `NaN`");
        let message = read(&b"t,a\n\xff\xfe,1\n"[..]).expect_err("must be refused");
        assert_eq!(message, "line 2: this is not text");
    }
}
