//! Reference trajectories through model files: text, checker, lowering, interpreter.
//!
//! Where the files come from and how near a run must come is told in `tests/reference/README.md`.

use handc_core::simulation::{Settings, Simulation};
use handc_core::trajectory::{columns, row};
use handc_tests::load::{interpreter, repository};
use handc_tests::table::{Table, reference};

/// Until which time (s) every column may differ by how much: coordinates in rad or m, momenta in
/// their unit or, where they exceed one unit, relative to their largest value.
type Bound = (f64, f64);

/// Runs a fixture until the last of the bounds and compares every column of a reference file.
fn agrees(fixture: &str, csv: &str, bounds: &[Bound]) {
    let table = Table::read(&reference(csv));
    let model = interpreter(&repository("tests/fixtures").join(fixture));
    let until = bounds.last().expect("a bound").0;
    let settings = Settings { duration: Some(until), ..Settings::default() };
    let mut simulation = Simulation::new(model, &settings).expect("a start");
    let names = columns(&simulation);
    let own: Vec<usize> = table
        .columns
        .iter()
        .map(|wanted| names.iter().position(|n| n == wanted).expect("the column"))
        .collect();
    let largest = |column| table.rows.iter().map(|row| f64::abs(row[column])).fold(1.0, f64::max);
    let scale: Vec<f64> = (0..own.len())
        .map(|c| if table.columns[c].starts_with("p.") { largest(c) } else { 1.0 })
        .collect();
    let mut numbers = Vec::new();
    let mut expected = table.rows.iter();
    let mut next = expected.next();
    let mut compared = 0;
    for step in 0..=simulation.steps {
        if step > 0 {
            simulation.step().unwrap_or_else(|error| panic!("{fixture}: {error}"));
        }
        let t = simulation.state.t;
        let Some(wanted) = next.filter(|wanted| (wanted[0] - t).abs() < 1e-3 * simulation.h) else {
            continue;
        };
        row(&mut simulation, &mut numbers);
        let bound = bounds.iter().find(|b| t < b.0 + 1e-9).expect("a bound for every row").1;
        for (column, value) in wanted.iter().enumerate() {
            let difference = (numbers[own[column]] - value).abs() / scale[column];
            let name = &table.columns[column];
            assert!(difference <= bound, "{fixture} at {t} s: `{name}` is {difference:.1e} off");
        }
        compared += 1;
        next = expected.next();
    }
    let last = next.map_or(f64::INFINITY, |wanted| wanted[0]);
    assert!(compared > 10 && last > until, "{fixture}: only {compared} rows were compared");
}

#[test]
fn double_pendulum() {
    // The reference itself departs from the exact solution of the step equations, computed with 30
    // digits, by 5.9e-10 at 250 steps and 1.3e-9 at 300.
    agrees("double_pendulum.hdl", "double_pendulum.csv", &[(2.5, 1e-9), (3.0, 2e-9)]);
}

#[test]
fn spring_pendulum() {
    agrees("spring_pendulum.hdl", "spring_pendulum.csv", &[(5.0, 1e-9)]);
}

#[test]
fn damped_pendulum() {
    agrees("damped_pendulum.hdl", "damped_pendulum.csv", &[(5.0, 1e-9)]);
}

#[test]
fn fourbar_with_a_rod() {
    agrees("fourbar_distance.hdl", "fourbar_distance.csv", &[(5.0, 1e-9)]);
}

#[test]
fn finger_through_three_motions() {
    agrees("finger.hdl", "finger_track.csv", &[(30.0, 1e-9)]);
}

#[test]
fn hand_at_the_beginning() {
    agrees("hand.hdl", "hand_close_first200.csv", &[(0.2, 1e-10)]);
}

#[test]
fn hand_closes_and_opens() {
    agrees("hand.hdl", "hand_close.csv", &[(1.0, 1e-8), (4.0, 1e-6), (10.0, 1e-5)]);
}

#[test]
fn damped_hand_closes_and_opens() {
    agrees("hand_damped.hdl", "hand_close_damped.csv", &[(10.0, 1e-8)]);
}
