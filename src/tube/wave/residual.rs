//! The equations of a wave: the end of every zone against the beginning of the next.

use std::f64::consts::TAU;

use super::{Wave, WaveAt, WaveScales};
use crate::continuation::newton::{self, Equations};
use crate::linalg::{Matrix, Vector};
use crate::tube::flow::jet::{DURATION, ENTRY_W, ENTRY_Y, Jet, LAYER, RADIAL_LAYER};
use crate::tube::flow::{FlowError, Frame, Quantities, SlidingFlow, ZoneEnd};
use crate::tube::model::Impact;
use crate::tube::model::signature::{Regime, ZoneEntry};

impl WaveAt<'_> {
    /// End of a zone: state and scaled switching function, with derivatives.
    pub fn zone_end(&self, index: usize) -> Result<ZoneEnd, FlowError> {
        let WaveAt { wave, flows, .. } = self;
        let zone = wave.signature.zone(index);
        let next = wave.signature.zone(index + 1).entry;
        let slide = self.slide(index);
        let time = wave.scales.time;
        match zone.regime {
            Regime::Stick => {
                let [y, w] = slide.entry;
                let y = Jet::variable(y, ENTRY_Y) + Jet::variable(slide.duration, DURATION);
                let w = Jet::variable(w, ENTRY_W);
                let switching = if wave.material {
                    // there is no layer in stick; V̈ = 0 at release is the matching of V̈
                    Jet::variable(slide.layer, LAYER) / wave.scales.layer
                } else {
                    (y - flows.frame.release(wave.model.law)) * (1.0 / time)
                };
                Ok(ZoneEnd {
                    y,
                    w,
                    switching,
                    ..ZoneEnd::default()
                })
            }
            Regime::Slip | Regime::Reverse | Regime::Contact => {
                let order = wave.order_at_entry(zone.entry);
                let arrested = next == ZoneEntry::Arrest;
                let end = flows.contact(zone.regime).zone(&slide, order, arrested)?;
                let w = end.w;
                let switching = if next == ZoneEntry::TakeOff && wave.material {
                    // Ü = 0 just after it takes the place of P = 0
                    Jet::default()
                } else if next == ZoneEntry::TakeOff {
                    flows.frame.pressure(w) * (1.0 / wave.scales.pressure)
                } else if next == ZoneEntry::Section {
                    w
                } else if wave.material {
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
                let order = wave.order_at_entry(zone.entry);
                let mut end = flows.separation().zone(&slide, order)?;
                // U − δ in units of time, duration in units of time: (U − δ)/T^m · time^{m−1}
                let power = if wave.material { 1 } else { order as i32 - 1 };
                end.switching = end.switching * time.powi(power);
                end.second = end.second * time.powi(order as i32 - 1);
                Ok(end)
            }
        }
    }

    /// (Ü, V̈) just after the entry of a zone, with material damping.
    pub(crate) fn entry_acceleration(&self, index: usize) -> Result<[Jet; 2], FlowError> {
        let flows = &self.flows;
        let slide = self.slide(index);
        let regime = self.wave.signature.zone(index).regime;
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
        index: usize,
        end: &ZoneEnd,
    ) -> Result<Vec<(usize, usize, Jet)>, FlowError> {
        let WaveAt { wave, flows, .. } = self;
        let next = wave.signature.zone(index + 1);
        let scales = &wave.scales;
        let [radial, tangential] = self.entry_acceleration(index + 1)?;
        let mut conditions = Vec::with_capacity(4);
        if wave.signature.zone(index).regime == Regime::Separation {
            conditions.push((4, index, end.second));
            if next.entry == ZoneEntry::ArrestedLanding {
                conditions.push((3, index, end.w - 1.0));
            } else {
                let friction = self.reaction(next.regime);
                let beta = flows.frame.material() * (1.0 / scales.rate);
                let [lifted, dragged] = end.impulse;
                let before = (dragged - friction * lifted) * (1.0 / scales.rate);
                conditions.push((3, index, before));
                conditions.push((3, index + 1, beta * (friction * radial - tangential)));
            }
            return Ok(conditions);
        }
        if wave.width() > 4 {
            let none = Jet::variable(self.slide(index).radial, RADIAL_LAYER) * (1.0 / scales.rate);
            conditions.push((4, index, none));
        }
        if next.entry == ZoneEntry::TakeOff {
            conditions.push((2, index + 1, radial * (1.0 / scales.layer)));
        }
        conditions.push((3, index, end.acceleration * (1.0 / scales.layer)));
        conditions.push((3, index + 1, tangential * (-1.0 / scales.layer)));
        Ok(conditions)
    }

    /// σf b/a: the friction of a concentrated reaction in terms of V̈ for one of Ü.
    pub(crate) fn reaction(&self, after: Regime) -> Jet {
        let sigma = after.sliding().unwrap_or(1.0);
        let quantity = |of: fn(&Quantities) -> f64| self.flows.frame.quantity(of);
        let radial = quantity(|of| of.friction) * quantity(|of| of.radial_stress) * sigma;
        radial / quantity(|of| of.stress)
    }

    /// W just after the switch that ends a zone.
    pub(crate) fn rate_after_switch(&self, end: &ZoneEnd, index: usize) -> Jet {
        let wave = self.wave;
        let next = wave.signature.zone(index + 1);
        match next.entry {
            // set, not carried over: the switching function of a zone entered at W = 1 takes that for
            // granted
            ZoneEntry::Arrest
            | ZoneEntry::Release
            | ZoneEntry::Reversal
            | ZoneEntry::ArrestedLanding => Jet::constant(1.0),
            ZoneEntry::Section => Jet::default(),
            ZoneEntry::Landing | ZoneEntry::Touch => {
                let sign = match wave.model.impact {
                    _ if wave.material => return end.w,
                    Impact::Frictionless => return end.w,
                    Impact::Coulomb if next.regime == Regime::Reverse => 1.0,
                    // contact that would need tension has V̇ < −gδ/κ: a touch comes from slip
                    Impact::Coulomb => -1.0,
                };
                end.w + self.impulse(end) * sign
            }
            _ => end.w,
        }
    }

    /// f m_b U̇⁻/m_a, the largest jump of W that a Coulomb impact can make (negative: U̇⁻ < 0).
    pub(crate) fn impulse(&self, end: &ZoneEnd) -> Jet {
        let quantity = |of: fn(&Quantities) -> f64| self.flows.frame.quantity(of);
        let normal = quantity(|of| of.friction) * quantity(|of| of.mb);
        normal / quantity(|of| of.ma) * end.radial_rate
    }
}

impl Wave {
    /// First-order bound of what rounding leaves of the scaled parameter, which a matrix of the wave's
    /// equations and one more determines; `last` is the rounding of that one besides what its derivatives show.
    pub(crate) fn parameter_rounding(
        &self,
        matrix: &Matrix,
        point: &Vector,
        last: f64,
    ) -> Option<f64> {
        let parameter = point.len() - 1;
        // ln(e/e₀) may be zero, but e has the rounding of a number of its own size
        let mut sizes = point.abs();
        sizes[parameter - 1] = sizes[parameter - 1].max(1.0);
        let mut noise = newton::noise(self, matrix, point);
        if let Some(noise) = &mut noise {
            noise[parameter] = last;
        }
        Some(newton::rounding(matrix, &sizes, noise.as_ref())?[parameter])
    }
}

impl Equations for Wave {
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
        let at = WaveAt {
            wave: self,
            point,
            flows: self.flows_of(Frame::new(&parameters, &derivative, excess)?),
        };
        let n = self.zones();
        let width = self.width();
        let WaveScales { time, rate, .. } = self.scales;
        for zone in 0..n {
            let end = at.zone_end(zone)?;
            let after = at.rate_after_switch(&end, zone);
            let next = width * ((zone + 1) % n);
            let row = width * zone;
            residual[row..row + width].fill(0.0);
            let mut add = |offset: usize, of: usize, jet: Jet| {
                let units = self.jet_units(of);
                residual[row + offset] += jet.value;
                for (index, column) in self.columns(of).enumerate() {
                    jacobian[(row + offset, column)] += jet.by[index] * units[index];
                }
            };
            add(0, zone, end.y * (1.0 / time));
            add(1, zone, after * (1.0 / rate));
            add(2, zone, end.switching);
            if self.material {
                for (offset, of, jet) in at.layer_conditions(zone, &end)? {
                    add(offset, of, jet);
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
