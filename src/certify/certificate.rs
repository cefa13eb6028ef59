//! What is proven of special points, what it takes to check it, and why something is not.

use std::fmt::Display;

use serde::{Deserialize, Serialize};

use super::arc::Broken;
use super::change::WaveBeyond;
use super::count::GrowthCount;
use super::open::OpenPoint;
use super::perturbation::ProvenEigenvalue;
use super::system::{NearWave, PosedWave, WaveCondition};
use crate::affine::system::System;
use crate::interval::Interval;
use crate::orbit::{Data, EventType};

/// A statement of a kind of orbits, and what it takes to check it.
pub trait Provable: Data {
    /// Name of the continuation parameter.
    type Parameter: Data;
    /// Which inequality is not proven.
    type Unproven: Display + Sync;
    /// Why nothing is known of what begins beyond an event.
    type Beyond: Display + Sync;

    /// Proves that a branch leads from one point to another without a further event.
    ///
    /// # Errors
    /// It is not proven.
    fn arc(from: &Self, to: &Self) -> Result<(), Broken<Self::Unproven, Self::Beyond>>;

    /// What a point says of the number of multipliers or eigenvalues that grow.
    fn tally(point: &CertifiedPoint<Self>) -> GrowthTally;

    /// Whether the event of another proof may be the same one. A value of the parameter is none: several may be one orbit, for a
    /// closed branch ends where it began.
    fn is_event_of(&self, other: &Self) -> bool;

    /// Takes out the system that its equations are of, where that is a user's.
    fn take_system(&mut self) -> Option<System> {
        None
    }

    /// Gives it the system of the certificate, where it has none of its own.
    fn give_system(&mut self, _: &System) {}
}

/// What a point says of the number of multipliers or eigenvalues that grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrowthTally {
    /// So many grow there. Others are on the circle or the axis, and grow on one of its sides.
    Known {
        /// They are outside the circle, or right of the axis.
        growing: usize,
        /// They are on it.
        neutral: usize,
    },
    /// So many pass together.
    Passes(usize),
    /// The number may change in any way.
    Unknown,
}

/// All that was proven of a branch, and what proves it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "")]
pub struct Certificate<P: Provable = WaveProof> {
    /// Version of the program.
    pub version: String,
    /// The user's system that all points are of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub system: Option<System>,
    /// The special points in their order.
    pub points: Vec<CertifiedPoint<P>>,
}

impl<P: Provable> Certificate<P> {
    /// The certificate of a branch.
    pub fn new(mut points: Vec<CertifiedPoint<P>>) -> Certificate<P> {
        let mut system = None;
        for proof in points.iter_mut().filter_map(CertifiedPoint::proof_mut) {
            system = proof.take_system().or(system);
        }
        Certificate {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            system,
            points,
        }
    }

    /// With the system at every point.
    #[cfg(feature = "cli")]
    pub(crate) fn spread(mut self) -> Certificate<P> {
        if let Some(system) = &self.system {
            let proofs = self.points.iter_mut().filter_map(CertifiedPoint::proof_mut);
            proofs.for_each(|proof| proof.give_system(system));
        }
        self
    }
}

/// Labels of events that an earlier one of a certificate is already: of the same type, at the same orbit, whatever zone that begins
/// with and from whatever side it is seen.
pub fn repeated<P: Provable>(points: &[CertifiedPoint<P>]) -> Vec<usize> {
    let is_one = |one: &CertifiedPoint<P>, other: &CertifiedPoint<P>| {
        let proofs = one.proof().zip(other.proof());
        one.kind == other.kind && proofs.is_some_and(|(a, b)| a.is_event_of(b))
    };
    let all = points.iter().enumerate();
    let again = all.filter(|(index, point)| points[..*index].iter().any(|one| is_one(one, point)));
    again.map(|(_, point)| point.label).collect()
}

/// Whether every zone of the one of two orbits that has fewer begins where one of the other does, by the numbers at their entries.
pub(super) fn begin_alike(one: &[Vec<f64>], other: &[Vec<f64>]) -> bool {
    /// Orbits in doubles are known to this share of their largest numbers.
    const KNOWN: f64 = 1e-6;
    let largest = |index: usize| {
        let all = one.iter().chain(other);
        let numbers = all.filter_map(|entry| entry.get(index));
        numbers.fold(0.0, |most: f64, number| most.max(number.abs()))
    };
    let agree = |a: &Vec<f64>, b: &Vec<f64>| {
        let mut pairs = a.iter().zip(b).enumerate();
        pairs.all(|(index, (a, b))| (a - b).abs() <= KNOWN * largest(index))
    };
    let (fewer, more) = match one.len() <= other.len() {
        true => (one, other),
        false => (other, one),
    };
    let mut fewer = fewer.iter();
    fewer.all(|a| more.iter().any(|b| agree(a, b)))
}

/// A special point of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, bound = "")]
pub struct CertifiedPoint<P: Provable = WaveProof> {
    /// Label of the event.
    pub label: usize,
    /// Its type.
    pub kind: EventType,
    /// Continuation parameter.
    pub parameter: P::Parameter,
    /// Leg of the branch.
    #[serde(default)]
    pub leg: usize,
    /// What was found.
    pub outcome: ProofOutcome<P>,
    /// Whether the branch from the point before has no other special point but where multipliers or eigenvalues cross,
    /// where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub arc: Option<ArcOutcome>,
    /// How many eigenvalues grow, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<Counted>,
}

/// Whether there is no further special point between two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ArcOutcome {
    /// It is proven.
    Proven,
    /// It is not, for this reason.
    Open(String),
}

impl<P: Provable> CertifiedPoint<P> {
    /// Whether it is proven.
    pub fn is_proven(&self) -> bool {
        matches!(self.outcome, ProofOutcome::Proven(_))
    }

    pub(crate) fn proof(&self) -> Option<&P> {
        match &self.outcome {
            ProofOutcome::Proven(proof) => Some(proof),
            ProofOutcome::Open(_) => None,
        }
    }

    fn proof_mut(&mut self) -> Option<&mut P> {
        match &mut self.outcome {
            ProofOutcome::Proven(proof) => Some(proof),
            ProofOutcome::Open(_) => None,
        }
    }

    /// Proves that on the branch from an earlier point to this there is no other but where multipliers or eigenvalues
    /// cross; `None` if the branch does not lead from there to here.
    pub fn stretch(&self, before: &CertifiedPoint<P>) -> Option<ArcOutcome> {
        if self.leg != before.leg {
            return None;
        }
        let ends = before.proof().zip(self.proof()).ok_or(Broken::End);
        Some(match ends.and_then(|(from, to)| P::arc(from, to)) {
            Ok(()) => ArcOutcome::Proven,
            Err(reason) => ArcOutcome::Open(reason.to_string()),
        })
    }
}

/// Whether the growing eigenvalues of a wave are counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Counted {
    /// They are.
    Proven(GrowthCount),
    /// They are not, for this reason.
    Open(String),
}

/// Whether a point is proven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub enum ProofOutcome<P: Provable = WaveProof> {
    /// It is.
    Proven(Box<P>),
    /// It is not, for this reason.
    Open(String),
}

impl<P: Provable, O: Display> From<Result<P, O>> for ProofOutcome<P> {
    fn from(proven: Result<P, O>) -> ProofOutcome<P> {
        match proven {
            Ok(proof) => ProofOutcome::Proven(Box::new(proof)),
            Err(reason) => ProofOutcome::Open(reason.to_string()),
        }
    }
}

/// A statement, and what it takes to check it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveProof {
    /// The model and its equations.
    pub posed: PosedWave,
    /// What singles out the point.
    pub condition: WaveCondition,
    /// The wave beyond a change of regime, as the continuation has entered it.
    pub beyond: Option<WaveBeyond>,
    /// The wave in doubles.
    pub near: NearWave,
    /// What is proven.
    pub statement: WaveStatement,
    /// Eigenvalues: at values of the parameter, the one of every Bloch sector that was found to lead.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub eigenvalues: Vec<ProvenEigenvalue>,
}

impl WaveProof {
    /// Whether the wave is unstable.
    pub fn is_unstable(&self) -> bool {
        let mut eigenvalues = self.eigenvalues.iter();
        eigenvalues.any(|eigenvalue| eigenvalue.growth.is_positive())
    }
}

/// What is proven of a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveStatement {
    /// The continuation parameter lies in here.
    pub parameter: Interval,
    /// The speed c.
    pub speed: Interval,
    /// Length of every zone, duration times |c|.
    pub lengths: Vec<Interval>,
    /// No other such wave has its parameter within this distance and all its other unknowns within the same
    /// share of their units.
    pub unique: f64,
    /// Im λ of an eigenvalue that crosses the imaginary axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub omega: Option<Interval>,
    /// Inequalities proven.
    pub inequalities: usize,
}

impl From<OpenPoint> for RefusedProof {
    fn from(reason: OpenPoint) -> RefusedProof {
        RefusedProof::NoProof(reason.to_string())
    }
}

/// Why a stored proof does not hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RefusedProof {
    /// The proof fails, for this reason.
    #[error("it is no proof: {0}")]
    NoProof(String),
    /// What it says is not what is proven.
    #[error("{0} is said otherwise than what is proven")]
    Statement(&'static str),
    /// It is not that of the problem file.
    #[error("{0} is not that of the problem file")]
    Problem(&'static str),
    /// The type does not follow.
    #[error("its type is {said}, but what vanishes there makes it {found}")]
    Kind {
        /// In the certificate.
        said: EventType,
        /// By the margin that vanishes.
        found: EventType,
    },
}
