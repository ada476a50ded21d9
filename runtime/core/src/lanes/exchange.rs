//! What goes in and out: states, what the world does, natural lengths that were measured.

use super::Lanes;
use super::vector::Vector;
use crate::lane::Lane;
use crate::predict::Missed;
use crate::step::State;

/// When a run's next step is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Around {
    /// Time at the middle (s).
    pub(crate) t: f64,
    /// Step (s).
    pub(crate) h: f64,
    /// Relative tolerance on momenta.
    pub(crate) tolerance: f64,
}

/// What one run is told in steps to come: lists of one row for each of them, or without any number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Told<'a> {
    /// How many steps.
    pub(crate) steps: usize,
    /// Natural lengths at the middle (m); those of followers are not read.
    pub(crate) rest: &'a [f64],
    /// Inputs at the middle.
    pub(crate) inputs: &'a [f64],
    /// Coordinates at the end, of which kinematic ones are read.
    pub(crate) ends: &'a [f64],
}

impl Around {
    /// Where there is no run.
    pub(crate) const NOTHING: Around = Around { t: 0.0, h: 1.0, tolerance: 0.0 };
}

impl Told<'_> {
    /// Nothing, where there is no run.
    pub(crate) const NOTHING: Told<'static> = Told { steps: 0, rest: &[], inputs: &[], ends: &[] };
}

/// A run as it is taken up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TakenUp<'a> {
    /// Its state.
    pub(crate) state: &'a State,
    /// Natural lengths (m), of which those that are told are not read.
    pub(crate) rest: &'a [f64],
    /// How far guesses of each degree have missed.
    pub(crate) missed: &'a Missed,
    /// The largest sensitivity so far of each equation of static equilibrium.
    pub(crate) stiffest: &'a [f64],
}

impl Lanes {
    /// Takes up runs, which have all taken the same number of steps.
    pub(crate) fn take_up(&mut self, runs: &[TakenUp]) {
        self.known = runs.first().map_or(0, |run| run.state.step);
        for vector in &mut self.vectors {
            vector.take_up(runs);
            for (k, strand) in vector.strands.iter().enumerate() {
                vector.rest[k] = runs[vector.runs[k % vector.width]].rest[*strand];
            }
            vector.forget();
        }
    }

    /// Hands over when the next step is; what the runs are told in it and later follows.
    #[inline]
    pub(crate) fn begin(&mut self, around: &[Around]) {
        self.vectors.iter_mut().for_each(|vector| vector.begin(around));
    }

    /// Hands over what the runs are told. Where nothing changes one row is enough for all steps.
    #[inline]
    pub(crate) fn tell(&mut self, told: &[Told]) {
        self.vectors.iter_mut().for_each(|vector| vector.tell(told));
    }

    /// Writes a run's state after a step; its time and number are left to the caller.
    pub(crate) fn write_state(&self, run: usize, state: &mut State) {
        for vector in &self.vectors {
            vector.write_state(run, state);
        }
    }

    /// Writes what a run's guesses are made of, and how stiff its equations have been.
    pub(crate) fn write_experience(
        &self,
        run: usize,
        state: &mut State,
        missed: &mut Missed,
        stiffest: &mut [f64],
    ) {
        missed.fill(0.0);
        for vector in &self.vectors {
            vector.write_experience(run, state, missed, stiffest);
        }
    }

    /// Whether some follower pulls on no block, so that no lane knows its natural length.
    pub(crate) fn leave_followers(&self) -> bool {
        self.leave_followers
    }

    /// Writes the natural lengths that a run's followers have had in the last step.
    pub(crate) fn write_rest(&self, run: usize, rest: &mut [f64]) {
        for vector in &self.vectors {
            for course in &vector.courses {
                for (row, &followers) in course.followers.iter().enumerate() {
                    for lane in 0..vector.used {
                        if followers >> lane & 1 == 1 && vector.runs[lane] == run {
                            let k = row * vector.width + lane;
                            rest[vector.strands[k]] = vector.rest[k];
                        }
                    }
                }
            }
        }
    }
}

impl Vector {
    fn take_up(&mut self, runs: &[TakenUp]) {
        let width = self.width;
        let unknowns = self.unknowns * width;
        for (k, &c) in self.coordinates.iter().enumerate() {
            let TakenUp { state, stiffest, .. } = runs[self.runs[k % width]];
            self.q[k] = state.q[c];
            if k < unknowns {
                (self.p[k], self.v[k]) = (state.p[c], state.v[c]);
                self.stiffest[k] = stiffest[c];
                for (degree, differences) in state.differences.chunks(state.q.len()).enumerate() {
                    self.differences[degree * unknowns + k] = differences[c];
                }
            }
        }
        for (k, place) in self.missed.iter_mut().enumerate() {
            *place = runs[self.runs[k % width]].missed[k / width];
        }
    }

    #[inline]
    fn begin(&mut self, around: &[Around]) {
        for lane in 0..self.width {
            let around = &around[self.runs[lane]];
            self.t[lane] = around.t;
            if self.h[lane] != around.h {
                (self.h[lane], self.per_h[lane]) = (around.h, 1.0 / around.h);
                self.renewal.forget();
                self.is_tried = false;
            }
            self.tolerance[lane] = around.tolerance;
        }
        self.t_first = self.t;
        self.told.clear();
    }

    fn tell(&mut self, told: &[Told]) {
        let Vector { told: rows, fed_inputs, fed_ends, fed_rest, .. } = self;
        let width = fed_inputs.len() + fed_ends.len() + fed_rest.len();
        let steps = told.iter().map(|told| told.steps).min().unwrap_or(0);
        rows.resize(steps * width, 0.0);
        let inputs = fed_inputs.iter().map(|fed| (fed, told[fed.run].inputs));
        let ends = fed_ends.iter().map(|fed| (fed, told[fed.run].ends));
        let rest = fed_rest.iter().map(|fed| (fed, told[fed.run].rest));
        for (place, (fed, list)) in inputs.chain(ends).chain(rest).enumerate() {
            let stride = list.len() / told[fed.run].steps;
            let mut next = fed.index;
            for row in rows.chunks_exact_mut(width) {
                row[place] = list[next];
                next += stride;
            }
        }
    }

    /// Takes what it has been told for step `k` of a stretch.
    #[inline(always)]
    pub(super) fn listen<L: Lane>(&mut self, k: usize) {
        // All inputs and ends are fed, in the order of the lists.
        let [inputs, ends] = [self.inputs.len(), self.ends.len()];
        let count = inputs + ends + self.fed_rest.len();
        if count == 0 {
            return;
        }
        let Some(row) = self.told.get(k * count..(k + 1) * count) else { return };
        for i in (0..inputs).step_by(L::WIDTH) {
            L::load(&row[i..]).store(&mut self.inputs[i..]);
        }
        for i in (0..ends).step_by(L::WIDTH) {
            L::load(&row[inputs + i..]).store(&mut self.ends[i..]);
        }
        for (fed, &value) in self.fed_rest.iter().zip(&row[inputs + ends..]) {
            self.rest[fed.place] = value;
        }
    }

    fn write_state(&self, run: usize, state: &mut State) {
        let unknowns = &self.coordinates[..self.unknowns * self.width];
        for (row, coordinates) in unknowns.chunks_exact(self.width).enumerate() {
            for (lane, &c) in coordinates.iter().enumerate().take(self.used) {
                if self.runs[lane] == run {
                    let k = row * self.width + lane;
                    (state.q[c], state.p[c], state.v[c]) = (self.q[k], self.p[k], self.v[k]);
                }
            }
        }
    }

    fn write_experience(
        &self,
        run: usize,
        state: &mut State,
        missed: &mut Missed,
        stiffest: &mut [f64],
    ) {
        let width = self.width;
        let unknowns = self.unknowns * width;
        for (k, &c) in self.coordinates[..unknowns].iter().enumerate() {
            if self.runs[k % width] == run && k % width < self.used {
                stiffest[c] = self.stiffest[k];
                let stride = state.q.len();
                for (degree, differences) in state.differences.chunks_mut(stride).enumerate() {
                    differences[c] = self.differences[degree * unknowns + k];
                }
            }
        }
        for (k, place) in self.missed.iter().enumerate() {
            if self.runs[k % width] == run && k % width < self.used {
                missed[k / width] += place;
            }
        }
    }
}
