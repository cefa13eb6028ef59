//! The expressions of a system at given values of its parameters, laid out as the matrices and rows of its modes.

use std::f64::consts::PI;
use std::sync::Arc;

use super::algebra::Algebra;
use super::dual::Dual;
use super::evaluation::{Evaluation, FormMode};
use super::form::Form;
use super::mode::{AffineSystem, Modes};
use super::monitor::Monitor;
use super::monitored::{MonitoredSystem, of_monitors};
use super::products::ContactModes;
use super::program::Terms;
use super::shape::{Shape, field};
use super::sliding::{SlidingField, SlidingForms};
use super::system::{Mistake, System, SystemError};

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
        self.evaluated_by(&parameter, (monitors, asked))
    }

    /// The same where parameters, by their index, are these numbers.
    pub(super) fn evaluated_by(
        &self,
        parameter: &dyn Fn(usize) -> Dual,
        (monitors, asked): (&[Monitor], &[usize]),
    ) -> Result<MonitoredSystem, SystemError> {
        let evaluation = Evaluation::new(self, parameter, Dual::number(PI))?;
        let omega = evaluation.frequency()?;
        let names = self.source.modes.names();
        if let Some(products) = &self.products {
            let modes = ContactModes::new(self, &evaluation, (products, omega), monitors)?;
            let Some(all) = modes.all_at_once()? else {
                return modes.on_demand(asked);
            };
            let laid_out = self.laid_out(&all.modes, omega, &[], &all.observed);
            let mut system = laid_out.map_err(|(error, _)| error)?;
            for (number, mistake) in all.obstructions {
                system.system.modes.written_mut()[number].obstruction = Some(mistake);
            }
            return Ok(system);
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
            signs: Vec::new(),
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
}
