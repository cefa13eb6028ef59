//! The discretised ring against the exact eigenvalues: `cargo run --release --example discretised`.
//!
//! Slip-stick wave of mode 4 (ν = 0.3, ξ = 1.5, γ = 1, f = 0.5, δ = 0.2), n points per wavelength and
//! friction law tanh((1 − V̇)/ε). Prints the error of the leading eigenvalue of the Bloch sectors 0
//! to 2 as n grows and ε falls, observed orders, and run times. With a path as argument the table
//! goes there as CSV, and a picture beside it as SVG.

use std::ops::Range;
use std::path::Path;
use std::time::Instant;

use brakewave::discretised::{RingSettings, SemiDiscreteWave, solve};
use brakewave::tube::model::Model;
use brakewave::tube::model::coefficients::Geometry;
use faer::c64;
use plotters::coord::Shift;
use plotters::prelude::*;

type Failure = Box<dyn std::error::Error>;

const MODE: u32 = 4;
const POINTS: [usize; 4] = [50, 100, 200, 400];
const EPSILONS: [f64; 6] = [0.08, 0.04, 0.02, 0.01, 0.005, 0.0025];
/// Where the error of ε is far below that of the spacing.
const SMALLEST: f64 = 1e-5;
/// Roots of N(λ)e^{−λT} = e^{2πij/4} with the largest real part, sectors j = 0, 1, 2.
const EXACT: [c64; 3] = [
    c64::new(0.04965063748184, 2.541566892289),
    c64::new(0.1279698868278, 1.319591652955),
    c64::new(0.107573000269, 0.8365151274592),
];
/// |Im λ| looked at.
const HIGHEST: f64 = 12.0;
/// Repetitions of a time taken.
const REPETITIONS: usize = 7;

const MODEL: Model = Model::tube(
    Geometry {
        nu: 0.3,
        xi: 1.5,
        gamma: 1.0,
    },
    0.5,
    0.2,
);

/// What was found for one n and ε.
struct Row {
    points: usize,
    epsilon: f64,
    speed: f64,
    /// The eigenvalue next to the exact one in each sector.
    found: [c64; 3],
}

impl Row {
    fn error(&self, sector: usize) -> f64 {
        (self.found[sector] - EXACT[sector]).norm()
    }
}

fn main() -> Result<(), Failure> {
    let mut rows = table()?;
    print(&rows);
    orders(&rows);
    rows.extend(limit()?);
    times()?;
    if let Some(path) = std::env::args_os().nth(1) {
        let path = Path::new(&path);
        write(&rows, path)?;
        draw(&rows, &path.with_extension("svg"))?;
    }
    Ok(())
}

fn settings(points: usize, epsilon: f64) -> RingSettings {
    RingSettings {
        points,
        epsilon,
        ..RingSettings::default()
    }
}

/// The eigenvalue of a sector next to a given one.
fn nearest(wave: &SemiDiscreteWave, sector: u32, to: c64) -> Result<c64, Failure> {
    let distance = |value: &c64| (value - to).norm();
    wave.eigenvalues(sector, HIGHEST, usize::MAX)?
        .into_iter()
        .min_by(|one, other| distance(one).total_cmp(&distance(other)))
        .ok_or_else(|| "no eigenvalue in the window".into())
}

fn row(wave: &SemiDiscreteWave) -> Result<Row, Failure> {
    let mut found = EXACT;
    for (sector, found) in (0..).zip(&mut found) {
        *found = nearest(wave, sector, *found)?;
    }
    Ok(Row {
        points: wave.values.len(),
        epsilon: wave.epsilon,
        speed: wave.speed,
        found,
    })
}

fn table() -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for points in POINTS {
        let mut wave = solve(&MODEL, MODE, &settings(points, EPSILONS[0]))?;
        for epsilon in EPSILONS {
            wave = wave.with_epsilon(epsilon)?;
            rows.push(row(&wave)?);
        }
    }
    Ok(rows)
}

/// Both limits: ε so small that it no longer matters, and what the second order in Δφ extrapolates
/// from n and 2n.
fn limit() -> Result<Vec<Row>, Failure> {
    let mut rows: Vec<Row> = Vec::new();
    println!("ε = {SMALLEST:e}, errors at n and extrapolated from n/2 and n");
    for points in POINTS {
        let row = row(&solve(&MODEL, MODE, &settings(points, SMALLEST))?)?;
        print!("{points:>4}");
        for sector in 0..3 {
            print!(" {:>9.2e}", row.error(sector));
        }
        if let Some(before) = rows.last() {
            for ((found, before), exact) in row.found.iter().zip(before.found).zip(EXACT) {
                let extrapolated = found + (found - before) / 3.0;
                print!(" {:>9.2e}", (extrapolated - exact).norm());
            }
        }
        println!();
        rows.push(row);
    }
    println!();
    Ok(rows)
}

fn print(rows: &[Row]) {
    println!(
        "{:>4} {:>7} {:>13}  {:^21} {:^21} {:^21}  |λ − exact| in the sectors",
        "n", "ε", "c", "sector 0", "sector 1", "sector 2"
    );
    for row in rows {
        print!("{:>4} {:>7} {:>13.9} ", row.points, row.epsilon, row.speed);
        for found in row.found {
            print!(" {:>9.6} {:+10.6}i", found.re, found.im);
        }
        for sector in 0..3 {
            print!(" {:>9.2e}", row.error(sector));
        }
        println!();
    }
    print!("{:>26} ", "exact");
    for exact in EXACT {
        print!(" {:>9.6} {:+10.6}i", exact.re, exact.im);
    }
    println!("\n");
}

/// log₂ of the ratio of successive errors, or of successive differences where the limit differs
/// from the exact value.
fn orders(rows: &[Row]) {
    let at = |points: usize, epsilon: usize| {
        let index = POINTS.iter().position(|&other| other == points);
        &rows[index.unwrap_or(0) * EPSILONS.len() + epsilon]
    };
    println!("observed orders{:>29} {:>8} {:>8}", "sector 0", "1", "2");
    let line = |name: String, order: &dyn Fn(usize) -> f64| {
        println!(
            "{name:<36} {:>7.2} {:>8.2} {:>8.2}",
            order(0),
            order(1),
            order(2)
        );
    };
    let difference =
        |one: &Row, other: &Row, sector: usize| (one.found[sector] - other.found[sector]).norm();
    for (index, epsilon) in EPSILONS.iter().enumerate() {
        line(
            format!("Δφ at ε = {epsilon}, n = 100, 200, 400"),
            &|sector| {
                let [one, two, three] = [100, 200, 400].map(|points| at(points, index));
                (difference(one, two, sector) / difference(two, three, sector)).log2()
            },
        );
    }
    for first in 0..EPSILONS.len() - 2 {
        let [one, two, three] = [0, 1, 2].map(|next| at(400, first + next));
        line(format!("ε to {} at n = 400", three.epsilon), &|sector| {
            (difference(one, two, sector) / difference(two, three, sector)).log2()
        });
    }
    // n = 50 with the third ε, then both halved together
    for index in 1..POINTS.len() {
        let (one, two) = (
            at(POINTS[index - 1], index + 1),
            at(POINTS[index], index + 2),
        );
        line(
            format!("both, to n = {}, ε = {}", two.points, two.epsilon),
            &|sector| (one.error(sector) / two.error(sector)).log2(),
        );
    }
    println!();
}

fn median(mut work: impl FnMut() -> Result<(), Failure>) -> Result<f64, Failure> {
    let mut times = Vec::with_capacity(REPETITIONS);
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        work()?;
        times.push(1e3 * start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    Ok(times[REPETITIONS / 2])
}

fn times() -> Result<(), Failure> {
    println!(
        "{:>4} {:>7} {:>6} {:>6} {:>10} {:>14}   medians of {REPETITIONS}, one thread",
        "n", "ε", "newton", "steps", "wave/ms", "4 spectra/ms"
    );
    for (points, epsilon) in [(100, 0.01), (200, 0.005)] {
        let wave = solve(&MODEL, MODE, &settings(points, epsilon))?;
        let solving = median(|| {
            std::hint::black_box(solve(&MODEL, MODE, &settings(points, epsilon))?);
            Ok(())
        })?;
        let spectra = median(|| {
            for sector in 0..MODE {
                std::hint::black_box(wave.multipliers(sector)?);
            }
            Ok(())
        })?;
        println!(
            "{points:>4} {epsilon:>7} {:>6} {:>6} {solving:>10.1} {spectra:>14.1}",
            wave.newton,
            wave.time_steps()
        );
    }
    Ok(())
}

fn write(rows: &[Row], path: &Path) -> Result<(), Failure> {
    let mut writer = csv::Writer::from_path(path)?;
    let mut header = vec!["points".to_string(), "epsilon".into(), "speed".into()];
    for sector in 0..3 {
        header.extend(["re", "im", "error"].map(|name| format!("{name}_{sector}")));
    }
    writer.write_record(header)?;
    for row in rows {
        let mut record = vec![
            row.points.to_string(),
            row.epsilon.to_string(),
            row.speed.to_string(),
        ];
        for (sector, found) in row.found.iter().enumerate() {
            record.extend([found.re, found.im, row.error(sector)].map(|value| value.to_string()));
        }
        writer.write_record(record)?;
    }
    writer.flush()?;
    Ok(())
}

/// Error of sector 0 against n for every ε, and against ε for every n.
fn draw(rows: &[Row], path: &Path) -> Result<(), Failure> {
    let name = path.to_str().ok_or("the path is not Unicode")?;
    let root = SVGBackend::new(name, (850, 640)).into_drawing_area();
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(425);
    let select = |label: String, of: &dyn Fn(&Row) -> Option<f64>| Curve {
        label,
        line: rows
            .iter()
            .filter_map(|row| Some((of(row)?, row.error(0))))
            .collect(),
    };
    let in_points = EPSILONS.into_iter().chain([SMALLEST]).map(|epsilon| {
        select(format!("ε = {epsilon:?}"), &|row| {
            (row.epsilon == epsilon).then_some(row.points as f64)
        })
    });
    panel(
        &left,
        "points per wavelength n",
        40.0..500.0,
        SeriesLabelPosition::LowerLeft,
        in_points,
    )?;
    let in_epsilon = POINTS.into_iter().map(|points| {
        select(format!("n = {points}"), &|row| {
            (row.points == points && row.epsilon > SMALLEST).then_some(row.epsilon)
        })
    });
    panel(
        &right,
        "width of the friction law ε",
        0.002..0.1,
        SeriesLabelPosition::LowerRight,
        in_epsilon,
    )?;
    root.present()?;
    Ok(())
}

struct Curve {
    label: String,
    line: Vec<(f64, f64)>,
}

fn panel(
    area: &DrawingArea<SVGBackend, Shift>,
    title: &str,
    range: Range<f64>,
    legend: SeriesLabelPosition,
    curves: impl Iterator<Item = Curve>,
) -> Result<(), Failure> {
    const COLOURS: [RGBColor; 7] = [
        RGBColor(68, 1, 84),
        RGBColor(65, 68, 135),
        RGBColor(42, 120, 142),
        RGBColor(34, 168, 132),
        RGBColor(122, 190, 60),
        RGBColor(214, 170, 20),
        RGBColor(196, 60, 40),
    ];
    const ERRORS: Range<f64> = 5e-4..0.2;
    let label = ("sans-serif", 14);
    // 1, 2 and 5 of every decade
    let number = |value: &f64| {
        let leading = value / 10.0_f64.powf(value.log10().floor() + 1e-9);
        let shown = [1.0, 2.0, 5.0, 10.0]
            .iter()
            .any(|digit| (leading - digit).abs() < 0.01);
        if shown {
            format!("{}", (value * 1e6).round() / 1e6)
        } else {
            String::new()
        }
    };
    let mut chart = ChartBuilder::on(area)
        .margin(14)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(range.log_scale(), ERRORS.log_scale())?;
    chart
        .configure_mesh()
        .x_desc(title)
        .y_desc("|λ − λ exact|, sector 0")
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(label)
        .bold_line_style(RGBColor(225, 225, 225))
        .max_light_lines(0)
        .draw()?;
    for (curve, colour) in curves.zip(COLOURS) {
        chart
            .draw_series(LineSeries::new(curve.line, colour.stroke_width(2)).point_size(3))?
            .label(curve.label)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2)));
    }
    chart
        .configure_series_labels()
        .position(legend)
        .background_style(WHITE)
        .border_style(RGBColor(190, 190, 190))
        .label_font(label)
        .draw()?;
    Ok(())
}
