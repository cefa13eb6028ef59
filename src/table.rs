//! Structures as rows of CSV and back, by serde.
//!
//! A field is a column by its name. A structure or a map within a row has its own columns, and a list
//! stands in one cell, separated by blanks. Numbers carry 17 significant digits, so that reading them
//! back gives the same double; what is not finite, and what is not there, is an empty cell.

use std::fmt;
use std::str::FromStr;

use csv::StringRecord;
use serde::de::DeserializeOwned;
use serde::ser::{Impossible, Serialize, SerializeMap, SerializeSeq, SerializeStruct, Serializer};

/// A number with 17 significant digits; empty where it is not finite.
pub(crate) fn number(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.16e}")
    } else {
        String::new()
    }
}

/// Names of the columns of a row; its values do not matter.
pub(crate) fn columns(row: &impl Serialize) -> Vec<String> {
    cells(row).0
}

/// The header of a table of such rows.
pub(crate) fn header<Row: Serialize + Default>() -> String {
    line_of(&columns(&Row::default()))
}

/// A row as a line.
pub(crate) fn line(row: &impl Serialize) -> String {
    line_of(&cells(row).1)
}

/// Rows below their header: the columns of the first one, for some are there only when asked for.
pub(crate) fn table<Row: Serialize + Default>(rows: impl IntoIterator<Item = Row>) -> String {
    let mut rows = rows.into_iter().peekable();
    let mut text = rows
        .peek()
        .map_or_else(header::<Row>, |row| line_of(&columns(row)));
    for row in rows {
        text.push_str(&line(&row));
    }
    text
}

/// Cells as a line of CSV.
pub(crate) fn line_of(cells: &[String]) -> String {
    let mut writer = csv::Writer::from_writer(Vec::with_capacity(512));
    // writing to memory does not fail
    let _ = writer.write_record(cells);
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// Names and cells of a row.
fn cells(row: &impl Serialize) -> (Vec<String>, Vec<String>) {
    let mut cells = Cells::default();
    let taken = row.serialize(&mut cells);
    debug_assert!(taken.is_ok(), "a row has an enumeration with content");
    (cells.names, cells.texts)
}

/// A row being taken apart.
#[derive(Default)]
struct Cells {
    /// Name of the field that is next.
    field: String,
    names: Vec<String>,
    texts: Vec<String>,
}

impl Cells {
    fn put(&mut self, text: String) -> fmt::Result {
        self.names.push(self.field.clone());
        self.texts.push(text);
        Ok(())
    }
}

/// A list being put into one cell: all cells from an index on.
struct List<'a>(&'a mut Cells, usize);

macro_rules! scalars {
    ($($name:ident: $type:ty),*) => {
        $(fn $name(self, value: $type) -> fmt::Result {
            self.put(value.to_string())
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

impl<'a> Serializer for &'a mut Cells {
    type Ok = ();
    type Error = fmt::Error;
    type SerializeSeq = List<'a>;
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
        self.put(number(value.into()))
    }

    fn serialize_f64(self, value: f64) -> fmt::Result {
        self.put(number(value))
    }

    fn serialize_none(self) -> fmt::Result {
        self.put(String::new())
    }

    fn serialize_unit(self) -> fmt::Result {
        self.put(String::new())
    }

    fn serialize_unit_struct(self, _: &'static str) -> fmt::Result {
        self.put(String::new())
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, name: &'static str) -> fmt::Result {
        self.put(name.to_owned())
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

    fn serialize_seq(self, _: Option<usize>) -> Result<List<'a>, fmt::Error> {
        let from = self.texts.len();
        Ok(List(self, from))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self, fmt::Error> {
        Ok(self)
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self, fmt::Error> {
        Ok(self)
    }
}

impl SerializeStruct for &mut Cells {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        name: &'static str,
        value: &T,
    ) -> fmt::Result {
        self.field = name.to_owned();
        value.serialize(&mut **self)
    }

    fn end(self) -> fmt::Result {
        Ok(())
    }
}

impl SerializeMap for &mut Cells {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> fmt::Result {
        let mut name = Cells::default();
        key.serialize(&mut name)?;
        self.field = name.texts.concat();
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        value.serialize(&mut **self)
    }

    fn end(self) -> fmt::Result {
        Ok(())
    }
}

impl SerializeSeq for List<'_> {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        value.serialize(&mut *self.0)
    }

    fn end(self) -> fmt::Result {
        let List(cells, from) = self;
        let text = cells.texts.split_off(from).join(" ");
        cells.names.truncate(from);
        cells.put(text)
    }
}

/// A table that was read: a header, and all rows that are finished.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Table {
    header: StringRecord,
    rows: Vec<StringRecord>,
}

impl Table {
    /// Reads a table. A last line without its end was cut short by a kill and is left out; a row may
    /// have fewer cells than the header, and blanks round them.
    ///
    /// # Errors
    /// When it is no CSV.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Table, csv::Error> {
        let whole = bytes.iter().rposition(|byte| *byte == b'\n');
        let text = String::from_utf8_lossy(&bytes[..whole.map_or(0, |last| last + 1)]);
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
        Ok(Table {
            header: reader.headers()?.clone(),
            rows: reader.records().collect::<Result<_, _>>()?,
        })
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(crate) fn columns(&self) -> impl Iterator<Item = &str> {
        self.header.iter()
    }

    /// Whether there is a column of this name.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.columns().any(|name| name == column)
    }

    /// A cell; empty when there is none.
    pub(crate) fn text(&self, row: usize, column: &str) -> &str {
        self.columns()
            .position(|name| name == column)
            .and_then(|index| self.rows.get(row)?.get(index))
            .unwrap_or("")
    }

    /// A cell as a value; none when it is empty or something else.
    pub(crate) fn field<T: FromStr>(&self, row: usize, column: &str) -> Option<T> {
        self.text(row, column).parse().ok()
    }

    /// A cell with a list of numbers.
    pub(crate) fn list(&self, row: usize, column: &str) -> Vec<f64> {
        let words = self.text(row, column).split_whitespace();
        words.filter_map(|word| word.parse().ok()).collect()
    }

    /// The first row that has this in its column `label`.
    pub(crate) fn labelled(&self, label: &str) -> Option<usize> {
        (0..self.len()).find(|row| !label.is_empty() && self.text(*row, "label") == label)
    }

    /// All rows as structures whose fields are columns; other columns do not matter.
    ///
    /// # Errors
    /// When a column is missing, or a cell is not of its type.
    pub(crate) fn rows<T: DeserializeOwned>(&self) -> Result<Vec<T>, csv::Error> {
        let rows = self.rows.iter();
        rows.map(|row| row.deserialize(Some(&self.header)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::{Deserialize, Serialize};

    #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
    struct Place {
        x: f64,
        y: Option<f64>,
    }

    #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
    struct Row {
        count: usize,
        #[serde(rename = "type")]
        kind: String,
        place: Place,
        list: Vec<f64>,
        last: f64,
    }

    #[test]
    fn structures_are_columns_and_lists_are_cells() {
        assert_eq!(header::<Row>(), "count,type,x,y,list,last\n");
        let row = Row {
            count: 3,
            kind: "a, \"b\"".to_owned(),
            place: Place {
                x: 1.0 / 3.0,
                y: None,
            },
            list: vec![0.5, -2.0],
            last: f64::NAN,
        };
        assert_eq!(
            line(&row),
            "3,\"a, \"\"b\"\"\",3.3333333333333331e-1,,\
             5.0000000000000000e-1 -2.0000000000000000e0,\n"
        );
    }

    /// Reading gives back the same doubles, whatever they are.
    #[test]
    fn numbers_survive_a_table() {
        let rows: Vec<Place> = (1..100)
            .map(|n| Place {
                x: f64::from(n).sqrt() * 10_f64.powi(6 * n - 300),
                y: (n % 2 == 0).then_some(-f64::MIN_POSITIVE / f64::from(n)),
            })
            .collect();
        let text = table(rows.iter().map(|row| Place { ..*row }));
        let read = Table::parse(text.as_bytes()).unwrap();
        assert_eq!(read.rows::<Place>().unwrap(), rows);
        assert_eq!(read.field::<f64>(3, "x"), Some(rows[3].x));
        // a kill within the last row
        let cut = Table::parse(&text.as_bytes()[..text.len() - 1]).unwrap();
        assert_eq!(cut.len(), rows.len() - 1);
    }

    #[test]
    fn what_is_not_there_is_empty() {
        let table = Table::parse(b"\xef\xbb\xbflabel, a\n1, 2 3\n7\n").unwrap();
        assert_eq!(table.list(0, "a"), [2.0, 3.0]);
        assert_eq!(table.labelled("7"), Some(1));
        assert_eq!((table.text(1, "a"), table.text(5, "a")), ("", ""));
        assert!(!table.has("b") && table.field::<usize>(0, "b").is_none());
        assert!(table.rows::<Place>().is_err());
    }
}
