//! Whether a folder may be used as asked for.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::{READ, StoreError, io_error, refused};
use super::file::found;
use super::manifest::{FolderKind, Header, Manifest};
use super::place::stranger;

/// What is to be done with results that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Existing {
    Refuse,
    Resume,
    Replace,
}

impl Existing {
    /// As `--resume` and `--force` say.
    pub(crate) fn of(resume: bool, force: bool) -> Existing {
        match (resume, force) {
            (true, _) => Existing::Resume,
            (_, true) => Existing::Replace,
            _ => Existing::Refuse,
        }
    }
}

/// Whether a folder may be used as asked for; returns whether it holds results.
pub(super) fn admit(
    path: &Path,
    kind: FolderKind,
    header: &Header,
    manifest: &Manifest,
    existing: Existing,
    inputs: &[PathBuf],
) -> Result<bool, StoreError> {
    let mut left = false;
    for name in &manifest.names {
        left |= found(&path.join(name))?.is_some();
    }
    if existing == Existing::Refuse && (left || stranger(path)?.is_some()) {
        return Err(StoreError::Occupied(path.to_path_buf()));
    }
    let Some(earlier) = manifest.header.as_ref().filter(|_| left) else {
        return Ok(left);
    };
    let (version, kept) = (&earlier.version, &earlier.kind);
    let resumes = existing == Existing::Resume;
    if !kind.fits(kept) {
        let reason = format!(
            "holds results of another kind ({kept}, not {}); take another folder with --out",
            header.kind
        );
        return Err(refused(path, reason));
    }
    if resumes && *version != header.version {
        let reason = format!(
            "written by version {version}, this is {}; go on with that version, or --force starts anew",
            header.version
        );
        return Err(refused(path, reason));
    }
    if resumes && earlier.problem != header.problem {
        let reason =
            "written for another problem; --force starts anew, --out DIR takes another folder";
        return Err(refused(path, reason));
    }
    let canonical = fs::canonicalize(path).map_err(io_error(READ, path))?;
    for input in inputs {
        // an input that is missing is told by who reads it
        let Ok(input) = fs::canonicalize(input) else {
            continue;
        };
        let Ok(inside) = input.strip_prefix(&canonical) else {
            continue;
        };
        let name = inside.to_string_lossy();
        if name.is_empty() || manifest.names.contains(name.as_ref()) {
            let reason = format!(
                "the results would replace {}, from which they are computed; take another folder with \
                 --out",
                input.display()
            );
            return Err(refused(path, reason));
        }
    }
    Ok(left)
}
