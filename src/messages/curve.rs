//! What happens along a curve of events, and how it ends.

use std::fmt::{self, Display, Formatter};

use super::branch::Told;
use super::list;
use crate::curve::{self, Gone, PointType, What};
use crate::orbit::{self, EventType};

impl<O: Told> Display for What<O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            What::Begins => f.write_str("the event on the branch"),
            What::Edge(parameter, value) => {
                orbit::special::Special::<O>::Edge(parameter.clone(), *value).fmt(f)
            }
            What::Meeting {
                second,
                may_go_on,
                next,
            } => {
                let (event, kind) = (O::event(second), second.kind);
                write!(f, "another inequality fails: {event} ({kind})")?;
                match next {
                    Some(next) => write!(f, "; the curve goes on in {next}"),
                    None if *may_go_on => f.write_str("; no curve of this event goes on from here"),
                    None => Ok(()),
                }
            }
            What::Fold => write!(f, "the {} has a fold here too", O::NAME),
            What::Cusp => f.write_str("cusp: two folds meet and vanish"),
            What::Close(close) => write!(
                f,
                "here, or since the point before, {close} comes so close to zero that rounding decides"
            ),
            What::Other(kind) => of_codimension_two(*kind, f),
            What::Limit { kind, error } => {
                f.write_str(match kind {
                    PointType::GH => "the orbit shrinks to an equilibrium, a degenerate Hopf point",
                    PointType::BT => {
                        "the orbit shrinks to an equilibrium, a fold with both eigenvalues zero"
                    }
                    PointType::Two(_, EventType::LP) => {
                        "the saddle of the orbit meets another equilibrium"
                    }
                    PointType::Two(EventType::HB, EventType::BE) => {
                        "the orbit shrinks to an equilibrium, a Hopf point on its guard"
                    }
                    PointType::Two(_, EventType::BE) => {
                        "the orbit shrinks to an equilibrium on a boundary"
                    }
                    _ => "the orbit shrinks to an equilibrium, a Hopf point",
                })?;
                write!(
                    f,
                    ": the parameters there are limits, to {error:.0e} of their ranges"
                )
            }
            What::Passing([before, after]) => write!(
                f,
                "multipliers pass the unit circle together: {before} are outside it before, {after} after"
            ),
        }
    }
}

/// What vanishes at a point of codimension two beside the event that is followed.
fn of_codimension_two(kind: PointType, f: &mut Formatter<'_>) -> fmt::Result {
    match kind {
        PointType::BT => f.write_str("ω → 0: the pair meets on the real axis, and with it a fold"),
        PointType::Resonance(order) => match order {
            1 => f.write_str("resonance 1:1: the pair meets at 1"),
            2 => f.write_str("resonance 1:2: the pair meets at -1"),
            _ => write!(
                f,
                "resonance 1:{order}: the pair is at the angle 2π/{order}"
            ),
        },
        PointType::GH => {
            f.write_str("the first Lyapunov coefficient is zero: a degenerate Hopf point")
        }
        PointType::ZH => f.write_str("a pair is on the imaginary axis, too"),
        PointType::HH => f.write_str("another pair is on the imaginary axis: two Hopf points"),
        PointType::Two(EventType::LP, EventType::LP) => f.write_str(
            "an eigenvalue is zero on one side of the kink: beyond it the branch turns there no more",
        ),
        PointType::Two(EventType::HB, _) => f.write_str("a pair is on the imaginary axis, too"),
        PointType::Two(_, EventType::PD) => f.write_str("a multiplier is -1 here too"),
        PointType::Two(_, EventType::NS) => {
            f.write_str("a pair of multipliers has the product 1 here too")
        }
        PointType::Two(_, EventType::BP) => {
            f.write_str("the symmetric orbit loses its symmetry here too")
        }
        PointType::Two(_, EventType::GR) => f.write_str(
            "a guard that is zero where a zone begins has no rate there: beyond it the guard falls below zero within the zone",
        ),
        kind => write!(f, "{kind}"),
    }
}

impl Display for Gone {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Gone::Lower(zone) => write!(
                f,
                "another minimum inside the {zone} zone falls below zero first"
            ),
            Gone::Left(zone) => write!(
                f,
                "the minimum inside the {zone} zone reaches an end of the zone: no inequality fails there \
                 any more"
            ),
            Gone::Along(zone) => write!(
                f,
                "an inequality of the {zone} zone that vanishes along with the event fails"
            ),
            Gone::Opened => f.write_str(
                "beyond it the branches of equilibria come apart: none crosses another one any more",
            ),
            Gone::Asymmetric => f.write_str(
                "beyond it the system is not symmetric: no orbit is its own image half a period later",
            ),
        }
    }
}

impl Display for curve::RegionName {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            curve::RegionName::Pair { grows: true } => f.write_str("the pair grows"),
            curve::RegionName::Pair { grows: false } => f.write_str("the pair decays"),
            curve::RegionName::Outside(0) | curve::RegionName::Growing(0) => f.write_str("stable"),
            curve::RegionName::Growing(1) => f.write_str("1 eigenvalue grows"),
            curve::RegionName::Growing(count) => write!(f, "{count} eigenvalues grow"),
            curve::RegionName::Outside(1) => f.write_str("1 multiplier outside"),
            curve::RegionName::Outside(count) => write!(f, "{count} multipliers outside"),
            curve::RegionName::Orbits { count, regimes } => {
                match count {
                    None => {}
                    Some((count, orbits)) => write!(f, "{count} {orbits} ")?,
                }
                f.write_str(&list(regimes, ", "))
            }
        }
    }
}

impl<P: curve::ParameterPlane> Display for curve::CurveRefusal<P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            curve::CurveRefusal::Flow(error) => error.fmt(f),
            curve::CurveRefusal::Posed(inadmissible) => {
                write!(
                    f,
                    "an inequality fails as soon as it is posed: {inadmissible}"
                )
            }
            curve::CurveRefusal::NotLocated => {
                f.write_str("a point of codimension two was not located")
            }
            curve::CurveRefusal::Gone(gone) => gone.fmt(f),
        }
    }
}

impl<P: curve::ParameterPlane> Display for curve::CurveEndReason<P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            curve::CurveEndReason::There | curve::CurveEndReason::Unknown => Ok(()),
            curve::CurveEndReason::Gone(gone) => gone.fmt(f),
            curve::CurveEndReason::Closed => f.write_str("the curve closes on its start"),
            curve::CurveEndReason::MaxPoints { most } => {
                write!(f, "`max_points`, {most} in either direction, are reached")
            }
            curve::CurveEndReason::Creeps {
                steps,
                longest,
                beside: (zone, length),
            } => {
                write!(
                    f,
                    "the last {steps} steps are all shorter than {longest:.0e}: Newton's method hardly converges"
                )?;
                // equilibria, and what leads from one to another, have none
                match length.is_finite() {
                    true => write!(f, " beside a {zone} zone of length {length:.1e}"),
                    false => Ok(()),
                }
            }
            curve::CurveEndReason::Stands { points, moved } => write!(
                f,
                "over the last {points} points the parameters move by no more than {moved:.0e} of their ranges: its steps \
                 do not lead on"
            ),
            curve::CurveEndReason::NoStep { ds_min, reason } => {
                write!(
                    f,
                    "no step of at least ds_min = {ds_min:e} succeeds: {reason}"
                )
            }
        }
    }
}
