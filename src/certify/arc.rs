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
//! tangent says so, or next to a fold Krawczyk's operator: it is the only one in the tube. A zone that opens where
//! its neighbours touch a limit has, like a fold, a length in which the parameter is stationary at the event.
//!
//! An arc that begins at a change of regime begins with its wave in the signature beyond ([`super::change`]).
//!
//! Compare J.B. van den Berg, J.-P. Lessard, K. Mischaikow, Math. Comp. 79 (2010) 1565.

use super::change::{self, NotBeyond};
use super::equations::Evaluated;
use super::inequality::{self, Part, Unproven};
use super::krawczyk::{self, Chord};
use super::system::{Condition, Near, Posed, System};
use super::{Proof, enclosed, units};
use crate::interval::{Gradient, Interval};
use crate::linalg::{Matrix, kernel};
use crate::tube::wave::admissibility::Watch;

/// Why an arc is not proven.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Broken {
    #[error("an end is not proven")]
    End,
    /// It begins where the signature changes.
    #[error("beyond the event that it begins with: {0}")]
    Beyond(#[from] NotBeyond),
    /// The two ends have different signatures or models.
    #[error("not covered: its ends are not waves of one signature")]
    Apart,
    #[error("undecided: beyond {0} no tube has exactly one curve")]
    Tube(f64),
    #[error("undecided: beyond {0} there may be a fold")]
    Fold(f64),
    #[error("undecided: beyond {0} {1} is not proven")]
    Inequality(f64, Unproven),
}

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

/// A point of the branch, in doubles.
#[derive(Clone, Copy)]
struct Place<'a> {
    near: &'a Near,
    condition: &'a Condition,
}

impl<'a> Place<'a> {
    fn new(near: &'a Near, condition: &'a Condition) -> Place<'a> {
        Place { near, condition }
    }

    /// The zone that has no length here.
    fn closed(&self) -> Option<usize> {
        let zones = 0..self.near.signature.len();
        match self.condition {
            Condition::Margin {
                watch: Watch::Duration,
                zone,
                ..
            } if zones.contains(zone) => Some(*zone),
            _ => None,
        }
    }
}

/// An end of the arc.
struct Ending<'a> {
    place: Place<'a>,
    joint: Joint,
    /// The equations of a fold and their zero in doubles, where the parameter is stationary along the arc.
    fold: Option<(System<'a>, Vec<f64>)>,
    /// e₀ of the arc over that of the end.
    ratio: Interval,
}

impl<'a> Ending<'a> {
    fn new(posed: &'a Posed, place: Place<'a>, steps: &[usize], excess: f64) -> Option<Ending<'a>> {
        let Place { near, condition } = place;
        let (system, guess) = System::cut(posed, near, condition, Some(steps))?;
        let mut at = enclosed(posed, &system, &guess)?;
        at.truncate(system.waves());
        if system.minimum(&at).is_some() {
            at.remove(system.waves() - 3);
        }
        // 1 + u = e/e₀
        let ratio = Interval::point(near.excess) / Interval::point(excess);
        let index = at.len() - 2;
        at[index] = (Interval::ONE + at[index]) * ratio - Interval::ONE;
        let stationary = *condition == Condition::Fold || change::is_touch(posed, near, condition);
        let fold = stationary.then(|| System::cut(posed, near, &Condition::Fold, Some(steps)));
        Some(Ending {
            place,
            joint: Joint::new(at),
            fold: fold.flatten(),
            ratio,
        })
    }
}

struct Arc<'a> {
    system: System<'a>,
    units: Vec<f64>,
    ends: [Ending<'a>; 2],
}

/// A piece of the curve.
struct Piece {
    chord: Chord,
    radius: Vec<f64>,
    /// The end that it is next to.
    next_to: Option<usize>,
}

impl Piece {
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
    let posed = &from.posed;
    let begin = match &from.beyond {
        Some(beyond) => {
            change::prove(posed, &from.near, &from.condition, beyond)?;
            Place::new(&beyond.near, &beyond.condition)
        }
        None => Place::new(&from.near, &from.condition),
    };
    let end = Place::new(&to.near, &to.condition);
    if posed.fixed() != to.posed.fixed() || begin.near.signature != end.near.signature {
        return Err(Broken::Apart);
    }
    // where a zone opens or closes it is one step; where it is longer at the other end it is cut anew between
    let stops = [waypoint(posed, begin, end)?, waypoint(posed, end, begin)?];
    let stops: Vec<(Near, Condition)> = stops.into_iter().flatten().collect();
    let between = stops.iter().map(|(near, value)| Place::new(near, value));
    let places: Vec<Place> = [begin].into_iter().chain(between).chain([end]).collect();
    let legs = places.windows(2);
    let legs = legs.map(|ends| Arc::between(posed, [ends[0], ends[1]]));
    let legs: Vec<Arc> = legs.collect::<Result<_, _>>()?;
    for (both, (near, _)) in legs.windows(2).zip(&stops) {
        let cuts = [&both[0].system, &both[1].system];
        if !change::is_cut_anew(posed, near, cuts) {
            return Err(Broken::Tube(near.parameter));
        }
    }
    legs.iter().map(Arc::prove).sum()
}

/// Steps of every zone at a point; what is one or two steps at two points is one on the way.
fn steps(posed: &Posed, places: [Place; 2]) -> Option<Vec<usize>> {
    let [one, other] = places.map(|Place { near, .. }| {
        let (system, _) = System::new(posed, near, &near.value())?;
        let zones = 0..near.signature.len();
        Some(zones.map(|zone| system.steps(zone)).collect::<Vec<_>>())
    });
    let both = one?.into_iter().zip(other?).enumerate();
    let steps = both.map(|(zone, both)| match both {
        (1, 2) | (2, 1) => 1,
        _ if places.iter().any(|place| place.closed() == Some(zone)) => 1,
        (a, b) => a.max(b),
    });
    Some(steps.collect())
}

/// The point on an arc at which a zone that opens or closes at an end has grown to [`STEP`], and its condition, where
/// the zone is more than two steps at the other end.
fn waypoint(posed: &Posed, end: Place, other: Place) -> Result<Option<(Near, Condition)>, Broken> {
    const STEP: f64 = 1.5;
    /// Steps in which it is reached.
    const STRIDES: usize = 16;
    let lost = Broken::Tube(end.near.parameter);
    let Some(zone) = end.closed() else {
        return Ok(None);
    };
    let long = steps(posed, [other, other]).ok_or(Broken::End)?;
    if long[zone] <= 2 {
        return Ok(None);
    }
    let arc = Arc::between(posed, [end, end])?;
    let reached = || {
        let mut joint = arc.ends[0].joint.clone();
        let frame = arc.system.frame_at(&joint.at)?;
        let longest = STEP / arc.system.flow(&frame, zone)?.norm();
        for stride in 1..=STRIDES {
            let length = longest * stride as f64 / STRIDES as f64;
            let tangent = arc.tangent(&joint)?;
            joint = arc.joint(&joint, &tangent, arc.system.duration(zone), length)?;
        }
        Some(arc.system.refined(&joint.near))
    };
    let near: Near = reached().ok_or(lost)?;
    let value = near.value();
    Ok(Some((near, value)))
}

impl<'a> Arc<'a> {
    fn between(posed: &'a Posed, ends: [Place<'a>; 2]) -> Result<Arc<'a>, Broken> {
        let steps = steps(posed, ends).ok_or(Broken::End)?;
        let near = ends[0].near;
        let (system, guess) =
            System::cut(posed, near, &near.value(), Some(&steps)).ok_or(Broken::End)?;
        let [first, last] =
            ends.map(|place| Ending::new(posed, place, &steps, near.excess).ok_or(Broken::End));
        Ok(Arc {
            units: units(&system, &guess, near, posed.unit),
            ends: [first?, last?],
            system,
        })
    }

    fn prove(&self) -> Result<usize, Broken> {
        // a fold does not say which of its two sides leads to the other end
        match self.follow(1.0) {
            Err(_) if *self.ends[0].place.condition == Condition::Fold => self.follow(-1.0),
            followed => followed,
        }
    }
}

impl Arc<'_> {
    /// Follows the arc from its first end to its last; a `side` of −1 leaves the other way.
    fn follow(&self, side: f64) -> Result<usize, Broken> {
        let [excess, parameter] = self.system.tail();
        let [first, last] = self.ends.each_ref().map(|end| &end.joint);
        let whole = |coordinate: usize| last.near[coordinate] - first.near[coordinate];
        // which way the arc leaves: in the parameter, at a fold in the speed, or so that a zone opens
        let begin = self.ends[0].place;
        let (lead, way) = match begin.closed() {
            Some(zone) => (self.system.duration(zone), 1.0),
            None if *begin.condition == Condition::Fold => (excess, whole(excess) * side),
            None => (parameter, whole(parameter)),
        };
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
                None => tangent[lead] * way,
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
        let condition = &self.system.condition;
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
                let closed = self.ends[end].place.closed();
                let rest = closed.map_or(Part::All, Part::But);
                inequality::prove(&self.system, condition, rest, &moving)
                    .and_then(|_| closed.map_or(Ok(0), |zone| over(Part::Within(zone), &hull)))
            }
        };
        held.map(|_| ())
            .map_err(|reason| Broken::Inequality(value, reason))
    }

    /// Whether a piece next to an end where the parameter is stationary has no other such point.
    fn is_only_fold(&self, piece: &Piece) -> bool {
        let Some(end) = piece.next_to.map(|end| &self.ends[end]) else {
            return false;
        };
        let Some((system, guess)) = &end.fold else {
            return false;
        };
        let [excess, parameter] = self.system.tail();
        let ratio = Interval::ONE / end.ratio;
        let mut x = piece.hull();
        x[excess] = (Interval::ONE + x[excess]) * ratio - Interval::ONE;
        // the direction v at a fold, ∂p = 0, ⟨ℓ, v⟩ = 1
        let mut v = piece.tangent();
        v.truncate(parameter);
        v[excess] = v[excess] * ratio;
        let weights = system.normal().iter().zip(&v);
        let size = weights.fold(Interval::ZERO, |sum, (weight, v)| {
            sum + Interval::point(*weight) * *v
        });
        x.extend(v.iter().map(|v| *v / size));
        let equations = |x: &[Interval]| system.evaluate(x);
        krawczyk::is_only_zero(&equations, guess, &x)
    }
}
