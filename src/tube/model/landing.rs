//! What ends a separation.

use super::laws::Impact;
use super::{Model, Parameter};

/// What ends a separation, as far as the model says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Landing {
    /// An impact under this law, without material damping.
    Impact(Impact),
    /// With material damping U̇ = 0 at landing: there is no impact, whatever its law.
    Damped,
}

impl Landing {
    /// That of waves followed in a parameter.
    pub(crate) fn of(model: &Model, parameter: Parameter) -> Landing {
        match model.has_material_damping(parameter) {
            true => Landing::Damped,
            false => Landing::Impact(model.impact),
        }
    }
}
