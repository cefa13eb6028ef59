//! A table as Parquet: the same columns and numbers as its CSV, with types.

use std::io::Write;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use ::parquet::basic::{ConvertedType, Repetition, Type as Physical};
use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::Type;

/// Rows of a row group: the rows that are held in memory at a time.
const GROUP: usize = 1 << 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ColumnType {
    /// 64-bit integer.
    Integer,
    Number,
    /// UTF-8.
    Text,
}

/// A table could not be converted.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConvertError {
    /// The table is no CSV.
    #[error("{0}")]
    Csv(#[from] csv::Error),
    #[error("{0}")]
    Parquet(#[from] ParquetError),
    /// A field is not of the type of its column.
    #[error("line {line}: `{field}` in column `{column}` is not of its type")]
    Field {
        line: usize,
        field: String,
        column: String,
    },
}

/// Converts a table with a header. `kind` gives the type of a column by its name; empty fields
/// become null.
///
/// # Errors
/// When the table cannot be read, a field does not fit its type, or `out` cannot be written.
pub(crate) fn convert(
    table: &Path,
    out: &mut (impl Write + Send),
    kind: impl Fn(&str) -> ColumnType,
) -> Result<(), ConvertError> {
    let mut reader = csv::Reader::from_path(table)?;
    let names: Vec<String> = reader.headers()?.iter().map(str::to_owned).collect();
    let kinds: Vec<ColumnType> = names.iter().map(|name| kind(name)).collect();
    let schema = schema(&names, &kinds)?;
    let created_by = format!("brakewave {}", env!("CARGO_PKG_VERSION"));
    let properties = WriterProperties::builder()
        .set_created_by(created_by)
        .build();
    let mut writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
    let mut records = reader.records();
    let mut line = 1;
    loop {
        let group: Vec<csv::StringRecord> =
            records.by_ref().take(GROUP).collect::<Result<_, _>>()?;
        if group.is_empty() {
            break;
        }
        let mut rows = writer.next_row_group()?;
        let mut index = 0;
        while let Some(mut column) = rows.next_column()? {
            let fields: Vec<&str> = group
                .iter()
                .map(|record| record.get(index).unwrap_or(""))
                .collect();
            let levels = fields.iter().map(|field| i16::from(!field.is_empty()));
            let levels: Vec<i16> = levels.collect();
            let cells = ColumnCells {
                fields,
                line,
                column: &names[index],
            };
            match kinds[index] {
                ColumnType::Integer => column.typed::<Int64Type>().write_batch(
                    &cells.parsed()?,
                    Some(&levels),
                    None,
                )?,
                ColumnType::Number => column.typed::<DoubleType>().write_batch(
                    &cells.parsed()?,
                    Some(&levels),
                    None,
                )?,
                ColumnType::Text => {
                    let given = cells.fields.iter().filter(|field| !field.is_empty());
                    let values: Vec<ByteArray> = given.map(|field| (*field).into()).collect();
                    let text = column.typed::<ByteArrayType>();
                    text.write_batch(&values, Some(&levels), None)?
                }
            };
            column.close()?;
            index += 1;
        }
        rows.close()?;
        line += group.len();
    }
    writer.close()?;
    Ok(())
}

/// The columns with their types: every field may be empty.
fn schema(names: &[String], kinds: &[ColumnType]) -> Result<Type, ParquetError> {
    let fields = names.iter().zip(kinds).map(|(name, kind)| {
        let (physical, converted) = match kind {
            ColumnType::Integer => (Physical::INT64, ConvertedType::NONE),
            ColumnType::Number => (Physical::DOUBLE, ConvertedType::NONE),
            ColumnType::Text => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
        };
        let built = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_converted_type(converted)
            .build()?;
        Ok(Arc::new(built))
    });
    let fields = fields.collect::<Result<Vec<_>, ParquetError>>()?;
    Type::group_type_builder("table")
        .with_fields(fields)
        .build()
}

/// The cells of a column in a group of rows.
struct ColumnCells<'a> {
    fields: Vec<&'a str>,
    /// Line of the table before them.
    line: usize,
    column: &'a str,
}

impl ColumnCells<'_> {
    /// Those that are not empty, as values.
    fn parsed<T: FromStr>(&self) -> Result<Vec<T>, ConvertError> {
        let rows = self.fields.iter().zip(self.line + 1..);
        let given = rows.filter(|(field, _)| !field.is_empty());
        let parse = |(field, line): (&&str, usize)| {
            field.parse().map_err(|_| ConvertError::Field {
                line,
                field: (*field).to_owned(),
                column: self.column.to_owned(),
            })
        };
        given.map(parse).collect()
    }
}
