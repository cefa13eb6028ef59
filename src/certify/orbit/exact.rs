//! Coefficients of a system as formulas: sums of products of whole numbers and names.
//!
//! Two formulas that are written as the same sum are the same number, whatever the parameters. So it is known that
//! a guard is zero where another was, which no interval can tell. Of numbers that are the same for other
//! reasons nothing is known, and nothing follows.

use std::collections::BTreeMap;

use crate::affine::dual::Coefficient;
use crate::affine::expression::{Algebra, Function, Obstacle, Operation};

/// Terms up to this are multiplied out; a larger product is one name.
const MOST_TERMS: usize = 256;
/// Whole exponents up to this are products.
const MOST_FACTORS: f64 = 16.0;
/// A decimal of so many characters is the one that its double is written as.
const LONGEST: usize = 15;

/// Whole factors of products of names, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exact(BTreeMap<Vec<String>, i64>);

impl Exact {
    /// A name that stands for a number.
    pub fn named(name: String) -> Exact {
        Exact(BTreeMap::from([(vec![name], 1)]))
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    fn of_whole(value: i64) -> Exact {
        let terms = (value != 0).then(|| (Vec::new(), value));
        Exact(terms.into_iter().collect())
    }

    /// The whole number that it is.
    pub fn number(&self) -> Option<i64> {
        match self.0.iter().next() {
            None => Some(0),
            Some((names, factor)) if names.is_empty() && self.0.len() == 1 => Some(*factor),
            Some(_) => None,
        }
    }

    fn text(&self) -> String {
        let term = |(names, factor): (&Vec<String>, &i64)| format!("{factor}*{}", names.join("*"));
        let terms: Vec<String> = self.0.iter().map(term).collect();
        format!("({})", terms.join("+"))
    }

    /// self + sign·other; `None` beyond the range of whole numbers.
    fn plus(&self, sign: i64, other: &Exact) -> Option<Exact> {
        let mut sum = self.0.clone();
        for (names, factor) in &other.0 {
            let known = sum.get(names).copied().unwrap_or(0);
            match known.checked_add(factor.checked_mul(sign)?)? {
                0 => sum.remove(names),
                factor => sum.insert(names.clone(), factor),
            };
        }
        Some(Exact(sum))
    }

    /// The sum whose product with a single term it is, if there is one.
    fn over(&self, other: &Exact) -> Option<Exact> {
        let mut terms = other.0.iter();
        let (Some((names, by)), None) = (terms.next(), terms.next()) else {
            return None;
        };
        let divided = |(own, factor): (&Vec<String>, &i64)| {
            let mut rest = own.clone();
            for name in names {
                rest.remove(rest.binary_search(name).ok()?);
            }
            let whole = factor.checked_rem(*by)? == 0;
            whole.then(|| (rest, factor / by))
        };
        self.0.iter().map(divided).collect::<Option<_>>().map(Exact)
    }

    fn product(&self, other: &Exact) -> Option<Exact> {
        if self.0.len().saturating_mul(other.0.len()) > MOST_TERMS {
            return None;
        }
        let mut product = Exact::default();
        for (one, factor) in &self.0 {
            for (two, by) in &other.0 {
                let mut names = [&one[..], two].concat();
                names.sort_unstable();
                let term = Exact(BTreeMap::from([(names, factor.checked_mul(*by)?)]));
                product = product.plus(1, &term)?;
            }
        }
        Some(product)
    }
}

impl Algebra for Exact {
    fn number(value: f64) -> Exact {
        let whole = value.fract() == 0.0 && value.abs() < 1e15;
        match whole {
            true => Exact::of_whole(value as i64),
            false => Exact::named(format!("{value:?}")),
        }
    }

    fn decimal(value: f64, text: &str) -> Exact {
        match text.len() <= LONGEST {
            true => <Exact as Algebra>::number(value),
            false => Exact::named(text.to_owned()),
        }
    }

    fn negative(self) -> Exact {
        Exact::default().sum(1.0, self, -1.0)
    }

    fn operate(self, operation: Operation, other: Exact) -> Result<Exact, Obstacle> {
        Ok(match operation {
            Operation::Plus => self.sum(1.0, other, 1.0),
            Operation::Minus => self.sum(1.0, other, -1.0),
            Operation::Times => self.times(other),
            // intervals tell that it is not zero
            Operation::Over => match self.over(&other) {
                Some(quotient) => quotient,
                None => self.times(Exact::named(format!("1/{}", other.text()))),
            },
            Operation::Power => {
                match Coefficient::whole(&other).filter(|n| (0.0..=MOST_FACTORS).contains(n)) {
                    Some(n) => {
                        let one = Exact::of_whole(1);
                        (0..n as usize).fold(one, |power, _| power.times(self.clone()))
                    }
                    None => Exact::named(format!("{}^{}", self.text(), other.text())),
                }
            }
        })
    }

    fn apply(self, function: Function) -> Result<Exact, Obstacle> {
        use Function::{Abs, Asin, Atan, Cos, Cosh, Exp, Sin, Sinh, Sqrt, Tan, Tanh};
        Ok(match (function, self.is_zero()) {
            (Sin | Tan | Sqrt | Abs | Tanh | Asin | Atan | Sinh, true) => self,
            (Cos | Exp | Cosh, true) => Exact::of_whole(1),
            _ => Exact::named(format!("{function:?}{}", self.text())),
        })
    }
}

impl Coefficient for Exact {
    const TERMS: bool = false;

    fn sum(self, weight: f64, other: Exact, other_weight: f64) -> Exact {
        let weighted = |x: Exact, weight: f64| match weight {
            1.0 => x,
            _ => x.times(<Exact as Algebra>::number(weight)),
        };
        let (one, other) = (weighted(self, weight), weighted(other, other_weight));
        let sum = one.plus(1, &other);
        sum.unwrap_or_else(|| Exact::named(format!("({}+{})", one.text(), other.text())))
    }

    fn times(self, other: Exact) -> Exact {
        if self.is_zero() || other.is_zero() {
            return Exact::default();
        }
        let product = self.product(&other);
        product.unwrap_or_else(|| Exact::named(format!("({}*{})", self.text(), other.text())))
    }

    fn fixed(&self) -> Option<f64> {
        self.number().map(|number| number as f64)
    }

    fn finite(self) -> Result<Exact, Obstacle> {
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quotient_is_a_sum_where_every_term_is_divided() {
        let number = <Exact as Algebra>::number;
        let rho = Exact::named("rho".to_owned());
        let over = |one: &Exact, other: &Exact| one.clone().operate(Operation::Over, other.clone());
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
