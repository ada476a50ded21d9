//! What the vector types of all instruction sets share: operators by one instruction each, and the
//! methods of [`Lane`](super::Lane) that are one instruction.

/// The operators of a vector type, each one instruction of the set.
macro_rules! operators {
    ($vector:ident: $($operator:ident $method:ident $instruction:ident;)*) => {
        impl crate::lane::sealed::Sealed for $vector {}
        $(
            impl std::ops::$operator for $vector {
                type Output = $vector;
                #[inline(always)]
                fn $method(self, other: $vector) -> $vector {
                    // SAFETY: values of this type exist only where the instructions do.
                    $vector(unsafe { $instruction(self.0, other.0) })
                }
            }
        )*
    };
}

/// Methods of `Lane` that are one instruction of the set.
macro_rules! methods {
    ($vector:ident, $width:literal:
        $splat:ident $load:ident $store:ident
        $mul_add:ident $mul_sub:ident $neg_mul_add:ident
        $min:ident $max:ident) => {
        const WIDTH: usize = $width;

        #[inline(always)]
        fn splat(x: f64) -> $vector {
            $vector(unsafe { $splat(x) })
        }
        #[inline(always)]
        fn load(from: &[f64]) -> $vector {
            let all = &from[..$width];
            $vector(unsafe { $load(all.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f64]) {
            let all = &mut to[..$width];
            unsafe { $store(all.as_mut_ptr(), self.0) };
        }
        #[inline(always)]
        fn lane(self, index: usize) -> f64 {
            let mut all = [0.0; $width];
            unsafe { $store(all.as_mut_ptr(), self.0) };
            all[index]
        }
        #[inline(always)]
        fn mul_add(self, b: $vector, c: $vector) -> $vector {
            $vector(unsafe { $mul_add(self.0, b.0, c.0) })
        }
        #[inline(always)]
        fn mul_sub(self, b: $vector, c: $vector) -> $vector {
            $vector(unsafe { $mul_sub(self.0, b.0, c.0) })
        }
        #[inline(always)]
        fn neg_mul_add(self, b: $vector, c: $vector) -> $vector {
            $vector(unsafe { $neg_mul_add(self.0, b.0, c.0) })
        }
        #[inline(always)]
        fn min(self, other: $vector) -> $vector {
            $vector(unsafe { $min(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: $vector) -> $vector {
            $vector(unsafe { $max(self.0, other.0) })
        }
    };
}

pub(crate) use {methods, operators};
