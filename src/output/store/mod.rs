//! Result folders: which files in them are the program's own, and who may write.
//!
//! Every folder carries a manifest, [`MANIFEST`]: version, kind of the results, hash of the problem,
//! and the name of every file the program wrote there, a line each. A name is appended before its
//! file is made, so that a kill leaves nothing unnamed. Only what is listed is ever replaced or
//! removed; anything else in the way is refused, and links are not followed. The manifest is also
//! the lock: it is held while results are written and falls with the process, however that ends. It
//! also tells the folder from another one that is put in its place, where nothing is written.
//!
//! A file is never written to under another name: one with a hard link is replaced by a copy first.
//!
//! What a checkpoint speaks of has come to the disk before it. Pictures, which are drawn again from the tables, have not.

mod admit;
mod checkpoint;
mod content;
mod error;
mod file;
mod manifest;
mod place;

use std::collections::BTreeSet;
use std::fs::{self, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;

use crate::problem;

pub(crate) use admit::Existing;
pub(crate) use checkpoint::Checkpoint;
pub use error::{Offers, StoreError};
pub(crate) use error::{READ, damaged, io_error, refused, resumable, unfinished};
pub(crate) use file::{GrowingFile, VERSION, bytes, decode, encode, hash, numbered, read, table};
pub(crate) use manifest::{FolderKind, MANIFEST};

use admit::admit;
use file::{found, is_at, is_left_over, is_shared, number, remove, unshare};
use manifest::{Header, Manifest};
use place::{make, real, stranger, unmake};

/// The problem file as it was written, beside its results.
pub(crate) const SOURCE: &str = "source.ron";

#[derive(Debug)]
pub(crate) struct Store {
    path: PathBuf,
    manifest: Mutex<Manifest>,
    header: Header,
    /// Results are there that were not replaced yet.
    results: bool,
    resumes: bool,
    /// The problem file as it was written.
    source: Option<String>,
}

impl Store {
    /// Takes hold of a folder. Nothing of earlier results changes before [`Store::begin`]; a folder
    /// that is made here is gone again if that is never called.
    ///
    /// `inputs` are the files and folders that the results are computed from, the problem file first.
    ///
    /// # Errors
    /// When the folder cannot be written, holds anything that is not to be touched, or is being
    /// written by another process.
    pub(crate) fn open(
        path: &Path,
        kind: FolderKind,
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
        let opened = Store::locked(&path, &mut made).and_then(|manifest| {
            admit(&path, kind, &header, &manifest, existing, inputs).map(|left| (manifest, left))
        });
        let (mut manifest, results) = match opened {
            Ok(opened) => opened,
            Err(error) => {
                unmake(&made);
                return Err(error);
            }
        };
        manifest.made = made;
        let store = Store {
            results,
            resumes: results && existing == Existing::Resume,
            manifest: Mutex::new(manifest),
            path,
            header,
            source: inputs.first().and_then(|file| problem::as_written(file)),
        };
        store.sweep()?;
        if !store.results {
            // a full disk is noticed here and not after the computation
            store.restart()?;
        }
        Ok(store)
    }

    /// The manifest of a folder, locked; made where there is none.
    fn locked(folder: &Path, made: &mut Vec<PathBuf>) -> Result<Manifest, StoreError> {
        let path = folder.join(MANIFEST);
        let new = !Manifest::exists(&path)?;
        if let Some(name) = stranger(folder)?.filter(|_| new) {
            let reason = format!(
                "holds `{name}` but no `{MANIFEST}`: it is no result folder, or one of a version before \
                 manifests; take another with --out, or move its files away"
            );
            return Err(refused(folder, reason));
        }
        let open = || {
            let mut options = OpenOptions::new();
            let opened = options.read(true).append(true).create(true).open(&path);
            let file = opened.map_err(io_error("open it for writing", &path))?;
            // a file system without locks does not keep anybody from computing
            if let Err(TryLockError::WouldBlock) = file.try_lock() {
                let reason = "another process is writing there; wait until it is done, or take another \
                              folder with --out";
                return Err(refused(folder, reason));
            }
            match is_at(&file, &path) {
                true => Ok(file),
                false => {
                    let reason = "another process has just left it; try again";
                    Err(refused(folder, reason))
                }
            }
        };
        let mut file = open()?;
        if unshare(&path)? {
            file = open()?;
        }
        made.extend(new.then(|| path.clone()));
        Manifest::read(&path, file, true)
    }

    /// A folder with results, to add files to while somebody else may be writing there.
    ///
    /// # Errors
    /// When it has no manifest.
    pub(crate) fn visit(path: &Path) -> Result<Store, StoreError> {
        let (path, _) = real(path)?;
        let file = path.join(MANIFEST);
        if !Manifest::exists(&file)? {
            let reason = format!(
                "has no `{MANIFEST}`: it is no result folder, or one of a version before manifests; \
                 compute it anew into another folder"
            );
            return Err(refused(&path, reason));
        }
        let open = || {
            let opened = OpenOptions::new().read(true).append(true).open(&file);
            opened.map_err(io_error("open it for writing", &file))
        };
        let mut opened = open()?;
        let shared = opened.metadata().is_ok_and(|manifest| is_shared(&manifest));
        // while somebody is writing the list stays theirs
        if shared && opened.try_lock().is_ok() && unshare(&file)? {
            opened = open()?;
        }
        let manifest = Manifest::read(&file, opened, false)?;
        let Some(header) = manifest.header.clone() else {
            return Err(StoreError::Foreign(file));
        };
        Ok(Store {
            path,
            manifest: Mutex::new(manifest),
            header,
            results: true,
            resumes: false,
            source: None,
        })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// What the folder holds; none where another version has a word of its own for it.
    pub(crate) fn kind(&self) -> Option<FolderKind> {
        FolderKind::of(&self.header.kind)
    }

    /// Names of the files of the program, in alphabetical order.
    pub(crate) fn names(&self) -> Vec<String> {
        self.manifest().names.iter().cloned().collect()
    }

    /// Whether there are results to go on with.
    pub(crate) fn resumes(&self) -> bool {
        self.resumes
    }

    /// Whether there are results of an earlier run.
    pub(crate) fn holds_results(&self) -> bool {
        self.results
    }

    fn manifest(&self) -> MutexGuard<'_, Manifest> {
        // a list of names is whole between any two statements
        self.manifest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins results anew with files of these names, `more` of them pictures mostly: what an earlier run
    /// left is removed, once it is known that nothing else is in the way. `numbered` is a folder for files
    /// `1.csv`, `2.csv`, ….
    ///
    /// # Errors
    /// When something else is in the way, or the system refuses.
    pub(crate) fn begin(
        &self,
        names: &[&str],
        more: Vec<String>,
        numbered: Option<&str>,
    ) -> Result<(), StoreError> {
        let source = self.source.as_ref().map(|_| SOURCE);
        let names = names.iter().copied().chain(source);
        let names = names.chain(more.iter().map(String::as_str));
        if let Some(numbered) = numbered {
            self.guard(numbered)?;
        }
        for name in names.clone() {
            self.free(&self.manifest(), name)?;
        }
        self.manifest().made.clear();
        self.restart()?;
        self.claim(names)?;
        match &self.source {
            Some(text) => self.replace(SOURCE, text.as_bytes()),
            None => Ok(()),
        }
    }

    /// Refuses files with a number for a name in a folder of such that are not on the list.
    ///
    /// # Errors
    /// When there is one, or the system refuses.
    pub(crate) fn guard(&self, numbered: &str) -> Result<(), StoreError> {
        let manifest = self.manifest();
        let folder = self.path.join(numbered);
        self.unlinked(&format!("{numbered}/1"))?;
        if found(&folder)?.is_none() {
            return Ok(());
        }
        for entry in fs::read_dir(&folder).map_err(io_error(READ, &folder))? {
            let name = entry.map_err(io_error(READ, &folder))?.file_name();
            let name = name.to_string_lossy();
            if number(Path::new(&*name)).is_some() {
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
        if found(&path)?.is_some() {
            let reason = "in the way: brakewave did not write it; move it away, or take another \
                          folder with --out";
            return Err(refused(&path, reason));
        }
        Ok(())
    }

    fn restart(&self) -> Result<(), StoreError> {
        self.retain(|_| false)?;
        let mut manifest = self.manifest();
        if !manifest.names.is_empty() || manifest.header.as_ref() != Some(&self.header) {
            manifest.names.clear();
            // all files of the old list are gone: nothing is lost with it
            manifest
                .file
                .set_len(0)
                .and_then(|()| manifest.file.write_all(self.header.text().as_bytes()))
                .map_err(io_error("write it", &self.path.join(MANIFEST)))?;
            manifest.header = Some(self.header.clone());
        }
        Ok(())
    }

    /// Removes the files of the list that are not to be kept, and folders that are empty then; none where
    /// one of them cannot be.
    ///
    /// # Errors
    /// When a file cannot be removed, or something that is no file has its name.
    pub(crate) fn retain(&self, keep: impl Fn(&str) -> bool) -> Result<(), StoreError> {
        let manifest = self.manifest();
        self.stay(&manifest)?;
        let mut paths = Vec::new();
        for name in manifest.names.iter().filter(|name| !keep(name)) {
            let path = self.unlinked(name)?;
            if found(&path)?.is_some_and(|there| there.is_dir()) {
                let reason = "in the way: a folder with the name of a result; move it away";
                return Err(refused(&path, reason));
            }
            paths.push(path);
        }
        for path in &paths {
            remove(path)?;
        }
        for folder in self.folders(paths.iter()) {
            // stays where it is not empty
            let _ = fs::remove_dir(&folder);
        }
        Ok(())
    }

    /// The folders inside this one in which files lie.
    fn folders<'a>(&self, paths: impl Iterator<Item = &'a PathBuf>) -> BTreeSet<PathBuf> {
        let folders = paths.filter_map(|path| path.parent());
        let inside = folders.filter(|folder| *folder != self.path);
        inside.map(Path::to_path_buf).collect()
    }

    /// Removes what was being written when an earlier process was killed.
    fn sweep(&self) -> Result<(), StoreError> {
        let paths: Vec<PathBuf> = {
            let names = &self.manifest().names;
            names.iter().map(|name| self.path.join(name)).collect()
        };
        let mut folders = self.folders(paths.iter());
        folders.insert(self.path.clone());
        for folder in folders {
            // no folder, or a link to one: nothing of ours is in it
            if !found(&folder)?.is_some_and(|there| there.is_dir()) {
                continue;
            }
            for entry in fs::read_dir(&folder).map_err(io_error(READ, &folder))? {
                let path = entry.map_err(io_error(READ, &folder))?.path();
                let name = path.file_name().and_then(|name| name.to_str());
                if name.is_some_and(is_left_over) {
                    remove(&path)?;
                }
            }
        }
        Ok(())
    }

    /// Refuses a folder that has taken the place of the one that was opened.
    fn stay(&self, manifest: &Manifest) -> Result<(), StoreError> {
        match is_at(&manifest.file, &self.path.join(MANIFEST)) {
            true => Ok(()),
            false => Err(StoreError::Moved(self.path.clone())),
        }
    }

    /// Removes the files of a folder for numbered ones whose number is larger than `last`.
    ///
    /// # Errors
    /// When a file cannot be removed.
    pub(crate) fn keep_numbered(&self, numbered: &str, last: usize) -> Result<(), StoreError> {
        self.retain(|name| match Path::new(name).strip_prefix(numbered) {
            Ok(file) => number(file).is_some_and(|number| number <= last),
            Err(_) => true,
        })
    }

    /// The path of a file, which must not lead through a link.
    fn unlinked(&self, name: &str) -> Result<PathBuf, StoreError> {
        let path = self.path.join(name);
        if let Some(folder) = path.parent().filter(|folder| *folder != self.path)
            && found(folder)?.is_some_and(|there| !there.is_dir())
        {
            let reason = "in the way: it is a link or a file; move it away";
            return Err(refused(folder, reason));
        }
        Ok(path)
    }

    /// Puts names on the list, before their files are made.
    ///
    /// # Errors
    /// When something else has such a name, or the manifest cannot be written.
    pub(crate) fn claim<S: AsRef<str>>(
        &self,
        names: impl IntoIterator<Item = S>,
    ) -> Result<(), StoreError> {
        let mut manifest = self.manifest();
        self.stay(&manifest)?;
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
        let written = manifest.file.write_all(text.as_bytes());
        written.map_err(io_error("write it", &self.path.join(MANIFEST)))?;
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

    /// Brings the list itself to the disk.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn sync(&self) -> Result<(), StoreError> {
        let synced = self.manifest().file.sync_all();
        synced.map_err(io_error("write it", &self.path.join(MANIFEST)))
    }
}

impl Drop for Store {
    fn drop(&mut self) {
        let manifest = self.manifest();
        if self.stay(&manifest).is_ok() {
            unmake(&manifest.made);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What was half written when a process was killed goes with the next one, and nothing else.
    #[test]
    fn what_is_left_over_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        let open = |existing| Store::open(&path, FolderKind::Run, &1, existing, &[]).unwrap();
        let store = open(Existing::Refuse);
        store.begin(&["branch.ron"], Vec::new(), None).unwrap();
        store.replace("profiles/1.csv", b"1").unwrap();
        drop(store);
        let names = || {
            let all = [path.clone(), path.join("profiles")];
            let entries = all.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
            entries.count()
        };
        let before = names();
        for inside in ["branch.ron", "profiles/1.csv"] {
            // as a kill leaves it
            file::new_beside(&path.join(inside)).unwrap();
            fs::write(path.join(inside).with_extension("new"), "mine").unwrap();
        }
        assert_eq!(names(), before + 4);
        drop(open(Existing::Resume));
        assert_eq!(names(), before + 2);
    }
}
