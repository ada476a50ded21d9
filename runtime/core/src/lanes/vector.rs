//! The numbers of one vector of lanes.

use super::course::Course;
use crate::lane::WIDEST;
use crate::predict::DEGREES;
use crate::step::Renewal;

/// Corrections that cost as much as a new inverse. Evaluating the matrix takes about as long as two of
/// them, inverting it another; and an old inverse learns from its corrections.
const PRICE: f64 = 4.0;

/// Pairs of a run and a block of one shape, each in a lane, with everything that their steps read and
/// write. Every list holds its first number in all lanes, then its second, and so on.
#[derive(Clone, Debug)]
pub(crate) struct Vector {
    /// Which of the model's shapes.
    pub(super) shape: usize,
    /// Lanes.
    pub(super) width: usize,
    /// Lanes in use; those left over repeat the last of them.
    pub(super) used: usize,
    /// Run of each lane.
    pub(super) runs: [usize; WIDEST],
    /// Unknowns of a block.
    pub(super) unknowns: usize,
    /// Where coordinates and strands stand in the model's vectors; of the coordinates the unknowns
    /// come first and kinematic ones after them.
    pub(super) coordinates: Vec<usize>,
    pub(super) strands: Vec<usize>,
    /// What is handed over for every step: natural lengths, inputs, ends of kinematic coordinates.
    pub(super) fed_rest: Vec<Fed>,
    pub(super) fed_inputs: Vec<Fed>,
    pub(super) fed_ends: Vec<Fed>,
    /// Those numbers, in this order, for each of the steps to come; one row where they stay.
    pub(super) told: Vec<f64>,

    /// Constants of the shape.
    pub(super) constants: Vec<f64>,
    /// Least sizes of the unknowns for tolerances (1 rad or the model's length).
    pub(super) size: Vec<f64>,
    /// 1 over them.
    pub(super) per_size: Vec<f64>,
    /// Part of the increment by which a step moves each unknown: half of it where it is in static
    /// equilibrium or internal, which is at the middle of the step.
    pub(super) share: Vec<f64>,
    /// Factor of the increment in the rate.
    pub(super) rate: Vec<f64>,
    /// 1 where an unknown is in static equilibrium, else 0; and whether any is.
    pub(super) balances: Vec<f64>,
    pub(super) has_balances: bool,

    /// Coordinates.
    pub(super) q: Vec<f64>,
    /// Momenta.
    pub(super) p: Vec<f64>,
    /// Rates of the step just ended.
    pub(super) v: Vec<f64>,
    /// What past steps add to the rates of internal coordinates; zero for others.
    pub(super) past: Vec<f64>,
    /// The largest sensitivity of each equation of static equilibrium so far; zero for others.
    pub(super) stiffest: Vec<f64>,
    /// Kinematic coordinates at the end of the step.
    pub(super) ends: Vec<f64>,
    /// Last increment and its backward differences, degree after degree.
    pub(super) differences: Vec<f64>,
    /// How far a guess of each degree has lately missed.
    pub(super) missed: Vec<f64>,

    /// What the last step's guess was if it knew vibrations, by which differences it was led, and the
    /// matrix that it has learned, by rows; how far it has lately missed; whether there was one.
    pub(super) foretold: Vec<f64>,
    pub(super) lead: Vec<f64>,
    pub(super) echo: Vec<f64>,
    pub(super) missed_echo: [f64; WIDEST],
    pub(super) is_foretold: bool,
    /// Whether anything has been learned, and whether the last step was as foretold.
    pub(super) has_learned: bool,
    pub(super) is_calm: bool,
    /// In which lanes, as bits, the guess of each degree is best, and that which knows vibrations.
    pub(super) choice: Option<([u8; DEGREES], u8)>,

    /// The inverse of the Newton matrix that is kept from step to step and the mass matrix, by rows;
    /// what rounding of the coordinates does to each equation; and when they are made anew.
    pub(super) inverse: Vec<f64>,
    pub(super) mass: Vec<f64>,
    pub(super) sensitivity: Vec<f64>,
    pub(super) renewal: Renewal,
    /// The longest correction to be trusted, in units of the coordinates' sizes, and whether anything
    /// is known of it; where the matrix is made in every step.
    pub(super) trusted: [f64; WIDEST],
    pub(super) is_tried: bool,

    /// Increments of the step at hand.
    pub(super) delta: Vec<f64>,
    /// Forces at its middle.
    pub(super) force: Vec<f64>,

    /// Natural lengths at the middle of the step (m).
    pub(super) rest: Vec<f64>,
    /// Inputs at the middle of the step.
    pub(super) inputs: Vec<f64>,
    /// Time at the middle of the step (s), and of the first in a stretch.
    pub(super) t: [f64; WIDEST],
    pub(super) t_first: [f64; WIDEST],
    /// Step (s), and 1 over it.
    pub(super) h: [f64; WIDEST],
    pub(super) per_h: [f64; WIDEST],
    /// Relative tolerance on momenta.
    pub(super) tolerance: [f64; WIDEST],
    /// Motions that natural lengths follow.
    pub(super) courses: Vec<Course>,

    /// The state as it was saved.
    saved: Vec<f64>,

    /// Lanes that could not take the step at hand, as bits.
    pub(super) failed: u8,
    /// Newton iterations of the step at hand.
    pub(super) iterations: usize,
}

/// A number that is handed over before every step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fed {
    /// Its place in the vector's list.
    pub(super) place: usize,
    /// The run it comes from, and its place in the model's vector.
    pub(super) run: usize,
    pub(super) index: usize,
}

/// How many numbers a vector has.
pub(super) struct Counts {
    pub(super) unknowns: usize,
    pub(super) coordinates: usize,
    pub(super) strands: usize,
    pub(super) inputs: usize,
}

impl Vector {
    /// Without numbers yet.
    pub(super) fn new(shape: usize, [width, used]: [usize; 2], counts: &Counts) -> Self {
        let room = |count: usize| vec![0.0; count * width];
        Vector {
            shape,
            width,
            used,
            runs: [0; WIDEST],
            unknowns: counts.unknowns,
            coordinates: Vec::with_capacity(counts.coordinates * width),
            strands: Vec::with_capacity(counts.strands * width),
            fed_rest: Vec::new(),
            fed_inputs: Vec::with_capacity(counts.inputs * width),
            fed_ends: Vec::with_capacity((counts.coordinates - counts.unknowns) * width),
            told: Vec::new(),
            constants: Vec::new(),
            size: Vec::with_capacity(counts.unknowns * width),
            per_size: Vec::with_capacity(counts.unknowns * width),
            share: Vec::with_capacity(counts.unknowns * width),
            rate: Vec::with_capacity(counts.unknowns * width),
            balances: Vec::with_capacity(counts.unknowns * width),
            has_balances: false,
            q: room(counts.coordinates),
            p: room(counts.unknowns),
            v: room(counts.unknowns),
            foretold: room(counts.unknowns),
            lead: room(counts.unknowns),
            echo: room(counts.unknowns * counts.unknowns),
            missed_echo: [0.0; WIDEST],
            is_foretold: false,
            has_learned: false,
            is_calm: false,
            choice: None,
            inverse: room(counts.unknowns * counts.unknowns),
            mass: room(counts.unknowns * counts.unknowns),
            sensitivity: room(counts.unknowns),
            renewal: Renewal::new(PRICE),
            trusted: [0.0; WIDEST],
            is_tried: false,
            past: room(counts.unknowns),
            stiffest: room(counts.unknowns),
            delta: room(counts.unknowns),
            force: room(counts.unknowns),
            ends: room(counts.coordinates - counts.unknowns),
            differences: room(DEGREES * counts.unknowns),
            missed: room(DEGREES),
            rest: room(counts.strands),
            inputs: room(counts.inputs),
            t: [0.0; WIDEST],
            t_first: [0.0; WIDEST],
            h: [1.0; WIDEST],
            per_h: [1.0; WIDEST],
            tolerance: [0.0; WIDEST],
            courses: Vec::new(),
            saved: Vec::new(),
            failed: 0,
            iterations: 0,
        }
    }
    /// Saves the state.
    pub(super) fn save(&mut self) {
        let mut saved = std::mem::take(&mut self.saved);
        saved.clear();
        self.state().into_iter().for_each(|list| saved.extend_from_slice(list));
        self.saved = saved;
    }

    /// Goes back to the saved state; what speeds steps up is forgotten.
    pub(super) fn restore(&mut self) {
        let saved = std::mem::take(&mut self.saved);
        let mut left = &saved[..];
        for list in self.state() {
            let (own, rest) = left.split_at(list.len());
            list.copy_from_slice(own);
            left = rest;
        }
        self.saved = saved;
        self.t = self.t_first;
        self.forget();
    }

    /// Forgets what speeds steps up, and where motions were.
    pub(super) fn forget(&mut self) {
        (self.is_foretold, self.has_learned, self.is_calm) = (false, false, false);
        self.choice = None;
        self.echo.fill(0.0);
        self.missed_echo.fill(0.0);
        self.renewal.forget();
        self.is_tried = false;
        self.courses.iter_mut().for_each(Course::forget);
    }

    fn state(&mut self) -> [&mut Vec<f64>; 6] {
        let Vector { q, p, v, differences, missed, stiffest, .. } = self;
        [q, p, v, differences, missed, stiffest]
    }
}
