//! Parts of blocks: coordinates that the Newton matrix couples without the help of constraints.
//! Equations are staged part by part; a block without constraints is one part.

use handc_core::layout::Block;
use handc_runtime::structure::Structure;

/// A part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part<'a> {
    /// Its coordinates by index.
    pub coordinates: &'a [usize],
    /// Where its first matrix entry stands in packed storage.
    pub matrix: usize,
    /// How far its rows of the matrix are apart.
    pub width: usize,
    /// Whether it is a block of its own, without constraints.
    pub is_block: bool,
}

impl Part<'_> {
    /// Where its matrix entries stand in packed storage, row by row.
    pub fn slots(&self) -> impl Iterator<Item = usize> {
        let (count, matrix, width) = (self.coordinates.len(), self.matrix, self.width);
        (0..count).flat_map(move |i| (0..count).map(move |j| matrix + i * width + j))
    }

    /// Row and column in the part of an entry in packed storage.
    pub fn entry(&self, slot: usize) -> (usize, usize) {
        ((slot - self.matrix) / self.width, (slot - self.matrix) % self.width)
    }
}

/// All parts in order.
pub fn parts<'a>(blocks: &'a [Block]) -> Vec<Part<'a>> {
    let of_block = |block: &'a Block| {
        let width = block.coordinates.len();
        block.part_ranges().map(move |range| Part {
            matrix: block.matrix_offset + range.start * (width + 1),
            coordinates: &block.coordinates[range],
            width,
            is_block: block.rows.is_empty(),
        })
    };
    blocks.iter().flat_map(of_block).collect()
}

/// The part whose equations give the length of each strand: the first that it touches; `None` where
/// all of its coordinates are kinematic.
pub(super) fn parts_of_strands(structure: &Structure) -> Vec<Option<usize>> {
    let mut part_of = vec![None; structure.count];
    for (number, part) in parts(&structure.blocks).iter().enumerate() {
        part.coordinates.iter().for_each(|&c| part_of[c] = Some(number));
    }
    let of = |coordinates: &[usize]| coordinates.iter().find_map(|&c| part_of[c]);
    structure.strands.iter().map(|path| of(&path.coordinates)).collect()
}
