//! Margins: smooth functions of the unknowns that are positive while a signature holds.

use serde::{Deserialize, Serialize};

use super::{Wave, WaveAt};
use crate::continuation::newton::Constraint;
use crate::linalg::Vector;
use crate::tube::flow::jet::{DURATION, ENTRY_W, ENTRY_Y, EXCESS, Jet, PARAMETER};
use crate::tube::flow::{FlowError, SlidingFlow};
use crate::tube::model::signature::{Regime, ZoneEntry};

/// What a margin measures: the quantity that is positive while the signature holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum WaveWatch {
    /// Duration T of the zone.
    Duration,
    /// A local minimum of P inside a slip zone.
    Pressure,
    /// P that contact has just after landing.
    LandingPressure,
    /// A local minimum of |1 − W| inside a sliding zone.
    Rate,
    /// −P that contact would have just after a touch; with material damping Ü there.
    Tension,
    /// |1 − W| just after landing, or beyond what a Coulomb impact can take away.
    LandingRate,
    /// What the arresting impact has left: impulse minus |1 − W⁻|; with material damping the friction of
    /// the concentrated reaction, minus what takes V̈ to 0.
    Impulse,
    /// A local minimum of U − δ inside a separation zone.
    Gap,
    /// −U̇ at landing; with material damping βÜ.
    LandingSpeed,
    /// Q + fP at the beginning of stick.
    LowerForce,
    /// Q − fP that stick would have between reverse slip, or a landing that arrests, and slip; with material
    /// damping −V̈ where slip begins.
    UpperForce,
    /// −V⃛ just after a release with material damping: Q ≤ fP at the end of stick.
    Release,
    /// D/c, watched only where it is not positive: waves run in the direction of D.
    Coupling,
}

/// A margin: positive while the signature holds. Scaled to order one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegimeMargin {
    /// Which quantity it is.
    pub watch: WaveWatch,
    /// Index of the zone, from 0 in the order of the signature.
    pub zone: usize,
    /// Time after the entry of the zone at which a local minimum lies; 0 for other margins.
    pub time: f64,
    /// Value with scaled derivatives in Y, W, T of the zone, c and the parameter.
    pub jet: Jet,
    /// Scaled derivatives in the unknowns of the next zone, where they enter.
    #[serde(skip)]
    pub beyond: Jet,
}

impl RegimeMargin {
    /// Derivative along a direction in the scaled unknowns.
    pub(crate) fn slope(&self, wave: &Wave, direction: &Vector) -> f64 {
        let along = |zone: usize, jet: &Jet| -> f64 {
            wave.columns(zone)
                .zip(jet.by)
                .map(|(column, by)| by * direction[column])
                .sum()
        };
        along(self.zone, &self.jet) + along(self.zone + 1, &self.beyond)
    }

    /// Σ |∂m/∂uᵢ|·dᵢ.
    pub(crate) fn reach(&self, wave: &Wave, changes: &Vector) -> f64 {
        let of = |zone: usize, jet: &Jet| -> f64 {
            wave.columns(zone)
                .zip(jet.by)
                .map(|(column, by)| by.abs() * changes[column])
                .sum()
        };
        of(self.zone, &self.jet) + of(self.zone + 1, &self.beyond)
    }

    /// Adds its derivatives in the scaled unknowns.
    pub(crate) fn add_gradient(&self, wave: &Wave, gradient: &mut [f64]) {
        for (zone, jet) in [(self.zone, self.jet), (self.zone + 1, self.beyond)] {
            for (column, by) in wave.columns(zone).zip(jet.by) {
                gradient[column] += by;
            }
        }
    }
}

/// The margins that belong to the ends of a zone.
pub(super) fn edge_margins(
    at: &WaveAt,
    index: usize,
) -> Result<Vec<(WaveWatch, [Jet; 2])>, FlowError> {
    let WaveAt { wave, point, .. } = at;
    let zone = wave.signature.zone(index);
    let next = wave.signature.zone(index + 1);
    let mut margins = Vec::with_capacity(4);
    let watched = |watch: WaveWatch| edge_margin(at, index, watch);
    margins.push((WaveWatch::Duration, watched(WaveWatch::Duration)?));
    if zone.entry == ZoneEntry::Landing && zone.regime != Regime::Contact {
        margins.push((WaveWatch::LandingRate, watched(WaveWatch::LandingRate)?));
    }
    // with material damping what belongs to a landing vanishes like a power of the duration of
    // separation, which is watched
    let before = index + wave.zones() - 1;
    let gone = |index: usize| wave.material && wave.duration_at(point, index) <= 0.0;
    if matches!(zone.entry, ZoneEntry::Landing | ZoneEntry::ArrestedLanding)
        && matches!(zone.regime, Regime::Slip | Regime::Contact)
        && !gone(before)
    {
        margins.push((
            WaveWatch::LandingPressure,
            watched(WaveWatch::LandingPressure)?,
        ));
    }
    if zone.entry == ZoneEntry::Touch && !gone(index) {
        if wave.material {
            // it slides as slip does
            margins.push((WaveWatch::LandingRate, watched(WaveWatch::LandingRate)?));
        }
        margins.push((WaveWatch::Tension, watched(WaveWatch::Tension)?));
    }
    if zone.regime == Regime::Stick {
        margins.push((WaveWatch::LowerForce, watched(WaveWatch::LowerForce)?));
    }
    if wave.material && zone.entry == ZoneEntry::Release {
        margins.push((WaveWatch::Release, watched(WaveWatch::Release)?));
    }
    if zone.regime == Regime::Reverse && next.entry == ZoneEntry::Reversal {
        margins.push((WaveWatch::UpperForce, watched(WaveWatch::UpperForce)?));
    }
    if zone.regime == Regime::Separation && !gone(index) {
        margins.push((WaveWatch::LandingSpeed, watched(WaveWatch::LandingSpeed)?));
        if next.entry == ZoneEntry::ArrestedLanding {
            margins.push((WaveWatch::Impulse, watched(WaveWatch::Impulse)?));
            // reverse slip that would stick has no length
            if next.regime == Regime::Slip {
                margins.push((WaveWatch::UpperForce, watched(WaveWatch::UpperForce)?));
            }
        }
    }
    Ok(margins)
}

/// One margin at an end of a zone, in physical derivatives: in the unknowns of the zone and, without a
/// value, in those of the next.
pub(super) fn edge_margin(
    at: &WaveAt,
    index: usize,
    watch: WaveWatch,
) -> Result<[Jet; 2], FlowError> {
    let wave = at.wave;
    let lands = wave.material && wave.signature.zone(index).regime == Regime::Separation;
    let reacts = matches!(
        watch,
        WaveWatch::LandingSpeed | WaveWatch::Impulse | WaveWatch::UpperForce
    );
    if !(lands && reacts) {
        let margin = edge_margin_of_zone(at, index, watch)?;
        return Ok([margin, Jet::default()]);
    }
    // β times what a concentrated reaction takes of Ü, and its friction against what that takes of V̈
    let unit = 1.0 / wave.scales.rate;
    let [lifted, dragged] = at.zone_end(index)?.impulse;
    let entered = at.entry_acceleration(index + 1)?;
    let [radial, tangential] = entered.map(|jet| at.flows.frame.material() * jet);
    let [mut own, mut beyond] = match watch {
        WaveWatch::LandingSpeed => [lifted * unit, radial * -unit],
        WaveWatch::UpperForce => [Jet::default(), entered[1] * (-1.0 / wave.scales.layer)],
        _ => {
            let drag = dragged.value - tangential.value;
            let sign = unit.copysign(drag);
            let largest = at.reaction(Regime::Slip) * unit;
            [
                largest * lifted - dragged * sign,
                tangential * sign - largest * radial,
            ]
        }
    };
    own.value += beyond.value;
    beyond.value = 0.0;
    // the frame is one for both
    for index in [EXCESS, PARAMETER] {
        own.by[index] += beyond.by[index];
        beyond.by[index] = 0.0;
    }
    Ok([own, beyond])
}

/// A margin that depends on one zone.
fn edge_margin_of_zone(at: &WaveAt, index: usize, watch: WaveWatch) -> Result<Jet, FlowError> {
    let WaveAt { wave, point, flows } = at;
    let zone = wave.signature.zone(index);
    let entry = wave.entry_at(point, index);
    let frame = &flows.frame;
    let y = Jet::variable(entry[0], ENTRY_Y);
    let w = Jet::variable(entry[1], ENTRY_W);
    let scales = &wave.scales;
    let force = 1.0 / scales.pressure;
    // Q − fP in slip terms: hY + α − fκW, with W = 1
    let excess = |y: Jet| {
        let h = frame.quantity(|of| of.h);
        h * (y - frame.release(wave.model.law))
    };
    // 2rfP at W = 1, r the static by the kinetic coefficient
    let band = || {
        let r = wave.model.law.static_ratio();
        let f = frame.quantity(|of| of.friction);
        f * r * (frame.weight() + frame.kappa()) * 2.0
    };
    Ok(match watch {
        WaveWatch::Coupling => frame.kappa() * force,
        WaveWatch::Duration => {
            Jet::variable(wave.duration_at(point, index), DURATION) * (1.0 / scales.time)
        }
        WaveWatch::LandingRate if zone.regime == Regime::Reverse => w - 1.0,
        WaveWatch::LandingRate => -w + 1.0,
        WaveWatch::LandingPressure if wave.material => {
            let [_, acceleration] = at.entry_acceleration(index)?;
            frame.pressure(w + frame.material() * acceleration) * force
        }
        WaveWatch::LandingPressure => frame.pressure(w) * force,
        // a touch takes no more of Ü than there is
        WaveWatch::Tension if wave.material => {
            at.entry_acceleration(index)?[0] * (1.0 / scales.layer)
        }
        WaveWatch::Tension => frame.pressure(w) * -force,
        // Q + fP = (Q − fP) + 2fP
        WaveWatch::LowerForce => (excess(y) + band()) * force,
        WaveWatch::UpperForce => {
            let end = at.zone_end(index)?;
            if wave.material {
                return Ok(end.acceleration * (-1.0 / scales.layer));
            }
            // the other way round: Q > fP lets reverse slip pass into slip
            excess(end.y) * force
        }
        WaveWatch::LandingSpeed => -at.zone_end(index)?.radial_rate,
        WaveWatch::Impulse => {
            let end = at.zone_end(index)?;
            let sign = if end.w.value < 1.0 { 1.0 } else { -1.0 };
            // |impulse| − |1 − W⁻|; the impulse is negative as U̇⁻ is
            -at.impulse(&end) + (end.w - 1.0) * sign
        }
        WaveWatch::Release => match flows.contact(zone.regime) {
            // in units of V̈ per unit of time
            SlidingFlow::Material(flow) => {
                flow.entry_rates(&at.slide(index))[1] * (-scales.time / scales.layer)
            }
            _ => Jet::default(),
        },
        WaveWatch::Pressure | WaveWatch::Rate | WaveWatch::Gap => {
            unreachable!("a margin inside a zone is not at its end")
        }
    })
}

/// The margin of a local minimum inside a zone at a time after its entry.
pub(super) fn interior_margin(
    at: &WaveAt,
    watch: WaveWatch,
    index: usize,
    time: f64,
) -> Result<Jet, FlowError> {
    let WaveAt { wave, flows, .. } = at;
    let slide = &at.slide(index);
    let regime = wave.signature.zone(index).regime;
    Ok(match watch {
        WaveWatch::Gap => {
            let mismatch = flows.frame.quantity(|of| of.mismatch);
            let u = flows.separation().radial(slide, time)?;
            (u - mismatch) * (1.0 / wave.scales.time)
        }
        WaveWatch::Pressure => {
            let [_, pressure] = flows.contact(regime).inside(&flows.frame, slide, time)?;
            pressure * (1.0 / wave.scales.pressure)
        }
        _ => {
            let [w, _] = flows.contact(regime).inside(&flows.frame, slide, time)?;
            let sigma = if regime == Regime::Reverse { 1.0 } else { -1.0 };
            w * sigma - sigma
        }
    })
}

/// A margin as the constraint of an event: margin = 0. The place of a local minimum is followed
/// from iterate to iterate.
#[derive(Clone, Copy, Debug)]
pub struct MarginConstraint {
    /// The margin where it was seen.
    pub margin: RegimeMargin,
}

impl MarginConstraint {
    /// The margin at another point.
    pub(crate) fn margin_at(
        &mut self,
        wave: &Wave,
        point: &Vector,
    ) -> Result<RegimeMargin, FlowError> {
        let at = wave.at(point)?;
        let RegimeMargin { watch, zone, .. } = self.margin;
        let [mut jet, mut beyond] = match watch {
            WaveWatch::Pressure | WaveWatch::Rate | WaveWatch::Gap => {
                self.margin.time = self.stationary(&at)?;
                let jet = interior_margin(&at, watch, zone, self.margin.time)?;
                [jet, Jet::default()]
            }
            _ => edge_margin(&at, zone, watch)?,
        };
        wave.scale(&mut jet, zone);
        wave.scale(&mut beyond, zone + 1);
        self.margin.jet = jet;
        self.margin.beyond = beyond;
        Ok(self.margin)
    }

    /// The stationary place next to the last one, by Newton's method.
    fn stationary(&self, at: &WaveAt) -> Result<f64, FlowError> {
        let WaveAt { wave, flows, .. } = at;
        let slide = &at.slide(self.margin.zone);
        let mut time = self.margin.time;
        let regime = wave.signature.zone(self.margin.zone).regime;
        for _ in 0..8 {
            let step = if self.margin.watch == WaveWatch::Gap {
                flows
                    .separation()
                    .step_to_extreme(&flows.frame, slide, time)?
            } else {
                let flow = flows.contact(regime);
                match flow {
                    SlidingFlow::Material(flow) if self.margin.watch == WaveWatch::Pressure => {
                        flow.pressure_step(slide, time)
                    }
                    _ => {
                        let state = flow.state(slide, time)?;
                        flow.acceleration(slide, time, state) / flow.jerk(slide, time, state)
                    }
                }
            };
            if !step.is_finite() {
                return Err(FlowError::Overflow { duration: time });
            }
            time -= step;
            // beyond this the place moves the value by less than rounding
            if step.abs() <= 1e-9 * wave.scales.time {
                break;
            }
        }
        Ok(time)
    }
}

impl Constraint<Wave> for MarginConstraint {
    fn evaluate(
        &mut self,
        wave: &Wave,
        point: &Vector,
        gradient: &mut [f64],
    ) -> Result<f64, FlowError> {
        let margin = self.margin_at(wave, point)?;
        margin.add_gradient(wave, gradient);
        Ok(margin.jet.value)
    }
}
