//! What is zero at the entries and ends of stretches by the equations themselves, whatever the parameters.
//!
//! A stretch ends where a form is zero, and what is zero there may stay so through a reset and along the next
//! flow. From nothing round the cycle to a fixed point these facts are found; each of them is an identity of
//! formulas. More may be zero than is found: then less is proven.

use super::exact::NamePolynomial;
use super::fraction::Fraction;
use super::modes::{IntervalMode, Row, added, negative, through};
use crate::affine::algebra::Algebra;
use crate::affine::dual::Coefficient;

/// Forms that are zero together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FormZeros {
    /// Forms with a factor 1 at a state of their own, which no other has.
    solved: Vec<(usize, Row<NamePolynomial>)>,
    /// Forms that are solved for no state, each with 1 as the number of its first term.
    others: Vec<Row<NamePolynomial>>,
}

fn is_zero(row: &Row<NamePolynomial>) -> bool {
    row.iter().all(NamePolynomial::is_zero)
}

/// A form over a number; `None` over zero, or beyond the range of fractions.
fn over(row: &[NamePolynomial], number: Fraction) -> Option<Row<NamePolynomial>> {
    row.iter().map(|entry| entry.over(number)).collect()
}

/// A form that is zero where another is, with 1 as the number of its first term.
fn normalised(row: &[NamePolynomial]) -> Row<NamePolynomial> {
    let first = row.iter().find_map(NamePolynomial::first_factor);
    first
        .and_then(|number| over(row, number))
        .unwrap_or_else(|| row.to_vec())
}

impl FormZeros {
    /// How many are known.
    pub fn len(&self) -> usize {
        self.solved.len() + self.others.len()
    }

    pub fn rows(&self) -> impl Iterator<Item = &Row<NamePolynomial>> {
        self.solved.iter().map(|(_, row)| row).chain(&self.others)
    }

    /// A form without what is zero.
    fn rest(&self, row: &[NamePolynomial]) -> Row<NamePolynomial> {
        let solved = self.solved.iter();
        solved.fold(row.to_vec(), |row, (state, zero)| {
            let factor = negative(&row[*state..=*state]);
            match factor[0].is_zero() {
                true => row,
                false => added(&row, zero, &factor[0]),
            }
        })
    }

    /// Whether a form is known to be zero.
    pub fn have(&self, row: &[NamePolynomial]) -> bool {
        let rest = self.rest(row);
        is_zero(&rest) || self.others.contains(&normalised(&rest))
    }

    /// Adds a form that is zero.
    pub fn insert(&mut self, row: &[NamePolynomial], states: usize) {
        if self.have(row) {
            return;
        }
        let rest = self.rest(row);
        let solved = |state: usize| Some((state, over(&rest, rest[state].fraction()?)?));
        match (0..states).find_map(solved) {
            None => self.others.push(normalised(&rest)),
            Some((state, own)) => {
                for (_, zero) in &mut self.solved {
                    let factor = negative(&zero[state..=state]);
                    *zero = added(zero, &own, &factor[0]);
                }
                self.solved.push((state, own));
                for other in std::mem::take(&mut self.others) {
                    self.insert(&other, states);
                }
            }
        }
    }

    /// The states at which all of them are zero, where they are solved for fractions.
    pub fn values(&self, states: usize) -> Option<Vec<Fraction>> {
        let value = |state: usize| {
            let mut solved = self.solved.iter();
            let (_, row) = solved.find(|(own, _)| *own == state)?;
            let alone = row.iter().enumerate();
            let mut others = alone.filter(|(column, _)| *column != state && *column != states);
            let constant = row[states].fraction()?;
            (others.all(|(_, entry)| entry.is_zero())).then_some(-constant)
        };
        (0..states).map(value).collect()
    }

    /// Those that stay zero along a mode.
    pub fn along(&self, mode: &IntervalMode<NamePolynomial>, states: usize) -> FormZeros {
        let mut kept = self.clone();
        loop {
            let mut next = FormZeros::default();
            let surface = |row: &Row<NamePolynomial>| {
                let row = normalised(row);
                mode.kept.iter().any(|known| normalised(known) == row)
            };
            for row in kept.rows() {
                if surface(row) || kept.have(&through(row, &mode.matrix)) {
                    next.insert(row, states);
                }
            }
            if next.len() == kept.len() {
                return kept;
            }
            kept = next;
        }
    }

    /// Those that are zero after a reset: of the forms themselves, and of new states less what they are set to.
    pub fn after(&self, reset: &[Row<NamePolynomial>]) -> FormZeros {
        let states = reset.len();
        let Some(size) = reset.first().map(Vec::len) else {
            return FormZeros::default();
        };
        let whole = whole(reset, size);
        let set = (0..states).map(|state| less(&unit(state, size), &reset[state]));
        let mut after = FormZeros::default();
        for row in self.rows().cloned().chain(set) {
            if self.have(&through(&row, &whole)) {
                after.insert(&row, states);
            }
        }
        after
    }

    /// The least k for which the derivative of order k of a form is not known to be zero; `None` if there is none.
    pub fn order(
        &self,
        row: &[NamePolynomial],
        mode: &IntervalMode<NamePolynomial>,
    ) -> Option<usize> {
        let mut row = row.to_vec();
        for order in 0..=row.len() {
            if !self.have(&row) {
                return Some(order);
            }
            row = through(&row, &mode.matrix);
        }
        None
    }
}

/// A form that is one component of z.
pub fn unit(index: usize, size: usize) -> Row<NamePolynomial> {
    let mut row = vec![NamePolynomial::default(); size];
    row[index] = <NamePolynomial as Algebra>::number(1.0);
    row
}

/// z after a reset in terms of z before.
pub fn whole(reset: &[Row<NamePolynomial>], size: usize) -> Vec<Row<NamePolynomial>> {
    let row = |index| reset.get(index).cloned();
    (0..size)
        .map(|index| row(index).unwrap_or_else(|| unit(index, size)))
        .collect()
}

/// One form less another.
pub fn less(one: &[NamePolynomial], other: &[NamePolynomial]) -> Row<NamePolynomial> {
    added(one, other, &<NamePolynomial as Algebra>::number(-1.0))
}

/// Where a form comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FormSource {
    /// The derivative of this order of a guard.
    Guard { guard: usize, order: usize },
    /// A condition of an exit.
    Condition {
        guard: usize,
        exit: usize,
        index: usize,
    },
}

impl FormSource {
    /// The form.
    pub fn row<C: Coefficient>(self, mode: &IntervalMode<C>) -> Option<Row<C>> {
        Some(match self {
            FormSource::Guard { guard, order } => {
                mode.derivative(&mode.guards.get(guard)?.row, order)
            }
            FormSource::Condition { guard, exit, index } => {
                let exit = mode.guards.get(guard)?.exits.get(exit)?;
                exit.conditions.get(index)?.clone()
            }
        })
    }
}

/// A form that is zero at an event.
#[derive(Clone, Copy, Debug)]
pub struct VanishingForm {
    pub stretch: usize,
    /// Whether at its end, or at its entry.
    pub at_end: bool,
    pub source: FormSource,
}

/// What singles out an event of the inequalities.
pub enum InequalityEvent {
    Zero(VanishingForm),
    /// A stretch has no duration.
    Closed(usize),
}

/// Forms that are zero at the entry and at the end of a stretch.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    pub entry: FormZeros,
    pub end: FormZeros,
}
