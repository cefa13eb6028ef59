//! How many eigenvalues grow: zeros of the characteristic function counted by an argument that is enclosed.
//!
//! With M the matrix by which a perturbation e^{−λs}(η, η′) is multiplied over a period, from a stick zone (1 × 1) or
//! a contact zone (2 × 2), λ is an eigenvalue of Bloch sector j exactly if
//!
//! ```text
//! F_j(λ) = det(1 − M(λ)/z_j) = 0,   z_j = e^{2πij/k}.
//! ```
//!
//! On a piece of a contour λ is a straight line in t, |t| ≤ 1, and M, by the propagators of the zones, a Taylor model in
//! t. The piece is cut until F lies in an open half-plane without 0 on every part. The path of F is then as
//! often round 0 as a polygon whose edges lie in the half-planes; its turns are counted by crossings of the
//! negative real axis, an integer. F_j(λ̄) is the conjugate of F_{k−j}(λ): upper halves of contours suffice.
//!
//! Right of Re λ = ρ there are no zeros ([`super::tail`]). The imaginary axis is the left edge, but for detours round
//! zeros that are known to lie on it: λ = 0 in sector 0, whose eigenfunction is V̇, those that cross there, and of
//! some waves i√h. In a box round each the zeros are counted as well: where these are all of them, no other lies on the
//! axis.

use serde::{Deserialize, Serialize};

use super::frame::IntervalFrame;
use super::perturbation::ProvenEigenvalue;
use super::propagator::{
    Complex, ETA, ETA_RATE, Perturbation, PerturbationEquations, combined, dimension, nothing, unit,
};
use super::system::{WaveCondition, WaveSystem};
use crate::interval::{Interval, Number, PI, TaylorModel};
use crate::tube::model::signature::{Regime, ZoneEntry};

type C64 = nalgebra::Complex<f64>;
type Model = Complex<TaylorModel>;

/// Growing eigenvalues of a wave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrowthCount {
    /// Largest |Im λ| that counts.
    pub window: f64,
    /// Mode k.
    pub mode: u32,
    /// Eigenvalues with Re λ > 0 there, of sectors 0 to k/2; those of sector k − j are conjugate to those of j.
    /// None is on the axis but λ = 0 in sector 0, what crosses there, and i√h without damping, stick and reversals.
    pub counts: Vec<usize>,
    /// Enclosed eigenvalues that lead their sector.
    pub leading: Vec<Leading>,
    /// What follows for the wave.
    pub verdict: ProvenVerdict,
}

/// An enclosed eigenvalue that leads its sector in the window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Leading {
    /// Bloch sector.
    pub sector: usize,
    /// Right of this Re λ there is no other but its conjugate, and λ = 0 in sector 0.
    pub line: f64,
}

/// Stability, as far as it is proven.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ProvenVerdict {
    /// On the full circle: no eigenvalue but λ = 0 of translation has Re λ ≥ 0.
    Stable {
        /// None has |λ| of at least this; below they are counted.
        beyond: f64,
    },
    /// An eigenvalue grows.
    Unstable,
    /// None grows in the window, and one is on the axis.
    Neutral,
    /// None grows in the window; beyond it is not known.
    HighFrequency,
}

impl GrowthCount {
    /// Number on the full circle.
    pub fn on_circle(&self) -> usize {
        let counts = self.counts.iter().enumerate();
        let mode = self.mode as usize;
        counts
            .map(|(sector, count)| match sector == 0 || 2 * sector == mode {
                true => *count,
                false => 2 * count,
            })
            .sum()
    }
}

/// Why the growing eigenvalues of a wave are not counted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Uncounted {
    /// The wave itself.
    #[error("undecided: the wave is not proven")]
    Wave,
    /// The perturbation of a Coulomb impact.
    #[error("not covered: eigenvalues of waves with a Coulomb impact")]
    CoulombImpact,
    /// β > 0.
    #[error("not covered: eigenvalues of waves with material damping")]
    MaterialDamping,
    /// What crosses is not counted in the window.
    #[error("undecided: what crosses the imaginary axis lies beyond the window")]
    Beyond,
    /// Too long a zone.
    #[error("undecided: the characteristic function cannot be enclosed")]
    NotEnclosed,
    /// No right edge of the contour.
    #[error("undecided: no bound of Re λ is known")]
    NoEdge,
    /// A zero on the contour, or next to it.
    #[error("undecided: an eigenvalue of sector {0} is on the imaginary axis, or too near to it")]
    OnAxis(usize),
}

/// A part of the path of F on a contour: a half-plane in which it lies, by its normal, and about its ends.
#[derive(Clone, Copy, Debug)]
struct ContourSide {
    normal: C64,
    from: C64,
    to: C64,
}

/// Least component of F along the normal, in units of |F|: room for the ends of the next part.
const ROOM: f64 = 0.1;
/// Bisections of the range of one Taylor model.
const BISECTIONS: usize = 5;
/// Radians by which the longest delay turns over half a piece.
const HALF_TURN: f64 = 2.0;
/// A piece shorter than this share of its side is given up.
const SHORTEST: f64 = 1e-10;
/// Most pieces of one contour.
const MOST_PIECES: usize = 20_000;
/// More than the rounding of a product of two complex numbers, relative to the product of their moduli.
const ROUNDED: f64 = 1e-14;

fn along(normal: C64, x: C64) -> f64 {
    normal.re * x.re + normal.im * x.im
}

/// Whether the line between two numbers crosses the negative real axis, counted counterclockwise; `None` where
/// rounding leaves it open.
fn crossing(from: C64, to: C64) -> Option<i32> {
    if (from.im < 0.0) == (to.im < 0.0) {
        return Some(0);
    }
    let [one, two] = [from.re * to.im, from.im * to.re];
    if (one - two).abs() <= ROUNDED * (one.abs() + two.abs()) {
        return None;
    }
    Some(match (from.im < 0.0, one > two) {
        (false, true) => 1,
        (true, false) => -1,
        _ => 0,
    })
}

/// Turns of a closed path round 0.
fn turns(path: &[ContourSide]) -> Option<i32> {
    if path.is_empty() {
        return None;
    }
    let next = path.iter().cycle().skip(1);
    let mut turns = 0;
    for (side, next) in path.iter().zip(next) {
        // both ends of the edge lie in the half-plane of the path
        let inside = |x: C64| along(side.normal, x) > ROUNDED * side.normal.l1_norm() * x.l1_norm();
        if !(inside(side.from) && inside(next.from)) {
            return None;
        }
        turns += crossing(side.from, next.from)?;
    }
    Some(turns)
}

/// A path, and back over the conjugates of λ, where F is the conjugate of `partner`.
fn mirrored(path: &[ContourSide], partner: &[ContourSide]) -> Vec<ContourSide> {
    let back = partner.iter().rev().map(|side| ContourSide {
        normal: side.normal.conj(),
        from: side.to.conj(),
        to: side.from.conj(),
    });
    path.iter().copied().chain(back).collect()
}

/// Covers the path of F for t in a range; false where it comes too near 0.
fn cover(f: &Model, [from, to]: [f64; 2], bisections: usize, path: &mut Vec<ContourSide>) -> bool {
    let at = |t: f64| {
        let [[re, re_by], [im, im_by]] = [f.re.at(t), f.im.at(t)];
        (C64::new(re, im), C64::new(re_by, im_by))
    };
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (normal, slope) = at(middle);
    let size = normal.norm();
    let blur = 2.0 * (f.re.blur() + f.im.blur()) + ROUNDED * (size + slope.l1_norm());
    let bent = 0.5 * half * half * (f.re.bend() + f.im.bend()) + blur;
    let least = size - along(normal, slope).abs() / size * half - bent;
    if least > ROOM * size {
        let [(from, _), (to, _)] = [at(from), at(to)];
        path.push(ContourSide { normal, from, to });
        return true;
    }
    bisections > 0
        && 2.0 * blur < size
        && cover(f, [from, middle], bisections - 1, path)
        && cover(f, [middle, to], bisections - 1, path)
}

/// The characteristic function of a wave that is known to intervals.
struct IntervalCharacteristic<'a> {
    system: &'a WaveSystem<'a>,
    wave: &'a [Interval],
    frame: IntervalFrame<TaylorModel>,
    /// Zones in their order, and the state at the end of each.
    course: Vec<(usize, [TaylorModel; 4])>,
    /// 1/z_j.
    multipliers: Vec<Model>,
    period: f64,
    delay: f64,
}

impl<'a> IntervalCharacteristic<'a> {
    fn new(system: &'a WaveSystem, wave: &'a [Interval]) -> Option<IntervalCharacteristic<'a>> {
        let [excess, parameter] = system.tail();
        let known = |column: usize| TaylorModel::constant(wave[column]);
        let exact = system.frame_at(wave)?;
        let course = system.course_of_zones()?.into_iter().map(|zone| {
            let end = system.end_of_zone(&exact, wave, zone);
            (zone, end.map(TaylorModel::constant))
        });
        /// Waves of a higher mode are not examined.
        const MOST_SECTORS: u32 = 1000;
        let mode = system.mode();
        if !(1..=MOST_SECTORS).contains(&mode) {
            return None;
        }
        let multipliers = (0..mode).map(|sector| {
            let turn = PI * Interval::point(2.0 * f64::from(sector)) / Interval::point(mode.into());
            Complex {
                re: TaylorModel::constant(turn.cos()),
                im: TaylorModel::constant(-turn.sin()),
            }
        });
        let (mut period, mut delay) = (0.0, 0.0);
        let slowest = (2.0 - exact.ma.middle()) / exact.ma.middle();
        for zone in 0..system.near.zones.len() {
            let time = wave[system.duration(zone)].middle();
            period += time;
            delay += match system.near.signature.zone(zone).regime {
                Regime::Stick => time,
                _ => time * slowest.max(1.0),
            };
        }
        Some(IntervalCharacteristic {
            system,
            wave,
            frame: system.frame(known(excess), known(parameter))?,
            course: course.collect(),
            multipliers: multipliers.collect(),
            period,
            delay,
        })
    }

    /// tr M and det M.
    fn invariants(&self, lambda: Model) -> Option<[Model; 2]> {
        let frame = &self.frame;
        let regime = |zone: usize| self.system.near.signature.zone(zone).regime;
        // λη is of the size of η′
        let rate = |mass: TaylorModel, stiffness: TaylorModel| {
            let [mass, stiffness] = [mass, stiffness].map(|x| x.value().middle().abs());
            let high = lambda.norm() * (1.0 - mass).abs().sqrt();
            [stiffness.sqrt().max(high), mass.sqrt()].map(|x| x.max(f64::MIN_POSITIVE))
        };
        let [[eta, eta_rate], [radial, radial_rate]] =
            [rate(frame.ma, frame.h), rate(frame.mb, frame.g)];
        let weights = [eta, eta_rate, radial, radial_rate];
        let columns = dimension(regime(self.course[0].0));
        let mut columns: Vec<Perturbation<TaylorModel>> = (0..columns).map(unit).collect();
        for (zone, end) in &self.course {
            let linear = match regime(*zone) {
                Regime::Stick => PerturbationEquations::still(lambda),
                regime => PerturbationEquations::new(frame, regime, lambda, weights)?,
            };
            let (moved, _) = linear.propagator(self.wave[self.system.duration(*zone)])?;
            for x in &mut columns {
                *x = combined(&moved, x);
                self.system.jump(frame, lambda, x, end, *zone);
            }
        }
        Some(match &columns[..] {
            [x] => [x[ETA], nothing()[0]],
            [x, y] => [
                x[ETA].plus(y[ETA_RATE]),
                x[ETA]
                    .times(y[ETA_RATE])
                    .plus(x[ETA_RATE].times(y[ETA]).minus()),
            ],
            _ => return None,
        })
    }

    /// Follows F_j of the sectors needed along straight lines between corners; `None` where a zero is too near.
    fn walk(
        &self,
        corners: &[C64],
        needed: impl Fn(usize) -> bool,
    ) -> Vec<Option<Vec<ContourSide>>> {
        let halves = 0..self.multipliers.len();
        let mut paths: Vec<_> = halves.map(|half| needed(half).then(Vec::new)).collect();
        if corners.iter().any(|corner| !corner.is_finite()) {
            return vec![None; paths.len()];
        }
        let mut pieces = 0;
        for pair in corners.windows(2) {
            let (start, way) = (pair[0], pair[1] - pair[0]);
            let first = (way.norm() * self.delay / (2.0 * HALF_TURN))
                .ceil()
                .clamp(1.0, 1e4);
            let shares = (0..first as usize).rev();
            let mut waiting: Vec<[f64; 2]> = shares
                .map(|index| [index as f64 / first, (index + 1) as f64 / first])
                .collect();
            while let Some([from, to]) = waiting.pop() {
                pieces += 1;
                if pieces > MOST_PIECES {
                    return vec![None; paths.len()];
                }
                let line = |start: f64, way: f64| {
                    if way == 0.0 {
                        return TaylorModel::line(start, 0.0);
                    }
                    // with room for the rounding of its ends
                    let room = 8.0 * f64::EPSILON * (start.abs() + way.abs());
                    let half = 0.5 * (to - from) * way;
                    TaylorModel::line(start + 0.5 * (from + to) * way, half + room.copysign(way))
                };
                let lambda = Complex {
                    re: line(start.re, way.re),
                    im: line(start.im, way.im),
                };
                let halve = [[0.5 * (from + to), to], [from, 0.5 * (from + to)]];
                let invariants = self.invariants(lambda);
                let parts: Vec<Option<Vec<ContourSide>>> = paths
                    .iter()
                    .zip(&self.multipliers)
                    .map(|(path, multiplier)| {
                        path.as_ref()?;
                        let [trace, determinant] = invariants?;
                        let turned = determinant.times(*multiplier).plus(trace.minus());
                        let one = Complex::real(TaylorModel::double(1.0));
                        let f = turned.times(*multiplier).plus(one);
                        let mut part = Vec::new();
                        cover(&f, [-1.0, 1.0], BISECTIONS, &mut part).then_some(part)
                    })
                    .collect();
                let lost =
                    |(path, part): (&Option<Vec<ContourSide>>, &Option<Vec<ContourSide>>)| {
                        path.is_some() && part.is_none()
                    };
                if paths.iter().zip(&parts).any(lost) && to - from > SHORTEST {
                    waiting.extend(halve);
                    continue;
                }
                for (path, part) in paths.iter_mut().zip(parts) {
                    match (path.as_mut(), part) {
                        (Some(path), Some(part)) => path.extend(part),
                        _ => *path = None,
                    }
                }
            }
        }
        paths
    }

    fn conjugate(&self, sector: usize) -> usize {
        (self.multipliers.len() - sector) % self.multipliers.len()
    }

    /// Zeros of F_j in a region symmetric about the real axis, from the upper half of its edge.
    fn zeros(&self, corners: &[C64], sectors: &[usize]) -> Vec<Option<usize>> {
        let needed =
            |half: usize| sectors.contains(&half) || sectors.contains(&self.conjugate(half));
        let paths = self.walk(corners, needed);
        let count = |sector: &usize| {
            let partner = paths[self.conjugate(*sector)].as_ref()?;
            let path = mirrored(paths[*sector].as_ref()?, partner);
            usize::try_from(turns(&path)?).ok()
        };
        sectors.iter().map(count).collect()
    }

    /// Re λ of a line right of which there is no zero with |Im λ| ≤ `top`.
    fn right_edge(&self, top: f64) -> Option<f64> {
        const TRIES: i32 = 30;
        (0..TRIES)
            .map(|index| 0.5 / self.period * 1.5_f64.powi(index))
            .find(|rho| self.system.is_free(self.wave, *rho, *rho, top) == Some(true))
    }

    /// |λ| from which on there is no zero with Re λ ≥ 0.
    fn top_edge(&self, window: f64) -> Option<f64> {
        const TRIES: i32 = 24;
        (0..TRIES)
            .map(|index| window * 1.25_f64.powi(index))
            .find(|top| self.is_free_beyond(*top))
    }

    fn is_free_beyond(&self, top: f64) -> bool {
        top > 0.0 && self.system.is_free(self.wave, top, 0.0, f64::INFINITY) == Some(true)
    }

    /// Zeros iω, ω > 0, that are known to be on the axis, by sector: what crosses there, and without damping, stick and
    /// reversals i√h, by which V swings as a whole: η = e^{λs} solves the equations with u = 0 where λ² + αλ + h = 0,
    /// and no switch changes it.
    fn on_axis(&self) -> Vec<(usize, f64)> {
        let mut known = Vec::new();
        if let WaveCondition::Crossing { sector, omega } = self.system.condition {
            // in the upper half: of the sector, or of its conjugate
            known.push(match omega < 0.0 {
                true => (self.conjugate(sector), -omega),
                false => (sector, omega),
            });
        }
        let swings = |(zone, _): &(usize, [TaylorModel; 4])| {
            let zone = self.system.near.signature.zone(*zone);
            zone.regime != Regime::Stick && zone.entry != ZoneEntry::Reversal
        };
        if self.frame.damping.is_zero() && self.course.iter().all(swings) {
            known.push((0, self.frame.h.value().middle().sqrt()));
        }
        known.sort_by(|one, other| other.1.total_cmp(&one.1));
        known
    }

    /// Zeros with Re λ > 0 and |Im λ| ≤ `top` in sectors 0 to k/2.
    fn growing(&self, top: f64) -> Result<Vec<usize>, Uncounted> {
        /// Half the width of a detour, in units of 1/T, and tries at smaller ones.
        const DETOUR: f64 = 0.05;
        const TRIES: i32 = 4;
        let right = self.right_edge(top).ok_or(Uncounted::NoEdge)?;
        let sectors: Vec<usize> = (0..=self.multipliers.len() / 2).collect();
        let mut failed = 0;
        for index in 0..TRIES {
            let d = DETOUR / self.period * 0.125_f64.powi(index);
            match self.left_edge(d, top, &sectors) {
                Ok(left) => {
                    let corners = [&[C64::new(right, 0.0), C64::new(right, top)], &left[..]];
                    let zeros = self.zeros(&corners.concat(), &sectors).into_iter();
                    let zeros = zeros.enumerate();
                    return zeros
                        .map(|(sector, zeros)| zeros.ok_or(Uncounted::OnAxis(sector)))
                        .collect();
                }
                Err(sector) => failed = sector,
            }
        }
        Err(Uncounted::OnAxis(failed))
    }

    /// The imaginary axis from the top down, with detours of a width round zeros on it, and no other beside them; or
    /// a sector with another.
    fn left_edge(&self, d: f64, top: f64, sectors: &[usize]) -> Result<Vec<C64>, usize> {
        let at = C64::new;
        let mut corners = vec![at(0.0, top)];
        let mut above = top;
        for (sector, omega) in self.on_axis() {
            let (low, high) = (omega - d, omega + d);
            if low > top {
                continue;
            }
            let corner = [at(d, low), at(d, high), at(-d, high), at(-d, low)];
            let alone = |(half, path): (usize, &Option<Vec<ContourSide>>)| {
                let zeros = path.as_ref().and_then(|path| turns(path));
                zeros == Some(i32::from(half == sector))
            };
            let edge = [&corner[..], &corner[..1]].concat();
            let apart = low > d && high < above;
            if !apart || !self.walk(&edge, |_| true).iter().enumerate().all(alone) {
                return Err(sector);
            }
            corners.extend([at(0.0, high), at(d, high), at(d, low), at(0.0, low)]);
            above = low;
        }
        let edge = [at(d, 0.0), at(d, d), at(-d, d), at(-d, 0.0)];
        let zeros = self.zeros(&edge, sectors);
        for (sector, zeros) in sectors.iter().zip(zeros) {
            if zeros != Some(usize::from(*sector == 0)) || d >= above {
                return Err(*sector);
            }
        }
        corners.extend([at(0.0, d), at(d, d), at(d, 0.0)]);
        Ok(corners)
    }

    /// Whether right of a line there is only an enclosed eigenvalue, with its conjugate and λ = 0. The translation mode
    /// itself does not lead: a statement about it would hide the eigenvalue that comes next.
    fn leads(&self, eigenvalue: &ProvenEigenvalue, line: f64, window: f64) -> bool {
        let sector = eigenvalue.sector;
        if sector == 0 && eigenvalue.growth.contains(0.0) && eigenvalue.omega.contains(0.0) {
            return false;
        }
        let own = self.conjugate(sector) == sector;
        let pair = own && !eigenvalue.omega.contains(0.0);
        let known = 1 + usize::from(pair) + usize::from(sector == 0 && line < 0.0);
        let corners = |right: f64| {
            let (low, high) = (C64::new(right, 0.0), C64::new(right, window));
            [low, high, C64::new(line, window), C64::new(line, 0.0)]
        };
        let zeros = |right: f64| self.zeros(&corners(right), &[sector])[0] == Some(known);
        let apart = line < eigenvalue.growth.low && eigenvalue.omega.magnitude() <= window;
        apart
            && self
                .right_edge(window)
                .filter(|right| line < *right)
                .is_some_and(zeros)
    }
}

impl WaveSystem<'_> {
    /// Counts the growing eigenvalues of a wave that is known to intervals. Where a line and a bound are stored
    /// they are not looked for.
    pub(super) fn growth(
        &self,
        wave: &[Interval],
        window: f64,
        eigenvalues: &[ProvenEigenvalue],
        stored: Option<&GrowthCount>,
    ) -> Result<GrowthCount, Uncounted> {
        /// First distance of a line from the eigenvalue, in units of 1/T, and tries, each a quarter as far.
        const ASIDE: f64 = 0.1;
        const TRIES: i32 = 5;
        let characteristic =
            IntervalCharacteristic::new(self, wave).ok_or(Uncounted::NotEnclosed)?;
        if !(window > 0.0 && window.is_finite()) {
            return Err(Uncounted::NotEnclosed);
        }
        if self.crossing().is_some() && wave[self.waves()].magnitude() > window {
            return Err(Uncounted::Beyond);
        }
        let counts = characteristic.growing(window)?;
        let lead = |eigenvalue: &ProvenEigenvalue| {
            let lines: Vec<f64> = match stored {
                Some(stored) => {
                    let same = |one: &&Leading| one.sector == eigenvalue.sector;
                    stored
                        .leading
                        .iter()
                        .filter(same)
                        .map(|one| one.line)
                        .collect()
                }
                None => (0..TRIES)
                    .map(|index| {
                        let aside = ASIDE / characteristic.period * 0.25_f64.powi(index);
                        eigenvalue.growth.low - aside
                    })
                    .collect(),
            };
            let sector = eigenvalue.sector;
            let leads = |line: &f64| characteristic.leads(eigenvalue, *line, window);
            let line = lines.into_iter().find(leads)?;
            Some(Leading { sector, line })
        };
        let none = |counts: &[usize]| counts.iter().all(|count| *count == 0);
        let stable = |beyond: f64| {
            let counts = || characteristic.growing(beyond);
            characteristic.is_free_beyond(beyond) && counts().is_ok_and(|counts| none(&counts))
        };
        let beyond = || match stored.map(|stored| stored.verdict) {
            Some(ProvenVerdict::Stable { beyond }) => Some(beyond),
            Some(_) => None,
            None => characteristic.top_edge(window),
        };
        let verdict = if !none(&counts) {
            ProvenVerdict::Unstable
        } else if !characteristic.on_axis().is_empty() {
            ProvenVerdict::Neutral
        } else {
            let beyond = beyond().filter(|beyond| stable(*beyond));
            beyond.map_or(ProvenVerdict::HighFrequency, |beyond| {
                ProvenVerdict::Stable { beyond }
            })
        };
        Ok(GrowthCount {
            window,
            mode: self.mode(),
            counts,
            leading: eigenvalues.iter().filter_map(lead).collect(),
            verdict,
        })
    }
}
