//! The same for every element of some vectors, as many at a time as there are lanes.

use super::{Lane, Work, call};

/// What is done at elements `i` to `i + L::WIDTH`.
pub(crate) trait Sweep {
    /// Does it. To be inlined, as [`Work::run`].
    fn at<L: Lane>(&mut self, i: usize);
}

/// Sweeps over `count` elements.
#[inline]
pub(crate) fn sweep(count: usize, sweep: &mut impl Sweep) {
    if !call(4, Whole { count, sweep: &mut *sweep }) {
        for i in 0..count {
            sweep.at::<f64>(i);
        }
    }
}

struct Whole<'a, S> {
    count: usize,
    sweep: &'a mut S,
}

impl<S: Sweep> Work for Whole<'_, S> {
    #[inline(always)]
    fn run<L: Lane>(self) {
        let mut i = 0;
        while i + L::WIDTH <= self.count {
            self.sweep.at::<L>(i);
            i += L::WIDTH;
        }
        for i in i..self.count {
            self.sweep.at::<f64>(i);
        }
    }
}
