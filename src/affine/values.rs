//! Values of parameters, which may be expressions in numbers and in the parameters before them.

use std::fmt;

use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::algebra::{Algebra, Function, Obstacle, Operation};
use super::expression::{Expression, ExpressionFlaw, Wrong};

/// The value of an expression after these parameters.
///
/// # Errors
/// It cannot be read, or has a name that is none of them.
pub fn value(text: &str, before: &[(String, f64)]) -> Result<f64, ExpressionFlaw> {
    let meaning = |name: &str| match name {
        "pi" => Some(std::f64::consts::PI),
        _ => {
            let mut known = before.iter();
            known.find(|(known, _)| known == name).map(|one| one.1)
        }
    };
    let value = Expression::read(text)?.evaluate(&meaning);
    value.map_err(|flaw| ExpressionFlaw {
        wrong: match flaw.wrong {
            Wrong::Unknown(name) => Wrong::NotBefore(name),
            wrong => wrong,
        },
        ..flaw
    })
}

impl Algebra for f64 {
    fn number(value: f64) -> f64 {
        value
    }

    fn negative(self) -> f64 {
        -self
    }

    fn operate(self, operation: Operation, other: f64) -> Result<f64, Obstacle> {
        Ok(match operation {
            Operation::Plus => self + other,
            Operation::Minus => self - other,
            Operation::Times => self * other,
            Operation::Over => self / other,
            Operation::Power => self.powf(other),
        })
    }

    fn apply(self, function: Function) -> Result<f64, Obstacle> {
        Ok(function.at(self).0)
    }
}

/// Reads the map of parameters. An expression that has no value is no number: what is wrong with it is told where its text
/// is known.
pub(super) fn read<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<(String, f64)>, D::Error> {
    deserializer.deserialize_map(ValuesVisitor)
}

struct ValuesVisitor;

impl<'de> Visitor<'de> for ValuesVisitor {
    type Value = Vec<(String, f64)>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a map `{\"name\": value, ..}`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut values = Vec::new();
        while let Some((name, written)) = map.next_entry::<String, WrittenValue>()? {
            let value = match written {
                WrittenValue::Number(value) => value,
                WrittenValue::Text(text) => value(&text, &values).unwrap_or(f64::NAN),
            };
            values.push((name, value));
        }
        Ok(values)
    }
}

/// A value as it is written.
enum WrittenValue {
    Number(f64),
    Text(String),
}

impl<'de> Deserialize<'de> for WrittenValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<WrittenValue, D::Error> {
        deserializer.deserialize_any(WrittenVisitor)
    }
}

struct WrittenVisitor;

impl Visitor<'_> for WrittenVisitor {
    type Value = WrittenValue;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number, or an expression in quotes")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<WrittenValue, E> {
        Ok(WrittenValue::Number(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<WrittenValue, E> {
        Ok(WrittenValue::Number(value as f64))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<WrittenValue, E> {
        Ok(WrittenValue::Number(value as f64))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<WrittenValue, E> {
        Ok(WrittenValue::Text(text.to_owned()))
    }
}
