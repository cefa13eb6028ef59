//! Spectra along a branch, and the crossings between its points.
//!
//! Work is counted in eigenvalues, never in time. A run has an allowance of them, see [`ALLOWANCE`].

mod search;

use std::cell::Cell;
use std::sync::Arc;

use super::characteristic::Characteristic;
use super::spectrum::{Spectrum, SpectrumRequest, spectrum, symmetric};
use super::verdict::VerdictReason;
use crate::continuation::Node;
use crate::continuation::arclength::advance;
use crate::continuation::locate::node_at;
use crate::tube::model::signature::Regime;
use crate::tube::wave::Wave;

pub(crate) use search::follow;
use search::{CrossingSearch, MOST_HALVINGS, TrackEnd};

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

/// Eigenvalues of a spectrum, in all its sectors.
fn size(spectrum: &Spectrum) -> usize {
    let lists = spectrum.sectors.iter();
    lists.map(|sector| sector.eigenvalues.len()).sum()
}
