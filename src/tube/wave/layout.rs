//! The unknowns of a wave: their order and their units.

use serde::{Deserialize, Serialize};

use crate::linalg::Vector;
use crate::tube::flow::jet::{
    DURATION, ENTRY_W, ENTRY_Y, EXCESS, Jet, LAYER, PARAMETER, RADIAL_LAYER, SOURCES,
};
use crate::tube::flow::method::Method;
use crate::tube::flow::{FlowError, Flows, Frame, Slide};
use crate::tube::model::signature::{Regime, Signature, ZoneEntry};
use crate::tube::model::{Constants, Impact, Model, Parameter};

/// Units of the unknowns, constant along a branch: they make every scaled unknown of order one,
/// and they follow the exact scaling (γ, δ, c) → (s²γ, sδ, c/s) of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WaveScales {
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

impl WaveScales {
    /// The units of a branch that begins with a wave of this excess speed and this largest |V̇|;
    /// `width` is that of the range of the parameter.
    pub fn new(model: &Model, mode: u32, excess: f64, largest_rate: f64, width: f64) -> WaveScales {
        let speed = model.speed(excess);
        let coefficients = model.constants().coefficients;
        let rate = RATE_UNITS * largest_rate.abs().max(1.0);
        // m_a = e(2 + e)/(1 + e)²
        let mass = excess * (2.0 + excess) / (1.0 + excess).powi(2);
        WaveScales {
            rate,
            layer: rate * (coefficients.h / mass).sqrt(),
            time: std::f64::consts::TAU / (f64::from(mode) * speed.abs()),
            excess,
            parameter: width,
            pressure: (coefficients.coupling / speed).abs(),
        }
    }
}

/// See [`WaveScales::rate`].
const RATE_UNITS: f64 = 4.0;

/// Unknowns of each zone of a wave: Y, W, T, with material damping G, and G_U where a zone separates.
pub(crate) fn width(material: bool, signature: &Signature) -> usize {
    match material {
        false => 3,
        true if signature.has(Regime::Separation) => 5,
        true => 4,
    }
}

/// The boundary-value problem of one signature.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    /// Model; its continuation parameter is overridden by the unknown.
    pub model: Model,
    /// Continuation parameter, the last of the unknowns.
    pub parameter: Parameter,
    /// Mode k: the wavelength is 2π/k.
    pub mode: u32,
    /// Cyclic sequence of zones over one wavelength.
    pub signature: Signature,
    /// Units of the unknowns, those of the first wave of the branch.
    pub scales: WaveScales,
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

/// A wave at a point, with its frame and flows there.
pub struct WaveAt<'a> {
    /// The boundary-value problem.
    pub wave: &'a Wave,
    /// Its scaled unknowns, as [`Wave::pack`] orders them.
    pub point: &'a Vector,
    /// Frame of its speed and flows of its regimes at this point.
    pub flows: Flows,
}

impl WaveAt<'_> {
    /// A zone as its flow takes it.
    pub(crate) fn slide(&self, zone: usize) -> Slide {
        self.wave.slide_at(self.point, zone)
    }
}

impl Wave {
    /// The boundary-value problem of a signature, with the default method of the friction law.
    pub fn new(
        model: Model,
        parameter: Parameter,
        mode: u32,
        signature: Signature,
        scales: WaveScales,
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
    pub(crate) fn with_material(mut self, material: bool) -> Wave {
        self.material = material;
        self
    }

    /// An undamped wave in the unknowns of material damping: the layers take V̈ at the end of each zone
    /// to its value at the next entry, and in separation they are the jump of the impact.
    ///
    /// # Errors
    /// The flow cannot be evaluated.
    pub(crate) fn with_layers(&self, point: &Vector) -> Result<(Wave, Vector), FlowError> {
        let wave = self.clone().with_material(true);
        let (excess, parameter) = (self.excess_at(point), self.parameter_at(point));
        let mut zones = self.unpack(point);
        let bare = wave.pack(&zones, excess, parameter);
        let at = wave.at(&bare)?;
        for (index, zone) in zones.iter_mut().enumerate() {
            let regime = self.signature.zone(index).regime;
            let end = at.zone_end(index)?;
            if regime == Regime::Separation {
                zone.layer = self.entry_at(point, index + 1)[1] - end.w.value;
                zone.radial = -end.radial_rate.value;
            } else if regime.sliding().is_some() {
                let [_, next] = at.entry_acceleration(index + 1)?;
                zone.layer = next.value - end.acceleration.value;
            }
        }
        let point = wave.pack(&zones, excess, parameter);
        Ok((wave, point))
    }

    /// The same wave under another signature.
    pub(crate) fn with_signature(&self, signature: Signature) -> Wave {
        Wave {
            signature,
            ..self.clone()
        }
    }

    /// Whether a separation zone is shorter than its layers: where it opens or closes the parameter is
    /// stationary.
    pub(crate) fn thinner_than_a_layer(&self, point: &Vector) -> bool {
        let Ok(flows) = self.flows(point) else {
            return false;
        };
        let layered = |zone: &usize| {
            let flow = flows.separation().layered().ok().flatten();
            self.signature.zone(*zone).regime == Regime::Separation
                && flow.is_some_and(|flow| self.duration_at(point, *zone) < flow.thickness())
        };
        self.material && (0..self.zones()).any(|zone| layered(&zone))
    }

    /// Number of zones in one wavelength.
    pub fn zones(&self) -> usize {
        self.signature.len()
    }

    pub(crate) fn width(&self) -> usize {
        width(self.material, &self.signature)
    }

    /// Law of the impact that decides which switches there are. With material damping there is no
    /// impact, but a concentrated reaction with its friction: the same switches, whatever the law.
    pub(crate) fn impact(&self) -> Impact {
        if self.material {
            Impact::Coulomb
        } else {
            self.model.impact
        }
    }

    /// Columns of the derivatives of a jet of a zone, in the order of the jet.
    pub(crate) fn columns(&self, zone: usize) -> impl Iterator<Item = usize> + use<> {
        let width = self.width();
        let first = width * (zone % self.zones());
        let last = width * self.zones();
        let layers = [first + 3, first + 4];
        [first, first + 1, first + 2, last, last + 1]
            .into_iter()
            .chain(layers)
            .take(width + 2)
    }

    /// Whether both halves of the wave are the same, but for rounding of what is singular there.
    pub(crate) fn is_double(&self, point: &Vector) -> bool {
        /// In scaled unknowns: the parameter differs by the square of it.
        const REPEATED: f64 = 1e-3;
        let half = self.zones() / 2;
        let (numbers, alike) = (half * self.width(), |zone: usize| {
            self.signature.zone(zone) == self.signature.zone(zone + half)
        });
        half > 0
            && self.zones() == 2 * half
            && (0..half).all(alike)
            && (0..numbers).all(|index| (point[index] - point[index + numbers]).abs() <= REPEATED)
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

    /// Layers G and G_U at the end of a zone: in sliding the part of V̈ there that grows by e^{T/ρ} over
    /// it, in separation the parts of V̇ and U̇; 0 without material damping.
    pub(crate) fn layers_at(&self, point: &Vector, zone: usize) -> [f64; 2] {
        let width = self.width();
        let first = width * (zone % self.zones());
        let at = |offset: usize| {
            if offset < width {
                point[first + offset]
            } else {
                0.0
            }
        };
        [at(3) * self.layer_unit(zone), at(4) * self.scales.rate]
    }

    /// Unit of G of a zone.
    fn layer_unit(&self, zone: usize) -> f64 {
        match self.signature.zone(zone).regime {
            Regime::Separation => self.scales.rate,
            _ => self.scales.layer,
        }
    }

    /// Derivatives of a jet of a zone in the scaled unknowns.
    pub(super) fn scale(&self, jet: &mut Jet, zone: usize) {
        for (by, unit) in jet.by.iter_mut().zip(self.jet_units(zone)) {
            *by *= unit;
        }
    }

    /// Units of the derivatives of a jet of a zone in the scaled unknowns.
    pub(super) fn jet_units(&self, zone: usize) -> [f64; SOURCES] {
        let mut units = [0.0; SOURCES];
        units[ENTRY_Y] = self.scales.time;
        units[ENTRY_W] = self.scales.rate;
        units[DURATION] = self.scales.time;
        units[EXCESS] = 1.0;
        units[PARAMETER] = self.scales.parameter;
        units[LAYER] = self.layer_unit(zone);
        units[RADIAL_LAYER] = self.scales.rate;
        units
    }

    /// A zone as its flow takes it.
    pub fn slide_at(&self, point: &Vector, zone: usize) -> Slide {
        let [layer, radial] = self.layers_at(point, zone);
        Slide {
            entry: self.entry_at(point, zone),
            duration: self.duration_at(point, zone),
            layer,
            radial,
        }
    }

    /// Duration T of a zone, counted modulo the number of zones, in units of 1/Ω; times |c| it is a length.
    pub fn duration_at(&self, point: &Vector, zone: usize) -> f64 {
        point[self.width() * (zone % self.zones()) + 2] * self.scales.time
    }

    /// The model at the parameter value of a point.
    pub fn model_at(&self, point: &Vector) -> Model {
        self.model.with(self.parameter, self.parameter_at(point))
    }

    /// Scaled unknowns from physical ones: (Y, W, T, G, G_U) for each zone, e, parameter. G and G_U count
    /// with material damping only.
    pub fn pack(&self, zones: &[Slide], excess: f64, parameter: f64) -> Vector {
        let time = self.scales.time;
        let width = self.width();
        let mut point = Vec::with_capacity(width * zones.len() + 2);
        for (index, slide) in zones.iter().enumerate() {
            let Slide {
                entry: [y, w],
                duration,
                layer,
                radial,
            } = slide;
            let unknowns = [
                y / time,
                w / self.scales.rate,
                duration / time,
                layer / self.layer_unit(index),
                radial / self.scales.rate,
            ];
            point.extend(&unknowns[..width]);
        }
        point.extend([
            (excess / self.scales.excess).ln(),
            parameter / self.scales.parameter,
        ]);
        Vector::from_vec(point)
    }

    /// Physical (Y, W, T, G, G_U) of each zone.
    pub fn unpack(&self, point: &Vector) -> Vec<Slide> {
        (0..self.zones())
            .map(|zone| self.slide_at(point, zone))
            .collect()
    }

    /// The numbers of the equations at a point, and their derivative in the parameter.
    pub(super) fn parameters_at(&self, point: &Vector) -> (Constants, Constants) {
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

    /// The wave at a point.
    ///
    /// # Errors
    /// There is no frame of its speed.
    pub fn at<'a>(&'a self, point: &'a Vector) -> Result<WaveAt<'a>, FlowError> {
        Ok(WaveAt {
            wave: self,
            point,
            flows: self.flows(point)?,
        })
    }

    pub(super) fn flows_of(&self, frame: Frame) -> Flows {
        Flows::new(frame, self.model.law, self.method, self.material)
    }

    /// Order of the zero just after an entry: of W − 1 in sliding, of U − δ in separation.
    pub fn order_at_entry(&self, entry: ZoneEntry) -> usize {
        match entry {
            ZoneEntry::Release if self.model.law.jumps_at_release() => 1,
            ZoneEntry::TakeOff => 3,
            ZoneEntry::Release | ZoneEntry::Touch => 2,
            ZoneEntry::Reversal | ZoneEntry::ArrestedLanding => 1,
            ZoneEntry::Arrest | ZoneEntry::Landing | ZoneEntry::Section => 0,
        }
    }
}
