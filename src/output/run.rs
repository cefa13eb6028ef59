//! The folder of a run: written as the branch grows, readable after a kill, resumable.
//!
//! Rows are appended one by one. `branch.ron` holds every labelled wave and the progress of the
//! run; it is there before the first row, and is replaced as a whole now and then and at the end.
//! A resumed run cuts the tables back to the last progress saved and goes on from there, through
//! the same steps as an uninterrupted one.

use std::path::Path;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::layout::{BRANCH, EVENTS, PROFILES, profile_file};
use super::store::{Checkpoint, GrowingFile, Store, StoreError, VERSION, refused, unfinished};
use crate::orbit::Data;
use crate::orbit::legs::{Run, RunState};

/// Lines of the tables of a run.
pub struct Headers {
    /// Of `branch.csv`.
    pub branch: String,
    /// Of `events.csv`.
    pub events: String,
    /// Of the table of eigenvalues or multipliers at labels, with its name, where stability is asked for.
    pub spectrum: Option<(&'static str, String)>,
    /// Files of the pictures to be drawn.
    pub pictures: Vec<String>,
}

/// What a point adds to the tables of a run.
pub struct Lines<S> {
    /// To `branch.csv`.
    pub branch: String,
    /// To `events.csv`, where it is an event.
    pub event: Option<String>,
    /// To the table of eigenvalues or multipliers.
    pub spectrum: Vec<String>,
    /// What is kept of a labelled point, its label, and its profile where it is asked for.
    pub kept: Option<(S, usize, Option<String>)>,
}

/// A run that a folder keeps.
pub trait Recorded: Run {
    /// Its problem.
    type Problem: Data;
    /// A labelled point.
    type Saved: Data;

    /// First lines of the tables.
    fn headers(problem: &Self::Problem) -> Headers;

    /// The lines of a point.
    fn lines(problem: &Self::Problem, item: &Self::Item) -> Lines<Self::Saved>;

    /// The label of a point that was saved.
    fn label(saved: &Self::Saved) -> usize;

    /// The first of the saved points that is not of its problem.
    fn broken(problem: &Self::Problem, saved: &[Self::Saved]) -> Option<usize>;
}

/// Content of `branch.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound = "")]
pub struct Restart<R: Recorded> {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: R::Problem,
    /// State of the run.
    pub progress: RunState<R::Orbit, R::Beside>,
    /// Every labelled point, in order.
    pub labelled: Vec<R::Saved>,
}

/// Its name.
pub(crate) const RESTART: &str = "branch.ron";

impl<R: Recorded> Checkpoint for Restart<R> {
    type Problem = R::Problem;

    const FILE: &'static str = RESTART;

    fn problem(&self) -> &R::Problem {
        &self.problem
    }

    fn flaw(&self) -> Option<String> {
        let mut labels = self.labelled.iter().enumerate();
        let misplaced = labels.position(|(index, saved)| R::label(saved) != index + 1);
        let broken = misplaced.or_else(|| R::broken(&self.problem, &self.labelled));
        match broken {
            Some(index) => Some(format!("the point in place {} is not whole", index + 1)),
            None if self.labelled.len() != self.progress.legs.labels => {
                Some("labelled points are missing".into())
            }
            None => None,
        }
    }
}

impl<R: Recorded> Restart<R> {
    /// Reads that of a folder.
    ///
    /// # Errors
    /// When it cannot be read, or is damaged.
    pub fn read(folder: &Path) -> Result<Restart<R>, StoreError> {
        Checkpoint::read(folder)
    }

    /// The point of a label.
    ///
    /// # Errors
    /// When there is no such label.
    pub fn labelled(&self, folder: &Path, label: usize) -> Result<&R::Saved, StoreError> {
        let mut saved = self.labelled.iter();
        saved.find(|saved| R::label(saved) == label).ok_or_else(|| {
            let last = self.labelled.len();
            let reason = format!("no label {label}; labels run from 1 to {last}");
            refused(&folder.join(RESTART), reason)
        })
    }
}

/// Intervals of a profile over one wavelength, or one period.
pub(crate) const PROFILE_RESOLUTION: usize = 360;

/// The state of a run is saved when this many times as long has passed as saving took: at most a
/// twentieth of the run goes into it, however slow the disk and large the state.
const SAVED_EVERY: u32 = 20;

/// The folder of a run being written.
pub(crate) struct RunFolder<R: Recorded> {
    store: Store,
    branch: GrowingFile,
    events: GrowingFile,
    /// With a `stability` section only.
    spectrum: Option<GrowingFile>,
    /// Written since the state was saved.
    profiles: Vec<GrowingFile>,
    restart: Restart<R>,
    /// When the state was saved, and how long that took.
    saved: (Instant, Duration),
}

impl<R: Recorded> RunFolder<R> {
    /// What an interrupted run left, if it left anything that would be missed.
    ///
    /// # Errors
    /// When that is damaged.
    pub(crate) fn interrupted(
        store: &Store,
        problem: &R::Problem,
    ) -> Result<Option<Restart<R>>, StoreError> {
        let saved: Option<Restart<R>> = store.interrupted(problem, BRANCH, 1)?;
        Ok(saved.filter(|saved| saved.progress.legs.points > 0))
    }

    /// What a run has saved, to be shown.
    ///
    /// # Errors
    /// When that is damaged, or nothing is saved yet.
    pub(crate) fn saved(store: &Store) -> Result<Restart<R>, StoreError> {
        let saved = store.saved(BRANCH, 1)?;
        saved.ok_or_else(|| unfinished(store.path(), "run", "nothing is saved yet"))
    }

    /// Begins a folder, in place of what an earlier run left there; or goes on with what is saved, to
    /// which the tables are cut back.
    ///
    /// # Errors
    /// When something else is in the way, when there is less than was saved, or when the system
    /// refuses.
    pub(crate) fn open(
        store: Store,
        problem: &R::Problem,
        branch: &R,
        saved: Option<Restart<R>>,
    ) -> Result<RunFolder<R>, StoreError> {
        let progress = branch.state();
        let now = progress.legs.clone();
        let resumed = saved.is_some();
        let kept = |rows: usize| resumed.then_some(rows);
        let Headers {
            branch,
            events,
            spectrum,
            pictures,
        } = R::headers(problem);
        if !resumed {
            let mut names: Vec<String> = spectrum.iter().map(|(name, _)| (*name).into()).collect();
            names.extend(pictures);
            store.begin(&[BRANCH, EVENTS, RESTART], names, Some(PROFILES))?;
        }
        let mut folder = RunFolder {
            branch: store.table(BRANCH, &branch, kept(now.points))?,
            events: store.table(EVENTS, &events, kept(now.events))?,
            spectrum: spectrum
                .map(|(name, header)| store.table(name, &header, kept(now.spectrum_rows)))
                .transpose()?,
            store,
            profiles: Vec::new(),
            saved: (Instant::now(), Duration::ZERO),
            restart: saved.unwrap_or_else(|| Restart {
                version: VERSION.to_owned(),
                problem: problem.clone(),
                progress,
                labelled: Vec::new(),
            }),
        };
        if resumed {
            folder.store.keep_numbered(PROFILES, now.labels)?;
            folder.store.guard(PROFILES)?;
        } else {
            // no row without it
            folder.save()?;
        }
        Ok(folder)
    }

    pub(crate) fn store(&self) -> &Store {
        &self.store
    }

    /// Writes what one step found and, now and then and at the end, the progress after it.
    ///
    /// # Errors
    /// When the system refuses.
    pub(crate) fn write(&mut self, items: &[R::Item], branch: &R) -> Result<(), StoreError> {
        for item in items {
            self.append(item)?;
        }
        let (then, took) = self.saved;
        if then.elapsed() >= SAVED_EVERY * took || branch.progress().end.is_some() {
            self.restart.progress = branch.state();
            self.save()?;
        }
        Ok(())
    }

    fn append(&mut self, item: &R::Item) -> Result<(), StoreError> {
        let lines = R::lines(&self.restart.problem, item);
        self.branch.push(lines.branch.as_bytes())?;
        if let Some(event) = &lines.event {
            self.events.push(event.as_bytes())?;
        }
        if let Some(file) = &mut self.spectrum {
            for line in &lines.spectrum {
                file.push(line.as_bytes())?;
            }
        }
        if let Some((saved, label, profile)) = lines.kept {
            self.restart.labelled.push(saved);
            if let Some(text) = profile {
                let file = self.store.create(&profile_file(label), text.as_bytes())?;
                self.profiles.push(file);
            }
        }
        Ok(())
    }

    /// Saves the state, after all that it speaks of has come to the disk.
    fn save(&mut self) -> Result<(), StoreError> {
        let begun = Instant::now();
        let tables = [&self.branch, &self.events].into_iter();
        for file in tables.chain(&self.spectrum).chain(&self.profiles) {
            file.sync()?;
        }
        self.profiles.clear();
        self.store.sync()?;
        self.store.save(RESTART, &self.restart)?;
        self.saved = (Instant::now(), begun.elapsed());
        Ok(())
    }
}
