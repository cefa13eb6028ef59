//! Connections of saddles: the motion that leaves one along a growing direction and comes to the next, or back to the same,
//! along the decaying ones.
//!
//! A saddle with k growing directions is left in the direction d = Pe(a), where P projects on the growing directions along the
//! others and a ∈ ℝᵏ⁻¹ chooses among them; it is come to where nothing of the k growing directions of the other saddle is in
//! what arrives there. These are k equations,
//!
//! ```text
//! Q e^(−JPt)(x(t) − x₂) = 0,    x(0) = x₁ + εd,
//! ```
//!
//! in a and one parameter; J is ∂f/∂x at x₂, Q are coordinates along its growing directions, t the time since the motion came near. The
//! left side hardly depends on t while x is near the saddle: it is the mean over samples, each weighted by the square of the
//! inverse of what it leaves out, which is smooth in the parameters. Of the parameter of the connection the motion has all
//! digits at its nearest sample, however long a stay there would last: no stay is followed.
//!
//! | left out | of | why |
//! |---|---|---|
//! | ε² | the way out of a mode that is not affine | the growing directions bend; it decays on the way |
//! | e^(−μt)·d² | an arrival at the distance d in such a mode, μ the least growth | the decaying directions bend |
//! | `NOISE` | any arrival | rounding of the flow, or its tolerance, which grows as what is looked at |

use serde::{Deserialize, Serialize};

use super::exponential::plain_propagator;
use super::mode::AffineSystem;
use super::motion::{Moment, Motion, Step};
use crate::linalg::{Factors, Matrix, Vector};

/// How near its saddle a motion begins, in units of the states: ε² is less than rounding. Where directions grow at different
/// rates the fast ones would be lost beside the slow ones so near, and it begins where it is known, but no farther than this.
const BEGINS: f64 = 1e-8;
const BEGINS_AT_MOST: f64 = 1e-3;

/// Growths that differ by less are those of a pair, but for rounding.
const EQUAL: f64 = 1.0 - 1e-6;

/// The way from saddle to saddle may last so many units of time, beside the times in which it leaves and arrives.
const LONGEST: f64 = 10.0;

/// Samples of an arrival in the time in which growth and decay together are a factor e.
const SAMPLES: f64 = 8.0;

/// What comes no nearer does not arrive, and without a switch it has left where it has been as far, in units of the states.
const NEAR: f64 = 0.3;

/// It comes back where it is nearer than this part of what it has been, and has been away from where it began.
const BACK: f64 = 0.5;

/// An arrival is over where the motion is so many times as far as it has been, or as far as it counts for near after it has
/// been half as far: what is left out of samples weighs by its square.
const OVER: f64 = 100.0;

/// Roundings of a flow, in units of the states, or times its tolerance where that is more.
const NOISE: f64 = 16.0;

/// Steps of Newton's method at most, and of its differences, in units of the unknowns: derivatives are off by as much as
/// decides how near the saddle the motion comes then, and by 1e-7 for rounding. What is below `FOUND` and falls no more is
/// rounding, of which some steps are told.
const STEPS: usize = 40;
const APART: f64 = 1e-8;
const FOUND: f64 = 1e-6;

/// Digits of a sign function: the error of its iteration is the square of that.
const SIGN: f64 = 1e-10;
const SIGN_STEPS: usize = 100;

/// A state at which a mode rests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Rest")]
pub struct SaddleRest {
    /// The mode.
    pub mode: usize,
    /// The state.
    pub state: Vec<f64>,
}

/// A switch on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Passed {
    /// The guard that is zero, by its number in the mode that ends.
    pub guard: usize,
    /// The exit taken.
    pub exit: usize,
    /// The mode that begins.
    pub to: usize,
}

/// What motions are measured by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConnectionScales {
    /// Units of the states.
    pub states: Vec<f64>,
    /// The unit of time, of the order of the way round.
    pub time: f64,
    /// The tolerance of flows that are integrated.
    pub tolerance: f64,
}

/// A motion from a saddle to a saddle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Connection {
    /// The saddles: that which is left, and that which is come to.
    ends: [SaddleRest; 2],
    /// Directions from which those that grow at either are projected, in units of the states: the first one leaves.
    growing: [Vec<Vec<f64>>; 2],
    /// How far from the first saddle the motion begins, in units of the states.
    begins: f64,
    /// The switches on the way.
    way: Vec<Passed>,
    scales: ConnectionScales,
    /// The product of the slowest growth and the slowest decay at the saddle that it began with.
    #[serde(default)]
    begun: f64,
}

/// What comes to the second saddle.
#[derive(Clone, Debug, PartialEq)]
pub struct SaddleArrival {
    /// Coordinates along its growing directions, as of where it comes near.
    pub misses: Vector,
    /// What is left out of each.
    pub left_out: f64,
}

/// A saddle, in units of the states.
struct Saddle {
    state: Vec<f64>,
    slopes: Matrix,
    /// On the growing directions along the others.
    projection: Matrix,
    growing: usize,
    /// The largest growth and the least, and the slowest decay; the growth where nothing decays.
    growth: f64,
    slowest: f64,
    decay: f64,
}

impl Saddle {
    /// The one near a state; `None` where nothing grows, or nothing decays in a mode that does not slide.
    fn new(system: &AffineSystem, rest: &SaddleRest, units: &[f64]) -> Option<Saddle> {
        let equilibrium = system.equilibrium_near(rest.mode, &rest.state)?;
        let values = &equilibrium.eigenvalues;
        let growing = values.iter().take_while(|value| value.re > 0.0).count();
        let slowest = values.get(growing.checked_sub(1)?)?.re;
        // into a mode that slides or holds a motion comes from without, and nothing needs to decay
        let slides = system.modes[rest.mode].surfaces().next().is_some();
        let decay = values.iter().find(|value| value.re < 0.0);
        let decay = decay.or(values.first().filter(|_| slides))?.re.abs();
        let n = units.len();
        let slopes = Matrix::from_fn(n, n, |row, column| {
            equilibrium.slopes[(row, column)] * units[column] / units[row]
        });
        // a direction that a surface takes away has the eigenvalue zero, and does not grow
        let shifted = &slopes - Matrix::identity(n, n) * (0.5 * slowest);
        Some(Saddle {
            projection: (sign(shifted)? + Matrix::identity(n, n)) * 0.5,
            growth: values[0].re,
            slowest,
            state: equilibrium.state,
            slopes,
            growing,
            decay,
        })
    }

    /// A state from it, in units of the states.
    fn off(&self, state: &[f64], units: &[f64]) -> Vector {
        let of = |index: usize, _| (state[index] - self.state[index]) / units[index];
        Vector::from_fn(units.len(), of)
    }
}

/// The sign function of a matrix without imaginary eigenvalues: 1 on what grows and −1 on what decays, by Newton's
/// iteration, scaled (Higham, Functions of Matrices, SIAM 2008, chapter 5).
fn sign(matrix: Matrix) -> Option<Matrix> {
    let mut sign = matrix;
    for _ in 0..SIGN_STEPS {
        let inverse = Factors::new(&sign).inverse()?;
        let scale = (inverse.norm() / sign.norm()).sqrt();
        let next = (&sign * scale + inverse / scale) * 0.5;
        let change = (&next - &sign).norm();
        sign = next;
        if change <= SIGN * sign.norm() {
            return Some(sign);
        }
    }
    None
}

/// An orthonormal basis of the image of a projection, the first vector along a given one.
fn basis(first: &Vector, projection: &Matrix, count: usize) -> Vec<Vector> {
    let mut found = vec![first.normalize()];
    while found.len() < count {
        let across = |column: usize| {
            let mut rest = projection.column(column).clone_owned();
            for known in &found {
                rest -= known * known.dot(&rest);
            }
            rest
        };
        let all = (0..projection.ncols()).map(across);
        let Some(next) = all.max_by(|one, other| one.norm().total_cmp(&other.norm())) else {
            break;
        };
        found.push(next.normalize());
    }
    found
}

impl Connection {
    /// The connection beside a motion that has left a saddle, with a state of its way out, and comes to another by these
    /// switches; `None` where they are no saddles of as many growing directions. It begins at a part of the distance from the
    /// saddle that suits: what it leaves out there falls by the square of that.
    pub fn new(
        system: &AffineSystem,
        ends: [SaddleRest; 2],
        (out, part): (&[f64], f64),
        way: Vec<Passed>,
        scales: ConnectionScales,
    ) -> Option<Connection> {
        let saddle = |rest: &SaddleRest| Saddle::new(system, rest, &scales.states);
        let (from, to) = (saddle(&ends[0])?, saddle(&ends[1])?);
        let off = &from.projection * from.off(out, &scales.states);
        if from.growing != to.growing || off.amax() <= 0.0 {
            return None;
        }
        // back along the flow to where the motion begins: a pair of growing directions turns
        let mode = &system.modes[ends[0].mode];
        let near = match mode.field.is_exact || from.slowest < EQUAL * from.growth {
            true => off.amax().min(BEGINS_AT_MOST),
            false => BEGINS,
        };
        let time = (off.amax() / (part * near)).ln().max(0.0) / from.growth;
        let back = &from.slopes * &from.projection * -1.0;
        let flow = plain_propagator(&back, off.len(), back.norm(), time);
        let first = &from.projection * (flow * off);
        let begins = first.norm();
        let column = (0..to.projection.ncols())
            .map(|column| to.projection.column(column).clone_owned())
            .max_by(|one, other| one.norm().total_cmp(&other.norm()))?;
        let growing = [
            basis(&first, &from.projection, from.growing),
            basis(&column, &to.projection, to.growing),
        ];
        let listed = |all: Vec<Vector>| all.iter().map(|one| one.as_slice().to_vec()).collect();
        Some(Connection {
            begun: from.slowest * from.decay,
            begins,
            ends,
            growing: growing.map(listed),
            way,
            scales,
        })
    }

    /// Number of unknowns a.
    pub fn turns(&self) -> usize {
        self.growing[0].len() - 1
    }

    /// Size of a homoclinic orbit of a saddle with this product of the slowest growth and the slowest decay, as a part of the first:
    /// beside a Bogdanov-Takens point its extent is as that. `None` of a connection of others.
    pub fn size(&self, product: f64) -> Option<f64> {
        let [from, to] = &self.ends;
        (from == to && self.begun > 0.0).then(|| product / self.begun)
    }

    /// The saddles.
    pub fn ends(&self) -> &[SaddleRest; 2] {
        &self.ends
    }

    /// The same whose saddle, or saddles, have moved to where they are in this system, in units of the motion there; the first one is near
    /// a state, and left as `turns` say.
    pub fn renewed(
        &self,
        system: &AffineSystem,
        state: &[f64],
        turns: &[f64],
    ) -> Option<Connection> {
        let mut next = self.clone();
        let larger;
        (next.scales, larger) = self.measured(system, state, turns)?;
        // how a motion leaves in several directions tells where it begins: at the same distance as before
        if self.turns() > 0 {
            next.begins /= larger;
        }
        next.ends = self.ends_near(state);
        for (rest, growing) in next.ends.iter_mut().zip(&mut next.growing) {
            let saddle = Saddle::new(system, rest, &self.scales.states)?;
            // all of them by the same factor: a remains what it is
            let projected = |one: &Vec<f64>| &saddle.projection * Vector::from_column_slice(one);
            let all: Vec<Vector> = growing.iter().map(projected).collect();
            let length = all.first()?.norm();
            *growing = all
                .iter()
                .map(|one| (one / length).as_slice().to_vec())
                .collect();
            rest.state = saddle.state;
        }
        Some(next)
    }

    /// What measures the motion as this one is, and how many times as large that is: along a curve it becomes smaller and slower, as beside
    /// a Bogdanov-Takens point. Units of the states remain in proportion.
    fn measured(
        &self,
        system: &AffineSystem,
        state: &[f64],
        turns: &[f64],
    ) -> Option<(ConnectionScales, f64)> {
        let units = &self.scales.states;
        let [from, to] = &self.ends_near(state);
        let [from, to] = [
            Saddle::new(system, from, units)?,
            Saddle::new(system, to, units)?,
        ];
        let far = |saddle: &Saddle, state: &[f64]| saddle.off(state, units).amax();
        let mut motion = self.way_out(system, &from, turns);
        let part = (SAMPLES * (from.growth + from.decay)).recip();
        let last = self.longest(&from) * (1 + self.way.len()) as f64;
        let (mut largest, mut left, mut away) = (0.0_f64, false, 0.0);
        let mut sample = 0.0;
        while part * sample < last {
            match motion.step(part * sample).ok()? {
                Step::Reached => {
                    let state = &motion.place().state;
                    let size = far(&from, state);
                    largest = largest.max(size);
                    left |= size >= NEAR;
                    if left && far(&to, state) < 0.5 * NEAR {
                        break;
                    }
                    away += if left { part } else { 0.0 };
                    sample += 1.0;
                }
                Step::Switched(_) | Step::Section => {}
            }
        }
        let mut scales = self.scales.clone();
        if !left || !largest.is_finite() {
            return Some((scales, 1.0));
        }
        scales.states.iter_mut().for_each(|unit| *unit *= largest);
        scales.time = away.max(part);
        Some((scales, largest))
    }

    /// The saddles where the first one, which may be the second as well, is near a state.
    fn ends_near(&self, state: &[f64]) -> [SaddleRest; 2] {
        let [from, to] = &self.ends;
        let moved = SaddleRest {
            state: state.to_vec(),
            ..*from
        };
        let to = if to == from { &moved } else { to }.clone();
        [moved, to]
    }

    /// What comes to the second saddle where the motion leaves the first, near a state, as `turns` say; `None` where it
    /// does not come there by these switches.
    pub fn arrival(
        &self,
        system: &AffineSystem,
        state: &[f64],
        turns: &[f64],
    ) -> Option<SaddleArrival> {
        let units = &self.scales.states;
        let [from, to] = &self.ends_near(state);
        let [from, to] = [
            Saddle::new(system, from, units)?,
            Saddle::new(system, to, units)?,
        ];
        if [&from, &to].map(|saddle| saddle.growing) != [turns.len() + 1; 2] {
            return None;
        }
        let mut motion = self.way_out(system, &from, turns);
        for passed in &self.way {
            let until = motion.place().time + self.longest(&from);
            let Step::Switched(switching) = motion.step(until).ok()? else {
                return None;
            };
            let taken = (switching.guard, switching.exit, switching.to);
            if taken != (passed.guard, passed.exit, passed.to) {
                return None;
            }
        }
        let is_exact = system.modes[self.ends[1].mode].field.is_exact;
        let longest = self.longest(&from);
        self.arrives(&mut motion, &to, is_exact, longest)
    }

    /// A time in which the next switch comes, or the arrival.
    fn longest(&self, from: &Saddle) -> f64 {
        LONGEST * self.scales.time - self.begins.ln() / from.growth
    }

    /// The motion that leaves a saddle.
    fn way_out<'a>(&self, system: &'a AffineSystem, saddle: &Saddle, turns: &[f64]) -> Motion<'a> {
        let mut direction = Vector::zeros(self.scales.states.len());
        let parts = std::iter::once(&1.0).chain(turns);
        for (part, growing) in parts.zip(&self.growing[0]) {
            direction += Vector::from_column_slice(growing) * *part;
        }
        let direction = &saddle.projection * direction;
        let states = saddle.state.iter().zip(&self.scales.states).zip(&direction);
        let place = Moment {
            time: 0.0,
            phase: 0.0,
            mode: self.ends[0].mode,
            state: states
                .map(|((rest, unit), along)| rest + self.begins * unit * along)
                .collect(),
        };
        Motion::new(system, place, self.scales.time)
    }

    /// What takes a state beside the second saddle to its coordinates along the growing directions there.
    fn along_growing(&self, saddle: &Saddle) -> Option<Matrix> {
        let all = &self.growing[1];
        let columns = Matrix::from_fn(self.scales.states.len(), all.len(), |row, column| {
            all[column][row]
        });
        let growing = &saddle.projection * columns;
        let square = growing.transpose() * &growing;
        Some(Factors::new(&square).inverse()? * growing.transpose())
    }

    /// What of a motion is along the growing directions of a saddle while it is near.
    fn arrives(
        &self,
        motion: &mut Motion,
        saddle: &Saddle,
        is_exact: bool,
        longest: f64,
    ) -> Option<SaddleArrival> {
        let units = &self.scales.states;
        let coordinates = self.along_growing(saddle)?;
        let back = &saddle.slopes * &saddle.projection * -1.0;
        let (bends, tolerance) = match is_exact {
            true => (0.0, 0.0),
            false => (1.0, self.scales.tolerance),
        };
        let noise = NOISE * tolerance.max(f64::EPSILON);
        let part = (SAMPLES * (saddle.growth + saddle.decay)).recip();
        let begins = motion.place().time;
        let last = longest - NOISE * f64::EPSILON.ln() / saddle.decay;
        let mut has_left = !self.way.is_empty();
        let (mut least, mut near, mut samples) = (f64::INFINITY, None, Vec::new());
        let mut largest = self.begins;
        for sample in 0.. {
            let time = part * f64::from(sample);
            if time > last || !matches!(motion.step(begins + time), Ok(Step::Reached)) {
                break;
            }
            let off = saddle.off(&motion.place().state, units);
            let grown = &saddle.projection * &off;
            let size = grown.amax().max((off - &grown).amax());
            // one that has become smaller than it was has left where it comes back
            largest = size.max(largest);
            has_left |= size >= NEAR || size <= BACK * largest;
            if !has_left || samples.is_empty() && size > NEAR && !is_exact {
                continue;
            }
            least = size.min(least);
            if size > OVER * least || least < 0.5 * NEAR && size > NEAR {
                break;
            }
            let since = time - *near.get_or_insert(time);
            let before = plain_propagator(&back, units.len(), back.norm(), since) * grown;
            samples.push(SaddleArrival {
                misses: &coordinates * before,
                left_out: bends * size * size * (-saddle.slowest * since).exp() + noise,
            });
            // all of a flow that is linear says the same
            if is_exact {
                break;
            }
        }
        if samples.is_empty() {
            return None;
        }
        let left_out = samples.iter().map(|sample| sample.left_out);
        let left_out = left_out.fold(f64::INFINITY, f64::min);
        let mut misses = Vector::zeros(saddle.growing);
        let mut weights = 0.0;
        for sample in &samples {
            let weight = (left_out / sample.left_out).powi(2);
            misses += &sample.misses * weight;
            weights += weight;
        }
        Some(SaddleArrival {
            misses: misses / weights,
            left_out,
        })
    }
}

/// A connection with the parameter at which it exists.
#[derive(Clone, Debug, PartialEq)]
pub struct Connected {
    /// The parameter, in its unit.
    pub value: f64,
    /// Its error.
    pub error: f64,
    /// How the first saddle is left.
    pub turns: Vec<f64>,
}

/// The zero of what arrives, next to a value of the parameter in its unit, by Newton's method.
pub fn connected(
    value: f64,
    turns: usize,
    arrival: impl Fn(f64, &[f64]) -> Option<SaddleArrival>,
) -> Option<Connected> {
    let at = |unknowns: &Vector| arrival(unknowns[0], &unknowns.as_slice()[1..]);
    let count = turns + 1;
    let mut unknowns = Vector::zeros(count);
    unknowns[0] = value;
    let rounding = 2.0 * f64::EPSILON * value.abs();
    let mut before = f64::INFINITY;
    for _ in 0..STEPS {
        let here = at(&unknowns)?;
        let mut slopes = Matrix::zeros(count, count);
        for column in 0..count {
            let mut beside = unknowns.clone();
            beside[column] += APART;
            let slope = (at(&beside)?.misses - &here.misses) / APART;
            slopes.set_column(column, &slope);
        }
        let inverse = Factors::new(&slopes).inverse()?;
        let step = &inverse * &here.misses;
        let size = step.amax();
        if size <= rounding || size <= FOUND && size >= 0.5 * before {
            let left_out = inverse.row(0).abs().sum() * here.left_out;
            return Some(Connected {
                value: unknowns[0],
                error: left_out + 4.0 * step[0].abs() + rounding,
                turns: unknowns.as_slice()[1..].to_vec(),
            });
        }
        before = size;
        unknowns -= step;
    }
    None
}
