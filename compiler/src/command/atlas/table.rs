//! The table of an atlas: a row for every strand at every value, in SI units.

use super::sweep::Sweep;
use handc_core::trajectory::push_number;
use handc_runtime::mechanism::Mechanism;

/// `joint,value,strand,length,moment_arm,tension`, sweep after sweep.
pub(super) fn lines(mechanism: &Mechanism, sweeps: &[Sweep]) -> String {
    let mut text = String::from("joint,value,strand,length,moment_arm,tension\n");
    for sweep in sweeps {
        let joint = &mechanism.coordinates[sweep.coordinates[0]].name;
        for &strand in &sweep.strands {
            for (values, instant) in &sweep.instants {
                let Some(instant) = instant else { continue };
                text.push_str(joint);
                number(&mut text, values[0]);
                text.push(',');
                text.push_str(&mechanism.strands[strand].name);
                number(&mut text, instant.lengths[strand]);
                number(&mut text, instant.arms[0][strand]);
                number(&mut text, instant.tensions[strand]);
                text.push('\n');
            }
        }
    }
    text
}

/// `J1,J2,strand,length,moment_arm.J1,moment_arm.J2,tension`.
pub(super) fn grid(mechanism: &Mechanism, sweep: &Sweep) -> String {
    let names = sweep.coordinates.iter().map(|&c| mechanism.coordinates[c].name.as_str());
    let [a, b] = [0, 1].map(|k| names.clone().nth(k).unwrap_or_default());
    let mut text = format!("{a},{b},strand,length,moment_arm.{a},moment_arm.{b},tension\n");
    for &strand in &sweep.strands {
        for (values, instant) in &sweep.instants {
            let Some(instant) = instant else { continue };
            push_number(&mut text, values[0]);
            number(&mut text, values[1]);
            text.push(',');
            text.push_str(&mechanism.strands[strand].name);
            number(&mut text, instant.lengths[strand]);
            instant.arms.iter().for_each(|arms| number(&mut text, arms[strand]));
            number(&mut text, instant.tensions[strand]);
            text.push('\n');
        }
    }
    text
}

/// A comma and a number with 17 significant digits.
fn number(text: &mut String, value: f64) {
    text.push(',');
    push_number(text, value);
}
