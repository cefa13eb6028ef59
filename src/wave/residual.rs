//! The equations of a wave: the end of every zone against the beginning of the next.

use std::f64::consts::TAU;

use super::{Scales, Wave, jet_units};
use crate::continuation::newton::System;
use crate::flow::jet::{DURATION, ENTRY_W, ENTRY_Y, Jet, LAYER};
use crate::flow::{FlowError, Flows, Frame, SlidingFlow, ZoneEnd};
use crate::linalg::{Matrix, Vector};
use crate::model::signature::{Entry, Regime};

impl Wave {
    /// End of a zone: state and scaled switching function, with derivatives.
    pub fn zone_end(
        &self,
        flows: &Flows,
        point: &Vector,
        index: usize,
    ) -> Result<ZoneEnd, FlowError> {
        let zone = self.signature.zone(index);
        let next = self.signature.zone(index + 1).entry;
        let entry = self.entry_at(point, index);
        let duration = self.duration_at(point, index);
        let time = self.scales.time;
        match zone.regime {
            Regime::Stick => {
                let y = Jet::variable(entry[0], ENTRY_Y) + Jet::variable(duration, DURATION);
                let w = Jet::variable(entry[1], ENTRY_W);
                let switching = if self.material {
                    // there is no layer in stick; V̈ = 0 at release is the matching of V̈
                    Jet::variable(self.layer_at(point, index), LAYER) / self.scales.layer
                } else {
                    (y - flows.frame.release(self.model.law)) * (1.0 / time)
                };
                Ok(ZoneEnd {
                    y,
                    w,
                    switching,
                    ..ZoneEnd::default()
                })
            }
            Regime::Slip | Regime::Reverse | Regime::Contact => {
                let order = self.order_at_entry(zone.entry);
                let slide = self.slide_at(point, index);
                let arrested = next == Entry::Arrest;
                let end = flows.contact(zone.regime).zone(&slide, order, arrested)?;
                let w = end.w;
                let switching = if next == Entry::TakeOff {
                    flows.frame.pressure(w) * (1.0 / self.scales.pressure)
                } else if next == Entry::Section {
                    w
                } else if self.material {
                    // 1, 1/T or 1/T²: see MaterialFlow::zone
                    let power = if order == 1 {
                        1 + i32::from(arrested)
                    } else {
                        0
                    };
                    end.switching * time.powi(power)
                } else {
                    end.switching * time.powi(order as i32)
                };
                Ok(ZoneEnd { switching, ..end })
            }
            Regime::Separation => {
                let order = self.order_at_entry(zone.entry);
                let mut end = flows.separation().zone(entry, duration, order)?;
                // U − δ in units of time, duration in units of time: (U − δ)/T^m · time^{m−1}
                end.switching = end.switching * time.powi(order as i32 - 1);
                Ok(end)
            }
        }
    }

    /// Whether a regime exists under the model: with material damping there is no theory of landing
    /// yet, and branches end where separation opens.
    pub(crate) fn has(&self, regime: Regime) -> bool {
        self.model.law.has(regime) && !(self.material && regime == Regime::Separation)
    }

    /// V̈ just after the entry of a zone, with material damping.
    pub(crate) fn entry_acceleration(&self, flows: &Flows, point: &Vector, index: usize) -> Jet {
        let index = index % self.zones();
        let regime = self.signature.zone(index).regime;
        match (regime, flows.contact(regime)) {
            (Regime::Slip | Regime::Reverse, SlidingFlow::Material(flow)) => {
                flow.entry_rates(&self.slide_at(point, index))[0]
            }
            _ => Jet::default(),
        }
    }

    /// W just after the switch that ends a zone.
    pub(crate) fn rate_after_switch(&self, flows: &Flows, end: &ZoneEnd, index: usize) -> Jet {
        let next = self.signature.zone(index + 1);
        match next.entry {
            // set, not carried over: the switching function of a zone entered at W = 1 takes that for
            // granted
            Entry::Arrest | Entry::Release | Entry::Reversal | Entry::ArrestedLanding => {
                Jet::constant(1.0)
            }
            Entry::Section => Jet::default(),
            Entry::Landing | Entry::Touch => {
                let sign = match self.model.impact {
                    crate::model::Impact::Frictionless => return end.w,
                    crate::model::Impact::Coulomb if next.regime == Regime::Reverse => 1.0,
                    // contact that would need tension has V̇ < −gδ/κ: a touch comes from slip
                    crate::model::Impact::Coulomb => -1.0,
                };
                end.w + self.impulse(flows, end) * sign
            }
            _ => end.w,
        }
    }

    /// f m_b U̇⁻/m_a, the largest jump of W that a Coulomb impact can make (negative: U̇⁻ < 0).
    pub(crate) fn impulse(&self, flows: &Flows, end: &ZoneEnd) -> Jet {
        let at = &flows.frame.at;
        let value = at.friction * at.mb / at.ma;
        let factor = flows.frame.jet(value, |by| {
            (by.friction * at.mb + at.friction * by.mb - value * by.ma) / at.ma
        });
        factor * end.radial_rate
    }
}

impl System for Wave {
    type Failure = FlowError;

    fn unknowns(&self) -> usize {
        self.width() * self.zones() + 2
    }

    fn evaluate(
        &self,
        point: &Vector,
        residual: &mut [f64],
        jacobian: &mut Matrix,
    ) -> Result<(), FlowError> {
        let (parameters, derivative) = self.parameters_at(point);
        let excess = self.excess_at(point);
        let flows = self.flows_of(Frame::new(&parameters, &derivative, excess)?);
        let n = self.zones();
        let width = self.width();
        let Scales { time, rate, .. } = self.scales;
        let units = jet_units(&self.scales);
        for zone in 0..n {
            let end = self.zone_end(&flows, point, zone)?;
            let after = self.rate_after_switch(&flows, &end, zone);
            let next = width * ((zone + 1) % n);
            let row = width * zone;
            for (offset, jet) in [end.y * (1.0 / time), after * (1.0 / rate), end.switching]
                .into_iter()
                .enumerate()
            {
                residual[row + offset] = jet.value;
                for (index, column) in self.columns(zone).enumerate() {
                    jacobian[(row + offset, column)] += jet.by[index] * units[index];
                }
            }
            if self.material {
                let entered = self.entry_acceleration(&flows, point, zone + 1);
                residual[row + 3] = 0.0;
                for (at, sign, jet) in [(zone, 1.0, end.acceleration), (zone + 1, -1.0, entered)] {
                    let jet = jet * (sign / self.scales.layer);
                    residual[row + 3] += jet.value;
                    for (index, column) in self.columns(at).enumerate() {
                        jacobian[(row + 3, column)] += jet.by[index] * units[index];
                    }
                }
            }
            residual[row] -= point[next];
            jacobian[(row, next)] -= 1.0;
            residual[row + 1] -= point[next + 1];
            jacobian[(row + 1, next + 1)] -= 1.0;
        }
        // Σ T|c| k/2π = 1, |c| = √a(1 + e)
        let durations: f64 = (0..n).map(|zone| point[width * zone + 2]).sum();
        let a = parameters.coefficients.a;
        let unit = time * a.sqrt() * f64::from(self.mode) / TAU;
        let factor = unit * (1.0 + excess);
        let row = width * n;
        residual[row] = durations * factor - 1.0;
        for zone in 0..n {
            jacobian[(row, width * zone + 2)] = factor;
        }
        jacobian[(row, row)] = durations * unit * excess;
        jacobian[(row, row + 1)] =
            durations * factor * 0.5 * derivative.coefficients.a / a * self.scales.parameter;
        Ok(())
    }
}
