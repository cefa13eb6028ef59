//! Expressions of a problem file: numbers, names, `+ - * / ^`, functions of one argument, `min` and `max` of two, brackets.
//!
//! `^` binds more closely than the sign before it and groups to the right: `-x^2` is −(x²). An expression is
//! read once; what its names stand for is said when it is evaluated, in any [`Algebra`]: real numbers for a
//! value, affine forms for the matrices of a flow.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use winnow::LocatingSlice;
use winnow::ascii::{digit0, digit1, multispace0};
use winnow::combinator::{
    Infix, Prefix, alt, cut_err, delimited, dispatch, expression, fail, opt, peek, preceded,
};
use winnow::prelude::*;
use winnow::token::{any, one_of, take_while};

use super::algebra::{Algebra, Extremum, Function, Obstacle, Operation};

/// Longest expression in characters.
const LONGEST: usize = 1000;

/// Deepest nesting of brackets, signs and powers: what reads and evaluates it nests no deeper, so that the stack
/// suffices.
const DEEPEST: usize = 150;

#[derive(Clone, Debug, PartialEq)]
enum ExpressionNode {
    /// The double next to it, and its text.
    Number(Box<(f64, String)>),
    Name(String),
    Negative(Box<Expression>),
    Binary(Operation, Box<[Expression; 2]>),
    /// A function by its name.
    Call(String, Box<Expression>),
    /// One of two numbers.
    Extremum(Extremum, Box<[Expression; 2]>),
}

/// An expression, with the bytes of the text that it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    node: ExpressionNode,
    /// Bytes of the text.
    pub span: Range<usize>,
}

/// What is wrong with an expression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum Wrong {
    /// It is longer than can be read.
    #[error("the expression has {0} characters; at most {LONGEST} are read")]
    TooLong(usize),
    /// It is nested more deeply than can be read.
    #[error("the expression is nested {0} deep; at most {DEEPEST} levels are read")]
    TooDeep(usize),
    /// Nothing, or something else, stands where a number, a name or an operator should.
    #[error("the expression makes no sense from here on")]
    Unreadable,
    /// A bracket is not closed.
    #[error("a `)` is missing here")]
    Unclosed,
    /// A bracket is closed that was not opened.
    #[error("this `)` closes nothing")]
    Unopened,
    /// Two operands with nothing between them.
    #[error("an operator is missing before this, `*` for example")]
    Juxtaposed,
    /// `**` in the place of `^`.
    #[error("`**` is no operator: a power is written `^`")]
    Stars,
    /// A function of more arguments than it has.
    #[error("functions have one argument, and `min` and `max` two: nothing may follow this comma")]
    Comma,
    /// One argument in the place of two.
    #[error("`min` and `max` have two arguments: the second is missing here")]
    Second,
    /// A name that stands for nothing.
    #[error("`{0}` is no state, parameter or abbreviation")]
    Unknown(String),
    /// A name that is none of a parameter, where no other may stand.
    #[error("`{0}` is no parameter")]
    NoParameter(String),
    /// A name that is none of a parameter above this one, where its value is written.
    #[error("`{0}` is no parameter that stands before this one")]
    NotBefore(String),
    /// A function that there is not.
    #[error("`{0}` is no function")]
    NoFunction(String),
    /// It cannot be evaluated.
    #[error(transparent)]
    Obstacle(#[from] Obstacle),
}

/// Something wrong, and the bytes of the text it is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Flaw")]
pub struct ExpressionFlaw {
    /// What.
    pub wrong: Wrong,
    /// Where.
    pub span: Range<usize>,
}

type Text<'a> = LocatingSlice<&'a str>;

impl Expression {
    /// Reads an expression.
    ///
    /// # Errors
    /// What is wrong, with its place.
    pub fn read(text: &str) -> Result<Expression, ExpressionFlaw> {
        let length = text.chars().count();
        let depth = nesting(text);
        let wrong = match length > LONGEST {
            true => Some(Wrong::TooLong(length)),
            false => (depth > DEEPEST).then_some(Wrong::TooDeep(depth)),
        };
        if let Some(wrong) = wrong {
            return Err(ExpressionFlaw {
                wrong,
                span: 0..text.len(),
            });
        }
        let read = delimited(multispace0, sum, multispace0).parse(LocatingSlice::new(text));
        let read = read.map_err(|error| {
            let at = error.offset().min(text.len());
            let rest = text[at..].chars().next().map_or(0, char::len_utf8);
            match unreadable(text, at) {
                // the two stars, of which the first may have been read
                Wrong::Stars => {
                    let read = text[..at].rfind("**").unwrap_or(at.saturating_sub(1));
                    let first = if text[at..].starts_with("**") {
                        at
                    } else {
                        read
                    };
                    (Wrong::Stars, first..first + 2)
                }
                wrong => (wrong, at..at + rest),
            }
        });
        read.map_err(|(wrong, span)| ExpressionFlaw { wrong, span })
    }

    /// Hands over every name in it, with its place.
    pub fn names(&self, take: &mut impl FnMut(&str, &Range<usize>)) {
        match &self.node {
            ExpressionNode::Number(_) => {}
            ExpressionNode::Name(name) => take(name, &self.span),
            ExpressionNode::Negative(one) | ExpressionNode::Call(_, one) => one.names(take),
            ExpressionNode::Binary(_, both) | ExpressionNode::Extremum(_, both) => {
                both.iter().for_each(|part| part.names(take));
            }
        }
    }

    /// Its value, where names stand for what `meaning` says.
    ///
    /// # Errors
    /// A name without meaning, or an operation without result, with its place.
    pub fn evaluate<A: Algebra>(
        &self,
        meaning: &impl Fn(&str) -> Option<A>,
    ) -> Result<A, ExpressionFlaw> {
        let here = |wrong| ExpressionFlaw {
            wrong,
            span: self.span.clone(),
        };
        let value = match &self.node {
            ExpressionNode::Number(number) => Ok(A::decimal(number.0, &number.1)),
            ExpressionNode::Name(name) => meaning(name).ok_or_else(|| Wrong::Unknown(name.clone())),
            ExpressionNode::Negative(one) => Ok(one.evaluate(meaning)?.negative()),
            ExpressionNode::Binary(operation, both) => {
                let [one, other] = &**both;
                let (one, other) = (one.evaluate(meaning)?, other.evaluate(meaning)?);
                one.operate(*operation, other).map_err(Wrong::from)
            }
            ExpressionNode::Extremum(extremum, both) => {
                let [one, other] = &**both;
                let (one, other) = (one.evaluate(meaning)?, other.evaluate(meaning)?);
                one.extremum(*extremum, other).map_err(Wrong::from)
            }
            ExpressionNode::Call(name, one) => {
                let argument = one.evaluate(meaning)?;
                let function = Function::named(name);
                let function = function.ok_or_else(|| Wrong::NoFunction(name.clone()));
                function.and_then(|function| Ok(argument.apply(function)?))
            }
        };
        value.map_err(here)
    }
}

/// Why a text is no expression from a place on.
fn unreadable(text: &str, at: usize) -> Wrong {
    let (before, rest) = (text[..at].trim_end(), text[at..].trim_start());
    let open = before.matches('(').count() > before.matches(')').count();
    let is_operand = |c: char| c.is_alphanumeric() || c == '_';
    let ends = before.ends_with(|c| is_operand(c) || c == ')' || c == '.');
    let begins = rest.starts_with(|c| is_operand(c) || c == '(');
    if rest.is_empty() && open && ends {
        Wrong::Unclosed
    } else if rest.starts_with(')') && !open {
        Wrong::Unopened
    } else if rest.starts_with(')') && ends {
        Wrong::Second
    } else if before.ends_with("**")
        || rest.starts_with("**")
        || rest.starts_with('*') && before.ends_with('*')
    {
        Wrong::Stars
    } else if rest.starts_with(',') {
        Wrong::Comma
    } else if ends && begins {
        Wrong::Juxtaposed
    } else {
        Wrong::Unreadable
    }
}

/// How deeply brackets, and signs and powers of signs and powers, are nested.
fn nesting(text: &str) -> usize {
    // signs and powers that are open in every bracket
    let mut open = vec![0];
    let (mut deepest, mut after_operand) = (0, false);
    for c in text.chars().filter(|c| !c.is_whitespace()) {
        let level = open.len() - 1;
        match c {
            '(' => open.push(0),
            ')' if level > 0 => {
                open.pop();
            }
            '^' => open[level] += 1,
            '+' | '-' if !after_operand => open[level] += 1,
            '+' | '-' | '*' | '/' | ',' => open[level] = 0,
            _ => {}
        }
        after_operand = !"(^+-*/,".contains(c);
        deepest = deepest.max(open.len() - 1 + open.iter().sum::<usize>());
    }
    deepest
}

/// A number. On its own, so that nested brackets take less of the stack.
#[inline(never)]
fn number(text: &mut Text) -> ModalResult<ExpressionNode> {
    let exponent = (one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1);
    let digits = alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void()));
    let number = (digits, opt(exponent)).take();
    number
        .verify_map(|text: &str| {
            let value = text.parse().ok()?;
            Some(ExpressionNode::Number(Box::new((value, text.to_owned()))))
        })
        .parse_next(text)
}

/// A name, or a call of a function.
#[inline(never)]
fn named(text: &mut Text) -> ModalResult<ExpressionNode> {
    let first = |c: char| c.is_alphabetic() || c == '_';
    let more = |c: char| c.is_alphanumeric() || c == '_';
    let mut name = (one_of(first), take_while(0.., more)).take();
    let name: &str = name.parse_next(text)?;
    let closed = || cut_err(preceded(multispace0, ')'));
    let opened = || (multispace0, '(', multispace0);
    if let Some(extremum) = Extremum::named(name) {
        let second = preceded((cut_err(','), multispace0), cut_err(sum));
        let both = delimited(opened(), (cut_err(sum), second), closed());
        return opt(both)
            .map(|both| match both {
                None => ExpressionNode::Name(name.to_owned()),
                Some((one, other)) => ExpressionNode::Extremum(extremum, Box::new([one, other])),
            })
            .parse_next(text);
    }
    opt(delimited(opened(), cut_err(sum), closed()))
        .map(|argument| match argument {
            None => ExpressionNode::Name(name.to_owned()),
            Some(argument) => ExpressionNode::Call(name.to_owned(), Box::new(argument)),
        })
        .parse_next(text)
}

/// A number, a call, a name or something in brackets.
fn operand(text: &mut Text) -> ModalResult<Expression> {
    let closed = cut_err(preceded(multispace0, ')'));
    let brackets = delimited(('(', multispace0), cut_err(sum), closed);
    let node = alt((number, named, brackets.map(|inner: Expression| inner.node)));
    let spanned = node.with_span();
    let spanned = delimited(multispace0, spanned, multispace0);
    spanned
        .map(|(node, span)| Expression { node, span })
        .parse_next(text)
}

/// Operands with signs and operators between them.
fn sum(text: &mut Text) -> ModalResult<Expression> {
    fn binary<const OPERATION: usize>(
        _: &mut Text,
        one: Expression,
        other: Expression,
    ) -> ModalResult<Expression> {
        let span = one.span.start..other.span.end;
        let node = ExpressionNode::Binary(Operation::ALL[OPERATION], Box::new([one, other]));
        Ok(Expression { node, span })
    }
    expression(operand)
        .prefix(dispatch! {peek(any);
            '-' => preceded((any, multispace0), Prefix(9, |_: &mut Text, one: Expression| {
                let span = one.span.clone();
                Ok(Expression { node: ExpressionNode::Negative(Box::new(one)), span })
            })),
            '+' => preceded((any, multispace0), Prefix(9, |_: &mut Text, one| Ok(one))),
            _ => fail,
        })
        .infix(dispatch! {any;
            '+' => preceded(multispace0, Infix::Left(5, binary::<0>)),
            '-' => preceded(multispace0, Infix::Left(5, binary::<1>)),
            '*' => preceded(multispace0, Infix::Left(7, binary::<2>)),
            '/' => preceded(multispace0, Infix::Left(7, binary::<3>)),
            '^' => preceded(multispace0, Infix::Right(11, binary::<4>)),
            _ => fail,
        })
        .parse_next(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<f64, ExpressionFlaw> {
        Expression::read(text)?.evaluate(&|name| match name {
            "x" => Some(3.0),
            "omega_0" => Some(0.5),
            _ => None,
        })
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        for (text, expected) in [
            ("-x^2", -9.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("1 - 2 - 3", -4.0),
            ("8/4/2", 1.0),
            ("1 + 2*x", 7.0),
            ("-(1 + 2)*x", -9.0),
            ("1e-3*.5e3 + 2.", 2.5),
            (" cos ( 0 ) * omega_0", 0.5),
            ("x*-2", -6.0),
            ("x * -2 - - 1", -5.0),
            ("2^ - 1", 0.5),
            ("max(-2, -x) + min(0,-x) + max(1, - x)", -4.0),
            ("sqrt(x + 1)*exp(ln(1))/x", 2.0 / 3.0),
            ("max(x, 2) - min (x, 2 ) + min(max(1, x), 5)", 4.0),
            ("acos(0) - asin(1) + atan(0) + sinh(0)*cosh(x)", 0.0),
        ] {
            assert_eq!(value(text), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_has_its_place() {
        let wrong = |text: &str| value(text).unwrap_err();
        let flaw = wrong("(x + 2");
        assert_eq!((flaw.wrong, flaw.span), (Wrong::Unclosed, 6..6));
        for (text, wrong_by, span) in [
            ("x + * 2", Wrong::Unreadable, 4..5),
            ("", Wrong::Unreadable, 0..0),
            ("x x", Wrong::Juxtaposed, 2..3),
            ("2 x", Wrong::Juxtaposed, 2..3),
            ("max(x)", Wrong::Second, 5..6),
            ("max(x, 1, 2)", Wrong::Comma, 8..9),
            ("sin(x, 1)", Wrong::Comma, 5..6),
        ] {
            let flaw = wrong(text);
            assert_eq!((flaw.wrong, flaw.span), (wrong_by, span), "{text}");
        }
        let flaw = wrong("2*xx + x");
        assert_eq!((flaw.wrong, flaw.span), (Wrong::Unknown("xx".into()), 2..4));
        let flaw = wrong("x + sine(x)");
        assert_eq!(
            (flaw.wrong, flaw.span),
            (Wrong::NoFunction("sine".into()), 4..11)
        );
        // deeper than any stack, were it not refused; what is read fits on it
        assert!(matches!(
            wrong(&"(".repeat(100_000)).wrong,
            Wrong::TooLong(_)
        ));
        for deep in ["(", "-", "x^", "sin("] {
            let wrong = |count: usize| wrong(&deep.repeat(count)).wrong;
            assert_eq!(wrong(DEEPEST), Wrong::Unreadable);
            assert_eq!(wrong(DEEPEST + 1), Wrong::TooDeep(DEEPEST + 1));
        }
        let tower = format!("{}x{}", "(".repeat(DEEPEST), ")".repeat(DEEPEST));
        assert_eq!(value(&tower), Ok(3.0));
        // what stands side by side is not nested
        assert_eq!(value(&format!("0{}", "+(-x)^2-x^2".repeat(85))), Ok(0.0));
    }
}
