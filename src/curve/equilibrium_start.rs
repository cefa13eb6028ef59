//! The special equilibrium that a curve begins with, found on a branch of equilibria.

use super::equilibria::{CriticalEquilibrium, EquilibriaInPlane};
use super::plane::{EventCurves as _, PlaneOfOrbits as _};
use super::point::CurveLimits;
use super::run::Singular;
use super::search::{KeptMonitor, event, wanted};
use super::start::{CurveStart, FixedMonitor, NoCurve, pose, pose_constant, pose_margin};
use crate::affine::equilibrium::start::EquilibriumRequest;
use crate::affine::equilibrium::{EquilibriumCurve, EquilibriumScales};
use crate::hybrid::equilibrium::{
    EquilibriumItem, EquilibriumRunner, LabelledEquilibrium, NamedEquilibrium, NoEquilibriumStart,
};
use crate::linalg::Vector;
use crate::orbit::legs::Run as _;
use crate::orbit::{EventType, Zones};
use crate::problem::{SystemCurve, SystemProblem};

/// Follows the branch of a problem with equilibria, which `begin` begins, to the event that its curve begins with. `watch`
/// sees the branch after every step.
///
/// # Errors
/// As [`super::search::find`].
pub fn find_of_equilibria(
    problem: &SystemProblem,
    curve: &SystemCurve,
    begin: impl FnOnce() -> Result<EquilibriumRunner, NoEquilibriumStart>,
    watch: &mut dyn FnMut(&EquilibriumRunner),
) -> Result<CurveStart<EquilibriaInPlane>, NoCurve<EquilibriaInPlane>> {
    let branch = begin().map_err(NoCurve::Run)?;
    let kind = curve.event.kind();
    let kept = KeptMonitor::of(problem, curve);
    let wanted = wanted(kind, kept.as_ref());
    let asked = (kind, curve.index);
    let scales = branch.state().beside;
    let of = |item: &EquilibriumItem| match &kept {
        None => item.point.kind,
        Some(kept) => kept.event(item.special.as_ref()),
    };
    let item = event::<EquilibriaInPlane, _>(branch, asked, wanted, of, watch)?;
    let special = item.special.as_ref();
    let kept = kept.map(|kept| kept.at::<EquilibriaInPlane>(special, &item.point.monitors));
    let kept = kept.transpose()?;
    let unknown = NoCurve::Run(NoEquilibriumStart::Unknown);
    let (saved, kind) = item.saved.zip(item.point.kind).ok_or(unknown)?;
    pose_equilibrium(problem, (&saved, Some(&scales)), (kind, kept), curve)
}

/// The special equilibrium that an earlier run labelled.
///
/// # Errors
/// As [`super::start::labelled`].
pub fn labelled_of_equilibria(
    problem: &SystemProblem,
    named: &NamedEquilibrium,
    curve: &SystemCurve,
) -> Result<CurveStart<EquilibriaInPlane>, NoCurve<EquilibriaInPlane>> {
    let NamedEquilibrium { saved, kind } = named;
    let kind = kind.unwrap_or(EventType::EP);
    if !EquilibriaInPlane::FOLLOWED.contains(&kind) {
        let label = saved.label;
        return Err(NoCurve::Kind { label, kind });
    }
    pose_equilibrium(problem, (saved, None), (kind, None), curve)
}

/// The equations of a special equilibrium.
fn pose_equilibrium(
    problem: &SystemProblem,
    (saved, known): (&LabelledEquilibrium, Option<&EquilibriumScales>),
    (kind, kept): (EventType, Option<FixedMonitor>),
    section: &SystemCurve,
) -> Result<CurveStart<EquilibriaInPlane>, NoCurve<EquilibriaInPlane>> {
    let limits = CurveLimits::of(section);
    let unknown = || NoCurve::Run(NoEquilibriumStart::Unknown);
    let parameters = &problem.system.source.parameters;
    let (first, second) = &section.parameters;
    let pair = parameters.index(first).zip(parameters.index(second));
    let (one, other) = pair.ok_or_else(unknown)?;
    let request = EquilibriumRequest {
        system: problem.system.clone(),
        values: saved.values.clone(),
        parameter: one,
        width: limits.widths()[0],
        mode: problem.system.mode(&saved.mode).ok_or_else(unknown)?,
    };
    let (at, point) = EquilibriumCurve::at(&request, &saved.state).map_err(Singular::flow)?;
    let bends = [EventType::LP, EventType::HB, EventType::BP].contains(&kind);
    let side = at.at_kink(&point).filter(|_| bends);
    let pair = [one, other];
    let of = side.as_ref().unwrap_or(&at);
    let plane = EquilibriaInPlane::new(of, &point, pair, limits.widths(), known);
    let plane = plane.map_err(Singular::flow)?;
    let posed = |index: usize| -> Result<(EquilibriumCurve, Vector), NoCurve<EquilibriaInPlane>> {
        let curve = plane.orbit(at.signature(), plane.values(), index);
        let curve = curve.map_err(Singular::flow)?;
        let point = curve.pack(&saved.state, plane.values()[index]);
        Ok((curve, point))
    };
    let (curve, point) = posed(0)?;
    if let Some(FixedMonitor { monitor, value }) = kept {
        return pose_constant(plane.keeping(&monitor), (&curve, &point), value, limits);
    }
    if side.is_some() {
        // what the rates are made of has other numbers over the plane
        let side = curve.at_kink(&point).ok_or(Singular::NoMargin)?;
        return pose_margin(plane, &side, &point, kind, limits);
    }
    let spectral = match kind {
        EventType::HB => {
            let unknowns = curve.pair_unknowns(&point).ok_or(Singular::NoNullVector)?;
            let near = unknowns.near;
            Some((CriticalEquilibrium::Pair { near }, unknowns.further))
        }
        EventType::BP => {
            let unknowns = curve.crossing_unknowns(&point);
            let unknowns = unknowns.ok_or(Singular::NoNullVector)?;
            for index in [0, 1] {
                let (curve, point) = posed(index)?;
                if !curve.stays_crossed(&point, &unknowns) {
                    let parameter = plane.parameters()[index].clone();
                    return Err(NoCurve::Unfolds { parameter });
                }
            }
            let near = unknowns.near;
            Some((CriticalEquilibrium::Crossing { near }, unknowns.further))
        }
        _ => None,
    };
    pose(plane, &curve, &point, (kind, spectral), limits)
}
