//! The result folder: written as the branch grows, readable after a kill, resumable.
//!
//! Rows are appended one by one. `branch.ron` holds every labelled wave and the progress of the
//! run; it is there before the first row, and is replaced as a whole now and then and at the end.
//! A resumed run cuts the tables back to the last progress saved and goes on from there, through
//! the same steps as an uninterrupted one.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::pictures;
use super::render::Format;
use super::store::{self, Store, StoreError, VERSION, bytes, damaged, io_error, read};
use crate::branch::SavedWave;
use crate::branch::row::{BranchRow, EigenvalueRow, EventRow, SpectrumRow};
use crate::branch::run::{Item, Progress, Runner};
use crate::curve::start::Labelled;
use crate::model::Parameter;
use crate::problem::{Problem, Start};
use crate::table;

/// Content of `branch.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Restart {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: Problem,
    /// State of the run.
    pub progress: Progress,
    /// Every labelled wave, in order.
    pub waves: Vec<SavedWave>,
}

impl Restart {
    /// Reads the restart file of a folder.
    ///
    /// # Errors
    /// When it cannot be read, or is damaged.
    pub fn read(folder: &Path) -> Result<Restart, StoreError> {
        let path = folder.join(RESTART);
        let restart: Restart = ron::from_str(&read(&path)?).map_err(|error| {
            let reason = format!("no restart file of version {VERSION}: {error}");
            damaged(&path, reason)
        })?;
        // all waves have the model of the problem, but for the parameter they were followed in
        let parameter = restart.problem.continuation.as_ref();
        let parameter = parameter.map_or(Parameter::Mismatch, |section| section.parameter);
        let model = match (&restart.problem.wave.start, restart.waves.first()) {
            (Start::Restart { .. }, Some(first)) => first.model,
            _ => restart.problem.model,
        };
        for (index, wave) in restart.waves.iter().enumerate() {
            let value = wave.model.value(parameter).unwrap_or(f64::NAN);
            let known = wave.model == model.with(parameter, value);
            if wave.label != index + 1 || !wave.is_whole() || !known {
                let reason = format!("the wave in place {} is not whole", index + 1);
                return Err(damaged(&path, reason));
            }
        }
        if restart.waves.len() != restart.progress.labels {
            return Err(damaged(&path, "waves are missing"));
        }
        Ok(restart)
    }

    /// The wave of a label.
    ///
    /// # Errors
    /// When there is no such label.
    pub fn wave(&self, folder: &Path, label: usize) -> Result<&SavedWave, StoreError> {
        self.waves
            .iter()
            .find(|wave| wave.label == label)
            .ok_or_else(|| StoreError::Refused {
                path: folder.join(RESTART),
                reason: format!(
                    "no label {label}; labels run from 1 to {}",
                    self.waves.len()
                ),
            })
    }
}

/// The event of a label, from `events.csv`.
///
/// # Errors
/// The file is missing or damaged, or has no such label.
pub fn labelled(folder: &Path, label: usize) -> Result<Labelled, StoreError> {
    let path = folder.join(EVENTS);
    let table = store::table(&path)?;
    let row = table
        .labelled(&label.to_string())
        .ok_or_else(|| StoreError::Refused {
            path: path.clone(),
            reason: format!("no label {label}; there are {}", table.len()),
        })?;
    Ok(Labelled {
        kind: table
            .field(row, "type")
            .ok_or_else(|| damaged(&path, format!("label {label} has no type")))?,
        sector: table.field(row, "sector").unwrap_or(0),
        omega: table.field(row, "omega"),
    })
}

/// Name of the restart file.
pub const RESTART: &str = "branch.ron";
/// Name of the table of points.
pub const BRANCH: &str = "branch.csv";
/// Name of the table of events.
pub const EVENTS: &str = "events.csv";
const SPECTRUM: &str = "spectrum.csv";
const PROFILES: &str = "profiles";

/// Intervals of a profile over one wavelength.
const PROFILE_RESOLUTION: usize = 360;

/// The state of a run is saved when this many times as long has passed as saving took: at most a
/// twentieth of the run goes into it, however slow the disk and large the state.
const SAVED_EVERY: u32 = 20;

/// A result folder being written.
#[derive(Debug)]
pub struct Folder {
    store: Store,
    branch: File,
    events: File,
    /// With a `stability` section only.
    spectrum: Option<File>,
    /// Written since the state was saved.
    profiles: Vec<File>,
    with_profiles: bool,
    restart: Restart,
    /// When the state was saved, and how long that took.
    saved: (Instant, Duration),
}

/// What an interrupted run left, if it left anything that would be missed.
///
/// # Errors
/// When that is damaged.
pub fn interrupted(store: &Store, problem: &Problem) -> Result<Option<Restart>, StoreError> {
    let path = store.path().join(RESTART);
    if !store.resumes() {
        return Ok(None);
    }
    if path.exists() {
        let restart = Restart::read(store.path())?;
        if restart.problem != *problem {
            return Err(damaged(&path, "it holds another problem than the manifest"));
        }
        return Ok(Some(restart).filter(|restart| restart.progress.points > 0));
    }
    // it is there before the first row is
    let branch = bytes(&store.path().join(BRANCH)).unwrap_or_default();
    if line_ends(&branch).count() > 1 {
        return Err(damaged(&path, "it is missing"));
    }
    Ok(None)
}

impl Folder {
    /// Begins a folder; what an earlier run left there is replaced.
    ///
    /// # Errors
    /// When something else is in the way, or the system refuses.
    pub fn create(store: Store, problem: &Problem, branch: &Runner) -> Result<Folder, StoreError> {
        let events = table::columns(&EventRow::columns(problem.model));
        let spectrum = branch.with_stability().then_some(SPECTRUM);
        let pictures = problem.output.plots.iter();
        let pictures = pictures.map(|picture| pictures::file_name(picture, Format::Svg));
        let fixed = [BRANCH, EVENTS, RESTART].into_iter().chain(spectrum);
        store.begin(fixed.map(str::to_owned).chain(pictures), Some(PROFILES))?;
        let mut folder = Folder {
            branch: store.create(BRANCH, table::header::<BranchRow>().as_bytes())?,
            events: store.create(EVENTS, table::line_of(&events).as_bytes())?,
            spectrum: spectrum
                .map(|name| store.create(name, table::header::<SpectrumRow>().as_bytes()))
                .transpose()?,
            store,
            profiles: Vec::new(),
            with_profiles: problem.output.profiles > 0,
            restart: Restart {
                version: VERSION.to_owned(),
                problem: problem.clone(),
                progress: branch.progress().clone(),
                waves: Vec::new(),
            },
            saved: (Instant::now(), Duration::ZERO),
        };
        // no row without it
        folder.save()?;
        Ok(folder)
    }

    /// Opens the folder of an interrupted run: tables are cut back to the saved progress.
    ///
    /// # Errors
    /// When there is less than was saved, or the system refuses.
    pub fn reopen(store: Store, restart: Restart) -> Result<Folder, StoreError> {
        let table = |name: &str, rows: usize| -> Result<File, StoreError> {
            let path = store.path().join(name);
            // bytes, for a row cut short may end within a character
            let text = bytes(&path).map_err(|_| damaged(&path, "it cannot be read"))?;
            let length = line_ends(&text).nth(rows).ok_or_else(|| {
                damaged(&path, format!("it has fewer than the {rows} rows saved"))
            })?;
            store.cut(name, length)
        };
        let Progress {
            points,
            events,
            eigenvalues,
            labels,
            ..
        } = restart.progress;
        let branch = table(BRANCH, points)?;
        let events = table(EVENTS, events)?;
        let spectrum = match restart.problem.stability {
            Some(_) => Some(table(SPECTRUM, eigenvalues)?),
            None => None,
        };
        store.retain(|name| match Path::new(name).strip_prefix(PROFILES) {
            Ok(profile) => label(profile).is_some_and(|label| label <= labels),
            Err(_) => true,
        })?;
        store.guard(PROFILES)?;
        Ok(Folder {
            store,
            branch,
            events,
            spectrum,
            profiles: Vec::new(),
            with_profiles: restart.problem.output.profiles > 0,
            restart,
            saved: (Instant::now(), Duration::ZERO),
        })
    }

    /// The folder as such.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// Writes what one step found and, now and then and at the end, the progress after it.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn write(&mut self, items: &[Item], branch: &Runner) -> Result<(), StoreError> {
        for item in items {
            self.append(item)?;
        }
        let (then, took) = self.saved;
        if then.elapsed() >= SAVED_EVERY * took || branch.progress().end.is_some() {
            self.restart.progress = branch.progress().clone();
            self.save()?;
        }
        Ok(())
    }

    fn append(&mut self, item: &Item) -> Result<(), StoreError> {
        let row = |mut file: &File, name: &str, row: String| {
            let path = self.store.path().join(name);
            file.write_all(row.as_bytes())
                .map_err(io_error("write to it", &path))
        };
        row(
            &self.branch,
            BRANCH,
            table::line(&BranchRow::new(&item.point, item.leg)),
        )?;
        if let Some(event) = &item.event {
            row(&self.events, EVENTS, table::line(&EventRow::new(event)))?;
        }
        if let (Some(file), Some(label)) = (&self.spectrum, item.point.label) {
            for &(sector, [re, im, error]) in &item.eigenvalues {
                let eigenvalue = EigenvalueRow {
                    sector,
                    re,
                    im,
                    error,
                };
                let found = SpectrumRow { label, eigenvalue };
                row(file, SPECTRUM, table::line(&found))?;
            }
        }
        let Some(saved) = &item.saved else {
            return Ok(());
        };
        self.restart.waves.push(saved.clone());
        // a profile that overflows is left out: the point itself has been solved
        if self.with_profiles
            && let Ok(samples) = item.profile(PROFILE_RESOLUTION)
        {
            let name = format!("{PROFILES}/{}.csv", saved.label);
            let text = table::table(samples);
            self.profiles
                .push(self.store.create(&name, text.as_bytes())?);
        }
        Ok(())
    }

    /// Saves the state, after all that it speaks of has come to the disk.
    fn save(&mut self) -> Result<(), StoreError> {
        let begun = Instant::now();
        let tables = [&self.branch, &self.events].into_iter();
        for file in tables.chain(&self.spectrum).chain(&self.profiles) {
            file.sync_all()
                .map_err(io_error("write a table in it", self.store.path()))?;
        }
        self.profiles.clear();
        self.store.sync()?;
        self.store.replace_ron(RESTART, &self.restart)?;
        self.saved = (Instant::now(), begun.elapsed());
        Ok(())
    }
}

/// The label that a profile belongs to.
fn label(profile: &Path) -> Option<usize> {
    profile.file_stem()?.to_str()?.parse().ok()
}

/// Where the lines of a text end, each past its newline.
fn line_ends(text: &[u8]) -> impl Iterator<Item = usize> {
    text.iter()
        .enumerate()
        .filter(|(_, byte)| **byte == b'\n')
        .map(|(index, _)| index + 1)
}
