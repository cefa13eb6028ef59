//! The list of what the program wrote in a folder.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use super::error::{READ, StoreError, io_error, refused};
use super::file::found;

pub(crate) const MANIFEST: &str = "brakewave.manifest";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FolderKind {
    Run,
    Map,
    /// Some rows of a map.
    MapShard,
    /// What motions settle on.
    Scan,
    /// Some pieces of a scan.
    ScanShard,
    /// A curve of an event.
    Curve,
    /// Errors and times of methods.
    Accuracy,
    Simulation,
    /// What is proven of a branch.
    Certificate,
    Steady,
}

impl FolderKind {
    /// All of them, with their words in a manifest.
    const NAMES: [(FolderKind, &str); 10] = [
        (FolderKind::Run, "run"),
        (FolderKind::Map, "map"),
        (FolderKind::MapShard, "map-shard"),
        (FolderKind::Scan, "scan"),
        (FolderKind::ScanShard, "scan-shard"),
        (FolderKind::Curve, "curve"),
        (FolderKind::Accuracy, "accuracy"),
        (FolderKind::Simulation, "simulation"),
        (FolderKind::Certificate, "certificate"),
        (FolderKind::Steady, "steady"),
    ];

    /// The kind of a word in a manifest.
    pub(super) fn of(name: &str) -> Option<FolderKind> {
        let known = FolderKind::NAMES.iter().find(|known| known.1 == name);
        known.map(|known| known.0)
    }

    /// Its word in a manifest.
    pub(crate) fn name(self) -> &'static str {
        let known = FolderKind::NAMES.iter().find(|known| known.0 == self);
        known.map_or("", |known| known.1)
    }

    /// Whether results of the other kind may be gone on with or replaced: a shard is a map.
    pub(super) fn fits(self, other: &str) -> bool {
        let family = |name: &str| name.split('-').next().map(str::to_owned);
        family(self.name()) == family(other)
    }
}

/// The first lines of a manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub version: String,
    pub kind: String,
    pub problem: String,
}

impl Header {
    pub(crate) fn text(&self) -> String {
        format!(
            "brakewave {}\n{} of problem {}\n",
            self.version, self.kind, self.problem
        )
    }

    fn parse(lines: &mut std::str::Lines) -> Option<Header> {
        let version = lines.next()?.strip_prefix("brakewave ")?;
        let (kind, problem) = lines.next()?.split_once(" of problem ")?;
        Some(Header {
            version: version.to_owned(),
            kind: kind.to_owned(),
            problem: problem.to_owned(),
        })
    }
}

/// A manifest, open for more names.
#[derive(Debug)]
pub(super) struct Manifest {
    pub file: File,
    pub header: Option<Header>,
    pub names: BTreeSet<String>,
    /// What this process has made and not used yet, outermost first: taken away again in the end.
    pub made: Vec<PathBuf>,
}

impl Manifest {
    /// Whether there is one; anything else of its name is in the way.
    pub(super) fn exists(path: &Path) -> Result<bool, StoreError> {
        match found(path)? {
            Some(there) if !there.is_file() => Err(refused(path, "in the way: it is no file")),
            there => Ok(there.is_some()),
        }
    }

    /// Reads a manifest; a line cut short by a power failure names no file yet and is left out.
    pub(crate) fn read(path: &Path, mut file: File, mend: bool) -> Result<Manifest, StoreError> {
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(io_error(READ, path))?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n');
        let whole = whole.map_or(0, |last| last + 1);
        if mend && whole < bytes.len() {
            file.set_len(whole as u64)
                .map_err(io_error("mend it", path))?;
        }
        let foreign = || StoreError::Foreign(path.to_path_buf());
        let text = std::str::from_utf8(&bytes[..whole]).map_err(|_| foreign())?;
        let mut lines = text.lines();
        let header = Header::parse(&mut lines);
        // cut short by a power failure, or something else altogether
        let torn = text.is_empty() || text.starts_with("brakewave ") && text.lines().count() == 1;
        if header.is_none() && !torn {
            return Err(foreign());
        }
        let names: BTreeSet<String> = lines.map(str::to_owned).collect();
        let inside = |name: &String| {
            let parts = Path::new(name).components();
            let normal = |part| matches!(part, Component::Normal(_));
            // a file of the folder, or of a folder in it
            matches!(parts.clone().count(), 1 | 2) && parts.into_iter().all(normal)
        };
        if !names.iter().all(inside) {
            return Err(foreign());
        }
        Ok(Manifest {
            file,
            header,
            names,
            made: Vec::new(),
        })
    }
}
