//! What the switches of a wave do to its perturbations: the numbers of [`super::characteristic`] and of
//! [`super::boundary`].

use super::perturbation::{LandingJump, PerturbationJump, Reaction};
use crate::tube::flow::{FlowError, ZoneEnd};
use crate::tube::model::Impact;
use crate::tube::model::signature::{Regime, ZoneEntry};
use crate::tube::wave::WaveAt;

/// A switch: the end of a zone of a wave.
struct ZoneSwitch<'a> {
    posed: &'a WaveAt<'a>,
    index: usize,
    end: &'a ZoneEnd,
    /// ã and b̃.
    stress: [f64; 2],
}

/// The jump at the end of a zone, with ã and b̃.
pub(super) fn jump(
    posed: &WaveAt,
    index: usize,
    end: &ZoneEnd,
    stress: [f64; 2],
) -> Result<PerturbationJump, FlowError> {
    let switch = ZoneSwitch {
        posed,
        index,
        end,
        stress,
    };
    switch.jump()
}

impl ZoneSwitch<'_> {
    fn jump(&self) -> Result<PerturbationJump, FlowError> {
        let ZoneSwitch { posed, index, .. } = *self;
        let signature = &posed.wave.signature;
        let (zone, next) = (signature.zone(index), signature.zone(index + 1));
        let (flows, at) = (&posed.flows, posed.flows.frame.at);
        let damped = at.material > 0.0;
        let [y, w] = [self.end.y.value, self.end.w.value];
        let sliding = |regime: Regime, w: f64| flows.contact(regime).outer_acceleration([y, w]);
        Ok(match next.entry {
            ZoneEntry::Release if posed.wave.model.law.jumps_at_release() => {
                PerturbationJump::StaticRelease(sliding(Regime::Slip, 1.0) / at.h)
            }
            ZoneEntry::Release | ZoneEntry::Section => PerturbationJump::None,
            ZoneEntry::Arrest => PerturbationJump::Arrest,
            ZoneEntry::TakeOff if damped => {
                PerturbationJump::Depart(posed.reaction(zone.regime).value)
            }
            ZoneEntry::TakeOff => PerturbationJump::TakeOff,
            ZoneEntry::Reversal if damped => {
                let (slide, after) = (posed.slide(index), posed.slide(index + 1));
                let leaving = flows.contact(zone.regime);
                let t = slide.duration;
                let jerk = flows.contact(next.regime).jerk(&after, 0.0, after.entry)
                    - leaving.jerk(&slide, t, [y, w]);
                PerturbationJump::Bend(jerk / leaving.acceleration(&slide, t, [y, w]))
            }
            ZoneEntry::Reversal => {
                PerturbationJump::Reversal(sliding(next.regime, w) / sliding(zone.regime, w))
            }
            ZoneEntry::ArrestedLanding | ZoneEntry::Landing | ZoneEntry::Touch if damped => {
                PerturbationJump::Settle(self.settlement()?)
            }
            ZoneEntry::ArrestedLanding | ZoneEntry::Landing | ZoneEntry::Touch => {
                PerturbationJump::Landing(self.impact())
            }
        })
    }

    /// A landing or a touch without impact.
    fn settlement(&self) -> Result<Reaction, FlowError> {
        let ZoneSwitch {
            posed, index, end, ..
        } = *self;
        let next = posed.wave.signature.zone(index + 1);
        let (frame, at) = (&posed.flows.frame, posed.flows.frame.at);
        let [a, b] = self.stress;
        let [weight, steady] = [frame.weight().value, frame.steady().value];
        let (beta, y, w) = (at.material, end.y.value, end.w.value);
        // (U⃛, V⃛) of separation at U̇ = 0 less m_bÜ/(βb̃) and m_aV̈/(βã)
        let left = |[lift, bend]: [f64; 2]| {
            let normal = weight + at.kappa * (w + beta * bend);
            let rubbed = (at.damping + beta * at.h) * w + at.h * (y + steady);
            let shear = rubbed - at.kappa * beta * lift;
            [normal / (beta * b), shear / (beta * a)]
        };
        let before = end.impulse.map(|jet| jet.value / beta);
        let slide = posed.slide(index + 1);
        let share = posed.reaction(next.regime).value;
        let [lift, bend, radial, tangential] = match next.regime {
            Regime::Separation => {
                let after = posed.entry_acceleration(index + 1)?;
                let after = after.map(|jet| jet.value);
                let [radial, tangential] = left(after);
                [after[0], after[1], radial, tangential]
            }
            Regime::Stick => [0.0; 4],
            _ => {
                let flow = posed.flows.contact(next.regime);
                let bend = flow.acceleration(&slide, 0.0, slide.entry);
                let jerk = flow.jerk(&slide, 0.0, slide.entry);
                [0.0, bend, 0.0, jerk - at.ma * bend / (beta * a)]
            }
        };
        let [normal, shear] = left(before);
        Ok(Reaction {
            before: before[1] / before[0],
            after: bend / before[0],
            bend: (tangential - shear - share * (radial - normal)) / before[0],
            share,
            lift: lift / before[0],
            arrested: next.entry == ZoneEntry::ArrestedLanding,
        })
    }

    /// A landing or a touch with an impact.
    fn impact(&self) -> LandingJump {
        let ZoneSwitch {
            posed, index, end, ..
        } = *self;
        let next = posed.wave.signature.zone(index + 1);
        let (frame, at) = (&posed.flows.frame, posed.flows.frame.at);
        let [a, b] = self.stress;
        let [weight, steady] = [frame.weight().value, frame.steady().value];
        let (y, w, radial) = (end.y.value, end.w.value, end.radial_rate.value);
        let after = posed.rate_after_switch(end, index).value;
        let free = |w: f64, radial: f64| {
            (at.kappa * radial - at.damping * w - at.h * (y + steady)) / at.ma
        };
        let (slide, bounce) = match next.regime {
            Regime::Separation => (free(after, 0.0), -(weight + at.kappa * after) / at.mb),
            Regime::Stick => (0.0, 0.0),
            regime => {
                let flow = posed.flows.contact(regime);
                (flow.outer_acceleration([y, after]), 0.0)
            }
        };
        // only a Coulomb impact brings V̇ to 1
        let arrested = next.entry == ZoneEntry::ArrestedLanding;
        let friction = match posed.wave.model.impact {
            Impact::Coulomb => next.regime.sliding().unwrap_or(1.0) * at.friction,
            Impact::Frictionless => 0.0,
        };
        let share = friction * at.mb / at.ma;
        let normal = -(weight + at.kappa * w + at.damping * radial) / at.mb;
        let bent = slide - free(w, radial) + share * normal;
        LandingJump {
            eta: (after - w) / radial,
            rate: match next.entry {
                ZoneEntry::ArrestedLanding => slide / radial,
                // of [V̈] = −κU̇⁻/m_a the difference would keep less
                ZoneEntry::Touch if friction == 0.0 => -at.kappa / at.ma,
                _ => bent / radial,
            },
            slope: 2.0 * friction * (a - b) / (at.ma * at.ma),
            share,
            arrested,
            bounce: bounce / radial,
        }
    }
}
