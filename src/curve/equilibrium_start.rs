//! The special equilibrium that a curve begins with, found on a branch of equilibria.

use super::equilibria::{CriticalEquilibrium, EquilibriaInPlane};
use super::plane::ParameterPlane;
use super::point::CurveLimits;
use super::run::Singular;
use super::search::event;
use super::start::{CurveStart, NoCurve, pose};
use crate::affine::equilibrium::start::EquilibriumRequest;
use crate::affine::equilibrium::{EquilibriumCurve, EquilibriumScales};
use crate::hybrid::equilibrium::{
    EquilibriumRunner, LabelledEquilibrium, NamedEquilibrium, NoEquilibriumStart,
};
use crate::linalg::Vector;
use crate::orbit::{EventType, Orbit};
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
    let wanted = kind.map_or_else(String::new, |kind| kind.to_string());
    let asked = (kind, curve.index);
    let scales = branch.state().scales;
    let item = event::<EquilibriaInPlane, _>(branch, asked, wanted, |item| item.point.kind, watch)?;
    let unknown = NoCurve::Run(NoEquilibriumStart::Unknown);
    let (saved, kind) = item.saved.zip(item.point.kind).ok_or(unknown)?;
    pose_equilibrium(problem, (&saved, Some(&scales)), kind, curve)
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
    pose_equilibrium(problem, (saved, None), kind, curve)
}

/// The equations of a special equilibrium.
fn pose_equilibrium(
    problem: &SystemProblem,
    (saved, known): (&LabelledEquilibrium, Option<&EquilibriumScales>),
    kind: EventType,
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
    let at = EquilibriumCurve::at(&request, &saved.state).map_err(Singular::flow)?;
    let pair = [one, other];
    let plane = EquilibriaInPlane::new(&at.0, &at.1, pair, limits.widths(), known);
    let plane = plane.map_err(Singular::flow)?;
    let posed = |index: usize| -> Result<(EquilibriumCurve, Vector), NoCurve<EquilibriaInPlane>> {
        let curve = plane.orbit(at.0.signature(), plane.values(), index);
        let curve = curve.map_err(Singular::flow)?;
        let point = curve.pack(&saved.state, plane.values()[index]);
        Ok((curve, point))
    };
    let (curve, point) = posed(0)?;
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
