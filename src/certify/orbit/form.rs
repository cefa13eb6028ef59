//! Expressions of a system as affine forms in states and forcing, with coefficients of any kind.

use crate::affine::expression::{Algebra, Expression, Flaw, Function, Obstacle, Operation};
use crate::affine::system::{Mistake, Switch, System, SystemError};

/// What is not affine.
const NOT_AFFINE: Obstacle = Obstacle::Deep;

/// What the coefficients of a form are: numbers that depend on parameters only.
pub trait Coefficient: Algebra + Default + PartialEq {
    /// Combination of both with weights that are doubles.
    fn sum(self, weight: f64, other: Self, other_weight: f64) -> Self;
    /// Product.
    fn times(self, other: Self) -> Self;
    /// The whole number that it is, whatever the parameters.
    fn whole(&self) -> Option<f64>;
    /// Itself, unless it is no finite number.
    ///
    /// # Errors
    /// Where it is not.
    fn finite(self) -> Result<Self, Obstacle>;
}

/// Highest multiple of the phase.
const HIGHEST: usize = 16;

/// An affine form Σ aᵢxᵢ + a + Σ (cₕ cos hφ + sₕ sin hφ) in the states x and the phase φ, whose coefficients
/// have derivatives in the parameters.
///
/// What it depends on is told by the expression and not by values: 0·x depends on x.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form<C> {
    /// aᵢ, up to the last state that occurs.
    pub states: Vec<C>,
    /// a.
    pub constant: C,
    /// (cₕ, sₕ) for h = 1, 2, …
    pub harmonics: Vec<[C; 2]>,
    /// The whole number of times that it has the phase itself, on the way into `sin` and `cos`.
    phase: Option<f64>,
}

impl<C: Coefficient> Form<C> {
    /// The state with this index.
    pub fn state(index: usize) -> Form<C> {
        let mut states = vec![C::default(); index + 1];
        states[index] = C::number(1.0);
        Form {
            states,
            ..Form::default()
        }
    }

    /// The phase φ.
    pub fn phase() -> Form<C> {
        Form {
            phase: Some(1.0),
            ..Form::default()
        }
    }

    /// A number that depends on parameters only.
    pub fn constant(constant: C) -> Form<C> {
        Form {
            constant,
            ..Form::default()
        }
    }

    fn is_constant(&self) -> bool {
        self.is_periodic() && self.harmonics.is_empty()
    }

    /// Whether it depends on cosines and sines of the phase only.
    fn is_periodic(&self) -> bool {
        self.states.is_empty() && self.phase.is_none()
    }

    /// Every coefficient through a function that keeps zero.
    fn map(mut self, change: impl Fn(C) -> C) -> Form<C> {
        let harmonics = self.harmonics.iter_mut().flatten();
        let terms = self.states.iter_mut().chain([&mut self.constant]);
        for term in terms.chain(harmonics) {
            *term = change(std::mem::take(term));
        }
        self
    }

    fn scaled(self, factor: C) -> Result<Form<C>, Obstacle> {
        let times = |phase: f64| Ok(phase * factor.whole().ok_or(Obstacle::Phase)?);
        let phase = self.phase.map(times).transpose()?;
        let scaled = self.map(|term| term.times(factor.clone()));
        Form { phase, ..scaled }.finite()
    }

    fn sum(mut self, other: Form<C>, sign: f64) -> Result<Form<C>, Obstacle> {
        let states = self.states.len().max(other.states.len());
        self.states.resize(states, C::default());
        for (term, more) in self.states.iter_mut().zip(other.states) {
            *term = std::mem::take(term).sum(1.0, more, sign);
        }
        self.constant = self.constant.sum(1.0, other.constant, sign);
        let harmonics = self.harmonics.len().max(other.harmonics.len());
        self.harmonics.resize(harmonics, Default::default());
        for (pair, more) in self.harmonics.iter_mut().zip(other.harmonics) {
            for (term, more) in pair.iter_mut().zip(more) {
                *term = std::mem::take(term).sum(1.0, more, sign);
            }
        }
        self.phase = match (self.phase, other.phase) {
            (None, None) => None,
            (one, other) => Some(one.unwrap_or(0.0) + sign * other.unwrap_or(0.0)),
        };
        self.finite()
    }

    /// Product of two forms in cosines and sines: cos m cos n = (cos(m − n) + cos(m + n))/2, and so on.
    fn periodic_product(&self, other: &Form<C>) -> Result<Form<C>, Obstacle> {
        let terms = |form: &Form<C>| {
            let mut terms = vec![[form.constant.clone(), C::default()]];
            terms.extend_from_slice(&form.harmonics);
            terms
        };
        let (one, other) = (terms(self), terms(other));
        let highest = one.len() + other.len() - 2;
        if highest > HIGHEST {
            return Err(Obstacle::Phase);
        }
        let mut product: Vec<[C; 2]> = vec![Default::default(); highest + 1];
        for (m, [c1, s1]) in one.iter().enumerate() {
            for (n, [c2, s2]) in other.iter().enumerate() {
                let of = |one: &C, other: &C| one.clone().times(other.clone());
                let (cc, ss, cs, sc) = (of(c1, c2), of(s1, s2), of(c1, s2), of(s1, c2));
                let mut add = |h: usize, cosine: C, sine: C| {
                    let [c, s] = std::mem::take(&mut product[h]);
                    product[h] = [c.sum(1.0, cosine, 1.0), s.sum(1.0, sine, 1.0)];
                };
                let sum = cc.clone().sum(0.5, ss.clone(), -0.5);
                add(m + n, sum, cs.clone().sum(0.5, sc.clone(), 0.5));
                let sign = if m >= n { 0.5 } else { -0.5 };
                add(m.abs_diff(n), cc.sum(0.5, ss, 0.5), sc.sum(sign, cs, -sign));
            }
        }
        let harmonics = product.split_off(1);
        let [constant, _] = product.pop().unwrap_or_default();
        let product = Form {
            constant,
            harmonics,
            ..Form::default()
        };
        product.finite()
    }

    /// cos or sin of mφ + q.
    fn wave(self, function: Function) -> Result<Form<C>, Obstacle> {
        let m = self.phase.unwrap_or(0.0);
        let multiple = m.abs();
        if !self.states.is_empty() || !self.harmonics.is_empty() {
            return Err(NOT_AFFINE);
        }
        if multiple > HIGHEST as f64 {
            return Err(Obstacle::Phase);
        }
        let cosine = self.constant.clone().apply(Function::Cos)?;
        let sine = self.constant.apply(Function::Sin)?;
        // cos(mφ + q) = cos q cos mφ − sin q sin mφ, sin(mφ + q) = sin q cos mφ + cos q sin mφ
        let [c, s] = match function {
            Function::Cos => [cosine, sine.negative()],
            _ => [sine, cosine],
        };
        let s = if m < 0.0 { s.negative() } else { s };
        if multiple == 0.0 {
            return Ok(Form::constant(c));
        }
        let mut harmonics: Vec<[C; 2]> = vec![Default::default(); multiple as usize];
        if let Some(last) = harmonics.last_mut() {
            *last = [c, s];
        }
        Ok(Form {
            harmonics,
            ..Form::default()
        })
    }

    fn finite(self) -> Result<Form<C>, Obstacle> {
        let harmonics = self.harmonics.iter().flatten();
        let constant = std::iter::once(&self.constant);
        let mut terms = self.states.iter().chain(constant).chain(harmonics);
        let finite = terms.all(|term| (*term).clone().finite().is_ok());
        finite.then_some(self).ok_or(Obstacle::NotFinite)
    }

    /// The form itself, where the phase stands inside `sin` and `cos` only.
    ///
    /// # Errors
    /// Where it does not.
    pub fn settled(self) -> Result<Form<C>, Obstacle> {
        match self.phase {
            Some(_) => Err(Obstacle::Phase),
            None => Ok(self),
        }
    }
}

impl<C: Coefficient> Algebra for Form<C> {
    fn number(value: f64) -> Form<C> {
        Form::constant(C::number(value))
    }

    fn decimal(value: f64, text: &str) -> Form<C> {
        Form::constant(C::decimal(value, text))
    }

    fn negative(self) -> Form<C> {
        let phase = self.phase.map(|phase| -phase);
        let negative = self.map(C::negative);
        Form { phase, ..negative }
    }

    fn operate(self, operation: Operation, other: Form<C>) -> Result<Form<C>, Obstacle> {
        match operation {
            Operation::Plus => self.sum(other, 1.0),
            Operation::Minus => self.sum(other, -1.0),
            Operation::Times if other.is_constant() => self.scaled(other.constant),
            Operation::Times if self.is_constant() => other.scaled(self.constant),
            Operation::Times if self.is_periodic() && other.is_periodic() => {
                self.periodic_product(&other)
            }
            Operation::Over if other.is_constant() => {
                let inverse = C::number(1.0).operate(Operation::Over, other.constant)?;
                self.scaled(inverse)
            }
            Operation::Power if self.is_constant() && other.is_constant() => {
                let power = self.constant.operate(Operation::Power, other.constant)?;
                Ok(Form::constant(power))
            }
            Operation::Power if self.is_periodic() && other.is_constant() => {
                let whole = other.constant.whole();
                let whole = whole.filter(|n| (0.0..=HIGHEST as f64).contains(n));
                let factors = 0..whole.ok_or(NOT_AFFINE)? as usize;
                factors
                    .into_iter()
                    .try_fold(Form::number(1.0), |power, _| power.periodic_product(&self))
            }
            _ => Err(NOT_AFFINE),
        }
    }

    fn apply(self, function: Function) -> Result<Form<C>, Obstacle> {
        match function {
            Function::Cos | Function::Sin => self.wave(function),
            _ if self.is_constant() => Ok(Form::constant(self.constant.apply(function)?)),
            _ => Err(NOT_AFFINE),
        }
    }
}

/// A switch with its expressions as forms.
pub struct FormSwitch<'a, C> {
    pub switch: &'a Switch,
    pub guard: Form<C>,
    pub reset: Vec<(usize, Form<C>)>,
    pub conditions: Vec<Form<C>>,
}

/// A mode with its expressions as forms.
pub struct FormMode<'a, C> {
    /// Rates in the order of the states.
    pub rates: Vec<Form<C>>,
    /// Switches in the order of the file.
    pub switches: Vec<FormSwitch<'a, C>>,
}

/// A system with its expressions as forms.
pub struct FormSystem<'a, C> {
    /// Angular frequency of the forcing; zero without.
    pub omega: C,
    /// Modes of the file.
    pub modes: Vec<FormMode<'a, C>>,
    /// Multiples of the phase that occur.
    pub harmonics: usize,
}

/// The expressions of the system as forms, where parameters and π are these coefficients.
///
/// # Errors
/// An expression that is not affine in the states or has no finite value, with its place.
pub fn forms<'a, C: Coefficient>(
    system: &'a System,
    parameter: &dyn Fn(usize) -> C,
    pi: C,
) -> Result<FormSystem<'a, C>, SystemError> {
    let evaluation = Evaluation::new(system, parameter, pi)?;
    let omega = match &system.forcing {
        None => C::default(),
        Some(expression) => evaluation.form(&|| "forcing".into(), expression)?.constant,
    };
    let names = system.source.modes.names();
    let modes = names.zip(&system.modes).map(|(name, mode)| {
        let path = || format!("modes.{name}");
        let rates = system.source.states.iter().zip(&mode.rates);
        let rates = rates
            .map(|(state, rate)| evaluation.form(&|| format!("{}.rates.{state}", path()), rate));
        let switches = mode.switches.iter().enumerate();
        let switches = switches.map(|(index, switch)| {
            evaluation.switch(&|| format!("{}.until.{index}", path()), switch)
        });
        Ok(FormMode {
            rates: rates.collect::<Result<_, _>>()?,
            switches: switches.collect::<Result<_, _>>()?,
        })
    });
    let modes: Vec<FormMode<C>> = modes.collect::<Result<_, SystemError>>()?;
    let forms = modes.iter().flat_map(|FormMode { rates, switches }| {
        let switches = switches.iter().flat_map(|switch| {
            let reset = switch.reset.iter().map(|(_, form)| form);
            [&switch.guard]
                .into_iter()
                .chain(reset)
                .chain(&switch.conditions)
        });
        rates.iter().chain(switches)
    });
    Ok(FormSystem {
        harmonics: forms.map(|form| form.harmonics.len()).max().unwrap_or(0),
        omega,
        modes,
    })
}

/// Where an expression stands: told only if it is wrong.
type Path<'a> = &'a dyn Fn() -> String;

/// What the names of a system stand for.
struct Evaluation<'a, C> {
    system: &'a System,
    parameter: &'a dyn Fn(usize) -> C,
    pi: C,
    abbreviations: Vec<Form<C>>,
}

impl<'a, C: Coefficient> Evaluation<'a, C> {
    fn new(
        system: &'a System,
        parameter: &'a dyn Fn(usize) -> C,
        pi: C,
    ) -> Result<Evaluation<'a, C>, SystemError> {
        let mut evaluation = Evaluation {
            system,
            parameter,
            pi,
            abbreviations: Vec::new(),
        };
        let names = system.source.define.names();
        for (name, expression) in names.zip(&system.define) {
            // an abbreviation may stand for the phase: only its use tells whether that makes sense
            let form = evaluation.evaluate(&|| format!("define.{name}"), expression)?;
            evaluation.abbreviations.push(form);
        }
        Ok(evaluation)
    }

    fn meaning(&self, name: &str) -> Option<Form<C>> {
        let source = &self.system.source;
        if let Some(state) = source.states.iter().position(|state| state == name) {
            return Some(Form::state(state));
        }
        if let Some(index) = source.parameters.index(name) {
            return Some(Form::constant((self.parameter)(index)));
        }
        if let Some(index) = source.define.index(name) {
            return self.abbreviations.get(index).cloned();
        }
        match name {
            "pi" => Some(Form::constant(self.pi.clone())),
            "phase" => Some(Form::phase()),
            _ => None,
        }
    }

    fn evaluate(&self, path: Path, expression: &Expression) -> Result<Form<C>, SystemError> {
        let form = expression.evaluate(&|name| self.meaning(name));
        form.map_err(|flaw| SystemError::at(path(), Mistake::Expression(flaw)))
    }

    fn form(&self, path: Path, expression: &Expression) -> Result<Form<C>, SystemError> {
        let form = self.evaluate(path, expression)?;
        form.settled().map_err(|obstacle| {
            let flaw = Flaw {
                wrong: obstacle.into(),
                span: expression.span.clone(),
            };
            SystemError::at(path(), Mistake::Expression(flaw))
        })
    }

    fn switch<'b>(&self, path: Path, switch: &'b Switch) -> Result<FormSwitch<'b, C>, SystemError> {
        let names = &self.system.source.states;
        let reset = switch.reset.iter().map(|(state, expression)| {
            let path = || format!("{}.reset.{}", path(), names[*state]);
            Ok((*state, self.form(&path, expression)?))
        });
        let conditions = switch.conditions.iter().enumerate();
        let conditions = conditions
            .map(|(index, expression)| self.form(&|| format!("{}.if.{index}", path()), expression));
        Ok(FormSwitch {
            switch,
            guard: self.form(&|| format!("{}.zero", path()), &switch.zero)?,
            reset: reset.collect::<Result<_, SystemError>>()?,
            conditions: conditions.collect::<Result<_, _>>()?,
        })
    }
}
