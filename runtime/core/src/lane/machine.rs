//! Which vectors the processor has; asked once.

use super::Work;
use std::sync::atomic::{AtomicU8, Ordering};

/// Not asked yet.
const UNKNOWN: u8 = 0;

/// Lanes of the widest vector that may be used: 1, 4 or 8.
static LANES: AtomicU8 = AtomicU8::new(UNKNOWN);

/// Lanes of the widest vector that may be used; 1 where there are none.
#[inline]
pub(crate) fn available() -> usize {
    match LANES.load(Ordering::Relaxed) {
        UNKNOWN => {
            let found = ask();
            LANES.store(found, Ordering::Relaxed);
            usize::from(found)
        }
        known => usize::from(known),
    }
}

/// Uses no more lanes than this from now on, in the whole program. It is for tests, which hold what
/// narrower machines do to what wide ones do; it must not be called while steps are taken.
pub fn use_at_most(lanes: usize) {
    let allowed = match lanes {
        0..4 => 1,
        4..8 => 4,
        _ => 8,
    };
    LANES.store(ask().min(allowed), Ordering::Relaxed);
}

#[cfg(not(target_arch = "x86_64"))]
fn ask() -> u8 {
    1
}

#[cfg(target_arch = "x86_64")]
fn ask() -> u8 {
    if !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")) {
        return 1;
    }
    let wide = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl");
    if wide { 8 } else { 4 }
}

/// Does the work on at least `lanes` lanes, at most [`available`] of them. Without vectors nothing
/// is done, and the caller goes on number by number.
#[cfg(not(target_arch = "x86_64"))]
pub(crate) fn call(_lanes: usize, _work: impl Work) -> bool {
    false
}

/// Does the work on a vector of 4 or 8 lanes, as asked and at most [`available`]. Without vectors
/// nothing is done, and the caller goes on number by number.
#[cfg(target_arch = "x86_64")]
#[inline]
#[allow(unsafe_code)]
pub(crate) fn call(lanes: usize, work: impl Work) -> bool {
    let available = available();
    // SAFETY: what is available has been asked of the processor.
    unsafe {
        match (available, lanes) {
            (8, 8) => super::avx512::with_eight(work),
            (8, _) => super::avx512::with_four(work),
            (4, _) => super::avx2::with_four(work),
            _ => return false,
        }
    }
    true
}
