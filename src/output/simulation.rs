//! The folder of a simulation: time series, regimes, snapshots, measures, checkpoint.
//!
//! Rows are appended as samples are taken. `checkpoint.ron` holds the state of the body; it is
//! replaced as a whole, never seen half written. A resumed simulation cuts everything back to the
//! last checkpoint and goes on through the same steps as an uninterrupted one, to the same bytes.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::store::{StoreError, damaged, encode, io_error};
use super::{npy, tables, vtk};
use crate::problem::Problem;
use crate::simulation::growth::Eigenvalue;
use crate::simulation::line::Line;
use crate::simulation::measure::{Measure, Sample};
use crate::simulation::motion::{Motion, Saved};

/// Name of the checkpoint.
pub const CHECKPOINT: &str = "checkpoint.ron";
/// Name of the time series.
pub const SERIES: &str = "series.csv";
/// Name of the array of regimes.
pub const REGIMES: &str = "regimes.npy";
/// Name of the contact line at the beginning.
pub const START: &str = "start.csv";
/// Name of the contact line at the end.
pub const END: &str = "end.csv";
/// Name of the table of measures.
pub const MEASURES: &str = "measures.csv";
const GROWTH: &str = "growth.csv";
const SNAPSHOTS: &str = "snapshots";

/// Most columns of the array of regimes.
const COLUMNS: usize = 512;

/// Content of `checkpoint.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Version of brakewave that wrote it.
    pub version: String,
    /// The problem with all its settings.
    pub problem: Problem,
    /// Samples taken, the one at the beginning included.
    pub samples: usize,
    /// Snapshots written.
    pub snapshots: usize,
    /// Steps taken.
    pub steps: u64,
    /// Energy at the beginning.
    pub energy: f64,
    /// State of the body.
    pub state: Saved,
}

impl Checkpoint {
    /// Reads the checkpoint of a folder.
    pub fn read(folder: &Path) -> Result<Checkpoint, StoreError> {
        let path = folder.join(CHECKPOINT);
        let text = fs::read_to_string(&path).map_err(refused(&path))?;
        ron::from_str(&text)
            .map_err(|error| damaged(&path, format!("not a checkpoint of this version: {error}")))
    }
}

fn refused(path: &Path) -> impl FnOnce(io::Error) -> StoreError + '_ {
    io_error("read or write it", path)
}

/// The folder of a simulation being written.
#[derive(Debug)]
pub struct SimulationFolder {
    path: PathBuf,
    series: File,
    regimes: File,
    samples: usize,
    snapshots: usize,
    columns: usize,
}

/// Every how many points one is kept in the array of regimes.
fn stride(points: usize) -> usize {
    points.div_ceil(COLUMNS)
}

impl SimulationFolder {
    /// Creates the folder. An existing one with results is refused unless `force`, which removes the
    /// files of an earlier simulation and no others.
    pub fn create(path: &Path, points: usize, force: bool) -> Result<SimulationFolder, StoreError> {
        if path.exists() {
            let occupied =
                !path.is_dir() || fs::read_dir(path).map_err(refused(path))?.next().is_some();
            if occupied && !force {
                return Err(StoreError::Refused {
                    path: path.to_path_buf(),
                    reason:
                        "holds results already; --force replaces them, --resume goes on, --out \
                             DIR takes another folder"
                            .to_owned(),
                });
            }
            clear(path)?;
        }
        let snapshots = path.join(SNAPSHOTS);
        fs::create_dir_all(&snapshots).map_err(refused(&snapshots))?;
        let create = |name: &str, content: &[u8]| -> Result<File, StoreError> {
            let path = path.join(name);
            let mut file = File::create(&path).map_err(refused(&path))?;
            file.write_all(content).map_err(refused(&path))?;
            Ok(file)
        };
        let columns = points.div_ceil(stride(points));
        let header = format!("{}\n", Sample::COLUMNS.join(","));
        Ok(SimulationFolder {
            series: create(SERIES, header.as_bytes())?,
            regimes: create(REGIMES, &npy::header(npy::Kind::Byte, 0, columns))?,
            path: path.to_path_buf(),
            samples: 0,
            snapshots: 0,
            columns,
        })
    }

    /// Opens the folder of an interrupted simulation, cut back to its checkpoint; returns the samples
    /// taken so far as well.
    pub fn reopen(
        path: &Path,
        points: usize,
        checkpoint: &Checkpoint,
    ) -> Result<(SimulationFolder, Vec<Sample>), StoreError> {
        let columns = points.div_ceil(stride(points));
        let open = |name: &str, length: usize| -> Result<File, StoreError> {
            let path = path.join(name);
            let mut file = OpenOptions::new()
                .read(true)
                .write(true)
                .open(&path)
                .map_err(refused(&path))?;
            let found = file.metadata().map_err(refused(&path))?.len();
            if found < length as u64 {
                return Err(damaged(&path, "shorter than the checkpoint says"));
            }
            file.set_len(length as u64).map_err(refused(&path))?;
            file.seek(SeekFrom::End(0)).map_err(refused(&path))?;
            Ok(file)
        };
        let (samples, length) = read_series(&path.join(SERIES), checkpoint.samples)?;
        let folder = SimulationFolder {
            series: open(SERIES, length)?,
            regimes: open(REGIMES, npy::HEADER + columns * checkpoint.samples)?,
            path: path.to_path_buf(),
            samples: checkpoint.samples,
            snapshots: checkpoint.snapshots,
            columns,
        };
        remove_snapshots(&path.join(SNAPSHOTS), checkpoint.snapshots)?;
        Ok((folder, samples))
    }

    /// Samples written.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Snapshots written.
    pub fn snapshots(&self) -> usize {
        self.snapshots
    }

    /// Appends a sample.
    pub fn sample(&mut self, sample: &Sample, line: &Line) -> Result<(), StoreError> {
        let row: Vec<String> = sample
            .numbers()
            .iter()
            .map(|x| tables::number(*x))
            .collect();
        let path = self.path.join(SERIES);
        writeln!(self.series, "{}", row.join(",")).map_err(refused(&path))?;
        let codes: Vec<u8> = line
            .regimes
            .iter()
            .step_by(stride(line.regimes.len()))
            .map(|regime| regime.code())
            .collect();
        let path = self.path.join(REGIMES);
        self.regimes.write_all(&codes).map_err(refused(&path))?;
        self.samples += 1;
        Ok(())
    }

    /// Writes the contact line as a table.
    pub fn line(&self, name: &str, line: &Line) -> Result<(), StoreError> {
        use std::fmt::Write;
        let mut text = String::from("phi,U,V,U_dot,V_dot,P,Q,regime\n");
        for point in 0..line.radial.len() {
            for value in [
                line.width * point as f64,
                line.radial[point],
                line.tangential[point],
                line.radial_rate[point],
                line.tangential_rate[point],
                line.pressure[point],
                line.shear[point],
            ] {
                // writing to a string does not fail
                let _ = write!(text, "{value:.16e},");
            }
            text.push_str(line.regimes[point].name());
            text.push('\n');
        }
        let path = self.path.join(name);
        fs::write(&path, text).map_err(refused(&path))
    }

    /// Writes a snapshot: an array of φ, U, V, U̇, V̇, P, Q for a ring, the mesh for an annulus.
    pub fn snapshot(&mut self, motion: &Motion) -> Result<(), StoreError> {
        let number = self.snapshots + 1;
        let (extension, content) = match motion {
            Motion::Ring(_) => {
                let line = motion.line();
                let angles: Vec<f64> = (0..line.radial.len())
                    .map(|point| line.width * point as f64)
                    .collect();
                let columns: [&[f64]; 7] = [
                    &angles,
                    &line.radial,
                    &line.tangential,
                    &line.radial_rate,
                    &line.tangential_rate,
                    &line.pressure,
                    &line.shear,
                ];
                ("npy", npy::doubles(&columns))
            }
            Motion::Annulus(annulus) => {
                let title = format!("brakewave annulus, t = {}", motion.time());
                ("vtk", vtk::annulus(annulus, &title).into_bytes())
            }
        };
        let path = self
            .path
            .join(SNAPSHOTS)
            .join(format!("{number:04}.{extension}"));
        fs::write(&path, content).map_err(refused(&path))?;
        self.snapshots = number;
        Ok(())
    }

    /// Saves the state, after what leads to it.
    pub fn checkpoint(
        &mut self,
        problem: &Problem,
        energy: f64,
        motion: &Motion,
    ) -> Result<(), StoreError> {
        let path = self.path.join(REGIMES);
        let header = npy::header(npy::Kind::Byte, self.samples, self.columns);
        self.regimes
            .seek(SeekFrom::Start(0))
            .and_then(|_| self.regimes.write_all(&header))
            .and_then(|()| self.regimes.seek(SeekFrom::End(0)))
            .map_err(refused(&path))?;
        let checkpoint = Checkpoint {
            version: env!("CARGO_PKG_VERSION").to_string(),
            problem: problem.clone(),
            samples: self.samples,
            snapshots: self.snapshots,
            steps: motion.steps(),
            energy,
            state: motion.saved(),
        };
        let path = self.path.join(CHECKPOINT);
        let beside = self.path.join("checkpoint.ron.new");
        let text = encode(&path, &checkpoint)?;
        fs::write(&beside, text).map_err(refused(&beside))?;
        fs::rename(&beside, &path).map_err(refused(&path))
    }

    /// Writes what was measured.
    pub fn measures(&self, measures: &[Measure]) -> Result<(), StoreError> {
        let mut text = String::from("name,value,error,from,to\n");
        for measure in measures {
            text.push_str(&format!(
                "{},{},{},{},{}\n",
                measure.name,
                tables::number(measure.value),
                tables::number(measure.error),
                tables::number(measure.window[0]),
                tables::number(measure.window[1]),
            ));
        }
        let path = self.path.join(MEASURES);
        fs::write(&path, text).map_err(refused(&path))
    }

    /// Writes eigenvalues by sector, each with its residual and its difference from a coarser grid.
    pub fn growth(&self, rows: &[(usize, Eigenvalue, f64)]) -> Result<(), StoreError> {
        let mut text = String::from("sector,re,im,residual,scatter,grid\n");
        for (sector, value, grid) in rows {
            text.push_str(&format!(
                "{sector},{},{},{},{},{}\n",
                tables::number(value.re),
                tables::number(value.im),
                tables::number(value.residual),
                tables::number(value.scatter),
                tables::number(*grid),
            ));
        }
        let path = self.path.join(GROWTH);
        fs::write(&path, text).map_err(refused(&path))
    }
}

/// The first rows of a time series, and the bytes they take with the header.
pub fn read_series(path: &Path, rows: usize) -> Result<(Vec<Sample>, usize), StoreError> {
    let damaged = |reason: &str| damaged(path, reason);
    let text = fs::read_to_string(path).map_err(refused(path))?;
    let mut length = 0;
    let mut samples = Vec::new();
    for (index, line) in text.split_inclusive('\n').enumerate() {
        if index > 0 {
            let mut numbers = [0.0; Sample::COLUMNS.len()];
            let mut cells = line.trim_end().split(',');
            for number in &mut numbers {
                let cell = cells.next().ok_or_else(|| damaged("a row is too short"))?;
                // what is not finite is left empty
                *number = match cell {
                    "" => f64::NAN,
                    cell => cell.parse().map_err(|_| damaged("a cell is no number"))?,
                };
            }
            samples.push(Sample::from_numbers(numbers));
        }
        length += line.len();
        if samples.len() == rows {
            break;
        }
    }
    if samples.len() < rows {
        return Err(damaged("fewer rows than the checkpoint says"));
    }
    Ok((samples, length))
}

/// Extensions of pictures.
const FORMATS: [&str; 3] = ["svg", "png", "pdf"];

/// Names of the pictures of a simulation, without extension.
pub const PICTURES: [&str; 3] = ["space_time", "phase_plane", "profiles"];

/// Removes what an earlier simulation wrote, and nothing else.
fn clear(path: &Path) -> Result<(), StoreError> {
    let known = [
        CHECKPOINT,
        "checkpoint.ron.new",
        SERIES,
        REGIMES,
        START,
        END,
        MEASURES,
        GROWTH,
    ];
    for entry in fs::read_dir(path).map_err(refused(path))?.flatten() {
        let file = entry.path();
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let picture = name
            .split_once('.')
            .is_some_and(|(stem, end)| PICTURES.contains(&stem) && FORMATS.contains(&end));
        if file.is_file() && (picture || known.contains(&name.as_ref())) {
            fs::remove_file(&file).map_err(refused(&file))?;
        }
    }
    remove_snapshots(&path.join(SNAPSHOTS), 0)
}

/// Removes snapshots beyond the last.
fn remove_snapshots(folder: &Path, last: usize) -> Result<(), StoreError> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let number: Option<usize> = entry
            .file_name()
            .to_str()
            .and_then(|name| name.strip_suffix(".npy").or(name.strip_suffix(".vtk")))
            .and_then(|number| number.parse().ok());
        if number.is_some_and(|number| number > last) {
            let path = entry.path();
            fs::remove_file(&path).map_err(refused(&path))?;
        }
    }
    Ok(())
}
