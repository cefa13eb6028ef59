//! One step of every node where reactions have a concentrated part that carries friction: material
//! damping β > 0, and Coulomb impacts for β = 0.
//!
//! Stiffness acts on Û = U + βU̇ and V̂ = V + βV̇. Leapfrog has the rates half a step before and after the
//! instant n, and forces are due at n: rates there are extrapolated from the two half-steps before,
//!
//! ```text
//! V̇ⁿ⁺½ = [(1 − αΔt/2) V̇ⁿ⁻½ + Δt (a∂²V̂ − D∂Û − hV̂ + Q)ⁿ] / (1 + αΔt/2),
//! Vⁿ⁺¹ = Vⁿ + Δt V̇ⁿ⁺½,   V̂ⁿ⁺¹ = Vⁿ⁺¹ + β(3V̇ⁿ⁺½ − V̇ⁿ⁻½)/2,
//! ```
//!
//! of second order in Δt where the rates have no jump, and so for U in the air. A node keeps Û and V̂ of the
//! instant, which is all that its neighbours read, so that a step remains explicit and its reach that of
//! the differences.
//!
//! **Time step.** A free motion of frequency ω turns into μ in a step, with p = Δt²ω² and q = βΔtω²
//!
//! ```text
//! μ(μ − 1)² + pμ² + ½q(3μ − 1)(μ − 1) = 0,
//! ```
//!
//! which leaves the unit circle at μ = −1 where p + 4q = 4: Δt = √(4β² + 4/ω²) − 2β, the Courant limit
//! 2/ω for β = 0, and 1/(βω²), about Δφ²/(4βa), where β is large or the grid is fine.
//!
//! **Reaction.** A node in contact has U = δ and U̇ = 0, and needs the reaction P = gδ − D∂V̂ − b∂²Û for it. The
//! last term is what neighbours in the air exert. Towards a landing it is concentrated, and together
//! with the velocity that the node loses by Newton's law without restitution it amounts to
//!
//! ```text
//! Δφ Σ P Δt → m_b|U̇⁻|, m_b = 1 − b/c²  (β = 0),      (βb/c²)Ü⁻  (β > 0)
//! ```
//!
//! for a front of speed c that nobody has to know: half of b/c² has slowed the node down before it
//! landed, half pulls at it until the next one lands. Friction may take f times as much, and the waves
//! of V make m_a[V̇] of it. As β and Δφ fall in whatever order, the law of the landing is that of Coulomb.
//!
//! The pull of a falling neighbour must not throw a landed node up again, and friction must last until
//! the neighbours that lag behind have landed as well: a node that is held at V̇ = 1 for one step only is torn
//! off it. So what is concentrated is handed out evenly over the time Δφ/√a from landing on, longer than
//! any front that is faster than these waves takes to the next node. It is an error of the first order
//! in Δφ. From then on b∂²Û acts at once: without it, nodes before a take-off would not know that the
//! pressure is to vanish.
//!
//! Instants within a step are those of [`super::kernel`] and [`super::friction`].

use super::friction::Friction;
use super::kernel::{Nodes, StepConstants, differences, windows};

/// What is handed out in a step of an impulse that has been handed out for `age` steps; the node is
/// touched for the part `touched` of its first step, 1 in all others.
#[inline(always)]
pub(super) fn release(constants: &StepConstants, impulse: f64, age: f64, touched: f64) -> f64 {
    let left = constants.window - age;
    if left > touched {
        impulse * (touched / left)
    } else {
        impulse
    }
}

/// Takes the nodes `from..to` of a stretch through one step. U, V, Û and V̂ of the next instant go to
/// `next`; Û and V̂ of the nodes within `R` of the range are read, and U and V if account is kept.
#[inline(always)]
pub(crate) fn step<const R: usize, const WATCHED: bool, F: Friction>(
    constants: &StepConstants,
    law: F,
    nodes: &mut Nodes,
    next: &mut [Vec<f64>; 4],
    from: usize,
    to: usize,
) {
    let c = *constants;
    let count = to - from;
    let hat_u = windows::<R>(&nodes.effective_radial, from, to);
    let hat_v = windows::<R>(&nodes.effective, from, to);
    let u = windows::<R>(&nodes.radial, from, to);
    let v = windows::<R>(&nodes.tangential, from, to);
    let radial_rate = &mut nodes.radial_rate[from..to];
    let tangential_rate = &mut nodes.tangential_rate[from..to];
    let share = &mut nodes.share[from..to];
    let impulse = &mut nodes.impulse[from..to];
    let age = &mut nodes.age[from..to];
    let [radial, tangential, effective_radial, effective] = next;
    let (effective_radial, effective) = (&mut effective_radial[from..to], &mut effective[from..to]);
    let (radial, tangential) = (&mut radial[from..to], &mut tangential[from..to]);
    let (friction_work, contact_work, damping_work) = if WATCHED {
        (
            &mut nodes.friction_work[from..to],
            &mut nodes.contact_work[from..to],
            &mut nodes.damping_work[from..to],
        )
    } else {
        (&mut [][..], &mut [][..], &mut [][..])
    };
    for i in 0..count {
        let [bend_u, slope_u] = differences::<R>(&hat_u, i, &c.b, &c.coupling);
        let [bend_v, slope_v] = differences::<R>(&hat_v, i, &c.a, &c.coupling);
        let force_u = bend_u + slope_v - c.g * hat_u[R][i];
        let force_v = bend_v - slope_u - c.h * hat_v[R][i];

        let (u0, touched, old_age) = (u[R][i], share[i], age[i]);
        let touches = touched != 0.0;
        let handed_out = impulse[i];
        let concentrated = handed_out - c.kick * bend_u;
        let part = if old_age == 0.0 { touched } else { 1.0 };
        let released = release(&c, concentrated, old_age, part);
        let regular = c.rest - slope_v;
        let reaction = c.kick * touched * regular + released;
        let holds = touches & (reaction >= 0.0);

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
        effective_radial[i] = if rests {
            c.mismatch
        } else {
            free + c.material * (1.5 * free_rate - 0.5 * before)
        };
        let landed = 1.5 - drop / moved;
        share[i] = if holds {
            1.0
        } else if lands {
            landed
        } else {
            0.0
        };
        impulse[i] = if holds {
            concentrated - released
        } else if lands {
            // the velocity at the instant, not in the middle of the step
            (c.kick * (1.0 - landed) * regular - free_rate / c.gain).max(0.0)
        } else {
            0.0
        };
        age[i] = if holds { old_age + part } else { 0.0 };
        radial_rate[i] = rate;

        let old = tangential_rate[i];
        let change = c.gain * (c.keep * old + c.kick * force_v) - old;
        let most = if holds {
            c.gain * c.friction * reaction
        } else {
            0.0
        };
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
        let ended = if ends & (reaction > 0.0) { ended } else { 0.0 };
        let bent = kink + begun - ended;
        let shifted = v[R][i] + c.dt * (new + bent);
        tangential_rate[i] = new;
        tangential[i] = shifted;
        effective[i] = shifted + c.material * (1.5 * new - 0.5 * old);

        if WATCHED {
            // forces are what is missing between the velocity without and with them
            let [bend_u, slope_u] = differences::<R>(&u, i, &c.b, &c.coupling);
            let [bend_v, slope_v] = differences::<R>(&v, i, &c.a, &c.coupling);
            let elastic_u = bend_u + slope_v - c.g * u0;
            let elastic_v = bend_v - slope_u - c.h * v[R][i];
            let (mean_u, mean_v) = (0.5 * (was + rate), 0.5 * (old + new));
            let alone = c.gain * (c.keep * was + c.kick * force_u);
            // moving the node by what is bent does work against the elastic force
            friction_work[i] += given / c.gain * mean_v - c.dt * bent * elastic_v;
            contact_work[i] += (rate - alone) / c.gain * mean_u;
            // αΔt = 1/gain − keep
            let alpha = 1.0 / c.gain - c.keep;
            damping_work[i] += (c.kick * (force_u - elastic_u) - alpha * mean_u) * mean_u
                + (c.kick * (force_v - elastic_v) - alpha * mean_v) * mean_v;
        }
    }
}
