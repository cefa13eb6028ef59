//! Rows as lines of CSV: a serializer that takes structures apart.

use std::fmt::{self, Write as _};

use serde::ser::{Impossible, Serialize, SerializeMap, SerializeSeq, SerializeStruct, Serializer};

use super::figures::put_number;

/// Names of the columns of a row; its values do not matter.
pub(crate) fn columns(row: &impl Serialize) -> Vec<String> {
    let mut names = Vec::new();
    taken_apart(row, &mut String::new(), Some(&mut names));
    names
}

/// The header of a table of such rows.
pub(crate) fn header<Row: Serialize + Default>() -> String {
    line_of(&columns(&Row::default()))
}

/// A row as a line.
pub(crate) fn line(row: &impl Serialize) -> String {
    let mut text = String::new();
    taken_apart(row, &mut text, None);
    text
}

/// Rows below their header: the columns of the first one, for some are there only when asked for.
pub(crate) fn table<Row: Serialize + Default>(rows: impl IntoIterator<Item = Row>) -> String {
    let mut rows = rows.into_iter().peekable();
    let mut text = rows
        .peek()
        .map_or_else(header::<Row>, |row| line_of(&columns(row)));
    for row in rows {
        taken_apart(&row, &mut text, None);
    }
    text
}

/// Cells as a line of CSV.
pub(crate) fn line_of(cells: &[String]) -> String {
    let mut text = String::new();
    let mut line = Cells::new(&mut text, None);
    for cell in cells {
        let _ = line.put(|text| text.write_str(cell));
    }
    line.end();
    text
}

/// Puts a row below a text as a line, and the names of its columns into a list.
fn taken_apart(row: &impl Serialize, text: &mut String, names: Option<&mut Vec<String>>) {
    let mut cells = Cells::new(text, names);
    let taken = row.serialize(&mut cells);
    debug_assert!(taken.is_ok(), "a row has an enumeration with content");
    cells.end();
}

/// A row being taken apart, into a line below a text.
struct Cells<'a> {
    text: &'a mut String,
    /// Where the line begins, and how many cells it has.
    from: usize,
    count: usize,
    /// Names of the cells, where they are asked for, and that of the field that is next.
    names: Option<&'a mut Vec<String>>,
    field: String,
    /// Elements so far where a list is put into one cell.
    list: Option<usize>,
}

impl<'a> Cells<'a> {
    fn new(text: &'a mut String, names: Option<&'a mut Vec<String>>) -> Cells<'a> {
        Cells {
            from: text.len(),
            count: 0,
            text,
            names,
            field: String::new(),
            list: None,
        }
    }

    /// Begins a cell; returns where.
    fn open(&mut self) -> usize {
        if self.count > 0 {
            self.text.push(',');
        }
        self.count += 1;
        if let Some(names) = &mut self.names {
            names.push(self.field.clone());
        }
        self.text.len()
    }

    /// Puts what would end a cell, from where it begins, between quotes.
    fn close(&mut self, from: usize) {
        let cell = &self.text[from..];
        if cell.contains([',', '"', '\n', '\r']) {
            let quoted = cell.replace('"', "\"\"");
            self.text.truncate(from);
            self.text.extend(["\"", &quoted, "\""]);
        }
    }

    fn put(&mut self, write: impl FnOnce(&mut String) -> fmt::Result) -> fmt::Result {
        if let Some(from) = self.put_plain(write)? {
            self.close(from);
        }
        Ok(())
    }

    /// Puts what ends no cell; returns where its own cell begins, unless it is part of a list.
    fn put_plain(
        &mut self,
        write: impl FnOnce(&mut String) -> fmt::Result,
    ) -> Result<Option<usize>, fmt::Error> {
        let Some(count) = &mut self.list else {
            let from = self.open();
            return write(self.text).map(|()| Some(from));
        };
        if *count > 0 {
            self.text.push(' ');
        }
        *count += 1;
        write(self.text).map(|()| None)
    }

    /// Ends the line; one without anything would be no row.
    fn end(self) {
        if self.text.len() == self.from {
            self.text.push_str("\"\"");
        }
        self.text.push('\n');
    }
}

/// A list being put into one cell, which begins there unless it is within another list.
struct CellList<'b, 'a>(&'b mut Cells<'a>, Option<usize>);

macro_rules! scalars {
    ($($name:ident: $type:ty),*) => {
        $(fn $name(self, value: $type) -> fmt::Result {
            self.put(|text| write!(text, "{value}"))
        })*
    };
}

/// What is no part of a row.
macro_rules! refused {
    ($($name:ident($($type:ty),*) -> $part:ident),*) => {
        $(fn $name(self, $(_: $type),*) -> Result<Self::$part, fmt::Error> {
            Err(fmt::Error)
        })*
    };
}

impl<'b, 'a> Serializer for &'b mut Cells<'a> {
    type Ok = ();
    type Error = fmt::Error;
    type SerializeSeq = CellList<'b, 'a>;
    type SerializeTuple = Impossible<(), fmt::Error>;
    type SerializeTupleStruct = Impossible<(), fmt::Error>;
    type SerializeTupleVariant = Impossible<(), fmt::Error>;
    type SerializeMap = Self;
    type SerializeStruct = Self;
    type SerializeStructVariant = Impossible<(), fmt::Error>;

    scalars!(
        serialize_bool: bool, serialize_char: char, serialize_str: &str,
        serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64,
        serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64
    );

    refused!(
        serialize_bytes(&[u8]) -> Ok,
        serialize_tuple(usize) -> SerializeTuple,
        serialize_tuple_struct(&'static str, usize) -> SerializeTupleStruct,
        serialize_tuple_variant(&'static str, u32, &'static str, usize) -> SerializeTupleVariant,
        serialize_struct_variant(&'static str, u32, &'static str, usize) -> SerializeStructVariant
    );

    fn serialize_f32(self, value: f32) -> fmt::Result {
        self.serialize_f64(value.into())
    }

    fn serialize_f64(self, value: f64) -> fmt::Result {
        self.put_plain(|text| put_number(text, value)).map(drop)
    }

    fn serialize_none(self) -> fmt::Result {
        self.put(|_| Ok(()))
    }

    fn serialize_unit(self) -> fmt::Result {
        self.put(|_| Ok(()))
    }

    fn serialize_unit_struct(self, _: &'static str) -> fmt::Result {
        self.put(|_| Ok(()))
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, name: &'static str) -> fmt::Result {
        self.put(|text| text.write_str(name))
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
        _: &T,
    ) -> fmt::Result {
        Err(fmt::Error)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<CellList<'b, 'a>, fmt::Error> {
        let from = self.list.is_none().then(|| self.open());
        self.list.get_or_insert(0);
        Ok(CellList(self, from))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self, fmt::Error> {
        Ok(self)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self, fmt::Error> {
        Ok(self)
    }
}

impl SerializeStruct for &mut Cells<'_> {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        name: &'static str,
        value: &T,
    ) -> fmt::Result {
        if self.names.is_some() {
            name.clone_into(&mut self.field);
        }
        value.serialize(&mut **self)
    }

    fn end(self) -> fmt::Result {
        Ok(())
    }
}

impl SerializeMap for &mut Cells<'_> {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> fmt::Result {
        if self.names.is_none() {
            return Ok(());
        }
        self.field.clear();
        let mut name = Cells::new(&mut self.field, None);
        // as it is, without quotes
        name.list = Some(0);
        key.serialize(&mut name)
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        value.serialize(&mut **self)
    }

    fn end(self) -> fmt::Result {
        Ok(())
    }
}

impl SerializeSeq for CellList<'_, '_> {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        value.serialize(&mut *self.0)
    }

    fn end(self) -> fmt::Result {
        let CellList(cells, from) = self;
        if let Some(from) = from {
            cells.list = None;
            cells.close(from);
        }
        Ok(())
    }
}
