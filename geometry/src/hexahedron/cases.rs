//! Which parts of the faces lie below a plane, by which nodes do: the only place where nodes, edges and faces are looked up.

use crate::cell::Cell;

use super::Hexahedron;

/// A corner of a face: its node and those that follow in outward order, and the edges between them.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) near: u8,
    pub(super) next: u8,
    pub(super) far: u8,
    pub(super) last: u8,
    /// Edges from `near` to `next`, from `near` to `last` and from `next` to `far`.
    pub(super) to_next: u8,
    pub(super) to_last: u8,
    pub(super) across: u8,
}

/// The corners of all faces: `4 face + corner`. The entries from 24 on are there for the index to have five bits.
pub(super) static CORNERS: [Corner; 32] = {
    let none = Corner { near: 0, next: 0, far: 0, last: 0, to_next: 15, to_last: 15, across: 15 };
    let mut corners = [none; 32];
    let mut index = 0;
    while index < 24 {
        let face = Hexahedron::FACE_NODES[index / 4];
        let [near, next, far, last] =
            [face[index % 4], face[(index + 1) % 4], face[(index + 2) % 4], face[(index + 3) % 4]];
        corners[index] = Corner {
            near: near as u8,
            next: next as u8,
            far: far as u8,
            last: last as u8,
            to_next: edge(near, next),
            to_last: edge(near, last),
            across: edge(next, far),
        };
        index += 1;
    }
    corners
};

/// The edge between two nodes.
const fn edge(a: usize, b: usize) -> u8 {
    let mut edge = 0;
    while edge < 12 {
        let [from, to] = Hexahedron::EDGES[edge];
        if (from == a && to == b) || (from == b && to == a) {
            return edge as u8;
        }
        edge += 1;
    }
    panic!("a face has no such edge")
}

/// The place of a part of a face: the index of the corner that it is counted from, and what it is.
#[derive(Clone, Copy)]
pub(super) struct Place(u8);

impl Place {
    /// The rest of the face without a corner.
    const REST: u8 = 32;
    /// A strip along the edge from its corner to the next.
    const STRIP: u8 = 64;
    /// Nothing.
    const NONE: u8 = 31;

    pub(super) fn corner(self) -> usize {
        usize::from(self.0 & 31)
    }

    /// 1 for the part itself, -1 for the rest of its face.
    pub(super) fn sign(self) -> f64 {
        [1.0, -1.0][usize::from((self.0 / Self::REST) & 1)]
    }

    /// `[1, 0]` for a corner, `[0, 1]` for a strip.
    pub(super) fn kind(self) -> [f64; 2] {
        [[1.0, 0.0], [0.0, 1.0]][usize::from((self.0 / Self::STRIP) & 1)]
    }
}

/// The parts of the faces below a plane.
#[derive(Clone, Copy)]
pub(super) struct Case {
    /// One for each face that is cut, except the saddles.
    pub(super) parts: [Place; 6],
    /// Faces that are wholly below, or whose parts above are corners: a bit each.
    pub(super) whole: u8,
    /// Faces of which two opposite nodes are below, a bit each: which case they are depends on the heights.
    pub(super) saddles: u8,
}

/// The two corners of a face with opposite nodes below, and the sign of what they add: they meet across the saddle, and the
/// other two are missing, or they do not.
pub(super) fn saddle(face: usize, mask: usize, heights: &[f64; 8]) -> ([Place; 2], bool) {
    let s = |i: usize| heights[Hexahedron::FACE_NODES[face][i]];
    let first = (mask >> Hexahedron::FACE_NODES[face][0] & 1) ^ 1;
    let joined = s(first) * s(first + 2) > s(first + 1) * s((first + 3) & 3);
    let corner = |i: usize| (4 * face + i) as u8;
    if joined {
        let other = 1 - first;
        ([corner(other) | Place::REST, corner(other + 2) | Place::REST].map(Place), true)
    } else {
        ([corner(first), corner(first + 2)].map(Place), false)
    }
}

/// The parts by the bits of the nodes that are below.
pub(super) static CASES: [Case; 256] = {
    let mut cases = [Case { parts: [Place(Place::NONE); 6], whole: 0, saddles: 0 }; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut count = 0;
        let mut face = 0;
        while face < 6 {
            let nodes = Hexahedron::FACE_NODES[face];
            let mut below = 0_usize;
            let mut i = 0;
            while i < 4 {
                below |= (mask >> nodes[i] & 1) << i;
                i += 1;
            }
            let first = 4 * face as u8;
            let part = match below {
                0b0000 | 0b1111 | 0b0101 | 0b1010 => Place::NONE,
                0b0001 | 0b0010 | 0b0100 | 0b1000 => first + below.trailing_zeros() as u8,
                0b1110 | 0b1101 | 0b1011 | 0b0111 => (first + (!below).trailing_zeros() as u8) | Place::REST,
                0b1001 => (first + 3) | Place::STRIP,
                _ => (first + below.trailing_zeros() as u8) | Place::STRIP,
            };
            if part != Place::NONE {
                cases[mask].parts[count] = Place(part);
                count += 1;
            }
            match below {
                0b1111 | 0b1110 | 0b1101 | 0b1011 | 0b0111 => cases[mask].whole |= 1 << face,
                0b0101 | 0b1010 => cases[mask].saddles |= 1 << face,
                _ => {}
            }
            face += 1;
        }
        mask += 1;
    }
    cases
};
