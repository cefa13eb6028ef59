//! Block-tridiagonal systems along a chain of points, cyclic or not: three unknowns for each point.

use nalgebra::Matrix3;

/// A number for each stage.
pub(super) type Stages = [f64; 3];
/// Coupling of the stage values of two points.
pub(super) type Block = Matrix3<f64>;

/// Consecutive points of the ring or of its repetition.
#[derive(Clone, Copy, Debug)]
pub(super) struct ChainNodes {
    pub(super) first: isize,
    pub(super) count: usize,
    /// Whether the last is next to the first.
    pub(super) cyclic: bool,
}

impl ChainNodes {
    /// Point of the cell at an index.
    pub(super) fn point(&self, index: usize, points: usize) -> usize {
        (self.first + index as isize).rem_euclid(points as isize) as usize
    }
}

/// Factors of a block-tridiagonal matrix, cyclic or not. The last point is eliminated last; in a
/// cyclic matrix it is next to the first, which fills its row and column. The matrices are close to
/// block-diagonal ones with dominant blocks (the coupling has the factor h²a/Δφ² < 1), so that
/// pivoting within blocks is enough.
#[derive(Clone, Debug)]
pub(super) struct BlockFactors {
    cyclic: bool,
    inverse: Vec<Block>,
    /// Coupling to the next point, above the diagonal.
    upper: Vec<Block>,
    /// Multiplier of the row before.
    lower: Vec<Block>,
    /// Coupling to the last point, in cyclic matrices.
    column: Vec<Block>,
    /// Multipliers for the row of the last point, in cyclic matrices.
    row: Vec<Block>,
}

impl BlockFactors {
    pub(super) fn new(
        nodes: ChainNodes,
        own: impl Fn(usize) -> Block,
        ahead: impl Fn(usize) -> Block,
        behind: impl Fn(usize) -> Block,
    ) -> Option<BlockFactors> {
        let ChainNodes { count, cyclic, .. } = nodes;
        let last = count - 1;
        let zero = Block::zeros();
        let mut factors = BlockFactors {
            cyclic,
            inverse: Vec::with_capacity(count),
            upper: Vec::with_capacity(count),
            lower: Vec::with_capacity(count),
            column: Vec::with_capacity(count),
            row: Vec::with_capacity(count),
        };
        let mut diagonal = own(0);
        let mut corner = own(last);
        let (mut column, mut row) = if cyclic {
            (behind(0), ahead(last))
        } else {
            (zero, zero)
        };
        for index in 0..last {
            let inverse = diagonal.try_inverse()?;
            let mut upper = ahead(index);
            if index + 1 == last {
                // the last point is the next point
                column += upper;
                row += behind(last);
                upper = zero;
            }
            let multiplier = row * inverse;
            corner -= multiplier * column;
            factors.row.push(multiplier);
            factors.column.push(column);
            factors.upper.push(upper);
            factors.inverse.push(inverse);
            if index + 1 < last {
                let lower = behind(index + 1) * inverse;
                diagonal = own(index + 1) - lower * upper;
                if cyclic {
                    row = -multiplier * upper;
                    column = -lower * column;
                }
                factors.lower.push(lower);
            }
        }
        factors.inverse.push(corner.try_inverse()?);
        Some(factors)
    }

    /// Solves in place for several right-hand sides, which lie side by side in rows: three rows for
    /// each point.
    pub(super) fn solve(&self, x: &mut [f64], columns: usize) {
        let last = self.inverse.len() - 1;
        let width = 3 * columns;
        // in a matrix that is not cyclic only the neighbour touches the row of the last point
        let coupled = |index: usize| self.cyclic || index + 1 == last;
        for index in 0..last {
            let (left, right) = x.split_at_mut(width * (index + 1));
            let here = &left[width * index..];
            if index + 1 < last {
                subtract(&self.lower[index], here, &mut right[..width], columns);
            }
            if coupled(index) {
                let end = right.len() - width;
                subtract(&self.row[index], here, &mut right[end..], columns);
            }
        }
        multiply(&self.inverse[last], &mut x[width * last..], columns);
        for index in (0..last).rev() {
            let (left, right) = x.split_at_mut(width * (index + 1));
            let here = &mut left[width * index..];
            if index + 1 < last {
                subtract(&self.upper[index], &right[..width], here, columns);
            }
            if coupled(index) {
                let end = right.len() - width;
                subtract(&self.column[index], &right[end..], here, columns);
            }
            multiply(&self.inverse[index], here, columns);
        }
    }
}

/// The three rows of a point.
pub(super) fn rows(x: &[f64], columns: usize) -> [&[f64]; 3] {
    [
        &x[..columns],
        &x[columns..2 * columns],
        &x[2 * columns..3 * columns],
    ]
}

/// to −= block·from.
fn subtract(block: &Block, from: &[f64], to: &mut [f64], columns: usize) {
    let [one, two, three] = rows(from, columns);
    for (row, to) in to.chunks_exact_mut(columns).enumerate() {
        let factors = [block[(row, 0)], block[(row, 1)], block[(row, 2)]];
        for (to, ((x, y), z)) in to.iter_mut().zip(one.iter().zip(two).zip(three)) {
            *to -= factors[0] * x + factors[1] * y + factors[2] * z;
        }
    }
}

/// x ← block·x.
fn multiply(block: &Block, x: &mut [f64], columns: usize) {
    let (one, rest) = x.split_at_mut(columns);
    let (two, three) = rest.split_at_mut(columns);
    for ((x, y), z) in one.iter_mut().zip(two).zip(three) {
        let product = block * nalgebra::Vector3::new(*x, *y, *z);
        (*x, *y, *z) = (product[0], product[1], product[2]);
    }
}
