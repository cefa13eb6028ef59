//! Inequalities of the orbits of a signature, and their margins.

use std::fmt::{Debug, Display};

use super::{Data, Examined, Orbit, Zones};
use crate::continuation::newton::Constraint;
use crate::linalg::Vector;

/// The precedence of a margin that is the duration of a zone.
pub(crate) const WITHOUT_LENGTH: usize = 0;

/// A smooth function of the unknowns that is positive while the signature holds.
pub trait MarginFunction: Clone + Debug + PartialEq {
    /// Its value, scaled to order one.
    fn value(&self) -> f64;

    /// Whether another margin of the same signature is the same function.
    fn is_same(&self, other: &Self) -> bool;

    /// Which of several margins that vanish at one place says most about what comes next: the least first, and that is
    /// [`WITHOUT_LENGTH`] if a zone has no length.
    fn precedence(&self) -> usize;

    /// Whether the parameter may be stationary where it vanishes, since a guard is met at zero speed there.
    fn grazes(&self) -> bool {
        false
    }
}

/// The inequalities of the orbits of a signature, each with a margin: its value, scaled to order one.
pub trait Inequalities: Zones {
    /// An inequality of the orbits, of which a margin is one value.
    type Inequality: Clone + Debug + PartialEq + Display;
    /// Why a point is not admissible.
    type Inadmissible: Data + std::error::Error;

    /// A margin that was seen nearby, at a point.
    ///
    /// # Errors
    /// The flow cannot be evaluated there.
    fn margin_at(&self, seen: &Self::Margin, point: &Vector)
    -> Result<Self::Margin, Self::Failure>;

    /// Adds the derivatives of a margin in the unknowns to those of the gradient.
    fn add_gradient(&self, margin: &Self::Margin, gradient: &mut [f64]);

    /// Derivative of a margin along a direction in the scaled unknowns.
    fn slope(&self, margin: &Self::Margin, direction: &Vector) -> f64 {
        let mut gradient = vec![0.0; direction.len()];
        self.add_gradient(margin, &mut gradient);
        gradient
            .iter()
            .zip(direction)
            .map(|(by, along)| by * along)
            .sum()
    }

    /// Σ |∂m/∂uᵢ|·dᵢ: how much a margin may change where every unknown changes by no more than dᵢ.
    fn reach(&self, margin: &Self::Margin, changes: &Vector) -> f64 {
        let mut gradient = vec![0.0; changes.len()];
        self.add_gradient(margin, &mut gradient);
        gradient
            .iter()
            .zip(changes)
            .map(|(by, change)| by.abs() * change)
            .sum()
    }

    /// When in the period a margin is looked at: margins that vanish together at several instants are changes of
    /// their own, which are all made at once.
    fn instant(&self, _point: &Vector, _margin: &Self::Margin) -> f64 {
        0.0
    }

    /// Whether a margin of this orbit and one of another signature measure the same.
    fn is_alike(&self, margin: &Self::Margin, other: &Self, of_other: &Self::Margin) -> bool;

    /// The inequality of which a margin is the value.
    fn inequality(&self, margin: &Self::Margin) -> Self::Inequality;

    /// The worst of what an examination found.
    fn inadmissible(&self, examination: &Self::Examination) -> Self::Inadmissible;
}

/// The margin of an examination that is the same function.
pub fn find<'a, O: Orbit>(
    examination: &'a O::Examination,
    margin: &O::Margin,
) -> Option<&'a O::Margin> {
    let mut margins = examination.margins().iter();
    margins.find(|known| known.is_same(margin))
}

/// The margins of an examination with those of another that are the same functions. Both mostly have them in the same order.
pub(super) fn paired<'a, O: Orbit>(
    before: &'a O::Examination,
    after: &'a O::Examination,
) -> impl Iterator<Item = (&'a O::Margin, &'a O::Margin)>
where
    O::Margin: 'a,
{
    let after = after.margins();
    let mut next = 0;
    before.margins().iter().filter_map(move |margin| {
        let is_same = |known: &O::Margin| known.is_same(margin);
        let here = after.get(next).is_some_and(is_same).then_some(next);
        let place = here.or_else(|| after.iter().position(is_same))?;
        next = place + 1;
        Some((margin, &after[place]))
    })
}

/// m(u) = 0.
#[derive(Clone, Debug)]
pub struct AtZero<O: Orbit> {
    /// The margin where it was last seen.
    pub margin: O::Margin,
}

impl<O: Orbit> AtZero<O> {
    /// The margin at a point, from which the next search sets out.
    pub(crate) fn margin_at(
        &mut self,
        orbit: &O,
        point: &Vector,
    ) -> Result<&O::Margin, O::Failure> {
        self.margin = orbit.margin_at(&self.margin, point)?;
        Ok(&self.margin)
    }
}

impl<O: Orbit> Constraint<O> for AtZero<O> {
    fn evaluate(
        &mut self,
        orbit: &O,
        point: &Vector,
        gradient: &mut [f64],
    ) -> Result<f64, O::Failure> {
        let margin = self.margin_at(orbit, point)?;
        orbit.add_gradient(margin, gradient);
        Ok(margin.value())
    }
}
