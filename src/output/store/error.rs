//! What can be wrong with a folder, and what helps.

use std::io;
use std::path::{Path, PathBuf};

/// What is wrong with a folder or a file in it.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The operating system refused.
    #[error("{}: cannot {doing}: {error}{}", path.display(), cure(doing, error.kind()))]
    Io {
        /// What was being done.
        doing: &'static str,
        /// File or folder.
        path: PathBuf,
        /// What the system said.
        error: io::Error,
    },
    /// The folder or the file may not be used like this.
    #[error("{}: {reason}", path.display())]
    Refused {
        /// File or folder.
        path: PathBuf,
        /// Why, and what helps.
        reason: String,
    },
    /// A file of a result folder is missing, cut short or changed.
    #[error(
        "{}: damaged: {reason}; put back an undamaged copy, or compute it anew with --force",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl StoreError {
    /// Whether the user asked for the wrong thing; otherwise input or output failed.
    pub fn is_usage(&self) -> bool {
        match self {
            StoreError::Io { doing, error, .. } => *doing == READ && absent(error.kind()),
            StoreError::Refused { .. } => true,
            StoreError::Damaged { .. } => false,
        }
    }
}

/// What is being done to a file that is read; what is missing then was wrongly named by the user.
pub(crate) const READ: &str = "read it";

/// Whether what was named is not there.
pub(crate) fn absent(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::NotFound | io::ErrorKind::NotADirectory)
}

fn cure(doing: &str, kind: io::ErrorKind) -> &'static str {
    use io::ErrorKind::{
        FileTooLarge, NotADirectory, PermissionDenied, QuotaExceeded, ReadOnlyFilesystem,
        StorageFull,
    };
    match kind {
        StorageFull | QuotaExceeded | FileTooLarge => {
            "; make room, then go on with --resume, or take another place with --out"
        }
        PermissionDenied if doing == READ => "; it takes the permission to read",
        PermissionDenied | ReadOnlyFilesystem => "; take a place that can be written with --out",
        NotADirectory if doing != READ => "; a part of the path is no folder",
        _ => "",
    }
}

/// An error of the operating system, with what was being done.
pub(crate) fn io_error<'a>(
    doing: &'static str,
    path: &'a Path,
) -> impl FnOnce(io::Error) -> StoreError + 'a {
    move |error| StoreError::Io {
        doing,
        path: path.to_path_buf(),
        error,
    }
}

/// What may not be used like this.
pub(crate) fn refused(path: &Path, reason: impl Into<String>) -> StoreError {
    StoreError::Refused {
        path: path.to_path_buf(),
        reason: reason.into(),
    }
}

/// A damaged file.
pub(crate) fn damaged(path: &Path, reason: impl Into<String>) -> StoreError {
    StoreError::Damaged {
        path: path.to_path_buf(),
        reason: reason.into(),
    }
}
