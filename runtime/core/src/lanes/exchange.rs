//! What goes in and out: states, what the world does, natural lengths that were measured.

use super::Lanes;
use super::vector::Vector;
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

/// What one run is told in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Told<'a> {
    /// Natural lengths at the middle (m); those of followers are not read.
    pub(crate) rest: &'a [f64],
    /// Inputs at the middle.
    pub(crate) inputs: &'a [f64],
    /// Kinematic coordinates at the end.
    pub(crate) driven_q: &'a [f64],
}

impl Around {
    /// Where there is no run.
    pub(crate) const NOTHING: Around = Around { t: 0.0, h: 1.0, tolerance: 0.0 };
}

impl Told<'_> {
    /// Nothing, where there is no run.
    pub(crate) const NOTHING: Told<'static> = Told { rest: &[], inputs: &[], driven_q: &[] };
}

/// A run as it is taken up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TakenUp<'a> {
    /// Its state.
    pub(crate) state: &'a State,
    /// How far guesses of each degree have missed.
    pub(crate) missed: &'a Missed,
    /// The largest sensitivity so far of each equation of static equilibrium.
    pub(crate) stiffest: &'a [f64],
}

impl Lanes {
    /// Takes up runs, which have all taken the same number of steps; with what they are told next.
    pub(crate) fn take_up(&mut self, runs: &[TakenUp], told: &[Told]) {
        self.known = runs.first().map_or(0, |run| run.state.step);
        for vector in &mut self.vectors {
            vector.take_up(runs);
            for (k, strand) in vector.strands.iter().enumerate() {
                vector.rest[k] = told[vector.runs[k % vector.width]].rest[*strand];
            }
            vector.forget();
        }
    }

    /// Hands over when the next step is; what the runs are told in it and later follows.
    #[inline]
    pub(crate) fn begin(&mut self, around: &[Around]) {
        self.vectors.iter_mut().for_each(|vector| vector.begin(around));
    }

    /// Hands over what the runs are told in one more step. Where nothing changes once is enough.
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
        self.told.extend(self.fed_inputs.iter().map(|fed| told[fed.run].inputs[fed.index]));
        self.told.extend(self.fed_ends.iter().map(|fed| told[fed.run].driven_q[fed.index]));
        self.told.extend(self.fed_rest.iter().map(|fed| told[fed.run].rest[fed.index]));
    }

    /// Takes what it has been told for step `k` of a stretch.
    #[inline]
    pub(super) fn listen(&mut self, k: usize) {
        if self.told.is_empty() {
            return;
        }
        // All inputs and ends are fed, in the order of the lists.
        let counts = [self.inputs.len(), self.ends.len(), self.fed_rest.len()];
        let count = counts.iter().sum::<usize>();
        let Some(row) = self.told.get(k * count..(k + 1) * count) else { return };
        let (inputs, row) = row.split_at(counts[0]);
        let (ends, rest) = row.split_at(counts[1]);
        self.inputs.copy_from_slice(inputs);
        self.ends.copy_from_slice(ends);
        for (fed, &value) in self.fed_rest.iter().zip(rest) {
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
