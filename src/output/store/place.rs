//! The place of a folder: found, made, and taken away again.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::error::{READ, StoreError, io_error, refused};
use super::file::found;
use super::manifest::MANIFEST;

/// A folder by its name, and whether it is there; a link to one is refused.
pub(crate) fn real(path: &Path) -> Result<(PathBuf, bool), StoreError> {
    // without the separator at its end, which would follow a link
    let path: PathBuf = path.components().collect();
    let there = found(&path)?;
    let wrong = there.as_ref().and_then(|there| match there {
        link if link.is_symlink() => Some("a symbolic link; name the folder that it points to"),
        other if !other.is_dir() => Some("a file, where a folder is to be; name another"),
        _ => None,
    });
    if let Some(reason) = wrong {
        return Err(refused(&path, reason));
    }
    let there = there.is_some();
    Ok((path, there))
}

/// Makes a folder and those above it.
pub(crate) fn make(path: &Path, made: &mut Vec<PathBuf>) -> Result<(), StoreError> {
    if let Some(above) = path.parent()
        && !above.as_os_str().is_empty()
        && !above.exists()
    {
        make(above, made)?;
    }
    match fs::create_dir(path) {
        Ok(()) => made.push(path.to_path_buf()),
        // somebody else was quicker
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists && path.is_dir() => {}
        Err(error) => {
            unmake(made);
            return Err(io_error("create the folder", path)(error));
        }
    }
    Ok(())
}

/// Takes away again what was made and not used.
pub(crate) fn unmake(made: &[PathBuf]) {
    for path in made.iter().rev() {
        // a folder stays where it is not empty
        let _ = fs::remove_file(path).or_else(|_| fs::remove_dir(path));
    }
}

/// An entry of a folder that is neither its manifest nor a result folder of its own.
pub(crate) fn stranger(folder: &Path) -> Result<Option<String>, StoreError> {
    for entry in fs::read_dir(folder).map_err(io_error(READ, folder))? {
        let entry = entry.map_err(io_error(READ, folder))?;
        let own = entry.file_name() == MANIFEST;
        let path = entry.path();
        let results = found(&path)?.is_some_and(|there| there.is_dir())
            && found(&path.join(MANIFEST))?.is_some();
        if !own && !results {
            return Ok(Some(entry.file_name().to_string_lossy().into_owned()));
        }
    }
    Ok(None)
}
