//! Numbers that depend on parameters, in their ranges: looked at when a run begins, since a range
//! of a constant has been looked at in the text.

use crate::model::Model;

/// What is wrong with the first number out of its range.
pub(crate) fn broken<M: Model>(model: &mut M) -> Option<String> {
    let count = model.layout().requirements.len();
    if count == 0 {
        return None;
    }
    let mut numbers = vec![0.0; count];
    model.required_numbers(&mut numbers);
    let mut requirements = model.layout().requirements.iter().zip(&numbers);
    let (wrong, number) = requirements.find(|(r, x)| !(r.least..=r.most).contains(x))?;
    Some(format!("{}, and is {number} at the start ({})", wrong.text, wrong.source))
}
