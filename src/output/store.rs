//! Result folders: which files in them are the program's own, and who may write.
//!
//! Every folder carries a manifest, [`MANIFEST`]: version, kind of the results, hash of the problem,
//! and the name of every file the program wrote there, a line each. A name is appended before its
//! file is made, so that a kill leaves nothing unnamed. Only what is listed is ever replaced or
//! removed; anything else in the way is refused, and links are not followed. The manifest is also
//! the lock: it is held while results are written and falls with the process, however that ends.

use std::collections::BTreeSet;
use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;

use crate::table::Table;

/// Name of the manifest.
pub const MANIFEST: &str = "brakewave.manifest";

/// This version, as manifests and restart files carry it.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

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
pub const READ: &str = "read it";

fn absent(kind: io::ErrorKind) -> bool {
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
pub fn io_error<'a>(
    doing: &'static str,
    path: &'a Path,
) -> impl FnOnce(io::Error) -> StoreError + 'a {
    move |error| StoreError::Io {
        doing,
        path: path.to_path_buf(),
        error,
    }
}

fn refused<T>(path: &Path, reason: impl Into<String>) -> Result<T, StoreError> {
    Err(StoreError::Refused {
        path: path.to_path_buf(),
        reason: reason.into(),
    })
}

/// A damaged file.
pub fn damaged(path: &Path, reason: impl Into<String>) -> StoreError {
    StoreError::Damaged {
        path: path.to_path_buf(),
        reason: reason.into(),
    }
}

/// The content of a file.
///
/// # Errors
/// When it is missing, no file, or cannot be read.
pub fn bytes(path: &Path) -> Result<Vec<u8>, StoreError> {
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
pub fn read(path: &Path) -> Result<String, StoreError> {
    String::from_utf8(bytes(path)?).map_err(|_| damaged(path, "it is no text"))
}

/// A table.
///
/// # Errors
/// As [`bytes`], and when it is no table.
pub fn table(path: &Path) -> Result<Table, StoreError> {
    Table::parse(&bytes(path)?).map_err(|error| damaged(path, error.to_string()))
}

/// A value as RON.
pub fn encode(path: &Path, value: &impl Serialize) -> Result<String, StoreError> {
    ron::to_string(value).map_err(|error| damaged(path, error.to_string()))
}

/// FNV-1a in 64 bits: tells one content from another where nobody forges any.
pub fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// What lies at a path, links not followed.
fn found(path: &Path) -> Result<Option<Metadata>, StoreError> {
    match fs::symlink_metadata(path) {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(io_error("look at it", path)(error)),
    }
}

/// Removes a file or a link, never what a link points to; what is not there need not be removed.
fn remove(path: &Path) -> Result<(), StoreError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(io_error("remove it", path)(error))
        }
        _ => Ok(()),
    }
}

/// A new file, no link.
fn new_file(path: &Path) -> Result<File, StoreError> {
    remove(path)?;
    let file = OpenOptions::new().write(true).create_new(true).open(path);
    file.map_err(io_error("create it", path))
}

/// Where a file is written before it takes its place.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(NEW);
    name.into()
}

const NEW: &str = ".new";

/// Replaces a file as a whole: written beside, brought to the disk, renamed.
///
/// # Errors
/// When the system refuses; the old file stays then.
pub fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> Result<(), StoreError>,
) -> Result<(), StoreError> {
    let new = beside(path);
    let file = new_file(&new)?;
    let done = (|| {
        let mut out = BufWriter::new(file);
        write(&mut out)?;
        let file = out
            .into_inner()
            .map_err(|error| io_error("write it", path)(error.into_error()))?;
        file.sync_all().map_err(io_error("write it", path))?;
        fs::rename(&new, path).map_err(io_error("replace it", path))
    })();
    if done.is_err() {
        // what is left of it would only take up room
        let _ = fs::remove_file(&new);
    }
    done?;
    // the renaming itself; not every file system can, and none loses the old file
    if let Some(Ok(folder)) = path.parent().map(File::open) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// What a folder holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A branch.
    Run,
    /// A map.
    Map,
    /// Some rows of a map.
    MapShard,
    /// A curve of an event.
    Curve,
    /// Errors and times of methods.
    Accuracy,
    /// A simulation.
    Simulation,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Kind::Run => "run",
            Kind::Map => "map",
            Kind::MapShard => "map-shard",
            Kind::Curve => "curve",
            Kind::Accuracy => "accuracy",
            Kind::Simulation => "simulation",
        }
    }

    /// Whether results of the other kind may be gone on with or replaced: a shard is a map.
    fn fits(self, other: &str) -> bool {
        let family = |name: &str| name.split('-').next().map(str::to_owned);
        family(self.name()) == family(other)
    }
}

/// What is to be done with results that are there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Leave them alone.
    Refuse,
    /// Go on with them.
    Resume,
    /// Replace them.
    Replace,
}

impl Existing {
    /// As `--resume` and `--force` say.
    pub fn of(resume: bool, force: bool) -> Existing {
        match (resume, force) {
            (true, _) => Existing::Resume,
            (_, true) => Existing::Replace,
            _ => Existing::Refuse,
        }
    }
}

/// The first lines of a manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Header {
    version: String,
    kind: String,
    problem: String,
}

impl Header {
    fn text(&self) -> String {
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

#[derive(Debug)]
struct Manifest {
    file: File,
    header: Option<Header>,
    names: BTreeSet<String>,
}

impl Manifest {
    /// Reads a manifest; a line cut short by a power failure names no file yet and is left out.
    fn read(path: &Path, mut file: File, mend: bool) -> Result<Manifest, StoreError> {
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(io_error(READ, path))?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n');
        let whole = whole.map_or(0, |last| last + 1);
        if mend && whole < bytes.len() {
            file.set_len(whole as u64)
                .map_err(io_error("mend it", path))?;
        }
        let foreign = || damaged(path, "it is no manifest of brakewave");
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
        })
    }
}

/// A result folder.
#[derive(Debug)]
pub struct Store {
    path: PathBuf,
    manifest: Mutex<Manifest>,
    header: Header,
    /// Results are there that were not replaced yet.
    results: bool,
    resumes: bool,
    /// Made by this process, outermost first: taken away again when nothing is put there.
    made: Vec<PathBuf>,
    kept: AtomicBool,
}

impl Store {
    /// Takes hold of a folder. Nothing of earlier results changes before [`Store::begin`]; a folder
    /// that is made here is gone again if that is never called.
    ///
    /// `inputs` are the files and folders that the results are computed from.
    ///
    /// # Errors
    /// When the folder cannot be written, holds anything that is not to be touched, or is being
    /// written by another process.
    pub fn open(
        path: &Path,
        kind: Kind,
        problem: &impl Serialize,
        existing: Existing,
        inputs: &[PathBuf],
    ) -> Result<Store, StoreError> {
        let (path, there) = real(path)?;
        let mut made = Vec::new();
        if !there {
            make(&path, &mut made)?;
        }
        let header = Header {
            version: VERSION.to_owned(),
            kind: kind.name().to_owned(),
            problem: format!("{:016x}", hash(encode(&path, problem)?.as_bytes())),
        };
        let opened = Store::locked(&path).and_then(|(manifest, new)| {
            if new {
                made.push(path.join(MANIFEST));
            }
            admit(&path, kind, &header, &manifest, existing, inputs).map(|left| (manifest, left))
        });
        let (manifest, left) = match opened {
            Ok(opened) => opened,
            Err(error) => {
                unmake(&made);
                return Err(error);
            }
        };
        let store = Store {
            results: left,
            resumes: left && existing == Existing::Resume,
            kept: AtomicBool::new(left && existing == Existing::Resume),
            manifest: Mutex::new(manifest),
            path,
            header,
            made,
        };
        if !store.results {
            // a full disk is noticed here and not after the computation
            store.restart()?;
        }
        Ok(store)
    }

    /// The manifest of a folder, locked, and whether it was made now.
    fn locked(folder: &Path) -> Result<(Manifest, bool), StoreError> {
        let path = folder.join(MANIFEST);
        let new = match found(&path)? {
            Some(there) if there.is_file() => false,
            Some(_) => return refused(&path, "in the way: it is no file"),
            None => match stranger(folder)? {
                None => true,
                Some(name) => {
                    return refused(
                        folder,
                        format!(
                            "holds `{name}` but no `{MANIFEST}`: it is no result folder, or one of \
                             a version before manifests; take another with --out, or move its \
                             files away"
                        ),
                    );
                }
            },
        };
        let file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(&path)
            .map_err(io_error("open it for writing", &path))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return refused(
                    folder,
                    "another process is writing there; wait until it is done, or take another \
                     folder with --out",
                );
            }
            // a file system without locks does not keep anybody from computing
            Err(TryLockError::Error(_)) | Ok(()) => {}
        }
        if found(&path)?.is_none() {
            return refused(folder, "another process has just left it; try again");
        }
        Ok((Manifest::read(&path, file, true)?, new))
    }

    /// A folder with results, to add files to while somebody else may be writing there.
    ///
    /// # Errors
    /// When it has no manifest.
    pub fn visit(path: &Path) -> Result<Store, StoreError> {
        let (path, _) = real(path)?;
        let file = path.join(MANIFEST);
        if found(&file)?.is_some_and(|there| !there.is_file()) {
            return refused(&file, "in the way: it is no file");
        }
        let opened = OpenOptions::new().read(true).append(true).open(&file);
        let manifest = match opened {
            Err(error) if absent(error.kind()) => {
                return refused(
                    &path,
                    format!(
                        "has no `{MANIFEST}`: it is no result folder, or one of a version before \
                         manifests; compute it anew into another folder"
                    ),
                );
            }
            opened => opened.map_err(io_error("open it for writing", &file))?,
        };
        let manifest = Manifest::read(&file, manifest, false)?;
        let Some(header) = manifest.header.clone() else {
            return Err(damaged(&file, "it is no manifest of brakewave"));
        };
        Ok(Store {
            path,
            manifest: Mutex::new(manifest),
            header,
            results: true,
            resumes: false,
            made: Vec::new(),
            kept: AtomicBool::new(true),
        })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether there are results to go on with.
    pub fn resumes(&self) -> bool {
        self.resumes
    }

    /// Whether there are results of an earlier run.
    pub fn holds_results(&self) -> bool {
        self.results
    }

    fn manifest(&self) -> MutexGuard<'_, Manifest> {
        // a list of names is whole between any two statements
        self.manifest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins results anew with files of these names: what an earlier run left is removed, once it is
    /// known that nothing else is in the way. `numbered` is a folder for files `1.csv`, `2.csv`, ….
    ///
    /// # Errors
    /// When something else is in the way, or the system refuses.
    pub fn begin(
        &self,
        names: impl IntoIterator<Item = String>,
        numbered: Option<&str>,
    ) -> Result<(), StoreError> {
        let names: Vec<String> = names.into_iter().collect();
        if let Some(numbered) = numbered {
            self.guard(numbered)?;
        }
        for name in &names {
            self.free(&self.manifest(), name)?;
        }
        self.kept.store(true, Ordering::Relaxed);
        self.restart()?;
        self.claim(names)
    }

    /// Refuses files with a number for a name in a folder of such that are not on the list.
    ///
    /// # Errors
    /// When there is one, or the system refuses.
    pub fn guard(&self, numbered: &str) -> Result<(), StoreError> {
        let manifest = self.manifest();
        let folder = self.path.join(numbered);
        self.unlinked(&format!("{numbered}/1"))?;
        if found(&folder)?.is_none() {
            return Ok(());
        }
        for entry in fs::read_dir(&folder).map_err(io_error(READ, &folder))? {
            let name = entry.map_err(io_error(READ, &folder))?.file_name();
            let name = name.to_string_lossy();
            let stem = name.split('.').next().unwrap_or_default();
            if stem.parse::<u64>().is_ok() && !name.ends_with(NEW) {
                self.free(&manifest, &format!("{numbered}/{name}"))?;
            }
        }
        Ok(())
    }

    /// Refuses a name that something else has.
    fn free(&self, manifest: &Manifest, name: &str) -> Result<(), StoreError> {
        if manifest.names.contains(name) {
            return Ok(());
        }
        let path = self.unlinked(name)?;
        for path in [beside(&path), path] {
            if found(&path)?.is_some() {
                return refused(
                    &path,
                    "in the way: brakewave did not write it; move it away, or take another folder \
                     with --out",
                );
            }
        }
        Ok(())
    }

    fn restart(&self) -> Result<(), StoreError> {
        self.retain(|_| false)?;
        let path = self.path.join(MANIFEST);
        let mut manifest = self.manifest();
        if !manifest.names.is_empty() || manifest.header.as_ref() != Some(&self.header) {
            manifest.names.clear();
            // all files of the old list are gone: nothing is lost with it
            manifest
                .file
                .set_len(0)
                .and_then(|()| manifest.file.write_all(self.header.text().as_bytes()))
                .map_err(io_error("write it", &path))?;
            manifest.header = Some(self.header.clone());
        }
        Ok(())
    }

    /// Removes the files of the list that are not to be kept, and folders that are empty then.
    ///
    /// # Errors
    /// When a file cannot be removed.
    pub fn retain(&self, keep: impl Fn(&str) -> bool) -> Result<(), StoreError> {
        let manifest = self.manifest();
        let mut folders = BTreeSet::new();
        for name in &manifest.names {
            let path = self.path.join(name);
            remove(&beside(&self.unlinked(name)?))?;
            if !keep(name) {
                remove(&path)?;
                folders.extend(path.parent().map(Path::to_path_buf));
            }
        }
        folders.remove(&self.path);
        for folder in folders {
            // stays where it is not empty
            let _ = fs::remove_dir(&folder);
        }
        Ok(())
    }

    /// The path of a file, which must not lead through a link.
    fn unlinked(&self, name: &str) -> Result<PathBuf, StoreError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent().filter(|folder| *folder != self.path)
            && found(folder)?.is_some_and(|there| !there.is_dir())
        {
            return refused(folder, "in the way: it is a link or a file; move it away");
        }
        Ok(path)
    }

    /// Puts names on the list, before their files are made.
    ///
    /// # Errors
    /// When something else has such a name, or the manifest cannot be written.
    pub fn claim<S: AsRef<str>>(
        &self,
        names: impl IntoIterator<Item = S>,
    ) -> Result<(), StoreError> {
        let mut manifest = self.manifest();
        let mut text = String::new();
        for name in names {
            let name = name.as_ref();
            if manifest.names.contains(name) {
                continue;
            }
            self.free(&manifest, name)?;
            text.push_str(name);
            text.push('\n');
        }
        if text.is_empty() {
            return Ok(());
        }
        let path = self.path.join(MANIFEST);
        manifest
            .file
            .write_all(text.as_bytes())
            .map_err(io_error("write it", &path))?;
        manifest.names.extend(text.lines().map(str::to_owned));
        Ok(())
    }

    /// The path of a file that is on the list, in a folder that is there.
    fn place(&self, name: &str) -> Result<PathBuf, StoreError> {
        self.claim([name])?;
        let path = self.unlinked(name)?;
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(io_error("create it", folder))?;
        }
        Ok(path)
    }

    /// A new file that begins with `bytes`, open for more.
    ///
    /// # Errors
    /// When something else has its name, or the system refuses.
    pub fn create(&self, name: &str, bytes: &[u8]) -> Result<File, StoreError> {
        let path = self.place(name)?;
        let mut file = new_file(&path)?;
        file.write_all(bytes).map_err(io_error("write it", &path))?;
        Ok(file)
    }

    /// A file of an earlier run, cut back to `length` bytes and open for more.
    ///
    /// # Errors
    /// When it is shorter, no file of the list, or the system refuses.
    pub fn cut(&self, name: &str, length: usize) -> Result<File, StoreError> {
        let path = self.unlinked(name)?;
        if !found(&path)?.is_some_and(|there| there.is_file()) {
            return Err(damaged(&path, "it is no longer there"));
        }
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
        Ok(file)
    }

    /// Replaces a file as a whole, never seen half written.
    ///
    /// # Errors
    /// When something else has its name, or the system refuses.
    pub fn replace(&self, name: &str, bytes: &[u8]) -> Result<(), StoreError> {
        let path = self.place(name)?;
        replace(&path, |out| {
            out.write_all(bytes).map_err(io_error("write it", &path))
        })
    }

    /// Replaces a file by a value as RON.
    ///
    /// # Errors
    /// As [`Store::replace`].
    pub fn replace_ron(&self, name: &str, value: &impl Serialize) -> Result<(), StoreError> {
        let text = encode(&self.path.join(name), value)?;
        self.replace(name, text.as_bytes())
    }

    /// Brings the list itself to the disk.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn sync(&self) -> Result<(), StoreError> {
        let path = self.path.join(MANIFEST);
        let manifest = self.manifest();
        manifest
            .file
            .sync_all()
            .map_err(io_error("write it", &path))
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        if !self.kept.load(Ordering::Relaxed) {
            unmake(&self.made);
        }
    }
}

/// A folder by its name, and whether it is there; a link to one is refused.
fn real(path: &Path) -> Result<(PathBuf, bool), StoreError> {
    // without the separator at its end, which would follow a link
    let path: PathBuf = path.components().collect();
    let there = match found(&path)? {
        Some(there) if there.is_symlink() => {
            return refused(&path, "a symbolic link; name the folder that it points to");
        }
        Some(there) if !there.is_dir() => {
            return refused(&path, "a file, where a folder is to be; name another");
        }
        there => there.is_some(),
    };
    Ok((path, there))
}

/// Makes a folder and those above it.
fn make(path: &Path, made: &mut Vec<PathBuf>) -> Result<(), StoreError> {
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
fn unmake(made: &[PathBuf]) {
    for path in made.iter().rev() {
        // a folder stays where it is not empty
        let _ = fs::remove_file(path).or_else(|_| fs::remove_dir(path));
    }
}

/// An entry of a folder that is neither its manifest nor a result folder of its own.
fn stranger(folder: &Path) -> Result<Option<String>, StoreError> {
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

/// Whether a folder may be used as asked for; returns whether it holds results.
fn admit(
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
        return refused(
            path,
            "holds results already; --force replaces them, --resume goes on, --out DIR takes \
             another folder",
        );
    }
    let Some(earlier) = manifest.header.as_ref().filter(|_| left) else {
        return Ok(left);
    };
    if !kind.fits(&earlier.kind) {
        return refused(
            path,
            format!(
                "holds results of another kind ({}, not {}); take another folder with --out",
                earlier.kind, header.kind
            ),
        );
    }
    if existing == Existing::Resume {
        if earlier.version != header.version {
            return refused(
                path,
                format!(
                    "written by version {}, this is {}; go on with that version, or --force starts \
                     anew",
                    earlier.version, header.version
                ),
            );
        }
        if earlier.problem != header.problem {
            return refused(
                path,
                "written for another problem; --force starts anew, --out DIR takes another folder",
            );
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
            return refused(
                path,
                format!(
                    "the results would replace {}, from which they are computed; take another \
                     folder with --out",
                    input.display()
                ),
            );
        }
    }
    Ok(left)
}
