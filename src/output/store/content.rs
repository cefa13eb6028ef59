//! The files of a result folder: tables that grow, files that are replaced whole, and the state to go on from.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use serde::Serialize;

use super::Store;
use super::error::io_error;
use super::file::{GrowingFile, bytes, encode, length_of_lines, replace, swap};
use super::{Checkpoint, StoreError, damaged};

impl Store {
    /// A new file that begins with `bytes`, open for more.
    ///
    /// # Errors
    /// When something else has its name, or the system refuses.
    pub(crate) fn create(&self, name: &str, head: &[u8]) -> Result<GrowingFile, StoreError> {
        GrowingFile::create(self.place(name)?, head)
    }

    /// A file of an earlier run, cut back to `length` bytes and open for more.
    ///
    /// # Errors
    /// When it is shorter, no file of the list, or the system refuses.
    pub(crate) fn cut(&self, name: &str, length: usize) -> Result<GrowingFile, StoreError> {
        GrowingFile::cut(self.unlinked(name)?, length)
    }

    /// The first lines of a file of an earlier run, or all that are finished.
    ///
    /// # Errors
    /// When it cannot be read, or has fewer.
    pub(crate) fn lines(&self, name: &str, lines: Option<usize>) -> Result<Vec<u8>, StoreError> {
        let path = self.path.join(name);
        let mut text = bytes(&path).map_err(|_| damaged(&path, "it cannot be read"))?;
        let length = length_of_lines(&text, lines);
        let length = length.ok_or_else(|| damaged(&path, "it has fewer rows than were saved"))?;
        text.truncate(length);
        Ok(text)
    }

    /// A table: new with its header, or cut back to the header and the rows kept.
    ///
    /// # Errors
    /// When there are fewer rows, or the system refuses.
    pub(crate) fn table(
        &self,
        name: &str,
        header: &str,
        kept: Option<usize>,
    ) -> Result<GrowingFile, StoreError> {
        match kept {
            None => self.create(name, header.as_bytes()),
            Some(rows) => self.cut(name, self.lines(name, Some(rows + 1))?.len()),
        }
    }

    /// The checkpoint of an interrupted run. There is none where nothing has been saved that would be
    /// missed: `table` has not more than these lines then.
    ///
    /// # Errors
    /// When it is damaged, or missing.
    pub(crate) fn interrupted<C: Checkpoint>(
        &self,
        problem: &C::Problem,
        table: &str,
        lines: usize,
    ) -> Result<Option<C>, StoreError> {
        if !self.resumes {
            return Ok(None);
        }
        let saved: Option<C> = self.saved(table, lines)?;
        if saved
            .as_ref()
            .is_some_and(|saved| saved.problem() != problem)
        {
            let path = self.path.join(C::FILE);
            return Err(damaged(&path, "it holds another problem than the manifest"));
        }
        Ok(saved)
    }

    /// The checkpoint of a folder, as [`Store::interrupted`].
    ///
    /// # Errors
    /// When it is damaged, or missing.
    pub(crate) fn saved<C: Checkpoint>(
        &self,
        table: &str,
        lines: usize,
    ) -> Result<Option<C>, StoreError> {
        let path = self.path.join(C::FILE);
        if path.exists() {
            return C::read(&self.path).map(Some);
        }
        let rows = bytes(&self.path.join(table)).unwrap_or_default();
        match length_of_lines(&rows, Some(lines + 1)) {
            Some(_) => Err(damaged(&path, "it is missing")),
            None => Ok(None),
        }
    }

    /// Replaces a file as a whole, never seen half written.
    ///
    /// # Errors
    /// When something else has its name, or the system refuses.
    pub(crate) fn replace(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        self.write(name, |path, out| {
            out.write_all(bytes).map_err(io_error("write it", path))
        })
    }

    /// The same for what can be made again from other files, a picture: it is left to the system when it comes to the
    /// disk. A kill leaves the old one or the new one; only a power failure can lose both.
    ///
    /// # Errors
    /// As [`Store::replace`].
    pub(crate) fn replace_derived(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.place(name)?;
        let write =
            |out: &mut BufWriter<File>| out.write_all(bytes).map_err(io_error("write it", &path));
        swap(&path, write, |_| Ok(()))
    }

    /// The same as [`Store::replace`] for what is written piece by piece.
    ///
    /// # Errors
    /// As [`Store::replace`].
    pub(crate) fn write(
        &self,
        name: &str,
        write: impl FnOnce(&Path, &mut BufWriter<File>) -> Result<(), StoreError>,
    ) -> Result<(), StoreError> {
        let path = self.place(name)?;
        replace(&path, |out| write(&path, out))
    }

    /// Replaces a file by a value as RON.
    ///
    /// # Errors
    /// As [`Store::replace`].
    pub(crate) fn save(&self, name: &str, value: &impl Serialize) -> Result<(), StoreError> {
        let text = encode(&self.path.join(name), value)?;
        self.replace(name, text.as_bytes())
    }
}
