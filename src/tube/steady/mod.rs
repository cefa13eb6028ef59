//! Stability of steady sliding, mode by mode.
//!
//! The tube slips everywhere, u = δX(r), and is perturbed by e^{ikφ+λt}. Both the reduced model
//! and the full radial problem give complex stiffnesses κ(k, f), from which damping makes the
//! eigenvalues λ ([`growth`]):
//!
//! ```text
//! coefficients ──► reduced: κ in closed form ─┐
//!                                             ├─► growth: λ(κ; α, β), Hopf points ──► Mode
//! geometry ──► radial: κ of elasticity ───────┘
//! ```
//!
//! The mismatch δ does not enter under Coulomb's law: the perturbation of the pressure is proportional
//! to the perturbation of the displacement, whatever the pressure. It does where friction depends on
//! the velocity ([`growth`]): the slope of the law is multiplied by the pressure.

pub mod growth;
pub mod radial;
pub mod reduced;
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub mod row;

use crate::tube::model::coefficients::{Coefficients, Geometry};
use crate::tube::model::{Damping, FrictionLaw};
use faer::c64;
pub use growth::{Hopf, SteadyFriction, SteadyWave};
use radial::{Radial, RadialError, RadialPair};
use reduced::Reduced;

/// Number of radial functions per component the first attempt is made with.
const FIRST_ORDER: usize = 12;
/// Largest number of radial functions; the eigenvalue problem then has twice as many rows.
const LAST_ORDER: usize = 120;
/// Relative difference of the stiffnesses κ of two successive orders at which the finer one is
/// taken. The error of the finer one is far smaller still: convergence is geometric in the order.
/// Rounding leaves about 1e-13.
const RADIAL_TOLERANCE: f64 = 1e-11;

/// What is computed besides the modes themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadySettings {
    /// Friction coefficient f ≥ 0.
    pub friction: f64,
    /// How friction depends on the velocity.
    pub law: FrictionLaw,
    /// Mismatch δ; without influence where friction does not depend on the velocity.
    pub mismatch: f64,
    /// Damping.
    pub damping: Damping,
    /// Families of radial modes looked at, at least 1.
    pub families: usize,
    /// Number of radial functions; `None` raises it until κ has converged.
    pub order: Option<usize>,
}

/// Stability of steady sliding against perturbations of one mode.
#[derive(Clone, Debug, PartialEq)]
pub struct SteadyMode {
    /// Number of waves around the circumference.
    pub mode: u32,
    /// The reduced model.
    pub reduced: SteadyBranch,
    /// The full radial problem; `None` where only the coefficients of the reduced model are known.
    pub full: Option<Full>,
}

/// The wave of one family of perturbations and the friction at which it begins to grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteadyBranch {
    /// The wave that grows fastest, or decays slowest.
    pub wave: SteadyWave,
    /// Where it begins to grow; `None` where no friction makes it grow.
    pub hopf: Option<Hopf>,
}

/// What the full radial problem says.
#[derive(Clone, Debug, PartialEq)]
pub struct Full {
    /// The fundamental family: least |κ|.
    pub fundamental: SteadyBranch,
    /// Distance of the fundamental displacement field from that of the reduced model, relative to
    /// its norm, in the norm of kinetic energy: 0 where they are parallel, 1 where orthogonal.
    pub field_error: f64,
    /// Family with the fastest growth, from 1 in the order of |κ|.
    pub lead: usize,
    /// Its wave.
    pub lead_wave: SteadyWave,
    /// Family whose Hopf point has the least friction, from 1, and that point.
    pub first: Option<(usize, Hopf)>,
    /// Radial functions per component.
    pub order: usize,
    /// Largest relative difference of a κ of these families from the next coarser order.
    pub error: f64,
}

/// Stability of steady sliding against one mode. `geometry` is `None` where only the coefficients
/// are known.
///
/// # Errors
/// When the iteration for the eigenvalues of the full problem fails.
pub fn mode(
    coefficients: &Coefficients,
    geometry: Option<&Geometry>,
    mode: u32,
    settings: &SteadySettings,
) -> Result<SteadyMode, RadialError> {
    let reduced = Reduced::new(coefficients, mode);
    let sliding = SteadyFriction::new(settings.law, coefficients.g * settings.mismatch);
    let full = match geometry {
        Some(geometry) => Some(full(geometry, mode, settings, sliding)?),
        None => None,
    };
    let damping = Damping {
        mass: settings.damping.mass + settings.friction * sliding.drag,
        ..settings.damping
    };
    let kappa = reduced.stiffness(settings.friction * sliding.strength);
    Ok(SteadyMode {
        mode,
        reduced: SteadyBranch {
            wave: SteadyWave::fastest(kappa, mode, damping),
            hopf: reduced.hopf_sliding(settings.damping, sliding),
        },
        full,
    })
}

/// The full problem at an order where κ, and λ where it follows from more than κ, has converged, or
/// at the last one.
fn full(
    geometry: &Geometry,
    mode: u32,
    settings: &SteadySettings,
    sliding: SteadyFriction,
) -> Result<Full, RadialError> {
    let (first, last) = match settings.order {
        Some(order) => ((order / 3 * 2).max(1), order),
        None => (FIRST_ORDER, LAST_ORDER),
    };
    let (families, damping) = (settings.families, settings.damping);
    let solve = |order: usize| -> Result<(Radial, Vec<RadialPair>, Vec<c64>), RadialError> {
        let radial = Radial::new(geometry, mode, order);
        let mut pairs = radial.lowest(settings.friction * sliding.strength, families)?;
        let leading = pairs
            .iter_mut()
            .map(|pair| radial.leading(pair, settings.friction, sliding, damping))
            .collect::<Result<_, _>>()?;
        Ok((radial, pairs, leading))
    };
    let mut order = first;
    let (_, mut coarse, mut coarse_leading) = solve(order)?;
    loop {
        order = (order + order / 2).max(order + 1).min(last);
        let (radial, pairs, leading) = solve(order)?;
        let mut error: f64 = 0.0;
        for (index, pair) in pairs.iter().enumerate() {
            error = error.max(match coarse.get(index) {
                Some(other) => (pair.kappa - other.kappa).norm() / pair.kappa.norm(),
                None => f64::INFINITY,
            });
            if sliding.drag != 0.0 {
                let other = coarse_leading.get(index).copied().unwrap_or_default();
                error = error.max((leading[index] - other).norm() / leading[index].norm());
            }
        }
        if order < last && error > RADIAL_TOLERANCE {
            (coarse, coarse_leading) = (pairs, leading);
            continue;
        }
        let waves: Vec<SteadyWave> = leading
            .iter()
            .map(|lambda| SteadyWave::of(*lambda, mode))
            .collect();
        let lead = fastest(&waves);
        let hopf = radial.hopf(families, damping, sliding)?;
        let mut least: Option<(usize, Hopf)> = None;
        for (index, point) in hopf.iter().enumerate() {
            if let Some(point) = point
                && least.is_none_or(|(_, known)| point.friction < known.friction)
            {
                least = Some((index + 1, *point));
            }
        }
        return Ok(Full {
            fundamental: SteadyBranch {
                wave: waves[0],
                hopf: hopf[0],
            },
            field_error: radial.field_error(&pairs[0]),
            lead: lead + 1,
            lead_wave: waves[lead],
            first: least,
            order,
            error,
        });
    }
}

/// The first of the waves that grow fastest.
fn fastest(waves: &[SteadyWave]) -> usize {
    let mut lead = 0;
    for (index, wave) in waves.iter().enumerate() {
        if wave.growth > waves[lead].growth {
            lead = index;
        }
    }
    lead
}

impl SteadyMode {
    /// Least Hopf friction in the reduced model, and growth there.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    fn onset(&self) -> Option<(f64, f64)> {
        Some((self.reduced.hopf?.friction, self.reduced.wave.growth))
    }

    /// The same of the tube, among all families.
    #[cfg_attr(not(feature = "cli"), allow(dead_code))]
    fn onset_of_tube(&self) -> Option<(f64, f64)> {
        let full = self.full.as_ref()?;
        Some((full.first?.1.friction, full.lead_wave.growth))
    }
}

/// The modes that grow first, by their places: in the reduced model and in the tube. Such a mode has the
/// least Hopf friction; without damping, where that is zero for all, it grows fastest.
#[cfg_attr(not(feature = "cli"), allow(dead_code))]
pub(crate) fn first_to_grow(modes: &[SteadyMode]) -> [Option<usize>; 2] {
    [SteadyMode::onset, SteadyMode::onset_of_tube].map(|onset| {
        let mut best: Option<(usize, (f64, f64))> = None;
        for (index, mode) in modes.iter().enumerate() {
            let Some((friction, growth)) = onset(mode) else {
                continue;
            };
            let earlier = best.is_none_or(|(_, (least, fastest))| {
                friction < least || (friction == least && growth > fastest)
            });
            if earlier {
                best = Some((index, (friction, growth)));
            }
        }
        best.map(|(index, _)| index)
    })
}
