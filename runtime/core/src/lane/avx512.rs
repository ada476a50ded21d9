//! Four or eight lanes in a register of AVX-512: twice as many registers as AVX2 has, masks in
//! registers of their own, constants broadcast by the instruction that needs them.

#![allow(unsafe_code)]

use super::vector::{methods, operators};
use super::{Lane, Work, root};
use std::arch::x86_64::*;

/// Four numbers.
#[derive(Clone, Copy)]
pub(crate) struct Z4(__m256d);

/// Eight numbers.
#[derive(Clone, Copy)]
pub(crate) struct Z8(__m512d);

/// Does the work on four lanes.
///
/// # Safety
/// The processor must have AVX-512 F, DQ and VL, AVX2 and FMA.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
pub(super) fn with_four(work: impl Work) {
    work.run::<Z4>();
}

/// Does the work on eight lanes.
///
/// # Safety
/// As of [`with_four`].
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
pub(super) fn with_eight(work: impl Work) {
    work.run::<Z8>();
}

operators! {
    Z4:
    Add add _mm256_add_pd;
    Sub sub _mm256_sub_pd;
    Mul mul _mm256_mul_pd;
    Div div _mm256_div_pd;
}

operators! {
    Z8:
    Add add _mm512_add_pd;
    Sub sub _mm512_sub_pd;
    Mul mul _mm512_mul_pd;
    Div div _mm512_div_pd;
}

/// What differs from AVX2: results of comparisons are bits already.
macro_rules! masked {
    ($vector:ident:
        $splat:ident $xor:ident $or:ident $and_not:ident $and_numbers:ident $abs:ident $compare:ident $blend:ident
        $as_integers:ident $as_numbers:ident $splat_integer:ident
        $test:ident $and:ident $add:ident $shift:ident $estimate:ident $estimate_recip:ident) => {
        #[inline(always)]
        fn exponent(shifted: $vector, x: $vector) -> $vector {
            unsafe {
                let power = $shift::<52>($as_integers(shifted.0));
                $vector($as_numbers($add($as_integers(x.0), power)))
            }
        }
        #[inline(always)]
        fn abs(self) -> $vector {
            unsafe { $vector($abs(self.0)) }
        }
        #[inline(always)]
        fn rough_recip(self) -> $vector {
            let estimate = $vector(unsafe { $estimate_recip(self.0) });
            let off = self.neg_mul_add(estimate, Self::splat(1.0));
            estimate.mul_add(off, estimate)
        }
        #[inline(always)]
        fn sqrt(self) -> $vector {
            self.sqrt_recip().0
        }
        #[inline(always)]
        fn sqrt_recip(self) -> ($vector, $vector) {
            root::refined(self, $vector(unsafe { $estimate(self.0) }))
        }
        #[inline(always)]
        fn less(self, other: $vector) -> u8 {
            unsafe { $compare::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn less_equal(self, other: $vector) -> u8 {
            unsafe { $compare::<_CMP_LE_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn equal(self, other: $vector) -> u8 {
            unsafe { $compare::<_CMP_EQ_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn with_sign_of(self, other: $vector) -> $vector {
            unsafe {
                let sign = $splat(-0.0);
                $vector($or($and_not(sign, self.0), $and_numbers(sign, other.0)))
            }
        }
        #[inline(always)]
        fn choose(bits: u8, then: $vector, otherwise: $vector) -> $vector {
            unsafe { $vector($blend(bits, otherwise.0, then.0)) }
        }
        #[inline(always)]
        fn turn(shifted: $vector, sine: $vector, cosine: $vector) -> ($vector, $vector) {
            unsafe {
                let quadrant = $as_integers(shifted.0);
                // The lowest bit chooses; the second flips the sign.
                let odd = $test(quadrant, $splat_integer(1));
                let (a, b) = ($blend(odd, sine.0, cosine.0), $blend(odd, cosine.0, sine.0));
                let second = |q| {
                    let second = $and(q, $splat_integer(2));
                    $as_numbers($shift::<62>(second))
                };
                let next = $add(quadrant, $splat_integer(1));
                ($vector($xor(a, second(quadrant))), $vector($xor(b, second(next))))
            }
        }
    };
}

macro_rules! negation {
    ($vector:ident $xor:ident $splat:ident) => {
        impl std::ops::Neg for $vector {
            type Output = $vector;
            #[inline(always)]
            fn neg(self) -> $vector {
                // SAFETY: as of the operators.
                $vector(unsafe { $xor(self.0, $splat(-0.0)) })
            }
        }
    };
}

negation!(Z4 _mm256_xor_pd _mm256_set1_pd);
negation!(Z8 _mm512_xor_pd _mm512_set1_pd);

// SAFETY of every block below: values of these types exist only within `with_four` and
// `with_eight`, where the processor has the instructions; loads are unaligned and stay within the
// slice that was checked.
impl Lane for Z4 {
    methods! {
        Z4, 4:
        _mm256_set1_pd _mm256_loadu_pd _mm256_storeu_pd
        _mm256_fmadd_pd _mm256_fmsub_pd _mm256_fnmadd_pd
        _mm256_min_pd _mm256_max_pd
    }
    masked! {
        Z4:
        _mm256_set1_pd _mm256_xor_pd _mm256_or_pd _mm256_andnot_pd _mm256_and_pd absolute_of_four _mm256_cmp_pd_mask _mm256_mask_blend_pd
        _mm256_castpd_si256 _mm256_castsi256_pd _mm256_set1_epi64x
        _mm256_test_epi64_mask _mm256_and_si256 _mm256_add_epi64 _mm256_slli_epi64
        _mm256_rsqrt14_pd _mm256_rcp14_pd
    }

    #[inline(always)]
    fn from_lanes(of: impl Fn(usize) -> f64) -> Z4 {
        Z4(unsafe { _mm256_setr_pd(of(0), of(1), of(2), of(3)) })
    }
}

impl Lane for Z8 {
    methods! {
        Z8, 8:
        _mm512_set1_pd _mm512_loadu_pd _mm512_storeu_pd
        _mm512_fmadd_pd _mm512_fmsub_pd _mm512_fnmadd_pd
        _mm512_min_pd _mm512_max_pd
    }
    masked! {
        Z8:
        _mm512_set1_pd _mm512_xor_pd _mm512_or_pd _mm512_andnot_pd _mm512_and_pd _mm512_abs_pd _mm512_cmp_pd_mask _mm512_mask_blend_pd
        _mm512_castpd_si512 _mm512_castsi512_pd _mm512_set1_epi64
        _mm512_test_epi64_mask _mm512_and_si512 _mm512_add_epi64 _mm512_slli_epi64
        _mm512_rsqrt14_pd _mm512_rcp14_pd
    }

    #[inline(always)]
    fn from_lanes(of: impl Fn(usize) -> f64) -> Z8 {
        Z8(unsafe { _mm512_setr_pd(of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)) })
    }
}

/// There is no instruction's name for it.
#[inline(always)]
unsafe fn absolute_of_four(x: __m256d) -> __m256d {
    // SAFETY: called where AVX is.
    unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), x) }
}
