//! Spectra along a branch, and the crossings between its points.
//!
//! Between two points of one signature every eigenvalue near the imaginary axis is followed by
//! Newton's method from the one spectrum into the other. The change of the unstable count must
//! equal what crosses; where it does not, the interval is halved. A crossing is located in the
//! arclength s by the secant rule on Re λ(s), with the wave and the eigenvalue solved together at
//! every s.
//!
//! Work is counted in eigenvalues, never in time. A run has an allowance of them, see [`ALLOWANCE`].

use std::cell::Cell;
use std::sync::Arc;

use super::C64;
use super::characteristic::Characteristic;
use super::crossing::uncertainty;
use super::spectrum::{
    Spectrum, SpectrumRequest, WaveEigenvalue, beside_translation, margin, spectrum, symmetric,
};
use super::verdict::VerdictReason;
use crate::continuation::Node;
use crate::continuation::arclength::advance;
use crate::continuation::locate::node_at;
use crate::continuation::zero::{Bracket, Zero, zero};
use crate::tube::model::signature::Regime;
use crate::tube::wave::Wave;

/// Where an eigenvalue crosses the imaginary axis.
#[derive(Clone, Debug)]
pub struct AxisCrossing {
    /// Arclength from the beginning of the step.
    pub s: f64,
    /// The solution there, with the tangent.
    pub node: Node,
    /// Bloch sector j, 0 ≤ j ≤ k/2, of the eigenvalue.
    pub sector: usize,
    /// Im λ at the crossing: positive in sectors 0 and k/2, zero where a real eigenvalue crosses.
    pub omega: f64,
    /// Whether the eigenvalue becomes unstable along the branch.
    pub grows: bool,
    /// Estimated error of the scaled parameter.
    pub uncertainty: f64,
}

/// A crossing with the spectrum there.
pub type Crossing = (AxisCrossing, Spectrum);

/// What a step did to the spectrum.
#[derive(Clone, Debug, Default)]
pub struct Tracked {
    /// Crossings of the imaginary axis, in the order of arclength.
    pub crossings: Vec<Crossing>,
    /// Spectrum at each point found, in order; `None` where the wave could not be linearised.
    pub spectra: Vec<Option<Spectrum>>,
    /// What remains to be said: a jump at a change of regime, or a count that was lost.
    pub remark: Option<Remark>,
}

/// What remains to be said of the spectrum after a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Remark {
    /// More eigenvalues cross the axis than the allowance pays for.
    Unpaid,
    /// The count changes and the crossing was not located.
    Lost,
    /// The count jumps at a change of regime: unstable eigenvalues before and after it by sector.
    Jump {
        /// (Bloch sector, growing eigenvalues in it) before the change.
        before: Vec<(usize, usize)>,
        /// (Bloch sector, growing eigenvalues in it) after the change.
        after: Vec<(usize, usize)>,
    },
}

/// Growing eigenvalues of every sector within the window.
#[derive(Clone, Debug, PartialEq)]
pub struct GrowingEigenvalues {
    /// (Bloch sector, growing eigenvalues in it).
    counts: Vec<(usize, usize)>,
    mode: u32,
}

impl GrowingEigenvalues {
    /// Those of a spectrum.
    pub fn new(spectrum: &Spectrum) -> GrowingEigenvalues {
        let sectors = spectrum.sectors.iter();
        let counts = sectors.map(|sector| (sector.sector, spectrum.unstable_in(sector)));
        GrowingEigenvalues {
            counts: counts.collect(),
            mode: spectrum.mode,
        }
    }

    /// Passes a crossing of the imaginary axis. A complex pair of a sector that is its own conjugate counts twice.
    pub fn cross(&mut self, crossing: &AxisCrossing) {
        let pair = symmetric(crossing.sector, self.mode) && crossing.omega != 0.0;
        let members = if pair { 2 } else { 1 };
        let mut counts = self.counts.iter_mut();
        if let Some((_, count)) = counts.find(|(sector, _)| *sector == crossing.sector) {
            *count = match crossing.grows {
                true => *count + members,
                false => count.saturating_sub(members),
            };
        }
    }

    /// What the located crossings leave unexplained in every sector at the next point: eigenvalues that pass the edge
    /// of the window, or, where `is_lost`, a crossing that was not located.
    pub fn unexplained(&self, next: &GrowingEigenvalues, is_lost: bool) -> Vec<VerdictReason> {
        let pairs = self.counts.iter().zip(&next.counts);
        let differ = pairs.filter(|(before, here)| before.1 != here.1);
        let reasons = differ.map(|(&(sector, before), &(_, here))| VerdictReason::Count {
            sector,
            before,
            here,
            is_lost,
        });
        reasons.collect()
    }
}

/// A point that a step of the branch passes.
#[derive(Clone, Copy, Debug)]
pub struct PassedPoint<'a> {
    /// Arclength from the beginning of the step.
    pub s: f64,
    /// The boundary-value problem that it solves.
    pub wave: &'a Wave,
    /// Its solution, with the tangent.
    pub node: &'a Node,
    /// Whether it is a fold.
    pub folds: bool,
    /// The wave beyond a change of regime, and its solution.
    pub entered: Option<(&'a Wave, &'a Node)>,
}

/// Follows the spectrum along a branch.
#[derive(Clone, Debug)]
pub struct Tracker {
    request: SpectrumRequest,
    tolerance: f64,
    /// Spectrum at the point where the next step sets out.
    last: Option<Spectrum>,
    /// Eigenvalues that may still be computed; once it is zero no spectrum is taken.
    allowance: Cell<usize>,
}

/// Eigenvalues in closed form that a run may compute ahead of [`PER_POINT`]: a spectrum counts as many as it has,
/// the location of a crossing one for every step of the secant rule. A thousand take some hundredths
/// of a second.
pub(crate) const ALLOWANCE: usize = 300_000;

/// Eigenvalues that every point adds to the allowance, up to where it began: spectra of fewer never
/// use it up.
pub(crate) const PER_POINT: usize = 1000;

/// Halvings of an interval before a count is given up.
const DEEPEST: u32 = 24;

/// Real eigenvalues have |Im λ| below this, in units of 1/T; complex pairs separate like a square root
/// and pass it within 1e-14 of their collision.
const REAL: f64 = 1e-7;

/// Part of the first step beyond a change of regime at which its spectrum is first taken, and of the step to one where a
/// flight closes before which it is last taken: at the event itself a zone has no length and its jump is 0/0.
const BEYOND: f64 = 1e-3;

/// A flight shorter than this, in units of the period, is one without length: events are located to 1e-12.
const CLOSED: f64 = 1e-9;

/// Whether a flight has no length at a point.
fn has_closed_flight(wave: &Wave, node: &Node) -> bool {
    let closed = |zone: usize| {
        wave.signature.zone(zone).regime == Regime::Separation
            && wave.duration_at(&node.point, zone).abs() < CLOSED * wave.scales.time
    };
    (0..wave.zones()).any(closed)
}

/// Most halvings of one step: an interval whose counts do not agree at any depth is given up.
const MOST_HALVINGS: usize = 120;

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
struct TrackEnd {
    s: f64,
    spectrum: Spectrum,
    /// Its wave, linearised; `None` where the step sets out, to which nothing is followed.
    characteristic: Option<Arc<Characteristic>>,
}

/// A pair of ends of one eigenvalue, whose real parts have different signs.
#[derive(Clone, Copy, Debug)]
struct SignChange {
    sector: usize,
    from: C64,
    to: C64,
}

impl Tracker {
    /// A tracker that has seen nothing yet, or the spectrum `last`. `tolerance` is that of the waves,
    /// `allowance` the eigenvalues that may still be computed.
    pub fn new(
        request: SpectrumRequest,
        last: Option<Spectrum>,
        tolerance: f64,
        allowance: usize,
    ) -> Tracker {
        Tracker {
            request,
            tolerance,
            last,
            allowance: Cell::new(allowance),
        }
    }

    /// Eigenvalues that may still be computed.
    pub fn allowance(&self) -> usize {
        self.allowance.get()
    }

    fn spend(&self, eigenvalues: usize) {
        self.allowance
            .set(self.allowance.get().saturating_sub(eigenvalues));
    }

    /// Spectrum at the point from which the next step sets out.
    pub fn last(&self) -> Option<&Spectrum> {
        self.last.as_ref()
    }

    /// The spectrum of one wave; seeds are those of the last point.
    pub fn at(&self, wave: &Wave, node: &Node) -> Option<Spectrum> {
        self.spectrum_near(wave, node, self.last.as_ref())
    }

    fn spectrum_near(
        &self,
        wave: &Wave,
        node: &Node,
        seeds: Option<&Spectrum>,
    ) -> Option<Spectrum> {
        let (_, spectrum) = self.linearised_near(wave, node, seeds)?;
        Some(spectrum)
    }

    /// The linearisation of one wave and its spectrum.
    fn linearised_near(
        &self,
        wave: &Wave,
        node: &Node,
        seeds: Option<&Spectrum>,
    ) -> Option<(Characteristic, Spectrum)> {
        if self.allowance.get() == 0 {
            return None;
        }
        let characteristic = Characteristic::new(wave, &node.point).ok()?;
        let found = spectrum(&characteristic, &self.request, seeds);
        self.spend(size(&found) * characteristic.cost(self.request.max_frequency));
        (!found.sectors.is_empty()).then_some((characteristic, found))
    }

    /// The end of an interval at a node.
    fn end(&self, wave: &Wave, s: f64, node: &Node, seeds: Option<&Spectrum>) -> Option<TrackEnd> {
        let (characteristic, spectrum) = self.linearised_near(wave, node, seeds)?;
        Some(TrackEnd {
            s,
            spectrum,
            characteristic: Some(Arc::new(characteristic)),
        })
    }

    /// The first point of a leg. Where it is a change of regime and has no spectrum, the first step is
    /// followed from a little way into it.
    pub fn start(&mut self, wave: &Wave, node: &Node) -> Option<Spectrum> {
        // rounding alone gives a flight without length one
        let has_spectrum = !has_closed_flight(wave, node);
        let here = has_spectrum
            .then(|| self.spectrum_near(wave, node, None))
            .flatten();
        self.last = here.clone().or_else(|| self.beyond(wave, node, BEYOND));
        here
    }

    /// The spectrum at a small arclength beyond a node.
    fn beyond(&self, wave: &Wave, node: &Node, mut ds: f64) -> Option<Spectrum> {
        for _ in 0..6 {
            if let Ok(step) = advance(wave, node, &[], ds, self.tolerance) {
                return self.spectrum_near(wave, &step.node, self.last.as_ref());
            }
            ds *= 0.25;
        }
        None
    }

    /// The spectrum a little before a change of regime at an arclength from a node.
    fn short_of(&self, wave: &Wave, from: &Node, s: f64) -> Option<TrackEnd> {
        let s = (1.0 - BEYOND) * s;
        let node = node_at(wave, from, s, self.tolerance)?;
        self.end(wave, s, &node, self.last.as_ref())
    }

    /// The step from `from` through the points found.
    pub fn step(&mut self, wave: &Wave, from: &Node, found: &[PassedPoint]) -> Tracked {
        let mut tracked = Tracked::default();
        // the last point bounds the interval, or a change of regime: folds and user points are inside
        let entered = found.iter().find(|point| point.entered.is_some());
        let Some(end) = entered.or(found.last()) else {
            return tracked;
        };
        // the jump where a flight without length lands is 0/0, and rounding alone gives it a length
        let closes = end.entered.is_some() && has_closed_flight(wave, end.node);
        let reached = match closes {
            true => self.short_of(wave, from, end.s),
            false => self.end(wave, end.s, end.node, self.last.as_ref()),
        };
        if closes && reached.is_none() && self.last.is_some() {
            tracked.remark = Some(Remark::Lost);
        }
        if let (Some(before), Some(other), true) = (&self.last, &reached, end.s > 0.0) {
            let one = TrackEnd {
                s: 0.0,
                spectrum: before.clone(),
                characteristic: None,
            };
            let folds = found.iter().filter(|point| point.folds);
            let mut search = CrossingSearch {
                tracker: self,
                wave,
                from,
                folds: folds.map(|point| point.s).collect(),
                halvings: MOST_HALVINGS,
                reserve: self.allowance.get() / 2,
                short: false,
                lost: false,
                crossings: Vec::new(),
            };
            search.between(&one, other, 0);
            tracked.remark = search.lost.then_some(match search.short {
                true => Remark::Unpaid,
                false => Remark::Lost,
            });
            tracked.crossings = search.crossings;
        }
        let after = reached.map(|end| end.spectrum);
        tracked
            .crossings
            .sort_by(|(one, _), (other, _)| one.s.total_cmp(&other.s));
        tracked.spectra = found
            .iter()
            .map(|point| {
                if point.s == end.s {
                    after.clone().filter(|_| !closes)
                } else {
                    self.at(point.wave, point.node)
                }
            })
            .collect();
        self.last = after;
        if let Some((next, node)) = end.entered {
            let jump = self.enter(next, node, end.s);
            tracked.remark = jump.or(tracked.remark);
        }
        tracked
    }

    /// The spectrum just beyond a change of regime. Returns a remark where it is not the
    /// continuation of the one before.
    fn enter(&mut self, wave: &Wave, node: &Node, s: f64) -> Option<Remark> {
        let before = self.last.clone();
        // a little way into the new signature
        self.last = self.beyond(wave, node, BEYOND * s.abs().max(1e-3));
        let (before, after) = (before.as_ref()?, self.last.as_ref()?);
        let [before, after] =
            [before, after].map(|spectrum| GrowingEigenvalues::new(spectrum).counts);
        (before != after).then_some(Remark::Jump { before, after })
    }
}

/// The search for the crossings within one step.
struct CrossingSearch<'a> {
    tracker: &'a Tracker,
    wave: &'a Wave,
    /// Where the step sets out.
    from: &'a Node,
    folds: Vec<f64>,
    halvings: usize,
    /// Eigenvalues of the allowance that are kept for later steps.
    reserve: usize,
    /// Whether crossings were given up for want of work.
    short: bool,
    /// Whether crossings were given up.
    lost: bool,
    crossings: Vec<Crossing>,
}

impl CrossingSearch<'_> {
    /// Crossings between two ends of an interval.
    fn between(&mut self, one: &TrackEnd, other: &TrackEnd, depth: u32) {
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
                let index = reached.and_then(|value| {
                    // the list is sorted by falling Re λ
                    let list = &after.eigenvalues;
                    let first = list.partition_point(|known| known.re > value.re + SAME * rate);
                    list[first..]
                        .iter()
                        .take_while(|known| known.re >= value.re - SAME * rate)
                        .position(|known| (known.value() - value).norm() < SAME * rate)
                        .map(|index| first + index)
                });
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
            // real ones that meet go apart as a pair, and Newton's method loses them: what moves by less
            // than its distance from the axis does not cross
            gone.retain(|value| {
                let nearest = (0..taken.len())
                    .filter(|&index| !taken[index])
                    .map(|index| ((after.eigenvalues[index].value() - value).norm(), index))
                    .min_by(|one, other| one.0.total_cmp(&other.0));
                match nearest {
                    Some((distance, index)) if distance < 0.5 * value.re.abs() => {
                        taken[index] = true;
                        false
                    }
                    _ => true,
                }
            });
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
        // at a fold a real eigenvalue of sector 0 passes through zero: that is the fold itself
        let inside = |s: &&f64| **s > one.s && **s <= other.s;
        let mut left = self.folds.iter().filter(inside).count();
        changes.retain(|change| {
            let real = change.from.im.abs().max(change.to.im.abs()) < REAL * rate;
            if change.sector == 0 && real && left > 0 {
                left -= 1;
                return false;
            }
            true
        });
        Some(changes)
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

/// Eigenvalues of a spectrum, in all its sectors.
fn size(spectrum: &Spectrum) -> usize {
    let lists = spectrum.sectors.iter();
    lists.map(|sector| sector.eigenvalues.len()).sum()
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
