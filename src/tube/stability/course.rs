//! Friction that depends on the velocity along a zone, as perturbations see it: F = fκS and E = f·dS/dV̇·P as power
//! series in time, and the coefficients of the equation that [`super::sliding`] solves with them.

use std::sync::OnceLock;

use super::C64;
use super::propagator::BoundedPropagators;
use super::segment::{Pair, SeriesSegment};
use crate::tube::flow::numeric::series::{Series, SlipPiece, at};

/// Friction along a zone.
#[derive(Clone, Debug)]
pub(super) struct ZoneFriction {
    /// In the order of time, without gaps.
    pub(super) segments: Vec<SeriesSegment>,
    /// Mean of F over the zone.
    pub(super) force: f64,
    /// Mean of E over the zone.
    pub(super) drag: f64,
    /// Largest |E|/m_a: what is fast against it sees the mean.
    pub(super) steepest: f64,
    duration: f64,
    /// F and E at the beginning and at the end.
    ends: [[f64; 2]; 2],
    /// ∫(F + E) over the zone.
    pushed: f64,
    /// The transfers over the zone, where they have been expanded.
    propagators: OnceLock<BoundedPropagators>,
}

/// ∫ of a series from 0 to `to`.
fn integral(series: &Series, to: f64) -> f64 {
    let terms = series.iter().enumerate().rev();
    let sum = terms.fold(0.0, |sum, (n, term)| sum * to + term / (n as f64 + 1.0));
    sum * to
}

impl ZoneFriction {
    /// From the pieces of a zone, with ã, m_a, h and α.
    pub(super) fn new(pieces: Vec<SlipPiece>, [a, ma, h, alpha]: [f64; 4]) -> ZoneFriction {
        let mean = |of: fn(&SlipPiece) -> &Series| -> f64 {
            let duration: f64 = pieces.iter().map(|piece| piece.duration).sum();
            let sum: f64 = pieces
                .iter()
                .map(|piece| integral(of(piece), 1.0) * piece.duration)
                .sum();
            if duration > 0.0 { sum / duration } else { 0.0 }
        };
        let (force, drag) = (mean(|piece| &piece.force), mean(|piece| &piece.drag));
        let largest = |piece: &SlipPiece| piece.drag[0].abs().max(at(&piece.drag, 1.0).abs());
        let steepest = pieces.iter().map(largest).fold(0.0, f64::max) / ma;
        let duration = pieces
            .last()
            .map_or(0.0, |piece| piece.start + piece.duration);
        let segments = pieces
            .into_iter()
            .map(|piece| {
                let (force, drag) = (&piece.force, &piece.drag);
                // α − F − E
                let mut resistance: Series = std::array::from_fn(|n| -force[n] - drag[n]);
                resistance[0] += alpha;
                let mut linear: Series = std::array::from_fn(|n| -force[n] - a * drag[n]);
                linear[0] += a * alpha;
                let mut constant: Series = std::array::from_fn(|n| {
                    let square: f64 = (0..=n).map(|k| resistance[k] * resistance[n - k]).sum();
                    let next = resistance.get(n + 1).copied().unwrap_or(0.0);
                    0.25 * square + 0.5 * ma * (n as f64 + 1.0) * next / piece.duration
                });
                constant[0] -= ma * h;
                let over = |series: Series| series.map(|term| term / (ma * ma));
                let (linear, constant) = (over(linear), over(constant));
                let size = |series: &Series| series.iter().map(|term| term.abs()).sum();
                SeriesSegment {
                    sizes: [size(&linear), size(&constant)],
                    piece,
                    linear,
                    constant,
                }
            })
            .collect();
        let mut course = ZoneFriction {
            segments,
            force,
            drag,
            steepest,
            duration,
            ends: [[0.0; 2]; 2],
            pushed: 0.0,
            propagators: OnceLock::new(),
        };
        course.ends = [0.0, duration].map(|time| course.within(time));
        course.pushed = course.pushed_within(duration);
        course
    }

    /// Whether a time is the end of the zone, to rounding.
    fn is_end(&self, time: f64) -> bool {
        (time - self.duration).abs() <= 4.0 * f64::EPSILON * self.duration
    }

    /// Expands the transfer over the zone in λ, with q = ã/m_a².
    pub(super) fn expand(&self, square: f64) {
        self.propagators
            .get_or_init(|| BoundedPropagators::new(&self.segments, self.duration, square));
    }

    /// Carries z and z′ with their derivatives over the zone, see [`BoundedPropagators::carry`]; `None` where the time is not
    /// the whole of it, or its transfer has not been expanded.
    pub(super) fn propagate(&self, lambda: C64, time: f64, pairs: &mut [Pair]) -> Option<f64> {
        let propagators = self.propagators.get().filter(|_| self.is_end(time))?;
        propagators.carry(&self.segments, lambda, pairs)
    }

    /// F and E at a time.
    pub(super) fn at(&self, time: f64) -> [f64; 2] {
        if time == 0.0 {
            self.ends[0]
        } else if self.is_end(time) {
            self.ends[1]
        } else {
            self.within(time)
        }
    }

    fn within(&self, time: f64) -> [f64; 2] {
        let index = self
            .segments
            .partition_point(|segment| segment.piece.start <= time)
            .saturating_sub(1);
        self.segments.get(index).map_or([0.0; 2], |segment| {
            let piece = &segment.piece;
            let x = (time - piece.start) / piece.duration;
            [&piece.force, &piece.drag].map(|series| at(series, x))
        })
    }

    /// ∫(F + E) up to a time.
    pub(super) fn pushed(&self, time: f64) -> f64 {
        if self.is_end(time) {
            self.pushed
        } else {
            self.pushed_within(time)
        }
    }

    fn pushed_within(&self, time: f64) -> f64 {
        let parts = self.segments.iter().map(|segment| {
            let piece = &segment.piece;
            let share = ((time - piece.start) / piece.duration).clamp(0.0, 1.0);
            (integral(&piece.force, share) + integral(&piece.drag, share)) * piece.duration
        });
        parts.sum()
    }
}
