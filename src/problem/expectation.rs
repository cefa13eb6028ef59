//! What an event is compared with.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::affine::system::Ordered;
use crate::orbit::EventType;
use crate::tube::model::Parameter;

/// Most expectations of a problem.
pub(crate) const MAX_EXPECTATIONS: usize = 1000;

/// How many numbers of an event of a wave can be compared: ω, c, and the parameters.
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
    /// The numbers by the names of their columns, in the order of the file.
    pub(super) numbers: Vec<(String, f64)>,
    /// Regimes before the event, joined by `-`.
    pub regimes_before: Option<String>,
    /// Regimes after the event, joined by `-`.
    pub regimes_after: Option<String>,
    /// Label of the event.
    pub label: Option<usize>,
}

impl Expectation {
    /// Names of the numbers of a wave: Im λ at the crossing, the signed speed c, and every parameter.
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

    /// Names of the numbers of an orbit besides the parameters of its system: its period, and the leading
    /// multiplier that is not trivial.
    pub const OF_ORBITS: [&str; 3] = ["period", "multiplier_re", "multiplier_im"];

    /// Fields beside the numbers.
    pub(super) const FIELDS: [&str; 6] = [
        "event",
        "tolerance",
        "sector",
        "regimes_before",
        "regimes_after",
        "label",
    ];

    /// Fields of a wave's expectation in a problem file.
    const OF_WAVES: [&str; COUNT + 6] = {
        let mut names = [Self::FIELDS[0]; COUNT + 6];
        (names[1], names[2]) = (Self::FIELDS[1], Self::FIELDS[2]);
        let mut index = 0;
        while index < COUNT {
            names[3 + index] = Expectation::NUMBERS[index];
            index += 1;
        }
        (names[COUNT + 3], names[COUNT + 4]) = (Self::FIELDS[3], Self::FIELDS[4]);
        names[COUNT + 5] = Self::FIELDS[5];
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
    pub fn numbers(&self) -> impl Iterator<Item = (&str, f64)> {
        self.numbers
            .iter()
            .map(|(name, value)| (name.as_str(), *value))
    }
}

/// The name of a number as something that lives as long as the program, where it is no parameter of a system.
fn fixed(name: &str) -> Option<&'static str> {
    let mut all = Expectation::NUMBERS
        .into_iter()
        .chain(Expectation::OF_ORBITS);
    all.find(|known| *known == name)
}

/// Numbers stand beside the other fields, or all in a map `numbers` where one has the name of a system's parameter.
impl Serialize for Expectation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let length = Self::FIELDS.len() + self.numbers.len();
        let mut fields = serializer.serialize_struct("Expectation", length)?;
        fields.serialize_field("event", &self.event)?;
        fields.serialize_field("tolerance", &self.tolerance)?;
        fields.serialize_field("sector", &self.sector)?;
        let named = self.numbers.iter();
        let named = named.map(|(name, value)| Some((fixed(name)?, value)));
        match named.collect::<Option<Vec<_>>>() {
            Some(numbers) => {
                for (name, value) in numbers {
                    fields.serialize_field(name, &Some(value))?;
                }
            }
            None => fields.serialize_field("numbers", &Ordered(self.numbers.clone()))?,
        }
        fields.serialize_field("regimes_before", &self.regimes_before)?;
        fields.serialize_field("regimes_after", &self.regimes_after)?;
        fields.serialize_field("label", &self.label)?;
        fields.end()
    }
}

/// Any name may be that of a number, for only a system knows its parameters.
impl<'de> Deserialize<'de> for Expectation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let fields = Fields { known: None };
        deserializer.deserialize_struct("Expectation", &Self::FIELDS, fields)
    }
}

/// Expectations of a problem with waves, which have no other numbers than [`Expectation::NUMBERS`].
pub(super) fn of_waves<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<Expectation>, D::Error> {
    struct OfWave(Expectation);
    impl<'de> Deserialize<'de> for OfWave {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let known = &Expectation::OF_WAVES;
            let fields = Fields { known: Some(known) };
            let read = deserializer.deserialize_struct("Expectation", known, fields);
            read.map(OfWave)
        }
    }
    struct ExpectationList;
    impl<'de> Visitor<'de> for ExpectationList {
        type Value = Vec<Expectation>;
        fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
            formatter.write_str("a sequence")
        }
        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
            let mut read = Vec::new();
            while let Some(OfWave(one)) = list.next_element()? {
                read.push(one);
            }
            Ok(read)
        }
    }
    deserializer.deserialize_seq(ExpectationList)
}

/// Reads the fields of an expectation; where not all names are known, any other one is that of a number.
struct Fields {
    known: Option<&'static [&'static str]>,
}

impl<'de> Visitor<'de> for Fields {
    type Value = Expectation;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an expected event")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Expectation, A::Error> {
        let (mut event, mut tolerance, mut given) = (None, None, Vec::new());
        let (mut sector, mut label, mut numbers) = (None, None, Vec::new());
        let [mut regimes_before, mut regimes_after] = [None, None];
        while let Some(name) = map.next_key::<String>()? {
            if let Some(known) = self.known
                && !known.contains(&name.as_str())
            {
                return Err(A::Error::unknown_field(&name, known));
            }
            let field = Expectation::FIELDS.into_iter().find(|field| *field == name);
            if let Some(name) = field.or(fixed(&name)) {
                if given.contains(&name) {
                    return Err(A::Error::duplicate_field(name));
                }
                given.push(name);
            }
            match name.as_str() {
                "event" => event = Some(map.next_value()?),
                "tolerance" => tolerance = Some(map.next_value()?),
                "sector" => sector = map.next_value()?,
                "regimes_before" => regimes_before = map.next_value()?,
                "regimes_after" => regimes_after = map.next_value()?,
                "label" => label = map.next_value()?,
                "numbers" => numbers.extend(map.next_value::<Ordered<f64>>()?.0),
                _ => {
                    let value: Option<f64> = map.next_value()?;
                    numbers.extend(value.map(|value| (name, value)));
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
