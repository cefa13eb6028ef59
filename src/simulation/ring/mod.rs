//! The ring: system (M) on N points of one wavelength or of the whole circle.
//!
//! [`kernel`] has the equations of a step, [`impulse`] those for β > 0 and for Coulomb impacts, [`friction`] the
//! law of a node.
//! This file has the grid, the limit of the time step, the balance of energy, and the way a long ring is
//! cut up.
//!
//! **Energy.** Per unit of mass of the ring, with Δφ the spacing and K the symmetric matrix of the
//! differences,
//!
//! ```text
//! E = Δφ Σ ½(U̇² + V̇²) + ½⟨(U,V)ⁿ⁻¹, K (U,V)ⁿ⟩,
//! ```
//!
//! which leapfrog keeps exactly where no force acts. With the mean of the two velocities each force
//! does the work that E gains. What is added to V at the kinks of its acceleration does work against
//! the elastic force, too, which is counted with friction. So E − (work of friction, contact and
//! damping) stays what it was to rounding as long as there are no kinks, and to the second order of the
//! step with them.
//!
//! **Cutting.** A stretch with the neighbours that `depth` steps reach is copied out, taken through
//! `depth` steps without a look at the rest, and its core is copied back. Stretches are independent
//! work for several cores and stay in their caches. Neighbours are computed twice, with the same
//! operations on the same numbers: the result has the same bits for any number of threads.

pub mod friction;
pub mod impulse;
pub mod kernel;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::tube::model::{Constants, Impact};
use friction::{Coulomb, Friction, Smoothed};
use kernel::{MOST_REACH, Nodes, STATE, StepConstants, step};

/// Accuracy of the space differences.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Order {
    /// Error of order Δφ².
    Second,
    /// Error of order Δφ⁴.
    #[default]
    Fourth,
    /// Error of order Δφ⁶.
    Sixth,
}

impl Order {
    pub(crate) fn reach(self) -> usize {
        match self {
            Order::Second => 1,
            Order::Fourth => 2,
            Order::Sixth => 3,
        }
    }

    /// Weights of the second difference, from the node outwards.
    fn second(self) -> [f64; MOST_REACH + 1] {
        match self {
            Order::Second => [-2.0, 1.0, 0.0, 0.0],
            Order::Fourth => [-2.5, 4.0 / 3.0, -1.0 / 12.0, 0.0],
            Order::Sixth => [-49.0 / 18.0, 1.5, -0.15, 1.0 / 90.0],
        }
    }

    /// Weights of the first difference, right minus left, from the nearest neighbour outwards.
    fn first(self) -> [f64; MOST_REACH] {
        match self {
            Order::Second => [0.5, 0.0, 0.0],
            Order::Fourth => [2.0 / 3.0, -1.0 / 12.0, 0.0],
            Order::Sixth => [0.75, -0.15, 1.0 / 60.0],
        }
    }
}

/// The friction law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Law", deny_unknown_fields)]
pub enum RingLaw {
    /// Set-valued, see [`Coulomb`].
    #[default]
    #[serde(rename = "SetValued")]
    Coulomb,
    /// Smoothed with tanh, see [`Smoothed`].
    #[serde(rename = "Tanh")]
    Smoothed {
        /// Width ε of the transition.
        epsilon: f64,
    },
}

/// Grid and steps of a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingSetup {
    /// Number of points N.
    pub points: usize,
    /// Length of the ring as an angle: 2π, or a wavelength; its ends are joined.
    pub angle: f64,
    /// Accuracy of the space differences.
    pub order: Order,
    /// Time step Δt in units of 1/Ω.
    pub time_step: f64,
    /// Friction law.
    pub law: RingLaw,
    /// What a landing does to V̇ for β = 0; with β > 0 there is no impact.
    pub impact: Impact,
    /// Whether account of work is kept.
    pub watched: bool,
}

/// Fewest points: differences must not reach round the ring.
pub(crate) const LEAST_POINTS: usize = 2 * MOST_REACH + 1;

/// Part of the limit of linear stability that a time step may take. The limit itself is exact for
/// the free ring; contact and friction only take energy out, landing moves a node by less than a step.
pub const LARGEST_PART: f64 = 0.98;

/// Why there is no ring.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RingSetupError {
    /// Too few points.
    #[error("a ring of {0} points is too coarse; take at least {LEAST_POINTS}")]
    Points(usize),
    /// A state that is none of this ring.
    #[error("its lists do not all have a finite number for every point of the ring")]
    State,
    /// The time step is not positive, or too large.
    #[error("the time step {step:e} must lie between 0 and {limit:e}, where the scheme is stable")]
    Step {
        /// The step asked for.
        step: f64,
        /// Largest stable step.
        limit: f64,
    },
}

/// A ring in motion.
#[derive(Clone, Debug)]
pub struct Ring {
    parameters: Constants,
    setup: RingSetup,
    constants: StepConstants,
    nodes: Nodes,
    steps: u64,
    /// Steps and time when the time step was changed last.
    since: (u64, f64),
    stretches: Vec<Stretch>,
    depth: usize,
}

/// Age of a contact that nobody saw begin.
const LONG_AGO: f64 = f64::MAX;

/// A piece of the ring that is worked on by itself.
#[derive(Clone, Debug)]
struct Stretch {
    from: usize,
    to: usize,
    nodes: Nodes,
    next: [Vec<f64>; 4],
}

/// Points of a stretch: its arrays stay in the second-level cache, and a block of steps takes long
/// enough (50 µs and more) for handing it to another thread to cost little.
const STRETCH: usize = 1024;

/// Steps of a block, at most; a stretch must be several times as long.
const DEPTH: usize = 48;

fn spacing(points: usize, angle: f64) -> f64 {
    angle / points as f64
}

/// The largest stable time step: √(4β² + 4/ω²) − 2β for the fastest motion of the grid (see [`impulse`]),
/// 2/ω for β = 0; ω² is bounded by the largest sum of absolute values in a row of the stiffness.
pub fn stable_step(parameters: &Constants, points: usize, angle: f64, order: Order) -> f64 {
    let c = parameters.coefficients;
    let width = spacing(points, angle);
    let second: f64 = order
        .second()
        .iter()
        .enumerate()
        .map(|(k, weight)| weight.abs() * if k == 0 { 1.0 } else { 2.0 })
        .sum();
    let first: f64 = order.first().iter().map(|weight| 2.0 * weight.abs()).sum();
    let coupling = c.coupling.abs() * first / width;
    let radial = c.b * second / (width * width) + c.g + coupling;
    let tangential = c.a * second / (width * width) + c.h + coupling;
    let beta = parameters.stiffness_damping;
    if beta > 0.0 {
        // friction joins neighbours through the pressure
        let joined = tangential + coupling.abs() * (parameters.friction - 1.0).max(0.0);
        return with_diffusion(2.0 / radial.max(joined).sqrt(), beta);
    }
    2.0 / radial.max(tangential).sqrt()
}

/// √(4β² + s²) − 2β, without cancellation: what β makes of a step s.
pub(crate) fn with_diffusion(step: f64, beta: f64) -> f64 {
    let ratio = 2.0 * beta / step;
    step / (1.0_f64.hypot(ratio) + ratio)
}

/// The time step of a Courant number: this part of √(4β² + Δφ²/a) − 2β, where order 2 becomes
/// unstable. That is √a Δt/Δφ for β = 0, and 4βaΔt/Δφ² where diffusion sets the limit.
pub fn courant_step(parameters: &Constants, points: usize, angle: f64, courant: f64) -> f64 {
    let free = spacing(points, angle) / parameters.coefficients.a.sqrt();
    courant * with_diffusion(free, parameters.stiffness_damping)
}

/// Numbers of a step whose rates are `kick` apart.
fn constants(parameters: &Constants, setup: &RingSetup, kick: f64) -> StepConstants {
    let c = parameters.coefficients;
    let width = spacing(setup.points, setup.angle);
    let half = 0.5 * parameters.mass_damping * kick;
    let second = setup.order.second();
    StepConstants {
        b: second.map(|weight| c.b * weight / (width * width)),
        a: second.map(|weight| c.a * weight / (width * width)),
        coupling: setup
            .order
            .first()
            .map(|weight| c.coupling * weight / width),
        g: c.g,
        h: c.h,
        rest: c.g * parameters.mismatch,
        mismatch: parameters.mismatch,
        friction: parameters.friction,
        dt: setup.time_step,
        kick,
        keep: 1.0 - half,
        gain: 1.0 / (1.0 + half),
        material: parameters.stiffness_damping,
        window: width / (c.a.sqrt() * setup.time_step),
    }
}

impl Ring {
    /// A ring at rest in steady sliding: U = δ, V = δfg/h, V̇ = 0.
    pub fn new(parameters: &Constants, setup: RingSetup) -> Result<Ring, RingSetupError> {
        if setup.points < LEAST_POINTS {
            return Err(RingSetupError::Points(setup.points));
        }
        let limit = LARGEST_PART * stable_step(parameters, setup.points, setup.angle, setup.order);
        let dt = setup.time_step;
        if !(dt > 0.0 && dt <= limit) {
            return Err(RingSetupError::Step { step: dt, limit });
        }
        let c = parameters.coefficients;
        let constants = constants(parameters, &setup, dt);
        let concentrated = parameters.stiffness_damping > 0.0 || setup.impact == Impact::Coulomb;
        let mut nodes = Nodes::new(setup.points, setup.watched, concentrated);
        nodes.radial.fill(parameters.mismatch);
        nodes.effective_radial.fill(parameters.mismatch);
        nodes.age.fill(LONG_AGO);
        nodes
            .tangential
            .fill(parameters.mismatch * parameters.friction * c.g / c.h);
        nodes.share.fill(1.0);
        nodes
            .effective
            .fill(parameters.mismatch * parameters.friction * c.g / c.h);
        let count = setup.points.div_ceil(STRETCH);
        let depth = DEPTH.min(setup.points / count / 12).max(1);
        let margin = depth * setup.order.reach();
        let stretches = (0..count)
            .map(|index| {
                let from = index * setup.points / count;
                let to = (index + 1) * setup.points / count;
                let size = to - from + 2 * margin;
                Stretch {
                    from,
                    to,
                    nodes: Nodes::new(size, setup.watched, concentrated),
                    next: [true, true, concentrated, concentrated]
                        .map(|used| vec![0.0; if used { size } else { 0 }]),
                }
            })
            .collect();
        Ok(Ring {
            parameters: *parameters,
            setup,
            constants,
            nodes,
            steps: 0,
            since: (0, 0.0),
            stretches,
            depth,
        })
    }

    /// What the ring was made of.
    pub fn constants(&self) -> &Constants {
        &self.parameters
    }

    /// Grid and steps.
    pub fn setup(&self) -> &RingSetup {
        &self.setup
    }

    /// Distance of neighbouring points.
    pub fn spacing(&self) -> f64 {
        spacing(self.setup.points, self.setup.angle)
    }

    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    /// Time since the start.
    pub fn time(&self) -> f64 {
        let (steps, time) = self.since;
        time + (self.steps - steps) as f64 * self.setup.time_step
    }

    /// Goes on with a shorter time step, and takes the first one: the rates stand half an old step
    /// before the instant, so that the mean of both steps brings them half a new one beyond it.
    pub(crate) fn shorten(&mut self, time_step: f64) {
        self.since = (self.steps, self.time());
        let mean = 0.5 * (self.setup.time_step + time_step);
        self.setup.time_step = time_step;
        self.constants = constants(&self.parameters, &self.setup, mean);
        self.advance(1);
        self.constants = constants(&self.parameters, &self.setup, time_step);
    }

    /// U and V at the time of the ring; rates half a step earlier.
    pub fn nodes(&self) -> &Nodes {
        &self.nodes
    }

    /// Goes on from these nodes after `steps` steps.
    ///
    /// # Errors
    /// When they are not as many as those of the ring, or not finite.
    pub fn resume(&mut self, nodes: Nodes, steps: u64) -> Result<(), RingSetupError> {
        if !nodes.fits(&self.nodes) {
            return Err(RingSetupError::State);
        }
        self.nodes = nodes;
        self.steps = steps;
        Ok(())
    }

    /// Puts a point where it is to begin: U, V, and their rates half a step before. U ≤ δ means
    /// contact.
    pub fn place(&mut self, point: usize, [u, v, u_rate, v_rate]: [f64; 4]) {
        let contact = u <= self.parameters.mismatch;
        self.nodes.radial[point] = u.max(self.parameters.mismatch);
        self.nodes.tangential[point] = v;
        self.nodes.radial_rate[point] = if contact { 0.0 } else { u_rate };
        self.nodes.tangential_rate[point] = v_rate;
        self.nodes.share[point] = if contact { 1.0 } else { 0.0 };
        // half a step of Ü and V̈ is lost, for one step: an error of second order
        let beta = self.constants.material;
        if let Some(effective) = self.nodes.effective.get_mut(point) {
            *effective = v + beta * v_rate;
            self.nodes.effective_radial[point] =
                self.nodes.radial[point] + beta * self.nodes.radial_rate[point];
            self.nodes.impulse[point] = 0.0;
            self.nodes.age[point] = if contact { LONG_AGO } else { 0.0 };
        }
    }

    /// Adds to V and V̇ of a point.
    pub fn push(&mut self, point: usize, v: f64, v_rate: f64) {
        self.nodes.tangential[point] += v;
        self.nodes.tangential_rate[point] += v_rate;
        if let Some(effective) = self.nodes.effective.get_mut(point) {
            *effective += v + self.constants.material * v_rate;
        }
    }

    /// V̂ of the points.
    fn effective(&self) -> &[f64] {
        if self.nodes.effective.is_empty() {
            &self.nodes.tangential
        } else {
            &self.nodes.effective
        }
    }

    /// Takes a number of steps.
    pub fn advance(&mut self, steps: u64) {
        let mut left = steps;
        while left > 0 {
            let block = left.min(self.depth as u64);
            match self.setup.law {
                RingLaw::Coulomb => self.block(Coulomb, block as usize),
                RingLaw::Smoothed { epsilon } => self.block(Smoothed { epsilon }, block as usize),
            }
            left -= block;
        }
        self.steps += steps;
    }

    fn block<F: Friction>(&mut self, law: F, steps: usize) {
        match (self.setup.order, self.setup.watched) {
            (Order::Second, false) => self.block_of::<1, false, F>(law, steps),
            (Order::Second, true) => self.block_of::<1, true, F>(law, steps),
            (Order::Fourth, false) => self.block_of::<2, false, F>(law, steps),
            (Order::Fourth, true) => self.block_of::<2, true, F>(law, steps),
            (Order::Sixth, false) => self.block_of::<3, false, F>(law, steps),
            (Order::Sixth, true) => self.block_of::<3, true, F>(law, steps),
        }
    }

    fn block_of<const R: usize, const WATCHED: bool, F: Friction>(&mut self, law: F, steps: usize) {
        let (nodes, constants) = (&self.nodes, &self.constants);
        let work = |stretch: &mut Stretch| {
            stretch.load(nodes, R * steps);
            // the widest vector registers of the machine; no operation is contracted or reordered
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || stretch.run::<R, WATCHED, F>(constants, law, steps),
            );
        };
        if self.stretches.len() == 1 {
            self.stretches.iter_mut().for_each(work);
        } else {
            self.stretches.par_iter_mut().for_each(work);
        }
        for stretch in &self.stretches {
            stretch.store(&mut self.nodes, R * steps);
        }
    }

    /// Energy of the ring, see the module.
    pub fn energy(&self) -> f64 {
        let nodes = &self.nodes;
        let count = nodes.count();
        let reach = self.setup.order.reach();
        let c = &self.constants;
        let dt = c.dt;
        let mut energy = 0.0;
        for i in 0..count {
            let (rate_u, rate_v) = (nodes.radial_rate[i], nodes.tangential_rate[i]);
            let (u, v) = (nodes.radial[i], nodes.tangential[i]);
            // where the node was one step before
            let (before_u, before_v) = (u - dt * rate_u, v - dt * rate_v);
            let mut force_u = c.b[0] * u - c.g * u;
            let mut force_v = c.a[0] * v - c.h * v;
            for k in 1..=reach {
                let (left, right) = ((i + count - k) % count, (i + k) % count);
                force_u += c.b[k] * (nodes.radial[left] + nodes.radial[right])
                    + c.coupling[k - 1] * (nodes.tangential[right] - nodes.tangential[left]);
                force_v += c.a[k] * (nodes.tangential[left] + nodes.tangential[right])
                    - c.coupling[k - 1] * (nodes.radial[right] - nodes.radial[left]);
            }
            energy += 0.5 * (rate_u * rate_u + rate_v * rate_v)
                - 0.5 * (before_u * force_u + before_v * force_v);
        }
        energy * self.spacing()
    }

    /// Work since the start of friction, contact and damping, where account is kept.
    pub fn work(&self) -> [f64; 3] {
        let sum = |ledger: &[f64]| ledger.iter().sum::<f64>() * self.spacing();
        [
            sum(&self.nodes.friction_work),
            sum(&self.nodes.contact_work),
            sum(&self.nodes.damping_work),
        ]
    }

    /// Shear that keeps V̈ = 0 at V̇ = 1: Q = α − a∂²V̂ + D∂U + hV̂.
    pub(crate) fn holding_shear(&self, point: usize) -> f64 {
        let (nodes, effective) = (&self.nodes, self.effective());
        let count = nodes.count();
        let c = &self.constants;
        let mut shear = self.parameters.mass_damping + (c.h - c.a[0]) * effective[point];
        for k in 1..=self.setup.order.reach() {
            let (left, right) = ((point + count - k) % count, (point + k) % count);
            shear += c.coupling[k - 1] * (nodes.radial[right] - nodes.radial[left])
                - c.a[k] * (effective[left] + effective[right]);
        }
        shear
    }

    /// Contact pressure of a point, zero in the air: P = gδ − D∂V̂, and what is handed out of a concentrated
    /// part, see [`impulse`].
    pub fn pressure(&self, point: usize) -> f64 {
        if self.nodes.share[point] == 0.0 {
            return 0.0;
        }
        let effective = self.effective();
        let count = effective.len();
        let c = &self.constants;
        let slope: f64 = (1..=self.setup.order.reach())
            .map(|k| {
                let (left, right) = ((point + count - k) % count, (point + k) % count);
                c.coupling[k - 1] * (effective[right] - effective[left])
            })
            .sum();
        let mut pressure = c.rest - slope;
        if let Some(hat) = self.nodes.effective_radial.get(point) {
            let hats = &self.nodes.effective_radial;
            let bend = (1..=self.setup.order.reach()).fold(c.b[0] * hat, |bend, k| {
                let (left, right) = ((point + count - k) % count, (point + k) % count);
                bend + c.b[k] * (hats[left] + hats[right])
            });
            let (impulse, age) = (self.nodes.impulse[point], self.nodes.age[point]);
            let part = if age == 0.0 {
                self.nodes.share[point]
            } else {
                1.0
            };
            pressure += impulse::release(c.window, impulse - c.kick * bend, age, part) / c.kick;
        }
        // what would be tension ends the contact with the next step
        pressure.max(0.0)
    }
}

impl Stretch {
    /// Copies the stretch with `margin` neighbours on either side; of work, what the core has done.
    fn load(&mut self, ring: &Nodes, margin: usize) {
        let (from, to) = (self.from, self.to);
        let lists = self.nodes.lists_mut().into_iter().zip(ring.lists());
        for (index, (here, there)) in lists.enumerate() {
            let count = there.len();
            if count == 0 {
                continue;
            }
            let end = margin + to - from;
            here[margin..end].copy_from_slice(&there[from..to]);
            if index < STATE {
                for (k, value) in here[..margin].iter_mut().enumerate() {
                    *value = there[(from + (margin / count + 1) * count + k - margin) % count];
                }
                for (k, value) in here[end..end + margin].iter_mut().enumerate() {
                    *value = there[(to + k) % count];
                }
            }
        }
    }

    /// Takes the stretch through the steps; what is known shrinks by `R` on either side per step.
    #[inline(always)]
    fn run<const R: usize, const WATCHED: bool, F: Friction>(
        &mut self,
        constants: &StepConstants,
        law: F,
        steps: usize,
    ) {
        let size = self.to - self.from + 2 * R * steps;
        for done in 1..=steps {
            let nodes = &mut self.nodes;
            let (from, to) = (R * done, size - R * done);
            let next = self.next.each_mut().map(|list| &mut list[..]);
            if nodes.effective.is_empty() {
                step::<R, WATCHED, false, F>(constants, law, nodes, next, from, to);
            } else {
                step::<R, WATCHED, true, F>(constants, law, nodes, next, from, to);
            }
            let moved = [
                &mut nodes.radial,
                &mut nodes.tangential,
                &mut nodes.effective_radial,
                &mut nodes.effective,
            ];
            for (list, next) in moved.into_iter().zip(&mut self.next) {
                std::mem::swap(list, next);
            }
        }
    }

    fn store(&self, ring: &mut Nodes, margin: usize) {
        let (from, to) = (self.from, self.to);
        let core = margin..margin + to - from;
        for (there, here) in ring.lists_mut().into_iter().zip(self.nodes.lists()) {
            if !there.is_empty() {
                there[from..to].copy_from_slice(&here[core.clone()]);
            }
        }
    }
}
