//! What an event is compared with.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::model::Parameter;
use crate::orbit::EventType;

/// Most expectations of a problem.
pub(crate) const MAX_EXPECTATIONS: usize = 1000;

/// How many numbers of an event can be compared: ω, c, and the parameters.
const COUNT: usize = 2 + Parameter::ALL.len();

/// An event that must be found, with the numbers it must have.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// Type of the event.
    pub event: EventType,
    /// Admitted difference: relative, absolute where the expected value is 0.
    pub tolerance: f64,
    /// Bloch sector, at most half the mode.
    pub sector: Option<usize>,
    /// The numbers, in the order of [`Expectation::NUMBERS`].
    numbers: [Option<f64>; COUNT],
    /// Regimes before the event, joined by `-`.
    pub regimes_before: Option<String>,
    /// Regimes after the event, joined by `-`.
    pub regimes_after: Option<String>,
    /// Label of the event.
    pub label: Option<usize>,
}

impl Expectation {
    /// Names of the numbers: Im λ at the crossing, the signed speed c of the wave, and every parameter.
    pub const NUMBERS: [&str; COUNT] = {
        let mut names = ["omega"; COUNT];
        names[1] = "speed";
        let mut index = 2;
        while index < COUNT {
            names[index] = Parameter::ALL[index - 2].column();
            index += 1;
        }
        names
    };

    /// Fields in a problem file.
    const FIELDS: [&str; COUNT + 6] = {
        let [event, tolerance, sector] = ["event", "tolerance", "sector"];
        let mut names = [event; COUNT + 6];
        (names[1], names[2]) = (tolerance, sector);
        let mut index = 0;
        while index < COUNT {
            names[3 + index] = Expectation::NUMBERS[index];
            index += 1;
        }
        (names[COUNT + 3], names[COUNT + 4]) = ("regimes_before", "regimes_after");
        names[COUNT + 5] = "label";
        names
    };

    /// Least and greatest value that passes for the expected one.
    pub fn admitted(&self, expected: f64) -> [f64; 2] {
        let width = match expected {
            0.0 => self.tolerance,
            _ => self.tolerance * expected.abs(),
        };
        [expected - width, expected + width]
    }

    /// The numbers to compare, each with its name.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let named = Expectation::NUMBERS.into_iter().zip(self.numbers);
        named
            .filter_map(|(name, value)| value.map(|value| (name, value)))
            .collect()
    }
}

impl Serialize for Expectation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Expectation", Self::FIELDS.len())?;
        fields.serialize_field("event", &self.event)?;
        fields.serialize_field("tolerance", &self.tolerance)?;
        fields.serialize_field("sector", &self.sector)?;
        for (name, value) in Expectation::NUMBERS.into_iter().zip(&self.numbers) {
            fields.serialize_field(name, value)?;
        }
        fields.serialize_field("regimes_before", &self.regimes_before)?;
        fields.serialize_field("regimes_after", &self.regimes_after)?;
        fields.serialize_field("label", &self.label)?;
        fields.end()
    }
}

impl<'de> Deserialize<'de> for Expectation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_struct("Expectation", &Self::FIELDS, Fields)
    }
}

/// Reads the fields of an expectation.
struct Fields;

impl<'de> Visitor<'de> for Fields {
    type Value = Expectation;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an expected event")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Expectation, A::Error> {
        let (mut event, mut tolerance, mut given) = (None, None, Vec::new());
        let (mut sector, mut label, mut numbers) = (None, None, [None; COUNT]);
        let [mut regimes_before, mut regimes_after] = [None, None];
        while let Some(name) = map.next_key::<String>()? {
            let mut known = Expectation::FIELDS.into_iter();
            let name = known
                .find(|known| *known == name)
                .ok_or_else(|| A::Error::unknown_field(&name, &Expectation::FIELDS))?;
            if given.contains(&name) {
                return Err(A::Error::duplicate_field(name));
            }
            given.push(name);
            match name {
                "event" => event = Some(map.next_value()?),
                "tolerance" => tolerance = Some(map.next_value()?),
                "sector" => sector = map.next_value()?,
                "regimes_before" => regimes_before = map.next_value()?,
                "regimes_after" => regimes_after = map.next_value()?,
                "label" => label = map.next_value()?,
                _ => {
                    let value = map.next_value()?;
                    let mut named = Expectation::NUMBERS.into_iter().zip(&mut numbers);
                    if let Some((_, number)) = named.find(|(known, _)| *known == name) {
                        *number = value;
                    }
                }
            }
        }
        Ok(Expectation {
            event: event.ok_or_else(|| A::Error::missing_field("event"))?,
            tolerance: tolerance.ok_or_else(|| A::Error::missing_field("tolerance"))?,
            sector,
            numbers,
            regimes_before,
            regimes_after,
            label,
        })
    }
}
