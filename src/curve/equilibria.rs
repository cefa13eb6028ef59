//! Equilibria of a user's system over a plane of two parameters.

use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use super::plane::{
    EventCondition, EventCurves, NotEvaluated, PlaneNames, PlaneOfOrbits, SpectralEvents, Test,
    TestValues,
};
use super::point::{Gone, PointType, RegionName, What};
use super::watched::passed;
use crate::affine::connection::Connection;
use crate::affine::equilibrium::codimension::KeptEigenvalues;
use crate::affine::equilibrium::plane::{
    CriticalUnknowns, EquilibriumPlane, PairVectors, SpecialCondition,
};
use crate::affine::equilibrium::{
    EquilibriumCurve, EquilibriumFailure, EquilibriumMargin, EquilibriumScales, RestMode,
};
use crate::affine::monitor::{Monitor, MonitorSource};
use crate::affine::monitored;
use crate::affine::system::{Ordered, System};
use crate::continuation::branch_point::PERFECT;
use crate::hybrid::equilibrium::NoEquilibriumStart;
use crate::linalg::{Matrix, Vector};
use crate::orbit::{EventType, Zones};

/// All that an equilibrium needs beside its mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriaInPlane {
    system: System,
    values: Vec<f64>,
    parameters: [usize; 2],
    widths: [f64; 2],
    scales: EquilibriumScales,
    /// The monitor that keeps its value, by its name, where one does.
    #[serde(default, skip_serializing_if = "Ordered::is_empty")]
    monitor: Ordered<MonitorSource>,
    #[serde(skip)]
    posed: PosedPlane,
}

/// The plane, posed where it is first asked for: it follows from the rest.
#[derive(Clone, Debug, Default)]
struct PosedPlane(Arc<OnceLock<Option<EquilibriumPlane>>>);

impl PartialEq for PosedPlane {
    fn eq(&self, _: &PosedPlane) -> bool {
        true
    }
}

/// An event of the eigenvalues, with the vector that normalises the critical one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum CriticalEquilibrium {
    /// A pair ± iω.
    Pair {
        /// c of c·a = 1, c·r = 0.
        near: Vec<f64>,
    },
    /// Another branch passes.
    Crossing {
        /// d of d·ψ = 1.
        near: Vec<f64>,
    },
    /// An orbit leaves it, a saddle, and returns, or comes to another one.
    Connection(Box<Connection>),
}

impl EquilibriaInPlane {
    /// Those beside an equilibrium, of a branch with `known` units; `widths` are the units of the parameters.
    ///
    /// # Errors
    /// Rates or guards have no finite value there.
    pub fn new(
        curve: &EquilibriumCurve,
        point: &Vector,
        parameters: [usize; 2],
        widths: [f64; 2],
        known: Option<&EquilibriumScales>,
    ) -> Result<EquilibriaInPlane, EquilibriumFailure> {
        Ok(EquilibriaInPlane {
            system: curve.setting.system.clone().with_monitors(Vec::new()),
            values: curve.values_at(point),
            parameters,
            widths,
            scales: curve.wide_scales(point, known)?,
            monitor: Ordered::default(),
            posed: PosedPlane::default(),
        })
    }

    /// The same with a monitor that keeps its value.
    pub fn keeping(self, monitor: &Monitor) -> EquilibriaInPlane {
        EquilibriaInPlane {
            monitor: Ordered(vec![(monitor.name.clone(), monitor.source.clone())]),
            posed: PosedPlane::default(),
            ..self
        }
    }

    fn plane(&self, signature: &RestMode) -> Result<&EquilibriumPlane, EquilibriumFailure> {
        let posed = self.posed.0.get_or_init(|| {
            let system = monitored::keeping(&self.system, &self.monitor);
            EquilibriumPlane::new(
                (&system, &self.values),
                self.parameters,
                &self.scales,
                self.widths,
            )
        });
        posed.as_ref().ok_or_else(|| no_value(signature))
    }

    /// ω² in the unit of the unknown κ.
    fn omega(&self, further: &[f64]) -> f64 {
        let kappa = further.last().copied().unwrap_or(f64::NAN);
        kappa.max(0.0).sqrt() * self.scales.rate
    }
}

fn no_value(signature: &RestMode) -> EquilibriumFailure {
    EquilibriumFailure::NoValue {
        mode: signature.name.clone(),
    }
}

/// What changes its sign where a pair of eigenvalues other than those that are kept comes to the sum zero. Two real ones are no
/// event.
fn test_of_pair(
    curve: &EquilibriumCurve,
    point: &Vector,
    (kind, kept): (PointType, KeptEigenvalues),
) -> Test {
    let sums = curve.pair_sums(point, kept);
    let kind = sums.filter(|sums| sums.is_complex).map(|_| kind);
    passed(kind, sums.map_or(f64::NAN, |sums| sums.value))
}

/// What is watched at a kink, on both sides of it: an eigenvalue that is zero on one ends what the kink does, and an imaginary pair a jump.
fn tests_at_kink(sides: [&EquilibriumCurve; 2], point: &Vector) -> Vec<Test> {
    let determinants = sides.map(|side| side.determinant(point).unwrap_or(f64::NAN));
    let [one, other] = determinants;
    let turns = one * other < 0.0;
    let zeros = determinants.map(|value| Test {
        ends: true,
        ..passed(Some(PointType::One(EventType::LP)), value)
    });
    let hopf = (PointType::One(EventType::HB), KeptEigenvalues::None);
    let pairs = sides.map(|side| {
        let test = test_of_pair(side, point, hopf);
        Test {
            ends: !turns && test.kind.is_some(),
            ..test
        }
    });
    zeros.into_iter().chain(pairs).collect()
}

impl PlaneOfOrbits for EquilibriaInPlane {
    type Orbit = EquilibriumCurve;
    type Watch = usize;

    fn parameters(&self) -> [String; 2] {
        let name = |index| self.system.source.parameters.names().nth(index);
        self.parameters
            .map(|index| name(index).unwrap_or_default().to_owned())
    }

    fn widths(&self) -> [f64; 2] {
        self.widths
    }

    fn values(&self) -> [f64; 2] {
        self.parameters.map(|index| self.values[index])
    }

    /// Where a parameter is positive the system may make sense for positive ones only.
    fn admits(&self, index: usize, value: f64) -> bool {
        self.values()[index] * value > 0.0
    }

    fn unknowns(&self, _: &RestMode) -> usize {
        self.system.source.states.len()
    }

    /// The mode itself.
    fn zones(_: &RestMode) -> usize {
        1
    }

    fn orbit(
        &self,
        signature: &RestMode,
        values: [f64; 2],
        index: usize,
    ) -> Result<EquilibriumCurve, EquilibriumFailure> {
        let plane = self.plane(signature)?;
        let curve = plane.curve(signature, values, index);
        curve.ok_or_else(|| no_value(signature))
    }

    /// The units are those of the first equilibrium, beside which another may be many times as large.
    fn stretch(states: &[f64]) -> f64 {
        states.iter().fold(1.0, |most: f64, x| most.max(x.abs()))
    }

    /// Equilibria have no zones.
    fn length(_: &EquilibriumCurve, _: &Vector, _: usize) -> f64 {
        f64::NAN
    }

    fn key(margin: &EquilibriumMargin) -> (usize, usize) {
        (margin.guard, 0)
    }
}

impl SpectralEvents for EquilibriaInPlane {
    type Spectral = CriticalEquilibrium;
    type NotLinearised = EquilibriumFailure;
    const HAS_SECTORS: bool = false;

    fn spectral(
        &self,
        spectral: &CriticalEquilibrium,
        curve: &EquilibriumCurve,
        point: &Vector,
        further: &[f64],
    ) -> Result<Vec<f64>, NotEvaluated<EquilibriaInPlane>> {
        let values = curve.values_at(point);
        if let CriticalEquilibrium::Connection(connection) = spectral {
            let arrival = self.system.at(&values, &[]).ok().and_then(|system| {
                let state = curve.state(point);
                connection.arrival(&system, &state, further)
            });
            let mode = curve.signature().name.clone();
            let lost = NotEvaluated::Linear(EquilibriumFailure::NoConnection { mode });
            return Ok(arrival.ok_or(lost)?.misses.as_slice().to_vec());
        }
        let scaled = self.parameters.iter().zip(self.widths);
        let scaled = scaled.map(|(index, width)| values[*index] / width);
        let states = point.iter().take(point.len() - 1).copied();
        let all = states.chain(further.iter().copied()).chain(scaled);
        let all = Vector::from_vec(all.collect());
        let count = all.len();
        let mut residual = vec![0.0; count - 1];
        let mut jacobian = Matrix::zeros(count, count);
        let condition = EventCondition::Spectral(spectral.clone());
        let equations = (&mut residual[..], &mut jacobian);
        if let Some(done) = self.extended(curve.signature(), &condition, &all, equations) {
            done.map_err(NotEvaluated::Flow)?;
        }
        Ok(residual.split_off(point.len() - 1))
    }

    fn further(spectral: &CriticalEquilibrium) -> usize {
        match spectral {
            CriticalEquilibrium::Pair { near } => 2 * near.len() + 1,
            CriticalEquilibrium::Crossing { near } => near.len() + 1,
            CriticalEquilibrium::Connection(connection) => connection.turns(),
        }
    }

    /// What arrives at a saddle is told from a distance d, of which d^(1 + growth/decay) is what the parameter is off: a
    /// derivative is off by d then, and by 1e-7 for rounding.
    fn difference(spectral: &CriticalEquilibrium) -> f64 {
        match spectral {
            CriticalEquilibrium::Connection(_) => 1e-8,
            _ => 1e-5,
        }
    }

    /// The saddle is found anew for the motion that leaves it.
    fn is_of_orbit(spectral: &CriticalEquilibrium) -> bool {
        !matches!(spectral, CriticalEquilibrium::Connection(_))
    }

    fn settle(
        &self,
        spectral: &mut CriticalEquilibrium,
        curve: &EquilibriumCurve,
        point: &Vector,
        further: &[f64],
    ) {
        match spectral {
            CriticalEquilibrium::Connection(connection) => {
                let system = self.system.at(&curve.values_at(point), &[]);
                let renewed = |system| connection.renewed(&system, &curve.state(point), further);
                if let Some(renewed) = system.ok().and_then(renewed) {
                    **connection = renewed;
                }
            }
            CriticalEquilibrium::Pair { near } => {
                let next = PairVectors::of(further).and_then(|pair| pair.across());
                *near = next.unwrap_or_else(|| near.clone());
            }
            CriticalEquilibrium::Crossing { near } => {
                let psi = Vector::from_column_slice(&further[..near.len()]);
                let size = psi.norm_squared();
                *near = (psi / size).as_slice().to_vec();
            }
        }
    }

    fn renewed(
        spectral: &CriticalEquilibrium,
        further: &[f64],
    ) -> Option<(CriticalEquilibrium, Vec<f64>)> {
        match spectral {
            CriticalEquilibrium::Pair { .. } => {
                let CriticalUnknowns { near, further } = PairVectors::of(further)?.renewed()?;
                Some((CriticalEquilibrium::Pair { near }, further))
            }
            CriticalEquilibrium::Crossing { .. } | CriticalEquilibrium::Connection(_) => None,
        }
    }

    fn lost(
        &self,
        spectral: &CriticalEquilibrium,
        _: &EquilibriumCurve,
        _: &Vector,
        further: &[f64],
    ) -> Option<Gone> {
        let beta = further.last().copied().unwrap_or(f64::NAN);
        let crossing = matches!(spectral, CriticalEquilibrium::Crossing { .. });
        let opened = beta.is_nan() || beta.abs() > PERFECT;
        (crossing && opened).then_some(Gone::Opened)
    }

    fn angular(
        &self,
        spectral: &CriticalEquilibrium,
        _: &EquilibriumCurve,
        _: &Vector,
        further: &[f64],
    ) -> Option<f64> {
        match spectral {
            CriticalEquilibrium::Pair { .. } => Some(self.omega(further)),
            CriticalEquilibrium::Crossing { .. } | CriticalEquilibrium::Connection(_) => None,
        }
    }
}

impl EventCurves for EquilibriaInPlane {
    const FOLLOWED: &'static [EventType] =
        &[EventType::LP, EventType::HB, EventType::BE, EventType::BP];

    fn extended(
        &self,
        signature: &RestMode,
        condition: &EventCondition<EquilibriaInPlane>,
        point: &Vector,
        equations: (&mut [f64], &mut Matrix),
    ) -> Option<Result<(), EquilibriumFailure>> {
        let special = match condition {
            EventCondition::Fold => SpecialCondition::Fold,
            EventCondition::Spectral(CriticalEquilibrium::Pair { near }) => {
                SpecialCondition::Pair(near)
            }
            EventCondition::Spectral(CriticalEquilibrium::Crossing { near }) => {
                SpecialCondition::Crossing(near)
            }
            EventCondition::Spectral(CriticalEquilibrium::Connection(_))
            | EventCondition::Margin(_)
            | EventCondition::Constant(_) => return None,
        };
        let mode = (signature.mode, signature.name.as_str());
        let plane = self.plane(signature);
        Some(plane.and_then(|plane| plane.evaluate(mode, special, point, equations)))
    }

    /// A null vector with the sign of the other one; vectors of a pair that the current vector normalises.
    fn alias(
        condition: &EventCondition<EquilibriaInPlane>,
        further: &[f64],
        near: &[f64],
    ) -> Option<Vec<f64>> {
        let turned = || {
            let product: f64 = further.iter().zip(near).map(|(x, y)| x * y).sum();
            further.iter().map(|x| x * product.signum()).collect()
        };
        match condition {
            EventCondition::Fold => Some(turned()),
            EventCondition::Spectral(CriticalEquilibrium::Pair { near }) => {
                PairVectors::of(further)?.normalised(near)
            }
            EventCondition::Spectral(CriticalEquilibrium::Crossing { near }) => {
                let psi = &further[..near.len()];
                let product: f64 = psi.iter().zip(near).map(|(x, y)| x * y).sum();
                let beta = further.get(near.len()).copied();
                Some(psi.iter().map(|x| x / product).chain(beta).collect())
            }
            EventCondition::Spectral(CriticalEquilibrium::Connection(_))
            | EventCondition::Margin(_)
            | EventCondition::Constant(_) => None,
        }
    }

    /// At a kink the branch turns where the determinants of both sides differ in their sign: on one side that is no fold.
    fn tells_fold(condition: &EventCondition<EquilibriaInPlane>, curve: &EquilibriumCurve) -> bool {
        match condition {
            EventCondition::Margin(margin) => curve.beyond(margin).is_none(),
            _ => *condition != EventCondition::Fold,
        }
    }

    /// Of a pair ω² and l₁, and another pair; beside a zero eigenvalue a second one, and a pair; beside none a pair.
    fn watched(
        &self,
        condition: &EventCondition<EquilibriaInPlane>,
        curve: &EquilibriumCurve,
        point: &Vector,
        further: &[f64],
    ) -> TestValues {
        let passed =
            |kind: PointType, value: Option<f64>| passed(Some(kind), value.unwrap_or(f64::NAN));
        let pair = |kind: PointType, kept| test_of_pair(curve, point, (kind, kept));
        let with_zero = || {
            vec![
                passed(PointType::BT, curve.double_zero(point)),
                pair(PointType::ZH, KeptEigenvalues::Zero),
            ]
        };
        let beyond = match condition {
            EventCondition::Margin(margin) => curve.beyond(margin),
            _ => None,
        };
        let tests = match condition {
            EventCondition::Fold
            | EventCondition::Spectral(CriticalEquilibrium::Crossing { .. }) => with_zero(),
            EventCondition::Spectral(CriticalEquilibrium::Pair { .. }) => {
                let omega = self.omega(further);
                let is_pair = omega > 0.0;
                let degenerate = is_pair.then(|| curve.degenerate_hopf(point, omega));
                let other = match is_pair {
                    true => pair(PointType::HH, KeptEigenvalues::Pair(omega)),
                    false => passed(PointType::HH, None),
                };
                vec![
                    Test {
                        ends: true,
                        ..passed(PointType::BT, further.last().copied())
                    },
                    passed(PointType::GH, degenerate.flatten()),
                    other,
                ]
            }
            // a saddle that is left in one direction, or whose growing ones stay as many
            EventCondition::Spectral(CriticalEquilibrium::Connection(_)) => Vec::new(),
            EventCondition::Margin(_) | EventCondition::Constant(_) => match beyond {
                Some(beyond) => tests_at_kink([curve, &beyond], point),
                None => vec![pair(PointType::One(EventType::HB), KeptEigenvalues::None)],
            },
        };
        TestValues {
            tests,
            outside: None,
        }
    }

    /// A homoclinic orbit shrinks to an equilibrium as its saddle does.
    fn extent(
        condition: &EventCondition<EquilibriaInPlane>,
        curve: &EquilibriumCurve,
        point: &Vector,
        most: f64,
    ) -> Option<f64> {
        let EventCondition::Spectral(CriticalEquilibrium::Connection(connection)) = condition
        else {
            return None;
        };
        let [growth, decay] = curve.saddle_rates(point)?;
        connection.size(growth * decay).filter(|size| *size <= most)
    }

    /// Both rates of the saddle are zero where its homoclinic orbit has no size, and one where it meets a node.
    fn at_limit(
        event: EventType,
        _: &EventCondition<EquilibriaInPlane>,
        curve: &EquilibriumCurve,
        point: &Vector,
    ) -> PointType {
        /// Next to the former neither is smaller than this part of the other.
        const ALIKE: f64 = 0.1;
        let rates = curve.saddle_rates(point);
        let alike = rates.is_none_or(|[one, other]| one.min(other) >= ALIKE * one.max(other));
        match alike {
            true => PointType::BT,
            false => EquilibriaInPlane::with_event(event, EventType::LP),
        }
    }

    fn with_fold(event: EventType) -> PointType {
        match event {
            EventType::HB => PointType::ZH,
            _ => EquilibriaInPlane::with_event(event, EventType::LP),
        }
    }

    /// A boundary equilibrium comes last.
    fn with_event(event: EventType, other: EventType) -> PointType {
        match event {
            EventType::BE => PointType::Two(other, event),
            _ => PointType::Two(event, other),
        }
    }
}

impl PlaneNames for EquilibriaInPlane {
    type NoBranch = NoEquilibriumStart;
    type Beside = ();
    const ORBIT: &'static str = "equilibrium";
    const ORBITS: &'static str = "equilibria";
    const ALL_STEPS: usize = 1800;
    const LONGEST_BESIDE: f64 = f64::INFINITY;
    const MEASURE: Option<&'static str> = None;
    const ANGULAR: &'static str = "omega";
    const SYMBOL: &'static str = "ω";

    fn zone(signature: &RestMode, _: usize) -> String {
        format!("`{}`", signature.name)
    }

    fn name(curve: &EquilibriumCurve, _: &Vector) -> String {
        curve.signature().name.clone()
    }

    fn passing(curve: &EquilibriumCurve, point: &Vector) -> String {
        let name = EquilibriaInPlane::name(curve, point);
        match curve.growing(point) {
            None => name,
            Some(0) => format!("stable {name}"),
            Some(_) => format!("unstable {name}"),
        }
    }

    fn measure(_: &EquilibriumCurve, _: &Vector) -> (f64, Option<f64>) {
        (f64::NAN, None)
    }

    fn columns(&self) -> Vec<String> {
        let states = self.system.source.states.iter().cloned();
        states.chain(["lyapunov".to_owned()]).collect()
    }

    /// The states, and the first Lyapunov coefficient of a Hopf point.
    fn numbers(
        &self,
        condition: &EventCondition<EquilibriaInPlane>,
        curve: &EquilibriumCurve,
        point: &Vector,
        further: &[f64],
    ) -> Vec<Option<f64>> {
        /// An ω below this, in its unit, is the root of a rounding: the coefficient has a pole where it is zero.
        const ROUNDED: f64 = 1e-7;
        let lyapunov = match condition {
            EventCondition::Spectral(CriticalEquilibrium::Pair { .. }) => {
                let omega = self.omega(further);
                (omega > ROUNDED * self.scales.rate)
                    .then(|| curve.lyapunov(point, omega))
                    .flatten()
            }
            _ => None,
        };
        let states = curve.state(point).into_iter().map(Some);
        states.chain([lyapunov]).collect()
    }

    /// At a BP two branches pass, and equations do not tell which is followed.
    fn beside(&self, spectral: &CriticalEquilibrium, _: Option<f64>) -> Option<()> {
        matches!(spectral, CriticalEquilibrium::Pair { .. }).then_some(())
    }

    fn name_beside(
        (): &mut (),
        curve: &EquilibriumCurve,
        point: &Vector,
        _: Option<EventType>,
    ) -> Option<Option<RegionName>> {
        Some(curve.growing(point).map(RegionName::Growing))
    }

    fn say(what: &What<EquilibriumCurve>) -> String {
        what.to_string()
    }
}
