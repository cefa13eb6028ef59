//! The number of zeros in a window: the turns of F_j along its edge.

use std::f64::consts::TAU;

use super::{C64, Spectrum, WaveEigenvalue};
use crate::tube::stability::asymptotic::HighFrequency;
use crate::tube::stability::characteristic::{Characteristic, Value};

/// A box symmetric about the real axis, |Im λ| < top, or with bottom > 0 a band of its upper half.
#[derive(Clone, Copy, Debug)]
pub(super) struct SearchWindow {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
    pub(super) top: f64,
}

impl SearchWindow {
    pub(super) fn symmetric(left: f64, right: f64, top: f64) -> SearchWindow {
        SearchWindow {
            left,
            right,
            bottom: 0.0,
            top,
        }
    }

    /// Whether an upper half zero lies inside; zeros on the real axis may come out just below it.
    pub(super) fn contains(&self, zero: &WaveEigenvalue) -> bool {
        let low = if self.bottom > 0.0 {
            self.bottom
        } else {
            -self.top
        };
        zero.re > self.left && zero.re < self.right && zero.im > low && zero.im < self.top
    }
}

/// Bands are this many spacings of the longest delay's zeros high: a window with thousands of
/// zeros is counted and searched band by band, so that effort grows with their number.
pub(super) const BAND: f64 = 16.0;

/// An edge walk closer to a zero than this fraction of the window is given up and moved.
const SHORTEST_STEP: f64 = 1e-7;

/// Most samples of one walk.
const MOST_SAMPLES: usize = 200_000;

/// F_j at a sample, with the exponent that was taken out of it.
#[derive(Clone, Copy)]
pub(super) struct CharacteristicSample {
    pub(super) f: C64,
    pub(super) by: C64,
}

/// Samples of all multipliers at one λ.
pub(super) struct MultiplierSamples {
    pub(super) lambda: C64,
    pub(super) top: f64,
    /// |t| + |d|, or (|t′| + |d′|)/τ if that is more, on the scale of the samples.
    pub(super) size: f64,
    pub(super) samples: Vec<CharacteristicSample>,
}

/// The search for the zeros of one wave.
pub(super) struct ZeroSearch<'a> {
    pub(super) characteristic: &'a Characteristic,
    /// Longest delay: zeros follow one another in Im λ at 2π over it, or farther apart.
    pub(super) delay: f64,
    /// Spacing of the first grid: about two points from zero to zero.
    pub(super) spacing: f64,
    /// 1/T.
    pub(super) rate: f64,
    /// Sectors whose upper halves are needed: those asked for and their conjugates.
    pub(super) halves: Vec<usize>,
    pub(super) multipliers: Vec<C64>,
    /// The line on which |t| + |d| < 1 is known, if any.
    pub(super) edge: Option<Edge>,
}

/// The line Re λ = right, |Im λ| ≤ top.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub(super) right: f64,
    pub(super) top: f64,
}

/// Between samples F may differ from the cubic by this fraction of what the trapezoidal rule
/// misses, h³F‴/12: the estimate from F itself, for h⁴F⁗/384 ≤ (hτ/32)·h³F‴/12.
const MISSED: f64 = 0.25;

/// The same without an a-priori bound: all that the trapezoidal rule misses, twice.
const MISSED_WITHOUT_BOUND: f64 = 2.0;

/// The a-priori bound (hτ)⁴/384 of the size of t and d is taken with their size at the samples, times
/// this: paths that interfere there need not do so between.
const INTERFERENCE: f64 = 2.0;

impl ZeroSearch<'_> {
    pub(super) fn row(&self, lambda: C64) -> MultiplierSamples {
        let value = self.characteristic.evaluate(lambda);
        MultiplierSamples {
            lambda,
            top: value.top() + value.offset,
            size: value.scaled_size(self.delay),
            samples: self.samples(&value),
        }
    }

    pub(super) fn samples(&self, value: &Value) -> Vec<CharacteristicSample> {
        self.multipliers
            .iter()
            .map(|z| {
                let (f, by) = value.sector(*z);
                CharacteristicSample { f, by }
            })
            .collect()
    }

    /// Whether a step of the walk is safe in every sector.
    pub(super) fn safe(&self, one: &MultiplierSamples, other: &MultiplierSamples) -> bool {
        let h = other.lambda - one.lambda;
        // on the scale of `one`
        let factor = (other.top - one.top).exp();
        let square = h.norm_sqr() * self.delay * self.delay;
        let size = one.size.max(other.size * factor);
        // with β > 0 F is not of exponential type, and only the estimate from F itself is left
        let (share, bound) = if self.characteristic.beta > 0.0 {
            (MISSED_WITHOUT_BOUND, 0.0)
        } else {
            (MISSED, square * square / 384.0 * INTERFERENCE * size)
        };
        one.samples.iter().zip(&other.samples).all(|(a, b)| {
            let (fa, fb) = (a.f, b.f * factor);
            let (da, db) = (a.by * h, b.by * h * factor);
            let missed = (fa + (da + db) * 0.5 - fb).norm_sqr().sqrt();
            // control points of the cubic on the bisector of its ends: it lies in their hull
            let middle = fa * fb.norm_sqr().sqrt() + fb * fa.norm_sqr().sqrt();
            let along = |x: C64| x.re * middle.re + x.im * middle.im;
            let least = along(fa)
                .min(along(fb))
                .min(along(fa + da / 3.0))
                .min(along(fb - db / 3.0));
            least > (share * missed + bound) * middle.norm_sqr().sqrt()
        })
    }

    /// Turns of every F along the upper half of the edge of a symmetric box, or round a band, in
    /// radians; `None` if a zero is too near.
    pub(super) fn walk(&self, window: &SearchWindow) -> Option<Vec<f64>> {
        let mut corners = vec![
            C64::new(window.right, window.bottom),
            C64::new(window.right, window.top),
            C64::new(window.left, window.top),
            C64::new(window.left, window.bottom),
        ];
        if window.bottom > 0.0 {
            corners.push(corners[0]);
        }
        let mut turns = vec![0.0; self.halves.len()];
        let shortest = SHORTEST_STEP * (window.top - window.bottom + window.right - window.left);
        let first = self.spacing;
        let mut last = self.row(corners[0]);
        let mut used = 0;
        if let Some(edge) = self.edge
            && edge.right == window.right
            && window.bottom < edge.top
        {
            // |F − 1| < 1 so far
            let next = self.row(C64::new(edge.right, edge.top.min(window.top)));
            for (turn, (a, b)) in turns.iter_mut().zip(last.samples.iter().zip(&next.samples)) {
                *turn += (b.f / a.f).arg();
            }
            corners[0] = next.lambda;
            last = next;
        }
        for pair in corners.windows(2) {
            if pair[0] == pair[1] {
                continue;
            }
            let length = (pair[1] - pair[0]).norm();
            let pieces = (length / first).ceil().max(1.0) as usize;
            let mut waiting: Vec<MultiplierSamples> = Vec::new();
            for piece in 1..=pieces {
                let share = piece as f64 / pieces as f64;
                waiting.push(self.row(pair[0] + (pair[1] - pair[0]) * share));
                while let Some(next) = waiting.pop() {
                    used += 1;
                    if used > MOST_SAMPLES {
                        return None;
                    }
                    if self.safe(&last, &next) {
                        for (turn, (a, b)) in
                            turns.iter_mut().zip(last.samples.iter().zip(&next.samples))
                        {
                            *turn += (b.f / a.f).arg();
                        }
                        last = next;
                    } else {
                        let step = next.lambda - last.lambda;
                        if step.norm().is_nan() || step.norm() < shortest {
                            return None;
                        }
                        let middle = self.row(last.lambda + step * 0.5);
                        waiting.push(next);
                        waiting.push(middle);
                    }
                }
            }
        }
        Some(turns)
    }

    pub(super) fn conjugate(&self, sector: usize) -> usize {
        let mode = self.characteristic.mode as usize;
        (mode - sector % mode) % mode
    }

    pub(super) fn index(&self, sector: usize) -> Option<usize> {
        self.halves.iter().position(|half| *half == sector)
    }

    /// Number of zeros of F_j in the whole box; `None` if the turns are not whole.
    pub(super) fn count(&self, turns: &[f64], sector: usize) -> Option<usize> {
        whole(turns[self.index(sector)?] + turns[self.index(self.conjugate(sector))?])
    }

    /// A search of a band; where a zero sits on its upper edge, the edge is moved.
    pub(super) fn moved<T>(
        &self,
        band: &mut SearchWindow,
        search: impl Fn(&SearchWindow) -> Option<T>,
    ) -> Option<T> {
        const MOVES: usize = 6;
        for _ in 0..MOVES {
            if let Some(found) = search(band) {
                return Some(found);
            }
            band.top += 0.137 * self.spacing;
        }
        None
    }

    /// Zeros right of the imaginary axis up to the largest frequency that counts, sector by sector,
    /// counted without being found; `None` where they are too many, or one is too near an edge. At
    /// low frequency the axis itself holds the translation mode: beside it the list serves.
    pub(super) fn growing(&self, spectrum: &Spectrum) -> Option<Vec<usize>> {
        /// Most bands: a walk round each takes about a millisecond.
        const MOST_BANDS: f64 = 1000.0;
        let (right, top) = (spectrum.right, spectrum.max_frequency);
        let height = BAND * TAU / self.delay;
        if top > MOST_BANDS * height {
            return None;
        }
        let beside = 0.01 * self.spacing;
        let mut band = SearchWindow::symmetric(beside, right, top.min(height));
        let turns = self.moved(&mut band, |band| self.walk(band))?;
        let mut counts = Vec::with_capacity(spectrum.sectors.len());
        for sector in &spectrum.sectors {
            let listed = |one: &&WaveEigenvalue| {
                one.re > spectrum.axis && one.re <= beside && one.im.abs() < band.top
            };
            let near = sector.eigenvalues.iter().filter(listed);
            let near: usize = near.map(|one| one.multiplicity).sum();
            counts.push(near + self.count(&turns, sector.sector)?);
        }
        while band.top < top {
            band = SearchWindow {
                left: 0.0,
                right,
                bottom: band.top,
                top: top.min(band.top + height),
            };
            let turns = if band.top < top {
                self.moved(&mut band, |band| self.walk(band))?
            } else {
                self.walk(&band)?
            };
            for (count, sector) in counts.iter_mut().zip(&spectrum.sectors) {
                for half in [sector.sector, self.conjugate(sector.sector)] {
                    *count += whole(turns[self.index(half)?])?;
                }
            }
        }
        Some(counts)
    }
}

/// Turns as a number of zeros; `None` if they are not whole.
pub(super) fn whole(turn: f64) -> Option<usize> {
    let zeros = turn / TAU;
    ((zeros - zeros.round()).abs() < 1e-6 && zeros > -0.5).then(|| zeros.round() as usize)
}

/// A right edge beyond which |t| + |d| < 1: no zero lies there. False if it was not found.
pub(super) fn right_edge(search: &ZeroSearch, high: &HighFrequency, top: f64) -> (f64, bool) {
    let characteristic = search.characteristic;
    // in the limit, room for samples at about twice 1/τ
    let room = 1.5 / search.delay;
    let beyond = |rho: f64| high.size(rho) + room * high.slope(rho) < EDGE;
    let mut right = 0.4 / characteristic.period;
    while right > 0.5 * search.spacing && beyond(right / 1.5) {
        right /= 1.5;
    }
    for _ in 0..60 {
        let clear = beyond(right)
            && if characteristic.beta > 0.0 {
                // six samples for a turn of the longest delay
                let samples = (top * search.delay).ceil().max(8.0) as usize;
                (0..=samples).all(|index| {
                    let im = top * index as f64 / samples as f64;
                    characteristic.evaluate(C64::new(right, im)).size() < EDGE
                })
            } else {
                clear_line(search, right, top)
            };
        if clear {
            return (right, true);
        }
        right *= 1.5;
    }
    (right, false)
}

/// Whether |t| + |d| stays below 1 on the line Re λ = right up to a height: every sample says so for
/// as far as |t′| + |d′| and the second derivatives cannot bring it to `EDGE`, and these reaches cover
/// the line. Of functions of exponential type τ that stay below 1, the latter are below τ²
/// (Bernstein).
fn clear_line(search: &ZeroSearch, right: f64, top: f64) -> bool {
    /// A line whose samples reach less far than this fraction of 1/τ is given up.
    const LEAST: f64 = 0.02;
    let delay = search.delay;
    let reach = |im: f64| {
        let value = search.characteristic.evaluate(C64::new(right, im));
        // of |t| + |d| + (|t′| + |d′|)r + (τr)²/2 = EDGE
        let slope = value.slope() / delay;
        ((slope * slope + 2.0 * (EDGE - value.size())).sqrt() - slope) / delay
    };
    let enough = |reach: f64| reach > LEAST / delay;
    let mut covered = reach(0.0);
    if !enough(covered) {
        return false;
    }
    let mut step = covered;
    while covered < top {
        let at = (covered + step).min(top);
        let here = reach(at);
        if !enough(here) {
            return false;
        }
        if at - here <= covered {
            covered = at + here;
            step = here.min(2.0 / delay);
        } else {
            step *= 0.5;
        }
    }
    true
}

/// |t| + |d| stays below this on the right edge.
pub(super) const EDGE: f64 = 0.95;
