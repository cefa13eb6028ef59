//! Arrays in NumPy's format, version 1.0: a header of text, then the numbers in rows.

use std::fmt::Write;

/// Bytes of every header written here, so that the number of rows can be changed in place.
pub(crate) const HEADER: usize = 128;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NpyType {
    /// 64-bit floating point, little-endian.
    Double,
    Byte,
}

/// The header of an array of `rows` × `columns`.
pub(crate) fn header(kind: NpyType, rows: usize, columns: usize) -> [u8; HEADER] {
    let descriptor = match kind {
        NpyType::Double => "<f8",
        NpyType::Byte => "|u1",
    };
    let mut text = String::with_capacity(HEADER);
    // writing to a string does not fail
    let _ = write!(
        text,
        "{{'descr': '{descriptor}', 'fortran_order': False, 'shape': ({rows}, {columns}), }}"
    );
    let mut bytes = [b' '; HEADER];
    bytes[..8].copy_from_slice(b"\x93NUMPY\x01\x00");
    bytes[8..10].copy_from_slice(&((HEADER - 10) as u16).to_le_bytes());
    let end = 10 + text.len().min(HEADER - 11);
    bytes[10..end].copy_from_slice(&text.as_bytes()[..end - 10]);
    bytes[HEADER - 1] = b'\n';
    bytes
}

/// An array of doubles, given by columns.
pub(crate) fn doubles(columns: &[&[f64]]) -> Vec<u8> {
    let rows = columns.iter().map(|column| column.len()).min().unwrap_or(0);
    let mut bytes = Vec::with_capacity(HEADER + 8 * rows * columns.len());
    bytes.extend_from_slice(&header(NpyType::Double, rows, columns.len()));
    for row in 0..rows {
        for column in columns {
            bytes.extend_from_slice(&column[row].to_le_bytes());
        }
    }
    bytes
}

/// A column of an array of doubles with this many columns; what a kill has cut off is missing.
pub(crate) fn column(bytes: &[u8], columns: usize, index: usize) -> Vec<f64> {
    let rows = bytes
        .get(HEADER..)
        .unwrap_or_default()
        .chunks_exact(8 * columns);
    let value = |row: &[u8]| {
        let bytes = row[8 * index..].first_chunk::<8>();
        bytes.map_or(f64::NAN, |bytes| f64::from_le_bytes(*bytes))
    };
    rows.map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The layout of the format: magic, version, length, a dictionary, and a line end before data
    /// that begin at a multiple of 64.
    #[test]
    fn header_is_as_the_format_says() {
        let bytes = doubles(&[&[1.0, 2.0], &[3.0, 4.0]]);
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        assert_eq!(
            u16::from_le_bytes([bytes[8], bytes[9]]) as usize + 10,
            HEADER
        );
        assert_eq!(HEADER % 64, 0);
        assert_eq!(bytes[HEADER - 1], b'\n');
        let text = std::str::from_utf8(&bytes[10..HEADER]).unwrap();
        assert!(text.contains("'descr': '<f8'") && text.contains("'shape': (2, 2)"));
        let number =
            |at: usize| f64::from_le_bytes(bytes[HEADER + 8 * at..][..8].try_into().unwrap());
        assert_eq!(
            [number(0), number(1), number(2), number(3)],
            [1.0, 3.0, 2.0, 4.0]
        );
        assert_eq!(column(&bytes, 2, 1), [3.0, 4.0]);
    }
}
