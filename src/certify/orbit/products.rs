//! The modes that contacts make, for a proof: those that a sequence names, as formulas.
//!
//! The law of every contact says its force, its guards and where these lead; forces that hold are the solution of linear
//! equations ([`crate::affine::contact`]). Here all of it is done with formulas instead of doubles, and what it hangs on, whether a
//! pivot is zero and which sign a factor has, is decided for a whole range of the parameter ([`Ranged`]). What comes out
//! is modes like those that a user writes down.

use std::collections::BTreeSet;

use super::OpenOrbit;
use super::exact::{Formula, NamePolynomial};
use super::ranged::Ranged;
use crate::affine::contact::forms::{ContactForms, Written};
use crate::affine::dual::Coefficient;
use crate::affine::evaluation::{Evaluation, FormMode};
use crate::affine::orbit::Zone;
use crate::affine::system::{System, SystemError};
use crate::interval::{Decimal, Interval, PI};

/// Which modes are needed, and where.
pub struct Needed<'a> {
    /// Values of the parameters.
    pub values: &'a [Decimal],
    /// Index of the one that varies.
    pub parameter: usize,
    /// Its values.
    pub range: Interval,
    /// Its unit.
    pub unit: f64,
    /// Numbers of modes, in order.
    pub modes: Vec<usize>,
}

impl<'a> Needed<'a> {
    /// Those that zones name, with these values of the parameters, next to some of the one that varies and in its unit.
    pub fn new(
        values: &'a [Decimal],
        parameter: usize,
        (range, unit): (Interval, f64),
        zones: impl Iterator<Item = &'a Zone>,
    ) -> Needed<'a> {
        let modes: BTreeSet<usize> = zones.map(|zone| zone.mode).collect();
        Needed {
            values,
            parameter,
            range,
            unit,
            modes: modes.into_iter().collect(),
        }
    }
}

/// The modes that contacts make, by their numbers.
#[derive(Clone, Debug)]
pub struct ProductModes {
    /// Their numbers, and what they are.
    modes: Vec<(usize, FormMode<NamePolynomial>, FormMode<Formula>)>,
    /// Of every switch of each, the guard that it belongs to.
    pub guards: Vec<Vec<usize>>,
    /// Values of the parameter for which they are so.
    pub range: Interval,
}

/// Powers of two by which the unit of the parameter is divided until all that the modes hang on is decided.
const HALVINGS: [i32; 7] = [0, 1, 2, 4, 8, 12, 24];

impl ProductModes {
    /// Of a system with contacts; `None` of one without.
    ///
    /// # Errors
    /// Something that they hang on is not decided, or not covered.
    pub fn of(system: &System, needed: &Needed) -> Result<Option<ProductModes>, OpenOrbit> {
        let Some(products) = &system.products else {
            return Ok(None);
        };
        let fits = needed.values.len() == system.source.parameters.0.len()
            && needed.modes.iter().all(|mode| *mode < products.count())
            && [needed.range.low, needed.range.high, needed.unit]
                .iter()
                .all(|x| x.is_finite())
            && needed.unit > 0.0;
        if !fits {
            return Err(OpenOrbit::Sequence);
        }
        let mut made = Err(OpenOrbit::Sequence);
        for halvings in HALVINGS {
            let beside = Interval::around(0.0, needed.unit * 2.0_f64.powi(-halvings));
            made = ProductModes::over(system, needed, needed.range + beside);
            if made.is_ok() {
                break;
            }
        }
        made.map(Some)
    }

    /// Over a range of the parameter.
    fn over(system: &System, needed: &Needed, range: Interval) -> Result<ProductModes, OpenOrbit> {
        let names: Vec<&str> = system.source.parameters.names().collect();
        let parameter = |index: usize| {
            let value = match index == needed.parameter {
                true => range,
                false => needed.values[index].interval(),
            };
            Ranged::named(names[index], value)
        };
        let forms = forms(system, &parameter)?;
        if forms.signs().iter().any(|number| number.range().low < 0.0) {
            return Err(OpenOrbit::Signs);
        }
        let made = needed.modes.iter().map(|number| {
            let mode = FormMode {
                held: forms.kept(*number),
                ..forms.mode(*number).map_err(OpenOrbit::Contacts)?
            };
            let exact = mode.convert(&|one: &Ranged| Ok::<_, OpenOrbit>(one.formula.clone()))?;
            let formula =
                mode.convert(&|one: &Ranged| one.formula.formula().ok_or(OpenOrbit::Written))?;
            let (exact, formula) = exact.zip(formula).ok_or(OpenOrbit::Written)?;
            Ok((*number, exact, formula))
        });
        let modes = made.collect::<Result<Vec<_>, OpenOrbit>>()?;
        let guards = modes.iter().map(|(_, exact, _)| exact.guards()).collect();
        Ok(ProductModes {
            modes,
            guards,
            range,
        })
    }

    /// Their numbers.
    pub fn numbers(&self) -> impl Iterator<Item = usize> {
        self.modes.iter().map(|(number, ..)| *number)
    }

    /// As formulas.
    pub fn exact(&self) -> Vec<FormMode<NamePolynomial>> {
        self.modes
            .iter()
            .map(|(_, exact, _)| exact.clone())
            .collect()
    }

    /// With other coefficients, of the parameters by their names.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn values<C: Coefficient>(
        &self,
        meaning: &impl Fn(&str) -> Option<C>,
    ) -> Result<Vec<FormMode<C>>, OpenOrbit> {
        let value = |formula: &Formula| formula.value(meaning).map_err(|_| OpenOrbit::Numbers);
        let modes = self.modes.iter();
        let modes = modes.map(|(.., formula)| formula.convert(&value)?.ok_or(OpenOrbit::Numbers));
        modes.collect()
    }
}

/// What the modes are made of.
fn forms(
    system: &System,
    parameter: &dyn Fn(usize) -> Ranged,
) -> Result<ContactForms<Ranged>, OpenOrbit> {
    let evaluated = || {
        let evaluation = Evaluation::new(system, parameter, Ranged::named("pi", PI))?;
        let laws = evaluation.laws()?;
        Ok((evaluation.frequency()?, evaluation.modes()?, laws))
    };
    let evaluated = evaluated().map_err(|error: SystemError| OpenOrbit::System(error.path));
    let (omega, modes, laws) = evaluated?;
    let products = system.products.clone();
    let written = Written {
        names: system.source.contacts.names().map(str::to_owned).collect(),
        laws,
        stretches: &system.stretches,
        products: products.unwrap_or_default(),
        omega,
    };
    ContactForms::new(modes, written).map_err(|(_, mistake)| OpenOrbit::Contacts(mistake))
}
