//! The modes that contacts make, laid out: when they are asked for where all of it is affine, and otherwise at once.

use std::sync::Arc;

use super::contact::forms::{ContactForms, Written};
use super::contact::law::Products;
use super::contact::mistake::ContactMistake;
use super::dual::Dual;
use super::evaluation::{Evaluation, FormMode};
use super::form::Form;
use super::mode::{AffineMode, AffineSystem, Modes};
use super::monitor::Monitor;
use super::monitored::{MonitoredSystem, of_monitors};
use super::program::{Program, Terms};
use super::shape::{Shape, field, still};
use super::system::{Mistake, System, SystemError};

/// What the modes of a system with contacts are made of.
struct Maker {
    forms: ContactForms,
    /// A cycle without switches has the section in a mode of its own.
    section: Option<FormMode>,
    states: usize,
    omega: Dual,
    /// How flows that are not exact are followed.
    how: (f64, bool),
}

/// The modes of a system with contacts, and its monitors.
pub(super) struct ContactModes<'a> {
    maker: Maker,
    monitors: &'a [Monitor],
    /// Their expressions, whatever the mode.
    monitored: Vec<Form>,
}

/// All modes, as forms.
pub(super) struct AllModes {
    /// The modes.
    pub modes: Vec<FormMode>,
    /// The forms of monitors in each.
    pub observed: Vec<Vec<Form>>,
    /// Modes whose forces make no motion.
    pub obstructions: Vec<(usize, ContactMistake)>,
}

/// A mode that is asked for with its number, and the forms of monitors in it.
type Asked = (usize, FormMode, Vec<Form>);

/// What is wrong with a contact of this name.
fn wrong(contact: &str, mistake: ContactMistake) -> SystemError {
    SystemError::at(format!("contacts.{contact}"), Mistake::Contact(mistake))
}

impl<'a> ContactModes<'a> {
    /// Of a system, evaluated.
    ///
    /// # Errors
    /// What is wrong with a contact or an expression, with its place.
    pub fn new(
        system: &System,
        evaluation: &Evaluation<'_, '_, Dual>,
        (products, omega): (&Products, Dual),
        monitors: &'a [Monitor],
    ) -> Result<ContactModes<'a>, SystemError> {
        let contacts = &system.source.contacts;
        let written = Written {
            names: contacts.names().map(str::to_owned).collect(),
            laws: evaluation.laws()?,
            stretches: &system.stretches,
            products: products.clone(),
            omega,
        };
        let forms = ContactForms::new(evaluation.modes()?, written);
        let forms = forms.map_err(|(contact, mistake)| {
            wrong(contacts.names().nth(contact).unwrap_or_default(), mistake)
        })?;
        let maker = Maker {
            forms,
            section: evaluation.section()?,
            states: system.source.states.len(),
            omega,
            how: (system.flow_tolerance(), system.integrated),
        };
        Ok(ContactModes {
            maker,
            monitors,
            monitored: of_monitors(evaluation, monitors)?,
        })
    }

    /// The forms of monitors in a mode; those of forces that are not determined have no value.
    fn observed(&self, number: usize, mode: &FormMode) -> Result<Vec<Form>, SystemError> {
        let of_mode = |(monitor, form): (&Monitor, &Form)| {
            let form = self.maker.forms.of_mode(form, number).unwrap_or_default();
            let form = mode.of_mode(&form);
            form.map_err(|obstacle| monitor.failed(obstacle))
        };
        self.monitors
            .iter()
            .zip(&self.monitored)
            .map(of_mode)
            .collect()
    }

    /// All modes, where something is not affine.
    ///
    /// # Errors
    /// More modes than are made at once; an expression of a monitor that has no finite value.
    pub fn all_at_once(&self) -> Result<Option<AllModes>, SystemError> {
        let Maker { forms, states, .. } = &self.maker;
        let of_section = self.maker.of_section();
        if forms.is_affine() && of_section.is_none_or(|form| form.beyond.is_empty()) {
            return Ok(None);
        }
        let few = forms.few();
        let count = few.map_err(|mistake| wrong(forms.first(), mistake))?;
        let mut obstructions = Vec::new();
        let modes = (0..count).map(|number| {
            forms.mode(number).unwrap_or_else(|mistake| {
                obstructions.push((number, mistake));
                still(*states)
            })
        });
        let mut modes: Vec<FormMode> = modes.collect();
        let observed = modes.iter().enumerate();
        let observed = observed.map(|(number, mode)| self.observed(number, mode));
        let mut observed = observed.collect::<Result<Vec<_>, _>>()?;
        if let Some(section) = &self.maker.section {
            modes.push(section.clone());
            observed.push(Vec::new());
        }
        Ok(Some(AllModes {
            modes,
            observed,
            obstructions,
        }))
    }

    /// The system whose modes are made when they are asked for; monitors have their forms in those of these numbers.
    ///
    /// # Errors
    /// An expression of a monitor that has no finite value.
    pub fn on_demand(self, asked: &[usize]) -> Result<MonitoredSystem, SystemError> {
        let asked: &[usize] = if self.monitors.is_empty() { &[] } else { asked };
        let asked = asked.iter().map(|number| {
            let mode = self.maker.forms.mode(*number);
            let mode = mode.unwrap_or_else(|_| still(self.maker.states));
            let observed = self.observed(*number, &mode)?;
            Ok((*number, mode, observed))
        });
        let asked = asked.collect::<Result<Vec<Asked>, SystemError>>()?;
        let observed = || asked.iter().flat_map(|(_, _, observed)| observed);
        let maker = self.maker;
        let highest = observed()
            .chain(maker.of_section())
            .map(Form::highest)
            .max();
        let harmonics = maker.forms.highest().max(highest.unwrap_or(0));
        let mut terms = Terms::new(maker.states, harmonics);
        observed().for_each(|form| terms.add(form));
        let (states, omega) = (maker.states, maker.omega);
        let shape = Shape {
            states,
            harmonics,
            terms,
        };
        let forms = asked.iter().map(|(number, _, observed)| {
            let rows = observed.iter().map(|form| shape.row(form));
            (*number, rows.collect())
        });
        let forms = forms.collect();
        let program = Arc::new(shape.terms.program().clone());
        let signs = maker.forms.signs();
        let count = maker.forms.count() + usize::from(maker.section.is_some());
        let known = asked
            .into_iter()
            .map(|(number, mode, _)| (number, maker.laid_out(&shape, number, &mode, &program)));
        let known: Vec<(usize, AffineMode)> = known.collect();
        let of = program.clone();
        let make = move |number: usize| maker.mode(number, (harmonics, &of), &known);
        let system = AffineSystem {
            states,
            harmonics,
            omega,
            modes: Modes::made(count, Box::new(make)),
            program,
            signs,
        };
        Ok(MonitoredSystem { system, forms })
    }
}

impl Maker {
    /// The section of a cycle without switches.
    fn of_section(&self) -> Option<&Form> {
        self.section.as_ref().map(|mode| &mode.switches[0].guard)
    }

    /// The mode of a number; some are known.
    fn mode(
        &self,
        number: usize,
        (harmonics, program): (usize, &Arc<Program>),
        known: &[(usize, AffineMode)],
    ) -> AffineMode {
        if let Some((_, mode)) = known.iter().find(|(known, _)| *known == number) {
            return mode.clone();
        }
        let made = match &self.section {
            Some(section) if number == self.forms.count() => Ok(section.clone()),
            // beside terms of monitors only the modes that were asked for are laid out
            _ if program.made() > 0 => Ok(still(self.states)),
            _ => self.forms.mode(number),
        };
        let obstruction = made.as_ref().err().cloned();
        let made = made.unwrap_or_else(|_| still(self.states));
        let shape = Shape {
            states: self.states,
            harmonics,
            terms: Terms::of(program),
        };
        AffineMode {
            obstruction,
            ..self.laid_out(&shape, number, &made, program)
        }
    }

    fn laid_out(
        &self,
        shape: &Shape,
        number: usize,
        mode: &FormMode,
        program: &Arc<Program>,
    ) -> AffineMode {
        let mut mode = shape.mode(number, mode, self.omega);
        mode.field = field(&mode, program, self.how);
        mode
    }
}
