//! A zone by an explicit Runge–Kutta method: Dormand and Prince's pair of order 8 with step control.
//!
//! The right side evaluated on numbers with derivatives is that of the variational equations, so
//! that one integration gives the end of the zone and all its derivatives.

use differential_equations::prelude::{ExplicitRungeKutta, IVP};
use differential_equations::traits::State;

use super::equations::VectorField;
use crate::tube::flow::jet::{Jet, LAYER};
use crate::tube::flow::{FlowError, Unsolved};

/// Most steps of one zone: beyond, the equations are stiff for an explicit method.
const MOST_STEPS: usize = 200_000;

/// Step control of one integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShootingSteps {
    /// Tolerance of the local error of a step, relative and absolute: every unknown is of the order
    /// of the zone's own scales.
    pub tolerance: f64,
    /// Longest step as a fraction of the zone.
    pub longest: f64,
}

/// x(1) of dx/dτ = F(τ, x) from x(0).
pub(crate) fn integrate<X: State<f64>>(
    rate: impl Fn(f64, &X, &mut X),
    begin: X,
    steps: ShootingSteps,
) -> Result<X, Unsolved> {
    let method = ExplicitRungeKutta::dop853()
        .rtol(steps.tolerance)
        .atol(steps.tolerance)
        .h_max(steps.longest)
        .max_steps(MOST_STEPS);
    let solution = IVP::ode_from_fn(rate, 0.0, 1.0, begin)
        .method(method)
        .solve()
        .map_err(|_| Unsolved::Steps)?;
    let end = solution.y.into_iter().next_back();
    let finite = |end: &X| (0..end.len()).all(|index| end.get_component(index).is_finite());
    end.filter(finite).ok_or(Unsolved::Overflow)
}

/// x(1) of dx/dτ = F(x), x(0) = 0.
pub(crate) fn values<const D: usize>(
    field: &impl VectorField<D, f64>,
    steps: ShootingSteps,
    duration: f64,
) -> Result<[f64; D], FlowError> {
    integrate(|_, x, by| *by = field.rate(x), [0.0; D], steps)
        .map_err(|reason| FlowError::Integration { duration, reason })
}

/// x(1) with all derivatives; S = 6D is the size of a state with its derivatives.
pub(crate) fn jets<const D: usize, const S: usize>(
    field: &impl VectorField<D, Jet>,
    steps: ShootingSteps,
    duration: f64,
) -> Result<[Jet; D], FlowError> {
    let unflatten = |x: &[f64; S]| -> [Jet; D] {
        std::array::from_fn(|row| Jet {
            value: x[6 * row],
            // there is no layer to differentiate in
            by: std::array::from_fn(|index| {
                if index < LAYER {
                    x[6 * row + 1 + index]
                } else {
                    0.0
                }
            }),
        })
    };
    let end = integrate(
        |_, x: &[f64; S], by: &mut [f64; S]| {
            for (row, jet) in field.rate(&unflatten(x)).into_iter().enumerate() {
                by[6 * row] = jet.value;
                by[6 * row + 1..6 * row + 6].copy_from_slice(&jet.by[..LAYER]);
            }
        },
        [0.0; S],
        steps,
    )
    .map_err(|reason| FlowError::Integration { duration, reason })?;
    Ok(unflatten(&end))
}
