//! Guards and stability of an equilibrium.

use serde::{Deserialize, Serialize};

use super::curve::{EquilibriumCurve, EquilibriumFailure};
use super::field::Linear;
use super::spectrum::{bordered, eigenvalues, growths, is_told, sums};
use super::{EquilibriumGuard, VirtualEquilibrium};
use crate::continuation::Node;
use crate::linalg::{Eigenvalue, Vector};
use crate::orbit::sign::SignVerdict;
use crate::orbit::{Examined, Growth};

/// A guard of the mode at an equilibrium, scaled to order one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EquilibriumMargin {
    /// Which of the mode.
    pub guard: usize,
    /// Its value.
    pub value: f64,
    /// What rounding of its terms, and of unknowns of order one, may leave in that.
    pub error: f64,
    /// Its derivatives in the scaled unknowns.
    pub gradient: Vec<f64>,
}

impl EquilibriumMargin {
    /// Roundings of a guard, relative to its terms.
    const ROUNDINGS: f64 = 8.0 * f64::EPSILON;

    /// That of a scaled function with this value.
    fn of(guard: usize, scaled: &Linear, value: f64) -> EquilibriumMargin {
        EquilibriumMargin {
            guard,
            value,
            error: EquilibriumMargin::ROUNDINGS * scaled.size.max(scaled.by.amax()),
            gradient: scaled.by.iter().copied().collect(),
        }
    }
}

/// What an examination of an equilibrium found.
#[derive(Clone, Debug)]
pub struct EquilibriumExamination {
    /// All guards of the mode.
    pub margins: Vec<EquilibriumMargin>,
    /// All eigenvalues, in a sliding mode those within its surface, the fastest growing first.
    pub eigenvalues: Vec<Eigenvalue>,
    tests: [f64; 2],
    unit: f64,
}

impl Examined for EquilibriumExamination {
    type Margin = EquilibriumMargin;

    fn margins(&self) -> &[EquilibriumMargin] {
        &self.margins
    }

    fn verdict(&self) -> SignVerdict {
        match self
            .margins
            .iter()
            .all(|margin| margin.value > margin.error)
        {
            true => SignVerdict::Positive,
            false => SignVerdict::Negative,
        }
    }

    fn tests(&self) -> &[f64] {
        &self.tests
    }

    fn is_told(&self, test: usize) -> bool {
        is_told(&self.eigenvalues, test)
    }

    fn growths(&self) -> Option<Vec<Growth>> {
        Some(growths(&self.eigenvalues, self.unit))
    }
}

impl EquilibriumExamination {
    /// How many eigenvalues grow, by more than rounding.
    pub fn growing(&self) -> usize {
        let all = self.eigenvalues.iter();
        all.filter(|one| one.value.re > one.error).count()
    }

    /// Whether rounding decides whether one of them grows.
    pub fn is_undecided(&self) -> bool {
        let mut all = self.eigenvalues.iter();
        !all.all(|one| one.value.re.abs() > one.error)
    }
}

impl EquilibriumCurve {
    /// Guards and stability at scaled unknowns.
    pub(super) fn examined(
        &self,
        point: &Vector,
    ) -> Result<EquilibriumExamination, EquilibriumFailure> {
        let at = self.linearised(point)?;
        let units = &self.setting.scales.units;
        let guards = at.guards.iter().zip(&self.guards).enumerate();
        let guards = guards.map(|(guard, (linear, factor))| {
            let scaled = linear.scaled(units, *factor);
            EquilibriumMargin::of(guard, &scaled, scaled.value)
        });
        let kinks = at.kinks.iter().enumerate().map(|(index, (step, operand))| {
            let sign = self.signature.signs.get(*step).copied().unwrap_or(0.0);
            let signed = self.scaled_operand(operand).times(sign);
            // one that has no side is on none
            let value = if sign == 0.0 { 1.0 } else { signed.value };
            EquilibriumMargin::of(at.guards.len() + index, &signed, value)
        });
        let margins: Vec<EquilibriumMargin> = guards.chain(kinks).collect();
        // beyond a guard or a kink it is looked at only to find the place of that
        if at.lacks_value && margins.iter().all(|margin| margin.value > 0.0) {
            return Err(self.no_value());
        }
        let eigenvalues = eigenvalues(&at);
        Ok(EquilibriumExamination {
            margins,
            // the sign of the first takes a tangent: see `across`
            tests: [1.0, sums(&eigenvalues)],
            eigenvalues,
            unit: self.setting.scales.rate,
        })
    }

    /// The function of [`super::spectrum::BRANCHING`] at a node.
    pub(super) fn across(&self, node: &Node) -> f64 {
        bordered(self, node).unwrap_or(f64::NAN)
    }

    /// Which kink of the rates a margin is, if it is none of the guards.
    pub(super) fn kink(&self, margin: &EquilibriumMargin) -> Option<usize> {
        let guards = &self.lifted.modes[self.signature.mode].guards;
        margin.guard.checked_sub(guards.len())
    }

    /// How many eigenvalues grow, where rounding does not decide.
    pub fn growing(&self, point: &Vector) -> Option<usize> {
        let examination = self.examined(point).ok()?;
        (!examination.is_undecided()).then(|| examination.growing())
    }

    /// The same on the other side of the kink that a margin is; `None` where it is a guard.
    pub fn beyond(&self, margin: &EquilibriumMargin) -> Option<EquilibriumCurve> {
        self.beyond_kink(self.kink(margin)?)
    }

    pub(super) fn guard_of(&self, margin: &EquilibriumMargin) -> EquilibriumGuard {
        let mode = self.signature.mode;
        let guard = match self.kink(margin) {
            Some(_) => "the operand of an `abs`, `min` or `max`".to_owned(),
            None => self.setting.system.guard_name(mode, margin.guard),
        };
        EquilibriumGuard {
            mode: self.signature.name.clone(),
            guard,
        }
    }

    /// The worst of the guards.
    pub(super) fn worst(&self, examination: &EquilibriumExamination) -> VirtualEquilibrium {
        let margins = examination.margins.iter();
        let worst = margins.min_by(|one, other| one.value.total_cmp(&other.value));
        match worst {
            Some(margin) if margin.value < -margin.error => VirtualEquilibrium::Guard {
                guard: self.guard_of(margin),
                value: margin.value / self.guards.get(margin.guard).copied().unwrap_or(1.0),
            },
            Some(margin) => VirtualEquilibrium::Zero {
                guard: self.guard_of(margin),
            },
            None => VirtualEquilibrium::Undecided,
        }
    }
}
