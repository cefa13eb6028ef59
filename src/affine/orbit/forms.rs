//! Linear forms of z that are zero together, and which of them stay so along a flow and through a reset.
//!
//! A form stands in one slice: its coefficients, and after them their derivatives in every parameter that varies. Forms are
//! found anew at every value of the parameter, so that they lie one after the other in one place.

use crate::affine::dual::{Dual, VARYING};
use crate::affine::exponential::entries;
use crate::affine::mode::{AffineMode, Exit, MatrixBy, Row};
use crate::affine::program::Program;
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
    /// Sizes of the parameters that may vary.
    pub parameters: [f64; VARYING],
    /// How many of them do: derivatives in the others are zero.
    pub varying: usize,
}

impl Units<'_> {
    /// Largest coefficient of a form, or its largest derivative.
    pub fn size(&self, row: &Row) -> f64 {
        let derivatives = row.by.each_ref().map(|by| by.as_slice());
        self.largest(row.at.as_slice(), derivatives.into_iter())
    }

    fn largest<'f>(&self, at: &[f64], by: impl Iterator<Item = &'f [f64]>) -> f64 {
        let largest = |row: &[f64]| {
            let terms = row.iter().zip(self.z.as_slice());
            let terms = terms.map(|(c, unit)| (c * unit).abs());
            terms.fold(0.0, f64::max)
        };
        let derivatives = by.zip(self.parameters);
        let derivatives = derivatives.map(|(by, unit)| unit * largest(by));
        derivatives.fold(largest(at), f64::max)
    }

    /// The same of a form in one slice.
    fn size_of(&self, form: &[f64]) -> f64 {
        let (at, by) = form.split_at(self.z.len());
        self.largest(at, by.chunks_exact(at.len()))
    }

    /// A row in one slice.
    fn form(&self, row: &Row) -> Vec<f64> {
        let mut form = Vec::with_capacity(self.length());
        form.extend_from_slice(row.at.as_slice());
        for by in &row.by[..self.varying] {
            form.extend_from_slice(by.as_slice());
        }
        form
    }

    /// Length of a form.
    fn length(&self) -> usize {
        (1 + self.varying) * self.z.len()
    }

    /// Sum of the terms of a form.
    pub fn sum(&self, row: &Row) -> f64 {
        let terms = row.at.iter().zip(self.z).map(|(c, unit)| (c * unit).abs());
        terms.sum()
    }

    /// The component whose coefficient is largest, a state if any of them counts.
    fn pivot(&self, form: &[f64], least: f64) -> Option<usize> {
        let value = |index: &usize| (form[*index] * self.z[*index]).abs();
        let largest = |range: std::ops::Range<usize>| {
            let first = range.rev().filter(|index| value(index) > least);
            first.max_by(|one, other| value(one).total_cmp(&value(other)))
        };
        largest(0..self.states).or_else(|| largest(self.states + 1..self.z.len()))
    }
}

/// 1/x.
fn inverse(x: Dual) -> Dual {
    let value = x.value.recip();
    Dual::new(value, x.by.map(|by| -value * value * by))
}

/// Forms in echelon form: each has a component of its own in which the others are zero, and its coefficient of that is 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forms {
    /// Components of z.
    size: usize,
    /// The forms one after the other.
    forms: Vec<f64>,
    /// The component of each of them.
    pub pivots: Vec<usize>,
}

impl Forms {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.pivots.len()
    }

    fn iter(&self) -> impl Iterator<Item = &[f64]> {
        let length = self.forms.len() / self.len().max(1);
        self.forms.chunks_exact(length.max(1))
    }

    /// The forms as rows.
    pub fn rows(&self) -> impl Iterator<Item = Row> {
        self.iter().map(|form| self.row_of(form))
    }

    /// The form with a component of its own.
    pub fn row(&self, index: usize) -> Option<Row> {
        self.iter().nth(index).map(|form| self.row_of(form))
    }

    fn row_of(&self, form: &[f64]) -> Row {
        let mut parts = form.chunks_exact(self.size).map(Vector::from_column_slice);
        let mut part = || parts.next().unwrap_or_else(|| Vector::zeros(self.size));
        Row {
            at: part(),
            by: std::array::from_fn(|_| part()),
        }
    }

    /// Whether none of them changes with a parameter.
    pub fn are_constant(&self) -> bool {
        let mut derivatives = self.iter().flat_map(|form| &form[self.size..]);
        derivatives.all(|by| *by == 0.0)
    }

    /// Takes away from a form what the others make of it.
    fn reduce(&self, form: &mut [f64]) {
        for (known, pivot) in self.iter().zip(&self.pivots) {
            subtract(form, dual(form, *pivot, self.size), known, self.size);
        }
    }

    /// Whether a form made of numbers of a size is zero where these are.
    pub fn contain(&self, row: &Row, size: f64, units: &Units) -> bool {
        self.contain_form(&mut units.form(row), size, units)
    }

    /// The same of a form in one slice, which is reduced.
    fn contain_form(&self, form: &mut [f64], size: f64, units: &Units) -> bool {
        self.reduce(form);
        units.size_of(form) <= ROUNDED * size
    }

    /// Adds a form that is zero, too. What depends on no state and no phase is left out.
    pub fn insert(&mut self, row: &Row, units: &Units) {
        self.insert_form(&mut units.form(row), units);
    }

    /// The same of a form in one slice, which is changed.
    fn insert_form(&mut self, form: &mut [f64], units: &Units) {
        let size = units.size_of(form);
        self.reduce(form);
        let Some(pivot) = units.pivot(form, ROUNDED * size) else {
            return;
        };
        self.size = units.z.len();
        scale(form, inverse(dual(form, pivot, self.size)), self.size);
        for known in self.forms.chunks_exact_mut(form.len()) {
            subtract(known, dual(known, pivot, self.size), form, self.size);
        }
        self.forms.extend_from_slice(form);
        self.pivots.push(pivot);
    }

    /// These without the forms of other pivots.
    pub fn with_pivots(&self, is_kept: impl Fn(usize) -> bool) -> Forms {
        let mut kept = Forms {
            size: self.size,
            ..Forms::default()
        };
        for (form, pivot) in self.iter().zip(&self.pivots) {
            if is_kept(*pivot) {
                kept.forms.extend_from_slice(form);
                kept.pivots.push(*pivot);
            }
        }
        kept
    }

    /// The forms r among these for which the whole of r, rM, rM², … is zero: they stay zero along the flow. Of forms of
    /// what is made of other components none is known to.
    pub fn invariant(&self, mode: &AffineMode, rates: &Rates, units: &Units) -> Forms {
        let mut kept = self.clone();
        if !mode.field.is_exact {
            kept = Forms::default();
            for form in self.iter() {
                let mut parts = form.chunks_exact(self.size);
                if parts.all(|part| part[mode.field.base()..].iter().all(|c| *c == 0.0)) {
                    kept.insert_form(&mut form.to_vec(), units);
                }
            }
        }
        let length = units.length();
        loop {
            // what the rates of these forms have beside the forms themselves
            let mut left = vec![0.0; kept.forms.len()];
            let mut stays = true;
            for (form, left) in kept.iter().zip(left.chunks_exact_mut(length)) {
                let size = rates.add_rate(form, left, units);
                match kept.contain_form(left, size, units) {
                    true => left.fill(0.0),
                    false => stays = false,
                }
            }
            if stays {
                return kept;
            }
            let mut forms = kept.forms.clone();
            let rest = vanishing(&mut left, &mut forms, units);
            if rest.len() == kept.len() {
                return kept;
            }
            kept = Forms::default();
            for index in rest {
                kept.insert_form(&mut forms[index * length..][..length], units);
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
        let (size, length) = (program.size(), units.length());
        // of every form what the reset changes, and what it leaves
        let mut rest = Vec::with_capacity((self.len() + reset.len()) * length);
        rest.extend_from_slice(&self.forms);
        rest.resize((self.len() + reset.len()) * length, 0.0);
        let new = rest[self.len() * length..].chunks_exact_mut(length);
        for (form, state) in new.zip(&reset) {
            for (part, matrix) in form.chunks_exact_mut(size).zip(parts_of(&exit.reset)) {
                let row = matrix.as_slice()[*state..].iter().step_by(matrix.nrows());
                part.iter_mut().zip(row).for_each(|(c, value)| *c = -value);
            }
        }
        let mut own = vec![0.0; rest.len()];
        let parts = own.chunks_exact_mut(size).zip(rest.chunks_exact_mut(size));
        for (own, rest) in parts {
            for component in &changed {
                own[*component] = std::mem::take(&mut rest[*component]);
            }
        }
        let new = rest[self.len() * length..].chunks_exact_mut(length);
        new.zip(&reset).for_each(|(form, state)| form[*state] = 1.0);
        let mut forms = Forms::default();
        for index in vanishing(&mut own, &mut rest, units) {
            forms.insert_form(&mut rest[index * length..][..length], units);
        }
        forms
    }

    /// The least k for which cMᵏ is not zero where these forms are, `None` if there is none.
    pub fn order(&self, row: &Row, rates: &Rates, units: &Units) -> Option<usize> {
        let (mut form, mut size) = (units.form(row), units.size(row));
        for order in 0..=row.at.len() {
            if !self.contain_form(&mut form.clone(), size, units) {
                return Some(order);
            }
            let mut next = vec![0.0; form.len()];
            size = rates.add_rate(&form, &mut next, units);
            form = next;
        }
        None
    }
}

/// Entries of a matrix that are not zero: row, column, value.
type Entries = Vec<(usize, usize, f64)>;

/// The matrix of a mode with its derivatives: most of their entries are zero.
#[derive(Clone, Debug)]
pub struct Rates {
    at: Entries,
    by: [Entries; VARYING],
}

impl Rates {
    /// Those of a matrix.
    pub fn new(matrix: &MatrixBy) -> Rates {
        Rates {
            at: entries(&matrix.at),
            by: matrix.by.each_ref().map(entries),
        }
    }

    /// Adds cᵀM with derivatives to a form, the rate of one of states and phase, and returns the size of the numbers that it is made
    /// of.
    fn add_rate(&self, form: &[f64], rate: &mut [f64], units: &Units) -> f64 {
        let size = units.z.len();
        let add = |row: &[f64], entries: &Entries, rate: &mut [f64], terms: &mut [f64]| {
            for (from, to, entry) in entries {
                let term = entry * row[*from];
                rate[*to] += term;
                terms[*to] += term.abs();
            }
        };
        let mut terms = vec![0.0; size];
        let mut largest = 0.0_f64;
        let parts = form.chunks_exact(size).zip(rate.chunks_exact_mut(size));
        for (part, (own, rate)) in parts.enumerate() {
            terms.fill(0.0);
            add(own, &self.at, rate, &mut terms);
            let unit = match part.checked_sub(1) {
                None => 1.0,
                Some(p) => {
                    add(&form[..size], &self.by[p], rate, &mut terms);
                    units.parameters[p]
                }
            };
            let sizes = terms.iter().zip(units.z.as_slice());
            let sizes = sizes.map(|(term, z)| unit * term * z);
            largest = sizes.fold(largest, f64::max);
        }
        largest
    }
}

/// A matrix and its derivatives.
fn parts_of(matrix: &MatrixBy) -> impl Iterator<Item = &Matrix> {
    std::iter::once(&matrix.at).chain(&matrix.by)
}

/// Coefficient of a component of z.
fn dual(form: &[f64], column: usize, size: usize) -> Dual {
    let mut parts = form[column..].iter().step_by(size).copied();
    let mut part = || parts.next().unwrap_or(0.0);
    Dual::new(part(), std::array::from_fn(|_| part()))
}

/// Adds a slice times a factor.
fn add(factor: f64, part: &[f64], sum: &mut [f64]) {
    let pairs = sum.iter_mut().zip(part);
    pairs.for_each(|(sum, c)| *sum += factor * c);
}

/// Takes another form times a factor away.
fn subtract(form: &mut [f64], factor: Dual, other: &[f64], size: usize) {
    if factor == Dual::default() {
        return;
    }
    add(-factor.value, other, form);
    let derivatives = form[size..].chunks_exact_mut(size);
    for (by, slope) in derivatives.zip(factor.by) {
        if slope != 0.0 {
            add(-slope, &other[..size], by);
        }
    }
}

fn scale(form: &mut [f64], factor: Dual, size: usize) {
    let (at, by) = form.split_at_mut(size);
    for (by, slope) in by.chunks_exact_mut(at.len()).zip(factor.by) {
        by.iter_mut().for_each(|by| *by *= factor.value);
        add(slope, at, by);
    }
    at.iter_mut().for_each(|c| *c *= factor.value);
}

/// Whether an exit changes a state.
fn is_reset(exit: &Exit, state: usize) -> bool {
    let entries = exit.reset.at.row(state);
    let mut entries = entries.iter().enumerate();
    let same = entries.all(|(index, value)| *value == f64::from(u8::from(index == state)));
    let mut derivatives = exit.reset.by.iter();
    !same || derivatives.any(|by| by.row(state).iter().any(|by| *by != 0.0))
}

/// Combinations of pairs whose first parts add up to zero: where their second parts stand.
fn vanishing(first: &mut [f64], second: &mut [f64], units: &Units) -> Vec<usize> {
    let (size_of_z, length) = (units.z.len(), units.length());
    let count = first.len() / length;
    let mut pivots: Vec<(usize, usize)> = Vec::with_capacity(count);
    let mut found = Vec::with_capacity(count);
    for index in 0..count {
        let (first_before, own) = first.split_at_mut(index * length);
        let (second_before, carried) = second.split_at_mut(index * length);
        let (own, carried) = (&mut own[..length], &mut carried[..length]);
        if own.iter().all(|c| *c == 0.0) {
            found.push(index);
            continue;
        }
        let size = units.size_of(own);
        for (pivot, known) in &pivots {
            let factor = dual(own, *pivot, size_of_z);
            let known = known * length..(known + 1) * length;
            subtract(own, factor, &first_before[known.clone()], size_of_z);
            subtract(carried, factor, &second_before[known], size_of_z);
        }
        let value = |index: &usize| (own[*index] * units.z[*index]).abs();
        let largest = (0..size_of_z).max_by(|one, other| value(one).total_cmp(&value(other)));
        match largest.filter(|index| value(index) > ROUNDED * size) {
            None if units.size_of(own) <= ROUNDED * size => found.push(index),
            // zero at this value of the parameter only
            None => {}
            Some(pivot) => {
                let factor = inverse(dual(own, pivot, size_of_z));
                scale(own, factor, size_of_z);
                scale(carried, factor, size_of_z);
                pivots.push((pivot, index));
            }
        }
    }
    found
}
