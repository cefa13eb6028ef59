//! A change of the sequence, proven: in the sequence before it or, where a zone of that has no duration, in one without the
//! zone; then in the others of the two that it lies between.

use super::system::OrbitCondition;
use super::{
    Changed, OpenOrbit, OrbitProof, PosedOrbit, SequenceOrbit, VANISHES, beyond, near, prove,
};
use crate::affine::orbit::candidates::candidates;
use crate::affine::orbit::{AffineOrbit, Margin, Sequence, Watch};
use crate::linalg::Vector;
use crate::orbit::special::Change;
use crate::orbit::{Changes, Examined, MarginFunction, Zones};

/// Proves a change of the sequence: in the sequence before or, where a zone of that has no duration, in one without
/// it, where another margin vanishes. At a graze several do, all for one reason: they are tried in turn.
pub(super) fn changed(
    posed: PosedOrbit,
    orbit: &AffineOrbit,
    point: &Vector,
    change: &Change<AffineOrbit>,
) -> Result<OrbitProof, OpenOrbit> {
    let (before, after) = (&change.before, &change.after);
    // where several things happen at once, what was entered before has no duration yet
    let tiny = VANISHES * orbit.setting.scales.time;
    let zones = near(orbit, point)?.zones;
    let closed = match change.margin.watch {
        Watch::Duration => Some(change.margin.zone),
        Watch::Inside(_) | Watch::Speed => None,
        _ => zones.iter().position(|zone| zone.duration < tiny),
    };
    let closes = closed.is_some();
    let mut list = vec![(orbit.clone(), point.clone())];
    if let Some(zone) = closed {
        list = without_zone(orbit, point, change, zone)?;
    }
    let branch = (orbit, point);
    let mut reason = None;
    for (orbit, point) in list {
        let Ok(examination) = orbit.examination(&point) else {
            continue;
        };
        let mut margins: Vec<&Margin> = match closes {
            true => Vec::new(),
            false => vec![&change.margin],
        };
        let alike = |one: &&Margin| {
            let kind = AffineOrbit::classify(before, after.as_ref(), one);
            one.value.abs() <= VANISHES
                && one.watch != Watch::Duration
                && (closes || !one.is_same(&change.margin) && kind == change.kind)
        };
        margins.extend(examination.margins().iter().filter(alike));
        for vanishing in margins {
            let near = near(&orbit, &point)?;
            match prove(posed.clone(), near, vanishing.into()) {
                Ok(proof) if proof.change() != Some(change.kind) => {
                    reason = reason.or(Some(OpenOrbit::Kind));
                }
                Ok(proof) => return Ok(completed(proof, branch, change)),
                Err(other) => reason = reason.or(Some(other)),
            }
        }
    }
    // two contacts that change their order have a zone between them on both sides, and no sequence without one
    if let Some(zone) = closed {
        let (orbit, point) = branch;
        match prove(posed, near(orbit, point)?, OrbitCondition::closed(zone)) {
            Ok(proof) if proof.change() == Some(change.kind) => {
                return Ok(completed(proof, branch, change));
            }
            Ok(_) => {}
            Err(other) => reason = reason.or(Some(other)),
        }
    }
    Err(reason.unwrap_or(OpenOrbit::Duration))
}

/// The orbit in the sequences of the change without a zone that has no duration there, that of the branch beyond first.
fn without_zone(
    orbit: &AffineOrbit,
    point: &Vector,
    change: &Change<AffineOrbit>,
    zone: usize,
) -> Result<Vec<(AffineOrbit, Vector)>, OpenOrbit> {
    let (before, after) = (&change.before, &change.after);
    let margin = Margin {
        watch: Watch::Duration,
        zone,
        ..change.margin.clone()
    };
    let found = candidates(orbit, point, &margin).map_err(|_| OpenOrbit::Duration)?;
    let mut list: Vec<_> = found
        .into_iter()
        .filter(|candidate| candidate.nascent.is_empty())
        .filter(|candidate| {
            let mut sides = [before].into_iter().chain(after);
            sides.any(|side| side.is_rotation_of(&candidate.orbit.sequence))
        })
        .map(|candidate| (candidate.orbit, candidate.point))
        .collect();
    // that of the branch beyond first
    list.sort_by_key(|(orbit, _)| Some(&orbit.sequence) != after.as_ref());
    Ok(list)
}

/// A proof with the change of the sequence, and with the orbit in the sequences in which it is not proven itself: what is not
/// proven there is not stated.
fn completed(
    mut proof: OrbitProof,
    (orbit, point): (&AffineOrbit, &Vector),
    change: &Change<AffineOrbit>,
) -> OrbitProof {
    let margin = &change.margin;
    let own = SequenceOrbit {
        condition: proof.condition.clone(),
        near: proof.near.clone(),
    };
    let proven =
        |sequence: &Sequence, list: &dyn Fn() -> Vec<SequenceOrbit>| match own.near.sequence
            == *sequence
        {
            true => Some(own.clone()),
            false => {
                let mut list = list().into_iter();
                list.find(|one| beyond::prove(&proof, one).is_ok())
            }
        };
    let first = proven(&change.before, &|| beyond::seen_here(orbit, point, margin));
    let first = first.unwrap_or_else(|| own.clone());
    let beyond = |after| proven(after, &|| beyond::seen(orbit, point, margin, after));
    let other = change.after.as_ref().and_then(beyond);
    let other = other.filter(|one| !one.near.sequence.is_rotation_of(&first.near.sequence));
    let vanishing = first.condition.watched();
    let (watch, zone) = vanishing.unwrap_or((margin.watch, margin.zone));
    proof.changed = Some(Changed {
        watch,
        zone,
        before: first.near.sequence.clone(),
        after: other.as_ref().map(|one| one.near.sequence.clone()),
    });
    let seen = [first].into_iter().chain(other);
    proof.seen = seen.filter(|one| one.near != proof.near).collect();
    proof
}
