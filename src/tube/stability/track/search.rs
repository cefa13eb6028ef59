//! The crossings of the imaginary axis within one step of a branch.
//!
//! Between two ends of an interval every eigenvalue near the axis is followed by Newton's method from the one spectrum into the
//! other. The change of the unstable count must equal what crosses; where it does not, the interval is halved. A crossing is
//! located in the arclength s by the secant rule on Re λ(s), with the wave and the eigenvalue solved together at every s.

use std::sync::Arc;

use super::{AxisCrossing, Crossing, Tracker, size};
use crate::continuation::Node;
use crate::continuation::locate::node_at;
use crate::continuation::zero::{Bracket, Zero, zero};
use crate::tube::stability::C64;
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::crossing::uncertainty;
use crate::tube::stability::spectrum::{Spectrum, WaveEigenvalue, beside_translation, margin};
use crate::tube::wave::Wave;

/// Halvings of an interval before a count is given up.
const DEEPEST: u32 = 24;

/// Real eigenvalues have |Im λ| below this, in units of 1/T; complex pairs separate like a square root
/// and pass it within 1e-14 of their collision.
const REAL: f64 = 1e-7;

/// Most halvings of one step: an interval whose counts do not agree at any depth is given up.
pub(super) const MOST_HALVINGS: usize = 120;

/// Real eigenvalues of sector 0 closer to λ = 0 than this, in units of 1/T, are followed by a function
/// that the translation mode is taken out of: at a fold one passes through it.
const NEXT_TO_TRANSLATION: f64 = 0.1;

/// Eigenvalues with Re λ below minus this over the period are not followed: none crosses the
/// imaginary axis in a step without coming near first, which the count would show.
const NEAR: f64 = 0.44;

/// Values closer than this, in units of 1/T, are one eigenvalue.
const SAME: f64 = 1e-8;

/// Eigenvalues are accounted for down to this fraction of that depth, or of the window's: those
/// below may have passed its left edge.
const ACCOUNTED: f64 = 0.5;

/// Rounding of λ, relative to its size.
const ROUNDING: f64 = 1e-14;

/// One end of an interval.
#[derive(Clone, Debug)]
pub(super) struct TrackEnd {
    pub(super) s: f64,
    pub(super) spectrum: Spectrum,
    /// Its wave, linearised; `None` where the step sets out, to which nothing is followed.
    pub(super) characteristic: Option<Arc<Characteristic>>,
}

/// A pair of ends of one eigenvalue, whose real parts have different signs.
#[derive(Clone, Copy, Debug)]
struct SignChange {
    sector: usize,
    from: C64,
    to: C64,
}

/// The search for the crossings within one step.
pub(super) struct CrossingSearch<'a> {
    pub(super) tracker: &'a Tracker,
    pub(super) wave: &'a Wave,
    /// Where the step sets out.
    pub(super) from: &'a Node,
    pub(super) folds: Vec<f64>,
    pub(super) halvings: usize,
    /// Eigenvalues of the allowance that are kept for later steps.
    pub(super) reserve: usize,
    /// Whether crossings were given up for want of work.
    pub(super) short: bool,
    /// Whether crossings were given up.
    pub(super) lost: bool,
    pub(super) crossings: Vec<Crossing>,
}

impl CrossingSearch<'_> {
    /// Crossings between two ends of an interval.
    pub(super) fn between(&mut self, one: &TrackEnd, other: &TrackEnd, depth: u32) {
        let left = |search: &Self| {
            search
                .tracker
                .allowance
                .get()
                .saturating_sub(search.reserve)
        };
        if let Some(changes) = self.changes(one, other) {
            // every crossing has a spectrum of its own: where there is no work for all, none is located
            let cost = size(&one.spectrum).max(1);
            if !changes.is_empty() && changes.len().saturating_mul(cost) > left(self) {
                (self.short, self.lost) = (true, true);
                return;
            }
            if let Some(found) = self.crossings(one, other, &changes) {
                self.crossings.extend(found);
                return;
            }
        }
        let work = left(self) > 0;
        self.short |= !work;
        let half = (depth < DEEPEST && self.halvings > 0 && work)
            .then(|| self.end_at(0.5 * (one.s + other.s), one))
            .flatten();
        self.halvings = self.halvings.saturating_sub(1);
        let Some(half) = half else {
            self.lost = true;
            return;
        };
        self.between(one, &half, depth + 1);
        self.between(&half, other, depth + 1);
    }

    /// An end of an interval at an arclength; seeds of its spectrum are those of another end.
    fn end_at(&self, s: f64, near: &TrackEnd) -> Option<TrackEnd> {
        let node = node_at(self.wave, self.from, s, self.tracker.tolerance)?;
        self.tracker.end(self.wave, s, &node, Some(&near.spectrum))
    }

    /// The crossings of these changes within the window, with their spectra; `None` if one is not located.
    fn crossings(
        &self,
        one: &TrackEnd,
        other: &TrackEnd,
        changes: &[SignChange],
    ) -> Option<Vec<Crossing>> {
        // spectra only once all are located: one that fails has the interval halved
        let located = changes.iter().map(|change| self.locate(one, other, change));
        let located: Vec<AxisCrossing> = located.collect::<Option<_>>()?;
        let tracker = self.tracker;
        let within =
            |crossing: &AxisCrossing| crossing.omega.abs() <= tracker.request.max_frequency;
        let with_spectrum = |located: AxisCrossing| {
            let seeds = Some(&one.spectrum);
            let spectrum = tracker.spectrum_near(self.wave, &located.node, seeds)?;
            Some((located, spectrum))
        };
        located
            .into_iter()
            .filter(within)
            .map(with_spectrum)
            .collect()
    }

    /// The eigenvalues that change the sign of their real part between two ends; `None` where
    /// following them does not account for the change of the count.
    fn changes(&self, one: &TrackEnd, other: &TrackEnd) -> Option<Vec<SignChange>> {
        let characteristic = other.characteristic.as_deref()?;
        let mut changes = Vec::new();
        let depth = (one.spectrum.left.max(other.spectrum.left)).max(-NEAR / characteristic.period);
        let accounted = ACCOUNTED * depth;
        let rate = characteristic.period.recip();
        let request = &self.tracker.request;
        let margin = margin(request, characteristic);
        let highest = |spectrum: &Spectrum| (spectrum.top - margin).min(request.max_frequency);
        // by their signs alone: to count from any threshold would lose what crosses between it and the
        // axis; but rounding of what stays on the axis is no crossing
        let axis = one.spectrum.axis.max(other.spectrum.axis);
        let crosses = |from: &WaveEigenvalue, to: &WaveEigenvalue| {
            (from.re > 0.0) != (to.re > 0.0) && from.re.abs().max(to.re.abs()) > axis
        };
        for (before, after) in one.spectrum.sectors.iter().zip(&other.spectrum.sectors) {
            let symmetric = one.spectrum.symmetric(before.sector);
            let relevant = |eigenvalue: &&WaveEigenvalue| eigenvalue.re > depth;
            let mut taken = vec![false; after.eigenvalues.len()];
            let mut gone = Vec::new();
            for start in before.eigenvalues.iter().filter(relevant) {
                let reached = reach(characteristic, before.sector, start.value());
                let index =
                    reached.and_then(|value| position(&after.eigenvalues, value, SAME * rate));
                match index {
                    Some(index) if !taken[index] => {
                        taken[index] = true;
                        let end = &after.eigenvalues[index];
                        // of a conjugate pair only the upper member is reported
                        let upper = !symmetric || start.im >= 0.0 || start.im.abs() < REAL * rate;
                        if crosses(start, end) && upper {
                            changes.push(SignChange {
                                sector: before.sector,
                                from: start.value(),
                                to: end.value(),
                            });
                        }
                    }
                    // it may have left through the upper edge
                    _ if start.im.abs() > highest(&one.spectrum) => {}
                    _ if start.re > accounted => gone.push(start.value()),
                    _ => {}
                }
            }
            Self::forget_met(&mut gone, &mut taken, &after.eigenvalues);
            // unstable eigenvalues that nothing has led to must have come in through the edge
            let strangers = after
                .eigenvalues
                .iter()
                .zip(&taken)
                .filter(|(eigenvalue, taken)| {
                    !**taken
                        && eigenvalue.re > accounted
                        && eigenvalue.im.abs() < highest(&other.spectrum) + 0.5 * margin
                })
                .count();
            if !gone.is_empty() || strangers > 0 {
                return None;
            }
        }
        self.without_folds(&mut changes, one.s, other.s, rate);
        Some(changes)
    }

    /// Takes out those that meet on the real axis: they go apart as a pair, and Newton's method loses them. What moves by less than
    /// its distance from the axis does not cross.
    fn forget_met(gone: &mut Vec<C64>, taken: &mut [bool], after: &[WaveEigenvalue]) {
        gone.retain(|value| {
            let nearest = (0..taken.len())
                .filter(|&index| !taken[index])
                .map(|index| ((after[index].value() - value).norm(), index))
                .min_by(|one, other| one.0.total_cmp(&other.0));
            match nearest {
                Some((distance, index)) if distance < 0.5 * value.re.abs() => {
                    taken[index] = true;
                    false
                }
                _ => true,
            }
        });
    }

    /// Takes out what passes through zero at a fold, a real eigenvalue of sector 0: that is the fold itself.
    fn without_folds(&self, changes: &mut Vec<SignChange>, from: f64, to: f64, rate: f64) {
        let inside = |s: &&f64| **s > from && **s <= to;
        let mut left = self.folds.iter().filter(inside).count();
        changes.retain(|change| {
            let real = change.from.im.abs().max(change.to.im.abs()) < REAL * rate;
            if change.sector == 0 && real && left > 0 {
                left -= 1;
                return false;
            }
            true
        });
    }

    /// The zero of Re λ(s) between two ends.
    fn locate(
        &self,
        one: &TrackEnd,
        other: &TrackEnd,
        change: &SignChange,
    ) -> Option<AxisCrossing> {
        // places and eigenvalues on both sides
        let (mut low, mut high) = ((one.s, change.from), (other.s, change.to));
        let at = |s: f64| {
            self.tracker.spend(1);
            let width = high.0 - low.0;
            let share = if width > 0.0 {
                (s - low.0) / width
            } else {
                0.0
            };
            let guess = low.1 + (high.1 - low.1) * share;
            let node = node_at(self.wave, self.from, s, self.tracker.tolerance).ok_or(())?;
            let characteristic = Characteristic::new(self.wave, &node.point).map_err(|_| ())?;
            let value = reach(&characteristic, change.sector, guess).ok_or(())?;
            let rate = characteristic.period.recip();
            // another eigenvalue was caught
            if (value - guess).norm() > 0.5 * (high.1 - low.1).norm() + SAME * rate {
                return Err(());
            }
            let size = rate + value.norm();
            let real = value.im.abs() < REAL * rate;
            let side = if (value.re > 0.0) == (low.1.re > 0.0) {
                &mut low
            } else {
                &mut high
            };
            *side = (s, value);
            let rounded = value.re.abs() <= 4.0 * f64::EPSILON * size || width <= 1e-15 * other.s;
            let re = if rounded { 0.0 } else { value.re };
            Ok((re, (node, value, size, real)))
        };
        let ends = Bracket::new((one.s, change.from.re), (other.s, change.to.re));
        let Zero {
            place: s, found, ..
        } = zero(ends, 0.0, at).ok()?;
        let (node, value, size, real) = found;
        let rounding = value.re.abs() + ROUNDING * size;
        let uncertainty = uncertainty(self.wave, &node.point, change.sector, value, rounding);
        let symmetric = one.spectrum.symmetric(change.sector);
        Some(AxisCrossing {
            s,
            uncertainty: uncertainty.unwrap_or(f64::NAN),
            node,
            sector: change.sector,
            omega: match (real, symmetric) {
                (true, true) => 0.0,
                (false, true) => value.im.abs(),
                _ => value.im,
            },
            grows: change.to.re > change.from.re,
        })
    }
}

/// The eigenvalue of a sector that a value known nearby leads to.
fn reach(characteristic: &Characteristic, sector: usize, start: C64) -> Option<C64> {
    let rate = characteristic.period.recip();
    if sector == 0 && start.im.abs() < REAL * rate && start.re.abs() < NEXT_TO_TRANSLATION * rate {
        let within = 3.0 * NEXT_TO_TRANSLATION;
        return beside_translation(characteristic, start.re, within).map(C64::from);
    }
    follow(characteristic, characteristic.multiplier(sector), start)
}

/// Newton's method on F_j, z = e^{2πij/k}, from a value known nearby. `None` where it leads away by more than
/// half a period's rate in one step.
pub(crate) fn follow(characteristic: &Characteristic, z: C64, start: C64) -> Option<C64> {
    /// A step below this, in units of 1/T, is the last but one: the next is its square.
    const ARRIVED: f64 = 1e-9;
    let mut value = start;
    let longest = 0.5 / characteristic.period;
    for _ in 0..20 {
        let (f, by) = characteristic.evaluate(value).sector(z);
        let step = f / by;
        let size = step.norm();
        if !size.is_finite() || size > longest {
            return None;
        }
        value -= step;
        if size * characteristic.period < ARRIVED {
            let (f, by) = characteristic.evaluate(value).sector(z);
            return Some(value - f / by);
        }
    }
    None
}

/// The place of a value in a list that is sorted by falling Re λ.
fn position(list: &[WaveEigenvalue], value: C64, within: f64) -> Option<usize> {
    let first = list.partition_point(|known| known.re > value.re + within);
    list[first..]
        .iter()
        .take_while(|known| known.re >= value.re - within)
        .position(|known| (known.value() - value).norm() < within)
        .map(|index| first + index)
}
