//! The annulus: the elastic tube by finite elements, on the turning shaft.
//!
//! Explicit central differences with the stiffness K and the lumped masses M of [`element`]:
//!
//! ```text
//! u̇ⁿ⁺½ = [(1 − αΔt/2) u̇ⁿ⁻½ − Δt M⁻¹K uⁿ/γ + Δt M⁻¹λⁿ/γ] / (1 + αΔt/2),    uⁿ⁺¹ = uⁿ + Δt u̇ⁿ⁺½,
//! ```
//!
//! where λ are the forces of the shaft on the nodes of the inner circle. They are the forward
//! increment Lagrange multipliers of Carpenter, Taylor and Katona (1991): the step is predicted
//! without contact; a node that would be inside the shaft at n + 1 receives the normal force that
//! puts it on the surface u = δ at n + 1 exactly; a force in tension is not admitted, the node leaves;
//! then the tangential force that would make it stick, V̇ = 1, is capped at f times the normal one.
//! With lumped masses no two nodes share a multiplier, so each is solved exactly by itself.
//!
//! With material damping β > 0 the stiffness acts on û = u + βu̇, the rates extrapolated to the instant
//! from the two half-steps before, as in [`super::ring::impulse`].
//!
//! The outer circle is fixed. Lengths are measured by R, stresses by E, time by 1/Ω.

pub mod element;
mod rest;

use std::f64::consts::TAU;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::ring::friction::{Coulomb, Friction};
use super::ring::with_diffusion;
use crate::tube::model::coefficients::{Geometry, lame};
use element::{Circles, circles};
use rest::{alike, steady};

/// Mesh, steps and numbers of an annulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TubeSetup {
    /// The tube.
    pub geometry: Geometry,
    /// Friction coefficient f.
    pub friction: f64,
    /// Mismatch δ.
    pub mismatch: f64,
    /// Mass-proportional damping α.
    pub mass_damping: f64,
    /// Stiffness-proportional damping β.
    pub stiffness_damping: f64,
    /// Elements along the angle.
    pub around: usize,
    /// Elements from the inner to the outer radius.
    pub across: usize,
    /// Angle of the part simulated, whose ends are joined.
    pub angle: f64,
    /// Time step.
    pub time_step: f64,
}

/// Part of the bound of the stability limit that a time step may take.
pub(crate) const LARGEST_PART: f64 = 0.98;

/// Why there is no annulus.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TubeSetupError {
    /// Too few elements.
    #[error("a mesh of {around} × {across} elements is too coarse; take at least 3 × 2")]
    Mesh {
        /// Elements around.
        around: usize,
        /// Elements across.
        across: usize,
    },
    /// The time step is not positive, or too large.
    #[error("the time step {step:e} must lie between 0 and {limit:e}, where the scheme is stable")]
    Step {
        /// The step asked for.
        step: f64,
        /// Largest stable step.
        limit: f64,
    },
    /// A state that is none of this mesh.
    #[error("its lists do not all have a finite number for every node of the mesh")]
    State,
}

/// Displacements at n, their rates at n − ½, and the last forces of the shaft. Node i of circle j
/// stands at j·around + i; the fixed circle is not stored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Radial displacement.
    pub radial: Vec<f64>,
    /// Tangential displacement.
    pub tangential: Vec<f64>,
    /// Rate of the radial displacement.
    pub radial_rate: Vec<f64>,
    /// Rate of the tangential displacement.
    pub tangential_rate: Vec<f64>,
    /// Displacements that the stiffness acts on, û = u + βu̇; empty for β = 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effective_radial: Vec<f64>,
    /// The tangential ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effective_tangential: Vec<f64>,
    /// Contact pressure p on the nodes of the inner circle in the last step, in units of E.
    pub pressure: Vec<f64>,
    /// Shear q on them.
    pub shear: Vec<f64>,
    /// Work of friction and of normal contact, and of damping, since the start.
    pub work: [f64; 3],
}

/// A tube in motion.
#[derive(Clone, Debug)]
pub struct Annulus {
    setup: TubeSetup,
    circles: Circles,
    state: State,
    /// Accelerations without contact, one pair of rows per circle; and those without damping for β > 0.
    force: (Vec<f64>, Vec<f64>),
    elastic: (Vec<f64>, Vec<f64>),
    /// Time from the rates before a step to those after it: Δt, and where the step changes the mean
    /// of both.
    kick: f64,
    steps: u64,
    /// Steps and time when the time step was changed last.
    since: (u64, f64),
}

/// Nodes from which on circles are worked on by several threads.
const PARALLEL: usize = 1 << 14;

/// The largest stable time step: √(4β² + 4/ω²) − 2β of the fastest vibration, whose ω² is bounded by the
/// largest sum of absolute values in a row of M⁻¹K/γ.
pub(crate) fn stable_step(
    geometry: &Geometry,
    around: usize,
    across: usize,
    angle: f64,
    stiffness_damping: f64,
) -> f64 {
    let circles = circles(geometry, across, angle / around as f64);
    let square = circles
        .blocks
        .iter()
        .zip(&circles.masses)
        .take(across)
        .flat_map(|(block, mass)| {
            [0, 1].map(|row| {
                let sum: f64 = block
                    .iter()
                    .flatten()
                    .map(|pair| pair[row][0].abs() + pair[row][1].abs())
                    .sum();
                sum / (geometry.gamma * mass)
            })
        })
        .fold(0.0, f64::max);
    with_diffusion(2.0 / square.sqrt(), stiffness_damping)
}

/// The time step of a Courant number: pressure waves √(C/γ) over the shorter side of the smallest
/// element; with β > 0 the part of √(4β² + s²) − 2β, with s the time that they take for it.
pub fn courant_step(
    geometry: &Geometry,
    around: usize,
    across: usize,
    angle: f64,
    courant: f64,
    stiffness_damping: f64,
) -> f64 {
    let [c, _, _] = lame(geometry.nu);
    let side = (angle / around as f64).min((geometry.xi - 1.0) / across as f64);
    let speed = (c / geometry.gamma).sqrt();
    let free = side / speed;
    courant * side / speed * (with_diffusion(free, stiffness_damping) / free)
}

impl Annulus {
    /// A tube in the steady sliding of its mesh: the solution of K u = λ with u = δ and the shear f p
    /// on the inner circle, the same all round. It differs from the exact one by the error of the
    /// elements.
    pub fn new(setup: TubeSetup) -> Result<Annulus, TubeSetupError> {
        let TubeSetup {
            around,
            across,
            angle,
            time_step: dt,
            ..
        } = setup;
        if around < 3 || across < 2 {
            return Err(TubeSetupError::Mesh { around, across });
        }
        let limit = LARGEST_PART
            * stable_step(
                &setup.geometry,
                around,
                across,
                angle,
                setup.stiffness_damping,
            );
        if !(dt > 0.0 && dt <= limit) {
            return Err(TubeSetupError::Step { step: dt, limit });
        }
        let circles = circles(&setup.geometry, across, angle / around as f64);
        let count = around * across;
        let (u, v) = steady(&circles, setup.mismatch, setup.friction);
        let spread = |values: &[f64]| -> Vec<f64> {
            values
                .iter()
                .flat_map(|value| std::iter::repeat_n(*value, around))
                .collect()
        };
        let (u_all, v_all) = (spread(&u), spread(&v));
        let some = |values: &[f64]| match setup.stiffness_damping > 0.0 {
            true => values.to_vec(),
            false => Vec::new(),
        };
        let mut annulus = Annulus {
            elastic: (some(&u_all), some(&v_all)),
            state: State {
                effective_radial: some(&u_all),
                effective_tangential: some(&v_all),
                radial: u_all,
                tangential: v_all,
                radial_rate: vec![0.0; count],
                tangential_rate: vec![0.0; count],
                pressure: vec![0.0; around],
                shear: vec![0.0; around],
                work: [0.0; 3],
            },
            force: (vec![0.0; count], vec![0.0; count]),
            setup,
            circles,
            kick: dt,
            steps: 0,
            since: (0, 0.0),
        };
        let rest = annulus.sums(0, [&u, &v]);
        let width = annulus.width();
        annulus.state.pressure.fill(rest[0] / width);
        annulus.state.shear.fill(rest[1] / width);
        Ok(annulus)
    }

    /// Mesh and steps.
    pub fn setup(&self) -> &TubeSetup {
        &self.setup
    }

    /// Radii of the circles of nodes.
    pub fn radii(&self) -> &[f64] {
        &self.circles.radii
    }

    /// Displacements, rates and forces.
    pub fn state(&self) -> &State {
        &self.state
    }

    pub(crate) fn width(&self) -> f64 {
        self.setup.angle / self.setup.around as f64
    }

    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    pub(crate) fn time(&self) -> f64 {
        let (steps, time) = self.since;
        time + (self.steps - steps) as f64 * self.setup.time_step
    }

    /// Goes on with a shorter time step, and takes the first one: the rates stand half an old step
    /// before the instant, so that the mean of both steps brings them half a new one beyond it.
    pub(crate) fn shorten(&mut self, time_step: f64) {
        self.since = (self.steps, self.time());
        self.kick = 0.5 * (self.setup.time_step + time_step);
        self.setup.time_step = time_step;
        self.advance(1);
        self.kick = time_step;
    }

    /// Goes on from a state after `steps` steps.
    pub(crate) fn resume(&mut self, state: State, steps: u64) -> Result<(), TubeSetupError> {
        let inner = self.setup.around;
        let all = inner * self.setup.across;
        let lists = [
            (&state.radial, all),
            (&state.tangential, all),
            (&state.radial_rate, all),
            (&state.tangential_rate, all),
            (&state.effective_radial, self.state.effective_radial.len()),
            (
                &state.effective_tangential,
                self.state.effective_tangential.len(),
            ),
            (&state.pressure, inner),
            (&state.shear, inner),
        ];
        let fits = |(list, count): &(&Vec<f64>, usize)| {
            list.len() == *count && list.iter().all(|x| x.is_finite())
        };
        if !(lists.iter().all(fits) && state.work.iter().all(|x| x.is_finite())) {
            return Err(TubeSetupError::State);
        }
        self.state = state;
        self.steps = steps;
        Ok(())
    }

    /// Adds a harmonic v = A X(r) cos kφ with the rate A X(r) Re(λe^{ikφ}), X(r) = (ξ²/r − r)/(ξ² − 1).
    /// Rates stand half a step before.
    pub fn perturb(&mut self, mode: u32, amplitude: f64, lambda: [f64; 2]) {
        let square = self.setup.geometry.xi * self.setup.geometry.xi;
        let (around, width) = (self.setup.around, self.width());
        for circle in 0..self.setup.across {
            let r = self.circles.radii[circle];
            let part = amplitude * (square / r - r) / (square - 1.0);
            for point in 0..around {
                let (sine, cosine) = (f64::from(mode) * width * point as f64).sin_cos();
                let node = circle * around + point;
                let rate = part * (lambda[0] * cosine - lambda[1] * sine);
                self.state.tangential[node] += part * cosine;
                self.state.tangential_rate[node] += rate;
                if let Some(effective) = self.state.effective_tangential.get_mut(node) {
                    *effective += part * cosine + self.setup.stiffness_damping * rate;
                }
            }
        }
    }

    /// Takes a number of steps.
    pub fn advance(&mut self, steps: u64) {
        for _ in 0..steps {
            self.step();
        }
        self.steps += steps;
    }

    fn step(&mut self) {
        let state = &self.state;
        let fields = (&state.radial[..], &state.tangential[..]);
        if state.effective_radial.is_empty() {
            accelerate(&self.circles, &self.setup, fields, &mut self.force);
        } else {
            let effective = (&state.effective_radial[..], &state.effective_tangential[..]);
            accelerate(&self.circles, &self.setup, effective, &mut self.force);
            accelerate(&self.circles, &self.setup, fields, &mut self.elastic);
        }
        self.move_nodes();
    }

    /// From the accelerations without contact to the next displacements.
    fn move_nodes(&mut self) {
        let TubeSetup {
            friction,
            mismatch,
            mass_damping,
            stiffness_damping: beta,
            around,
            time_step: dt,
            geometry,
            ..
        } = self.setup;
        let width = self.width();
        let kick = self.kick;
        let half = 0.5 * mass_damping * kick;
        let (keep, gain) = (1.0 - half, 1.0 / (1.0 + half));
        let state = &mut self.state;
        let mut work = [0.0; 3];
        for circle in 0..self.setup.across {
            let mass = geometry.gamma * self.circles.masses[circle];
            for point in 0..around {
                let node = circle * around + point;
                let (old_u, old_v) = (state.radial_rate[node], state.tangential_rate[node]);
                let alone_u = gain * (keep * old_u + kick * self.force.0[node]);
                let alone_v = gain * (keep * old_v + kick * self.force.1[node]);
                let (mut u, mut v) = (alone_u, alone_v);
                let mut radial = state.radial[node] + dt * alone_u;
                if circle == 0 {
                    let (mut normal, mut shear) = (0.0, 0.0);
                    if radial < mismatch {
                        u = (mismatch - state.radial[node]) / dt;
                        radial = mismatch;
                        normal = u - alone_u;
                        let (slid, _) =
                            Coulomb.slide(old_v - 1.0, alone_v - old_v, friction * normal);
                        v = 1.0 + slid;
                        shear = v - alone_v;
                    }
                    let per_area = mass / (gain * kick * width);
                    state.pressure[point] = normal * per_area;
                    state.shear[point] = shear * per_area;
                    work[0] += mass / gain * shear * 0.5 * (old_v + v);
                    work[1] += mass / gain * normal * 0.5 * (old_u + u);
                }
                if mass_damping != 0.0 {
                    let (mean_u, mean_v) = (0.5 * (old_u + u), 0.5 * (old_v + v));
                    work[2] -= mass * mass_damping * kick * (mean_u * mean_u + mean_v * mean_v);
                }
                state.radial_rate[node] = u;
                state.tangential_rate[node] = v;
                state.radial[node] = radial;
                state.tangential[node] += dt * v;
                if beta > 0.0 {
                    let (mean_u, mean_v) = (0.5 * (old_u + u), 0.5 * (old_v + v));
                    let damped = (self.force.0[node] - self.elastic.0[node]) * mean_u
                        + (self.force.1[node] - self.elastic.1[node]) * mean_v;
                    work[2] += mass * kick * damped;
                    // what touches rests from then on
                    let touches = circle == 0 && radial == mismatch;
                    let now = if touches { 0.0 } else { 1.5 * u - 0.5 * old_u };
                    state.effective_radial[node] = radial + beta * now;
                    state.effective_tangential[node] =
                        state.tangential[node] + beta * (1.5 * v - 0.5 * old_v);
                }
            }
        }
        for (total, part) in state.work.iter_mut().zip(work) {
            *total += part;
        }
    }

    /// Energy of the tube: kinetic, and elastic between the displacements of two steps, which leapfrog
    /// keeps exactly where no force acts.
    pub fn energy(&self) -> f64 {
        let TubeSetup {
            around,
            across,
            time_step: dt,
            geometry,
            ..
        } = self.setup;
        let state = &self.state;
        let (mut u, mut v) = (vec![0.0; around], vec![0.0; around]);
        let mut energy = 0.0;
        for circle in 0..across {
            let fields = (&state.radial[..], &state.tangential[..]);
            accelerations(&self.circles, &self.setup, fields, circle, &mut u, &mut v);
            let mass = geometry.gamma * self.circles.masses[circle];
            for point in 0..around {
                let node = circle * around + point;
                let (rate_u, rate_v) = (state.radial_rate[node], state.tangential_rate[node]);
                let before_u = state.radial[node] - dt * rate_u;
                let before_v = state.tangential[node] - dt * rate_v;
                energy += 0.5
                    * mass
                    * (rate_u * rate_u + rate_v * rate_v
                        - before_u * u[point]
                        - before_v * v[point]);
            }
        }
        energy
    }

    /// Elastic forces on a node of a circle when all nodes of a circle move alike.
    fn sums(&self, circle: usize, fields: [&[f64]; 2]) -> [f64; 2] {
        alike(
            &self.circles.blocks[circle],
            circle,
            self.setup.across,
            fields,
        )
    }

    /// Cartesian places of the nodes of a circle's point, for drawing.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn place(&self, circle: usize, point: usize) -> [f64; 2] {
        let (sine, cosine) = (self.width() * point as f64).sin_cos();
        [
            self.circles.radii[circle] * cosine,
            self.circles.radii[circle] * sine,
        ]
    }

    /// Whether the mesh goes all the way round.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    pub(crate) fn closed(&self) -> bool {
        // the angle of the whole circle is written as 2π exactly
        self.setup.angle >= TAU
    }
}

/// −M⁻¹K u/γ of all circles.
fn accelerate(
    circles: &Circles,
    setup: &TubeSetup,
    fields: (&[f64], &[f64]),
    to: &mut (Vec<f64>, Vec<f64>),
) {
    let around = setup.around;
    let one = |(circle, (u, v)): (usize, (&mut [f64], &mut [f64]))| {
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || accelerations(circles, setup, fields, circle, u, v),
        );
    };
    if around * setup.across >= PARALLEL {
        let rows = (to.0.par_chunks_mut(around), to.1.par_chunks_mut(around));
        rows.0.zip(rows.1).enumerate().for_each(one);
    } else {
        let rows = (to.0.chunks_mut(around), to.1.chunks_mut(around));
        rows.0.zip(rows.1).enumerate().for_each(one);
    }
}

/// −M⁻¹K u/γ of a circle.
#[inline(always)]
fn accelerations(
    circles: &Circles,
    setup: &TubeSetup,
    fields: (&[f64], &[f64]),
    circle: usize,
    u: &mut [f64],
    v: &mut [f64],
) {
    let around = setup.around;
    u.fill(0.0);
    v.fill(0.0);
    let factor = -1.0 / (setup.geometry.gamma * circles.masses[circle]);
    for (dr, blocks) in circles.blocks[circle].iter().enumerate() {
        let other = circle + dr;
        // nothing inside the tube, and the outer circle is at rest
        if other < 1 || other > setup.across {
            continue;
        }
        let row = (other - 1) * around..other * around;
        let (radial, tangential) = (&fields.0[row.clone()], &fields.1[row]);
        for (shift, block) in blocks.iter().enumerate() {
            let [[uu, uv], [vu, vv]] = block.map(|line| line.map(|entry| factor * entry));
            let mut add = |to: std::ops::Range<usize>, from: usize| {
                let count = to.len();
                let (x, y) = (&radial[from..from + count], &tangential[from..from + count]);
                let (p, q) = (&mut u[to.clone()], &mut v[to]);
                for i in 0..count {
                    p[i] += uu * x[i] + uv * y[i];
                    q[i] += vu * x[i] + vv * y[i];
                }
            };
            match shift {
                0 => {
                    add(1..around, 0);
                    add(0..1, around - 1);
                }
                1 => add(0..around, 0),
                _ => {
                    add(0..around - 1, 1);
                    add(around - 1..around, 0);
                }
            }
        }
    }
}
