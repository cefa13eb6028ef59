//! Every inequality of every zone, verified over the whole zone up to rounding, and the margins left.
//!
//! The functions that must keep their sign — 1 − W in slip, W − 1 in reverse slip, P in contact,
//! U − δ in separation — are components of linear flows. In contact all of them are monotone
//! between the zeros of V̈, which are known in closed form. A separation zone is cut into pieces of
//! at most one radian; on each piece the Taylor polynomial of U and its Bernstein coefficients
//! tell the sign ([`crate::orbit::sign`]) and locate every local minimum.
//!
//! A *margin* is a smooth function of the unknowns that is positive while the signature holds:
//! durations, the least values just named, and the conditions of the switching table. The margin
//! that reaches zero first names the event.

use crate::continuation::zero::zero_by_slope;
use crate::linalg::Vector;
use crate::orbit::sign::{Bernstein, COEFFICIENTS, SignVerdict};
use crate::tube::flow::jet::Jet;
use crate::tube::flow::piece::{horner, horner_curvature, horner_slope};
use crate::tube::flow::{FlowError, Slide, SlidingFlow};
use crate::tube::model::signature::{Regime, ZoneEntry};

pub use super::margin::{MarginConstraint, RegimeMargin, WaveWatch};
use super::margin::{edge_margin, edge_margins, interior_margin};
use super::{Wave, WaveAt};

/// Which inequalities of a signature a wave keeps, by [`examine`].
#[derive(Clone, Debug)]
pub struct WaveExamination {
    /// All margins, in the order of the zones.
    pub margins: Vec<RegimeMargin>,
    /// Whether every inequality holds everywhere.
    pub verdict: SignVerdict,
    /// Least pressure over the zones in contact; infinite if there is none.
    pub least_pressure: f64,
    /// Largest U − δ over the separation zones, in units of R; 0 if there is none.
    pub largest_gap: f64,
    /// Smallest and largest V over the wave, in units of R.
    pub tangential: (f64, f64),
}

/// Collects what the pieces of one zone show.
struct Collector<'a> {
    at: &'a WaveAt<'a>,
    examination: WaveExamination,
}

impl Collector<'_> {
    fn margin(
        &mut self,
        watch: WaveWatch,
        zone: usize,
        time: f64,
        [mut jet, mut beyond]: [Jet; 2],
    ) {
        self.at.wave.scale(&mut jet, zone);
        self.at.wave.scale(&mut beyond, zone + 1);
        if let Some(known) = self
            .examination
            .margins
            .iter_mut()
            .find(|margin| margin.watch == watch && margin.zone == zone)
        {
            if jet.value < known.jet.value {
                known.time = time;
                known.jet = jet;
                known.beyond = beyond;
            }
            return;
        }
        self.examination.margins.push(RegimeMargin {
            watch,
            zone,
            time,
            jet,
            beyond,
        });
    }

    fn judge(&mut self, verdict: SignVerdict) {
        self.examination.verdict = self.examination.verdict.and(verdict);
    }

    fn visit(&mut self, v: f64) {
        let (low, high) = self.examination.tangential;
        self.examination.tangential = (low.min(v), high.max(v));
    }
}

/// Examines a point whatever its signature. Zones of negative duration are refused as such and
/// not looked into.
pub fn examine(wave: &Wave, point: &Vector) -> Result<WaveExamination, FlowError> {
    let at = &wave.at(point)?;
    let flows = &at.flows;
    let mut collector = Collector {
        at,
        examination: WaveExamination {
            margins: Vec::with_capacity(4 * wave.zones()),
            verdict: SignVerdict::Positive,
            least_pressure: f64::INFINITY,
            largest_gap: 0.0,
            tangential: (f64::INFINITY, f64::NEG_INFINITY),
        },
    };
    let kappa = flows.frame.at.kappa;
    if kappa.is_nan() || kappa <= 0.0 {
        let jet = edge_margin(at, 0, WaveWatch::Coupling)?;
        collector.judge(SignVerdict::Negative);
        collector.margin(WaveWatch::Coupling, 0, 0.0, jet);
    }
    for index in 0..wave.zones() {
        let entry = wave.entry_at(point, index);
        let duration = wave.duration_at(point, index);
        let regime = wave.signature.zone(index).regime;
        for margin in edge_margins(at, index)? {
            let positive = if margin.1[0].value > 0.0 {
                SignVerdict::Positive
            } else {
                SignVerdict::Negative
            };
            collector.judge(positive);
            collector.margin(margin.0, index, 0.0, margin.1);
        }
        if duration.is_nan() || duration <= 0.0 {
            continue;
        }
        match regime {
            Regime::Stick => {
                let pressure = flows.frame.weight().value + flows.frame.at.kappa;
                let least = collector.examination.least_pressure;
                collector.examination.least_pressure = least.min(pressure);
                collector.visit(entry[0] + flows.frame.steady().value);
                collector.visit(entry[0] + duration + flows.frame.steady().value);
            }
            Regime::Slip | Regime::Reverse | Regime::Contact => {
                contact_zone(&mut collector, index)?;
            }
            Regime::Separation => {
                separation_zone(&mut collector, index)?;
            }
        }
    }
    Ok(collector.examination)
}

/// A zero of V̈ closer to an arrest than this, in units of the period, is the arrest itself if W − 1
/// is of the order of its square there.
const AT_ARREST: f64 = 1e-5;

/// A contact zone. W is monotone between the zeros of V̈, which are known in closed form (by a
/// numerical method, as far as its samples show them): its values there and at the ends decide
/// every inequality. Where W = 1 or P = 0 by the switching
/// conditions, the end itself says nothing, and monotonicity does the rest.
fn contact_zone(collector: &mut Collector, index: usize) -> Result<(), FlowError> {
    let WaveAt { wave, flows, .. } = collector.at;
    let slide = &collector.at.slide(index);
    let Slide {
        entry, duration, ..
    } = *slide;
    let zone = wave.signature.zone(index);
    let takes_off = wave.signature.zone(index + 1).entry == ZoneEntry::TakeOff;
    let arrested = wave.signature.zone(index + 1).entry == ZoneEntry::Arrest;
    let flow = flows.contact(zone.regime);
    let sigma = if zone.regime == Regime::Reverse {
        -1.0
    } else {
        1.0
    };
    let weight = flows.frame.weight().value;
    let kappa = flows.frame.at.kappa;
    let steady = flows.frame.steady().value;
    let order = wave.order_at_entry(zone.entry);
    let mut least_pressure = f64::INFINITY;
    // a smooth law has no direction of sliding to keep
    let mut decided = zone.regime == Regime::Contact;
    let mut press = |collector: &mut Collector, at_end: bool, drive: f64| {
        // with material damping P jumps to 0 from a positive value, of the order of β
        if at_end && takes_off && flows.frame.at.material <= 0.0 {
            least_pressure = least_pressure.min(0.0);
            return;
        }
        let pressure = weight + kappa * drive;
        least_pressure = least_pressure.min(pressure);
        if pressure.is_nan() || pressure <= 0.0 {
            collector.judge(SignVerdict::Negative);
        }
    };
    let mut slide_on = |collector: &mut Collector, at_start: bool, at_end: bool, w: f64| {
        let known = at_start && order > 0 || at_end && !takes_off;
        if !known && zone.regime != Regime::Contact {
            decided = true;
            let lag = sigma * (1.0 - w);
            if lag.is_nan() || lag <= 0.0 {
                collector.judge(SignVerdict::Negative);
            }
        }
    };
    let drive = |time: f64, state: [f64; 2]| flow.drive(slide, time, state);
    press(collector, false, drive(0.0, entry));
    slide_on(collector, true, false, entry[1]);
    let turning_points = flow.turning_points(slide, order == 2)?;
    // with one extreme between two ends at W = 1 its sign is that of V̈ at the entry, where W − 1 is
    // lost in rounding: a zone opens like T², with material damping like T³
    let single = order == 1 && !takes_off && turning_points.len() == 1;
    for time in turning_points {
        let state = flow.state(slide, time)?;
        // where the stick zone has no length V̈ vanishes at the end too, but for rounding
        let at_end = duration - time < AT_ARREST * wave.scales.time;
        if order == 2 && arrested && at_end && (state[1] - 1.0).abs() < AT_ARREST * AT_ARREST {
            continue;
        }
        if single && (wave.material || (state[1] - 1.0).abs() < LOST) {
            let rise = flow.acceleration(slide, 0.0, entry);
            slide_on(collector, false, false, 1.0 + rise.signum());
        } else {
            slide_on(collector, false, false, state[1]);
        }
        press(collector, false, drive(time, state));
        let maximum = flow.jerk(slide, time, state) < 0.0;
        if zone.regime != Regime::Contact && maximum == (sigma > 0.0) {
            interior(collector, WaveWatch::Rate, index, time)?;
        }
        if !maximum && zone.regime != Regime::Reverse && !wave.material {
            interior(collector, WaveWatch::Pressure, index, time)?;
        }
    }
    if let SlidingFlow::Material(material) = flow {
        for time in material.pressure_extremes(slide) {
            press(collector, false, drive(time, flow.state(slide, time)?));
            if material.pressure_bends_up(slide, time) {
                interior(collector, WaveWatch::Pressure, index, time)?;
            }
        }
    }
    let end = flow.state(slide, duration)?;
    press(collector, true, drive(duration, end));
    slide_on(collector, false, true, end[1]);
    if !decided {
        // both ends at W = 1 and nothing between them: the zone has no room
        collector.judge(SignVerdict::Undecided);
    }
    let known = collector.examination.least_pressure;
    collector.examination.least_pressure = known.min(least_pressure);
    collector.visit(entry[0] + steady);
    for time in flow.extremes(slide)? {
        collector.visit(flow.state(slide, time)?[0] + steady);
    }
    collector.visit(end[0] + steady);
    Ok(())
}

/// W − 1 below this may be rounding: W is of order one where it passes 1, and at the stiff end of the
/// slow waves it is known to 1e-12 only.
const LOST: f64 = 1e-10;

/// A zone of more radians than this is refused: no wave of interest has it, and its examination
/// would take longer than a second.
const MOST_PIECES: f64 = 1e5;

fn separation_zone(collector: &mut Collector, index: usize) -> Result<(), FlowError> {
    /// With material damping U̇ = 0 at the end: an extreme closer to it than this part of the last
    /// piece is the end.
    const AT_LANDING: f64 = 1e-3;
    let WaveAt { wave, flows, .. } = collector.at;
    let slide = &collector.at.slide(index);
    let Slide {
        entry, duration, ..
    } = *slide;
    let flow = flows.separation();
    let steady = flows.frame.steady().value;
    let layered = flow.layered()?.is_some();
    let radians = flow.norm() * duration;
    if radians.is_nan() || radians > MOST_PIECES {
        return Err(FlowError::Winding {
            duration,
            radians,
            most: MOST_PIECES,
        });
    }
    let order = wave.order_at_entry(wave.signature.zone(index).entry);
    let pieces = flow.pieces(&flows.frame, slide, order)?;
    let at_landing = if layered { 2 } else { 1 };
    let mut falling = false;
    let mut rising = false;
    collector.visit(entry[0] + steady);
    let count = pieces.len();
    for (piece, taylor) in pieces.into_iter().enumerate() {
        let order = if piece == 0 { order } else { 0 };
        let last = piece + 1 == count;
        let gap = Bernstein::from_taylor(&taylor.gap, taylor.remainder);
        collector.judge(gap.verdict(order, if last { at_landing } else { 0 }));
        for place in gap.minima(&mut falling) {
            if layered && last && place > 1.0 - AT_LANDING {
                continue;
            }
            let time = taylor.start + place * taylor.length;
            interior(collector, WaveWatch::Gap, index, time)?;
        }
        for place in gap.affine(-1.0, 0.0).minima(&mut rising) {
            let known = collector.examination.largest_gap;
            collector.examination.largest_gap = known.max(horner(&taylor.gap, place));
        }
        for place in tangential_extremes(&taylor.tangential) {
            collector.visit(horner(&taylor.tangential, place));
        }
        if last {
            collector.visit(horner(&taylor.tangential, 1.0) - steady + steady);
        }
    }
    Ok(())
}

/// Places in [0, 1] where V may be extreme on a piece: its slopes change sign at most once on most
/// pieces, and between V̇ of different signs the change is found by Newton's method within a bracket;
/// where they change more often, every minimum and maximum is isolated.
fn tangential_extremes(taylor: &[f64; COEFFICIENTS]) -> Vec<f64> {
    /// A last step up to this leaves an error of its square, and of the fourth power in V.
    const NEAR: f64 = 1e-4;
    /// Steps taken in any case.
    const LEAST_STEPS: usize = 3;
    let polynomial = Bernstein::from_taylor(taylor, 0.0);
    if polynomial.turns() > 1 {
        let mut places = polynomial.minima(&mut false);
        places.extend(polynomial.affine(-1.0, 0.0).minima(&mut false));
        return places;
    }
    let (first, last) = (taylor[1], horner_slope(taylor, 1.0));
    if first * last >= 0.0 {
        return Vec::new();
    }
    let sign = last.signum();
    let mut steps = 0;
    let enough = |step: f64, _| {
        steps += 1;
        steps >= LEAST_STEPS && step <= NEAR
    };
    let slopes = |t: f64| {
        let (slope, curvature) = (horner_slope(taylor, t), horner_curvature(taylor, t));
        (sign * slope, sign * curvature)
    };
    vec![zero_by_slope((0.0, 1.0), first / (first - last), enough, slopes).1]
}

/// Adds the margin of a local minimum inside a zone. Its derivative in the place of the minimum
/// is zero, so the derivatives are those at a fixed time after the entry.
fn interior(
    collector: &mut Collector,
    watch: WaveWatch,
    index: usize,
    time: f64,
) -> Result<(), FlowError> {
    let jet = interior_margin(collector.at, watch, index, time)?;
    collector.margin(watch, index, time, [jet, Jet::default()]);
    Ok(())
}
