//! Linear forms of z that are zero together, and which of them stay so along a flow and through a reset.

use crate::affine::form::{Dual, VARYING};
use crate::affine::mode::{AffineMode, Exit, MatrixBy, Row};
use crate::affine::series::Program;
use crate::linalg::{Matrix, Vector};

/// A form whose coefficients are smaller than this part of what they are made of is zero but for rounding.
const ROUNDED: f64 = 1e-10;

/// Units in which forms are compared: the size of every component of z, and of the parameters.
#[derive(Clone, Debug)]
pub struct Units<'a> {
    /// Sizes of the components of z.
    pub z: &'a Vector,
    /// Number of states.
    pub states: usize,
    /// Sizes of the parameters that vary.
    pub parameters: [f64; VARYING],
}

impl Units<'_> {
    /// Largest coefficient of a form, or its largest derivative.
    pub fn size(&self, row: &Row) -> f64 {
        let largest = |row: &Vector| {
            let terms = row.iter().zip(self.z).map(|(c, unit)| (c * unit).abs());
            terms.fold(0.0, f64::max)
        };
        let derivatives = row.by.iter().zip(self.parameters);
        let derivatives = derivatives.map(|(by, unit)| unit * largest(by));
        derivatives.fold(largest(&row.at), f64::max)
    }

    /// Sum of the terms of a form.
    pub fn sum(&self, row: &Row) -> f64 {
        let terms = row.at.iter().zip(self.z).map(|(c, unit)| (c * unit).abs());
        terms.sum()
    }

    /// The component whose coefficient is largest, a state if any of them counts.
    fn pivot(&self, row: &Row, least: f64) -> Option<usize> {
        let value = |index: usize| (row.at[index] * self.z[index]).abs();
        let largest = |mut range: Vec<usize>| {
            range.retain(|index| value(*index) > least);
            let first = range.into_iter().rev();
            first.max_by(|one, other| value(*one).total_cmp(&value(*other)))
        };
        largest((0..self.states).collect())
            .or_else(|| largest((self.states + 1..row.at.len()).collect()))
    }
}

/// 1/x.
fn inverse(x: Dual) -> Dual {
    let value = x.value.recip();
    Dual {
        value,
        by: x.by.map(|by| -value * value * by),
    }
}

/// Forms in echelon form: each has a component of its own in which the others are zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forms {
    /// The forms; the coefficient of its own component is 1.
    pub rows: Vec<Row>,
    /// The component of each of them.
    pub pivots: Vec<usize>,
}

impl Forms {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A form without what the others make of it.
    fn remainder(&self, row: &Row) -> Row {
        let mut row = row.clone();
        for (form, pivot) in self.rows.iter().zip(&self.pivots) {
            let factor = row.dual(*pivot);
            row.subtract(factor, form);
        }
        row
    }

    /// Whether a form made of numbers of a size is zero where these are.
    pub fn contain(&self, row: &Row, size: f64, units: &Units) -> bool {
        units.size(&self.remainder(row)) <= ROUNDED * size
    }

    /// Adds a form that is zero, too. What depends on no state and no phase is left out.
    pub fn insert(&mut self, row: &Row, units: &Units) {
        let size = units.size(row);
        let mut row = self.remainder(row);
        let Some(pivot) = units.pivot(&row, ROUNDED * size) else {
            return;
        };
        let own = row.dual(pivot);
        scale(&mut row, inverse(own));
        for form in &mut self.rows {
            let factor = form.dual(pivot);
            form.subtract(factor, &row);
        }
        self.rows.push(row);
        self.pivots.push(pivot);
    }

    /// The forms r among these for which the whole of r, rM, rM², … is zero: they stay zero along the flow. Of forms of
    /// what is made of other components none is known to.
    pub fn invariant(&self, mode: &AffineMode, units: &Units) -> Forms {
        let matrix = &mode.matrix;
        let mut kept = self.clone();
        if !mode.field.is_exact {
            let plain = |row: &&Row| (mode.field.base()..row.at.len()).all(|c| !row.has(c));
            kept = Forms::default();
            self.rows
                .iter()
                .filter(plain)
                .for_each(|row| kept.insert(row, units));
        }
        loop {
            let pairs = kept.rows.iter().map(|row| {
                let through = row.through(matrix);
                let size = bound(row, matrix, units);
                let mut left = kept.remainder(&through);
                if units.size(&left) <= ROUNDED * size {
                    left = Row::zero(row.at.len());
                }
                (left, row.clone())
            });
            let rest = vanishing(pairs.collect(), units);
            if rest.len() == kept.len() {
                return kept;
            }
            kept = Forms::default();
            for row in &rest {
                kept.insert(row, units);
            }
        }
    }

    /// The forms that are zero after the reset of an exit where these are before it.
    pub fn after(&self, exit: &Exit, program: &Program, units: &Units) -> Forms {
        let states = units.states;
        let reset: Vec<usize> = (0..states).filter(|state| is_reset(exit, *state)).collect();
        let made = program.size() - program.made()..program.size();
        let made = made.filter(|component| program.depends(*component, &reset));
        let changed: Vec<usize> = reset.iter().copied().chain(made).collect();
        let split = |row: Row| {
            let (mut own, mut rest) = (Row::zero(row.at.len()), row);
            for state in &changed {
                let value = rest.dual(*state);
                own.set(*state, value);
                rest.set(*state, Dual::default());
            }
            (own, rest)
        };
        let kept = self.rows.iter().map(|row| split(row.clone()));
        let new = reset.iter().map(|state| {
            let (own, mut rest) = split(exit.reset.row(*state).negative());
            let one = Dual {
                value: 1.0,
                ..Dual::default()
            };
            rest.set(*state, one);
            (own, rest)
        });
        let pairs = kept.chain(new).collect();
        let mut forms = Forms::default();
        for row in vanishing(pairs, units) {
            forms.insert(&row, units);
        }
        forms
    }

    /// The least k for which cMᵏ is not zero where these forms are, `None` if there is none.
    pub fn order(&self, row: &Row, matrix: &MatrixBy, units: &Units) -> Option<usize> {
        let (mut row, mut size) = (row.clone(), units.size(row));
        for order in 0..=row.at.len() {
            if !self.contain(&row, size, units) {
                return Some(order);
            }
            size = bound(&row, matrix, units);
            row = row.through(matrix);
        }
        None
    }
}

/// Size of the numbers of which a form times a matrix is made.
fn bound(row: &Row, matrix: &MatrixBy, units: &Units) -> f64 {
    let terms = |row: &Vector, matrix: &Matrix, column: usize| -> f64 {
        let column = &matrix.as_slice()[column * row.len()..][..row.len()];
        let entries = row.as_slice().iter().zip(column);
        entries.map(|(c, entry)| (c * entry).abs()).sum()
    };
    let changes = |by: &[f64]| by.iter().any(|by| *by != 0.0);
    let varies = |p: &usize| changes(row.by[*p].as_slice()) || changes(matrix.by[*p].as_slice());
    let varying: Vec<usize> = (0..VARYING).filter(varies).collect();
    let largest = |column: usize| {
        let derivative = |p: usize| {
            terms(&row.by[p], &matrix.at, column) + terms(&row.at, &matrix.by[p], column)
        };
        let derivatives = varying
            .iter()
            .map(|p| units.parameters[*p] * derivative(*p));
        let size = derivatives.fold(terms(&row.at, &matrix.at, column), f64::max);
        size * units.z[column]
    };
    (0..row.at.len()).map(largest).fold(0.0, f64::max)
}

/// Whether an exit changes a state.
fn is_reset(exit: &Exit, state: usize) -> bool {
    let row = exit.reset.row(state);
    let others = row.at.iter().enumerate();
    let same = others
        .into_iter()
        .all(|(index, value)| *value == f64::from(u8::from(index == state)));
    !same || row.by.iter().any(|by| by.amax() > 0.0)
}

fn scale(row: &mut Row, factor: Dual) {
    for (by, slope) in row.by.iter_mut().zip(factor.by) {
        *by *= factor.value;
        by.axpy(slope, &row.at, 1.0);
    }
    row.at *= factor.value;
}

/// Combinations of pairs whose first parts add up to zero: their second parts.
fn vanishing(pairs: Vec<(Row, Row)>, units: &Units) -> Vec<Row> {
    let mut pivots: Vec<(usize, Row, Row)> = Vec::new();
    let mut found = Vec::new();
    for (mut first, mut second) in pairs {
        let size = units.size(&first);
        for (pivot, known, carried) in &pivots {
            let factor = first.dual(*pivot);
            first.subtract(factor, known);
            second.subtract(factor, carried);
        }
        let value = |index: &usize| (first.at[*index] * units.z[*index]).abs();
        let largest = (0..first.at.len()).max_by(|one, other| value(one).total_cmp(&value(other)));
        match largest.filter(|index| value(index) > ROUNDED * size) {
            None if units.size(&first) <= ROUNDED * size => found.push(second),
            // zero at this value of the parameter only
            None => {}
            Some(pivot) => {
                let factor = inverse(first.dual(pivot));
                scale(&mut first, factor);
                scale(&mut second, factor);
                pivots.push((pivot, first, second));
            }
        }
    }
    found
}
