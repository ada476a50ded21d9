//! Slices as arrays of a known length, so that generated code indexes without checks.

/// The first `N` numbers.
///
/// # Panics
/// If there are fewer: the caller's vectors do not belong to this model.
#[inline(always)]
pub fn sized<const N: usize>(values: &[f64]) -> &[f64; N] {
    match values.first_chunk() {
        Some(array) => array,
        None => too_short(values.len(), N),
    }
}

/// As [`sized`], to write to.
///
/// # Panics
/// As [`sized`].
#[inline(always)]
pub fn sized_mut<const N: usize>(values: &mut [f64]) -> &mut [f64; N] {
    let length = values.len();
    match values.first_chunk_mut() {
        Some(array) => array,
        None => too_short(length, N),
    }
}

#[cold]
fn too_short(length: usize, needed: usize) -> ! {
    panic!("a vector of {length} numbers was given where the model needs {needed}")
}
