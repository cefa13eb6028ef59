//! The equations of a wave: the end of every zone against the beginning of the next.

use std::f64::consts::TAU;

use super::{Scales, Wave};
use crate::continuation::newton::System;
use crate::flow::jet::{DURATION, ENTRY_W, ENTRY_Y, Jet, LAYER, RADIAL_LAYER};
use crate::flow::{FlowError, Flows, Frame, SlidingFlow, ZoneEnd};
use crate::linalg::{Matrix, Vector};
use crate::model::Impact;
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
                    Jet::variable(self.layers_at(point, index)[0], LAYER) / self.scales.layer
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
                let switching = if next == Entry::TakeOff && self.material {
                    // Ü = 0 just after it takes the place of P = 0
                    Jet::default()
                } else if next == Entry::TakeOff {
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
                let slide = self.slide_at(point, index);
                let mut end = flows.separation().zone(&slide, order)?;
                // U − δ in units of time, duration in units of time: (U − δ)/T^m · time^{m−1}
                let power = if self.material { 1 } else { order as i32 - 1 };
                end.switching = end.switching * time.powi(power);
                end.second = end.second * time.powi(order as i32 - 1);
                Ok(end)
            }
        }
    }

    /// (Ü, V̈) just after the entry of a zone, with material damping.
    pub(crate) fn entry_acceleration(
        &self,
        flows: &Flows,
        point: &Vector,
        index: usize,
    ) -> Result<[Jet; 2], FlowError> {
        let slide = self.slide_at(point, index);
        let regime = self.signature.zone(index).regime;
        if regime == Regime::Separation {
            let flow = flows.separation().layered()?;
            return Ok(flow.map_or_else(Default::default, |flow| flow.entry_acceleration(&slide)));
        }
        Ok(match (regime, flows.contact(regime)) {
            (Regime::Slip | Regime::Reverse, SlidingFlow::Material(flow)) => {
                [Jet::default(), flow.entry_rates(&slide)[0]]
            }
            _ => Default::default(),
        })
    }

    /// What material damping asks of a switch besides: a row, the zone whose unknowns enter, the jet.
    ///
    /// Row 3 is the tangential condition. In contact and at a take-off V̈ is continuous. At a landing
    /// friction goes with the concentrated reaction βb̃Ü⁻: aV̈ − σfbÜ is continuous, written with the
    /// factor β with which it tends to the law of the Coulomb impact. At an arrested landing it is
    /// V̇ = 1. Row 2 at a take-off is Ü = 0 just after it; row 4 the second condition of a landing.
    fn layer_conditions(
        &self,
        flows: &Flows,
        point: &Vector,
        index: usize,
        end: &ZoneEnd,
    ) -> Result<Vec<(usize, usize, Jet)>, FlowError> {
        let next = self.signature.zone(index + 1);
        let scales = &self.scales;
        let [radial, tangential] = self.entry_acceleration(flows, point, index + 1)?;
        let mut conditions = Vec::with_capacity(4);
        if self.signature.zone(index).regime == Regime::Separation {
            conditions.push((4, index, end.second));
            if next.entry == Entry::ArrestedLanding {
                conditions.push((3, index, end.w - 1.0));
            } else {
                let friction = self.reaction(flows, next.regime);
                let beta = flows.frame.material() * (1.0 / scales.rate);
                let [lifted, dragged] = end.impulse;
                let before = (dragged - friction * lifted) * (1.0 / scales.rate);
                conditions.push((3, index, before));
                conditions.push((3, index + 1, beta * (friction * radial - tangential)));
            }
            return Ok(conditions);
        }
        if self.width() > 4 {
            let [_, layer] = self.layers_at(point, index);
            let none = Jet::variable(layer, RADIAL_LAYER) * (1.0 / scales.rate);
            conditions.push((4, index, none));
        }
        if next.entry == Entry::TakeOff {
            conditions.push((2, index + 1, radial * (1.0 / scales.layer)));
        }
        conditions.push((3, index, end.acceleration * (1.0 / scales.layer)));
        conditions.push((3, index + 1, tangential * (-1.0 / scales.layer)));
        Ok(conditions)
    }

    /// σf b/a: the friction of a concentrated reaction in terms of V̈ for one of Ü.
    pub(crate) fn reaction(&self, flows: &Flows, after: Regime) -> Jet {
        let sigma = after.sliding().unwrap_or(1.0);
        let at = &flows.frame.at;
        let value = sigma * at.friction * at.radial_stress / at.stress;
        flows.frame.jet(value, |by| {
            (sigma * (by.friction * at.radial_stress + at.friction * by.radial_stress)
                - value * by.stress)
                / at.stress
        })
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
                    _ if self.material => return end.w,
                    Impact::Frictionless => return end.w,
                    Impact::Coulomb if next.regime == Regime::Reverse => 1.0,
                    // contact that would need tension has V̇ < −gδ/κ: a touch comes from slip
                    Impact::Coulomb => -1.0,
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
        for zone in 0..n {
            let end = self.zone_end(&flows, point, zone)?;
            let after = self.rate_after_switch(&flows, &end, zone);
            let next = width * ((zone + 1) % n);
            let row = width * zone;
            for (offset, jet) in [end.y * (1.0 / time), after * (1.0 / rate), end.switching]
                .into_iter()
                .enumerate()
            {
                let units = self.jet_units(zone);
                residual[row + offset] = jet.value;
                for (index, column) in self.columns(zone).enumerate() {
                    jacobian[(row + offset, column)] += jet.by[index] * units[index];
                }
            }
            if self.material {
                residual[row + 3..row + width].fill(0.0);
                for (offset, at, jet) in self.layer_conditions(&flows, point, zone, &end)? {
                    let units = self.jet_units(at);
                    residual[row + offset] += jet.value;
                    for (index, column) in self.columns(at).enumerate() {
                        jacobian[(row + offset, column)] += jet.by[index] * units[index];
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
