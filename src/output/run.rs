//! The folder of a run: written as the branch grows, readable after a kill, resumable.
//!
//! Rows are appended one by one. `branch.ron` holds every labelled wave and the progress of the
//! run; it is there before the first row, and is replaced as a whole now and then and at the end.
//! A resumed run cuts the tables back to the last progress saved and goes on from there, through
//! the same steps as an uninterrupted one.

use crate::orbit::legs::Run as _;
use std::path::Path;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::layout::{self, BRANCH, EVENTS, PROFILES, SPECTRUM, profile_file};
use super::render::Format;
use super::store::{
    self, Checkpoint, Growing, Kind, Store, StoreError, VERSION, damaged, refused, unfinished,
};
use crate::branch::SavedWave;
use crate::branch::row::{BranchRow, EventRow, SpectrumRow};
use crate::branch::run::{Item, Progress, Runner};
use crate::curve::start::Labelled;
use crate::model::signature::Regime;
use crate::orbit::EventType;
use crate::problem::{Problem, Start};
use crate::table::{self, Table};

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

impl Checkpoint for Restart {
    const FILE: &'static str = "branch.ron";

    type Problem = Problem;

    fn problem(&self) -> &Problem {
        &self.problem
    }

    /// All waves have the model of the problem, but for the parameter they were followed in.
    fn flaw(&self) -> Option<String> {
        let parameter = self.problem.parameter();
        let model = match (&self.problem.wave.start, self.waves.first()) {
            (Start::Restart { .. }, Some(first)) => first.model,
            _ => self.problem.model,
        };
        let broken = self.waves.iter().enumerate().position(|(index, wave)| {
            let value = wave.model.value(parameter).unwrap_or(f64::NAN);
            let known = wave.model == model.with(parameter, value);
            wave.label != index + 1 || !wave.is_whole() || !known
        });
        match broken {
            Some(index) => Some(format!("the wave in place {} is not whole", index + 1)),
            None if self.waves.len() != self.progress.legs.labels => {
                Some("waves are missing".into())
            }
            None => None,
        }
    }
}

impl Restart {
    /// Reads that of a folder.
    ///
    /// # Errors
    /// When it cannot be read, or is damaged.
    pub fn read(folder: &Path) -> Result<Restart, StoreError> {
        Checkpoint::read(folder)
    }

    /// The wave of a label.
    ///
    /// # Errors
    /// When there is no such label.
    pub fn wave(&self, folder: &Path, label: usize) -> Result<&SavedWave, StoreError> {
        let wave = self.waves.iter().find(|wave| wave.label == label);
        wave.ok_or_else(|| {
            let last = self.waves.len();
            let reason = format!("no label {label}; labels run from 1 to {last}");
            refused(&folder.join(Restart::FILE), reason)
        })
    }
}

/// The event of a label, from `events.csv`.
///
/// # Errors
/// The file is missing or damaged, or has no such label.
pub(crate) fn labelled(folder: &Path, label: usize) -> Result<Labelled, StoreError> {
    #[derive(Deserialize)]
    struct Row {
        label: usize,
        #[serde(rename = "type")]
        kind: EventType,
        sector: Option<usize>,
        omega: Option<f64>,
    }
    let path = folder.join(EVENTS);
    let rows = store::table(&path)?.rows::<Row>();
    let rows = rows.map_err(|error| damaged(&path, error.to_string()))?;
    let row = rows.iter().find(|row| row.label == label);
    let row =
        row.ok_or_else(|| refused(&path, format!("no label {label}; there are {}", rows.len())))?;
    Ok(Labelled {
        kind: row.kind,
        sector: row.sector.unwrap_or(0),
        omega: row.omega,
    })
}

/// Whether a wave in the table of points lifts off.
pub(crate) fn separates(branch: &Table) -> bool {
    let separation = |name| Regime::named(name) == Some(Regime::Separation);
    (0..branch.len()).any(|row| branch.text(row, "regimes").split('-').any(separation))
}

/// Intervals of a profile over one wavelength.
pub(crate) const PROFILE_RESOLUTION: usize = 360;

/// The state of a run is saved when this many times as long has passed as saving took: at most a
/// twentieth of the run goes into it, however slow the disk and large the state.
const SAVED_EVERY: u32 = 20;

/// The folder of a run being written.
#[derive(Debug)]
pub(crate) struct RunFolder {
    store: Store,
    branch: Growing,
    events: Growing,
    /// With a `stability` section only.
    spectrum: Option<Growing>,
    /// Written since the state was saved.
    profiles: Vec<Growing>,
    restart: Restart,
    /// When the state was saved, and how long that took.
    saved: (Instant, Duration),
}

impl RunFolder {
    /// What an interrupted run left, if it left anything that would be missed.
    ///
    /// # Errors
    /// When that is damaged.
    pub(crate) fn interrupted(
        store: &Store,
        problem: &Problem,
    ) -> Result<Option<Restart>, StoreError> {
        let saved: Option<Restart> = store.interrupted(problem, BRANCH, 1)?;
        Ok(saved.filter(|saved| saved.progress.legs.points > 0))
    }

    /// What a run has saved, to be shown.
    ///
    /// # Errors
    /// When that is damaged, or nothing is saved yet.
    pub(crate) fn saved(store: &Store) -> Result<Restart, StoreError> {
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
        problem: &Problem,
        branch: &Runner,
        saved: Option<Restart>,
    ) -> Result<RunFolder, StoreError> {
        let now = branch.saved();
        let resumed = saved.is_some();
        let kept = |rows: usize| resumed.then_some(rows);
        let spectrum = branch.with_stability().then_some(SPECTRUM);
        if !resumed {
            let mut names = Vec::from_iter(spectrum.map(str::to_owned));
            names.extend(layout::pictures(Kind::Run, problem, Format::Svg));
            store.begin(&[BRANCH, EVENTS, Restart::FILE], names, Some(PROFILES))?;
        }
        let header = table::columns(&EventRow::columns(problem.model, problem.output.rotation));
        let columns = table::columns(&BranchRow::columns(problem.output.rotation));
        let mut folder = RunFolder {
            branch: store.table(BRANCH, &table::line_of(&columns), kept(now.legs.points))?,
            events: store.table(EVENTS, &table::line_of(&header), kept(now.legs.events))?,
            spectrum: spectrum
                .map(|name| {
                    let header = table::header::<SpectrumRow>();
                    store.table(name, &header, kept(now.beside.eigenvalues))
                })
                .transpose()?,
            store,
            profiles: Vec::new(),
            saved: (Instant::now(), Duration::ZERO),
            restart: saved.unwrap_or_else(|| Restart {
                version: VERSION.to_owned(),
                problem: problem.clone(),
                progress: now.clone(),
                waves: Vec::new(),
            }),
        };
        if resumed {
            folder.store.keep_numbered(PROFILES, now.legs.labels)?;
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
    pub(crate) fn write(&mut self, items: &[Item], branch: &Runner) -> Result<(), StoreError> {
        for item in items {
            self.append(item)?;
        }
        let (then, took) = self.saved;
        if then.elapsed() >= SAVED_EVERY * took || branch.progress().end.is_some() {
            self.restart.progress = branch.saved();
            self.save()?;
        }
        Ok(())
    }

    fn append(&mut self, item: &Item) -> Result<(), StoreError> {
        let mode = f64::from(item.wave().0.mode);
        let output = &self.restart.problem.output;
        let hertz = |speed: f64| output.hertz(mode * speed);
        let row = BranchRow::new(&item.point, item.leg, hertz(item.point.speed));
        self.branch.row(&row)?;
        if let Some(event) = &item.event {
            self.events.row(&EventRow::new(event, hertz(event.speed)))?;
        }
        if let (Some(file), Some(label)) = (&mut self.spectrum, item.point.label) {
            for &eigenvalue in &item.eigenvalues {
                file.row(&SpectrumRow { label, eigenvalue })?;
            }
        }
        let Some(saved) = &item.saved else {
            return Ok(());
        };
        self.restart.waves.push(saved.clone());
        // a profile that overflows is left out: the point itself has been solved
        if self.restart.problem.output.profiles > 0
            && let Ok(samples) = item.profile(PROFILE_RESOLUTION)
        {
            let text = table::table(samples);
            let file = self
                .store
                .create(&profile_file(saved.label), text.as_bytes())?;
            self.profiles.push(file);
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
        self.store.save(Restart::FILE, &self.restart)?;
        self.saved = (Instant::now(), begun.elapsed());
        Ok(())
    }
}
