//! A stored proof of an orbit, checked: everything it says is proven again from its equations, without continuation, and its
//! type follows from what vanishes.

use super::modes::Structure;
use super::products::Needed;
use super::system::OrbitSystem;
use super::{Changed, OpenOrbit, OrbitCondition, OrbitProof, PosedOrbit, beyond, statement};
use crate::affine::orbit::{Sequence, Zone};
use crate::certify;
use crate::certify::certificate::{CertifiedPoint, RefusedProof};
use crate::interval::Interval;
use crate::orbit::EventType;

/// Proves a stored statement again, without continuation.
///
/// # Errors
/// The proof fails, or it proves something else.
pub fn verify(point: &CertifiedPoint<OrbitProof>, proof: &OrbitProof) -> Result<(), RefusedProof> {
    proven_again(point, proof).map(|_| ())
}

/// Proves a stored statement again; returns the proof with intervals of it that are no wider than they are proven.
///
/// # Errors
/// The proof fails, or it proves something else.
pub(crate) fn proven_again(
    point: &CertifiedPoint<OrbitProof>,
    proof: &OrbitProof,
) -> Result<OrbitProof, RefusedProof> {
    let OrbitProof {
        posed,
        condition,
        near,
        statement: said,
        ..
    } = proof;
    let open = |open: OpenOrbit| RefusedProof::NoProof(open.to_string());
    let mut names = posed.system().map_err(open)?.source.parameters.names();
    if names.nth(posed.parameter) != Some(&point.parameter) {
        return Err(RefusedProof::Statement("the parameter"));
    }
    check_zones(proof)?;
    check_kind(proof, point.kind)?;
    let proven = statement(posed, near, condition, Some(said.unique)).map_err(open)?;
    certify::compared("the parameter", said.parameter, proven.parameter)?;
    certify::compared("the period", said.period, proven.period)?;
    match (said.angle, proven.angle) {
        (Some(said), Some(proven)) => certify::compared("the angle", said, proven)?,
        (None, None) => {}
        _ => return Err(RefusedProof::Statement("the angle")),
    }
    certify::compared_unique(said.unique, proven.unique)?;
    if said.inequalities != proven.inequalities {
        return Err(RefusedProof::Statement("the number of inequalities"));
    }
    if said.outside.is_some() && said.outside != proven.outside {
        return Err(RefusedProof::Statement(
            "the number of multipliers outside the unit circle",
        ));
    }
    let mut again = proof.clone();
    let statement = &mut again.statement;
    statement.parameter = certify::narrowed(said.parameter, proven.parameter);
    statement.period = certify::narrowed(said.period, proven.period);
    let angles = said.angle.zip(proven.angle);
    statement.angle = angles.map(|(said, proven)| certify::narrowed(said, proven));
    Ok(again)
}

/// Refuses zones that are no modes of the system, by their numbers and their names, or have labels that their switches do not give.
fn check_zones(proof: &OrbitProof) -> Result<(), RefusedProof> {
    let open = |open: OpenOrbit| RefusedProof::NoProof(open.to_string());
    let system = proof.posed.system().map_err(open)?;
    let seen = proof.seen.iter().map(|seen| &seen.near.sequence);
    let changed = proof.changed.iter();
    let changed = changed.flat_map(|changed| [&changed.before].into_iter().chain(&changed.after));
    let sequences = [&proof.near.sequence]
        .into_iter()
        .chain(seen)
        .chain(changed);
    let zones: Vec<&Zone> = sequences.flat_map(|sequence| &sequence.0).collect();
    let PosedOrbit {
        values,
        parameter,
        units,
        ..
    } = &proof.posed;
    let near = (Interval::point(proof.near.parameter), units.parameter);
    let needed = Needed::new(values, *parameter, near, zones.iter().copied());
    let (_, modes) = Structure::of(system, &needed).map_err(open)?;
    let is_mode = |zone: &Zone| {
        let way = zone.way.map(|way| [way.guard, way.exit]);
        let label = way.and_then(|way| modes.label(system, zone.mode, way));
        modes.modes.get(zone.mode).is_some()
            && system.mode_name(zone.mode) == zone.name
            && zone.has_label(label)
    };
    match zones.into_iter().all(is_mode) {
        true => Ok(()),
        false => Err(RefusedProof::Statement("the name of a zone")),
    }
}

/// Proves that the sequence changes from the one that is stated, by what is stated to vanish there, to the other, if there is one: in
/// each of them the orbit of the event is proven.
fn check_change(proof: &OrbitProof, changed: &Changed) -> Result<(), RefusedProof> {
    let Changed {
        watch,
        zone,
        before,
        after,
    } = changed;
    let refused = || RefusedProof::Statement("the change of the sequence");
    let mut sides = [before].into_iter().chain(after);
    let is_none = |after: &Sequence| after.is_rotation_of(before);
    if !sides.clone().any(|one| *one == proof.near.sequence) || after.as_ref().is_some_and(is_none)
    {
        return Err(refused());
    }
    let condition = match *before == proof.near.sequence {
        true => Some(&proof.condition),
        false => {
            let mut seen = proof.seen.iter();
            let there = seen.find(|seen| seen.near.sequence == *before);
            there.map(|seen| &seen.condition)
        }
    };
    let vanishing = condition.and_then(OrbitCondition::watched);
    if vanishing != Some((*watch, *zone)) {
        return Err(refused());
    }
    for seen in &proof.seen {
        beyond::prove(proof, seen).map_err(|reason| RefusedProof::NoProof(reason.to_string()))?;
    }
    let is_proven = |side: &Sequence| {
        let mut seen = proof.seen.iter();
        *side == proof.near.sequence || seen.any(|seen| seen.near.sequence == *side)
    };
    match sides.all(is_proven) {
        true => Ok(()),
        false => Err(refused()),
    }
}

/// Whether the type of an event follows from what vanishes there.
fn check_kind(proof: &OrbitProof, said: EventType) -> Result<(), RefusedProof> {
    let OrbitProof {
        posed,
        condition,
        changed,
        near,
        ..
    } = proof;
    let open = |open: OpenOrbit| RefusedProof::NoProof(open.to_string());
    if changed.is_none() && !proof.seen.is_empty() {
        return Err(RefusedProof::Statement("the change of the sequence"));
    }
    let found = match (condition, changed.as_ref()) {
        // of a value the certificate does not say who asked for it
        (OrbitCondition::Value(_), None) if said == EventType::EP => EventType::EP,
        (OrbitCondition::Value(_), None) => EventType::UZ,
        (OrbitCondition::Fold, None) => EventType::LP,
        (OrbitCondition::Doubling, None) => EventType::PD,
        (OrbitCondition::Branching, None) => EventType::BP,
        (OrbitCondition::Torus { .. }, None) => EventType::NS,
        (OrbitCondition::Margin { .. }, Some(changed)) => {
            check_change(proof, changed)?;
            let (system, _) = OrbitSystem::new(posed, near, condition).map_err(open)?;
            system.change().ok_or_else(|| open(OpenOrbit::Kind))?
        }
        _ => return Err(RefusedProof::Statement("the change of the sequence")),
    };
    match found == said {
        true => Ok(()),
        false => Err(RefusedProof::Kind { said, found }),
    }
}
