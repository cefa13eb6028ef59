//! What can be wrong with a folder, and what helps.

use std::io;
use std::path::{Path, PathBuf};

/// What is wrong with a folder or a file in it.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The operating system refused.
    #[error("{}: cannot {doing}: {error}", path.display())]
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
    /// The folder holds results, and nobody said what is to become of them.
    #[error("{}: holds results already", .0.display())]
    Occupied(PathBuf),
    /// Nothing is damaged, but the results were interrupted before there is anything to show.
    #[error("{}: not finished: {reason}; `brakewave {verb} PROBLEM.ron --out {0} --resume` goes on", path.display())]
    Unfinished {
        /// The folder.
        path: PathBuf,
        /// The verb that computes it.
        verb: &'static str,
        /// What is missing.
        reason: String,
    },
    /// A file of a result folder is missing, cut short or changed.
    #[error("{}: damaged: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
        /// Whether `--resume` makes it again from what else is there, or computes no more than it.
        resumable: bool,
    },
    /// The manifest is none, so that nobody knows which files are the program's.
    #[error("{}: damaged: it is no manifest of brakewave, which would list the files to replace", .0.display())]
    Foreign(PathBuf),
    /// Another folder has the name of the one that was being written.
    #[error(
        "{}: moved away or replaced while results were written there: nothing more is written; what \
         has been saved is where the folder is now, and can be gone on with there",
        .0.display()
    )]
    Moved(PathBuf),
}

/// Which options a verb has that help.
#[derive(Clone, Copy, Debug, Default)]
pub struct Offers {
    /// `--out`.
    pub out: bool,
    /// `--resume`.
    pub resume: bool,
}

impl StoreError {
    /// Whether the user asked for the wrong thing; otherwise input or output failed.
    pub fn is_usage(&self) -> bool {
        match self {
            StoreError::Io { doing, error, .. } => *doing == READ && absent(error.kind()),
            StoreError::Refused { .. }
            | StoreError::Occupied(_)
            | StoreError::Unfinished { .. } => true,
            StoreError::Damaged { .. } | StoreError::Foreign(_) | StoreError::Moved(_) => false,
        }
    }

    /// What helps, with the options of the verb; empty where the error itself says so.
    pub fn cure(&self, offers: Offers) -> &'static str {
        use io::ErrorKind::{
            FileTooLarge, NotADirectory, PermissionDenied, QuotaExceeded, ReadOnlyFilesystem,
            StorageFull,
        };
        match self {
            StoreError::Io { doing, error, .. } => match error.kind() {
                StorageFull | QuotaExceeded | FileTooLarge if offers.resume => {
                    "; make room, then go on with --resume, or take another place with --out"
                }
                StorageFull | QuotaExceeded | FileTooLarge if offers.out => {
                    "; make room, or take another place with --out"
                }
                StorageFull | QuotaExceeded | FileTooLarge => "; make room",
                PermissionDenied if *doing == READ => "; it takes the permission to read",
                PermissionDenied | ReadOnlyFilesystem if offers.out => {
                    "; take a place that can be written with --out"
                }
                PermissionDenied | ReadOnlyFilesystem => "; it takes the permission to write",
                NotADirectory if *doing != READ => "; a part of the path is no folder",
                _ => "",
            },
            StoreError::Occupied(_) if offers.resume => {
                "; --force replaces them, --resume goes on, --out DIR takes another folder"
            }
            StoreError::Occupied(_) => "; --force replaces them, --out DIR takes another folder",
            StoreError::Damaged { resumable, .. } => match resumable {
                true => "; --resume of the verb that wrote it makes it again",
                false => {
                    "; put back an undamaged copy, or compute it anew with --force of the verb that \
                     wrote it"
                }
            },
            StoreError::Foreign(_) if offers.out => {
                "; look what is in the folder and remove it by hand, or take another one with --out"
            }
            StoreError::Foreign(_) => {
                "; put back an undamaged copy, or compute the results anew into another folder"
            }
            StoreError::Refused { .. } | StoreError::Unfinished { .. } | StoreError::Moved(_) => "",
        }
    }
}

/// What is being done to a file that is read; what is missing then was wrongly named by the user.
pub(crate) const READ: &str = "read it";

/// Whether what was named is not there.
pub(crate) fn absent(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::NotFound | io::ErrorKind::NotADirectory)
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

pub(crate) fn damaged(path: &Path, reason: impl Into<String>) -> StoreError {
    StoreError::Damaged {
        path: path.to_path_buf(),
        reason: reason.into(),
        resumable: false,
    }
}

/// Results of a verb that has nothing to show yet.
pub(crate) fn unfinished(path: &Path, verb: &'static str, reason: impl Into<String>) -> StoreError {
    StoreError::Unfinished {
        path: path.to_path_buf(),
        verb,
        reason: reason.into(),
    }
}

/// A damaged file that `--resume` makes again.
pub(crate) fn resumable(path: &Path, reason: impl Into<String>) -> StoreError {
    StoreError::Damaged {
        path: path.to_path_buf(),
        reason: reason.into(),
        resumable: true,
    }
}
