//! What expressions are evaluated in: forms in states and forcing, affine ones, and what goes beyond them as terms of its own.

use std::collections::HashMap;
use std::sync::Arc;

use super::dual::{Coefficient, Degree, Dual, Measured};
use super::expression::{Algebra, Extremum, Function, Obstacle, Operation};

/// Highest multiple of the phase.
const HIGHEST: usize = 16;

/// Deepest nesting of terms that are not affine: what walks through them recurses no deeper.
const DEEPEST: usize = 1000;

/// Largest whole exponent of something that changes that is made of products.
const PRODUCTS: f64 = 64.0;

/// How a term that is not affine is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// ab.
    Product,
    /// a/b.
    Quotient,
    /// aʳ.
    Power(f64),
    /// f(a).
    Function(Function),
}

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

    /// Its rate of change where the states change at these rates and the phase at ω.
    pub(super) fn lie(&self, rates: &[Form<C>], omega: C) -> Result<Form<C>, Obstacle> {
        self.lie_of(rates, omega, &mut HashMap::new())
    }

    /// The same; `known` has the rates of terms that have been met.
    fn lie_of(
        &self,
        rates: &[Form<C>],
        omega: C,
        known: &mut HashMap<*const Term<C>, Form<C>>,
    ) -> Result<Form<C>, Obstacle> {
        let mut sum = Form::default();
        for (coefficient, rate) in self.states.iter().zip(rates) {
            if *coefficient != C::default() {
                sum = sum.sum(rate.clone().scaled(coefficient.clone())?, 1.0)?;
            }
        }
        let turn = |(h, [c, s]): (usize, &[C; 2])| {
            let speed = omega.clone().times(C::number((h + 1) as f64));
            [
                s.clone().times(speed.clone()),
                c.clone().times(speed).negative(),
            ]
        };
        let harmonics = self.harmonics.iter().enumerate().map(turn).collect();
        sum = sum.sum(
            Form {
                harmonics,
                ..Form::default()
            },
            1.0,
        )?;
        for (coefficient, term) in &self.beyond {
            if let Some(rate) = known.get(&Arc::as_ptr(term)) {
                sum = sum.sum(rate.clone().scaled(coefficient.clone())?, 1.0)?;
                continue;
            }
            let [a, b] = &term.operands;
            let own = Form {
                beyond: vec![(C::number(1.0), term.clone())],
                ..Form::default()
            };
            let times = |one: Form<C>, other: Form<C>| one.operate(Operation::Times, other);
            let over = |one: Form<C>, other: Form<C>| one.operate(Operation::Over, other);
            let [a_rate, b_rate] = [
                a.lie_of(rates, omega.clone(), known)?,
                b.lie_of(rates, omega.clone(), known)?,
            ];
            let square = |form: &Form<C>| times(form.clone(), form.clone());
            let rate = match term.rule {
                Rule::Product => times(a_rate, b.clone())?.sum(times(a.clone(), b_rate)?, 1.0)?,
                Rule::Quotient => {
                    let moved = times(own, b_rate)?;
                    over(a_rate.sum(moved, -1.0)?, b.clone())?
                }
                Rule::Power(r) => times(a_rate, over(own, a.clone())?.scaled(C::number(r))?)?,
                Rule::Function(function) => {
                    let one = || Form::number(1.0);
                    let slope = match function {
                        Function::Sin => a.clone().apply(Function::Cos)?,
                        Function::Cos => a.clone().apply(Function::Sin)?.negative(),
                        Function::Tan => one().sum(square(&own)?, 1.0)?,
                        Function::Tanh => one().sum(square(&own)?, -1.0)?,
                        Function::Exp => own,
                        Function::Ln => over(one(), a.clone())?,
                        Function::Sqrt => over(Form::number(0.5), own)?,
                        Function::Abs => over(own, a.clone())?,
                        Function::Asin | Function::Acos => {
                            let rest = one().sum(square(a)?, -1.0)?;
                            let slope = over(one(), rest.apply(Function::Sqrt)?)?;
                            match function {
                                Function::Asin => slope,
                                _ => slope.negative(),
                            }
                        }
                        Function::Atan => over(one(), one().sum(square(a)?, 1.0)?)?,
                        Function::Sinh => a.clone().apply(Function::Cosh)?,
                        Function::Cosh => a.clone().apply(Function::Sinh)?,
                    };
                    times(a_rate, slope)?
                }
            };
            known.insert(Arc::as_ptr(term), rate.clone());
            sum = sum.sum(rate.scaled(coefficient.clone())?, 1.0)?;
        }
        Ok(sum)
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
            Operation::Over => Form::term(Rule::Quotient, [self, other]),
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

impl<C: Measured> Form<C> {
    /// The form where some others are not negative: ±g in the place of |g| where g is a multiple of one of these.
    /// `known` has the terms that have been met, and whether they are others there.
    ///
    /// # Errors
    /// An operation that has no result there.
    pub(super) fn where_positive(
        &self,
        positive: &[Form<C>],
        known: &mut HashMap<*const Term<C>, Option<Form<C>>>,
    ) -> Result<Form<C>, Obstacle> {
        let mut sum = Form {
            beyond: Vec::new(),
            ..self.clone()
        };
        for (coefficient, term) in &self.beyond {
            let place = Arc::as_ptr(term);
            if !known.contains_key(&place) {
                let form = term.where_positive(positive, known)?;
                known.insert(place, form);
            }
            match known.get(&place) {
                Some(Some(form)) => {
                    sum = sum.sum(form.clone().scaled(coefficient.clone())?, 1.0)?
                }
                _ => sum.beyond.push((coefficient.clone(), term.clone())),
            }
        }
        Ok(sum)
    }

    /// The sign of the number that it is times another form: of zero, it is 1.
    pub(super) fn sign_of_ratio(&self, other: &Form<C>) -> Option<f64> {
        // a guard that has no state is one of time alone: where it is zero is known, and not what is multiplied with it
        let size = |state: &usize| other.states[*state].certain().abs();
        let pivot = (0..other.states.len()).max_by(|one, more| size(one).total_cmp(&size(more)))?;
        if size(&pivot) == 0.0 {
            return None;
        }
        let own = self.states.get(pivot).cloned().unwrap_or_default();
        let factor = own.operate(Operation::Over, other.states[pivot].clone());
        let factor = factor.ok()?;
        if factor.certain() == 0.0 && factor.largest() > 0.0 {
            return None;
        }
        let negative = factor.certain() < 0.0;
        let rest = other.clone().scaled(factor).ok()?;
        let rest = self.clone().sum(rest, -1.0).ok()?;
        (rest.largest() <= C::SAME * self.largest()).then(|| if negative { -1.0 } else { 1.0 })
    }

    fn coefficients(&self) -> impl Iterator<Item = &C> {
        let harmonics = self.harmonics.iter().flatten();
        let terms = self.states.iter().chain(harmonics).chain([&self.constant]);
        terms.chain(self.beyond.iter().map(|(c, _)| c))
    }

    /// Size of its largest coefficient.
    pub(super) fn largest(&self) -> f64 {
        let values = self.coefficients().map(C::largest);
        values.fold(0.0, f64::max)
    }

    /// Size of its largest coefficient, or the least that it may have where that is a number.
    pub(super) fn certain(&self) -> f64 {
        match self.is_constant() {
            true => self.constant.certain().abs(),
            false => self.largest(),
        }
    }

    /// Whether it is the same as another where a guard is zero: their difference is nothing, or a multiple of the guard.
    pub(super) fn is_same_at(&self, other: &Form<C>, guard: &Form<C>) -> bool {
        let size = self.largest().max(other.largest());
        let difference = self.clone().sum(other.clone(), -1.0);
        difference.is_ok_and(|difference| {
            difference.largest() <= C::SAME * size || difference.sign_of_ratio(guard).is_some()
        })
    }
}

impl<C: Measured> Term<C> {
    /// Another form of it where some are not negative; `None` where it is the same.
    fn where_positive(
        &self,
        positive: &[Form<C>],
        known: &mut HashMap<*const Term<C>, Option<Form<C>>>,
    ) -> Result<Option<Form<C>>, Obstacle> {
        let [one, other] = &self.operands;
        let resolved = [
            one.where_positive(positive, known)?,
            other.where_positive(positive, known)?,
        ];
        if self.rule == Rule::Function(Function::Abs) {
            let mut signs = positive
                .iter()
                .filter_map(|form| resolved[0].sign_of_ratio(form));
            if let Some(sign) = signs.next() {
                return resolved[0].clone().scaled(C::number(sign)).map(Some);
            }
        }
        let is_same = |one: &Form<C>, other: &Form<C>| {
            let mut pairs = one.beyond.iter().zip(&other.beyond);
            one.beyond.len() == other.beyond.len()
                && pairs.all(|((_, one), (_, other))| Arc::ptr_eq(one, other))
        };
        if is_same(&resolved[0], one) && is_same(&resolved[1], other) {
            return Ok(None);
        }
        let [one, other] = resolved;
        let form = match self.rule {
            Rule::Product => one.operate(Operation::Times, other),
            Rule::Quotient => one.operate(Operation::Over, other),
            Rule::Power(r) => one.operate(Operation::Power, Form::number(r)),
            Rule::Function(function) => one.apply(function),
        };
        form.map(Some)
    }
}

#[cfg(test)]
mod tests {
    use super::super::expression::{Expression, Flaw, Wrong};
    use super::*;

    /// States x, v; parameters p = 0.7 and q = 1.3, which vary.
    fn form(text: &str) -> Result<Form, Flaw> {
        Expression::read(text)?.evaluate(&|name| match name {
            "x" => Some(Form::state(0)),
            "v" => Some(Form::state(1)),
            "p" => Some(Form::constant(Dual::parameter(0.7, Some(0)))),
            "q" => Some(Form::constant(Dual::parameter(1.3, Some(1)))),
            "phase" => Some(Form::phase()),
            _ => None,
        })
    }

    /// Value and derivatives in p and q of a form at a state and a phase.
    fn value(form: &Form, states: [f64; 2], phase: f64) -> Dual {
        let mut sum = form.constant;
        for (term, state) in form.states.iter().zip(states) {
            sum = sum.sum(1.0, *term, state);
        }
        for (h, [c, s]) in form.harmonics.iter().enumerate() {
            let angle = (h + 1) as f64 * phase;
            sum = sum.sum(1.0, *c, angle.cos()).sum(1.0, *s, angle.sin());
        }
        sum
    }

    #[test]
    fn a_form_is_its_expression() {
        // for every expression its value as a function of x, v, φ, p, q, in plain arithmetic
        type Direct = fn([f64; 5]) -> f64;
        let cases: [(&str, Direct); 6] = [
            ("p*x - 2*v/q + 3", |[x, v, _, p, q]| {
                p * x - 2.0 * v / q + 3.0
            }),
            ("p*cos(phase)^3 - x", |[x, _, f, p, _]| {
                p * f.cos().powi(3) - x
            }),
            ("sin(2*phase - q)*cos(phase)*p", |[_, _, f, p, q]| {
                (2.0 * f - q).sin() * f.cos() * p
            }),
            ("(1 - cos(3*phase))*(q + sin(phase))", |[_, _, f, _, q]| {
                (1.0 - (3.0 * f).cos()) * (q + f.sin())
            }),
            ("-(x - v)*exp(p*q)*tanh(q) + p^q", |[x, v, _, p, q]| {
                -(x - v) * (p * q).exp() * q.tanh() + p.powf(q)
            }),
            ("cos(q - 2*phase) + abs(p - q)*x", |[x, _, f, p, q]| {
                (q - 2.0 * f).cos() + (p - q).abs() * x
            }),
        ];
        for (text, direct) in cases {
            let form = form(text).unwrap().settled().unwrap();
            for phase in [0.0, 0.9, -2.2, 4.0] {
                let point = [0.4, -1.1, phase, 0.7, 1.3];
                let found = value(&form, [0.4, -1.1], phase);
                assert!((found.value - direct(point)).abs() < 1e-14, "{text}");
                for (p, index) in [(0, 3), (1, 4)] {
                    let shifted = |shift: f64| {
                        let mut point = point;
                        point[index] += shift;
                        direct(point)
                    };
                    // central difference: error h²/6 of third derivatives of order ten, and 1e-16/h
                    let difference = (shifted(1e-5) - shifted(-1e-5)) / 2e-5;
                    assert!((found.by[p] - difference).abs() < 1e-8, "{text}, {p}");
                }
            }
        }
    }

    #[test]
    fn what_has_no_value_is_refused_with_its_place() {
        for (text, obstacle, span) in [
            ("cos(0.5*phase)", Obstacle::Phase, 4..13),
            ("1 + phase*x", Obstacle::Phase, 4..11),
            ("exp(phase)", Obstacle::Phase, 0..10),
            ("1/(p - p)", Obstacle::NotFinite, 0..9),
            ("ln(p - 1)", Obstacle::NotFinite, 0..9),
        ] {
            let flaw = form(text).unwrap_err();
            assert_eq!(
                (flaw.wrong, flaw.span),
                (Wrong::Obstacle(obstacle), span),
                "{text}"
            );
        }
        assert_eq!(
            form("phase + x").unwrap().settled().err(),
            Some(Obstacle::Phase)
        );
    }
}
