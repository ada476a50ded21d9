//! Four lanes in a register of AVX2.

#![allow(unsafe_code)]

use super::vector::{methods, operators};
use super::{Lane, Work};
use std::arch::x86_64::*;

/// Four numbers.
#[derive(Clone, Copy)]
pub(crate) struct X4(__m256d);

/// Does the work on four lanes.
///
/// # Safety
/// The processor must have AVX2 and FMA.
#[target_feature(enable = "avx2,fma")]
pub(super) fn with_four(work: impl Work) {
    work.run::<X4>();
}

operators! {
    X4:
    Add add _mm256_add_pd;
    Sub sub _mm256_sub_pd;
    Mul mul _mm256_mul_pd;
    Div div _mm256_div_pd;
}

impl std::ops::Neg for X4 {
    type Output = X4;
    #[inline(always)]
    fn neg(self) -> X4 {
        // SAFETY: as of the operators.
        X4(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
}

/// Masks of all sets of lanes.
static MASKS: [[u64; 4]; 16] = {
    let mut masks = [[0; 4]; 16];
    let mut bits = 0;
    while bits < 16 {
        let mut lane = 0;
        while lane < 4 {
            if bits >> lane & 1 == 1 {
                masks[bits][lane] = u64::MAX;
            }
            lane += 1;
        }
        bits += 1;
    }
    masks
};

// SAFETY of every block below: values of this type exist only within `with_four`, where the
// processor has the instructions; loads are unaligned and stay within the slice that was checked.
impl Lane for X4 {
    methods! {
        X4, 4:
        _mm256_set1_pd _mm256_loadu_pd _mm256_storeu_pd
        _mm256_fmadd_pd _mm256_fmsub_pd _mm256_fnmadd_pd
        _mm256_min_pd _mm256_max_pd
    }

    #[inline(always)]
    fn from_lanes(of: impl Fn(usize) -> f64) -> X4 {
        X4(unsafe { _mm256_setr_pd(of(0), of(1), of(2), of(3)) })
    }
    #[inline(always)]
    fn sqrt(self) -> X4 {
        X4(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> X4 {
        X4(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn less(self, other: X4) -> u8 {
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)) as u8 }
    }
    #[inline(always)]
    fn less_equal(self, other: X4) -> u8 {
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0)) as u8 }
    }
    #[inline(always)]
    fn equal(self, other: X4) -> u8 {
        unsafe { _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, other.0)) as u8 }
    }
    #[inline(always)]
    fn if_less(left: X4, right: X4, then: X4, otherwise: X4) -> X4 {
        unsafe {
            let mask = _mm256_cmp_pd::<_CMP_LT_OQ>(left.0, right.0);
            X4(_mm256_blendv_pd(otherwise.0, then.0, mask))
        }
    }
    #[inline(always)]
    fn if_less_equal(left: X4, right: X4, then: X4, otherwise: X4) -> X4 {
        unsafe {
            let mask = _mm256_cmp_pd::<_CMP_LE_OQ>(left.0, right.0);
            X4(_mm256_blendv_pd(otherwise.0, then.0, mask))
        }
    }
    #[inline(always)]
    fn with_sign_of(self, other: X4) -> X4 {
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            X4(_mm256_or_pd(_mm256_andnot_pd(sign, self.0), _mm256_and_pd(sign, other.0)))
        }
    }
    #[inline(always)]
    fn choose(bits: u8, then: X4, otherwise: X4) -> X4 {
        let mask = &MASKS[usize::from(bits & 15)];
        unsafe {
            let mask = _mm256_castsi256_pd(_mm256_loadu_si256(mask.as_ptr().cast()));
            X4(_mm256_blendv_pd(otherwise.0, then.0, mask))
        }
    }
    #[inline(always)]
    fn exponent(shifted: X4, x: X4) -> X4 {
        unsafe {
            let power = _mm256_slli_epi64::<52>(_mm256_castpd_si256(shifted.0));
            X4(_mm256_castsi256_pd(_mm256_add_epi64(_mm256_castpd_si256(x.0), power)))
        }
    }
    #[inline(always)]
    fn turn(shifted: X4, sine: X4, cosine: X4) -> (X4, X4) {
        unsafe {
            let quadrant = _mm256_castpd_si256(shifted.0);
            // The lowest bit, as sign, chooses; the second flips the sign.
            let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(quadrant));
            let (a, b) =
                (_mm256_blendv_pd(sine.0, cosine.0, odd), _mm256_blendv_pd(cosine.0, sine.0, odd));
            let second = |q| {
                let second = _mm256_and_si256(q, _mm256_set1_epi64x(2));
                _mm256_castsi256_pd(_mm256_slli_epi64::<62>(second))
            };
            let next = _mm256_add_epi64(quadrant, _mm256_set1_epi64x(1));
            (X4(_mm256_xor_pd(a, second(quadrant))), X4(_mm256_xor_pd(b, second(next))))
        }
    }
}
