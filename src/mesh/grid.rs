//! Counting the cells, nodes and neighbours of a structured mesh. The first axis runs fastest.

/// The topology of a structured mesh: cells per direction and which directions are periodic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid<const D: usize> {
    cells: [usize; D],
    periodic: [bool; D],
    strides: [usize; D],
}

impl<const D: usize> Grid<D> {
    /// A grid with this many cells along each axis; `periodic` axes join their two ends.
    pub fn new(cells: [usize; D], periodic: [bool; D]) -> Self {
        Self { cells, periodic, strides: std::array::from_fn(|axis| cells[..axis].iter().product()) }
    }

    /// Cells along each axis.
    pub fn cells(&self) -> [usize; D] {
        self.cells
    }

    /// Which axes join their two ends.
    pub fn periodic(&self) -> [bool; D] {
        self.periodic
    }

    /// Number of cells.
    #[expect(clippy::len_without_is_empty, reason = "a mesh is never empty")]
    pub fn len(&self) -> usize {
        self.cells.iter().product()
    }

    /// Index of the cell at an offset along each axis.
    pub fn index(&self, offset: [usize; D]) -> usize {
        (0..D).rev().fold(0, |index, axis| index * self.cells[axis] + offset[axis])
    }

    /// Offset of a cell along each axis.
    pub fn offset(&self, mut index: usize) -> [usize; D] {
        self.cells.map(|n| {
            let at = index % n;
            index /= n;
            at
        })
    }

    /// Distance in the index between neighbours along an axis.
    pub fn stride(&self, axis: usize) -> usize {
        self.strides[axis]
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.cells.iter().map(|n| n + 1).product()
    }

    /// Index of the node at an offset along each axis.
    pub fn node_index(&self, offset: [usize; D]) -> usize {
        (0..D).rev().fold(0, |index, axis| index * (self.cells[axis] + 1) + offset[axis])
    }

    /// Offset of a node along each axis.
    pub fn node_offset(&self, mut node: usize) -> [usize; D] {
        self.cells.map(|n| {
            let at = node % (n + 1);
            node /= n + 1;
            at
        })
    }

    /// The cell across face `2 axis + side` (`side` 0 lower, 1 upper); none beyond an end that is not periodic.
    pub fn neighbour(&self, index: usize, axis: usize, side: usize) -> Option<usize> {
        let n = self.cells[axis];
        let stride = self.stride(axis);
        let at = index / stride % n;
        match (side, at) {
            (0, 0) => self.periodic[axis].then(|| index + (n - 1) * stride),
            (0, _) => Some(index - stride),
            (_, at) if at + 1 == n => self.periodic[axis].then(|| index - (n - 1) * stride),
            _ => Some(index + stride),
        }
    }

    /// The offset of a cell that lies `step` away from `offset`: wrapped along periodic axes, at the last cell
    /// inside elsewhere (the mirror image of the first layer outside).
    pub fn stepped(&self, offset: [usize; D], step: [isize; D]) -> [usize; D] {
        std::array::from_fn(|axis| self.stepped_along(axis, offset[axis], step[axis]))
    }

    fn stepped_along(&self, axis: usize, at: usize, step: isize) -> usize {
        let n = self.cells[axis] as isize;
        let to = at as isize + step;
        // Divisions are dear, and most cells lie inside.
        if (0..n).contains(&to) {
            to as usize
        } else if self.periodic[axis] {
            to.rem_euclid(n) as usize
        } else {
            to.clamp(0, n - 1) as usize
        }
    }

    /// All cells at most `radius` steps away along every axis, the cell itself among them. Cells that would lie beyond an
    /// end are given as the last cell inside, so that some come more than once.
    pub fn around(&self, index: usize, radius: usize) -> impl Iterator<Item = usize> + '_ {
        let at = self.offset(index);
        let width = 2 * radius + 1;
        let step = move |place: usize| (place % width) as isize - radius as isize;
        (0..width.pow(D as u32 - 1)).flat_map(move |mut place| {
            let mut row = 0;
            for axis in 1..D {
                row += self.stepped_along(axis, at[axis], step(place)) * self.strides[axis];
                place /= width;
            }
            (0..width).map(move |place| row + self.stepped_along(0, at[0], step(place)))
        })
    }

    /// Nodes along each axis that are not images of others at joined ends.
    pub fn unique_nodes(&self) -> [usize; D] {
        std::array::from_fn(|axis| self.cells[axis] + usize::from(!self.periodic[axis]))
    }

    /// The cells around a node, each with the number of its corner that the node is: bit `a` of the number is the corner's offset along
    /// the axis `a`.
    pub fn around_node(&self, node: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let at = self.node_offset(node);
        (0..1 << D).filter_map(move |corner| {
            let mut offset = [0; D];
            for axis in 0..D {
                let n = self.cells[axis];
                offset[axis] = match at[axis].checked_sub(corner >> axis & 1) {
                    Some(place) if place < n => place,
                    _ if !self.periodic[axis] => return None,
                    Some(_) => 0,
                    None => n - 1,
                };
            }
            Some((corner, self.index(offset)))
        })
    }
}
