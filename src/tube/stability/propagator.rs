//! The transfer of perturbations over a sliding zone as polynomials in λ, under friction that depends on the velocity.
//!
//! z″ = Δz with Δ = qλ² + L(s)λ + C(s), see [`super::sliding`]. With μ = λ/Λ and z = Σ z_k μᵏ
//!
//! ```text
//! z_k″ = C z_k + ΛL z_{k−1} + Λ²q z_{k−2},
//! ```
//!
//! whose solutions are real and do not depend on λ: one expansion serves every sample and every eigenvalue of a wave. A
//! block of the zone lasts as long as z turns by no more than [`RADIANS`] at |λ| = Λ. With all terms of Δ replaced by their
//! moduli z turns by no more than μ·[`RADIANS`] at real μ ≥ 1, so that the transfer, in units in which it has no dimension,
//! is below e^{2μ}, and its coefficient of order k below (2e/k)ᵏ (Cauchy): the orders that [`DEGREE`] leaves out add up to
//! 3e-18. Products of transfers obey the same bound with the sum of their angles. The series of one step in
//! [`super::sliding`] has terms of the same size, and loses no fewer digits.

use std::sync::OnceLock;

use super::segment::{ORDER, Pair, RADIANS, SeriesSegment, part, scaled_down};
use super::{C64, ONE, ZERO};
use crate::tube::flow::numeric::series::{Series, TERMS};

/// Degree of the polynomials in λ/Λ.
const DEGREE: usize = 25;

/// Number of bounds Λ, each twice the one before.
const LEVELS: usize = 16;

/// Most blocks of a zone, of 832 bytes each: where more are needed perturbations go step by step.
const MOST_BLOCKS: f64 = 1000.0;

/// The transfer of (z, z′): coefficients of its entries, row by row, in powers of λ/Λ.
#[derive(Clone, Debug)]
struct Transfer {
    coefficients: [[f64; 4]; DEGREE + 1],
}

/// (λ/Λ)ᵏ and its derivative in λ.
type Powers = [[C64; 2]; DEGREE + 1];

impl Transfer {
    /// The transfer over `seconds`, from the series of ΛL and C over them and from Λ²q, all times their square.
    fn new(linear: &Series, constant: &Series, square: f64, seconds: f64) -> Transfer {
        // power series in time, order by order in μ, of the solutions from (1, 0) and (0, 1)
        let mut orders = [[[0.0; 2]; ORDER]; DEGREE + 1];
        orders[0][0][0] = 1.0;
        orders[0][1][1] = seconds;
        let mut coefficients = [[0.0; 4]; DEGREE + 1];
        for k in 0..=DEGREE {
            // two orders in μ come with two in time at least
            for n in k.saturating_sub(2)..ORDER - 2 {
                let mut sum = [0.0; 2];
                let mut add = |factors: &[f64], terms: &[[f64; 2]]| {
                    for (factor, term) in factors.iter().zip(terms.iter().rev()) {
                        sum[0] += factor * term[0];
                        sum[1] += factor * term[1];
                    }
                };
                let count = n.min(TERMS - 1) + 1;
                add(&constant[..count], &orders[k][..=n]);
                if k >= 1 {
                    add(&linear[..count], &orders[k - 1][..=n]);
                }
                if k >= 2 {
                    add(&[square], &orders[k - 2][n..=n]);
                }
                let inverse = 1.0 / ((n as f64 + 1.0) * (n as f64 + 2.0));
                orders[k][n + 2] = sum.map(|sum| sum * inverse);
            }
            for (n, [one, other]) in orders[k].iter().enumerate().rev() {
                let slope = n as f64 / seconds;
                let terms = [*one, *other, one * slope, other * slope];
                let sums = coefficients[k].iter_mut().zip(terms);
                sums.for_each(|(sum, term)| *sum += term);
            }
        }
        Transfer { coefficients }
    }

    /// The same transfer for a bound Λ that is a power of two smaller.
    fn narrowed(&self, halvings: i32) -> Transfer {
        let factor = (-f64::from(halvings)).exp2();
        let mut power = 1.0;
        let coefficients = self.coefficients.map(|terms| {
            let terms = terms.map(|term| term * power);
            power *= factor;
            terms
        });
        Transfer { coefficients }
    }

    /// This transfer and then another one.
    fn then(&self, next: &Transfer) -> Transfer {
        let mut coefficients = [[0.0; 4]; DEGREE + 1];
        for (k, sums) in coefficients.iter_mut().enumerate() {
            let before = self.coefficients[..=k].iter().rev();
            for ([a, b, c, d], [e, f, g, h]) in next.coefficients.iter().zip(before) {
                let terms = [a * e + b * g, a * f + b * h, c * e + d * g, c * f + d * h];
                sums.iter_mut()
                    .zip(terms)
                    .for_each(|(sum, term)| *sum += term);
            }
        }
        Transfer { coefficients }
    }

    /// The entries at λ and their derivatives.
    fn at(&self, powers: &Powers) -> [[C64; 4]; 2] {
        let mut sums = [[0.0; 4]; 4];
        for (terms, [at, by]) in self.coefficients.iter().zip(powers).rev() {
            for (sums, factor) in sums.iter_mut().zip([at.re, at.im, by.re, by.im]) {
                for (sum, term) in sums.iter_mut().zip(terms) {
                    *sum += factor * term;
                }
            }
        }
        let [re, im, re_by, im_by] = sums;
        [(re, im), (re_by, im_by)]
            .map(|(re, im)| std::array::from_fn(|entry| C64::new(re[entry], im[entry])))
    }
}

/// A part of a zone with the angle by which z turns in it at most.
#[derive(Clone, Debug)]
struct Block {
    angle: f64,
    transfer: Transfer,
}

/// Appends a part of a zone to its blocks: to the last of them while the angle allows.
fn append(blocks: &mut Vec<Block>, next: Block) {
    match blocks.last_mut() {
        Some(last) if last.angle + next.angle <= RADIANS => {
            last.transfer = last.transfer.then(&next.transfer);
            last.angle += next.angle;
        }
        _ => blocks.push(next),
    }
}

/// A segment whose transfer over the whole of it is expanded at the largest level at which that is one block.
#[derive(Clone, Debug)]
struct WholeSegment {
    level: usize,
    transfer: Transfer,
}

/// The transfer over a zone for |λ| ≤ Λ.
#[derive(Clone, Debug)]
struct Propagator {
    bound: f64,
    blocks: Vec<Block>,
}

impl Propagator {
    /// Carries z and z′ with their derivatives over the zone. Returns the exponent that is taken out of them.
    fn carry(&self, lambda: C64, pairs: &mut [Pair]) -> f64 {
        let mu = lambda / self.bound;
        let mut powers: Powers = [[ONE, ZERO]; DEGREE + 1];
        for k in 1..=DEGREE {
            let before = powers[k - 1][0];
            powers[k] = [before * mu, before * (k as f64 / self.bound)];
        }
        let mut exponent = 0.0;
        for block in &self.blocks {
            let [[a, b, c, d], [a_by, b_by, c_by, d_by]] = block.transfer.at(&powers);
            for pair in pairs.iter_mut() {
                let [[z, rate], [z_by, rate_by]] = *pair;
                *pair = [
                    [a * z + b * rate, c * z + d * rate],
                    [
                        a * z_by + b * rate_by + a_by * z + b_by * rate,
                        c * z_by + d * rate_by + c_by * z + d_by * rate,
                    ],
                ];
            }
            exponent += scaled_down(pairs);
        }
        exponent
    }
}

/// The transfer over a zone for one bound of |λ| after the other, each expanded when it is first needed.
#[derive(Clone, Debug)]
pub(super) struct BoundedPropagators {
    square: f64,
    /// The smallest bound: up to it the part qλ² of Δ turns z by no more than [`RADIANS`] over the whole zone.
    least: f64,
    /// Segment by segment; `None` where there are several blocks at every level.
    whole: Vec<Option<WholeSegment>>,
    levels: [OnceLock<Option<Propagator>>; LEVELS],
}

impl BoundedPropagators {
    /// Of the segments of a zone that lasts `duration`, with q.
    pub(super) fn new(
        segments: &[SeriesSegment],
        duration: f64,
        square: f64,
    ) -> BoundedPropagators {
        let least = RADIANS / (square.sqrt() * duration);
        let whole = segments.iter().map(|segment| {
            let fits = |level: &usize| {
                let size = segment.size(square, least * (*level as f64).exp2());
                size.sqrt() * segment.piece.duration <= RADIANS
            };
            let level = (0..LEVELS).rev().find(fits)?;
            let bound = least * (level as f64).exp2();
            let transfer = segment.transfer([0.0, 1.0], square, bound);
            Some(WholeSegment { level, transfer })
        });
        BoundedPropagators {
            square,
            least,
            whole: whole.collect(),
            levels: std::array::from_fn(|_| OnceLock::new()),
        }
    }

    /// Carries z and z′ with their derivatives over the zone. Returns the exponent that is taken out of them, or
    /// `None` where |λ| needs too many blocks.
    pub(super) fn carry(
        &self,
        segments: &[SeriesSegment],
        lambda: C64,
        pairs: &mut [Pair],
    ) -> Option<f64> {
        let level = (lambda.norm() / self.least).log2().ceil().max(0.0);
        if !(self.least.is_normal() && level < LEVELS as f64) {
            return None;
        }
        let propagator = self.levels[level as usize]
            .get_or_init(|| self.propagator(segments, level as usize))
            .as_ref()?;
        Some(propagator.carry(lambda, pairs))
    }

    /// The propagator of a level; `None` where it has too many blocks.
    fn propagator(&self, segments: &[SeriesSegment], level: usize) -> Option<Propagator> {
        let bound = self.least * (level as f64).exp2();
        let angle = |segment: &SeriesSegment| {
            segment.size(self.square, bound).sqrt() * segment.piece.duration
        };
        let most: f64 = segments.iter().map(angle).sum();
        if most.is_nan() || most > MOST_BLOCKS * RADIANS {
            return None;
        }
        let mut blocks = Vec::new();
        for (segment, whole) in segments.iter().zip(&self.whole) {
            let angle = angle(segment);
            if let Some(whole) = whole.as_ref().filter(|whole| whole.level >= level) {
                let transfer = whole.transfer.narrowed((whole.level - level) as i32);
                append(&mut blocks, Block { angle, transfer });
                continue;
            }
            let count = (angle / RADIANS).ceil().max(1.0);
            for index in 0..count as usize {
                let part = [index as f64 / count, count.recip()];
                let transfer = segment.transfer(part, self.square, bound);
                let angle = angle / count;
                append(&mut blocks, Block { angle, transfer });
            }
        }
        Some(Propagator { bound, blocks })
    }
}

impl SeriesSegment {
    /// The transfer over a part of the segment, from its beginning and width in units of the whole.
    fn transfer(&self, [from, width]: [f64; 2], square: f64, bound: f64) -> Transfer {
        let seconds = width * self.piece.duration;
        let scale = seconds * seconds;
        let linear = part(&self.linear, from, width).map(|term| term * (scale * bound));
        let constant = part(&self.constant, from, width).map(|term| term * scale);
        Transfer::new(&linear, &constant, square * bound * bound * scale, seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tube::stability::course::ZoneFriction;
    use crate::tube::stability::perturbation::{
        Characteristic, LinearZone, PerturbationColumns, PerturbationJump, modulus,
    };
    use std::sync::Arc;

    use crate::tube::flow::numeric::series::SlipPiece;
    use crate::tube::model::signature::Regime;

    const A: f64 = 0.6;
    const H: f64 = 8.5;
    const DAMPING: f64 = 0.3;

    /// Pieces of a zone along which friction changes smoothly, the last of them too long for one block.
    fn pieces() -> Vec<SlipPiece> {
        let series = |terms: [f64; 4]| -> Series {
            std::array::from_fn(|n| terms.get(n).copied().unwrap_or(0.0))
        };
        let piece = |start: f64, duration: f64, at: f64| SlipPiece {
            start,
            duration,
            force: series([0.4 - at, 0.2, -0.05, 0.01]),
            drag: series([-1.5 + at, 0.3, 0.2, -0.1]),
        };
        vec![
            piece(0.0, 0.1, 0.0),
            piece(0.1, 0.05, 0.1),
            piece(0.15, 0.2, 0.2),
            piece(0.35, 4.0, 0.3),
        ]
    }

    fn zone() -> LinearZone {
        LinearZone {
            regime: Regime::Slip,
            duration: 4.35,
            jump: PerturbationJump::None,
            course: Some(Arc::new(ZoneFriction::new(
                pieces(),
                [A, 1.0 - A, H, DAMPING],
            ))),
        }
    }

    fn wave(zone: LinearZone) -> Characteristic {
        Characteristic {
            period: zone.duration,
            zones: vec![zone],
            stick: false,
            mode: 1,
            excess: A.powf(-0.5) - 1.0,
            ma: 1.0 - A,
            mb: 0.8,
            a: A,
            b: 0.2,
            kappa: 0.7,
            g: 18.0,
            h: H,
            friction: 0.5,
            static_friction: 0.5,
            damping: DAMPING,
            beta: 0.0,
            turn: 0.0,
            defect: 0.0,
        }
    }

    /// The expanded transfer and its derivative are those of the steps, to the rounding of the angle |λ|T: at
    /// every level, at bounds of levels and between them.
    #[test]
    fn expansion_agrees_with_steps() {
        let expanded = wave(zone());
        expanded.expand();
        let plain = wave(zone());
        for size in [0.0, 1e-3, 0.3, 1.0, 2.9, 7.3, 20.0, 65.0] {
            for turn in [0.0, 0.4, 1.3, 2.0, 3.1] {
                let lambda = C64::from_polar(size, turn);
                let ends = [&expanded, &plain].map(|wave| {
                    let mut state = PerturbationColumns::unit();
                    wave.cross(&wave.zones[0], lambda, &mut state, 2);
                    state
                });
                let shift = (ends[0].exponent - ends[1].exponent).exp();
                let largest = |of: fn(&PerturbationColumns) -> &[nalgebra::Vector4<C64>; 2]| {
                    let numbers = of(&ends[1]).iter().flatten();
                    numbers.map(|z| modulus(*z)).fold(0.0, f64::max)
                };
                let rounding = 2e-14 * (1.0 + 4.35 * size);
                let (value, slope) = (largest(|end| &end.columns), largest(|end| &end.by));
                for column in 0..2 {
                    for row in 2..4 {
                        let [one, other] = [0, 1].map(|of| ends[of].columns[column][row]);
                        assert!(modulus(one * shift - other) < rounding * value, "{lambda}");
                        let [one, other] = [0, 1].map(|of| ends[of].by[column][row]);
                        assert!(modulus(one * shift - other) < rounding * slope, "{lambda}");
                    }
                }
            }
        }
    }
}
