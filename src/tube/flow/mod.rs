//! Exact flow of one regime along a material point, with exact derivatives.
//!
//! A wave of speed c depends on θ = φ − ct alone. Following one material point forward in time s,
//! ∂/∂φ = −(1/c) d/ds turns (M) into linear equations with constant coefficients; for β = 0
//!
//! ```text
//! slip, reverse (σ = ±1):  m_a V̈ − (σfκ − α)V̇ + hV = σfgδ,     P = gδ + κV̇,  Q = σfP
//! stick:                   V̇ = 1,                               P = gδ + κ,   Q = hV + α
//! separation:              m_b Ü + αU̇ + gU + κV̇ = 0,  m_a V̈ + αV̇ + hV − κU̇ = 0
//! m_a = 1 − a/c²,  m_b = 1 − b/c²,  κ = D/c > 0.
//! ```
//!
//! The tangential displacement is measured from that of steady sliding, Y = V − fgδ/h: slip-stick
//! waves then do not depend on δ at all, and no digits are lost where δ is large.
//! W stands for V̇ throughout. Material damping β > 0 raises the order of the sliding equations:
//! [`material`].

use std::cell::OnceCell;

pub mod contact;
pub(crate) mod exponential;
mod frame;
pub mod friction;
pub mod jet;
pub mod layered;
pub mod material;
pub mod method;
pub mod numeric;
pub(crate) mod piece;
pub mod separation;

mod solvent;
mod square;

use serde::{Deserialize, Serialize};

use crate::tube::model::FrictionLaw;
use crate::tube::model::signature::Regime;
use contact::ContactFlow;
pub use frame::{Frame, Quantities};
use jet::{DURATION, Jet};
use layered::LayeredFlow;
use material::MaterialFlow;
use method::Method;
use numeric::{Integrator, NumericalContact, NumericalSeparation};
use piece::SeparationPiece;
use separation::SeparationFlow;

/// Why a method cannot solve the equations of a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
pub enum Unsolved {
    /// The exponents of sliding coincide to rounding.
    #[error("the exponents of sliding with material damping cannot be told apart")]
    SlidingExponents,
    /// The exponents of separation coincide to rounding.
    #[error("the exponents of separation with material damping cannot be told apart")]
    SeparationExponents,
    /// A Runge–Kutta method gives up.
    #[error("the step of the Runge–Kutta method became too small or too many were needed")]
    Steps,
    /// The solution is not finite.
    #[error("the solution leaves the range of double precision")]
    Overflow,
    /// A matrix of collocation has no inverse.
    #[error("the collocation matrix is singular")]
    Singular,
    /// Newton's method for the collocation equations runs away.
    #[error("the collocation equations diverge")]
    Diverges,
    /// Newton's method does not come to an end.
    #[error("Newton's method on a mesh interval does not converge")]
    NotConverged,
}

/// Why a flow cannot be evaluated. Inside a continuation step either rejects the step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum FlowError {
    /// |c| ≤ √a: the equations along the material point lose their type.
    #[error("the wave is not supersonic: its excess speed |c|/√a − 1 = {excess:e} is not positive")]
    Subsonic {
        /// e = |c|/√a − 1.
        excess: f64,
    },
    /// A numerical method could not solve the equations of a zone.
    #[error("a zone of duration {duration:e} could not be integrated: {reason}")]
    Integration {
        /// Duration of the zone, in units of 1/Ω.
        duration: f64,
        /// Why the method gave up.
        reason: Unsolved,
    },
    /// A zone turns too often for its inequalities to be verified.
    #[error(
        "a zone of duration {duration:e} turns through {radians:.1e} radians, more than the \
         {most:.0e} through which inequalities are verified: |c| is close to √a"
    )]
    Winding {
        /// Duration of the zone, in units of 1/Ω.
        duration: f64,
        /// Bound of the radians through which it turns.
        radians: f64,
        /// Radians up to which inequalities are verified.
        most: f64,
    },
    /// A zone grew beyond the range of double precision.
    #[error("a zone of duration {duration:e} leaves the range of double precision")]
    Overflow {
        /// Duration of the zone, in units of 1/Ω.
        duration: f64,
    },
}

/// A zone: where it begins, how long it lasts and, with material damping, how it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide {
    /// (Y, W) = (V − fgδ/h, V̇) at the entry.
    pub entry: [f64; 2],
    /// Duration T, in units of 1/Ω.
    pub duration: f64,
    /// Amplitude G of the boundary layer at the end, see [`material`], in separation G_V of
    /// [`layered`]; 0 without material damping.
    pub layer: f64,
    /// Amplitude G_U of the radial layer at the end of separation, see [`layered`]; otherwise 0.
    pub radial: f64,
}

impl Slide {
    /// A zone without layers, as every zone is without material damping.
    pub fn bare(entry: [f64; 2], duration: f64) -> Slide {
        Slide {
            entry,
            duration,
            layer: 0.0,
            radial: 0.0,
        }
    }

    /// (Y, W, T), which is all of it without material damping.
    pub(crate) fn without_layers(&self) -> [f64; 3] {
        let [y, w] = self.entry;
        [y, w, self.duration]
    }
}

/// End of a zone: state and the function whose zero ends the zone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ZoneEnd {
    /// Y at the end.
    pub y: Jet,
    /// W at the end, before any jump of the switch.
    pub w: Jet,
    /// U̇ at the end; zero in contact.
    pub radial_rate: Jet,
    /// V̈ at the end of sliding; only with material damping, where it is continuous.
    pub acceleration: Jet,
    /// The switching function, divided by duration^m where it has an m-fold zero at the entry.
    pub switching: Jet,
    /// The second condition of a landing with material damping, see [`LayeredFlow::zone`].
    pub second: Jet,
    /// β(Ü, V̈) at the end of separation with material damping: what is left of an impulse.
    pub impulse: [Jet; 2],
}

/// Flow of a sliding zone, by the method of the problem.
#[derive(Clone, Debug)]
pub enum SlidingFlow {
    /// In closed form: friction does not depend on the velocity, and there is no material damping.
    Exact(ContactFlow),
    /// In closed form, with material damping.
    Material(Box<MaterialFlow>),
    /// By a numerical method, under any law of friction.
    Numerical(Box<NumericalContact>),
}

impl SlidingFlow {
    /// (Y, W) after a time t from the entry.
    pub fn state(&self, slide: &Slide, t: f64) -> Result<[f64; 2], FlowError> {
        match self {
            SlidingFlow::Exact(flow) => Ok(flow.state(slide.entry, t)),
            SlidingFlow::Material(flow) => Ok(flow.motion(slide, t).state),
            SlidingFlow::Numerical(flow) => flow.within(slide.entry, slide.duration, t),
        }
    }

    /// Sizes of the terms of which (Y, W) at the end of a zone is the sum, by a closed form.
    pub(crate) fn terms(&self, slide: &Slide) -> Option<[f64; 2]> {
        let flow = match self {
            SlidingFlow::Exact(flow) => flow,
            SlidingFlow::Material(flow) => &flow.slow,
            SlidingFlow::Numerical(_) => return None,
        };
        Some(flow.terms(slide.entry, slide.duration))
    }

    /// (Y, W) at increasing times within a zone.
    pub(crate) fn states(&self, slide: &Slide, times: &[f64]) -> Result<Vec<[f64; 2]>, FlowError> {
        match self {
            SlidingFlow::Numerical(flow) => flow.states(slide.entry, slide.duration, times),
            _ => times.iter().map(|time| self.state(slide, *time)).collect(),
        }
    }

    /// W and P at a fixed time t inside the zone, with all derivatives.
    pub(crate) fn inside(
        &self,
        frame: &Frame,
        slide: &Slide,
        t: f64,
    ) -> Result<[Jet; 2], FlowError> {
        let mut w = match self {
            SlidingFlow::Exact(flow) => flow.advance(slide.entry, t)?[1],
            SlidingFlow::Material(flow) => {
                let [_, w, acceleration] = flow.inside(slide, t)?;
                let drive = w + frame.material() * acceleration;
                return Ok([w, frame.pressure(drive)]);
            }
            SlidingFlow::Numerical(flow) => flow.zone(slide.entry, t, 0)?[1],
        };
        w.by[DURATION] = 0.0;
        Ok([w, frame.pressure(w)])
    }

    /// The end of a zone. Its switching function is (W − 1)/t^m, m being the order of the zero of
    /// W − 1 at the entry; for m = 0 W − 1. With material damping: [`MaterialFlow::zone`];
    /// `arrested` says that the zone ends in stick.
    pub(crate) fn zone(
        &self,
        slide: &Slide,
        m: usize,
        arrested: bool,
    ) -> Result<ZoneEnd, FlowError> {
        let Slide {
            entry, duration: t, ..
        } = *slide;
        let [y, w, switching] = match self {
            SlidingFlow::Exact(flow) => {
                let [y, w] = flow.advance(entry, t)?;
                let reduced = match m {
                    0 => w - 1.0,
                    m => flow.reduced_rate(entry, t, m, w),
                };
                [y, w, reduced]
            }
            SlidingFlow::Material(flow) => return flow.zone(slide, m, arrested),
            SlidingFlow::Numerical(flow) => flow.zone(entry, t, m)?,
        };
        Ok(ZoneEnd {
            y,
            w,
            switching,
            ..ZoneEnd::default()
        })
    }

    /// V̈ at a time t, where the state is `state`.
    pub fn acceleration(&self, slide: &Slide, t: f64, state: [f64; 2]) -> f64 {
        match self {
            SlidingFlow::Exact(flow) => flow.acceleration(state),
            SlidingFlow::Material(flow) => flow.motion(slide, t).acceleration,
            SlidingFlow::Numerical(flow) => flow.acceleration(state),
        }
    }

    /// W + βV̈ at a time t, where the state is `state`: P = gδ + κ(W + βV̈).
    pub fn drive(&self, slide: &Slide, t: f64, state: [f64; 2]) -> f64 {
        match self {
            SlidingFlow::Material(flow) => {
                state[1] + flow.beta * flow.motion(slide, t).acceleration
            }
            _ => state[1],
        }
    }

    /// V̈ at a state as it is without the layer of material damping.
    pub(crate) fn outer_acceleration(&self, state: [f64; 2]) -> f64 {
        match self {
            SlidingFlow::Exact(flow) => flow.acceleration(state),
            SlidingFlow::Material(flow) => flow.slow.acceleration(state),
            SlidingFlow::Numerical(flow) => flow.acceleration(state),
        }
    }

    /// The third derivative of V at a time t, where the state is `state`.
    pub(crate) fn jerk(&self, slide: &Slide, t: f64, state: [f64; 2]) -> f64 {
        match self {
            SlidingFlow::Exact(flow) => 2.0 * flow.p * flow.acceleration(state) - flow.q * state[1],
            SlidingFlow::Material(flow) => flow.motion(slide, t).jerk,
            SlidingFlow::Numerical(flow) => flow.jerk(state),
        }
    }

    /// Times in (0, duration) at which V̈ vanishes, the beginning left out where it vanishes there
    /// (`at_rest`: W − 1 has a double zero at the entry). In closed form all of them; by a numerical
    /// method those that its samples show.
    pub(crate) fn turning_points(
        &self,
        slide: &Slide,
        at_rest: bool,
    ) -> Result<Vec<f64>, FlowError> {
        /// A zero of V̈ closer to a release than this, in radians, is the release itself.
        const AT_RELEASE: f64 = 1e-6;
        let Slide {
            entry, duration, ..
        } = *slide;
        match self {
            SlidingFlow::Exact(flow) => {
                let acceleration = flow.acceleration(entry);
                let jerk = 2.0 * flow.p * acceleration - flow.q * entry[1];
                // V̈ = 0 at a release by the switching condition, not to the last digit
                let (acceleration, near) = if at_rest {
                    (0.0, AT_RELEASE / flow.q.sqrt())
                } else {
                    (acceleration, 0.0)
                };
                let mut times = flow.zeros(acceleration, jerk, duration);
                times.retain(|time| *time > near);
                Ok(times)
            }
            SlidingFlow::Material(flow) => Ok(flow.turning_points(slide, at_rest)),
            SlidingFlow::Numerical(flow) => flow.turning_points(entry, duration, at_rest),
        }
    }

    /// Times in (0, duration) at which W vanishes: extremes of V.
    pub(crate) fn extremes(&self, slide: &Slide) -> Result<Vec<f64>, FlowError> {
        let Slide {
            entry, duration, ..
        } = *slide;
        match self {
            SlidingFlow::Exact(flow) => {
                Ok(flow.zeros(entry[1], flow.acceleration(entry), duration))
            }
            SlidingFlow::Material(flow) => Ok(flow.extremes(slide)),
            SlidingFlow::Numerical(flow) => flow.extremes(entry, duration),
        }
    }
}

/// Flow of a separation zone, by the method of the problem.
#[derive(Clone, Debug)]
pub enum FreeFlow {
    /// By the matrix exponential, without material damping.
    Exact(Box<SeparationFlow>),
    /// By matrix exponentials, with material damping; or why there is none in this frame.
    Material(Result<Box<LayeredFlow>, FlowError>),
    /// By a numerical method.
    Numerical(Box<NumericalSeparation>),
}

impl FreeFlow {
    /// The flow with material damping.
    pub(crate) fn layered(&self) -> Result<Option<&LayeredFlow>, FlowError> {
        match self {
            FreeFlow::Material(Ok(flow)) => Ok(Some(flow)),
            FreeFlow::Material(Err(error)) => Err(*error),
            _ => Ok(None),
        }
    }

    /// Radians per unit of time: a bound of the rates of the flow.
    pub fn norm(&self) -> f64 {
        match self {
            FreeFlow::Exact(flow) => flow.norm(),
            FreeFlow::Material(flow) => flow.as_ref().map_or(f64::NAN, |flow| flow.norm()),
            FreeFlow::Numerical(flow) => flow.norm(),
        }
    }

    /// (U, U̇, Y, W) at a time t within a zone.
    pub fn state(&self, slide: &Slide, t: f64) -> Result<[f64; 4], FlowError> {
        match self {
            FreeFlow::Exact(flow) => flow.state(slide.entry, t),
            FreeFlow::Material(flow) => flow.as_ref().map_err(|error| *error)?.state(slide, t),
            FreeFlow::Numerical(flow) => flow.state(slide.entry, t),
        }
    }

    /// U at a time t within a zone, with all derivatives at this time held fixed.
    pub(crate) fn radial(&self, slide: &Slide, t: f64) -> Result<Jet, FlowError> {
        let mut u = match self {
            FreeFlow::Exact(flow) => flow.advance(slide.entry, t)?[0],
            FreeFlow::Material(flow) => {
                let flow = flow.as_ref().map_err(|error| *error)?;
                return Ok(flow.motion(slide, t)?.position[0]);
            }
            FreeFlow::Numerical(flow) => flow.advance(slide.entry, t)?[0],
        };
        u.by[DURATION] = 0.0;
        Ok(u)
    }

    /// U̇/Ü at a time t within a zone: Newton's step towards an extreme of U.
    pub(crate) fn step_to_extreme(
        &self,
        frame: &Frame,
        slide: &Slide,
        t: f64,
    ) -> Result<f64, FlowError> {
        if let Some(flow) = self.layered()? {
            let motion = flow.motion::<0>(slide, t)?;
            return Ok(motion.rate[0].value / motion.acceleration[0].value);
        }
        let at = &frame.at;
        let [u, rate, _, w] = self.state(slide, t)?;
        let acceleration = -(at.damping * rate + at.g * u + at.kappa * w) / at.mb;
        Ok(rate / acceleration)
    }

    /// Pieces of a zone, U − δ having a zero of this order at the entry.
    pub(crate) fn pieces(
        &self,
        frame: &Frame,
        slide: &Slide,
        order: usize,
    ) -> Result<Vec<SeparationPiece>, FlowError> {
        match self.layered()? {
            Some(flow) => flow.pieces(slide, order),
            None => Ok(piece::undamped(frame, self.norm(), slide, order)),
        }
    }

    /// The zone to its end; the switching function is (U − δ)/t^m, with material damping see
    /// [`LayeredFlow::zone`].
    pub(crate) fn zone(&self, slide: &Slide, m: usize) -> Result<ZoneEnd, FlowError> {
        let t = slide.duration;
        match self {
            FreeFlow::Exact(flow) => flow.zone(slide.entry, t, m),
            FreeFlow::Material(flow) => flow.as_ref().map_err(|error| *error)?.zone(slide, m),
            FreeFlow::Numerical(flow) => flow.zone(slide.entry, t, m),
        }
    }
}

/// The flows of one frame, each made when a zone first asks for it.
pub struct Flows {
    /// The frame in which their equations are posed.
    pub frame: Frame,
    law: FrictionLaw,
    material: bool,
    integrator: Option<Integrator>,
    slip: OnceCell<SlidingFlow>,
    reverse: OnceCell<SlidingFlow>,
    separation: OnceCell<FreeFlow>,
}

impl Flows {
    /// The flows of a frame by a method; `material` says whether material damping enters.
    pub(crate) fn new(frame: Frame, law: FrictionLaw, method: Method, material: bool) -> Flows {
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

    /// Flow of separation, by the method of these flows.
    pub fn separation(&self) -> &FreeFlow {
        self.separation.get_or_init(|| {
            if self.material {
                return FreeFlow::Material(LayeredFlow::new(&self.frame).map(Box::new));
            }
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
