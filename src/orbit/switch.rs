//! The other branch at an orbit whose equations are singular at a fixed parameter.
//!
//! The branch that is known moves in the parameter there; the other one leaves along the null vector of the equations
//! at a fixed parameter, or along this and the parameter. The tangents of both are the zeros of the algebraic branching
//! equation, and the other branch is looked for in planes that do not meet the known one. At the event the equations are
//! singular whatever borders them: both branches pass; a short way along the other they are not. At a doubling the orbit is
//! taken as one that is traversed twice: there the null vector is (ξ, −ξ), of one that never switches ξ at its beginning.

use super::sign::SignVerdict;
use super::{Examined, Orbit};
use crate::continuation::Node;
use crate::continuation::arclength::correct;
use crate::continuation::branching::Branching;
use crate::continuation::newton::{self, Plane, Settings, Solution};
use crate::linalg::{self, Vector};

/// Why there is no other branch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoBranch<O: Orbit> {
    /// The equations are regular at a fixed parameter: their least singular value, relative to the largest.
    #[error("no other branch passes through it: its equations are singular to {0:.1e} only")]
    Regular(f64),
    /// Newton's method finds nothing beside the event.
    #[error("{0}")]
    Newton(newton::Failure<O::Failure>),
    /// What it finds is not admissible.
    #[error("beside it {0}")]
    Inadmissible(O::Inadmissible),
}

/// The other branch a short way from the event, on one of its sides.
struct BranchSide {
    /// The first of its orbits.
    point: Vector,
    /// Whether the parameter grows from there on.
    up: bool,
}

/// A located event solves the singular equations to about 1e-12, and those of an orbit without one are far from it.
const SINGULAR: f64 = 1e-7;

/// How far from the event the branch begins, in scaled unknowns of order one, and how often a quarter of it is tried:
/// the parameter moves by the square of it where the branch begins level.
const AWAY: f64 = 3e-3;
const TRIES: i32 = 5;

/// Where the parameter moves by less of its unit, the branches are one but for rounding, as where the unit of a state is small: the
/// branch begins so many times farther, so often at most.
const MOVED: f64 = 1e-8;
const FARTHER: f64 = 4.0;
const FARTHEST: i32 = 16;

/// Where the parameter moves by more of its unit, which is the width of the range, the branch begins nearer: so many quarters of it are
/// tried at most.
const PASSED: f64 = 0.05;
const NEAREST: i32 = 30;

/// Settings of Newton's method for an orbit beside an event.
const BESIDE: Settings = Settings {
    tolerance: 1e-10,
    most_iterations: 20,
    halvings: 4,
    polish: 1,
};

/// How the other branch leaves: its direction, and the normal of planes that it meets and the known one does not.
struct Leaving {
    along: Vector,
    across: Vector,
}

impl Leaving {
    /// Of two tangents that which is less along the known branch or, where nothing is known of it, more along the null vector.
    fn along(tangents: [Vector; 2], known: Option<&Vector>, null: &Vector) -> Option<Leaving> {
        let [one, two] = tangents;
        let own = |tangent: &Vector| match known {
            Some(known) => tangent.dot(known).abs(),
            None => -tangent.dot(null).abs(),
        };
        let (known, along) = if own(&one) > own(&two) {
            (one, two)
        } else {
            (two, one)
        };
        let across = beside(&along, &known)?;
        Some(Leaving { along, across })
    }

    /// The same to the side of this sign.
    fn times(&self, sign: f64) -> Leaving {
        Leaving {
            along: &self.along * sign,
            across: &self.across * sign,
        }
    }
}

/// The unit vector of what is left of a direction beside another; `None` where they are one.
fn beside(direction: &Vector, known: &Vector) -> Option<Vector> {
    /// Less of a unit vector is nothing.
    const LEFT: f64 = 1e-3;
    let across = direction - known * (direction.dot(known) / known.norm_squared());
    (across.norm() > LEFT).then(|| across.normalize())
}

/// The first orbit of the other branch at an event, and the ways that the branch goes from there, of those asked for. At
/// a doubling and at a loss of symmetry its two sides go one way, and one is the other shifted in time or mirrored: a
/// branch that goes one way only is found from either. `known` is the direction of the known branch, where that is not the one of the
/// parameter alone.
///
/// # Errors
/// No other branch passes there, or it is not admissible.
pub fn other<O: Orbit>(
    orbit: &O,
    (at, known): (&Vector, Option<Vector>),
    directions: &[bool],
) -> Result<(Vector, Vec<bool>), NoBranch<O>> {
    let evaluated = newton::jacobian(orbit, at).map_err(newton::Failure::System);
    let (matrix, _) = evaluated.map_err(NoBranch::Newton)?;
    let square = matrix.columns(0, at.len() - 1).clone_owned();
    let least = linalg::least(&square).ok_or(NoBranch::Newton(newton::Failure::Singular))?;
    if least.value > SINGULAR * least.largest {
        return Err(NoBranch::Regular(least.value / least.largest));
    }
    let null = least.right.insert_row(at.len() - 1, 0.0);
    let known = known.filter(|known| known.len() == at.len() && known.norm() > 0.0);
    let tangents = Branching::at(orbit, at, SINGULAR).and_then(|branching| branching.tangents());
    let leaving = tangents.and_then(|tangents| Leaving::along(tangents, known.as_ref(), &null));
    let leaving = leaving.unwrap_or_else(|| {
        let across = known
            .and_then(|known| beside(&null, &known))
            .unwrap_or(null);
        Leaving {
            along: across.clone(),
            across,
        }
    });
    let found = [1.0, -1.0].map(|sign| side(orbit, at, &leaving.times(sign)));
    if let [Err(_), Err(refused)] = found {
        return Err(refused);
    }
    // the one where the parameter grows goes first
    let mut sides: Vec<BranchSide> = found.into_iter().flatten().collect();
    sides.sort_by_key(|side| !side.up);
    let wished = |side: &BranchSide| directions.contains(&side.up);
    let begun = sides.remove(sides.iter().position(wished).unwrap_or(0));
    let mut ways = vec![begun.up];
    if directions.len() > 1 && sides.iter().any(|side| side.up != begun.up) {
        ways.push(!begun.up);
    }
    Ok((begun.point, ways))
}

/// Whether an orbit is one of a family at one value of the parameter, as motions without loss are at a resonance: beside
/// it, along a null vector, lies another. At a fold or where branches cross the orbit that lies there has another value of
/// the parameter, by no less than the square of the distance. Where the equations with the parameter free are singular,
/// too, Newton's method at a fixed parameter comes back from there.
pub fn is_in_family<O: Orbit>(orbit: &O, at: &Vector) -> bool {
    /// Steps: at a double zero each takes half of the distance away, at a threefold one a third.
    const STEPS: usize = 10;
    /// Singular values below this part of the largest are zero.
    const ZERO: f64 = 1e-9;
    /// Below this part they are nothing but rounding.
    const ROUNDED: f64 = 1e-14;
    /// Values of the parameter, in its unit, that are the same but for rounding: far below the square of the distance.
    const SAME: f64 = 1e-11;
    let last = at.len() - 1;
    let evaluated = |point: &Vector| {
        let (matrix, residual) = newton::evaluated(orbit, point).ok()?;
        Some((matrix.columns(0, last).clone_owned(), residual))
    };
    let null = evaluated(at).and_then(|(square, _)| linalg::least(&square));
    let Some(null) = null.filter(|least| least.value <= ZERO * least.largest) else {
        return false;
    };
    let along = null.right.insert_row(last, 0.0);
    let guess = at + &along * AWAY;
    let mut plane = Plane {
        normal: &along,
        through: &guess,
    };
    // singular also beside the orbit: it is one of a family whatever the parameter
    let is_regular = newton::evaluated(orbit, &guess).is_ok_and(|(matrix, _)| {
        let mut bordered = matrix.insert_row(last, 0.0);
        bordered.set_row(last, &along.transpose());
        linalg::least(&bordered).is_some_and(|least| least.value > ROUNDED * least.largest)
    });
    let beside = || newton::solve(orbit, &mut plane, &guess, &BESIDE).ok();
    let beside = is_regular.then(beside).flatten();
    let near = |solution: &Solution| (&solution.point - &guess).norm() <= AWAY;
    if let Some(Solution { point, .. }) = beside.filter(near) {
        return (point[last] - at[last]).abs() <= SAME * at[last].abs().max(1.0);
    }
    let mut point = guess;
    for _ in 0..STEPS {
        let step = evaluated(&point).and_then(|(square, residual)| {
            let inverse = linalg::pseudo_inverse(&square, ZERO)?;
            Some((inverse * residual).insert_row(last, 0.0))
        });
        let Some(step) = step else {
            return false;
        };
        point -= step;
    }
    let solves = evaluated(&point).is_some_and(|(_, residual)| residual.amax() <= SINGULAR * AWAY);
    solves && along.dot(&(&point - at)) >= 0.5 * AWAY
}

/// Whether every inequality of an orbit holds.
///
/// # Errors
/// One does not, or it cannot be examined.
pub fn admitted<O: Orbit>(orbit: &O, point: &Vector) -> Result<(), NoBranch<O>> {
    let examination = orbit.examination(point);
    let examination =
        examination.map_err(|failure| NoBranch::Newton(newton::Failure::System(failure)))?;
    match examination.verdict() {
        SignVerdict::Positive => Ok(()),
        _ => Err(NoBranch::Inadmissible(orbit.inadmissible(&examination))),
    }
}

/// The branch that leaves a singular point.
fn side<O: Orbit>(
    orbit: &O,
    at: &Vector,
    Leaving { along, across }: &Leaving,
) -> Result<BranchSide, NoBranch<O>> {
    let last = at.len() - 1;
    let begun = |away: f64| {
        let guess = at + along * away;
        let mut plane = Plane {
            normal: across,
            through: &guess,
        };
        let corrected = correct(orbit, &mut plane, &guess, along, &BESIDE);
        let (node, _) = corrected.map_err(NoBranch::Newton)?;
        admitted(orbit, &node.point)?;
        Ok(node)
    };
    let moved = |node: &Node| (node.point[last] - at[last]).abs();
    let is_apart = |node: &Node| moved(node) >= MOVED;
    let nearer = |exponent: i32| begun(AWAY * 0.25_f64.powi(exponent));
    let mut found = begun(AWAY);
    for exponent in 1..TRIES {
        found = found.or_else(|_| nearer(exponent));
    }
    let mut node = found?;
    if moved(&node) > PASSED {
        let mut nodes = (1..=NEAREST).filter_map(|exponent| nearer(exponent).ok());
        let near = nodes.find(|node| moved(node) <= PASSED);
        node = near.unwrap_or(node);
    }
    if !is_apart(&node) {
        let farther = (1..=FARTHEST).map_while(|step| begun(AWAY * FARTHER.powi(step)).ok());
        node = farther.into_iter().find(is_apart).unwrap_or(node);
    }
    Ok(BranchSide {
        up: node.tangent[last] > 0.0,
        point: node.point,
    })
}
