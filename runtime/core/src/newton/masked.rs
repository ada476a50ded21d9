//! What is done in some lanes and not in others.

use crate::lane::Lane;

/// Keeps the force of lanes that are done.
#[inline(always)]
pub(super) fn hold<L: Lane, const N: usize>(bits: u8, force: &[L; N], kept: &mut [L; N]) {
    if bits == L::ALL {
        *kept = *force;
        return;
    }
    for i in 0..N {
        kept[i] = L::choose(bits, force[i], kept[i]);
    }
}

/// Corrects the increment in the lanes whose bits are set. Where all are, nothing waits for the bits,
/// which come late: the processor goes on before it knows them.
#[inline(always)]
pub(super) fn correct<L: Lane, const N: usize, const Q: usize>(
    bits: u8,
    delta: &mut [L; Q],
    by: &[L; N],
) {
    if bits == L::ALL {
        for i in 0..N {
            delta[i] = delta[i] - by[i];
        }
        return;
    }
    for i in 0..N {
        delta[i] = L::choose(bits, delta[i] - by[i], delta[i]);
    }
}
