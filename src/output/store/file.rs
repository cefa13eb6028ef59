//! Single files: read, replaced as a whole, or growing at their end.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::{READ, StoreError, damaged, io_error};
use crate::table::{self, Table};

/// This version, as manifests and checkpoints carry it.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The content of a file.
///
/// # Errors
/// When it is missing, no file, or cannot be read.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>, StoreError> {
    let found = fs::metadata(path).map_err(io_error(READ, path))?;
    // a device or a pipe may never end
    if !found.is_file() {
        return Err(damaged(path, "it is no file"));
    }
    fs::read(path).map_err(io_error(READ, path))
}

/// The text of a file.
///
/// # Errors
/// As [`bytes`], and when it is no text.
pub(crate) fn read(path: &Path) -> Result<String, StoreError> {
    String::from_utf8(bytes(path)?).map_err(|_| damaged(path, "it is no text"))
}

/// A table.
///
/// # Errors
/// As [`bytes`], and when it is no table.
pub(crate) fn table(path: &Path) -> Result<Table, StoreError> {
    Table::parse(&bytes(path)?).map_err(|error| damaged(path, error.to_string()))
}

/// A value as RON. Behind a vtable, for the writer of RON is a thousand lines for every type of a field.
pub(crate) fn encode(
    path: &Path,
    value: &dyn erased_serde::Serialize,
) -> Result<String, StoreError> {
    ron::to_string(value).map_err(|error| damaged(path, error.to_string()))
}

/// A value that was written as RON.
///
/// # Errors
/// As [`read`], and when it is no such value.
pub(crate) fn decode<T: DeserializeOwned>(path: &Path) -> Result<T, StoreError> {
    ron::from_str(&read(path)?).map_err(|error| {
        let reason = format!("it is not as version {VERSION} writes it: {error}");
        damaged(path, reason)
    })
}

/// The number that a file is named by, whatever its extension.
pub(super) fn number(file: &Path) -> Option<usize> {
    let name = file.file_name()?.to_str()?;
    name.split('.').next()?.parse().ok()
}

/// The files of a folder that have a number for a name, with this extension; none without the folder.
///
/// # Errors
/// When the folder cannot be read.
pub(crate) fn numbered(
    folder: &Path,
    extension: &str,
) -> Result<BTreeMap<usize, PathBuf>, StoreError> {
    let mut files = BTreeMap::new();
    if found(folder)?.is_none() {
        return Ok(files);
    }
    for entry in fs::read_dir(folder).map_err(io_error(READ, folder))? {
        let path = entry.map_err(io_error(READ, folder))?.path();
        let stem = path.to_str().and_then(|path| path.strip_suffix(extension));
        if let Some(number) = stem.and_then(|_| path.file_stem()?.to_str()?.parse().ok()) {
            files.insert(number, path);
        }
    }
    Ok(files)
}

/// FNV-1a in 64 bits: tells one content from another where nobody forges any.
pub(crate) fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// What lies at a path, links not followed.
pub(crate) fn found(path: &Path) -> Result<Option<Metadata>, StoreError> {
    match fs::symlink_metadata(path) {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(io_error("look at it", path)(error)),
    }
}

/// Removes a file or a link, never what a link points to; what is not there need not be removed.
pub(crate) fn remove(path: &Path) -> Result<(), StoreError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(io_error("remove it", path)(error))
        }
        _ => Ok(()),
    }
}

/// A new file, no link.
pub(crate) fn new_file(path: &Path) -> Result<File, StoreError> {
    remove(path)?;
    let file = OpenOptions::new().write(true).create_new(true).open(path);
    file.map_err(io_error("create it", path))
}

/// What the name of a file begins with that is being written, before it takes its place.
const NEW: &str = ".brakewave-";

/// A new file beside others, under a name that nobody else has given: a number that is used once, and
/// its checksum.
pub(super) fn new_beside(path: &Path) -> Result<(PathBuf, File), StoreError> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let (time, count) = (
            now.unwrap_or_default(),
            COUNT.fetch_add(1, Ordering::Relaxed),
        );
        let once = hash(format!("{} {time:?} {count}", process::id()).as_bytes());
        let new = path.with_file_name(format!("{NEW}{once:016x}-{:016x}", checksum(once)));
        match OpenOptions::new().write(true).create_new(true).open(&new) {
            Ok(file) => return Ok((new, file)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(io_error("create it", path)(error)),
        }
    }
}

fn checksum(once: u64) -> u64 {
    hash(&once.to_le_bytes())
}

/// Whether a file was being written by this program when it was killed.
pub(super) fn is_left_over(name: &str) -> bool {
    let number = |text: &str| u64::from_str_radix(text, 16).ok();
    let parts = name.strip_prefix(NEW).and_then(|rest| rest.split_once('-'));
    let parts = parts.and_then(|(once, sum)| number(once).zip(number(sum)));
    parts.is_some_and(|(once, sum)| checksum(once) == sum)
}

/// Whether an open file is still the one at its path; where the system does not tell, whether one is.
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    let own = file.metadata().ok();
    let both = own.zip(fs::symlink_metadata(path).ok());
    #[cfg(unix)]
    let same = |own: Metadata, there: Metadata| {
        use std::os::unix::fs::MetadataExt;
        (own.dev(), own.ino()) == (there.dev(), there.ino())
    };
    #[cfg(not(unix))]
    let same = |_: Metadata, there: Metadata| there.is_file();
    both.is_some_and(|(own, there)| same(own, there))
}

/// Whether a file has another name too: what is written to it changes both.
pub(super) fn is_shared(found: &Metadata) -> bool {
    #[cfg(unix)]
    return std::os::unix::fs::MetadataExt::nlink(found) > 1;
    #[cfg(not(unix))]
    return false;
}

/// Puts a copy in the place of a file that has another name too; whether it had.
pub(super) fn unshare(path: &Path) -> Result<bool, StoreError> {
    let shared = found(path)?.is_some_and(|there| is_shared(&there));
    if shared {
        let text = bytes(path)?;
        replace(path, |out| {
            out.write_all(&text).map_err(io_error("write it", path))
        })?;
    }
    Ok(shared)
}

/// Replaces a file as a whole: written beside, brought to the disk, renamed.
///
/// # Errors
/// When the system refuses; the old file stays then.
pub(crate) fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    swap(path, write, |file| {
        file.sync_all().map_err(io_error("write it", path))
    })?;
    // the renaming itself; not every file system can, and none loses the old file
    if let Some(Ok(folder)) = path.parent().map(File::open) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// Replaces a file as a whole: written beside, renamed. What becomes of it in between is up to `settle`.
///
/// # Errors
/// When the system refuses; the old file stays then.
pub(super) fn swap(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), StoreError>,
    settle: impl FnOnce(&File) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let (new, file) = new_beside(path)?;
    let done = (|| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        let file = out
            .into_inner()
            .map_err(|error| io_error("write it", path)(error.into_error()))?;
        settle(&file)?;
        fs::rename(&new, path).map_err(io_error("replace it", path))
    })();
    if done.is_err() {
        // what is left of it would only take up room
        let _ = fs::remove_file(&new);
    }
    done
}

/// Bytes that the first lines of a text take, or all lines that are finished: what follows them was cut
/// short by a kill. None where there are fewer lines.
pub(crate) fn length_of_lines(text: &[u8], lines: Option<usize>) -> Option<usize> {
    let ends = text.iter().enumerate();
    let mut ends = ends.filter_map(|(index, byte)| (*byte == b'\n').then_some(index + 1));
    match lines {
        None => Some(ends.next_back().unwrap_or(0)),
        Some(0) => Some(0),
        Some(lines) => ends.nth(lines - 1),
    }
}

/// A file that grows at its end.
#[derive(Debug)]
pub(crate) struct GrowingFile {
    file: File,
    path: PathBuf,
}

impl GrowingFile {
    /// A new file with this beginning.
    pub(super) fn create(path: PathBuf, head: &[u8]) -> Result<GrowingFile, StoreError> {
        let file = new_file(&path)?;
        let mut growing = GrowingFile { file, path };
        growing.push(head)?;
        Ok(growing)
    }

    /// A file that is there, cut back to `length` bytes; a copy of it where it has another name too.
    pub(super) fn cut(path: PathBuf, length: usize) -> Result<GrowingFile, StoreError> {
        if !found(&path)?.is_some_and(|there| there.is_file()) {
            return Err(damaged(&path, "it is no longer there"));
        }
        unshare(&path)?;
        let mut file = OpenOptions::new()
            .write(true)
            .open(&path)
            .map_err(io_error("open it for writing", &path))?;
        let there = file.metadata().map_err(io_error(READ, &path))?.len();
        if there < length as u64 {
            return Err(damaged(&path, "it is shorter than it was saved"));
        }
        file.set_len(length as u64)
            .and_then(|()| file.seek(SeekFrom::End(0)))
            .map_err(io_error("cut it", &path))?;
        Ok(GrowingFile { file, path })
    }

    /// Adds bytes.
    ///
    /// # Errors
    /// When the system refuses, like all that follow.
    pub(crate) fn push(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        let written = self.file.write_all(bytes);
        written.map_err(io_error("write it", &self.path))
    }

    pub(crate) fn row(&mut self, row: &impl Serialize) -> Result<(), StoreError> {
        self.push(table::line(row).as_bytes())
    }

    /// Writes the beginning anew, as long as it was.
    pub(crate) fn rewrite_head(&mut self, head: &[u8]) -> Result<(), StoreError> {
        let file = &mut self.file;
        file.seek(SeekFrom::Start(0))
            .and_then(|_| file.write_all(head))
            .and_then(|()| file.seek(SeekFrom::End(0)))
            .map_err(io_error("write it", &self.path))?;
        Ok(())
    }

    /// Brings it to the disk.
    pub(crate) fn sync(&self) -> Result<(), StoreError> {
        self.file
            .sync_all()
            .map_err(io_error("write it", &self.path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a kill leaves half written is known by its name, which no user gives by accident.
    #[test]
    fn what_is_left_over_is_known_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("branch.ron");
        let names: Vec<String> = (0..3)
            .map(|_| {
                let (new, _) = new_beside(&path).unwrap();
                new.file_name().unwrap().to_str().unwrap().to_owned()
            })
            .collect();
        assert!(names[0] != names[1] && names[1] != names[2]);
        assert!(names.iter().all(|name| is_left_over(name)));
        let changed = names[0].replace(NEW, ".brakewave-1");
        for name in [&changed, "branch.ron.new", ".brakewave-", ".brakewave-1-2"] {
            assert!(!is_left_over(name), "{name}");
        }
    }
}
