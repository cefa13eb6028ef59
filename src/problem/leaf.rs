//! The numbers and texts of any serialisable data, each with the path to it.

use std::fmt;

use serde::ser::{self, Serialize, Serializer};

/// A number or a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Leaf<'a> {
    Number(f64),
    Text(&'a str),
}

/// A step from a value to one that it holds.
#[derive(Clone, Debug)]
enum PathStep {
    Field(&'static str),
    /// Of a map.
    Key(String),
    Entry(usize),
}

/// The way to a value.
#[derive(Debug, Default)]
pub(super) struct LeafPath(Vec<PathStep>);

impl LeafPath {
    /// The names of the fields, joined by dots.
    pub fn name(&self) -> String {
        let fields = self.0.iter().filter_map(|step| match step {
            PathStep::Field(name) => Some(*name),
            PathStep::Key(name) => Some(name),
            PathStep::Entry(_) => None,
        });
        fields.collect::<Vec<_>>().join(".")
    }

    /// The same with the places of entries, as an outline of the text locates it.
    pub fn address(&self) -> String {
        let steps = self.0.iter().map(|step| match step {
            PathStep::Field(name) => (*name).to_owned(),
            PathStep::Key(name) => name.clone(),
            PathStep::Entry(place) => place.to_string(),
        });
        steps.collect::<Vec<_>>().join(".")
    }
}

/// The first that `look` finds at a number or text of the data.
pub(super) fn find<T>(
    data: &dyn erased_serde::Serialize,
    mut look: impl FnMut(&LeafPath, Leaf<'_>) -> Option<T>,
) -> Option<T> {
    let mut found = None;
    let mut visit = Visit {
        path: LeafPath::default(),
        see: &mut |path, leaf| {
            found = look(path, leaf);
            found.is_some()
        },
    };
    // ends early where something is found
    let _ = data.serialize(&mut visit);
    found
}

/// A visit to all of the data, which ends with an error as soon as `see` says so.
struct Visit<'a> {
    path: LeafPath,
    see: &'a mut dyn FnMut(&LeafPath, Leaf<'_>) -> bool,
}

impl Visit<'_> {
    fn leaf(&mut self, leaf: Leaf<'_>) -> fmt::Result {
        match (self.see)(&self.path, leaf) {
            true => Err(fmt::Error),
            false => Ok(()),
        }
    }

    fn below<T: Serialize + ?Sized>(&mut self, step: PathStep, value: &T) -> fmt::Result {
        self.path.0.push(step);
        value.serialize(&mut *self)?;
        self.path.0.pop();
        Ok(())
    }
}

/// A value that holds others: how many have been passed, and the key of the next of a map.
struct Group<'a, 'b>(&'a mut Visit<'b>, usize, Option<String>);

impl Group<'_, '_> {
    fn entry<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        let place = self.1;
        self.1 += 1;
        self.0.below(PathStep::Entry(place), value)
    }
}

macro_rules! numbers {
    ($($name:ident: $type:ty),*) => {
        $(fn $name(self, value: $type) -> fmt::Result {
            self.leaf(Leaf::Number(value as f64))
        })*
    };
}

/// What has neither numbers nor texts.
macro_rules! silent {
    ($($name:ident($($type:ty),*)),*) => {
        $(fn $name(self, $(_: $type),*) -> fmt::Result {
            Ok(())
        })*
    };
}

/// What holds values, with the other arguments that tell its name and length.
macro_rules! groups {
    ($($name:ident($($type:ty),*) -> $part:ident),*) => {
        $(fn $name(self, $(_: $type),*) -> Result<Self::$part, fmt::Error> {
            Ok(Group(self, 0, None))
        })*
    };
}

impl<'a, 'b> Serializer for &'a mut Visit<'b> {
    type Ok = ();
    type Error = fmt::Error;
    type SerializeSeq = Group<'a, 'b>;
    type SerializeTuple = Group<'a, 'b>;
    type SerializeTupleStruct = Group<'a, 'b>;
    type SerializeTupleVariant = Group<'a, 'b>;
    type SerializeMap = Group<'a, 'b>;
    type SerializeStruct = Group<'a, 'b>;
    type SerializeStructVariant = Group<'a, 'b>;

    numbers!(
        serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64,
        serialize_f32: f32, serialize_f64: f64
    );

    silent!(
        serialize_bool(bool),
        serialize_char(char),
        serialize_bytes(&[u8]),
        serialize_none(),
        serialize_unit(),
        serialize_unit_struct(&'static str),
        serialize_unit_variant(&'static str, u32, &'static str)
    );

    groups!(
        serialize_seq(Option<usize>) -> SerializeSeq,
        serialize_tuple(usize) -> SerializeTuple,
        serialize_tuple_struct(&'static str, usize) -> SerializeTupleStruct,
        serialize_tuple_variant(&'static str, u32, &'static str, usize) -> SerializeTupleVariant,
        serialize_map(Option<usize>) -> SerializeMap,
        serialize_struct(&'static str, usize) -> SerializeStruct,
        serialize_struct_variant(&'static str, u32, &'static str, usize) -> SerializeStructVariant
    );

    fn serialize_str(self, value: &str) -> fmt::Result {
        self.leaf(Leaf::Text(value))
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> fmt::Result {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> fmt::Result {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        value: &T,
    ) -> fmt::Result {
        self.below(PathStep::Entry(0), value)
    }
}

/// Values without names, by the trait and the method that takes them.
macro_rules! entries {
    ($($part:ident::$method:ident),*) => {
        $(impl ser::$part for Group<'_, '_> {
            type Ok = ();
            type Error = fmt::Error;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
                self.entry(value)
            }

            fn end(self) -> fmt::Result {
                Ok(())
            }
        })*
    };
}

/// Values with names, by their trait.
macro_rules! fields {
    ($($part:ident),*) => {
        $(impl ser::$part for Group<'_, '_> {
            type Ok = ();
            type Error = fmt::Error;

            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                name: &'static str,
                value: &T,
            ) -> fmt::Result {
                self.0.below(PathStep::Field(name), value)
            }

            fn end(self) -> fmt::Result {
                Ok(())
            }
        })*
    };
}

entries!(
    SerializeSeq::serialize_element,
    SerializeTuple::serialize_element,
    SerializeTupleStruct::serialize_field,
    SerializeTupleVariant::serialize_field
);
fields!(SerializeStruct, SerializeStructVariant);

impl ser::SerializeMap for Group<'_, '_> {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> fmt::Result {
        self.2 = None;
        let mut visit = Visit {
            path: LeafPath::default(),
            see: &mut |_, leaf| {
                if let Leaf::Text(text) = leaf {
                    self.2 = Some(text.to_owned());
                }
                false
            },
        };
        key.serialize(&mut visit)?;
        // names are texts as well, of the map itself
        match self.2.clone() {
            Some(name) => self.0.leaf(Leaf::Text(&name)),
            None => Ok(()),
        }
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        match self.2.take() {
            Some(name) => self.0.below(PathStep::Key(name), value),
            None => self.entry(value),
        }
    }

    fn end(self) -> fmt::Result {
        Ok(())
    }
}
