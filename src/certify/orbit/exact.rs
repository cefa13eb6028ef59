//! Coefficients of a system as formulas: sums of products of fractions and names.
//!
//! Two formulas that are written as the same sum are the same number, whatever the parameters. So it is known that
//! a guard is zero where another was, which no interval can tell. Of numbers that are the same for other
//! reasons nothing is known, and nothing follows. Names are expressions: a formula has a value ([`Formula`]).

use std::collections::BTreeMap;

use super::fraction::Fraction;
use crate::affine::algebra::{Algebra, Function, Obstacle, Operation};
use crate::affine::dual::Coefficient;
use crate::affine::expression::Expression;
use crate::affine::system::is_name;

/// Terms up to this are multiplied out; a larger product is one name.
const MOST_TERMS: usize = 256;
/// Whole exponents up to this are products.
const MOST_FACTORS: f64 = 16.0;

/// Factors of products of names, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NamePolynomial(BTreeMap<Vec<String>, Fraction>);

impl NamePolynomial {
    /// A name that stands for a number.
    pub fn named(name: String) -> NamePolynomial {
        NamePolynomial(BTreeMap::from([(vec![name], Fraction::ONE)]))
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// A fraction.
    pub fn of_fraction(value: Fraction) -> NamePolynomial {
        let terms = (!value.is_zero()).then(|| (Vec::new(), value));
        NamePolynomial(terms.into_iter().collect())
    }

    /// The fraction that it is.
    pub fn fraction(&self) -> Option<Fraction> {
        match self.0.iter().next() {
            None => Some(Fraction::ZERO),
            Some((names, factor)) if names.is_empty() && self.0.len() == 1 => Some(*factor),
            Some(_) => None,
        }
    }

    /// The whole number that it is.
    pub fn number(&self) -> Option<i64> {
        self.fraction().and_then(Fraction::whole)
    }

    /// The fraction with which its first term begins, if it has any.
    pub fn first_factor(&self) -> Option<Fraction> {
        self.0.values().next().copied()
    }

    /// It over a fraction; `None` over zero, or beyond the range of fractions.
    pub fn over(&self, number: Fraction) -> Option<NamePolynomial> {
        let by = number.inverse()?;
        let terms = self.0.iter();
        let terms = terms.map(|(names, factor)| Some((names.clone(), factor.times(by)?)));
        terms.collect::<Option<_>>().map(NamePolynomial)
    }

    /// As an expression in brackets.
    fn text(&self) -> String {
        let term = |(names, factor): (&Vec<String>, &Fraction)| match (names.is_empty(), factor) {
            (true, _) => factor.to_string(),
            (false, &Fraction::ONE) => names.join("*"),
            (false, _) => format!("{factor}*{}", names.join("*")),
        };
        let terms: Vec<String> = self.0.iter().map(term).collect();
        match terms.is_empty() {
            true => "(0)".to_owned(),
            false => format!("({})", terms.join("+")),
        }
    }

    /// self + sign·other; `None` beyond the range of fractions.
    fn plus(&self, sign: Fraction, other: &NamePolynomial) -> Option<NamePolynomial> {
        let mut sum = self.0.clone();
        for (names, factor) in &other.0 {
            let known = sum.get(names).copied().unwrap_or(Fraction::ZERO);
            let factor = known.plus(factor.times(sign)?)?;
            match factor.is_zero() {
                true => sum.remove(names),
                false => sum.insert(names.clone(), factor),
            };
        }
        Some(NamePolynomial(sum))
    }

    /// 1 over it, where it is a single term.
    pub fn inverse_of_term(&self) -> Option<NamePolynomial> {
        (self.0.len() == 1).then(|| self.inverse())?
    }

    /// 1 over it: of a single term term by term, of a sum as a name, with 1 as its first factor.
    fn inverse(&self) -> Option<NamePolynomial> {
        let (names, factor) = self.0.iter().next()?;
        let by = factor.inverse()?;
        if self.0.len() == 1 {
            let mut names: Vec<String> = names.iter().map(|name| inverted(name)).collect();
            names.sort_unstable();
            return Some(NamePolynomial(BTreeMap::from([(names, by)])));
        }
        let sum = self.over(*factor)?;
        let name = format!("1/{}", sum.text());
        Some(NamePolynomial(BTreeMap::from([(vec![name], by)])))
    }

    fn product(&self, other: &NamePolynomial) -> Option<NamePolynomial> {
        if self.0.len().saturating_mul(other.0.len()) > MOST_TERMS {
            return None;
        }
        let mut product = NamePolynomial::default();
        for (one, factor) in &self.0 {
            for (two, by) in &other.0 {
                let mut names = one.clone();
                for name in two {
                    // a name times its inverse is 1: intervals tell that it is not zero
                    match names.iter().position(|known| *known == inverted(name)) {
                        Some(place) => drop(names.remove(place)),
                        None => names.push(name.clone()),
                    }
                }
                names.sort_unstable();
                let term = NamePolynomial(BTreeMap::from([(names, factor.times(*by)?)]));
                product = product.plus(Fraction::ONE, &term)?;
            }
        }
        Some(product)
    }

    /// As a formula that has a value; `None` where a name is no expression of this length.
    pub fn formula(&self) -> Option<Formula> {
        let terms = self.0.iter().map(|(names, factor)| {
            let names = names.iter().map(|name| Expression::read(name).ok());
            Some((*factor, names.collect::<Option<_>>()?))
        });
        terms.collect::<Option<_>>().map(Formula)
    }
}

/// The name of 1 over a name.
fn inverted(name: &str) -> String {
    let inner = name
        .strip_prefix("1/(")
        .and_then(|rest| rest.strip_suffix(')'));
    match inner.filter(|inner| is_name(inner)) {
        Some(inner) => inner.to_owned(),
        None => format!("1/({name})"),
    }
}

/// A formula whose names are read: it has a value where these have.
#[derive(Clone, Debug)]
pub struct Formula(Vec<(Fraction, Vec<Expression>)>);

impl Formula {
    /// Its value, where names stand for what `meaning` says.
    ///
    /// # Errors
    /// An operation without result, or a name without meaning.
    pub fn value<A: Algebra>(&self, meaning: &impl Fn(&str) -> Option<A>) -> Result<A, Obstacle> {
        let mut sum = A::number(0.0);
        for (factor, names) in &self.0 {
            let mut product = factor.value::<A>()?;
            for name in names {
                let value = name.evaluate(meaning).map_err(|_| Obstacle::NotFinite)?;
                product = product.operate(Operation::Times, value)?;
            }
            sum = sum.operate(Operation::Plus, product)?;
        }
        Ok(sum)
    }
}

impl Algebra for NamePolynomial {
    fn number(value: f64) -> NamePolynomial {
        match Fraction::of_double(value) {
            Some(fraction) => NamePolynomial::of_fraction(fraction),
            // no expression: it has no value
            None => NamePolynomial::named(format!("double {value:?}")),
        }
    }

    fn decimal(_: f64, text: &str) -> NamePolynomial {
        match Fraction::of_decimal(text) {
            Some(fraction) => NamePolynomial::of_fraction(fraction),
            None => NamePolynomial::named(text.to_owned()),
        }
    }

    fn negative(self) -> NamePolynomial {
        NamePolynomial::default().sum(1.0, self, -1.0)
    }

    fn operate(
        self,
        operation: Operation,
        other: NamePolynomial,
    ) -> Result<NamePolynomial, Obstacle> {
        Ok(match operation {
            Operation::Plus => self.sum(1.0, other, 1.0),
            Operation::Minus => self.sum(1.0, other, -1.0),
            Operation::Times => self.times(other),
            // intervals tell that it is not zero
            Operation::Over => {
                let inverse = other.inverse();
                let named = || NamePolynomial::named(format!("1/{}", other.text()));
                self.times(inverse.unwrap_or_else(named))
            }
            Operation::Power => {
                match Coefficient::whole(&other).filter(|n| (0.0..=MOST_FACTORS).contains(n)) {
                    Some(n) => {
                        let one = NamePolynomial::of_fraction(Fraction::ONE);
                        (0..n as usize).fold(one, |power, _| power.times(self.clone()))
                    }
                    None => NamePolynomial::named(format!("{}^{}", self.text(), other.text())),
                }
            }
        })
    }

    fn apply(self, function: Function) -> Result<NamePolynomial, Obstacle> {
        let at_zero = function.at_zero().filter(|_| self.is_zero());
        Ok(match at_zero {
            Some(value) => <NamePolynomial as Algebra>::number(value),
            None => NamePolynomial::named(format!("{}{}", function.name(), self.text())),
        })
    }
}

impl Coefficient for NamePolynomial {
    const TERMS: bool = false;

    fn sum(self, weight: f64, other: NamePolynomial, other_weight: f64) -> NamePolynomial {
        let weighted = |x: NamePolynomial, weight: f64| match weight {
            1.0 => x,
            _ => x.times(<NamePolynomial as Algebra>::number(weight)),
        };
        let (one, other) = (weighted(self, weight), weighted(other, other_weight));
        let sum = one.plus(Fraction::ONE, &other);
        sum.unwrap_or_else(|| NamePolynomial::named(format!("({}+{})", one.text(), other.text())))
    }

    fn times(self, other: NamePolynomial) -> NamePolynomial {
        if self.is_zero() || other.is_zero() {
            return NamePolynomial::default();
        }
        let product = self.product(&other);
        product
            .unwrap_or_else(|| NamePolynomial::named(format!("({}*{})", self.text(), other.text())))
    }

    fn fixed(&self) -> Option<f64> {
        self.number().map(|number| number as f64)
    }

    fn finite(self) -> Result<NamePolynomial, Obstacle> {
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quotient_is_a_sum_where_every_term_is_divided() {
        let number = <NamePolynomial as Algebra>::number;
        let rho = NamePolynomial::named("rho".to_owned());
        let over = |one: &NamePolynomial, other: &NamePolynomial| {
            one.clone().operate(Operation::Over, other.clone())
        };
        let square = rho.clone().times(rho.clone());
        let sum = square.sum(-4.0, rho.clone(), 6.0);
        assert_eq!(
            over(&sum, &number(-2.0)),
            Ok(rho.clone().times(rho.clone()).sum(2.0, rho.clone(), -3.0))
        );
        assert_eq!(
            over(&sum, &rho),
            Ok(rho.clone().sum(-4.0, number(6.0), 1.0))
        );
        // as a product with a name of its own, which is not zero and no other's
        let half = over(&rho, &number(2.0)).unwrap();
        assert!(half != rho && !half.is_zero());
        assert_eq!(half, over(&rho, &number(2.0)).unwrap());
        assert!(over(&rho, &number(0.0)).is_ok_and(|inverse| !inverse.is_zero()));
    }
}
