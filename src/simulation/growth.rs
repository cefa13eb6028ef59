//! Growth of small perturbations of a travelling wave, from the simulation alone.
//!
//! Two rings that begin with the wave ± ε times a perturbation ψ are taken through the time T, in
//! which the wave moves by a whole number of points. Half their difference, moved back with the wave,
//! is Mψ up to O(ε²), where M has the eigenvalues e^{λT}. Half differences rather than one: the wave
//! of the grid is not the wave of the table, and what is the same in both cancels.
//!
//! A single difference followed in time shows a sum of many exponentials, of which decaying ones lie
//! densely. Arnoldi's method applies the pair of runs again and again to a new ψ, each orthogonal to
//! all before: m pairs give the m × (m+1) matrix of M between these shapes, its eigenvalues μ, and
//! for each the residual ‖Mψ − μψ‖, whence λ = ln μ/T with an error. |Im λ| < π/T.
//!
//! Where exactly the fronts stand between the points when the wave is perturbed shows in M: some points
//! have just been passed, others have not. [`averaged`] begins at several such instants; the scatter of
//! the eigenvalues is an honest error, and that of λ = 0, translation, is one of its samples.
//!
//! In the Bloch sector j of a ring with w waves a perturbation is Re ψ(θ)e^{±2πijm/w} on the m-th
//! wave, with the upper sign for c < 0; the difference is decomposed in the same way.

use faer::{Mat, c64};
use serde::Serialize;
use std::f64::consts::TAU;

use super::profile::Profile;
use super::ring::kernel::Nodes;
use super::ring::{Ring, RingSetup, RingSetupError};
use crate::tube::model::Constants;

/// What to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Points per wavelength.
    pub points: usize,
    /// Waves on the ring, 1 for sector 0 alone.
    pub waves: usize,
    /// Bloch sector j < waves.
    pub sector: usize,
    /// Points that the wave moves by in T.
    pub shift: usize,
    /// Courant number √a Δt/Δφ that is not exceeded.
    pub courant: f64,
    /// Largest value of ε ψ.
    pub amplitude: f64,
    /// Pairs of runs.
    pub pairs: usize,
    /// Time over which the wave of the table becomes that of the grid before it is perturbed.
    pub settling: f64,
}

impl Request {
    /// What a Bloch sector of a wave of mode k takes: T is the time in which the wave moves by its own
    /// length, and sector 0 needs one wave alone.
    pub fn of_sector(sector: usize, mode: usize, points: usize) -> Request {
        Request {
            points,
            waves: if sector == 0 { 1 } else { mode },
            sector,
            shift: points,
            courant: 0.2,
            amplitude: 1e-6,
            pairs: 80,
            settling: SETTLING,
        }
    }

    /// Whether the sector is its own conjugate.
    pub(crate) fn real(&self) -> bool {
        self.sector == 0 || 2 * self.sector == self.waves
    }
}

/// Which eigenvalues are worth a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Listing {
    /// Largest residual and scatter.
    pub resolved: f64,
    /// Largest |Im λ|.
    pub highest: f64,
    /// |Im λ| below which an eigenvalue counts as real.
    pub real: f64,
    /// Most of them.
    pub most: usize,
}

impl Listing {
    /// The eigenvalues of a request that are listed: of conjugate pairs the upper member.
    pub fn of(
        self,
        request: &Request,
        found: Vec<SimulatedEigenvalue>,
    ) -> impl Iterator<Item = SimulatedEigenvalue> + use<> {
        let both = !request.real();
        let listed = move |value: &SimulatedEigenvalue| {
            value.residual.max(value.scatter) <= self.resolved
                && value.im.abs() <= self.highest
                && (both || value.im >= -self.real)
        };
        found.into_iter().filter(listed).take(self.most)
    }
}

/// Time that suffices for the wave of a table to become that of the grid: fronts settle within a
/// few steps, and a wavelength passes in about this time at the speeds of thin tubes.
pub const SETTLING: f64 = 1.0;

/// An eigenvalue with the residual of its shape, in units of Ω.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SimulatedEigenvalue {
    /// Growth rate.
    pub re: f64,
    /// Frequency.
    pub im: f64,
    /// ‖Mψ − μψ‖/(|μ|T): error of λ to first order, apart from that of the grid.
    pub residual: f64,
    /// Standard error of the mean over several instants of the fronts between the points; 0 for one.
    pub scatter: f64,
}

impl SimulatedEigenvalue {
    /// |λ₁ − λ₂|.
    pub(super) fn distance(&self, other: &SimulatedEigenvalue) -> f64 {
        (other.re - self.re).hypot(other.im - self.im)
    }
}

/// Why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum GrowthError {
    /// The ring cannot be set up.
    #[error("{0}")]
    Setup(#[from] RingSetupError),
    /// The eigenvalues of the small matrix do not converge.
    #[error("the eigenvalues of the matrix of {0} shapes do not converge")]
    Eigenvalues(usize),
    /// There is no such sector.
    #[error("there is no sector {0} on a ring of {1} waves")]
    Sector(usize, usize),
}

/// Puts a wave on the ring, as many times as it fits.
pub fn place(ring: &mut Ring, profile: &Profile) {
    let width = ring.spacing();
    let earlier = -0.5 * ring.setup().time_step;
    for point in 0..ring.setup().points {
        let angle = point as f64 * width;
        let now = profile.at(angle, 0.0);
        let before = profile.at(angle, earlier);
        let mut values = now.values;
        values[2..].copy_from_slice(&before.values[2..]);
        if now.contact {
            values[0] = ring.constants().mismatch;
        }
        ring.place(point, values);
    }
}

/// The ring of a request with the wave on it, the time T, and the steps that it takes.
fn begin(
    parameters: &Constants,
    setup: &RingSetup,
    profile: &Profile,
    request: &Request,
) -> Result<(Ring, f64, f64), GrowthError> {
    let Request { points, waves, .. } = *request;
    if request.sector >= waves.max(1) {
        return Err(GrowthError::Sector(request.sector, waves));
    }
    let angle = profile.wavelength() * waves as f64;
    let interval =
        request.shift as f64 * profile.wavelength() / points as f64 / profile.speed().abs();
    let longest = super::ring::courant_step(parameters, points * waves, angle, request.courant);
    let steps = (interval / longest).ceil().max(1.0);
    let mut ring = Ring::new(
        parameters,
        RingSetup {
            points: points * waves,
            angle,
            time_step: interval / steps,
            watched: false,
            ..*setup
        },
    )?;
    place(&mut ring, profile);
    Ok((ring, interval, steps))
}

/// Steps of nodes that [`averaged`] takes.
///
/// # Errors
/// When the ring cannot be set up.
pub(crate) fn work(
    parameters: &Constants,
    setup: &RingSetup,
    profile: &Profile,
    request: &Request,
    instants: usize,
) -> Result<f64, GrowthError> {
    let (ring, _, steps) = begin(parameters, setup, profile, request)?;
    let settling = request.settling / ring.setup().time_step;
    let pairs = request.pairs.min(FIELDS * request.points) as f64;
    Ok((settling + 2.0 * pairs * steps) * ring.setup().points as f64 * instants.max(2) as f64)
}

/// Eigenvalues of the perturbations of a wave, by falling growth rate. `tick` is called after every
/// pair of runs.
pub fn eigenvalues(
    parameters: &Constants,
    setup: &RingSetup,
    profile: &Profile,
    request: &Request,
    tick: &mut dyn FnMut(),
) -> Result<Vec<SimulatedEigenvalue>, GrowthError> {
    let Request {
        points,
        waves,
        sector,
        shift,
        ..
    } = *request;
    let (mut ring, interval, steps) = begin(parameters, setup, profile, request)?;
    ring.advance((request.settling / ring.setup().time_step).round() as u64);
    let map = PeriodMap {
        points,
        waves,
        phase: -profile.speed().signum() * TAU * sector as f64 / waves as f64,
        real: request.real(),
        shift: shift as isize * profile.speed().signum() as isize,
        steps: steps as u64,
        amplitude: request.amplitude,
        ring,
    };
    let (matrix, basis, last) = arnoldi(&map, request.pairs, tick);
    let size = matrix.nrows();
    let decomposition = matrix.eigen().map_err(|_| GrowthError::Eigenvalues(size))?;
    let (values, shapes) = (decomposition.S().column_vector(), decomposition.U());
    let mut found: Vec<SimulatedEigenvalue> = (0..size)
        .map(|index| {
            let value: c64 = values[index];
            let norm: f64 = (0..size)
                .map(|row| shapes[(row, index)].norm_sqr())
                .sum::<f64>()
                .sqrt();
            let exponent = value.ln() / interval;
            let weights: Vec<c64> = (0..size).map(|row| shapes[(row, index)]).collect();
            let rough = map.frequency(&basis, &weights, profile.speed());
            let turns = ((rough - exponent.im) * interval / TAU).round();
            SimulatedEigenvalue {
                re: exponent.re,
                im: exponent.im + turns * TAU / interval,
                scatter: 0.0,
                residual: last * shapes[(size - 1, index)].norm()
                    / (norm * value.norm() * interval),
            }
        })
        .filter(|value| value.re.is_finite() && value.im.is_finite())
        .collect();
    found.sort_by(|one, other| other.re.total_cmp(&one.re));
    Ok(found)
}

/// Instants of [`averaged`] that give a fair scatter.
pub const INSTANTS: usize = 4;

/// Time between these instants: a fraction of a period in which fronts pass several points, not a
/// multiple of the time from point to point for any number of points in use.
const APART: f64 = 0.061_803_398_875;

/// The mean of [`eigenvalues`] over several instants, two or more, at which the wave is perturbed. Eigenvalues
/// of the first are matched with the nearest of the others.
pub fn averaged(
    parameters: &Constants,
    setup: &RingSetup,
    profile: &Profile,
    request: &Request,
    instants: usize,
    tick: &mut dyn FnMut(),
) -> Result<Vec<SimulatedEigenvalue>, GrowthError> {
    let instants = instants.max(2);
    let mut sets = Vec::with_capacity(instants);
    for instant in 0..instants {
        let later = Request {
            settling: request.settling + APART * instant as f64,
            ..*request
        };
        sets.push(eigenvalues(parameters, setup, profile, &later, tick)?);
    }
    let count = instants as f64;
    let mut means: Vec<SimulatedEigenvalue> = sets[0]
        .iter()
        .map(|value| {
            let matched: Vec<&SimulatedEigenvalue> = sets
                .iter()
                .filter_map(|set| {
                    set.iter()
                        .min_by(|one, other| value.distance(one).total_cmp(&value.distance(other)))
                })
                .collect();
            let (re, im) = matched.iter().fold((0.0, 0.0), |(re, im), other| {
                (re + other.re / count, im + other.im / count)
            });
            let square: f64 = matched
                .iter()
                .map(|other| (other.re - re).powi(2) + (other.im - im).powi(2))
                .sum();
            SimulatedEigenvalue {
                re,
                im,
                residual: matched
                    .iter()
                    .map(|other| other.residual)
                    .fold(0.0, f64::max),
                scatter: (square / (count * (count - 1.0))).sqrt(),
            }
        })
        .collect();
    means.sort_by(|one, other| other.re.total_cmp(&one.re));
    Ok(means)
}

/// The map M of perturbations over T.
struct PeriodMap {
    ring: Ring,
    points: usize,
    waves: usize,
    /// e^{i·phase} from one wave to the next.
    phase: f64,
    real: bool,
    shift: isize,
    steps: u64,
    amplitude: f64,
}

/// Values per point: V, V̇, U, U̇.
const FIELDS: usize = 4;

/// The quantities of a perturbation in the order of its shape.
fn fields(nodes: &mut Nodes) -> [&mut Vec<f64>; FIELDS] {
    [
        &mut nodes.tangential,
        &mut nodes.tangential_rate,
        &mut nodes.radial,
        &mut nodes.radial_rate,
    ]
}

impl PeriodMap {
    fn size(&self) -> usize {
        FIELDS * self.points
    }

    /// Whether an entry of a shape is free to be perturbed: U and U̇ only in the air, V̇ not in stick,
    /// which would forget it at once.
    fn free(&self, entry: usize) -> bool {
        let (field, point) = (entry / self.points, entry % self.points);
        let nodes = self.ring.nodes();
        match field {
            0 => true,
            1 => nodes.tangential_rate[point] != 1.0,
            _ => nodes.share[point] == 0.0,
        }
    }

    /// A smooth shape to begin with: a few waves of V and V̇ that are not alike.
    fn first(&self) -> Vec<c64> {
        (0..self.size())
            .map(|entry| {
                let (field, point) = (entry / self.points, entry % self.points);
                if field >= 2 || !self.free(entry) {
                    return c64::new(0.0, 0.0);
                }
                let angle = TAU * point as f64 / self.points as f64;
                let place = point as f64 / self.points as f64;
                let mut value = c64::new(0.0, 0.0);
                for wave in 0..6 {
                    let order = f64::from(wave) + 0.37 * field as f64;
                    let turn = 0.7 * order * order + 0.4;
                    let size = 1.0 / (1.0 + 0.5 * f64::from(wave));
                    if self.real {
                        value.re += size * (f64::from(wave) * angle + turn).cos();
                    } else {
                        let signed = if wave % 2 == 0 {
                            -wave / 2
                        } else {
                            (wave + 1) / 2
                        };
                        let argument = f64::from(signed) * angle + self.phase * place + turn;
                        value += c64::new(size * argument.cos(), size * argument.sin());
                    }
                }
                if self.real && self.phase != 0.0 {
                    // vanishes at the ends, where the sign changes
                    value.re *= (0.5 * angle).sin();
                }
                value
            })
            .collect()
    }

    /// The ring with a multiple of a shape added.
    fn perturbed(&self, shape: &[c64], factor: f64) -> Ring {
        let mut ring = self.ring.clone();
        let mut nodes = ring.nodes().clone();
        let steps = ring.steps();
        let mismatch = ring.constants().mismatch;
        let beta = ring.constants().stiffness_damping;
        for (field, values) in fields(&mut nodes).into_iter().enumerate() {
            for wave in 0..self.waves {
                let (sine, cosine) = (self.phase * wave as f64).sin_cos();
                for point in 0..self.points {
                    let value = shape[field * self.points + point];
                    values[wave * self.points + point] +=
                        factor * (value.re * cosine - value.im * sine);
                }
            }
        }
        for value in &mut nodes.radial {
            *value = value.max(mismatch);
        }
        // Û and V̂ move with U, V and their rates
        let before = self.ring.nodes();
        for (point, value) in nodes.effective.iter_mut().enumerate() {
            *value += nodes.tangential[point] - before.tangential[point]
                + beta * (nodes.tangential_rate[point] - before.tangential_rate[point]);
        }
        for (point, value) in nodes.effective_radial.iter_mut().enumerate() {
            *value += nodes.radial[point] - before.radial[point]
                + beta * (nodes.radial_rate[point] - before.radial_rate[point]);
        }
        // the number of nodes is the same
        let _ = ring.resume(nodes, steps);
        ring
    }

    /// Mψ.
    fn apply(&self, shape: &[c64]) -> Vec<c64> {
        let largest = shape.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let factor = self.amplitude / largest.max(f64::MIN_POSITIVE);
        let run = |factor: f64| {
            let mut ring = self.perturbed(shape, factor);
            ring.advance(self.steps);
            ring.nodes().clone()
        };
        let (mut plus, mut minus) = rayon::join(|| run(factor), || run(-factor));
        // where one run has landed and the other not, the difference of U̇ is no derivative
        let apart: Vec<bool> = plus
            .share
            .iter()
            .zip(&minus.share)
            .map(|(one, other)| (*one == 0.0) != (*other == 0.0))
            .collect();
        let (plus, minus) = (fields(&mut plus), fields(&mut minus));
        let count = self.points as isize;
        let share = if self.real { 1.0 } else { 2.0 } / self.waves as f64;
        (0..self.size())
            .map(|entry| {
                if !self.free(entry) {
                    return c64::new(0.0, 0.0);
                }
                let (field, point) = (entry / self.points, entry % self.points);
                let moved = point as isize + self.shift;
                let (turns, source) = (moved.div_euclid(count), moved.rem_euclid(count) as usize);
                let mut value = c64::new(0.0, 0.0);
                for wave in 0..self.waves {
                    let index = wave * self.points + source;
                    if field >= 2 && apart[index] {
                        continue;
                    }
                    let half = 0.5 * (plus[field][index] - minus[field][index]);
                    let argument = -self.phase * wave as f64;
                    value += c64::new(half * argument.cos(), half * argument.sin());
                }
                let turn = self.phase * turns as f64;
                let turned = value * c64::new(turn.cos(), turn.sin()) * (share / factor);
                if self.real {
                    c64::new(turned.re, 0.0)
                } else {
                    turned
                }
            })
            .collect()
    }
}

impl PeriodMap {
    /// Im⟨ψ, V̇ + cψ′⟩/⟨ψ, ψ⟩ of a combination of shapes.
    fn frequency(&self, basis: &[Vec<c64>], weights: &[c64], speed: f64) -> f64 {
        let count = self.points;
        let combine = |entry: usize| -> c64 {
            basis
                .iter()
                .zip(weights)
                .map(|(shape, weight)| weight * shape[entry])
                .sum()
        };
        let shape: Vec<c64> = (0..count).map(combine).collect();
        let slope = speed * 0.5 / self.ring.spacing();
        let turn = |angle: f64| c64::new(angle.cos(), angle.sin());
        let (mut product, mut square) = (c64::new(0.0, 0.0), 0.0);
        for point in 0..count {
            let right = match point + 1 {
                next if next == count => turn(self.phase) * shape[0],
                next => shape[next],
            };
            let left = match point {
                0 => turn(-self.phase) * shape[count - 1],
                point => shape[point - 1],
            };
            let rate = combine(count + point) + slope * (right - left);
            product += shape[point].conj() * rate;
            square += shape[point].norm_sqr();
        }
        if square > 0.0 {
            (product / square).im
        } else {
            0.0
        }
    }
}

/// Part of a new shape's length that must be left after the old ones have been taken out; less is
/// rounding, and the shapes found span all there is.
const EXHAUSTED: f64 = 1e-12;

/// The matrix of the map between orthonormal shapes, these shapes, and the length of what it leaves
/// out.
type Arnoldi = (Mat<c64>, Vec<Vec<c64>>, f64);

/// See [`Arnoldi`].
fn arnoldi(map: &PeriodMap, pairs: usize, tick: &mut dyn FnMut()) -> Arnoldi {
    let length = |shape: &[c64]| {
        shape
            .iter()
            .map(|value| value.norm_sqr())
            .sum::<f64>()
            .sqrt()
    };
    let mut shape = map.first();
    let first = length(&shape);
    shape.iter_mut().for_each(|value| *value /= first);
    let mut shapes = vec![shape];
    let mut columns: Vec<Vec<c64>> = Vec::new();
    let mut last = 0.0;
    while columns.len() < pairs.min(map.size()) {
        let mut image = map.apply(&shapes[shapes.len() - 1]);
        tick();
        let whole = length(&image);
        let mut column = vec![c64::new(0.0, 0.0); shapes.len()];
        // twice is enough
        for _ in 0..2 {
            for (entry, shape) in column.iter_mut().zip(&shapes) {
                let part: c64 = shape
                    .iter()
                    .zip(&image)
                    .map(|(one, other)| one.conj() * other)
                    .sum();
                *entry += part;
                for (value, one) in image.iter_mut().zip(shape) {
                    *value -= part * one;
                }
            }
        }
        last = length(&image);
        column.push(c64::new(last, 0.0));
        columns.push(column);
        if last <= EXHAUSTED * whole {
            break;
        }
        image.iter_mut().for_each(|value| *value /= last);
        shapes.push(image);
    }
    let size = columns.len();
    let matrix = Mat::from_fn(size, size, |row, column| {
        columns[column]
            .get(row)
            .copied()
            .unwrap_or(c64::new(0.0, 0.0))
    });
    (matrix, shapes, last)
}
