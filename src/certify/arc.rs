//! Arcs: between two special points there is no other.
//!
//! With one of the unknowns x_κ — the excess speed, the length of a zone or the parameter — as the coordinate, a piece of the solution
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
//! tangent says so, or next to a fold Krawczyk's operator: it is the only one in the tube.
//!
//! Compare J.B. van den Berg, J.-P. Lessard, K. Mischaikow, Math. Comp. 79 (2010) 1565.

use super::inequality::{self, Part, Unproven};
use super::krawczyk::{self, Chord};
use super::system::{Condition, Evaluated, System};
use super::{Proof, units};
use crate::interval::{Decimal, Gradient, Interval};
use crate::linalg::{Matrix, kernel};
use crate::wave::admissibility::Watch;

/// Why an arc is not proven.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Broken {
    /// An end is not.
    #[error("an end is not proven")]
    End,
    /// It begins where the signature changes.
    #[error("not covered: at its beginning a zone opens or closes")]
    Change,
    /// The two ends have different signatures or models.
    #[error("not covered: its ends are not waves of one signature")]
    Apart,
    /// No tube.
    #[error("undecided: beyond {0} no tube has exactly one curve")]
    Tube(f64),
    /// A fold.
    #[error("undecided: beyond {0} there may be a fold")]
    Fold(f64),
    /// An inequality.
    #[error("undecided: beyond {0} {1} is not proven")]
    Inequality(f64, Unproven),
}

/// Pieces at most.
const PIECES: usize = 1000;
/// Pieces shorter than this share of the arc are not tried.
const SHORTEST: f64 = 1e-7;
/// The end is tried from so many lengths of a piece away.
const REACH: f64 = 16.0;
/// Tubes are at least this much wider than the points between them are known, and than this in units of the
/// unknowns.
const WIDER: f64 = 8.0;
const NARROWEST: f64 = 1e-15;

/// A point of the arc: next to it in doubles, and enclosed.
#[derive(Clone)]
struct Joint {
    near: Vec<f64>,
    at: Vec<Interval>,
}

impl Joint {
    fn new(at: Vec<Interval>) -> Joint {
        Joint {
            near: at.iter().map(|x| x.middle()).collect(),
            at,
        }
    }
}

/// An end of the arc.
struct Ending<'a> {
    system: System<'a>,
    joint: Joint,
    /// The zero of its own equations, in doubles.
    guess: Vec<f64>,
    /// e₀ of the arc over that of the end.
    ratio: Interval,
}

impl<'a> Ending<'a> {
    fn new(proof: &'a Proof, steps: &[usize], excess: f64) -> Option<Ending<'a>> {
        let Proof {
            posed,
            near,
            condition,
            ..
        } = proof;
        let (system, guess) = System::cut(posed, near, condition, Some(steps))?;
        let equations = |x: &[Interval]| system.evaluate(x);
        let units = units(&system, &guess, near, posed.unit);
        let mut at = krawczyk::enclosed(&equations, &guess, &units)?.at;
        at.truncate(system.waves());
        if system.minimum(&at).is_some() {
            at.remove(system.waves() - 3);
        }
        // 1 + u = e/e₀
        let ratio = Interval::point(near.excess) / Interval::point(excess);
        let index = at.len() - 2;
        at[index] = (Interval::ONE + at[index]) * ratio - Interval::ONE;
        Some(Ending {
            system,
            joint: Joint::new(at),
            guess,
            ratio,
        })
    }
}

struct Arc<'a> {
    system: System<'a>,
    /// Units of the unknowns.
    units: Vec<f64>,
    ends: [Ending<'a>; 2],
}

/// A piece of the curve.
struct Piece {
    chord: Chord,
    /// Radius r.
    radius: Vec<f64>,
    /// The end that it is next to.
    next_to: Option<usize>,
}

impl Piece {
    /// Intervals of the unknowns.
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

/// Proves that between two points of a branch the waves are one curve, on which no fold and no change of regime
/// lies; returns the number of pieces.
pub fn prove(from: &Proof, to: &Proof) -> Result<usize, Broken> {
    let signature = &from.near.signature;
    if from.after.as_ref().is_some_and(|after| after != signature) {
        return Err(Broken::Change);
    }
    let posed = &from.posed;
    if posed.fixed() != to.posed.fixed() || *signature != to.near.signature {
        return Err(Broken::Apart);
    }
    let value = Condition::Value(Decimal::of(from.near.parameter));
    let steps = |proof: &Proof| {
        let (system, _) = System::new(posed, &proof.near, &value)?;
        let zones = 0..signature.len();
        Some(zones.map(|zone| system.steps(zone)).collect::<Vec<_>>())
    };
    let both = steps(from).zip(steps(to)).ok_or(Broken::End)?;
    // a zone that closes is one step to the last: at most two radians
    let steps = both.0.iter().zip(&both.1).map(|both| match both {
        (1, 2) | (2, 1) => 1,
        (a, b) => *a.max(b),
    });
    let steps: Vec<usize> = steps.collect();
    let begin = System::cut(posed, &from.near, &value, Some(&steps));
    let (system, guess) = begin.ok_or(Broken::End)?;
    let ending = |proof| Ending::new(proof, &steps, from.near.excess).ok_or(Broken::End);
    let arc = Arc {
        units: units(&system, &guess, &from.near, posed.unit),
        ends: [ending(from)?, ending(to)?],
        system,
    };
    // a fold does not say which of its two sides leads to the other end
    match arc.follow(1.0) {
        Err(_) if from.condition == Condition::Fold => arc.follow(-1.0),
        followed => followed,
    }
}

impl Arc<'_> {
    /// Follows the arc from its first end to its last; a `side` of −1 leaves the other way.
    fn follow(&self, side: f64) -> Result<usize, Broken> {
        let [excess, parameter] = self.system.tail();
        let [first, last] = self.ends.each_ref().map(|end| &end.joint);
        let whole = |coordinate: usize| last.near[coordinate] - first.near[coordinate];
        // which way the arc leaves: in the parameter, or at a fold in the speed
        let folded = *self.ends[0].system.condition == Condition::Fold;
        let lead = if folded { excess } else { parameter };
        let mut before: Option<Vec<f64>> = None;
        let mut joint = first.clone();
        let mut longest = f64::INFINITY;
        let mut count = 0;
        // why the last piece did not do
        let mut blocked = None;
        loop {
            let value = joint.near[parameter];
            let tangent = self.tangent(&joint).ok_or(Broken::Tube(value))?;
            let forward = match &before {
                Some(before) => before.iter().zip(&tangent).map(|(a, b)| a * b).sum(),
                None => tangent[lead] * whole(lead) * side,
            };
            let forward = f64::signum(forward);
            // what moves most: the parameter, unless another does by far
            let durations =
                (0..self.system.near.zones.len()).map(|zone| self.system.duration(zone));
            let moves =
                |index: usize| tangent[index].abs() * if index == parameter { 8.0 } else { 1.0 };
            let coordinate = durations
                .chain([excess, parameter])
                .max_by(|a, b| moves(*a).total_cmp(&moves(*b)))
                .unwrap_or(parameter);
            let direction = forward * tangent[coordinate].signum();
            before = Some(tangent.iter().map(|x| x * forward).collect());
            let unit = self.units[coordinate];
            let left = (last.near[coordinate] - joint.near[coordinate]) * direction;
            let shortest = SHORTEST * whole(coordinate).abs().max(SHORTEST * unit);
            let mut length = longest.min(unit);
            if left > 0.0 {
                length = length.min(0.5 * left);
                if count > 0 && left < REACH * length {
                    match self.piece(&joint, last, coordinate, direction, Some(1)) {
                        Ok(()) => return Ok(count + 1),
                        // too close to it a piece is shorter than the end is known
                        Err(Broken::Tube(_)) if blocked.is_some() => {}
                        Err(reason) => blocked = Some(reason),
                    }
                }
            }
            let mut growth = 2.0;
            loop {
                let to = joint.near[coordinate] + direction * length;
                let next_to = (count == 0).then_some(0);
                let next = self.joint(&joint, &tangent, coordinate, to);
                let next = next.ok_or(Broken::Tube(value)).and_then(|next| {
                    self.piece(&joint, &next, coordinate, direction, next_to)?;
                    Ok(next)
                });
                match next {
                    Ok(next) => {
                        joint = next;
                        count += 1;
                        longest = growth * length;
                        break;
                    }
                    Err(reason) if length < shortest => return Err(blocked.unwrap_or(reason)),
                    Err(_) => {
                        length *= 0.5;
                        growth = 1.0;
                    }
                }
            }
            if count >= PIECES {
                return Err(blocked.unwrap_or(Broken::Tube(value)));
            }
        }
    }

    /// The tangent at a joint in the units of the unknowns.
    fn tangent(&self, joint: &Joint) -> Option<Vec<f64>> {
        let n = joint.near.len();
        let Evaluated { jacobian, .. } = self.system.waves_into(&joint.at, n)?;
        let scaled = |i: usize, j: usize| jacobian[i][j].middle() * self.units[j];
        let kernel = kernel(&Matrix::from_fn(n - 1, n, scaled))?;
        Some(kernel.null_vector.iter().copied().collect())
    }

    /// The equations of the wave, and that of its coordinate.
    fn equations(&self, x: &[Interval], coordinate: usize, value: f64) -> Option<Evaluated> {
        let n = x.len();
        let mut evaluated = self.system.waves_into(x, n)?;
        evaluated.residual[n - 1] = x[coordinate] - Interval::point(value);
        evaluated.jacobian[n - 1].fill(Interval::ZERO);
        evaluated.jacobian[n - 1][coordinate] = Interval::ONE;
        Some(evaluated)
    }

    /// The point of the curve at a value of a coordinate, from another and the tangent there.
    fn joint(&self, from: &Joint, tangent: &[f64], coordinate: usize, value: f64) -> Option<Joint> {
        let equations = |x: &[Interval]| self.equations(x, coordinate, value);
        let way = value - from.near[coordinate];
        let share = way / (tangent[coordinate] * self.units[coordinate]);
        let numbers = from.near.iter().zip(tangent).zip(&self.units);
        let guess: Vec<f64> = numbers
            .map(|((x, tangent), unit)| x + share * tangent * unit)
            .collect();
        let near = krawczyk::refined(&equations, &guess)?;
        krawczyk::enclosed(&equations, &near, &self.units).map(|zero| Joint::new(zero.at))
    }

    /// Proves a piece.
    fn piece(
        &self,
        from: &Joint,
        to: &Joint,
        coordinate: usize,
        direction: f64,
        next_to: Option<usize>,
    ) -> Result<(), Broken> {
        let [_, parameter] = self.system.tail();
        let value = from.near[parameter];
        let chord = Chord::between(&from.near, &to.near, coordinate);
        let known = from.at.iter().zip(&to.at).zip(&self.units);
        let narrowest: Vec<f64> = known
            .map(|((a, b), unit)| WIDER * (a.width().max(b.width()) + unit * NARROWEST))
            .collect();
        let equations = |x: &[Interval]| self.equations(x, coordinate, chord.middle[coordinate]);
        let radius = krawczyk::tube(&equations, &chord, &narrowest).ok_or(Broken::Tube(value))?;
        let piece = Piece {
            chord,
            radius,
            next_to,
        };
        if !(piece.has(&from.at) && piece.has(&to.at)) {
            return Err(Broken::Tube(value));
        }
        let (hull, tangent) = (piece.hull(), piece.tangent());
        let turns = coordinate != parameter && tangent[parameter].contains(0.0);
        if turns && !self.is_only_fold(&piece) {
            return Err(Broken::Fold(value));
        }
        let condition = self.system.condition;
        let over = |part, x: &[Interval]| inequality::prove(&self.system, condition, part, x);
        let held = match piece.next_to {
            None => over(Part::All, &hull),
            Some(end) => {
                // away from the end
                let sign = Interval::point(if end == 0 { direction } else { -direction });
                let numbers = hull.iter().zip(&tangent);
                let moving: Vec<_> = numbers
                    .map(|(value, by)| Gradient {
                        value: *value,
                        by: [*by * sign],
                    })
                    .collect();
                // a zone that closes there has nothing to grow from
                let closed = match self.ends[end].system.condition {
                    Condition::Margin { watch, zone, .. } if *watch == Watch::Duration => {
                        Some(*zone)
                    }
                    _ => None,
                };
                let rest = closed.map_or(Part::All, Part::But);
                inequality::prove(&self.system, condition, rest, &moving)
                    .and_then(|_| closed.map_or(Ok(0), |zone| over(Part::Within(zone), &hull)))
            }
        };
        held.map(|_| ())
            .map_err(|reason| Broken::Inequality(value, reason))
    }

    /// Whether a piece next to a fold has no other.
    fn is_only_fold(&self, piece: &Piece) -> bool {
        let Some(end) = piece.next_to.map(|end| &self.ends[end]) else {
            return false;
        };
        if *end.system.condition != Condition::Fold {
            return false;
        }
        let [excess, parameter] = self.system.tail();
        let ratio = Interval::ONE / end.ratio;
        let mut x = piece.hull();
        x[excess] = (Interval::ONE + x[excess]) * ratio - Interval::ONE;
        // the direction v at a fold, ∂p = 0, ⟨ℓ, v⟩ = 1
        let mut v = piece.tangent();
        v.truncate(parameter);
        v[excess] = v[excess] * ratio;
        let weights = end.system.normal().iter().zip(&v);
        let size = weights.fold(Interval::ZERO, |sum, (weight, v)| {
            sum + Interval::point(*weight) * *v
        });
        x.extend(v.iter().map(|v| *v / size));
        let equations = |x: &[Interval]| end.system.evaluate(x);
        krawczyk::is_only_zero(&equations, &end.guess, &x)
    }
}
