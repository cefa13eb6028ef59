//! The forces of all contacts that are in given states.
//!
//! A force is known where its law says it (it slips, is open, is a spring's), and otherwise what keeps a velocity of slip
//! or of a gap at zero: d/dt of it, which is affine in the forces, is zero. Together these are one linear system
//! Aq + r = 0. Its coefficients are forms: numbers where masses are, and the elimination of unknowns by forms is exact
//! where these are affine.

use super::law::{BACKWARD, CLOSED, FORWARD, GIVES_BACKWARD, GIVES_FORWARD, HELD, Law, STICK};
use super::mistake::{ContactMistake, Kinematic};
use crate::affine::algebra::{Algebra, Obstacle};
use crate::affine::dual::{Dual, Measured};
use crate::affine::form::Form;

/// Part of the largest entry of its row below which a pivot is nothing but the rounding of what has been taken away.
const NOTHING: f64 = 1e-12;

/// What the forces do to the rates of one of the user's modes, and to the contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct Own<C = Dual> {
    /// Rates of the states without forces.
    pub rates: Vec<Form<C>>,
    /// Of every contact: what its force adds to the rates of the states.
    pub weights: Vec<Vec<Form<C>>>,
    /// Of every contact: how its slip or its gap moves.
    pub kinematics: Vec<Moving<C>>,
}

/// How the slip of a contact, or the velocity of its gap, moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Moving<C = Dual> {
    /// The slip, or the velocity of the gap.
    pub speed: Form<C>,
    /// Its rate without forces.
    pub drift: Form<C>,
    /// What every force adds to that.
    pub by: Vec<Form<C>>,
    /// The state of a Jenkins element.
    pub stretch: Option<usize>,
}

impl<C: Measured> Own<C> {
    /// Takes the forces out of rates in which they are states from number `states` on, as many as there are laws.
    ///
    /// # Errors
    /// A force that does not stand linearly, or has no influence, or the wrong sign.
    pub fn new(
        rates: &[Form<C>],
        laws: &[Law<Form<C>>],
        (names, stretches): (&[String], &[Option<usize>]),
        omega: C,
    ) -> Result<Own<C>, (usize, ContactMistake)> {
        let states = rates.len();
        let none = |state: usize| (state >= states).then(Form::default);
        let failed = |contact: usize| {
            move |obstacle| {
                let mistake = ContactMistake::Obstacle(names[contact].clone(), obstacle);
                (contact, mistake)
            }
        };
        let mut weights = Vec::new();
        for (contact, name) in names.iter().enumerate() {
            let mut own = Vec::new();
            for rate in rates {
                let by = rate.slope(states + contact).map_err(failed(contact))?;
                if by.has_from(states) {
                    return Err((contact, ContactMistake::Nonlinear(name.clone())));
                }
                own.push(by);
            }
            weights.push(own);
        }
        // what is linear in forces has a value without them
        let bare = rates.iter().map(|rate| rate.with(&none));
        let bare: Vec<Form<C>> = bare.collect::<Result<_, _>>().map_err(failed(0))?;
        let mut own = Own {
            rates: bare,
            weights,
            kinematics: Vec::new(),
        };
        for (contact, law) in laws.iter().enumerate() {
            let moving = own
                .moving(law, omega.clone())
                .map_err(|error| match error {
                    Ok(obstacle) => failed(contact)(obstacle),
                    Err(mistake) => (contact, mistake),
                })?;
            moving.check(law, contact, &names[contact])?;
            own.kinematics.push(Moving {
                stretch: stretches[contact],
                ..moving
            });
        }
        Ok(own)
    }

    /// How the slip or the gap of a law moves.
    fn moving(
        &self,
        law: &Law<Form<C>>,
        omega: C,
    ) -> Result<Moving<C>, Result<Obstacle, ContactMistake>> {
        let along = |form: &Form<C>, rates: &[Form<C>], omega: C| {
            form.lie(rates, omega).map(Form::trimmed).map_err(Ok)
        };
        let by = |form: &Form<C>| -> Result<Vec<Form<C>>, _> {
            let forces = self.weights.iter();
            forces
                .map(|weights| along(form, weights, C::default()))
                .collect()
        };
        let speed = match law {
            Law::Friction { slip, .. } | Law::Jenkins { slip, .. } => slip.clone(),
            Law::Stop { gap, .. } | Law::Spring { gap, .. } => {
                if !by(gap)?.iter().all(Form::is_zero) {
                    return Err(Err(ContactMistake::Massless));
                }
                along(gap, &self.rates, omega.clone())?
            }
        };
        Ok(Moving {
            drift: along(&speed, &self.rates, omega)?,
            by: by(&speed)?,
            stretch: None,
            speed,
        })
    }

    /// The forces of contacts in these states.
    ///
    /// # Errors
    /// They are not determined, or contradict a law.
    pub fn forces(
        &self,
        laws: &[Law<Form<C>>],
        digits: &[usize],
        names: (&[String], &dyn Fn() -> String),
    ) -> Result<Vec<Form<C>>, ContactMistake> {
        let failed = |obstacle| ContactMistake::Obstacle(names.1(), obstacle);
        let count = laws.len();
        let mut forces = vec![Form::default(); count];
        let mut held = Vec::new();
        let mut linked = Vec::new();
        for (contact, (law, digit)) in laws.iter().zip(digits).enumerate() {
            match self.known(contact, law, *digit).map_err(failed)? {
                // a bound that has forces
                Some(force) if force.has_from(self.rates.len()) => linked.push((contact, force)),
                Some(force) => forces[contact] = force,
                None => held.push(contact),
            }
        }
        // what nothing else that holds acts on is found by itself
        let acts = |contact: usize, other: usize| !self.kinematics[contact].by[other].is_zero();
        let of_others: Vec<usize> = linked.iter().map(|one| one.0).collect();
        let (alone, held): (Vec<usize>, Vec<usize>) = held.iter().partition(|contact| {
            let mut others = held.iter().chain(&of_others);
            others.all(|other| other == *contact || !acts(**contact, *other))
        });
        for contact in alone {
            let (row, rest) = self.holding(contact, &[contact], &forces).map_err(failed)?;
            let own = row.into_iter().next().unwrap_or_default();
            forces[contact] = rest.over(own).map_err(failed)?.trimmed();
        }
        let unknown: Vec<usize> = held
            .iter()
            .copied()
            .chain(linked.iter().map(|one| one.0))
            .collect();
        if unknown.is_empty() {
            return Ok(forces);
        }
        let mut rows = Vec::new();
        for contact in &held {
            rows.push(self.holding(*contact, &unknown, &forces).map_err(failed)?);
        }
        for (contact, force) in &linked {
            rows.push(
                self.linking(*contact, force, &unknown, &forces)
                    .map_err(failed)?,
            );
        }
        if !linked.is_empty() {
            self.check_paradox(laws, &unknown, &rows, names)?;
        }
        let solved = eliminated(rows).map_err(failed)?;
        let solved = solved.ok_or_else(|| ContactMistake::Singular(names.1()))?;
        for (contact, force) in unknown.into_iter().zip(solved) {
            forces[contact] = force;
        }
        Ok(forces)
    }

    /// The force that a law says; `None` where it is what holds.
    fn known(
        &self,
        contact: usize,
        law: &Law<Form<C>>,
        digit: usize,
    ) -> Result<Option<Form<C>>, Obstacle> {
        let none = Form::default();
        let force = match (law, digit) {
            (Law::Friction { .. }, STICK) | (Law::Stop { .. }, CLOSED) => return Ok(None),
            (Law::Friction { bound, .. }, FORWARD) => bound.clone().negative(),
            (Law::Friction { bound, .. }, BACKWARD) => bound.clone(),
            (Law::Jenkins { bound, .. }, GIVES_FORWARD) => bound.clone().negative(),
            (Law::Jenkins { bound, .. }, GIVES_BACKWARD) => bound.clone(),
            (Law::Jenkins { stiffness, .. }, HELD) => {
                let stretch = self.kinematics[contact].stretch;
                let stretch = stretch.map_or_else(Form::default, Form::state);
                stretch.times(stiffness.clone())?.negative()
            }
            (
                Law::Spring {
                    gap,
                    stiffness,
                    damping,
                },
                CLOSED,
            ) => {
                let force = gap.clone().times(stiffness.clone())?;
                let speed = self.kinematics[contact].speed.clone();
                let damped = damping.clone().map(|damping| speed.times(damping));
                force.plus(damped.transpose()?.unwrap_or(none))?.negative()
            }
            _ => none,
        };
        Ok(Some(force))
    }

    /// The row of A and −r of a contact that holds.
    fn holding(
        &self,
        contact: usize,
        unknown: &[usize],
        forces: &[Form<C>],
    ) -> Result<Row<C>, Obstacle> {
        let Moving { drift, by, .. } = &self.kinematics[contact];
        let mut rest = drift.clone();
        for (force, by) in forces.iter().zip(by) {
            if !by.is_zero() && !force.is_zero() {
                rest = rest.plus(by.clone().times(force.clone())?)?;
            }
        }
        let row = unknown.iter().map(|contact| by[*contact].clone()).collect();
        Ok((row, rest.negative()))
    }

    /// The row of a contact whose force is an expression in forces.
    fn linking(
        &self,
        contact: usize,
        force: &Form<C>,
        unknown: &[usize],
        forces: &[Form<C>],
    ) -> Result<Row<C>, Obstacle> {
        let states = self.rates.len();
        let mut row = Vec::new();
        for other in unknown {
            let own = if *other == contact { 1.0 } else { 0.0 };
            row.push(Form::number(own).minus(force.slope(states + other)?)?);
        }
        let of = |state: usize| {
            let contact = state.checked_sub(states)?;
            Some(match unknown.contains(&contact) {
                true => Form::default(),
                false => forces[contact].clone(),
            })
        };
        Ok((row, force.with(&of)?))
    }

    /// Refuses a stop whose force would close its gap by the friction that depends on it: the diagonal of A⁻¹ has what a
    /// force needs to be for a unit of the acceleration that it stops.
    fn check_paradox(
        &self,
        laws: &[Law<Form<C>>],
        unknown: &[usize],
        rows: &[Row<C>],
        (names, mode): (&[String], &dyn Fn() -> String),
    ) -> Result<(), ContactMistake> {
        let constant = rows
            .iter()
            .all(|(row, _)| row.iter().all(Form::is_constant));
        if !constant {
            return Ok(());
        }
        let failed = |obstacle| ContactMistake::Obstacle(mode(), obstacle);
        for (index, contact) in unknown.iter().enumerate() {
            if !matches!(laws[*contact], Law::Stop { .. }) {
                continue;
            }
            let mut unit = rows.to_vec();
            for (row, (_, value)) in unit.iter_mut().enumerate() {
                *value = Form::number(if row == index { 1.0 } else { 0.0 });
            }
            let column = eliminated(unit).map_err(failed)?;
            let column = column.ok_or_else(|| ContactMistake::Singular(mode()))?;
            if column[index].constant.certain() <= 0.0 {
                let name = names[*contact].clone();
                return Err(ContactMistake::Paradox(mode(), name));
            }
        }
        Ok(())
    }
}

impl<C: Measured> Moving<C> {
    /// Refuses a force without influence on what it acts on, or of the wrong sign, where that is a number.
    fn check(
        &self,
        law: &Law<Form<C>>,
        contact: usize,
        name: &str,
    ) -> Result<(), (usize, ContactMistake)> {
        let what = match law {
            Law::Friction { .. } | Law::Jenkins { .. } => Kinematic::Slip,
            Law::Stop { .. } | Law::Spring { .. } => Kinematic::Gap,
        };
        let influence = &self.by[contact];
        let name = name.to_owned();
        match influence
            .is_constant()
            .then_some(influence.constant.certain())
        {
            Some(0.0) => Err((contact, ContactMistake::NoInfluence(name, what))),
            Some(value) if value < 0.0 => Err((contact, ContactMistake::Sign(name, what))),
            _ => Ok(()),
        }
    }
}

/// A row of A and −r.
type Row<C> = (Vec<Form<C>>, Form<C>);

/// The solution of a linear system by elimination, pivots in the order of the unknowns: masses make it positive definite. What
/// cancels but for rounding is zero, so that forces do not hang on what others hold. `None` where it is singular.
fn eliminated<C: Measured>(mut rows: Vec<Row<C>>) -> Result<Option<Vec<Form<C>>>, Obstacle> {
    let count = rows.len();
    let sizes = |row: &Row<C>| row.0.iter().map(Form::largest).fold(0.0, f64::max);
    let mut scales: Vec<f64> = rows.iter().map(sizes).collect();
    for pivot in 0..count {
        let fits = |row: &usize| rows[*row].0[pivot].certain() > NOTHING * scales[*row];
        let Some(row) = (pivot..count).find(fits) else {
            return Ok(None);
        };
        rows.swap(pivot, row);
        scales.swap(pivot, row);
        let (own, value) = rows[pivot].clone();
        for (index, row) in rows.iter_mut().enumerate() {
            if index == pivot || row.0[pivot].is_zero() {
                continue;
            }
            let factor = row.0[pivot].clone().over(own[pivot].clone())?;
            for (entry, own) in row.0.iter_mut().zip(&own).skip(pivot) {
                if !own.is_zero() {
                    let taken = factor.clone().times(own.clone())?;
                    *entry = entry.clone().held_by(taken.negative())?;
                }
            }
            row.0[pivot] = Form::default();
            let taken = factor.times(value.clone())?;
            row.1 = row.1.clone().held_by(taken.negative())?;
        }
    }
    let solved = rows.into_iter().enumerate().map(|(index, (row, value))| {
        let value = value.over(row[index].clone())?;
        Ok(value.trimmed())
    });
    solved.collect::<Result<_, _>>().map(Some)
}
