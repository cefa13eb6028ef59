//! What a curve of an event needs to know of the orbits it belongs to.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::point::{Gone, PointType, RegionName, What};
use crate::continuation::newton::Equations;
use crate::linalg::{Matrix, Vector};
use crate::orbit::monitor::MonitorStop;
use crate::orbit::{Data, EventType, Inequalities, Orbit, Zones};

/// Margins of the orbits of a plane.
pub type MarginOf<P> = <<P as PlaneOfOrbits>::Orbit as Zones>::Margin;
/// Their signatures.
pub type SignatureOf<P> = <<P as PlaneOfOrbits>::Orbit as Zones>::Signature;
/// Their parameters.
pub type ParameterOf<P> = <<P as PlaneOfOrbits>::Orbit as Zones>::Parameter;
/// Why one of them is not admissible.
pub type InadmissibleOf<P> = <<P as PlaneOfOrbits>::Orbit as Inequalities>::Inadmissible;
/// Why their equations cannot be evaluated.
pub type FailureOf<P> = <<P as PlaneOfOrbits>::Orbit as Equations>::Failure;
/// What an examination of them finds.
pub type ExaminationOf<P> = <<P as PlaneOfOrbits>::Orbit as Zones>::Examination;

/// A test function of a curve, and what its zero is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// Type of the point where it vanishes, as seen from here; none where it is none.
    pub kind: Option<PointType>,
    /// Its value.
    pub value: f64,
    /// Whether the curve ends there.
    pub ends: bool,
}

/// What a plane watches at a point, beside the margins and the fold.
#[derive(Clone, Debug, Default)]
pub struct TestValues {
    /// Test functions in a fixed order. One whose value is not finite is not looked at.
    pub tests: Vec<Test>,
    /// How many multipliers are outside the unit circle beside those of the event, which are on it; `None` where that is
    /// not known, or not asked.
    pub outside: Option<usize>,
}

/// What makes the orbit special.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum EventCondition<P: SpectralEvents> {
    /// A margin vanishes.
    Margin(MarginOf<P>),
    /// A monitor keeps a value.
    Constant(MonitorStop),
    /// Fold in either parameter.
    Fold,
    /// An event of the spectrum.
    Spectral(P::Spectral),
}

/// Why the equations could not be evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(bound = "")]
pub enum NotEvaluated<P: SpectralEvents> {
    /// The flow overflows, the wave is subsonic, or the system makes no sense there.
    #[error("{0}")]
    Flow(FailureOf<P>),
    /// There is no eigenfunction problem.
    #[error("{0}")]
    Linear(P::NotLinearised),
}

/// Orbits over a plane of two parameters, beside their signature.
pub trait PlaneOfOrbits: Data {
    /// The orbits, posed in one of the two parameters.
    type Orbit: Orbit<Margin: Data>;
    /// What a margin measures.
    type Watch: Data + Copy;

    /// The two parameters.
    fn parameters(&self) -> [ParameterOf<Self>; 2];

    /// Their units.
    fn widths(&self) -> [f64; 2];

    /// Their values where the curve begins.
    fn values(&self) -> [f64; 2];

    /// Whether a parameter has no values below zero.
    fn is_bounded(&self, _index: usize) -> bool {
        false
    }

    /// Whether a parameter may have this value.
    fn admits(&self, index: usize, value: f64) -> bool;

    /// Number of unknowns of an orbit, its parameter left out.
    fn unknowns(&self, signature: &SignatureOf<Self>) -> usize;

    /// Number of zones.
    fn zones(signature: &SignatureOf<Self>) -> usize;

    /// The orbits of a signature at values of the parameters, posed in one of them.
    ///
    /// # Errors
    /// The system makes no sense there.
    fn orbit(
        &self,
        signature: &SignatureOf<Self>,
        values: [f64; 2],
        index: usize,
    ) -> Result<Self::Orbit, FailureOf<Self>>;

    /// How many times longer than elsewhere steps from such unknowns of an orbit may be: more than 1 where they are much larger
    /// than their units.
    fn stretch(_unknowns: &[f64]) -> f64 {
        1.0
    }

    /// Length of a zone.
    fn length(orbit: &Self::Orbit, point: &Vector, zone: usize) -> f64;

    /// What a margin measures, and in which zone.
    fn key(margin: &MarginOf<Self>) -> (Self::Watch, usize);
}

/// Events of the spectrum of the orbits over a plane, and their equations.
pub trait SpectralEvents: PlaneOfOrbits {
    /// An event of the spectrum.
    type Spectral: Data;
    /// Why it cannot be evaluated.
    type NotLinearised: Data + std::error::Error;
    /// Whether events of the spectrum have a Bloch sector.
    const HAS_SECTORS: bool;

    /// Its equations.
    ///
    /// # Errors
    /// They cannot be evaluated.
    fn spectral(
        &self,
        spectral: &Self::Spectral,
        orbit: &Self::Orbit,
        point: &Vector,
        further: &[f64],
    ) -> Result<Vec<f64>, NotEvaluated<Self>>;

    /// The multipliers on which its equation depends where it vanishes, each with the factor of its own derivative in that of
    /// the equation, of which the real part counts; `None` where that is found by differences.
    fn critical(
        &self,
        _: &Self::Spectral,
        _: &Self::Orbit,
        _: &Vector,
    ) -> Option<Vec<(Complex<f64>, Complex<f64>)>> {
        None
    }

    /// Number of further unknowns of an event of the spectrum; it has one equation more.
    fn further(_spectral: &Self::Spectral) -> usize {
        0
    }

    /// Step of central differences in its equations, in scaled unknowns of order one: where truncation and rounding both stay
    /// near 1e-10 of the derivative, far below what keeps Newton's convergence fast.
    fn difference(_spectral: &Self::Spectral) -> f64 {
        1e-5
    }

    /// Whether its equations depend on the unknowns of the orbit, beside the parameters.
    fn is_of_orbit(_spectral: &Self::Spectral) -> bool {
        true
    }

    /// Whether a perturbation of the event has the other sign after a period: its equations are those of a null vector then,
    /// which is as long as the unknowns of the orbit.
    fn is_doubling(_spectral: &Self::Spectral) -> bool {
        false
    }

    /// What of the derivatives of the equations of an orbit is that of the beginning of the next period.
    ///
    /// # Errors
    /// They cannot be evaluated.
    fn closing(_: &Self::Orbit, point: &Vector) -> Result<Matrix, FailureOf<Self>> {
        Ok(Matrix::zeros(point.len() - 1, point.len()))
    }

    /// Takes what normalises further unknowns, or what the event is known from, to where they are now.
    fn settle(
        &self,
        _: &mut Self::Spectral,
        _orbit: &Self::Orbit,
        _point: &Vector,
        _further: &[f64],
    ) {
    }

    /// The same event with other further unknowns, and what normalises these, where they are better than those it has.
    fn renewed(_: &Self::Spectral, _further: &[f64]) -> Option<(Self::Spectral, Vec<f64>)> {
        None
    }

    /// Why a solution of the equations of an event of the spectrum has the event no more.
    fn lost(
        &self,
        _: &Self::Spectral,
        _: &Self::Orbit,
        _point: &Vector,
        _further: &[f64],
    ) -> Option<Gone> {
        None
    }

    /// Its frequency or angle.
    fn angular(
        &self,
        spectral: &Self::Spectral,
        orbit: &Self::Orbit,
        point: &Vector,
        further: &[f64],
    ) -> Option<f64>;

    /// Bloch sector of an event of the spectrum.
    fn sector(_spectral: &Self::Spectral) -> Option<usize> {
        None
    }
}

/// What curves of events need over a plane beside the equations of orbits and of the spectrum, and what is watched along them.
pub trait EventCurves: SpectralEvents {
    /// Events that have a curve.
    const FOLLOWED: &'static [EventType];
    /// Whether curves are smooth in the duration of a zone that shrinks where their equations are singular.
    const CLOSES: bool = false;

    /// Puts in the place of equations of the orbit those that the event needs, where it makes them singular.
    ///
    /// # Errors
    /// They cannot be evaluated.
    fn restrict(
        &self,
        _: &EventCondition<Self>,
        _: &Self::Orbit,
        _: &Vector,
        _equations: (&mut [f64], &mut Matrix),
    ) -> Result<(), FailureOf<Self>> {
        Ok(())
    }

    /// All equations of an event of one signature, and their derivatives, in its unknowns, where the plane has them itself: with
    /// exact derivatives in both parameters. `None` where they are those of an orbit and of the condition.
    fn extended(
        &self,
        _: &SignatureOf<Self>,
        _: &EventCondition<Self>,
        _point: &Vector,
        _equations: (&mut [f64], &mut Matrix),
    ) -> Option<Result<(), FailureOf<Self>>> {
        None
    }

    /// Further unknowns, or the null vector, of a known point of the curve as they would be beside another point, with what
    /// normalises them now: a curve that comes back may have turned them. `None` where they are the same.
    fn alias(_: &EventCondition<Self>, _further: &[f64], _near: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// What is watched beside the margins and the fold.
    fn watched(
        &self,
        condition: &EventCondition<Self>,
        orbit: &Self::Orbit,
        point: &Vector,
        further: &[f64],
    ) -> TestValues;

    /// The rates of guards that are zero where a zone begins along the whole curve, as margins that vanish tell: where
    /// one passes zero the guard falls below it in the zone.
    fn onsets(_: &(Self::Orbit, Vector), _own: &[(Self::Watch, usize)]) -> Vec<Test> {
        Vec::new()
    }

    /// Whether det F_x, where it is regular beside the curve, tells a fold of its orbits.
    fn tells_fold(condition: &EventCondition<Self>, _: &Self::Orbit) -> bool {
        *condition != EventCondition::Fold
    }

    /// Type of a point at which an orbit of an event has a fold, too.
    fn with_fold(event: EventType) -> PointType {
        Self::with_event(event, EventType::LP)
    }

    /// Type of a point of two events, of which the first one is followed.
    fn with_event(event: EventType, other: EventType) -> PointType {
        PointType::Two(event, other)
    }

    /// Size of an orbit, in units of its states, where it is at most this and orbits that shrink to a point make the equations
    /// singular.
    fn extent(
        _: &EventCondition<Self>,
        _orbit: &Self::Orbit,
        _point: &Vector,
        _most: f64,
    ) -> Option<f64> {
        None
    }

    /// Whether an orbit sets out the other way round than one before it, as it does beyond a point of no size.
    fn turns(_: &ExaminationOf<Self>, _before: &ExaminationOf<Self>) -> bool {
        false
    }

    /// Type of the point at which orbits of an event shrink to a point, as seen from one next to it.
    fn at_limit(
        event: EventType,
        _: &EventCondition<Self>,
        _: &Self::Orbit,
        _point: &Vector,
    ) -> PointType {
        PointType::One(event)
    }
}

/// What results call the orbits over a plane, and what they tell of a point.
pub trait PlaneNames: EventCurves {
    /// Why a branch with the event does not begin.
    type NoBranch: Clone + std::fmt::Debug + PartialEq + std::error::Error;
    /// What is carried along a branch through an event of the spectrum, to name places beside it.
    type Beside;
    /// What one of them is called.
    const ORBIT: &'static str;
    /// What several of them are called.
    const ORBITS: &'static str;
    /// Most steps of all branches that are followed to name places beside a curve: about as long as the curve itself
    /// took, or a second.
    const ALL_STEPS: usize;
    /// Longest of these steps beside an event of the spectrum, in units of the range.
    const LONGEST_BESIDE: f64;
    /// Name of the column of [`super::Point::measure`], where they have one.
    const MEASURE: Option<&'static str>;
    /// Name of the column of [`super::Point::angular`].
    const ANGULAR: &'static str;
    /// Its symbol.
    const SYMBOL: &'static str;

    /// Name of a zone.
    fn zone(signature: &SignatureOf<Self>, zone: usize) -> String;

    /// The two guards, in the order of their names, whose zeros meet where the duration of a zone vanishes; `None` for other
    /// margins, and where the name of the zone tells.
    fn guards_of_duration(_: &Self::Orbit, _: &MarginOf<Self>) -> Option<[String; 2]> {
        None
    }

    /// Name of an orbit.
    fn name(orbit: &Self::Orbit, point: &Vector) -> String;

    /// The name of an orbit that passes beside a change of regime.
    fn passing(orbit: &Self::Orbit, point: &Vector) -> String {
        Self::name(orbit, point)
    }

    /// What every point tells of its orbit: the speed of a wave, the period of an orbit; and the excess speed.
    fn measure(orbit: &Self::Orbit, point: &Vector) -> (f64, Option<f64>);

    /// Names of the columns of [`super::Point::numbers`].
    fn columns(&self) -> Vec<String> {
        Vec::new()
    }

    /// What every point tells in these columns.
    fn numbers(
        &self,
        _: &EventCondition<Self>,
        _: &Self::Orbit,
        _point: &Vector,
        _further: &[f64],
    ) -> Vec<Option<f64>> {
        Vec::new()
    }

    /// What is carried along a branch through an event of the spectrum, with its frequency or angle there.
    fn beside(&self, spectral: &Self::Spectral, angular: Option<f64>) -> Option<Self::Beside>;

    /// What it calls the next point of the branch, of this type, if anything; `None` where it is lost.
    fn name_beside(
        beside: &mut Self::Beside,
        orbit: &Self::Orbit,
        point: &Vector,
        kind: Option<EventType>,
    ) -> Option<Option<RegionName>>;

    /// A sentence of what happens.
    fn say(what: &What<Self::Orbit>) -> String;
}

/// A plane of two parameters in which curves of events are followed.
pub trait ParameterPlane: PlaneNames {}

impl<P: PlaneNames> ParameterPlane for P {}
