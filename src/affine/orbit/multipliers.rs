//! Floquet multipliers: the product of the flows of the zones and of the jumps between them.
//!
//! A perturbation reaches a guard earlier or later; compared at equal time it jumps by S = Rₓ + (f⁺ − Rż⁻)gᵀ/ġ.
//! Where no jump is singular the product of the inverses is formed, too: of multipliers of very different size
//! the large ones are exact in the one product, the small ones in the other.

use nalgebra::Complex;

use super::layout::{AffineOrbit, OrbitAt, OrbitFailure};
use super::passage::Passage;
use super::structure::exit_of;
use crate::linalg::{Factors, Matrix, Vector};
use crate::orbit::events::AT_ZERO;

/// A Floquet multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Multiplier {
    /// Its value.
    pub value: Complex<f64>,
    /// Whether it is what it is for every orbit of its kind: 1 for the shift in time of an orbit without forcing,
    /// 0 for a dimension that a sliding mode or a reset takes away.
    pub trivial: bool,
    /// What rounding may have left in it: the long products of an orbit that stays near a saddle have entries so
    /// large that multipliers of order one are lost in them.
    pub error: f64,
}

/// A multiplier this close to the unit circle is on it but for rounding: the events where one crosses are located to
/// about this.
const ON_CIRCLE: f64 = 1e-9;

/// A multiplier larger than this is infinite but for rounding: at a graze, where the speed of an impact is zero.
const INFINITE: f64 = 1e12;

impl Multiplier {
    /// Whether it is finite.
    pub fn is_finite(&self) -> bool {
        self.value.norm() < INFINITE
    }

    /// Whether the orbit grows along it.
    pub fn is_outside(&self) -> bool {
        !self.trivial && self.value.norm() > 1.0 + ON_CIRCLE.max(self.error)
    }

    /// Whether it may not be told from one on the unit circle.
    pub fn is_on_circle(&self) -> bool {
        !self.trivial && (self.value.norm() - 1.0).abs() <= ON_CIRCLE.max(self.error)
    }
}

/// From just after one switch to just after the next, in the states.
struct Link {
    /// Along the zone.
    flow: Matrix,
    /// Through the switch.
    jump: Matrix,
    /// The inverse, where there is one.
    backward: Option<Matrix>,
    /// How fast the guard falls, scaled to order one.
    fall: f64,
    /// ẋ just after the switch.
    after: Vector,
}

/// The linearised motion over a period, without what is trivial.
#[derive(Clone, Debug)]
pub struct Monodromy {
    /// In coordinates of the perturbations that are left.
    pub matrix: Matrix,
    inverse: Option<Matrix>,
    /// Sizes of the two products before the shift was divided out: their rounding is relative to these.
    sizes: [f64; 2],
    /// How fast every guard falls at the end of its zone, scaled to order one.
    falls: Vec<f64>,
    /// Dimensions that are taken away.
    zeros: usize,
    /// Whether the shift in time has been divided out.
    shifts: bool,
}

/// Rounding of a multiplier relative to the product it comes from: that of some dozens of factors.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Rates on both sides of a switch are the same to this part of the terms of one of them: those of states that are known
/// to a few roundings.
const CONTINUOUS: f64 = 16.0 * f64::EPSILON;

/// A jump is singular where its determinant is this part of the numbers it is made of.
const SINGULAR: f64 = 1e-10;

impl OrbitAt<'_> {
    fn link(&self, zone: usize, passage: &Passage) -> Link {
        let n = self.orbit.states();
        let flow = passage.forward();
        let exit = exit_of(&self.posed.system, &self.orbit.sequence, zone);
        let (Some(exit), Some(way)) = (exit, self.orbit.sequence.zone(zone).way) else {
            return Link {
                flow,
                jump: Matrix::identity(n, n),
                backward: Some(passage.backward()),
                fall: 1.0,
                after: passage.rate.rows(0, n).into_owned(),
            };
        };
        let row = &self.mode(zone).guards[way.guard].row;
        let rate = &passage.rate;
        let fall = row.at.dot(rate);
        let next = zone + 1;
        // what the reset makes of the state: at a graze the entry of the next zone has lost the speed in rounding
        let mut entry = passage.end.clone();
        entry
            .rows_mut(0, n)
            .copy_from(&(&exit.reset.at * &passage.end));
        self.mode(next).field.complete(&mut entry);
        let matrix = &self.mode(next).matrix.at;
        let after = (matrix * &entry).rows(0, n).into_owned();
        let mut shift = &after - &exit.reset.at * rate;
        // fields that meet without a jump differ by rounding, which a graze would magnify without bound
        let sizes = (matrix.abs() * entry.abs()).rows(0, n).into_owned();
        for (shift, size) in shift.iter_mut().zip(&sizes) {
            if shift.abs() <= CONTINUOUS * size {
                *shift = 0.0;
            }
        }
        let normal = passage.gradient(row).rows(0, n).into_owned();
        let reset = passage.slopes(&exit.reset.at);
        let jump = &reset + &shift * normal.transpose() / fall;
        let inverse = || {
            let undone = Factors::new(reset.clone()).inverse()?;
            let moved = &undone * &shift;
            let terms = normal.iter().zip(&moved).map(|(g, w)| g * w);
            let size: f64 = terms.clone().map(f64::abs).sum::<f64>() + fall.abs();
            let divisor = fall + terms.sum::<f64>();
            let singular =
                divisor.abs() <= SINGULAR * size || undone.amax() * reset.amax() > SINGULAR.recip();
            let back =
                passage.backward() * (&undone - moved * (normal.transpose() * &undone) / divisor);
            (!singular).then_some(back)
        };
        Link {
            backward: inverse(),
            fall: -fall * self.orbit.setting.scales.time / self.orbit.size(row),
            jump,
            flow,
            after,
        }
    }

    fn links(&self, passages: &[Passage]) -> Vec<Link> {
        let passages = passages.iter().enumerate();
        let links = passages.map(|(zone, passage)| self.link(zone, passage));
        links.collect()
    }

    /// The linearised motion over half a period, with the image at its end: some states change their sign.
    pub(super) fn half_monodromy(&self, passages: &[Passage], signs: &Vector) -> Option<Monodromy> {
        let mut links = self.links(passages);
        let last = links.last_mut()?;
        let image = Matrix::from_diagonal(signs);
        last.jump = &image * &last.jump;
        last.after.component_mul_assign(signs);
        last.backward = last.backward.take().map(|back| back * &image);
        self.over(&links)
    }

    /// The linearised motion over a period; `None` where it is infinite, at a graze.
    pub(super) fn monodromy(&self, passages: &[Passage]) -> Option<Monodromy> {
        self.over(&self.links(passages))
    }

    /// The linearised motion over links in a row.
    fn over(&self, links: &[Link]) -> Option<Monodromy> {
        let finite = |matrix: &Matrix| matrix.iter().all(|x| x.is_finite());
        if !links
            .iter()
            .all(|link| finite(&link.flow) && finite(&link.jump))
        {
            return None;
        }
        let n = self.orbit.states();
        let rate = &self.mode(0).matrix.at * self.entry(0);
        let rate = rate.rows(0, n).into_owned();
        let after = links.last().map_or(&rate, |link| &link.after);
        let back: Option<Vec<&Matrix>> = links.iter().map(|link| link.backward.as_ref()).collect();
        let identity = Matrix::identity(n, n);
        let (matrix, inverse, [rate, after], zeros) = match back {
            Some(back) => {
                let matrix = links.iter().fold(identity.clone(), |product, link| {
                    &link.jump * (&link.flow * product)
                });
                let inverse = back
                    .into_iter()
                    .rev()
                    .fold(identity, |product, back| back * product);
                (
                    matrix,
                    Some(inverse).filter(finite),
                    [rate.clone(), after.clone()],
                    0,
                )
            }
            None => {
                let (basis, factors) = reduced(links, n);
                let rank = basis.ncols();
                let matrix = factors
                    .iter()
                    .fold(Matrix::identity(rank, rank), |product, one| one * product);
                let inverses: Option<Vec<Matrix>> = factors
                    .into_iter()
                    .map(|one| Factors::new(one).inverse())
                    .collect();
                let inverse = inverses.map(|inverses| {
                    let inverses = inverses.into_iter().rev();
                    inverses.fold(Matrix::identity(rank, rank), |product, one| one * product)
                });
                (
                    matrix,
                    inverse.filter(finite),
                    [&rate, after].map(|rate| basis.tr_mul(rate)),
                    n - rank,
                )
            }
        };
        let sizes = [
            matrix.norm(),
            inverse.as_ref().map_or(0.0, |inverse| inverse.norm()),
        ];
        let shifts = !self.orbit.is_forced() && rate.norm() > 0.0;
        // M takes ẋ at the beginning to ẋ at the end: what is across the one goes to what is across the other. They
        // differ by how well the orbit closes, which M would carry into the rest multiplied by its size
        let bases = shifts.then(|| {
            let axis = rate.iamax();
            [&rate, &after].map(|rate| complement(rate, axis))
        });
        let (matrix, inverse) = match &bases {
            None => (matrix, inverse),
            Some([begin, end]) => (
                end.tr_mul(&(matrix * begin)),
                inverse.map(|inverse| begin.tr_mul(&(inverse * end))),
            ),
        };
        Some(Monodromy {
            matrix,
            inverse,
            sizes,
            falls: links.iter().map(|link| link.fall).collect(),
            zeros,
            shifts,
        })
    }
}

/// An orthonormal basis of the perturbations that are left after a period, and the links in coordinates of such
/// bases.
fn reduced(links: &[Link], states: usize) -> (Matrix, Vec<Matrix>) {
    let mut basis = Matrix::identity(states, states);
    loop {
        let before = basis.ncols();
        let first = basis.clone();
        let mut factors = Vec::with_capacity(links.len());
        for link in links {
            // a flow takes nothing away, however much it contracts
            let moved = &link.flow * &basis;
            let middle = range(&moved, 0.0);
            let image = &link.jump * &middle;
            let next = range(&image, SINGULAR);
            factors.push(next.tr_mul(&image) * middle.tr_mul(&moved));
            basis = next;
        }
        if basis.ncols() == before {
            // the last basis in coordinates of the first: both span the same
            let turn = first.tr_mul(&basis);
            if let Some(last) = factors.last_mut() {
                *last = turn * &*last;
            }
            return (first, factors);
        }
    }
}

/// An orthonormal basis of the range of a matrix; columns of less than a part of the largest are nothing.
fn range(matrix: &Matrix, least: f64) -> Matrix {
    let mut columns: Vec<Vector> = Vec::new();
    let mut rest: Vec<Vector> = matrix
        .column_iter()
        .map(|column| column.into_owned())
        .collect();
    let largest = rest
        .iter()
        .fold(0.0_f64, |largest, column| largest.max(column.norm()));
    loop {
        let length = |index: &usize| rest[*index].norm();
        let longest = (0..rest.len()).max_by(|one, other| length(one).total_cmp(&length(other)));
        let Some(index) = longest else { break };
        let mut column = rest.swap_remove(index);
        if column.norm() <= least * largest {
            break;
        }
        // twice is enough
        for _ in 0..2 {
            for known in &columns {
                let along = known.dot(&column);
                column.axpy(-along, known, 1.0);
            }
            column /= column.norm();
        }
        for other in &mut rest {
            let along = column.dot(other);
            other.axpy(-along, &column, 1.0);
        }
        columns.push(column);
    }
    if columns.is_empty() {
        return Matrix::zeros(matrix.nrows(), 0);
    }
    Matrix::from_columns(&columns)
}

/// An orthonormal basis of what is perpendicular to a vector, which is not zero: the reflection that takes it to an
/// axis, along which it is long, without the column of the axis.
fn complement(vector: &Vector, axis: usize) -> Matrix {
    let n = vector.len();
    let mut mirror = vector / vector.norm();
    mirror[axis] += mirror[axis].signum();
    let scale = 2.0 / mirror.norm_squared();
    let reflection = Matrix::identity(n, n) - &mirror * mirror.transpose() * scale;
    reflection.remove_column(axis)
}

/// Eigenvalues, the largest first; of a conjugate pair that above the real axis.
fn eigenvalues(matrix: &Matrix) -> Vec<Complex<f64>> {
    let mut values: Vec<Complex<f64>> = match matrix.nrows() {
        0 => Vec::new(),
        1 => vec![Complex::new(matrix[(0, 0)], 0.0)],
        _ => matrix.complex_eigenvalues().iter().copied().collect(),
    };
    values.sort_by(|one, other| {
        let by_size = other.norm().total_cmp(&one.norm());
        let close = (one.norm() - other.norm()).abs() <= 1e-12 * one.norm();
        let by_sign = other.im.total_cmp(&one.im);
        if close && one.re == other.re {
            by_sign
        } else {
            by_size
        }
    });
    values
}

impl Monodromy {
    /// All multipliers, the largest first.
    pub fn multipliers(&self) -> Vec<Multiplier> {
        let mut values = eigenvalues(&self.matrix);
        let [size, other_size] = self.sizes;
        // what is across the shift is known to the rounding of a direction that the product stretches to its size
        let lost = |size: f64| match self.shifts {
            true => ROUNDING * size * size.max(1.0),
            false => ROUNDING * size,
        };
        let mut errors = vec![lost(size); values.len()];
        if let Some(inverse) = &self.inverse {
            let mut others = eigenvalues(inverse);
            others.reverse();
            let mut index = 0;
            while index < values.len() {
                let pair = values
                    .get(index + 1)
                    .is_some_and(|next| *next == values[index].conj());
                let count = if pair && values[index].im != 0.0 {
                    2
                } else {
                    1
                };
                // each is known to the rounding of the product it comes from
                let own = size / values[index].norm();
                let other = other_size / others[index].norm();
                if other < own {
                    for index in index..index + count {
                        values[index] = others[index].inv();
                        errors[index] = lost(other_size) * values[index].norm_sqr();
                    }
                }
                index += count;
            }
        }
        let left = values.into_iter().zip(errors);
        let left = left.map(|(value, error)| Multiplier {
            value,
            trivial: false,
            error,
        });
        let trivial = |value: f64| Multiplier {
            value: Complex::new(value, 0.0),
            trivial: true,
            error: 0.0,
        };
        let one = self.shifts.then(|| trivial(1.0));
        let mut all: Vec<Multiplier> = left.chain(one).collect();
        all.sort_by(|one, other| other.value.norm().total_cmp(&one.value.norm()));
        all.extend((0..self.zeros).map(|_| trivial(0.0)));
        all
    }

    /// Of all multipliers det(M + 1), det(M − 1) and ∏(1 − μᵢμⱼ) over pairs, of what is not trivial: they change their sign where
    /// a multiplier passes −1, where one passes 1, and where a pair has the product 1.
    ///
    /// At a graze one multiplier is infinite. The determinants have a simple pole there, which the speeds of the
    /// guards divide out; the product is not looked at. Entries of M are so large then that its determinant is lost
    /// in rounding: the multipliers are not.
    pub fn tests(&self, multipliers: &[Multiplier]) -> [f64; 3] {
        let values: Vec<Complex<f64>> = own(multipliers).map(|one| one.value).collect();
        // where nothing is left no speed is divided out
        let speeds: f64 = match values.is_empty() {
            true => 1.0,
            false => self.falls.iter().product(),
        };
        let shifted = |by: f64| {
            let product: Complex<f64> = values.iter().map(|value| value + by).product();
            // a multiplier that a switch takes away is zero
            speeds * f64::powi(by, self.zeros as i32) * product.re
        };
        let torus = || {
            let pairs = (0..values.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
            let product: Complex<f64> = pairs.map(|(i, j)| 1.0 - values[i] * values[j]).product();
            product.re
        };
        let grazes = self.falls.iter().any(|fall| *fall <= AT_ZERO);
        let tests = [
            shifted(1.0),
            shifted(-1.0),
            if grazes { 0.0 } else { torus() },
        ];
        let finite = |test: f64| if test.is_finite() { test } else { 0.0 };
        tests.map(finite)
    }

    /// The pair of multipliers whose product is nearest to 1.
    fn nearest_pair(&self) -> Option<[Complex<f64>; 2]> {
        let values = eigenvalues(&self.matrix);
        let pairs = (0..values.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        let far = |&(i, j): &(usize, usize)| (1.0 - values[i] * values[j]).norm();
        let nearest = pairs.min_by(|one, other| far(one).total_cmp(&far(other)));
        nearest.map(|(i, j)| [values[i], values[j]])
    }

    /// Argument of that pair, between 0 and π; `None` where they are real: a saddle whose multipliers are μ and
    /// 1/μ.
    pub fn angle_on_circle(&self) -> Option<f64> {
        let [one, _] = self.nearest_pair()?;
        (one.im != 0.0).then(|| one.arg().abs())
    }

    /// Half the sum of that pair: the cosine of its angle where it is on the unit circle.
    pub fn cosine(&self) -> Option<f64> {
        let [one, other] = self.nearest_pair()?;
        Some(0.5 * (one.re + other.re))
    }
}

/// Those that are not trivial.
pub fn own(multipliers: &[Multiplier]) -> impl Iterator<Item = &Multiplier> {
    multipliers.iter().filter(|one| !one.trivial)
}

/// Whether more than rounding tells the sign of a function of [`Monodromy::tests`]: it does not where a multiplier, or
/// the product of a pair, stays where it vanishes, as those of a motion without loss do.
pub(super) fn is_told(multipliers: &[Multiplier], test: usize) -> bool {
    /// Rounding of multipliers, a condition of many thousands included.
    const NOISE: f64 = 1e-10;
    let own: Vec<&Multiplier> = own(multipliers).collect();
    let off = |x: Complex<f64>, from: f64, error: f64| {
        (x - from).norm() > NOISE * (1.0 + x.norm()) + error
    };
    let from = |from: f64| own.iter().all(|one| off(one.value, from, one.error));
    let pair = |one: &Multiplier, two: &Multiplier| {
        let error = one.error * two.value.norm() + two.error * one.value.norm();
        off(one.value * two.value, 1.0, error)
    };
    match test {
        0 => from(-1.0),
        1 => from(1.0),
        _ => (0..own.len()).all(|j| (0..j).all(|i| pair(own[i], own[j]))),
    }
}

impl AffineOrbit {
    /// The linearised motion over a period; `None` where it is infinite, at a graze.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn monodromy(&self, point: &Vector) -> Result<Option<Monodromy>, OrbitFailure> {
        let at = self.at(point)?;
        Ok(at.monodromy(&at.passages()?))
    }

    /// All Floquet multipliers at a point, the largest first; none at a graze, where they have no limit.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    pub fn multipliers(&self, point: &Vector) -> Result<Vec<Multiplier>, OrbitFailure> {
        let monodromy = self.monodromy(point)?;
        Ok(monodromy.map_or_else(Vec::new, |monodromy| monodromy.multipliers()))
    }
}
