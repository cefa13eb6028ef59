//! A travelling wave as a boundary-value problem for one signature.
//!
//! Unknowns are, for each zone i, the state (Y_i, W_i) just after its entry and its duration T_i,
//! then the excess speed e = |c|/√a − 1, as ln e, and the continuation parameter: 3n + 2 numbers. Equations are, for each zone,
//! the matching of Y and of W with the next entry and the switching condition at its end, then
//! the period Σ T_i·|c| = 2π/k: 3n + 1. Matching zone by zone, instead of following the flow once
//! round, keeps the growth of one zone out of the others.
//!
//! | switch | switching condition at the end of the zone | W after it |
//! |---|---|---|
//! | release | hY = rfκ + (r − 1)fgδ − α | 1 |
//! | arrest, reversal | (W − 1)/T^m = 0 | 1 |
//! | take-off | P = 0 | W |
//! | landing, touch | (U − δ)/T^m = 0 | W, or W ± f m_b \|U̇\|/m_a with a Coulomb impact |
//! | arrested landing | (U − δ)/T^m = 0 | 1 |
//! | section | W = 0 | 0 |
//!
//! With material damping β > 0 ([`crate::flow::material`]) every zone has a fourth unknown, the layer
//! G_i at its end, and a fourth equation, the matching of V̈ with the next entry: V̈ = 0 at both ends
//! of stick, of which the one at release takes the place of Q = fP. In stick G = 0.
//!
//! m is the order of the zero at the entry of the zone. Of W − 1: 2 after a release (V̈ = 0 there),
//! 1 after a reversal, an arrested landing or a release from
//! static friction. Of U − δ: 3 after take-off, 2 after a touch. Divided out, the zone may shrink to nothing and
//! beyond while the equations stay regular, which is how zones open and close along a branch: the
//! square-root law T ∝ √(δ* − δ) of a nascent zone is the parabola δ* − δ ∝ T² of its duration.

pub mod admissibility;
pub mod hopf;
pub mod precise;
pub mod profile;
pub mod start;
pub mod successor;

use std::cell::OnceCell;
use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::continuation::newton::System;
use crate::flow::contact::ContactFlow;
use crate::flow::jet::{DURATION, ENTRY_W, ENTRY_Y, EXCESS, Jet, LAYER, PARAMETER, SOURCES};
use crate::flow::material::MaterialFlow;
use crate::flow::method::Method;
use crate::flow::numerical::{Integrator, NumericalContact, NumericalSeparation};
use crate::flow::separation::SeparationFlow;
use crate::flow::{FlowError, Frame, FreeFlow, Slide, SlidingFlow, ZoneEnd};
use crate::linalg::{Matrix, Vector};
use crate::model::signature::{Entry, Regime, Signature};
use crate::model::{Constants, FrictionLaw, Model, Parameter};

/// Units of the unknowns, constant along a branch: they make every scaled unknown of order one,
/// and they follow the exact scaling (γ, δ, c) → (s²γ, sδ, c/s) of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// Period 2π/(k|c|) of the first wave: unit of Y and of durations.
    pub time: f64,
    /// Unit of W: [`RATE_UNITS`] times the largest |V̇| of the first wave. Just after landing and
    /// before take-off W varies by much more than the lengths of the zones do; in its own unit it
    /// would take the whole arclength.
    pub rate: f64,
    /// Excess speed e₀ of the first wave: the unknown is ln(e/e₀), which resolves e as well where
    /// c² → a as where c is large.
    pub excess: f64,
    /// Unit of the continuation parameter: the width of its range.
    pub parameter: f64,
    /// κ = D/c of the first wave: unit of pressures.
    pub pressure: f64,
    /// Unit of V̈ and of the layer G: that of W times √(h/m_a), the frequency of slip.
    pub layer: f64,
}

/// See [`Scales::rate`].
pub const RATE_UNITS: f64 = 4.0;

/// (Y, W, T, G) of a zone: see [`Wave::unpack`].
pub type ZoneUnknowns = [f64; 4];

/// The boundary-value problem of one signature.
#[derive(Clone, Debug)]
pub struct Wave {
    /// Model; its continuation parameter is overridden by the unknown.
    pub model: Model,
    /// Continuation parameter.
    pub parameter: Parameter,
    /// Mode k: the wavelength is 2π/k.
    pub mode: u32,
    /// Sequence of zones.
    pub signature: Signature,
    /// Units.
    pub scales: Scales,
    /// How the equations of a zone are solved.
    pub method: Method,
    /// Whether material damping enters, be it at β = 0 where β is the continuation parameter.
    pub material: bool,
    /// Numbers of the model at its own parameter values: valid wherever the continuation
    /// parameter does not enter a, b, D, g, h.
    fixed: Constants,
    derivative: Constants,
    /// Sign of c, kept along the branch: that of D in `model`. The numbers above are seen in it.
    direction: f64,
}

/// The flows of one frame, each made when a zone first asks for it.
pub struct Flows {
    /// Frame.
    pub frame: Frame,
    law: FrictionLaw,
    material: bool,
    integrator: Option<Integrator>,
    slip: OnceCell<SlidingFlow>,
    reverse: OnceCell<SlidingFlow>,
    separation: OnceCell<FreeFlow>,
}

impl Flows {
    fn new(frame: Frame, law: FrictionLaw, method: Method, material: bool) -> Flows {
        Flows {
            frame,
            law,
            material,
            integrator: Integrator::of(method, law),
            slip: OnceCell::new(),
            reverse: OnceCell::new(),
            separation: OnceCell::new(),
        }
    }

    fn sliding(&self, sigma: f64) -> SlidingFlow {
        match self.integrator {
            None if self.material => {
                SlidingFlow::Material(Box::new(MaterialFlow::new(&self.frame, sigma)))
            }
            None => SlidingFlow::Exact(ContactFlow::new(&self.frame, sigma)),
            Some(integrator) => SlidingFlow::Numerical(Box::new(NumericalContact::new(
                &self.frame,
                self.law,
                sigma,
                integrator,
            ))),
        }
    }

    /// Flow of a sliding regime; slip for anything that is not reverse.
    pub fn contact(&self, regime: Regime) -> &SlidingFlow {
        match regime {
            Regime::Reverse => self.reverse.get_or_init(|| self.sliding(-1.0)),
            _ => self.slip.get_or_init(|| self.sliding(1.0)),
        }
    }

    /// Flow of separation.
    pub fn separation(&self) -> &FreeFlow {
        self.separation.get_or_init(|| {
            let exact = SeparationFlow::new(&self.frame);
            // friction does not enter: the dearest of the laws takes the closed form
            let smooth = matches!(self.law, FrictionLaw::Regularised { .. });
            match self.integrator.filter(|_| !smooth) {
                None => FreeFlow::Exact(Box::new(exact)),
                Some(integrator) => FreeFlow::Numerical(Box::new(NumericalSeparation::new(
                    &self.frame,
                    exact.norm(),
                    integrator,
                ))),
            }
        })
    }
}

impl Wave {
    /// The boundary-value problem of a signature, with the default method of the friction law.
    pub fn new(
        model: Model,
        parameter: Parameter,
        mode: u32,
        signature: Signature,
        scales: Scales,
    ) -> Wave {
        let direction = model.direction();
        Wave {
            model,
            parameter,
            mode,
            signature,
            scales,
            method: Method::cheapest(model.law),
            material: model.has_material_damping(parameter),
            fixed: model.constants().seen(direction),
            derivative: model.derivative(parameter).seen(direction),
            direction,
        }
    }

    /// The same problem solved by another method.
    pub fn with_method(mut self, method: Method) -> Wave {
        self.method = method;
        self
    }

    /// The same problem in the unknowns of material damping, or not.
    pub fn with_material(mut self, material: bool) -> Wave {
        self.material = material;
        self
    }

    /// An undamped wave in the unknowns of material damping: the layers take V̈ at the end of each zone
    /// to its value at the next entry.
    ///
    /// # Errors
    /// The flow cannot be evaluated.
    pub fn with_layers(&self, point: &Vector) -> Result<(Wave, Vector), FlowError> {
        let wave = self.clone().with_material(true);
        let (excess, parameter) = (self.excess_at(point), self.parameter_at(point));
        let mut zones = self.unpack(point);
        let bare = wave.pack(&zones, excess, parameter);
        let flows = wave.flows(&bare)?;
        for (index, zone) in zones.iter_mut().enumerate() {
            if self.signature.zone(index).regime.sliding().is_some() {
                let end = wave.zone_end(&flows, &bare, index)?.acceleration;
                let next = wave.entry_acceleration(&flows, &bare, index + 1);
                zone[3] = next.value - end.value;
            }
        }
        let point = wave.pack(&zones, excess, parameter);
        Ok((wave, point))
    }

    /// The same wave under another signature.
    pub fn with_signature(&self, signature: Signature) -> Wave {
        Wave {
            signature,
            ..self.clone()
        }
    }

    /// Number of zones.
    pub fn zones(&self) -> usize {
        self.signature.len()
    }

    /// Unknowns of a zone: Y, W, T, and G with material damping.
    pub fn width(&self) -> usize {
        if self.material { 4 } else { 3 }
    }

    /// Columns of the derivatives of a jet of a zone, in the order of the jet.
    pub fn columns(&self, zone: usize) -> impl Iterator<Item = usize> + use<> {
        let width = self.width();
        let first = width * (zone % self.zones());
        let last = width * self.zones();
        [first, first + 1, first + 2, last, last + 1, first + 3]
            .into_iter()
            .take(width + 2)
    }

    /// Value of the continuation parameter at a point.
    pub fn parameter_at(&self, point: &Vector) -> f64 {
        point[self.width() * self.zones() + 1] * self.scales.parameter
    }

    /// Excess speed e = |c|/√a − 1 at a point.
    pub fn excess_at(&self, point: &Vector) -> f64 {
        self.scales.excess * point[self.width() * self.zones()].exp()
    }

    /// Speed c = ±√a(1 + e) at a point, with the sign of the branch.
    pub fn speed_at(&self, point: &Vector) -> f64 {
        self.model_at(point).speed(self.excess_at(point)).abs() * self.direction
    }

    /// Entry state (Y, W) of a zone.
    pub fn entry_at(&self, point: &Vector, zone: usize) -> [f64; 2] {
        let first = self.width() * (zone % self.zones());
        [
            point[first] * self.scales.time,
            point[first + 1] * self.scales.rate,
        ]
    }

    /// Layer G at the end of a zone: the part of V̈ there that grows by e^{T/ρ} over it; 0 without
    /// material damping.
    pub fn layer_at(&self, point: &Vector, zone: usize) -> f64 {
        if self.material {
            point[4 * (zone % self.zones()) + 3] * self.scales.layer
        } else {
            0.0
        }
    }

    /// A sliding zone as its flow takes it.
    pub fn slide_at(&self, point: &Vector, zone: usize) -> Slide {
        Slide {
            entry: self.entry_at(point, zone),
            duration: self.duration_at(point, zone),
            layer: self.layer_at(point, zone),
        }
    }

    /// Duration of a zone.
    pub fn duration_at(&self, point: &Vector, zone: usize) -> f64 {
        point[self.width() * (zone % self.zones()) + 2] * self.scales.time
    }

    /// The model at the parameter value of a point.
    pub fn model_at(&self, point: &Vector) -> Model {
        self.model.with(self.parameter, self.parameter_at(point))
    }

    /// Scaled unknowns from physical ones: (Y, W, T, G) for each zone, e, parameter. G counts with
    /// material damping only.
    pub fn pack(&self, zones: &[ZoneUnknowns], excess: f64, parameter: f64) -> Vector {
        let time = self.scales.time;
        let mut point = Vec::with_capacity(4 * zones.len() + 2);
        for [y, w, duration, layer] in zones {
            point.extend([y / time, w / self.scales.rate, duration / time]);
            if self.material {
                point.push(layer / self.scales.layer);
            }
        }
        point.extend([
            (excess / self.scales.excess).ln(),
            parameter / self.scales.parameter,
        ]);
        Vector::from_vec(point)
    }

    /// Physical (Y, W, T, G) of each zone.
    pub fn unpack(&self, point: &Vector) -> Vec<ZoneUnknowns> {
        (0..self.zones())
            .map(|zone| {
                let Slide {
                    entry: [y, w],
                    duration,
                    layer,
                } = self.slide_at(point, zone);
                [y, w, duration, layer]
            })
            .collect()
    }

    /// The numbers of the equations at a point, and their derivative in the parameter.
    fn parameters_at(&self, point: &Vector) -> (Constants, Constants) {
        let value = self.parameter_at(point);
        let mut parameters = self.fixed;
        match self.parameter {
            Parameter::Mismatch => parameters.mismatch = value,
            Parameter::Friction => parameters.friction = value,
            Parameter::MassDamping => parameters.mass_damping = value,
            Parameter::StiffnessDamping => parameters.stiffness_damping = value,
            _ => {
                let model = self.model.with(self.parameter, value);
                return (
                    model.constants().seen(self.direction),
                    model.derivative(self.parameter).seen(self.direction),
                );
            }
        }
        (parameters, self.derivative)
    }

    /// Frame and flows at a point.
    pub fn flows(&self, point: &Vector) -> Result<Flows, FlowError> {
        let (parameters, derivative) = self.parameters_at(point);
        let frame = Frame::new(&parameters, &derivative, self.excess_at(point))?;
        Ok(self.flows_of(frame))
    }

    fn flows_of(&self, frame: Frame) -> Flows {
        Flows::new(frame, self.model.law, self.method, self.material)
    }

    /// Order of the zero just after an entry: of W − 1 in sliding, of U − δ in separation.
    pub fn order_at_entry(&self, entry: Entry) -> usize {
        match entry {
            Entry::Release if self.model.law.jumps_at_release() => 1,
            Entry::TakeOff => 3,
            Entry::Release | Entry::Touch => 2,
            Entry::Reversal | Entry::ArrestedLanding => 1,
            Entry::Arrest | Entry::Landing | Entry::Section => 0,
        }
    }

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
    pub fn has(&self, regime: Regime) -> bool {
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
    pub fn rate_after_switch(&self, flows: &Flows, end: &ZoneEnd, index: usize) -> Jet {
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
    pub fn impulse(&self, flows: &Flows, end: &ZoneEnd) -> Jet {
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

/// Units of the derivatives of a jet in the scaled unknowns.
pub fn jet_units(scales: &Scales) -> [f64; SOURCES] {
    let mut units = [0.0; SOURCES];
    units[ENTRY_Y] = scales.time;
    units[ENTRY_W] = scales.rate;
    units[DURATION] = scales.time;
    units[EXCESS] = 1.0;
    units[PARAMETER] = scales.parameter;
    units[LAYER] = scales.layer;
    units
}
