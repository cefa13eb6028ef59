//! Structures as rows of CSV and back, by serde.
//!
//! A field is a column by its name. A structure or a map within a row has its own columns, and a list
//! stands in one cell, separated by blanks. Numbers carry 17 significant digits, so that reading them
//! back gives the same double; what is not finite, and what is not there, is an empty cell.

use std::borrow::Cow;
use std::fmt::{self, Write as _};
use std::str::FromStr;

use csv::StringRecord;
use serde::de::DeserializeOwned;
use serde::ser::{Impossible, Serialize, SerializeMap, SerializeSeq, SerializeStruct, Serializer};

/// A number with 17 significant digits; empty where it is not finite.
pub(crate) fn number(value: f64) -> String {
    let mut text = String::new();
    // writing to memory does not fail
    let _ = put_number(&mut text, value);
    text
}

fn put_number(text: &mut String, value: f64) -> fmt::Result {
    if !value.is_finite() {
        return Ok(());
    }
    match figures(value.abs()) {
        Some(figures) => put_figures(text, value.is_sign_negative(), figures),
        None => write!(text, "{value:.16e}"),
    }
}

/// Significant digits of a number.
const DIGITS: usize = 17;

/// Least number of one digit more.
const TOO_MANY: u128 = 10_u128.pow(DIGITS as u32);

/// Powers of five up to the last one whose product with a mantissa fits into 128 bits.
const FIVES: [u128; 33] = {
    let mut powers = [1; 33];
    let mut index = 1;
    while index < powers.len() {
        powers[index] = 5 * powers[index - 1];
        index += 1;
    }
    powers
};

/// The significant digits of a number ≥ 0 as an integer, rounded to the nearest one, of two to the even one, and the
/// decimal exponent of the first digit. None of numbers whose product with a power of ten takes more than 128 bits:
/// those below 1e-16 and those from 1e17.
fn figures(value: f64) -> Option<(u128, i32)> {
    if value == 0.0 {
        return Some((0, 0));
    }
    let bits = value.to_bits();
    // value = mantissa·2^exponent
    let mantissa = u128::from(bits & ((1 << 52) - 1) | 1 << 52);
    let exponent = i32::try_from(bits >> 52).ok()? - 1075;
    // log₁₀ 2 = 315653/2²⁰ to all digits that count; the mantissa may add one
    let least = ((exponent + 52) * 315_653) >> 20;
    let digits = |decimal: i32| {
        let scale = DIGITS as i32 - 1 - decimal;
        let product = mantissa * FIVES.get(usize::try_from(scale).ok()?)?;
        Some(match exponent + scale {
            up @ 0.. => product << up,
            down => rounded(product, down.unsigned_abs()),
        })
    };
    match digits(least)? {
        enough if enough < TOO_MANY => Some((enough, least)),
        _ => Some((digits(least + 1)?, least + 1)),
    }
}

/// n/2^bits to the nearest integer, of two to the even one.
fn rounded(n: u128, bits: u32) -> u128 {
    let (whole, rest, half) = (n >> bits, n & ((1 << bits) - 1), 1 << (bits - 1));
    whole + u128::from(rest > half || rest == half && whole % 2 == 1)
}

/// Puts digits below a text as `{:e}` does.
fn put_figures(text: &mut String, negative: bool, (digits, exponent): (u128, i32)) -> fmt::Result {
    let mut figures = *b"-0.0000000000000000e";
    // 17 digits are less than 2⁶⁴
    let mut left = digits as u64;
    for index in (1..=DIGITS + 1).rev().filter(|index| *index != 2) {
        figures[index] += (left % 10) as u8;
        left /= 10;
    }
    let shown = &figures[usize::from(!negative)..];
    text.push_str(std::str::from_utf8(shown).map_err(|_| fmt::Error)?);
    if exponent < 0 {
        text.push('-');
    }
    let size = exponent.unsigned_abs();
    for digit in [size / 10, size % 10]
        .into_iter()
        .skip(usize::from(size < 10))
    {
        text.extend(char::from_digit(digit, 10));
    }
    Ok(())
}

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
struct List<'b, 'a>(&'b mut Cells<'a>, Option<usize>);

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
    type SerializeSeq = List<'b, 'a>;
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

    fn serialize_seq(self, _: Option<usize>) -> Result<List<'b, 'a>, fmt::Error> {
        let from = self.list.is_none().then(|| self.open());
        self.list.get_or_insert(0);
        Ok(List(self, from))
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

impl SerializeSeq for List<'_, '_> {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        value.serialize(&mut *self.0)
    }

    fn end(self) -> fmt::Result {
        let List(cells, from) = self;
        if let Some(from) = from {
            cells.list = None;
            cells.close(from);
        }
        Ok(())
    }
}

/// A table that was read: a header, and all rows that are finished.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Table {
    header: Vec<String>,
    /// All cells, without what separates them.
    text: String,
    /// Where each cell ends in the text.
    ends: Vec<usize>,
    /// The number of cells up to the end of each row.
    rows: Vec<usize>,
}

impl Table {
    /// Reads a table. A last line without its end was cut short by a kill and is left out; a row may
    /// have fewer cells than the header, and blanks round them.
    ///
    /// # Errors
    /// When it is no CSV.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Table, csv::Error> {
        let whole = bytes.iter().rposition(|byte| *byte == b'\n');
        let bytes = &bytes[..whole.map_or(0, |last| last + 1)];
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => String::from_utf8_lossy(bytes),
        };
        let text = text.trim_start_matches('\u{feff}');
        let mut table = Table::default();
        if text.bytes().any(|byte| matches!(byte, b'"' | b'\r')) {
            let mut reader = csv::ReaderBuilder::new()
                .flexible(true)
                .has_headers(false)
                .from_reader(text.as_bytes());
            for record in reader.records() {
                table.push(record?.iter());
            }
        } else {
            table.text.reserve(text.len());
            table.push_plain(text);
        }
        Ok(table)
    }

    /// Adds all lines of a text without quotes; empty ones are none.
    fn push_plain(&mut self, text: &str) {
        let (mut cells, mut from) = (Vec::new(), 0);
        for (place, byte) in text.bytes().enumerate() {
            if !matches!(byte, b',' | b'\n') {
                continue;
            }
            cells.push(&text[from..place]);
            from = place + 1;
            if byte == b'\n' {
                if cells != [""] {
                    self.push(cells.iter().copied());
                }
                cells.clear();
            }
        }
    }

    /// Adds a line: the first one is the header.
    fn push<'a>(&mut self, cells: impl Iterator<Item = &'a str>) {
        if self.header.is_empty() {
            self.header = cells.map(|name| name.trim().to_owned()).collect();
            return;
        }
        for cell in cells {
            self.text.push_str(cell);
            self.ends.push(self.text.len());
        }
        self.rows.push(self.ends.len());
    }

    /// The same table with other cells in a column.
    pub(crate) fn with(&self, column: &str, cell: impl Fn(usize) -> String) -> Table {
        let mut table = Table::default();
        table.push(self.columns());
        for row in 0..self.len() {
            let own = cell(row);
            let cells = self.columns().zip(self.row(row));
            table.push(cells.map(|(name, text)| if name == column { &*own } else { text }));
        }
        table
    }

    /// The cells of a row.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = &str> {
        let first = row.checked_sub(1).map_or(0, |before| self.rows[before]);
        (first..self.rows[row]).map(|cell| self.cell(cell))
    }

    /// A cell by its number in the table, without blanks round it.
    fn cell(&self, cell: usize) -> &str {
        let from = cell.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.text[from..self.ends[cell]].trim()
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(crate) fn columns(&self) -> impl Iterator<Item = &str> {
        self.header.iter().map(String::as_str)
    }

    /// Whether there is a column of this name.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.columns().any(|name| name == column)
    }

    /// A cell; empty when there is none.
    pub(crate) fn text(&self, row: usize, column: &str) -> &str {
        let place = self.columns().position(|name| name == column);
        place.map_or("", |place| self.text_at(row, place))
    }

    /// A cell by the place of its column; empty when there is none.
    fn text_at(&self, row: usize, place: usize) -> &str {
        let Some(last) = self.rows.get(row) else {
            return "";
        };
        let first = row.checked_sub(1).map_or(0, |before| self.rows[before]);
        match first + place < *last {
            true => self.cell(first + place),
            false => "",
        }
    }

    /// The cells of these columns, row by row; those of a column that is missing are empty.
    pub(crate) fn select<const N: usize>(
        &self,
        columns: [&str; N],
    ) -> impl Iterator<Item = [&str; N]> {
        let places = columns.map(|column| self.columns().position(|name| name == column));
        (0..self.len())
            .map(move |row| places.map(|place| place.map_or("", |place| self.text_at(row, place))))
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
        let header = StringRecord::from_iter(self.columns());
        let rows = (0..self.len()).map(|row| StringRecord::from_iter(self.row(row)));
        rows.map(|row| row.deserialize(Some(&header))).collect()
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

    /// What a cell holds is what is read, and a line is the one that a writer of CSV makes.
    #[test]
    fn any_words_survive_a_line() {
        let words = [
            "",
            "a",
            "a,b",
            "\"",
            "a\"b",
            "two\nlines",
            "\r",
            "ä → b",
            "a b",
        ];
        for one in words {
            for other in words {
                let cells = [one.to_owned(), other.to_owned(), "end".to_owned()];
                for cells in [&cells[..], &cells[..1], &cells[1..]] {
                    let mut writer = csv::Writer::from_writer(Vec::new());
                    writer.write_record(cells).unwrap();
                    let text = line_of(cells);
                    assert_eq!(text.as_bytes(), writer.into_inner().unwrap());
                    let mut reader = csv::ReaderBuilder::new();
                    let mut reader = reader.has_headers(false).from_reader(text.as_bytes());
                    let read = reader.records().next().unwrap().unwrap();
                    assert!(read.iter().eq(cells.iter()));
                }
            }
        }
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

    /// Numbers are written as the library writes them, ties included, whichever of the two writes.
    #[test]
    fn numbers_are_those_of_the_library() {
        let exponents = (-40..40).flat_map(|n| [10_f64.powi(n), 2_f64.powi(3 * n)]);
        let factors = (0..200).map(|n| f64::from(n).sqrt() - 3.0);
        let products = exponents.flat_map(|size| factors.clone().map(move |x| x * size));
        // a quarter, a half and three quarters in the seventeenth digit, and what rounds up to the next power of ten
        let ties = (0..400).map(|n| 1_234_567_890_123_456.0 + 0.25 * f64::from(n));
        let nines = (-16..18).flat_map(|n| {
            let power = 10_f64.powi(n);
            [power.next_down(), power, power.next_up()]
        });
        let limits = [0.0, -0.0, 1.0, f64::MAX, f64::MIN_POSITIVE, 5e-324, 3e-310];
        for value in products.chain(ties).chain(nines).chain(limits) {
            assert_eq!(number(value), format!("{value:.16e}"));
        }
    }

    /// The short way through a table without quotes leads to what the library reads.
    #[test]
    fn tables_are_those_of_the_library() {
        let plain = "a, b ,c\n1,2,3\n\n4\n , 5 ,\n6,7,8,9\n";
        let table = Table::parse(plain.as_bytes()).unwrap();
        for other in [
            plain.replace('\n', "\r\n"),
            plain.replace('2', "\"2\""),
            format!("\u{feff}{plain}10,11"),
        ] {
            assert_eq!(Table::parse(other.as_bytes()).unwrap(), table);
        }
        assert_eq!(table.columns().collect::<Vec<_>>(), ["a", "b", "c"]);
        assert_eq!(
            [0, 1, 2, 3].map(|row| table.text(row, "b")),
            ["2", "", "5", "7"]
        );
    }

    #[test]
    fn what_is_not_there_is_empty() {
        let table = Table::parse(b"\xef\xbb\xbflabel, a\n1, 2 3\n7\n").unwrap();
        assert_eq!(table.list(0, "a"), [2.0, 3.0]);
        assert_eq!(table.labelled("7"), Some(1));
        assert_eq!((table.text(1, "a"), table.text(5, "a")), ("", ""));
        let selected = table.select(["a", "b", "label"]);
        assert!(selected.eq([["2 3", "", "1"], ["", "", "7"]]));
        assert!(!table.has("b") && table.field::<usize>(0, "b").is_none());
        assert!(table.rows::<Place>().is_err());
    }
}
