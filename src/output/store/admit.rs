//! Whether a folder may be used as asked for.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::{READ, StoreError, io_error, refused};
use super::file::found;
use super::manifest::{Header, Kind, Manifest};
use super::place::stranger;

/// What is to be done with results that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Existing {
    /// Leave them alone.
    Refuse,
    /// Go on with them.
    Resume,
    /// Replace them.
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
    kind: Kind,
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
        return Err(refused(
            path,
            "holds results already; --force replaces them, --resume goes on, --out DIR takes \
             another folder",
        ));
    }
    let Some(earlier) = manifest.header.as_ref().filter(|_| left) else {
        return Ok(left);
    };
    if !kind.fits(&earlier.kind) {
        return Err(refused(
            path,
            format!(
                "holds results of another kind ({}, not {}); take another folder with --out",
                earlier.kind, header.kind
            ),
        ));
    }
    if existing == Existing::Resume {
        if earlier.version != header.version {
            return Err(refused(
                path,
                format!(
                    "written by version {}, this is {}; go on with that version, or --force starts \
                     anew",
                    earlier.version, header.version
                ),
            ));
        }
        if earlier.problem != header.problem {
            return Err(refused(
                path,
                "written for another problem; --force starts anew, --out DIR takes another folder",
            ));
        }
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
            return Err(refused(
                path,
                format!(
                    "the results would replace {}, from which they are computed; take another \
                     folder with --out",
                    input.display()
                ),
            ));
        }
    }
    Ok(left)
}
