//! `brakewave spectrum`.

use std::io::{self, IsTerminal};
use std::path::PathBuf;

use clap::Args;
use faer::c64;

use super::failure::{Usage, VerbExit, VerbFailure};
use super::options::{assignment, once, picture, positive, set, spare, write};
use super::prepare::{Prepared, prepare};
use super::progress::drive;
use super::{print, stopped, summary, warn};
use crate::branch::BranchPoint;
use crate::branch::passage::PassageSearch;
use crate::branch::row::{EigenfunctionRow, EigenvalueRow, WaveEigenvalueRow};
use crate::branch::run::{End, WaveItem, answer};
use crate::discretised;
use crate::orbit::Stability;
use crate::output::pictures;
use crate::problem::{Problem, StabilitySection};
use crate::table;
use crate::tube::model::{FrictionLaw, Parameter};
use crate::tube::stability::characteristic::Characteristic;
use crate::tube::stability::eigenfunction::eigenfunction;
use crate::tube::stability::spectrum::{SpectrumRequest, spectrum as compute};

#[derive(Debug, Args)]
pub(crate) struct SpectrumArguments {
    /// Problem file; - reads standard input
    problem: PathBuf,
    /// Parameter value by its column, e.g. mismatch=0.045; the continuation parameter is reached
    /// along the branch, any other replaces the value in the file [default: the first wave]
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    at: Vec<(Parameter, f64)>,
    /// CSV on a terminal too
    #[arg(long)]
    csv: bool,
    /// Bloch sector [default: those of the file, or all]
    #[arg(long, value_name = "J")]
    sector: Option<usize>,
    /// Which passage of the branch through the value of --at, where it turns back [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    passage: Option<u16>,
    /// Eigenvalues of the discretised ring with N points per wavelength instead of the exact ones
    #[arg(long, value_name = "N", conflicts_with = "eigenfunctions", value_parser = ring_points, allow_negative_numbers = true)]
    discretised: Option<usize>,
    /// Width of the friction law tanh((1 − V̇)/ε) that the discretised ring has in place of Coulomb's
    /// [default: 0.005]; the law `Regularised` of a problem has its own
    #[arg(long, value_name = "EPSILON", requires = "discretised", value_parser = positive, allow_negative_numbers = true)]
    epsilon: Option<f64>,
    /// Draw the multipliers of the discretised ring, the exact ones over them: FILE.svg, .png or .pdf
    #[arg(long, value_name = "FILE", requires = "discretised")]
    plot: Option<PathBuf>,
    /// Write the eigenfunctions on the full circle, as CSV
    #[arg(long, value_name = "FILE")]
    eigenfunctions: Option<PathBuf>,
}

/// Points per wavelength of a discretised ring.
fn ring_points(text: &str) -> Result<usize, Usage> {
    let points: u128 = text.parse().map_err(|_| Usage::Points(text.to_owned()))?;
    if points < discretised::LEAST_POINTS as u128 {
        return Err(Usage::FewPoints(points));
    }
    let within = usize::try_from(points).ok();
    within
        .filter(|points| *points <= discretised::MOST_POINTS)
        .ok_or(Usage::ManyPoints(points))
}

/// The width of the friction law of a discretised ring: the problem's own, or what the sign of the sliding
/// velocity is smoothed with under Coulomb's and Stribeck's. Static friction is not posed.
fn smoothing(law: FrictionLaw, asked: Option<f64>) -> Result<f64, Usage> {
    match (law, asked) {
        (FrictionLaw::Coulomb | FrictionLaw::Stribeck { .. }, asked) => {
            Ok(asked.unwrap_or(discretised::RingSettings::default().epsilon))
        }
        (FrictionLaw::Regularised { epsilon }, None) => Ok(epsilon),
        (FrictionLaw::Regularised { epsilon }, Some(_)) => Err(Usage::OwnWidth(epsilon)),
        (FrictionLaw::Static { .. }, _) => Err(Usage::LawOfRing),
    }
}

/// Intervals of an eigenfunction over one wavelength.
const RESOLUTION: usize = 180;

/// The sectors, eigenvalues and frequencies that are asked for.
fn request(problem: &Problem, sector: Option<usize>) -> Result<SpectrumRequest, Usage> {
    let mode = problem.wave.mode as usize;
    let assumed = || StabilitySection::of(&problem.model).request(problem.wave.mode);
    let mut request = problem.request().unwrap_or_else(assumed);
    match sector {
        Some(sector) if sector >= mode => return Err(Usage::Sector { sector, mode }),
        Some(sector) => request.sectors = vec![sector],
        None => {}
    }
    Ok(request)
}

pub(crate) fn spectrum(arguments: &SpectrumArguments) -> Result<VerbExit, VerbFailure> {
    let mut prepared = prepare(&arguments.problem)?;
    let Prepared {
        problem,
        continuation,
        ..
    } = &mut prepared;
    if let Some(path) = &arguments.eigenfunctions {
        spare(path, std::slice::from_ref(&arguments.problem))?;
    }
    if arguments.discretised.is_some() {
        smoothing(problem.model.law, arguments.epsilon)?;
    }
    let request = request(problem, arguments.sector)?;
    // the branch itself needs no stability
    problem.stability = None;
    let parameter = continuation.parameter;
    once(&arguments.at)?;
    let mut target = None;
    // a value of the command line is on no line of the file
    let mut of_file = true;
    for &(other, value) in &arguments.at {
        if other == parameter {
            target = Some(value);
        } else {
            set(problem, other, value)?;
            of_file = false;
        }
    }
    if target.is_none() && arguments.passage.is_some() {
        return Err(Usage::Passage(parameter.column()).into());
    }
    continuation.stop_at.clear();
    continuation.stop_after.clear();
    if let Some(value) = target {
        let range = continuation.range;
        if !(value >= range.0 && value <= range.1) {
            return Err(Usage::OutOfRange {
                parameter,
                value,
                range,
            }
            .into());
        }
        if value > range.0 && value < range.1 {
            continuation.stop_at.push(value.into());
        }
    }
    let branch = match of_file {
        true => prepared.begin(false)?,
        false => prepared.start(false, &prepared.problem)?,
    };
    let wanted = arguments.passage.unwrap_or(1);
    let mut passage = PassageSearch::new(branch, target, wanted.into());
    drive(false, || {
        let words = |passage: &PassageSearch| format!("{} points on the way", passage.points());
        Ok(passage.step().then(|| (f64::NAN, words(&passage))))
    })?;
    if let Some(value) = target {
        remark(&passage, parameter, value, wanted);
    }
    match passage.found() {
        None => Ok(VerbExit::Numerical),
        Some(item) => match arguments.discretised {
            None => write_spectrum(item, &request, arguments),
            Some(points) => write_ring(item, &request, &prepared.problem, arguments, points),
        },
    }
}

/// What is to be known of other passages, and why there is none.
fn remark(passage: &PassageSearch, parameter: Parameter, value: f64, wanted: u16) {
    let (name, passages, steps) = (parameter.column(), passage.passages(), passage.steps());
    let more = passage.end().is_none();
    if passage.found().is_none() {
        let reason = match passage.end() {
            Some(End::Failed(reason)) => format!(": {reason}"),
            _ => String::new(),
        };
        warn(&format!(
            "the branch passes {name} = {value} only {passages} times{reason}"
        ));
    } else if passages > 1 {
        let least = if more { "at least " } else { "" };
        warn(&format!(
            "the branch passes {name} = {value} {least}{passages} times; this is passage {wanted}, \
             `--passage N` takes another"
        ));
    } else if more {
        warn(&format!(
            "whether the branch passes {name} = {value} again was looked for in {steps} steps only; \
             `--passage 2` goes on"
        ));
    }
}

/// The eigenvalues of the discretised ring on standard output, and its multipliers as a picture.
fn write_ring(
    item: &WaveItem,
    request: &SpectrumRequest,
    problem: &Problem,
    arguments: &SpectrumArguments,
    points: usize,
) -> Result<VerbExit, VerbFailure> {
    let (wave, unknowns) = item.wave();
    let settings = discretised::RingSettings {
        points,
        // where the branch has come, should ε be its parameter
        epsilon: smoothing(wave.model_at(unknowns).law, arguments.epsilon)?,
        ..discretised::RingSettings::default()
    };
    let inputs = std::slice::from_ref(&arguments.problem);
    let picture = picture(arguments.plot.as_deref(), inputs)?;
    let everything = SpectrumRequest {
        eigenvalues: usize::MAX,
        max_frequency: f64::INFINITY,
        ..request.clone()
    };
    let solved = discretised::solve_from(wave, unknowns, &settings).and_then(|ring| {
        let all = picture.map(|_| ring.leading(&everything)).transpose()?;
        Ok((ring.leading(request)?, all, ring))
    });
    let (values, all, ring) = match solved {
        Ok(solved) => solved,
        Err(error) => return stopped(&error),
    };
    if let (Some(file), Some(all)) = (picture, all) {
        let exact = Characteristic::new(wave, unknowns).ok();
        let exact = exact.map(|exact| compute(&exact, request, None));
        let exact = exact.iter().flat_map(|exact| {
            let leading = exact.leading(request.eigenvalues);
            leading.map(|(sector, eigenvalue)| (sector, eigenvalue.value()))
        });
        let exact: Vec<(usize, c64)> = exact.collect();
        let drawn = pictures::multipliers::discretised(&all, &exact, points, ring.period());
        pictures::save(file, problem, drawn)?;
    }
    let row = |(sector, value): (usize, c64)| EigenvalueRow {
        sector,
        re: value.re,
        im: value.im,
        // the ring gives no error of its own
        error: f64::NAN,
    };
    let eigenvalues: Vec<EigenvalueRow> = values.into_iter().map(row).collect();
    let mut point = item.point.clone();
    point.speed = ring.speed;
    print(&eigenvalue_table(&eigenvalues, &point, arguments.csv))?;
    Ok(VerbExit::Done)
}

/// The eigenvalues of a wave on standard output, and its eigenfunctions where they are asked for.
fn write_spectrum(
    item: &WaveItem,
    request: &SpectrumRequest,
    arguments: &SpectrumArguments,
) -> Result<VerbExit, VerbFailure> {
    let (wave, unknowns) = item.wave();
    let characteristic = match Characteristic::new(wave, unknowns) {
        Ok(characteristic) => characteristic,
        Err(error) => return stopped(&error),
    };
    let spectrum = compute(&characteristic, request, None);
    let mut point = item.point.clone();
    answer(&mut point, Some(&spectrum), wave, unknowns);
    let eigenvalues: Vec<EigenvalueRow> = spectrum
        .leading(request.eigenvalues)
        .map(|(sector, eigenvalue)| EigenvalueRow::new(sector, eigenvalue))
        .collect();
    print(&eigenvalue_table(&eigenvalues, &point, arguments.csv))?;
    if let Some(path) = &arguments.eigenfunctions {
        let modes = eigenvalues.iter().flat_map(|row| {
            let value = c64::new(row.re, row.im);
            let mode = eigenfunction(&characteristic, point.speed, row.sector, value, RESOLUTION);
            let samples = mode.samples.into_iter();
            samples.map(|sample| EigenfunctionRow {
                sector: row.sector,
                re: row.re,
                im: row.im,
                theta: sample.theta,
                psi_re: sample.psi.re,
                psi_im: sample.psi.im,
                slope_re: sample.slope.re,
                slope_im: sample.slope.im,
            })
        });
        write(path, &table::table(modes))?;
    }
    for reason in &spectrum.reasons {
        warn(&format!("stable: {}: {reason}", spectrum.stable.word()));
    }
    Ok(match spectrum.sectors.is_empty() {
        true => VerbExit::Numerical,
        false => VerbExit::Done,
    })
}

/// The table of the eigenvalues; a terminal shows what all rows have in common in a line above it.
fn eigenvalue_table(eigenvalues: &[EigenvalueRow], point: &BranchPoint, csv: bool) -> String {
    let rows = eigenvalues.iter();
    let text = table::table(rows.map(|row| WaveEigenvalueRow::new(*row, point)));
    let shown = summary::table(text, csv, &["sector", "re", "im", "error"]);
    if csv || !io::stdout().is_terminal() {
        return shown;
    }
    let stable = point.stable.map_or("", Stability::word);
    format!(
        "{}, c = {:.12}, stable: {stable}\n\n{shown}",
        point.regimes, point.speed
    )
}
