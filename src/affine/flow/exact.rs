//! The exact flow exp(Mt) of a linear mode over pieces of one length, and what is slow of it over longer ones.

use std::sync::OnceLock;

use super::Expansion;
use crate::affine::exponential::{TERMS, entries, plain_propagator};
use crate::affine::mode::AffineMode;
use crate::affine::stiff::{GAP, Splitting};
use crate::linalg::{Matrix, Vector, add_product};
use crate::orbit::sign::{COEFFICIENTS, DEGREE};

/// Most components of z whose series are made in arrays: those of a forced oscillator of two degrees of freedom.
const FEW: usize = 8;

/// exp(Mt) over pieces of one length.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    pub matrix: Matrix,
    /// Its entries that are not zero: row, column, value.
    entries: Vec<(usize, usize, f64)>,
    /// Length of a piece.
    pub length: f64,
    /// exp(M·length).
    pub step: Matrix,
    pub guards: Vec<GuardSeries>,
    /// What is slow of it, and its flow, with much longer pieces; the longest first.
    pub stiff: Vec<(Splitting, Exact)>,
}

/// A guard over a piece.
#[derive(Clone, Debug)]
pub(super) struct GuardSeries {
    pub form: Vector,
    /// Its Taylor coefficients in time/`length` as linear forms of z at the beginning, for every component of z those of
    /// all orders: of many flows only the values of guards are wanted.
    coefficients: OnceLock<Vec<[f64; COEFFICIENTS]>>,
    /// Bounds of its terms for 1 of every component of z at the beginning, whatever the signs of others.
    terms: OnceLock<TermBounds>,
}

/// Bounds of the terms |M·length|ᵏ/k! of an exponential on one side of a vector without signs. They are taken entry by entry, so that
/// other units of a state scale them alone and change nothing else.
#[derive(Clone, Debug)]
struct TermBounds {
    /// Of the largest for every component.
    largest: Vec<f64>,
    /// Of the sum of those that an expansion leaves out.
    left_out: Vec<f64>,
}

impl TermBounds {
    /// Those of a vector, for a step from the term before to the k-th, which is added to zeros.
    fn of(vector: &[f64], step: impl Fn(f64, &[f64], &mut [f64])) -> TermBounds {
        let mut term: Vec<f64> = vector.iter().map(|x| x.abs()).collect();
        let (mut largest, mut next) = (term.clone(), term.clone());
        for k in 1..COEFFICIENTS {
            next.fill(0.0);
            step((k as f64).recip(), &term, &mut next);
            std::mem::swap(&mut term, &mut next);
            let pairs = largest.iter_mut().zip(&term);
            pairs.for_each(|(largest, term)| *largest = term.max(*largest));
        }
        TermBounds {
            left_out: TermBounds::beyond(term, step),
            largest,
        }
    }

    /// The sum of those after the last of an expansion.
    fn beyond(mut term: Vec<f64>, step: impl Fn(f64, &[f64], &mut [f64])) -> Vec<f64> {
        /// What follows falls geometrically where a term adds less than this part to every component.
        const LEAST: f64 = 1.0 / 64.0;
        let (mut sum, mut next) = (vec![0.0; term.len()], term.clone());
        // by the way from every component to every other
        for k in COEFFICIENTS..COEFFICIENTS + 2 * term.len() + 8 {
            next.fill(0.0);
            step((k as f64).recip(), &term, &mut next);
            std::mem::swap(&mut term, &mut next);
            let pairs = sum.iter_mut().zip(&term);
            pairs.for_each(|(sum, term)| *sum += term);
            let mut pairs = sum.iter().zip(&term);
            if pairs.all(|(sum, term)| *term <= LEAST * sum) {
                break;
            }
        }
        sum
    }
}

impl Exact {
    fn new(matrix: Matrix, states: usize, longest: f64, norm: f64) -> Exact {
        let length = if norm * longest > 1.0 {
            norm.recip()
        } else {
            longest
        };
        let step = plain_propagator(&matrix, states, norm, length);
        Exact {
            guards: Vec::new(),
            stiff: Vec::new(),
            step,
            length,
            entries: entries(&matrix),
            matrix,
        }
    }

    /// The flow of a mode.
    pub fn of(mode: &AffineMode, longest: f64, (scales, norm): (Vector, f64)) -> Exact {
        let matrix = &mode.matrix.at;
        let ways = Splitting::all(matrix, &scales, norm, longest);
        let mut flow = Exact::new(matrix.clone(), mode.states, longest, norm);
        let stiff = ways.into_iter().map(|way| {
            let size = way.slow.nrows();
            let slow = Exact::new(way.slow.clone(), size, longest, way.norm);
            (way, slow)
        });
        flow.stiff = stiff
            .filter(|(_, slow)| slow.length >= GAP * flow.length)
            .collect();
        for guard in &mode.guards {
            flow.watch(guard.row.at.clone());
        }
        flow
    }

    pub fn watch(&mut self, form: Vector) {
        for (way, slow) in &mut self.stiff {
            slow.watch(way.along.tr_mul(&form));
        }
        self.guards.push(GuardSeries {
            terms: OnceLock::new(),
            coefficients: OnceLock::new(),
            form,
        });
    }

    pub fn coefficients(&self, guard: usize) -> &[[f64; COEFFICIENTS]] {
        let GuardSeries {
            form, coefficients, ..
        } = &self.guards[guard];
        coefficients.get_or_init(|| {
            let mut coefficients = vec![[0.0; COEFFICIENTS]; form.len()];
            let (mut last, mut next) = (form.clone(), form.clone());
            for k in 0..COEFFICIENTS {
                if k > 0 {
                    next.fill(0.0);
                    let (part, matrix) = (self.length / k as f64, self.matrix.as_slice());
                    add_product(part, last.as_slice(), 1, matrix, next.as_mut_slice());
                    std::mem::swap(&mut last, &mut next);
                }
                let components = coefficients.iter_mut().zip(&last);
                components.for_each(|(orders, coefficient)| orders[k] = *coefficient);
            }
            coefficients
        })
    }

    pub fn within(&self, z: &Vector, time: f64) -> Vector {
        let mut sum = z.clone();
        let add = |sum: &mut [f64], term: &[f64]| {
            let pairs = sum.iter_mut().zip(term);
            pairs.for_each(|(sum, term)| *sum += term);
        };
        if let Some(mut term) = self.few(z.as_slice()) {
            for k in 1..=TERMS {
                term = self.rate_of_few(time / f64::from(k), &term);
                add(sum.as_mut_slice(), &term);
            }
            return sum;
        }
        let (mut term, mut next) = (z.clone(), z.clone());
        for k in 1..=TERMS {
            next.fill(0.0);
            self.rate(time / f64::from(k), term.as_slice(), next.as_mut_slice());
            std::mem::swap(&mut term, &mut next);
            add(sum.as_mut_slice(), term.as_slice());
        }
        sum
    }

    /// Adds Mz times a factor.
    fn rate(&self, factor: f64, z: &[f64], rate: &mut [f64]) {
        for (row, column, value) in &self.entries {
            rate[*row] += value * (factor * z[*column]);
        }
    }

    /// z with zeros behind it, where it has so few components.
    fn few(&self, z: &[f64]) -> Option<[f64; FEW]> {
        let mut few = [0.0; FEW];
        few.get_mut(..z.len())?.copy_from_slice(z);
        Some(few)
    }

    /// Mz times a factor, of a z of few components: indices of entries are below [`FEW`], which the compiler is told.
    fn rate_of_few(&self, factor: f64, z: &[f64; FEW]) -> [f64; FEW] {
        let mut rate = [0.0; FEW];
        for (row, column, value) in &self.entries {
            rate[row % FEW] += value * (factor * z[column % FEW]);
        }
        rate
    }

    /// Expands z in place of another expansion.
    pub fn expand(&self, z: &Vector, part: f64, expansion: &mut Expansion) {
        let z_at = z.as_slice();
        expansion.terms.clear();
        expansion.terms.resize(z_at.len(), [0.0; COEFFICIENTS]);
        expansion.set(0, z_at);
        let factor = |k: usize| part * self.length / k as f64;
        if let Some(mut term) = self.few(z_at) {
            for k in 1..COEFFICIENTS {
                term = self.rate_of_few(factor(k), &term);
                expansion.set(k, &term);
            }
        } else {
            let (mut term, mut next) = (z_at.to_vec(), z_at.to_vec());
            for k in 1..COEFFICIENTS {
                next.fill(0.0);
                self.rate(factor(k), &term, &mut next);
                std::mem::swap(&mut term, &mut next);
                expansion.set(k, &term);
            }
        }
    }

    /// What an expansion of z over the beginning of a piece leaves out, by its last coefficients.
    pub fn left_out(&self, expansion: &Expansion, part: f64) -> Vec<f64> {
        let last = expansion.terms.iter().map(|terms| terms[DEGREE].abs());
        TermBounds::beyond(last.collect(), |factor, before, next| {
            let factor = factor * part * self.length;
            for (row, column, value) in &self.entries {
                next[*row] += value.abs() * (factor * before[*column]);
            }
        })
    }

    /// What the coefficients of a guard leave out over the beginning of a piece with this z, and the rounding of the products that they
    /// are made of, where the first, so many, are known to be zero.
    pub fn error(&self, guard: usize, z: &Vector, part: f64, zeros: usize) -> f64 {
        let GuardSeries { form, terms, .. } = &self.guards[guard];
        let TermBounds { largest, left_out } = terms.get_or_init(|| {
            TermBounds::of(form.as_slice(), |factor, before, next| {
                let factor = factor * self.length;
                for (row, column, value) in &self.entries {
                    next[*column] += value.abs() * (factor * before[*row]);
                }
            })
        });
        let (mut rounding, mut beyond) = (0.0, 0.0);
        for ((z, largest), left_out) in z.iter().zip(largest).zip(left_out) {
            rounding += z.abs() * largest;
            beyond += z.abs() * left_out;
        }
        2.0 * f64::EPSILON * part.powi(zeros as i32) * rounding
            + part.powi(COEFFICIENTS as i32) * beyond
    }

    /// The coefficients of a guard over the beginning of a piece, and the error of the polynomial without its first
    /// coefficients, so many, which are known to be zero: the others are rounded in proportion to the part.
    pub fn taylor(
        &self,
        guard: usize,
        z: &Vector,
        part: f64,
        zeros: usize,
    ) -> ([f64; COEFFICIENTS], f64) {
        let mut taylor = [0.0; COEFFICIENTS];
        for (orders, z) in self.coefficients(guard).iter().zip(z.as_slice()) {
            let pairs = taylor.iter_mut().zip(orders);
            pairs.for_each(|(sum, coefficient)| *sum += coefficient * z);
        }
        let mut power = 1.0;
        for coefficient in &mut taylor {
            *coefficient *= power;
            power *= part;
        }
        (taylor, self.error(guard, z, part, zeros))
    }
}
