//! One step of every node.
//!
//! Leapfrog: U, V at the instant n, their rates at n − ½. With ∂ and ∂² the central differences,
//!
//! ```text
//! U̇ⁿ⁺½ = [(1 − αΔt/2) U̇ⁿ⁻½ + Δt (b∂²U + D∂V − gU)ⁿ] / (1 + αΔt/2)      where U > δ
//! V̇ⁿ⁺½ = [(1 − αΔt/2) V̇ⁿ⁻½ + Δt (a∂²V − D∂U − hV + Q)ⁿ] / (1 + αΔt/2)
//! Uⁿ⁺¹ = Uⁿ + Δt U̇ⁿ⁺½,   Vⁿ⁺¹ = Vⁿ + Δt V̇ⁿ⁺½.
//! ```
//!
//! **Contact.** A node in contact has U = δ and U̇ = 0 and stays as long as P = gδ − D∂V ≥ 0. This is the
//! reaction of a stretch in contact. The term b∂²U of a neighbour that is still in the air does not
//! enter: it would throw a landed node up again with b/(2c²) of its velocity at every resolution,
//! where the law wants rest. When P < 0 the node is free from this step on. A free node whose next
//! U lies below δ lands: U becomes δ, its velocity is lost.
//!
//! **Instants within a step.** A node that lands after the share s of the step from n to n + 1 is in
//! contact for 3/2 − s steps by the time n + 3/2, so that friction gets that share of its next step.
//! Without it every landing would come half a step late on average. The true V is then ahead by
//! ½(1 − s)²Δt² times the acceleration by friction, which is added. Crossings of V̇ = 1 are in
//! [`super::friction`].
//!
//! Every statement is a selection between values, so that the loop has no branches and uses vector
//! registers. There is no sum over nodes: the result does not depend on how the ring is cut up.

use serde::{Deserialize, Serialize};

use super::friction::Friction;
use super::impulse::release;

/// Most neighbours on either side that a difference reaches to.
pub(crate) const MOST_REACH: usize = 3;

/// Numbers of the step, the same for all nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepConstants {
    /// Radial wave: b/Δφ² times the weights of the second difference, from the node outwards.
    pub b: [f64; MOST_REACH + 1],
    /// Tangential wave: a/Δφ² times the weights of the second difference.
    pub a: [f64; MOST_REACH + 1],
    /// Coupling: D/Δφ times the weights of the first difference.
    pub coupling: [f64; MOST_REACH],
    /// Radial stiffness.
    pub g: f64,
    /// Tangential stiffness.
    pub h: f64,
    /// gδ, the pressure of rest.
    pub rest: f64,
    /// Mismatch δ.
    pub mismatch: f64,
    /// Friction coefficient f.
    pub friction: f64,
    /// Time step.
    pub dt: f64,
    /// Time from the rates before a step to those after it: Δt, and where the step changes the mean
    /// of both.
    pub kick: f64,
    /// 1 − α/2 times `kick`.
    pub keep: f64,
    /// 1/(1 + α/2 times `kick`).
    pub gain: f64,
    /// Material damping β.
    pub material: f64,
    /// Steps over which a concentrated reaction is handed out, see [`super::impulse`].
    pub window: f64,
}

/// Nodes side by side, one array per quantity.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Nodes {
    /// U at n.
    pub radial: Vec<f64>,
    /// V at n.
    pub tangential: Vec<f64>,
    /// V̂ = V + βV̇ at n; empty where reactions have no concentrated part with friction, and so are the
    /// next three.
    #[serde(default)]
    pub effective: Vec<f64>,
    /// Û = U + βU̇ at n.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub effective_radial: Vec<f64>,
    /// Concentrated reaction that has not yet acted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub impulse: Vec<f64>,
    /// Steps since landing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub age: Vec<f64>,
    /// U̇ at n − ½.
    pub radial_rate: Vec<f64>,
    /// V̇ at n − ½.
    pub tangential_rate: Vec<f64>,
    /// Share of the next step that friction acts: 0 in the air, 1 in contact, ½ to 3/2 just landed.
    pub share: Vec<f64>,
    /// Work of friction since the start, per unit of mass of the node; empty when not watched.
    pub friction_work: Vec<f64>,
    /// Work of contact, which is what landings dissipate; empty when not watched.
    pub contact_work: Vec<f64>,
    /// Work of mass and material damping; empty when not watched.
    pub damping_work: Vec<f64>,
}

/// Lists of [`Nodes`], and how many of them, the first, are its state; the others are accounts of work.
const LISTS: usize = 12;
pub(super) const STATE: usize = 9;

impl Nodes {
    /// Zeros; `concentrated` says whether reactions have such a part with friction.
    pub fn new(count: usize, watched: bool, concentrated: bool) -> Nodes {
        let zeros = || vec![0.0; count];
        let some = || vec![0.0; if concentrated { count } else { 0 }];
        let ledger = || vec![0.0; if watched { count } else { 0 }];
        Nodes {
            radial: zeros(),
            tangential: zeros(),
            effective: some(),
            effective_radial: some(),
            impulse: some(),
            age: some(),
            radial_rate: zeros(),
            tangential_rate: zeros(),
            share: zeros(),
            friction_work: ledger(),
            contact_work: ledger(),
            damping_work: ledger(),
        }
    }

    /// All quantities, accounts of work last.
    pub(super) fn lists(&self) -> [&Vec<f64>; LISTS] {
        [
            &self.radial,
            &self.tangential,
            &self.effective,
            &self.effective_radial,
            &self.impulse,
            &self.age,
            &self.radial_rate,
            &self.tangential_rate,
            &self.share,
            &self.friction_work,
            &self.contact_work,
            &self.damping_work,
        ]
    }

    /// The same to write to.
    pub(super) fn lists_mut(&mut self) -> [&mut Vec<f64>; LISTS] {
        [
            &mut self.radial,
            &mut self.tangential,
            &mut self.effective,
            &mut self.effective_radial,
            &mut self.impulse,
            &mut self.age,
            &mut self.radial_rate,
            &mut self.tangential_rate,
            &mut self.share,
            &mut self.friction_work,
            &mut self.contact_work,
            &mut self.damping_work,
        ]
    }

    /// Whether there are as many of every quantity as there are of the other, all of them finite.
    pub(crate) fn fits(&self, other: &Nodes) -> bool {
        let mut pairs = self.lists().into_iter().zip(other.lists());
        pairs.all(|(one, other)| one.len() == other.len() && one.iter().all(|x| x.is_finite()))
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.radial.len()
    }
}

/// The values at the nodes `from..to` and at their neighbours −R … R, window k being that of
/// neighbour k − R: slices of one length each, so that no access is checked within a loop over them.
#[inline(always)]
pub(super) fn windows<const R: usize>(values: &[f64], from: usize, to: usize) -> [&[f64]; 7] {
    let values = &values[from - R..to + R];
    std::array::from_fn(|k| {
        let k = k.min(2 * R);
        &values[k..k + (to - from)]
    })
}

/// The second difference with the weights `second` and the first with the weights `first`.
#[inline(always)]
pub(super) fn differences<const R: usize>(
    values: &[&[f64]; 7],
    i: usize,
    second: &[f64],
    first: &[f64],
) -> [f64; 2] {
    let (mut bend, mut slope) = (second[0] * values[R][i], 0.0);
    for k in 1..=R {
        let (left, right) = (values[R - k][i], values[R + k][i]);
        bend += second[k] * (left + right);
        slope += first[k - 1] * (right - left);
    }
    [bend, slope]
}

/// The part `from..to` of a list that is kept; nothing of one that is not.
#[inline(always)]
fn kept(is_kept: bool, list: &mut [f64], from: usize, to: usize) -> &mut [f64] {
    if is_kept {
        &mut list[from..to]
    } else {
        &mut []
    }
}

/// Takes the nodes `from..to` of a stretch through one step. U, V, Û and V̂ of the next instant go to
/// `next`; the nodes within `R` of the range are read. `WATCHED` keeps account of work; `CONCENTRATED`
/// says that reactions have such a part with friction, see [`super::impulse`]: without it Û is U and V̂
/// is V.
#[inline(always)]
pub(crate) fn step<const R: usize, const WATCHED: bool, const CONCENTRATED: bool, F: Friction>(
    constants: &StepConstants,
    law: F,
    nodes: &mut Nodes,
    next: [&mut [f64]; 4],
    from: usize,
    to: usize,
) {
    let c = *constants;
    let count = to - from;
    let u = windows::<R>(&nodes.radial, from, to);
    let v = windows::<R>(&nodes.tangential, from, to);
    let (hat_u, hat_v) = if CONCENTRATED {
        (
            windows::<R>(&nodes.effective_radial, from, to),
            windows::<R>(&nodes.effective, from, to),
        )
    } else {
        (u, v)
    };
    let radial_rate = &mut nodes.radial_rate[from..to];
    let tangential_rate = &mut nodes.tangential_rate[from..to];
    let share = &mut nodes.share[from..to];
    let impulse = kept(CONCENTRATED, &mut nodes.impulse, from, to);
    let age = kept(CONCENTRATED, &mut nodes.age, from, to);
    let friction_work = kept(WATCHED, &mut nodes.friction_work, from, to);
    let contact_work = kept(WATCHED, &mut nodes.contact_work, from, to);
    let damping_work = kept(WATCHED, &mut nodes.damping_work, from, to);
    let [radial, tangential, effective_radial, effective] = next;
    let (radial, tangential) = (&mut radial[from..to], &mut tangential[from..to]);
    let effective_radial = kept(CONCENTRATED, effective_radial, from, to);
    let effective = kept(CONCENTRATED, effective, from, to);
    for i in 0..count {
        let [bend_u, slope_u] = differences::<R>(&hat_u, i, &c.b, &c.coupling);
        let [bend_v, slope_v] = differences::<R>(&hat_v, i, &c.a, &c.coupling);
        let force_u = bend_u + slope_v - c.g * hat_u[R][i];
        let force_v = bend_v - slope_u - c.h * hat_v[R][i];

        let (u0, touched) = (u[R][i], share[i]);
        let touches = touched != 0.0;
        let pressure = c.rest - slope_v;
        let (handed_out, old_age) = if CONCENTRATED {
            (impulse[i], age[i])
        } else {
            (0.0, 0.0)
        };
        let concentrated = handed_out - c.kick * bend_u;
        let part = if old_age == 0.0 { touched } else { 1.0 };
        let released = release(c.window, concentrated, old_age, part);
        let reaction = c.kick * touched * pressure + released;
        let pushes = if CONCENTRATED { reaction } else { pressure };
        let holds = touches & (pushes >= 0.0);

        // an impact has left a node that touches without velocity, whatever its last step was
        let was = radial_rate[i];
        let before = if touches { 0.0 } else { was };
        let free_rate = c.gain * (c.keep * before + c.kick * force_u);
        let moved = c.dt * free_rate;
        let free = u0 + moved;
        let lands = !holds & (free < c.mismatch);
        let drop = c.mismatch - u0;
        let rate = if holds {
            0.0
        } else if lands {
            drop / c.dt
        } else {
            free_rate
        };
        let rests = holds | lands;
        radial[i] = if rests { c.mismatch } else { free };
        let landed = 1.5 - drop / moved;
        share[i] = if holds {
            1.0
        } else if lands {
            landed
        } else {
            0.0
        };
        radial_rate[i] = rate;
        if CONCENTRATED {
            effective_radial[i] = if rests {
                c.mismatch
            } else {
                free + c.material * (1.5 * free_rate - 0.5 * before)
            };
            impulse[i] = if holds {
                concentrated - released
            } else if lands {
                // the velocity at the instant, not in the middle of the step
                (c.kick * (1.0 - landed) * pressure - free_rate / c.gain).max(0.0)
            } else {
                0.0
            };
            age[i] = if holds { old_age + part } else { 0.0 };
        }

        let old = tangential_rate[i];
        let change = c.gain * (c.keep * old + c.kick * force_v) - old;
        let most = if CONCENTRATED {
            c.gain * c.friction * reaction
        } else {
            c.gain * c.kick * touched * c.friction * pressure
        };
        let most = if holds { most } else { 0.0 };
        let (slid, kink) = law.slide(old - 1.0, change, most);
        let new = 1.0 + slid;
        let given = new - old - change;
        // friction that began within the last step
        let late = touched - 0.5;
        let begun = 0.5 * given / touched * (late * late);
        let begun = if holds & (touched != 1.0) { begun } else { 0.0 };
        // what was concentrated and ends within this one, unless the node sticks
        let left = c.window - old_age;
        let ends = holds & (old_age > 0.0) & (left > 0.0) & (left < 1.0) & (slid != 0.0);
        let late = left - 0.5;
        let ended = 0.5 * given * (handed_out / reaction) / left * (late * late);
        let ends = CONCENTRATED & ends & (reaction > 0.0);
        let bent = kink + begun - if ends { ended } else { 0.0 };
        let shifted = v[R][i] + c.dt * (new + bent);
        tangential_rate[i] = new;
        tangential[i] = shifted;
        if CONCENTRATED {
            effective[i] = shifted + c.material * (1.5 * new - 0.5 * old);
        }

        if WATCHED {
            // forces are what is missing between the velocity without and with them
            let (mean_u, mean_v) = (0.5 * (was + rate), 0.5 * (old + new));
            let alone = c.gain * (c.keep * was + c.kick * force_u);
            contact_work[i] += (rate - alone) / c.gain * mean_u;
            // αΔt = 1/gain − keep
            let alpha = 1.0 / c.gain - c.keep;
            let (elastic_v, damping) = if CONCENTRATED {
                let [bend_u, slope_u] = differences::<R>(&u, i, &c.b, &c.coupling);
                let [bend_v, slope_v] = differences::<R>(&v, i, &c.a, &c.coupling);
                let elastic_u = bend_u + slope_v - c.g * u0;
                let elastic_v = bend_v - slope_u - c.h * v[R][i];
                let damping_u = (c.kick * (force_u - elastic_u) - alpha * mean_u) * mean_u;
                let damping_v = (c.kick * (force_v - elastic_v) - alpha * mean_v) * mean_v;
                (elastic_v, damping_u + damping_v)
            } else {
                (force_v, -alpha * (mean_v * mean_v + mean_u * mean_u))
            };
            damping_work[i] += damping;
            // moving the node by what is bent does work against the elastic force
            friction_work[i] += given / c.gain * mean_v - c.dt * bent * elastic_v;
        }
    }
}
