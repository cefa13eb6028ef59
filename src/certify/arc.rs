//! Arcs: between two special points there is no other.
//!
//! With one of the unknowns x_κ as the coordinate, a piece of the solution
//! curve is looked for in a tube around its chord, x = m + (x_κ − m_κ)t + y, |y| ≤ r. With J enclosing F′ over
//! the tube, C ≈ J⁻¹ with the row of x_κ, and h half the length of the piece,
//!
//! ```text
//! |CF(m)| + |CJt| h + |1 − CJ| r < r
//! ```
//!
//! proves that for every x_κ there is exactly one solution in the tube (Krawczyk's operator with a parameter),
//! and then its tangent is within r/h of t. A point between two pieces lies in both tubes, so that their curves
//! are one. All inequalities hold over every piece. Next to an end, where the margin of the event vanishes, what
//! is not positive over the piece grows from there. Where x_κ is the parameter there is no fold; otherwise the
//! tangent says so, or next to a fold the curve: it is the only one in the tube.
//!
//! What solves equations along a curve is a [`ArcEquations`]: waves ([`super::stretch`]) and orbits ([`super::orbit::arc`]).
//!
//! Compare J.B. van den Berg, J.-P. Lessard, K. Mischaikow, Math. Comp. 79 (2010) 1565.

use super::equations::Evaluated;
use super::krawczyk::{self, Chord};
use crate::interval::{Gradient, Interval};
use crate::linalg::{Matrix, kernel};

/// A number along a piece of a curve, with its derivative away from the end that the piece is next to, if it is.
pub type Moving = Gradient<Interval, 1>;

/// Why an arc is not proven: for an inequality, or for what begins beyond an event.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Broken<U, B> {
    #[error("an end is not proven")]
    End,
    /// It begins where the sequence of regimes changes.
    #[error("beyond the event that it begins with: {0}")]
    Beyond(B),
    /// The two ends have different sequences or numbers.
    #[error("not covered: its ends have not one sequence of zones")]
    Apart,
    /// What grows at two points differs, and the events between do not make it.
    #[error(
        "undecided: {0} multipliers or eigenvalues grow at a point before and {1} at one after it, which the events between do not \
         make"
    )]
    Tally(usize, usize),
    #[error("undecided: beyond {0} no tube has exactly one curve")]
    Tube(f64),
    #[error("undecided: beyond {0} there may be a fold")]
    Fold(f64),
    #[error("undecided: beyond {0} {1} is not proven")]
    Inequality(f64, U),
}

/// Equations with one unknown more than there are, and inequalities.
pub trait ArcEquations {
    /// Which inequality is not proven.
    type Unproven;
    /// Why nothing is known of what begins beyond an event.
    type Beyond;

    /// Units of the unknowns.
    fn units(&self) -> &[f64];

    /// Where the parameter stands.
    fn parameter(&self) -> usize;

    /// Unknowns that may be the coordinate of a piece.
    fn coordinates(&self) -> Vec<usize>;

    /// The equations; the last row is free.
    fn equations(&self, x: &[Interval]) -> Option<Evaluated>;

    /// Proves all inequalities over a piece; next to an end, whose index is given, what is not positive grows from there.
    ///
    /// # Errors
    /// One that is not proven.
    fn hold(&self, x: &[Moving], next_to: Option<usize>) -> Result<(), Self::Unproven>;

    /// Whether the fold at an end is the only one over a piece next to it, along which ∂x_κ = 1.
    fn is_only_fold(
        &self,
        end: usize,
        coordinate: usize,
        x: &[Interval],
        tangent: &[Interval],
    ) -> bool;

    /// The equations, and that of a coordinate.
    fn located(&self, x: &[Interval], coordinate: usize, value: f64) -> Option<Evaluated> {
        let last = x.len() - 1;
        let mut evaluated = self.equations(x)?;
        evaluated.residual[last] = x[coordinate] - Interval::point(value);
        evaluated.jacobian[last].fill(Interval::ZERO);
        evaluated.jacobian[last][coordinate] = Interval::ONE;
        Some(evaluated)
    }

    /// The tangent at a joint in the units of the unknowns.
    fn tangent(&self, joint: &Joint) -> Option<Vec<f64>> {
        let n = joint.near.len();
        let Evaluated { jacobian, .. } = self.equations(&joint.at)?;
        let scaled = |i: usize, j: usize| jacobian[i][j].middle() * self.units()[j];
        let kernel = kernel(&Matrix::from_fn(n - 1, n, scaled))?;
        Some(kernel.null_vector.iter().copied().collect())
    }

    /// The point of the curve at a value of a coordinate, from another and the tangent there.
    fn joint(&self, from: &Joint, tangent: &[f64], coordinate: usize, value: f64) -> Option<Joint> {
        let equations = |x: &[Interval]| self.located(x, coordinate, value);
        let way = value - from.near[coordinate];
        let share = way / (tangent[coordinate] * self.units()[coordinate]);
        let numbers = from.near.iter().zip(tangent).zip(self.units());
        let guess: Vec<f64> = numbers
            .map(|((x, tangent), unit)| x + share * tangent * unit)
            .collect();
        let near = krawczyk::refined(&equations, &guess)?;
        krawczyk::enclosed(&equations, &near, self.units()).map(|zero| Joint::new(zero.at))
    }
}

/// Reasons of a kind of curves.
pub type BrokenOf<C> = Broken<<C as ArcEquations>::Unproven, <C as ArcEquations>::Beyond>;

const PIECES: usize = 1000;
/// Pieces shorter than this share of the arc are not tried.
const SHORTEST: f64 = 1e-7;
/// The end is tried from so many lengths of a piece away.
const REACH: f64 = 16.0;
/// A point is not about to reach the end where an unknown is so many times farther from it, in units, than the coordinate: that
/// passes its value there on the way.
const PASSES: f64 = 1000.0;
/// Tubes are at least this much wider than the points between them are known, and than this in units of the
/// unknowns.
const WIDER: f64 = 8.0;
const NARROWEST: f64 = 1e-15;

/// A point of the arc: next to it in doubles, and enclosed.
#[derive(Clone)]
pub struct Joint {
    pub near: Vec<f64>,
    pub at: Vec<Interval>,
}

impl Joint {
    pub fn new(at: Vec<Interval>) -> Joint {
        Joint {
            near: at.iter().map(|x| x.middle()).collect(),
            at,
        }
    }
}

/// Which way an arc leaves its first end.
#[derive(Clone, Copy)]
pub enum ArcDirection {
    /// Toward the last in the parameter.
    Parameter,
    /// From a fold, which does not say on which of its sides the last is; toward it in this unknown first, if there is one
    /// that leads.
    Fold(Option<usize>),
    /// This unknown grows.
    Grows(usize),
}

/// A piece of the curve.
struct ArcPiece {
    chord: Chord,
    radius: Vec<f64>,
}

impl ArcPiece {
    fn hull(&self) -> Vec<Interval> {
        self.chord.hull(&self.radius)
    }

    /// Intervals of the tangent, ∂x_κ = 1.
    fn tangent(&self) -> Vec<Interval> {
        let Chord {
            coordinate,
            slope,
            reach,
            ..
        } = &self.chord;
        let enclosed = |(index, (t, r)): (usize, (&f64, &f64))| {
            if index == *coordinate {
                return Interval::ONE;
            }
            let share = (Interval::point(*r) / Interval::point(*reach)).high;
            Interval::around(*t, share)
        };
        let numbers = slope.iter().zip(&self.radius);
        numbers.enumerate().map(enclosed).collect()
    }

    /// Whether an enclosed point of the curve lies in the tube.
    fn has(&self, point: &[Interval]) -> bool {
        let Chord {
            coordinate,
            middle,
            slope,
            reach,
        } = &self.chord;
        let along = point[*coordinate] - Interval::point(middle[*coordinate]);
        let mut numbers = point
            .iter()
            .zip(middle)
            .zip(slope)
            .zip(&self.radius)
            .enumerate();
        along.magnitude() <= *reach
            && numbers.all(|(index, (((x, m), t), r))| {
                let apart = *x - Interval::point(*m) - along * Interval::point(*t);
                index == *coordinate || apart.magnitude() < *r
            })
    }
}

/// The direction v at a fold, with ∂p = 0 and ⟨ℓ, v⟩ = 1, of a tangent.
pub fn direction<'a>(
    normal: &[f64],
    tangent: &'a [Interval],
) -> impl Iterator<Item = Interval> + use<'a> {
    let weights = normal.iter().zip(tangent);
    let size = weights.fold(Interval::ZERO, |sum, (weight, v)| {
        sum + Interval::point(*weight) * *v
    });
    tangent.iter().map(move |v| *v / size)
}

/// Proves that a curve leads from one end to another, without a fold and with all inequalities.
///
/// # Errors
/// It is not proven.
pub fn prove<C: ArcEquations>(
    curve: &C,
    ends: [&Joint; 2],
    way: ArcDirection,
) -> Result<(), BrokenOf<C>> {
    match (follow(curve, ends, way, 1.0), way) {
        (Err(_), ArcDirection::Fold(_)) => follow(curve, ends, way, -1.0),
        (followed, _) => followed,
    }
}

/// Follows an arc from its first end to its last; from a fold a `side` of −1 leaves the other way.
fn follow<C: ArcEquations>(
    curve: &C,
    [first, last]: [&Joint; 2],
    way: ArcDirection,
    side: f64,
) -> Result<(), BrokenOf<C>> {
    let parameter = curve.parameter();
    let whole = |coordinate: usize| last.near[coordinate] - first.near[coordinate];
    let coordinates = curve.coordinates();
    let mut before: Option<Vec<f64>> = None;
    let mut joint = first.clone();
    let mut longest = f64::INFINITY;
    let mut count = 0;
    // why the last piece did not do
    let mut blocked = None;
    loop {
        let value = joint.near[parameter];
        let tangent = curve.tangent(&joint).ok_or(Broken::Tube(value))?;
        // what moves most: the parameter, unless another does by far
        let moves =
            |index: usize| tangent[index].abs() * if index == parameter { 8.0 } else { 1.0 };
        let most = coordinates.iter().copied();
        let coordinate = most
            .max_by(|a, b| moves(*a).total_cmp(&moves(*b)))
            .unwrap_or(parameter);
        let leaves = || match way {
            ArcDirection::Parameter => tangent[parameter] * whole(parameter),
            ArcDirection::Grows(index) => tangent[index],
            ArcDirection::Fold(index) => {
                let lead = index.unwrap_or(coordinate);
                tangent[lead] * whole(lead) * side
            }
        };
        let forward = match &before {
            Some(before) => before.iter().zip(&tangent).map(|(a, b)| a * b).sum(),
            None => leaves(),
        };
        let forward = f64::signum(forward);
        let direction = forward * tangent[coordinate].signum();
        before = Some(tangent.iter().map(|x| x * forward).collect());
        let unit = curve.units()[coordinate];
        let left = (last.near[coordinate] - joint.near[coordinate]) * direction;
        let shortest = SHORTEST * whole(coordinate).abs().max(SHORTEST * unit);
        let mut length = longest.min(unit);
        let apart =
            |index: &usize| (last.near[*index] - joint.near[*index]).abs() / curve.units()[*index];
        let far = coordinates.iter().map(apart).fold(0.0, f64::max);
        if left > 0.0 && far < PASSES * left / unit {
            length = length.min(0.5 * left);
            if count > 0 && left < REACH * length {
                match piece(curve, [&joint, last], coordinate, direction, Some(1)) {
                    Ok(()) => return Ok(()),
                    // too close to it a piece is shorter than the end is known
                    Err(Broken::Tube(_)) if blocked.is_some() => {}
                    Err(reason) => blocked = Some(reason),
                }
            }
        }
        let lengths = [length, shortest];
        let step = (coordinate, direction);
        let next = advanced(curve, &joint, &tangent, step, lengths, count == 0);
        (joint, longest) = next.map_err(|reason| blocked.take().unwrap_or(reason))?;
        count += 1;
        if count >= PIECES {
            return Err(blocked.unwrap_or(Broken::Tube(value)));
        }
    }
}

/// The joint a length further, or less where no piece to it is proven, and the longest step to be tried from there.
fn advanced<C: ArcEquations>(
    curve: &C,
    joint: &Joint,
    tangent: &[f64],
    (coordinate, direction): (usize, f64),
    [mut length, shortest]: [f64; 2],
    is_first: bool,
) -> Result<(Joint, f64), BrokenOf<C>> {
    let value = joint.near[curve.parameter()];
    let next_to = is_first.then_some(0);
    let mut growth = 2.0;
    loop {
        let to = joint.near[coordinate] + direction * length;
        let next = curve.joint(joint, tangent, coordinate, to);
        let next = next.ok_or(Broken::Tube(value)).and_then(|next| {
            piece(curve, [joint, &next], coordinate, direction, next_to)?;
            Ok(next)
        });
        match next {
            Ok(next) => return Ok((next, growth * length)),
            Err(reason) if length < shortest => return Err(reason),
            Err(_) => {
                length *= 0.5;
                growth = 1.0;
            }
        }
    }
}

fn piece<C: ArcEquations>(
    curve: &C,
    [from, to]: [&Joint; 2],
    coordinate: usize,
    direction: f64,
    next_to: Option<usize>,
) -> Result<(), BrokenOf<C>> {
    let parameter = curve.parameter();
    let value = from.near[parameter];
    let chord = Chord::between(&from.near, &to.near, coordinate);
    let known = from.at.iter().zip(&to.at).zip(curve.units());
    let narrowest: Vec<f64> = known
        .map(|((a, b), unit)| WIDER * (a.width().max(b.width()) + unit * NARROWEST))
        .collect();
    let equations = |x: &[Interval]| curve.located(x, coordinate, chord.middle[coordinate]);
    let radius = krawczyk::tube(&equations, &chord, &narrowest).ok_or(Broken::Tube(value))?;
    let piece = ArcPiece { chord, radius };
    if !(piece.has(&from.at) && piece.has(&to.at)) {
        return Err(Broken::Tube(value));
    }
    let (hull, tangent) = (piece.hull(), piece.tangent());
    let turns = coordinate != parameter && tangent[parameter].contains(0.0);
    let once = |end| curve.is_only_fold(end, coordinate, &hull, &tangent);
    if turns && !next_to.is_some_and(once) {
        return Err(Broken::Fold(value));
    }
    // away from the end
    let sign = Interval::point(match next_to {
        None => 0.0,
        Some(0) => direction,
        Some(_) => -direction,
    });
    let numbers = hull.iter().zip(&tangent);
    let moving: Vec<Moving> = numbers
        .map(|(value, by)| Gradient {
            value: *value,
            by: [*by * sign],
        })
        .collect();
    let held = curve.hold(&moving, next_to);
    held.map_err(|reason| Broken::Inequality(value, reason))
}
