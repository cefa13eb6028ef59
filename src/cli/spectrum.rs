//! `brakewave spectrum`.

use std::path::PathBuf;

use clap::Args;

use super::progress::Progress;
use super::run::{Prepared, prepare};
use super::{Failure, NUMERICAL, print, spare, warn, write};
use crate::branch::EventType;
use crate::branch::row::{EigenfunctionRow, EigenvalueRow, WaveEigenvalueRow};
use crate::branch::run::{End, Item, Runner, answer};
use crate::linalg::Vector;
use crate::model::{FrictionLaw, Parameter};
use crate::problem::Problem;
use crate::stability::characteristic::Characteristic;
use crate::stability::discretised;
use crate::stability::eigenfunction::eigenfunction;
use crate::stability::spectrum::{Request, spectrum as compute, symmetric};
use crate::table;
use crate::wave::Wave;

#[derive(Debug, Args)]
pub struct SpectrumArguments {
    /// Problem file
    problem: PathBuf,
    /// Parameter value by its column, e.g. mismatch=0.045; the continuation parameter is reached
    /// along the branch, any other replaces the value in the file [default: the first wave]
    #[arg(long, value_name = "NAME=VALUE", value_parser = assignment)]
    at: Vec<(Parameter, f64)>,
    /// Bloch sector [default: those of the file, or all]
    #[arg(long, value_name = "J")]
    sector: Option<usize>,
    /// Which passage of the branch through the value, where it turns back
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    passage: u16,
    /// Eigenvalues of the discretised ring with N points per wavelength instead of the exact ones
    #[arg(long, value_name = "N", conflicts_with = "eigenfunctions", value_parser = ring_points, allow_negative_numbers = true)]
    discretised: Option<usize>,
    /// Width of the friction law tanh((1 − V̇)/ε) that the discretised ring has in place of Coulomb's
    /// [default: 0.005]; the law `Regularised` of a problem has its own
    #[arg(long, value_name = "EPSILON", requires = "discretised", value_parser = width, allow_negative_numbers = true)]
    epsilon: Option<f64>,
    /// Write the eigenfunctions on the full circle, as CSV
    #[arg(long, value_name = "FILE")]
    eigenfunctions: Option<PathBuf>,
}

/// Points per wavelength of a discretised ring.
fn ring_points(text: &str) -> Result<usize, String> {
    let (least, most) = (discretised::LEAST_POINTS, discretised::MOST_POINTS);
    let points: u128 = text
        .parse()
        .map_err(|_| format!("`{text}` is no number of points; take {least} to {most}"))?;
    if points < least as u128 {
        return Err(format!(
            "{points} points per wavelength do not resolve a wave; take {least} at least"
        ));
    }
    match usize::try_from(points) {
        Ok(points) if points <= most => Ok(points),
        _ => Err(format!(
            "the dense eigenvalue problem of {points} points per wavelength takes about {:.0} GB; \
             take {most} points at most",
            discretised::memory(points as f64) / 1e9
        )),
    }
}

/// Width of a smooth friction law.
fn width(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(width) if width.is_finite() && width > 0.0 => Ok(width),
        _ => Err("take a positive number such as 0.005".into()),
    }
}

/// The width of the friction law of a discretised ring: the problem's own, or what Coulomb's law is
/// smoothed with. Other laws are not posed.
fn smoothing(law: FrictionLaw, asked: Option<f64>) -> Result<f64, Failure> {
    match law {
        FrictionLaw::Coulomb => Ok(asked.unwrap_or(discretised::Settings::default().epsilon)),
        FrictionLaw::Regularised { epsilon } => match asked {
            None => Ok(epsilon),
            Some(_) => Err(Failure::Usage(format!(
                "--epsilon smooths Coulomb's law, but `friction_law` is Regularised(epsilon: \
                 {epsilon}); leave the option out, or give --at smoothing=VALUE"
            ))),
        },
        FrictionLaw::Static { .. } | FrictionLaw::Stribeck { .. } => Err(Failure::Usage(
            "`friction_law`: the discretised ring has Coulomb's law smoothed, or Regularised(…)\n  \
             help: leave out --discretised for the exact eigenvalues under this one"
                .into(),
        )),
    }
}

/// NAME=VALUE on the command line.
pub(super) fn assignment(text: &str) -> Result<(Parameter, f64), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("write NAME=VALUE, for example mismatch=0.045")?;
    let names = || {
        let names: Vec<&str> = Parameter::ALL.iter().map(|one| one.column()).collect();
        format!("`{name}` is no parameter; known: {}", names.join(", "))
    };
    let parameter = Parameter::from_column(name.trim()).ok_or_else(names)?;
    let value: f64 = value
        .trim()
        .parse()
        .map_err(|_| format!("`{value}` is not a number"))?;
    if !value.is_finite() {
        return Err(format!("{value} is not finite"));
    }
    Ok((parameter, value))
}

/// Steps in which other passages are looked for, at least.
const STEPS_BEYOND: usize = 2000;

/// Intervals of an eigenfunction over one wavelength.
const RESOLUTION: usize = 180;

pub fn spectrum(arguments: &SpectrumArguments) -> Result<u8, Failure> {
    let Prepared {
        mut problem,
        mut continuation,
        restart,
        source,
    } = prepare(&arguments.problem)?;
    if let Some(path) = &arguments.eigenfunctions {
        spare(path, std::slice::from_ref(&arguments.problem))?;
    }
    if arguments.discretised.is_some() {
        smoothing(problem.model.law, arguments.epsilon)?;
    }
    let mode = problem.wave.mode as usize;
    if let Some(sector) = arguments.sector
        && sector >= mode
    {
        return Err(Failure::Usage(format!(
            "there is no Bloch sector {sector} for mode {mode}: take 0 to {}",
            mode - 1
        )));
    }
    let mut request = problem.request().unwrap_or_else(|| Request {
        sectors: (0..=mode / 2).collect(),
        eigenvalues: crate::problem::DEFAULT_EIGENVALUES,
        max_frequency: crate::problem::DEFAULT_MAX_FREQUENCY,
    });
    if let Some(sector) = arguments.sector {
        request.sectors = vec![sector];
    }
    // the branch itself needs no stability
    problem.stability = None;
    let mut target = None;
    for (parameter, value) in &arguments.at {
        if *parameter == continuation.parameter {
            target = Some(*value);
        } else {
            set(&mut problem, *parameter, *value)?;
        }
    }
    continuation.stop_at.clear();
    continuation.stop_after.clear();
    if let Some(value) = target {
        let (low, high) = continuation.range;
        if !(value >= low && value <= high) {
            return Err(Failure::Usage(format!(
                "{} = {value} lies outside the range from {low} to {high} of the problem",
                continuation.parameter.column()
            )));
        }
        if value > low && value < high {
            continuation.stop_at.push(value);
        }
    }
    // a value of the command line is on no line of the file
    let of_file = arguments
        .at
        .iter()
        .all(|(one, _)| *one == continuation.parameter);
    let mut branch = Runner::begin(&problem, &continuation, restart.as_ref()).map_err(|error| {
        if of_file {
            source.place(error)
        } else {
            error.into()
        }
    })?;
    let column = continuation.parameter;
    let passage = usize::from(arguments.passage);
    let mut passages = 0;
    let mut reached: Option<Item> = None;
    let (mut steps, mut most) = (0, usize::MAX);
    let mut progress = Progress::new(false);
    while branch.progress().end.is_none() && steps < most {
        steps += 1;
        progress.show(f64::NAN, || {
            format!("{} points on the way", branch.progress().points)
        });
        for item in branch.step() {
            let here = item
                .saved
                .as_ref()
                .and_then(|saved| saved.model.value(column));
            let meets = target.is_none() || (item.point.label.is_some() && here == target);
            if meets && item.point.kind != Some(EventType::MX) {
                passages += 1;
                if passages == passage || (target.is_none() && reached.is_none()) {
                    reached = Some(item);
                    // whether there are others: as far again as it was to come here
                    most = match target {
                        Some(_) => 2 * steps + STEPS_BEYOND,
                        None => steps,
                    };
                }
            }
        }
    }
    drop(progress);
    if let (Some(value), Some(_)) = (target, &reached) {
        let more = branch.progress().end.is_none();
        let name = column.column();
        if passages > 1 {
            let least = if more { "at least " } else { "" };
            warn(&format!(
                "the branch passes {name} = {value} {least}{passages} times; this is passage \
                 {passage}, `--passage N` takes another"
            ));
        } else if more {
            warn(&format!(
                "whether the branch passes {name} = {value} again was looked for in {steps} steps \
                 only; `--passage 2` goes on"
            ));
        }
    }
    let Some(item) = reached else {
        let reason = match &branch.progress().end {
            Some(End::Failed(reason)) => format!(": {reason}"),
            _ => String::new(),
        };
        warn(&format!(
            "the branch passes {} = {} only {passages} times{reason}",
            column.column(),
            target.unwrap_or(f64::NAN)
        ));
        return Ok(NUMERICAL);
    };
    let (wave, unknowns) = item.wave();
    if let Some(points) = arguments.discretised {
        let settings = discretised::Settings {
            points,
            // where the branch has come, should ε be its parameter
            epsilon: smoothing(wave.model_at(unknowns).law, arguments.epsilon)?,
            ..discretised::Settings::default()
        };
        return match ring(wave, unknowns, &settings, &request, &item) {
            Ok(text) => print(&text).map(|()| 0),
            Err(error) => {
                warn(&error.to_string());
                Ok(NUMERICAL)
            }
        };
    }
    let characteristic = match Characteristic::new(wave, unknowns) {
        Ok(characteristic) => characteristic,
        Err(error) => {
            warn(&error.to_string());
            return Ok(NUMERICAL);
        }
    };
    let spectrum = compute(&characteristic, &request, None);
    let mut point = item.point.clone();
    answer(&mut point, Some(&spectrum), wave, unknowns);
    let mut text = table::header::<WaveEigenvalueRow>();
    let mut modes = table::header::<EigenfunctionRow>();
    for sector in &spectrum.sectors {
        for eigenvalue in spectrum.listed(sector).take(request.eigenvalues) {
            let row = EigenvalueRow {
                sector: sector.sector,
                re: eigenvalue.re,
                im: eigenvalue.im,
                error: eigenvalue.error,
            };
            text.push_str(&table::line(&WaveEigenvalueRow::new(row, &point)));
            if arguments.eigenfunctions.is_some() {
                let mode = eigenfunction(
                    &characteristic,
                    item.point.speed,
                    sector.sector,
                    eigenvalue.value(),
                    RESOLUTION,
                );
                for sample in mode.samples {
                    modes.push_str(&table::line(&EigenfunctionRow {
                        sector: row.sector,
                        re: row.re,
                        im: row.im,
                        theta: sample.theta,
                        psi_re: sample.psi.re,
                        psi_im: sample.psi.im,
                        slope_re: sample.slope.re,
                        slope_im: sample.slope.im,
                    }));
                }
            }
        }
    }
    print(&text)?;
    if let Some(path) = &arguments.eigenfunctions {
        write(path, &modes)?;
    }
    for reason in &spectrum.reasons {
        warn(&format!("stable: {}: {reason}", spectrum.stable.word()));
    }
    if spectrum.sectors.is_empty() {
        return Ok(NUMERICAL);
    }
    Ok(0)
}

/// The same table from the discretised ring; it gives no error of its own and no verdict.
fn ring(
    wave: &Wave,
    unknowns: &Vector,
    settings: &discretised::Settings,
    request: &Request,
    item: &Item,
) -> Result<String, discretised::Error> {
    let ring = discretised::solve_from(wave, unknowns, settings)?;
    let mut point = item.point.clone();
    point.speed = ring.speed;
    let mut text = table::header::<WaveEigenvalueRow>();
    for &sector in &request.sectors {
        let symmetric = symmetric(sector, wave.mode);
        let all = ring.eigenvalues(sector as u32, request.max_frequency, usize::MAX)?;
        // the translation mode is the one nearest to zero
        let translation = (sector == 0).then(|| {
            all.iter()
                .map(|value| value.norm())
                .fold(f64::INFINITY, f64::min)
        });
        let listed = all
            .into_iter()
            .filter(|value| translation != Some(value.norm()))
            .filter(|value| !symmetric || value.im >= 0.0);
        for value in listed.take(request.eigenvalues) {
            let row = EigenvalueRow {
                sector,
                re: value.re,
                im: value.im,
                error: f64::NAN,
            };
            text.push_str(&table::line(&WaveEigenvalueRow::new(row, &point)));
        }
    }
    Ok(text)
}

/// Replaces a parameter of the model, under the rules of a problem file.
pub(super) fn set(problem: &mut Problem, parameter: Parameter, value: f64) -> Result<(), Failure> {
    let model = &mut problem.model;
    let refused = |rule: &str| {
        Err(Failure::Usage(format!(
            "{} = {value} is not admitted: {rule}",
            parameter.column()
        )))
    };
    if model.value(parameter).is_none() {
        return refused("the model has no such parameter");
    }
    if !(parameter.admits(value) && value.is_finite()) {
        return refused(&parameter.rule());
    }
    *model = model.with(parameter, value);
    Ok(())
}
