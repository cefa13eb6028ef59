//! What expressions are evaluated in: forms in states and forcing, affine ones, and what goes beyond them as terms of its own.

mod rate;
mod rule;
mod sign;

pub use rule::Rule;
pub(super) use sign::Signs;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use super::algebra::{Algebra, Extremum, Function, Obstacle, Operation};
use super::dual::{Coefficient, Degree, Dual};

/// Highest multiple of the phase.
const HIGHEST: usize = 16;

/// Deepest nesting of terms that are not affine: what walks through them recurses no deeper.
const DEEPEST: usize = 1000;

/// Largest whole exponent of something that changes that is made of products.
const PRODUCTS: f64 = 64.0;

/// A term that is not affine in the states.
#[derive(Debug, PartialEq)]
pub struct Term<C = Dual> {
    /// How it is made.
    pub rule: Rule,
    /// Of what: b is zero where the rule has one operand.
    pub operands: [Form<C>; 2],
    /// How many such terms are nested in it.
    depth: usize,
    /// Highest multiple of the phase in it.
    highest: usize,
}

/// An affine form Σ aᵢxᵢ + a + Σ (cₕ cos hφ + sₕ sin hφ) in the states x and the phase φ, whose coefficients
/// have derivatives in the parameters; and a combination of terms that are not affine.
///
/// What it depends on is told by the expression and not by values: 0·x depends on x.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form<C = Dual> {
    /// aᵢ, up to the last state that occurs.
    pub states: Vec<C>,
    /// a.
    pub constant: C,
    /// (cₕ, sₕ) for h = 1, 2, …
    pub harmonics: Vec<[C; 2]>,
    /// Terms that are not affine, with their coefficients.
    pub beyond: Vec<(C, Arc<Term<C>>)>,
    /// The whole number of times that it has the phase itself, on the way into `sin` and `cos`.
    pub(super) phase: Option<f64>,
}

impl<C: Coefficient> Form<C> {
    /// The state with this index.
    pub(crate) fn state(index: usize) -> Form<C> {
        let mut states = vec![C::default(); index + 1];
        states[index] = C::number(1.0);
        Form {
            states,
            ..Form::default()
        }
    }

    /// The phase φ.
    pub(crate) fn phase() -> Form<C> {
        Form {
            phase: Some(1.0),
            ..Form::default()
        }
    }

    /// A number that depends on parameters only.
    pub(crate) fn constant(constant: C) -> Form<C> {
        Form {
            constant,
            ..Form::default()
        }
    }

    /// Whether it depends on parameters only.
    pub(super) fn is_constant(&self) -> bool {
        self.is_periodic() && self.harmonics.is_empty()
    }

    /// Whether it depends on cosines and sines of the phase only.
    fn is_periodic(&self) -> bool {
        self.states.is_empty() && self.phase.is_none() && self.beyond.is_empty()
    }

    /// A term of its own made of forms.
    fn term(rule: Rule, operands: [Form<C>; 2]) -> Result<Form<C>, Obstacle> {
        if !C::TERMS {
            return Err(Obstacle::NotAffine);
        }
        if operands.iter().any(|form| form.phase.is_some()) {
            return Err(Obstacle::Phase);
        }
        let inner = operands.iter().flat_map(|form| &form.beyond);
        let depth = 1 + inner.map(|(_, term)| term.depth).max().unwrap_or(0);
        if depth > DEEPEST {
            return Err(Obstacle::Deep);
        }
        let term = Term {
            rule,
            highest: operands.iter().map(Form::highest).max().unwrap_or(0),
            operands,
            depth,
        };
        Ok(Form {
            beyond: vec![(C::number(1.0), Arc::new(term))],
            ..Form::default()
        })
    }

    /// Highest multiple of the phase that occurs.
    pub(crate) fn highest(&self) -> usize {
        let inner = self.beyond.iter().map(|(_, term)| term.highest);
        inner.fold(self.harmonics.len(), usize::max)
    }

    fn function(self, function: Function) -> Result<Form<C>, Obstacle> {
        Form::term(Rule::Function(function), [self, Form::default()])
    }

    /// A power of something that changes.
    fn power(self, exponent: Form<C>) -> Result<Form<C>, Obstacle> {
        let fixed = exponent.constant.fixed().filter(|_| exponent.is_constant());
        let Some(r) = fixed else {
            // aᵇ = exp(b ln a)
            let logarithm = self.apply(Function::Ln)?;
            return exponent
                .operate(Operation::Times, logarithm)?
                .apply(Function::Exp);
        };
        if r.fract() != 0.0 || r.abs() > PRODUCTS {
            return Form::term(Rule::Power(r), [self, Form::default()]);
        }
        if r < 0.0 {
            let positive = self.power(Form::number(-r))?;
            return Form::number(1.0).operate(Operation::Over, positive);
        }
        let (mut power, mut square, mut left) = (Form::number(1.0), self, r as u32);
        while left > 0 {
            if left % 2 == 1 {
                power = power.operate(Operation::Times, square.clone())?;
            }
            left /= 2;
            if left > 0 {
                square = square.clone().operate(Operation::Times, square)?;
            }
        }
        Ok(power)
    }

    /// Whether no coefficient is other than zero.
    pub(super) fn is_zero(&self) -> bool {
        let harmonics = self.harmonics.iter().flatten();
        let mut all = self.states.iter().chain([&self.constant]).chain(harmonics);
        all.all(|one| *one == C::default()) && self.beyond.is_empty()
    }

    /// Every coefficient through a function that keeps zero.
    fn map(mut self, change: impl Fn(C) -> C) -> Form<C> {
        let harmonics = self.harmonics.iter_mut().flatten();
        let beyond = self.beyond.iter_mut().map(|(term, _)| term);
        let terms = self.states.iter_mut().chain([&mut self.constant]);
        for term in terms.chain(harmonics).chain(beyond) {
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
        for (term, more) in other.beyond {
            match self
                .beyond
                .iter_mut()
                .find(|(_, known)| Arc::ptr_eq(known, &more))
            {
                Some((known, _)) => *known = std::mem::take(known).sum(1.0, term, sign),
                None => self.beyond.push((term.sum(sign, C::default(), 0.0), more)),
            }
        }
        self.beyond.retain(|(term, _)| *term != C::default());
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
        if !self.states.is_empty() || !self.harmonics.is_empty() || !self.beyond.is_empty() {
            let rest = Form {
                phase: None,
                ..self
            };
            if m == 0.0 {
                return rest.function(function);
            }
            // cos(mφ + g) = cos mφ cos g − sin mφ sin g, sin(mφ + g) = sin mφ cos g + cos mφ sin g
            let turning = Form {
                phase: Some(m),
                ..Form::default()
            };
            let (with_cosine, with_sine, sign) = match function {
                Function::Cos => (Function::Cos, Function::Sin, -1.0),
                _ => (Function::Sin, Function::Cos, 1.0),
            };
            let one = turning.clone().wave(with_cosine)?;
            let one = one.operate(Operation::Times, rest.clone().function(Function::Cos)?)?;
            let other = turning.wave(with_sine)?;
            let other = other.operate(Operation::Times, rest.function(Function::Sin)?)?;
            return one.sum(other, sign);
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
        let beyond = self.beyond.iter().map(|(term, _)| term);
        let constant = std::iter::once(&self.constant);
        let mut terms = self
            .states
            .iter()
            .chain(constant)
            .chain(harmonics)
            .chain(beyond);
        let finite = terms.all(|term| (*term).clone().finite().is_ok());
        finite.then_some(self).ok_or(Obstacle::NotFinite)
    }

    /// The form itself, where the phase stands inside `sin` and `cos` only.
    ///
    /// # Errors
    /// Where it does not.
    pub(crate) fn settled(self) -> Result<Form<C>, Obstacle> {
        match self.phase {
            Some(_) => Err(Obstacle::Phase),
            None => Ok(self),
        }
    }
}

impl<C> Form<C> {
    /// The same with every coefficient through a function; `None` where it has terms that are not affine.
    ///
    /// # Errors
    /// The first that the function has.
    pub(crate) fn convert<D, E>(
        &self,
        change: &impl Fn(&C) -> Result<D, E>,
    ) -> Result<Option<Form<D>>, E> {
        if !self.beyond.is_empty() {
            return Ok(None);
        }
        let pair = |[cosine, sine]: &[C; 2]| Ok([change(cosine)?, change(sine)?]);
        Ok(Some(Form {
            states: self.states.iter().map(change).collect::<Result<_, E>>()?,
            constant: change(&self.constant)?,
            harmonics: self.harmonics.iter().map(pair).collect::<Result<_, E>>()?,
            beyond: Vec::new(),
            phase: self.phase,
        }))
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
            Operation::Times
                if self.is_periodic()
                    && other.is_periodic()
                    && self.harmonics.len() + other.harmonics.len() <= HIGHEST =>
            {
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
                let highest = (HIGHEST / self.harmonics.len().max(1)) as f64;
                let whole = other.constant.whole();
                let Some(whole) = whole.filter(|n| (0.0..=highest).contains(n)) else {
                    return self.power(other);
                };
                (0..whole as usize)
                    .try_fold(Form::number(1.0), |power, _| power.periodic_product(&self))
            }
            Operation::Times => Form::term(Rule::Product, [self, other]),
            Operation::Over => self.over_what_changes(other),
            Operation::Power => self.power(other),
        }
    }

    fn extremum(self, extremum: Extremum, other: Form<C>) -> Result<Form<C>, Obstacle> {
        if self.is_constant() && other.is_constant() {
            let constant = self.constant.extremum(extremum, other.constant)?;
            return Ok(Form::constant(constant));
        }
        let apart = self.operate(Operation::Minus, other.clone())?;
        let size = apart.clone().apply(Function::Abs)?;
        let sign = match extremum {
            Extremum::Min => -1.0,
            Extremum::Max => 1.0,
        };
        let more = apart.sum(size, sign)?.scaled(C::number(0.5))?;
        other.sum(more, 1.0)
    }

    fn apply(self, function: Function) -> Result<Form<C>, Obstacle> {
        match function {
            Function::Cos | Function::Sin => self.wave(function),
            _ if self.is_constant() => Ok(Form::constant(self.constant.apply(function)?)),
            _ => self.function(function),
        }
    }
}

impl Form {
    /// How it depends on the parameter along which a system is led.
    pub(super) fn degree(&self) -> Degree {
        let degrees = self.coefficients().map(|c| c.degree);
        degrees.max().unwrap_or_default()
    }
}
