//! The expressions of a system at given values of its parameters, laid out as the matrices and rows of its modes.

use std::f64::consts::PI;
use std::sync::Arc;

use super::contact::forms::{ContactForms, Written};
use super::contact::law::Products;
use super::contact::mistake::ContactMistake;
use super::evaluation::{Evaluation, FormMode, FormSwitch};
use super::expression::Algebra;
use super::form::{Dual, Form};
use super::mode::{AffineMode, AffineSystem, Exit, Guard, Modes};
use super::monitor::Monitor;
use super::monitored::MonitoredSystem;
use super::rows::{MatrixBy, Row};
use super::series::{Field, Program, Terms};
use super::sliding::{SlidingField, SlidingForms};
use super::system::{Mistake, System, SystemError};
use crate::linalg::Vector;

impl System {
    /// The system at these values of its parameters, with derivatives in those of the indices `varying`.
    ///
    /// # Errors
    /// An expression that is not affine in the states or has no finite value, with its place; two modes that
    /// cannot slide.
    pub fn at(&self, values: &[f64], varying: &[usize]) -> Result<AffineSystem, SystemError> {
        let system = self.evaluated(values, varying)?;
        match self.forcing.is_some() && system.omega.value <= 0.0 {
            true => {
                let mistake = Mistake::Frequency(system.omega.value);
                Err(SystemError::at("forcing", mistake))
            }
            false => Ok(system),
        }
    }

    /// The system where one parameter is zero, whatever that does to the forcing, if all of it is affine in that parameter:
    /// [`AffineSystem::move_to`] leads from it to other values.
    pub fn origin(&self, values: &[f64], parameter: usize) -> Option<AffineSystem> {
        if self.integrated || self.products.is_some() || !self.is_affine_in(parameter) {
            return None;
        }
        let mut values = values.to_vec();
        values[parameter] = 0.0;
        let origin = self.evaluated(&values, &[parameter]).ok()?;
        // a sliding field is affine, too, where the surface stays and with it the difference of the fields on its sides
        let stays = |by: &Vector| by.iter().all(|by| *by == 0.0);
        let surfaces = origin.modes.written().iter();
        let surfaces = surfaces.filter_map(|mode| mode.surface.as_ref());
        let flat = surfaces.flat_map(|row| &row.by).all(stays);
        let alike = self.sliding.iter().all(|sides| {
            let [below, above] =
                sides.map(|side| origin.modes[side].matrix.by[0].rows(0, origin.states));
            below == above
        });
        // and where what they take over from the modes on their sides is no product of what changes
        let sliding = origin.modes.written().iter();
        let sliding = sliding.filter(|mode| mode.sides.is_some());
        let exits = sliding.flat_map(|mode| mode.guards.iter().flat_map(|guard| &guard.exits));
        let plain = exits
            .flat_map(|exit| &exit.reset.by)
            .all(|by| by.iter().all(|by| *by == 0.0));
        (flat && alike && plain && origin.program.made() == 0).then_some(origin)
    }

    /// Whether every expression is affine in a parameter.
    fn is_affine_in(&self, parameter: usize) -> bool {
        let name = self.source.parameters.names().nth(parameter);
        let mut known: Vec<(&str, Option<u32>)> = Vec::new();
        for (define, expression) in self.source.define.names().zip(&self.define) {
            let degree = expression.degree(&|one| degree_of(one, name, &known));
            known.push((define, degree));
        }
        let of = |one: &str| degree_of(one, name, &known);
        self.expressions()
            .all(|expression| expression.degree(&of).is_some())
    }

    /// The same as [`System::at`] with the forms of its monitors laid out in it.
    ///
    /// # Errors
    /// As [`System::at`]; an expression of a monitor that has no finite value. Of the modes that contacts make those of these
    /// numbers are laid out alone.
    pub fn monitored(
        &self,
        values: &[f64],
        varying: &[usize],
        modes: &[usize],
    ) -> Result<MonitoredSystem, SystemError> {
        self.evaluated_with(values, varying, (&self.monitors, modes))
    }

    /// The same as [`System::at`] for a forcing of any frequency.
    fn evaluated(&self, values: &[f64], varying: &[usize]) -> Result<AffineSystem, SystemError> {
        Ok(self.evaluated_with(values, varying, (&[], &[]))?.system)
    }

    /// The same with the forms of monitors.
    fn evaluated_with(
        &self,
        values: &[f64],
        varying: &[usize],
        (monitors, asked): (&[Monitor], &[usize]),
    ) -> Result<MonitoredSystem, SystemError> {
        let parameter = Dual::parameters(values, varying);
        let evaluation = Evaluation::new(self, &parameter, Dual::number(PI))?;
        let omega = evaluation.frequency()?;
        let names = self.source.modes.names();
        if let Some(products) = &self.products {
            return self.with_contacts(&evaluation, (products, omega), (monitors, asked));
        }
        let within = evaluation
            .modes()?
            .into_iter()
            .zip(names)
            .map(|(mode, name)| {
                mode.within().map_err(|obstacle| {
                    let mistake = Mistake::Within(name.to_owned(), obstacle);
                    SystemError::at(format!("modes.{name}"), mistake)
                })
            });
        let modes = within.collect::<Result<Vec<FormMode>, _>>()?;
        let observed = self.observed(&evaluation, &modes, monitors)?;
        let mut numerical = vec![None; self.sliding.len()];
        loop {
            match self.laid_out(&modes, omega, &numerical, &observed) {
                // what has no affine field slides by one that is not
                Err((error, Some(index))) if numerical[index].is_none() => {
                    let [first, second] = self.sliding[index].map(|side| &modes[side]);
                    let forms = SlidingForms::new(first, second, self.sliding[index], omega);
                    numerical[index] = Some(forms.map_err(|_| error)?);
                }
                result => return result.map_err(|(error, _)| error),
            }
        }
    }

    /// The forms of monitors in every mode, as they are within it.
    fn observed(
        &self,
        evaluation: &Evaluation<Dual>,
        modes: &[FormMode],
        monitors: &[Monitor],
    ) -> Result<Vec<Vec<Form>>, SystemError> {
        let forms = of_monitors(evaluation, monitors)?;
        let of_mode = |mode: Option<&FormMode>| {
            let within = monitors.iter().zip(&forms).map(|(monitor, form)| {
                let within = mode.map_or_else(|| Ok(form.clone()), |mode| mode.of_mode(form));
                within.map_err(|obstacle| monitor.failed(obstacle))
            });
            within.collect::<Result<Vec<Form>, _>>()
        };
        let of_file = modes.iter().map(Some);
        let all = of_file.chain(self.sliding.iter().map(|_| None));
        all.map(of_mode).collect()
    }

    /// The system with the terms of all forms as components of z, those observed in the modes included; the index of the
    /// sliding mode that fails.
    fn laid_out(
        &self,
        modes: &[FormMode],
        omega: Dual,
        numerical: &[Option<SlidingForms>],
        observed: &[Vec<Form>],
    ) -> Result<MonitoredSystem, (SystemError, Option<usize>)> {
        let forms = modes.iter().flat_map(FormMode::forms);
        let sliding = numerical.iter().flatten();
        let sliding = sliding.flat_map(|forms| forms.rates.iter().chain(&forms.falls));
        let forms: Vec<&Form> = forms
            .chain(sliding)
            .chain(observed.iter().flatten())
            .collect();
        let harmonics = forms.iter().map(|form| form.highest()).max().unwrap_or(0);
        let mut terms = Terms::new(self.source.states.len(), harmonics);
        forms.iter().for_each(|form| terms.add(form));
        let shape = Shape {
            states: self.source.states.len(),
            harmonics,
            terms,
        };
        let program = Arc::new(shape.terms.program().clone());
        let modes = modes.iter().enumerate();
        let modes = modes.map(|(number, mode)| shape.mode(number, mode, omega));
        let mut system = AffineSystem {
            states: shape.states,
            harmonics,
            omega,
            modes: Modes::of(modes.collect()),
            program: program.clone(),
        };
        for (index, sides) in self.sliding.iter().enumerate() {
            let own = self.modes.len() + index;
            let sliding = numerical[index].as_ref().map(|forms| SlidingField {
                falls: forms.falls.each_ref().map(|form| shape.row(form)),
                matrix: shape.matrix(&forms.rates, omega),
            });
            system.slide(self, own, *sides, sliding)?;
        }
        for index in 0..self.sliding.len() {
            system.watch_sides(self.modes.len() + index);
        }
        let how = (self.flow_tolerance(), self.integrated);
        for mode in system.modes.written_mut() {
            mode.field = field(mode, &program, how);
        }
        let rows = observed.iter();
        let rows = rows.map(|forms| forms.iter().map(|form| shape.row(form)).collect());
        Ok(MonitoredSystem {
            forms: rows.enumerate().collect(),
            system,
        })
    }

    /// The system with contacts: modes are made when they are asked for where all of it is affine, and otherwise at once.
    fn with_contacts(
        &self,
        evaluation: &Evaluation<'_, '_, Dual>,
        (products, omega): (&Products, Dual),
        (monitors, asked): (&[Monitor], &[usize]),
    ) -> Result<MonitoredSystem, SystemError> {
        let names: Vec<String> = self.source.contacts.names().map(str::to_owned).collect();
        let at = |(contact, mistake): (usize, ContactMistake)| {
            let path = format!("contacts.{}", names[contact]);
            SystemError::at(path, Mistake::Contact(mistake))
        };
        let written = Written {
            names: names.clone(),
            laws: evaluation.laws()?,
            stretches: &self.stretches,
            products: products.clone(),
            omega,
        };
        let forms = ContactForms::new(evaluation.modes()?, written).map_err(at)?;
        let section = evaluation.section()?;
        let states = self.source.states.len();
        let how = (self.flow_tolerance(), self.integrated);
        let monitored = of_monitors(evaluation, monitors)?;
        let observed_in = |number: usize, mode: &FormMode| -> Result<Vec<Form>, SystemError> {
            let of_mode = |(monitor, form): (&Monitor, &Form)| {
                // a mode whose forces are not determined has no value of theirs
                let form = forms.of_mode(form, number).unwrap_or_default();
                let form = mode.of_mode(&form);
                form.map_err(|obstacle| monitor.failed(obstacle))
            };
            monitors.iter().zip(&monitored).map(of_mode).collect()
        };
        let of_section = section.as_ref().map(|mode| &mode.switches[0].guard);
        if !(forms.is_affine() && of_section.is_none_or(|form| form.beyond.is_empty())) {
            let count = forms.few().map_err(|mistake| at((0, mistake)))?;
            let mut obstructions = Vec::new();
            let modes = (0..count).map(|number| {
                forms.mode(number).unwrap_or_else(|mistake| {
                    obstructions.push((number, mistake));
                    still(states)
                })
            });
            let mut modes: Vec<FormMode> = modes.collect();
            modes.extend(section);
            let observed = modes.iter().enumerate();
            let observed = observed.map(|(number, mode)| match number < count {
                true => observed_in(number, mode),
                false => Ok(Vec::new()),
            });
            let observed = observed.collect::<Result<Vec<_>, _>>()?;
            let mut system = self
                .laid_out(&modes, omega, &[], &observed)
                .map_err(|(error, _)| error)?;
            for (number, mistake) in obstructions {
                system.system.modes.written_mut()[number].obstruction = Some(mistake);
            }
            return Ok(system);
        }
        // the modes that monitors are asked for in, with what these have in them
        let asked: &[usize] = if monitors.is_empty() { &[] } else { asked };
        let known = asked.iter().map(|number| {
            let mode = forms.mode(*number).unwrap_or_else(|_| still(states));
            let observed = observed_in(*number, &mode)?;
            Ok((*number, mode, observed))
        });
        let known = known.collect::<Result<Vec<_>, SystemError>>()?;
        let observed = || known.iter().flat_map(|(_, _, observed)| observed);
        let highest = observed().chain(of_section).map(Form::highest).max();
        let harmonics = forms.highest().max(highest.unwrap_or(0));
        let mut terms = Terms::new(states, harmonics);
        observed().for_each(|form| terms.add(form));
        let own = Shape {
            states,
            harmonics,
            terms,
        };
        let program = Arc::new(own.terms.program().clone());
        let rows = known.iter().map(|(number, _, observed)| {
            let rows = observed.iter().map(|form| own.row(form));
            (*number, rows.collect())
        });
        let rows = rows.collect();
        let count = forms.count();
        let all = count + usize::from(section.is_some());
        let laid = move |shape: &Shape, number: usize, mode: &FormMode, program: &Arc<Program>| {
            let mut mode = shape.mode(number, mode, omega);
            mode.field = field(&mode, program, how);
            mode
        };
        let made = known
            .iter()
            .map(|(number, mode, _)| (*number, laid(&own, *number, mode, &program)));
        let made: Vec<(usize, AffineMode)> = made.collect();
        let of = program.clone();
        let has_terms = program.made() > 0;
        let make = move |number: usize| {
            if let Some((_, mode)) = made.iter().find(|(known, _)| *known == number) {
                return mode.clone();
            }
            let made = match &section {
                Some(section) if number == count => Ok(section.clone()),
                // beside terms of monitors only the modes that were asked for are laid out
                _ if has_terms => Ok(still(states)),
                _ => forms.mode(number),
            };
            let obstruction = made.as_ref().err().cloned();
            let made = made.unwrap_or_else(|_| still(states));
            let shape = Shape {
                states,
                harmonics,
                terms: Terms::of(&of),
            };
            AffineMode {
                obstruction,
                ..laid(&shape, number, &made, &of)
            }
        };
        let system = AffineSystem {
            states,
            harmonics,
            omega,
            modes: Modes::made(all, Box::new(make)),
            program,
        };
        Ok(MonitoredSystem {
            system,
            forms: rows,
        })
    }
}

/// The expressions of monitors as forms, whatever the mode.
fn of_monitors(
    evaluation: &Evaluation<Dual>,
    monitors: &[Monitor],
) -> Result<Vec<Form>, SystemError> {
    let forms = monitors
        .iter()
        .map(|monitor| evaluation.form(&|| monitor.path(), &monitor.expression));
    forms.collect()
}

/// A mode in which nothing moves.
fn still(states: usize) -> FormMode {
    FormMode {
        rates: vec![Form::default(); states],
        switches: Vec::new(),
        held: Vec::new(),
    }
}

/// How the components of z move in a mode that are not those of states and phase.
fn field(mode: &AffineMode, program: &Arc<Program>, how: (f64, bool)) -> Field {
    let exits = || mode.guards.iter().flat_map(|guard| &guard.exits);
    let conditions = exits().flat_map(|exit| exit.conditions.iter().cloned());
    let reset = exits().flat_map(|exit| (0..mode.states).map(|row| exit.reset.row(row)));
    let guards = mode.guards.iter().map(|guard| guard.row.clone());
    let along = guards.chain(mode.surface.clone());
    Field::new(program, &mode.matrix, (along, conditions.chain(reset)), how)
}

/// The degree in a parameter of what a name stands for.
fn degree_of(one: &str, parameter: Option<&str>, known: &[(&str, Option<u32>)]) -> Option<u32> {
    let mut known = known.iter();
    match known.find(|(name, _)| *name == one) {
        Some((_, degree)) => *degree,
        None => Some(u32::from(Some(one) == parameter)),
    }
}

/// Where what stands in z.
struct Shape {
    states: usize,
    harmonics: usize,
    terms: Terms,
}

impl Shape {
    fn size(&self) -> usize {
        self.terms.program().size()
    }

    fn row(&self, form: &Form) -> Row {
        let mut row = Row::zero(self.size());
        for (column, value) in self.terms.coefficients(form) {
            row.add(column, value);
        }
        row
    }

    fn matrix(&self, rates: &[Form], omega: Dual) -> MatrixBy {
        let mut matrix = MatrixBy::zero(self.size(), self.size());
        for (state, rate) in rates.iter().enumerate() {
            for (column, value) in self.terms.coefficients(rate) {
                matrix.add(state, column, value);
            }
        }
        for h in 1..=self.harmonics {
            let cosine = self.states + 2 * h - 1;
            let mut turn = |row: usize, column: usize, factor: f64| {
                matrix.at[(row, column)] = factor * omega.value;
                for (by, derivative) in matrix.by.iter_mut().zip(omega.by) {
                    by[(row, column)] = factor * derivative;
                }
            };
            turn(cosine, cosine + 1, -(h as f64));
            turn(cosine + 1, cosine, h as f64);
        }
        matrix
    }

    fn mode(&self, number: usize, mode: &FormMode, omega: Dual) -> AffineMode {
        let held = mode.held.iter().filter(|form| form.beyond.is_empty());
        AffineMode {
            states: self.states,
            field: Field::default(),
            guards: self.guards(number, &mode.switches),
            surface: None,
            held: held.map(|form| self.row(form)).collect(),
            sides: None,
            obstruction: None,
            matrix: self.matrix(&mode.rates, omega),
        }
    }

    /// Guards of a mode in the order of the file, each with all its exits.
    fn guards(&self, mode: usize, switches: &[FormSwitch]) -> Vec<Guard> {
        let mut guards: Vec<Guard> = Vec::new();
        for (index, switch) in switches.iter().enumerate() {
            let exit = self.exit(switch);
            let row = self.row(&switch.guard);
            let known = match switch.group {
                Some(group) => guards.get_mut(group),
                None => guards.iter_mut().find(|guard| guard.row == row),
            };
            match known {
                Some(guard) => guard.exits.push(exit),
                None => guards.push(Guard {
                    row,
                    exits: vec![exit],
                    written: Some([mode, index]),
                }),
            }
        }
        guards
    }

    fn exit(&self, switch: &FormSwitch) -> Exit {
        let mut reset = MatrixBy::zero(self.states, self.size());
        reset.at.fill_with_identity();
        for (state, form) in &switch.reset {
            reset.at[(*state, *state)] = 0.0;
            for (column, value) in self.terms.coefficients(form) {
                reset.add(*state, column, value);
            }
        }
        Exit {
            to: switch.to,
            reset,
            conditions: switch
                .conditions
                .iter()
                .map(|form| self.row(form))
                .collect(),
            rest: switch.rest,
            tangent: switch.tangent,
            name: switch.name.clone(),
        }
    }
}
