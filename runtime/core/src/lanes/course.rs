//! Motions on lanes: the poses whose strand lengths are the natural lengths of followers.
//!
//! A motion goes from pose to pose, see [`crate::motion`]. Every lane keeps the part it is in as the
//! pose where that begins and the change to where it ends, until a lane comes to another part.

use super::measure::{MeasuredAhead, rows_are_alike};
use super::vector::Vector;
use crate::lane::{Lane, WIDEST};
use crate::motion::Part;

/// Which strands follow which motions, and which keep their natural lengths.
#[derive(Clone, Debug, Default)]
pub(crate) struct Follows {
    /// Motion, and strands by index.
    list: Vec<(usize, Vec<usize>)>,
    /// By strand: whether its natural length stays what it was when the run was taken up.
    stays: Vec<bool>,
}

impl Follows {
    /// The strands in `list` follow motions; those marked in `stays` keep their natural lengths; the
    /// others' are handed over before every step.
    pub(crate) fn new(list: Vec<(usize, Vec<usize>)>, stays: Vec<bool>) -> Self {
        Follows { list, stays }
    }

    /// Whether a strand's natural length is handed over before every step.
    pub(super) fn is_fed(&self, strand: usize) -> bool {
        !self.stays.get(strand).is_some_and(|&stays| stays) && !self.is_follower(strand)
    }

    /// Strands that follow motions.
    pub(super) fn followers(&self) -> impl Iterator<Item = usize> {
        self.list.iter().flat_map(|(_, strands)| strands.iter().copied())
    }

    /// Whether a strand follows a motion.
    pub(super) fn is_follower(&self, strand: usize) -> bool {
        self.followers().any(|follower| follower == strand)
    }

    /// One course for each motion that any of a vector's strands follows.
    pub(super) fn courses(&self, vector: &Vector) -> Vec<Course> {
        let width = vector.width;
        let rows = || vector.strands.chunks_exact(width);
        let all: u8 = (0..width).map(|lane| 1 << lane).sum();
        let has_like_constants = rows_are_alike(&vector.constants, width);
        let of = |(motion, strands): &(usize, Vec<usize>)| {
            let bits = |row: &[usize]| {
                let follows = row.iter().enumerate().filter(|(_, s)| strands.contains(s));
                follows.map(|(lane, _)| 1 << lane).sum()
            };
            let followers: Vec<u8> = rows().map(bits).collect();
            let has_like_lanes =
                has_like_constants && followers.iter().all(|&bits| bits == 0 || bits == all);
            let counts = [vector.coordinates.len(), vector.strands.len()];
            Course::new(*motion, followers, has_like_lanes, counts)
        };
        self.list.iter().map(of).filter(|c| c.followers.iter().any(|&bits| bits != 0)).collect()
    }
}

/// Poses and motions of one run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Courses<'a> {
    /// Poses.
    pub(crate) poses: &'a [Vec<f64>],
    /// Knots of each motion: pose, time (s).
    pub(crate) motions: &'a [Vec<(usize, f64)>],
}

/// Where one motion is in every lane.
#[derive(Clone, Debug)]
pub(super) struct Course {
    motion: usize,
    /// By strand of the shape: lanes that follow, as bits.
    pub(super) followers: Vec<u8>,
    /// Pose at the beginning of the part.
    pub(super) from: Vec<f64>,
    /// Change until its end.
    pub(super) change: Vec<f64>,
    /// When the part begins (s), and 1 over how long it lasts.
    pub(super) begins: [f64; WIDEST],
    pub(super) per_duration: [f64; WIDEST],
    /// Between which times all lanes stay in their parts (s).
    valid: [f64; 2],
    /// Whether any lane moves.
    moves: bool,
    /// Whether the natural lengths belong to the pose, and it rests.
    pub(super) is_measured: bool,
    /// Whether all lanes have the same constants and followers.
    has_like_lanes: bool,
    /// Whether they move, and their part of the motion is the same too: at like times all lanes then
    /// measure the same.
    pub(super) is_alike: bool,
    /// What was measured in this part for steps to come.
    pub(super) ahead: MeasuredAhead,
}

impl Course {
    /// With how many coordinates and strands there are in all lanes.
    fn new(
        motion: usize,
        followers: Vec<u8>,
        has_like_lanes: bool,
        [numbers, strands]: [usize; 2],
    ) -> Self {
        Course {
            motion,
            followers,
            from: vec![0.0; numbers],
            change: vec![0.0; numbers],
            begins: [0.0; WIDEST],
            per_duration: [0.0; WIDEST],
            valid: [f64::INFINITY, f64::NEG_INFINITY],
            moves: false,
            is_measured: false,
            has_like_lanes,
            is_alike: false,
            ahead: MeasuredAhead::new(strands),
        }
    }

    /// Whether the lengths are to be measured in this step.
    #[inline(always)]
    pub(super) fn is_due(&self) -> bool {
        self.moves || !self.is_measured
    }

    /// In which lanes a motion stays at these times in the part it is in, as bits.
    #[inline(always)]
    pub(super) fn holds<L: Lane>(&self, t: L) -> u8 {
        let [begin, end] = self.valid.map(L::splat);
        begin.less_equal(t) & t.less(end)
    }

    /// Forgets where the motion was.
    pub(super) fn forget(&mut self) {
        self.valid = [f64::INFINITY, f64::NEG_INFINITY];
    }

    /// Finds the part of every lane.
    fn turn(&mut self, t: &[f64], runs: &[usize], coordinates: &[usize], courses: &[Courses]) {
        let width = t.len();
        self.valid = [f64::NEG_INFINITY, f64::INFINITY];
        (self.moves, self.is_measured) = (false, false);
        // Those lengths belong to the part that has been left.
        self.ahead.clear();
        for lane in 0..width {
            let Courses { poses, motions } = courses[runs[lane]];
            let Some(part) = Part::at(&motions[self.motion], t[lane]) else { continue };
            let [begin, end] = part.times;
            self.valid = [self.valid[0].max(begin), self.valid[1].min(end)];
            let moves = !part.rests();
            self.moves |= moves;
            self.begins[lane] = if moves { begin } else { 0.0 };
            self.per_duration[lane] = if moves { 1.0 / (end - begin) } else { 0.0 };
            let [from, to] = part.poses.map(|pose| &poses[pose]);
            for k in (lane..self.from.len()).step_by(width) {
                let c = coordinates[k];
                (self.from[k], self.change[k]) = (from[c], to[c] - from[c]);
            }
        }
        let lists: [&[f64]; 4] =
            [&self.from, &self.change, &self.begins[..width], &self.per_duration[..width]];
        let is_alike = |list: &&[f64]| rows_are_alike(list, width);
        self.is_alike = self.moves && self.has_like_lanes && lists.iter().all(is_alike);
    }
}

impl Vector {
    /// Only steps of one stretch share what they measure ahead: what was handed over may differ in the
    /// next.
    #[inline(always)]
    pub(super) fn begin_stretch(&mut self) {
        for course in &mut self.courses {
            course.ahead.clear();
        }
    }

    /// Takes the motions to the times of the lanes.
    #[inline(always)]
    pub(super) fn move_courses<L: Lane>(&mut self, t: L, courses: &[Courses]) {
        for course in &mut self.courses {
            if course.holds(t) != L::ALL {
                course.turn(&self.t[..self.width], &self.runs, &self.coordinates, courses);
            }
        }
    }
}
