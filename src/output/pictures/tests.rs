//! Tests of the pictures as files.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::profile::Profiles;
use super::tables::Tables;
use super::{PlotError, describe};
use crate::output::render::{Extent, Format, Layer, Picture, Point, number};
use crate::output::store::{MANIFEST, Store, StoreError};
use crate::problem::{self, Plot, Problem};

mod branch;

const BRANCH: &str = "point,label,type,regimes,mismatch,friction,mass_damping,stiffness_damping,\
gamma,nu,xi,speed,switches,min_pressure,max_gap,amplitude,stable,unstable,lead_re,lead_im,\
lead_sector,newton,residual,leg\n";

const PROFILE: &str = "theta,U,V,U_dot,V_dot,P,Q,regime
0,0.1,0.0,0,1,0.2,0.06,slip
0.2,0.1,0.1,0,-1,0.2,0.06,slip
0.3,0.1,0.05,0,0.2,0,0,slip
0.3,0.1,0.05,0,0.2,0,0,separation
0.4,0.13,0.02,0,0.8,0,0,separation
0.5,0.1,0,0,1,0,0,separation
0.5,0.1,0,0,1,0.1,0.01,stick
0.78,0.1,0,0,1,0.2,0.06,stick
";

fn row(label: &str, kind: &str, mismatch: f64, stable: &str, leg: usize) -> String {
    format!(
        "1,{label},{kind},slip-stick,{mismatch},0.3,0,0,1,0.3,0.9,{speed},0.4 0.78,0.1,0,0.2,\
         {stable},,,,,3,1e-12,{leg}\n",
        speed = -1.24 - 0.01 * mismatch
    )
}

fn folder(rows: &[String]) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(
        folder.path().join("branch.csv"),
        format!("{BRANCH}{}", rows.concat()),
    )
    .unwrap();
    folder
}

fn add_profiles(folder: &Path) {
    let profiles = folder.join("profiles");
    fs::create_dir(&profiles).unwrap();
    for label in 1..=3 {
        fs::write(profiles.join(format!("{label}.csv")), PROFILE).unwrap();
    }
}

/// A problem that asks for these pictures.
fn problem(plots: &[Plot]) -> Problem {
    let text = "(
        model: (coefficients: Geometry(nu: 0.3, xi: 1.5, gamma: 1.0), friction: 0.3, mismatch: 0.2),
        wave: (mode: 8, start: Fast),
        continuation: (parameter: Mismatch, range: (0.1, 0.2), toward: Down),
    )";
    let mut problem = problem::parse(text, "a test").unwrap();
    problem.output.plots = plots.to_vec();
    problem
}

fn draw_of(folder: &Path, problem: &Problem, format: Format) -> Result<Vec<PathBuf>, PlotError> {
    let manifest = "brakewave 0.0.0\nrun of problem 0\n";
    fs::write(folder.join(MANIFEST), manifest).unwrap();
    super::draw(&Store::visit(folder).unwrap(), Some(problem), format)
}

fn draw(folder: &Path, plots: &[Plot], format: Format) -> Result<Vec<PathBuf>, PlotError> {
    draw_of(folder, &problem(plots), format)
}

fn all() -> Vec<Plot> {
    let column = |name: &str| Plot::Column(name.to_owned());
    vec![
        Plot::Diagram,
        Plot::Pressure,
        Plot::Displacement,
        Plot::Wave,
        Plot::PhasePlane,
        Plot::Friction,
        Plot::Spectrum,
        Plot::Multipliers,
        column("amplitude"),
        column("lead_re"),
        column("switches"),
    ]
}

/// Whether an error is this one of a folder.
fn is(error: &PlotError, wanted: impl Fn(&StoreError) -> bool) -> bool {
    matches!(error, PlotError::Store(error) if wanted(error))
}

fn svg(folder: &TempDir, picture: Plot) -> String {
    let files = draw(folder.path(), &[picture], Format::Svg).unwrap();
    fs::read_to_string(&files[0]).unwrap()
}

/// The value of a picture.
fn picture(folder: &TempDir, plot: Plot) -> Picture {
    let tables = Tables::read(folder.path(), "mismatch").unwrap();
    let profiles = Profiles::read(folder.path(), &tables, &[]).unwrap();
    describe(&plot, &tables, &profiles).unwrap()
}

/// All that is drawn, panel by panel.
fn layers(picture: &Picture) -> Vec<&Layer> {
    picture
        .panels
        .iter()
        .flat_map(|panel| &panel.layers)
        .collect()
}

/// Number of points drawn as marks.
fn marks(picture: &Picture) -> usize {
    let count = |layer: &&Layer| match layer {
        Layer::Marks(points, _) => points.len(),
        _ => 0,
    };
    layers(picture).iter().map(count).sum()
}

fn captions(picture: &Picture) -> Vec<String> {
    let panels = picture.panels.iter();
    let axes = panels.flat_map(|panel| [&panel.x, &panel.y]);
    axes.map(|axis| axis.quantity.caption()).collect()
}

/// Headings and texts of the legend.
fn explanations(picture: &Picture) -> Vec<&str> {
    let groups = picture.legend.groups.iter();
    let texts = groups.flat_map(|group| {
        let entries = group.entries.iter().map(|entry| entry.1.as_str());
        [group.heading.as_str()].into_iter().chain(entries)
    });
    texts.filter(|text| !text.is_empty()).collect()
}

#[test]
fn short_branches_give_every_picture() {
    for count in 0..3 {
        let rows: Vec<String> = (0..count)
            .map(|index| row("", "", 0.1 * f64::from(index), "", 1))
            .collect();
        let folder = folder(&rows);
        let files = draw(folder.path(), &all(), Format::Svg).unwrap();
        assert_eq!(files.len(), all().len());
        for file in files {
            let text = fs::read_to_string(&file).unwrap();
            assert!(text.starts_with("<svg "), "{}", file.display());
            assert!(text.trim_end().ends_with("</svg>"), "{}", file.display());
        }
    }
}

#[test]
fn what_is_missing_is_said() {
    let folder = folder(&[]);
    for (plot, remark) in [
        (Plot::Diagram, "the branch has no points"),
        (
            Plot::Column("switches".to_owned()),
            "the branch has no points",
        ),
        (Plot::Pressure, "no profiles were asked for"),
        (Plot::Displacement, "no profiles were asked for"),
        (Plot::Wave, "no profiles were asked for"),
        (Plot::PhasePlane, "no profiles were asked for"),
        (Plot::Friction, "no profiles were asked for"),
        (Plot::Spectrum, "no spectrum was asked for"),
        (Plot::Multipliers, "no spectrum was asked for"),
    ] {
        let wanted = Layer::Remark(remark.to_owned());
        assert!(
            layers(&picture(&folder, plot.clone())).contains(&&wanted),
            "{plot:?}"
        );
        assert!(svg(&folder, plot).contains(remark));
    }
}

#[test]
fn files_are_named_after_their_pictures() {
    let folder = folder(&[row("", "", 0.1, "", 1)]);
    let files = draw(folder.path(), &all(), Format::Svg).unwrap();
    let expected: Vec<PathBuf> = [
        "diagram",
        "pressure",
        "displacement",
        "wave",
        "phase_plane",
        "friction",
        "spectrum",
        "multipliers",
        "column_amplitude",
        "column_lead_re",
        "column_switches",
    ]
    .iter()
    .map(|name| folder.path().join(format!("{name}.svg")))
    .collect();
    assert_eq!(files, expected);
}

#[test]
fn unknown_columns_are_refused_with_the_known_ones() {
    let folder = folder(&[row("", "", 0.1, "", 1)]);
    for name in ["height", "regimes", "../speed"] {
        let pictures = [Plot::Column(name.to_owned())];
        let error = draw(folder.path(), &pictures, Format::Svg).unwrap_err();
        assert!(is(&error, |error| matches!(
            error,
            StoreError::Refused { .. }
        )));
        assert!(error.to_string().contains("amplitude"), "{error}");
    }
    let refused = Tables::read(folder.path(), "switches").map(|_| ());
    assert!(matches!(refused, Err(StoreError::Refused { .. })));
}

#[test]
fn unfinished_last_rows_are_ignored() {
    let whole = [row("", "", 0.1, "", 1), row("", "", 0.2, "", 1)];
    let expected = svg(&folder(&whole), Plot::Diagram);
    for cut in ["1,,,slip-st", "1,,,slip-stick,9.5,0.3,0", "1,,,\"slip"] {
        let mut rows = whole.to_vec();
        rows.push(cut.to_owned());
        assert_eq!(svg(&folder(&rows), Plot::Diagram), expected);
    }
    let mut rows = whole.to_vec();
    rows.push(row("", "", 9.5, "", 1).trim_end().to_owned());
    assert_eq!(svg(&folder(&rows), Plot::Diagram), expected);
}

#[test]
fn profiles_are_drawn() {
    let rows = [
        row("1", "EP", 0.1, "", 1),
        row("2", "UZ", 0.2, "", 1),
        row("3", "EP", 0.3, "", 1),
    ];
    let folder = folder(&rows);
    add_profiles(folder.path());
    let pressure = picture(&folder, Plot::Pressure);
    assert_eq!(captions(&pressure), ["position θ", "pressure P"]);
    assert_eq!(explanations(&pressure), ["δ =", "0.1", "0.2", "0.3"]);
    let plane = picture(&folder, Plot::PhasePlane);
    assert!(explanations(&plane).contains(&"stick, V\u{307} = 1"));
    let displacement = picture(&folder, Plot::Displacement);
    assert_eq!(
        captions(&displacement),
        ["position θ", "U − δ at mismatch δ"]
    );
    // two changes of regime on each of three waves, joined with those of the next
    assert_eq!(marks(&displacement), 6);
    assert!(explanations(&displacement).contains(&"switching points"));
    let friction = picture(&folder, Plot::Friction);
    assert_eq!(captions(&friction)[1], "friction force Q");
    assert_eq!(captions(&friction)[3], "velocity 1 − V\u{307}");
    for wanted in ["at δ = 0.1:", "Q", "±f P", "slip", "separation", "stick"] {
        assert!(explanations(&friction).contains(&wanted), "{wanted}");
    }
    // what is in the value is in the file
    for plot in all() {
        let (value, text) = (picture(&folder, plot.clone()), svg(&folder, plot));
        for wanted in explanations(&value) {
            assert!(text.contains(wanted), "{wanted}");
        }
    }
}

#[test]
fn incomplete_profiles_are_refused_by_name() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1)]);
    let profiles = folder.path().join("profiles");
    fs::create_dir(&profiles).unwrap();
    fs::write(profiles.join("1.csv"), "theta,U\n0,1\n").unwrap();
    let error = draw(folder.path(), &[Plot::Pressure], Format::Svg).unwrap_err();
    assert!(error.to_string().contains("1.csv"), "{error}");
    assert!(is(&error, |error| matches!(
        error,
        StoreError::Damaged { .. }
    )));
}

#[test]
fn spectrum_names_sectors_and_labels() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
    fs::write(
        folder.path().join("spectrum.csv"),
        "label,sector,re,im,error\n1,0,-0.1,1,0\n1,3,0.1,2,0\n2,0,-0.2,NaN,0\n2,0,-0.2,1,0\n",
    )
    .unwrap();
    let spectrum = picture(&folder, Plot::Spectrum);
    assert_eq!(captions(&spectrum), ["Re λ", "Im λ"]);
    let wanted = ["sector", "0", "3", "δ =", "0.1 [1]", "0.2 [2]"];
    assert_eq!(explanations(&spectrum), wanted);
    assert_eq!(marks(&spectrum), 3);
}

/// The multipliers of a spectrum of a wave of which eight go round.
fn multipliers(spectrum: &str) -> Picture {
    let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
    fs::write(
        folder.path().join("spectrum.csv"),
        format!("label,sector,re,im,error\n{spectrum}2,0,-0.1,5,0\n"),
    )
    .unwrap();
    picture(&folder, Plot::Multipliers)
}

/// Where the leading eigenvalue is known along the branch, the modulus of its multiplier is drawn over the parameter: exp(Re λ T) with
/// T = 2π/(k|c|).
#[test]
fn the_leading_multiplier_is_shown_along_the_branch() {
    let lambda = [(0.1, 3.0), (-0.02, 2.9)];
    let rows = [0.1, 0.2]
        .into_iter()
        .zip(lambda)
        .map(|(mismatch, (re, im))| {
            let row = row("", "", mismatch, "no", 1);
            row.replacen("no,,,,,", &format!("no,1,{re},{im},3,"), 1)
        });
    let labelled = row("1", "EP", 0.3, "", 1);
    let folder = folder(&rows.chain([labelled]).collect::<Vec<_>>());
    let spectrum = "label,sector,re,im,error\n1,0,-0.1,5,0\n";
    fs::write(folder.path().join("spectrum.csv"), spectrum).unwrap();
    let picture = picture(&folder, Plot::Multipliers);
    assert_eq!(captions(&picture), ["Re μ", "Im μ", "mismatch δ", "|μ|"]);
    let lines = picture.panels[1]
        .layers
        .iter()
        .filter_map(|layer| match layer {
            Layer::Line(points, _) => Some(points.clone()),
            _ => None,
        });
    let drawn: Vec<Point> = lines
        .flatten()
        .filter(|point| point.1.is_finite())
        .collect();
    assert_eq!(drawn.len(), 2);
    for ((mismatch, (growth, _)), place) in [0.1, 0.2].into_iter().zip(lambda).zip(drawn) {
        let period = std::f64::consts::TAU / (8.0 * (1.24 + 0.01 * mismatch));
        let size = f64::exp(growth * period);
        assert!(
            (place.0 - mismatch).hypot(place.1 - size) < 1e-12,
            "{place:?}"
        );
    }
    assert_eq!(points(&picture, 0).len(), 2);
}

/// Points of a panel without the cross at 1.
fn points(picture: &Picture, panel: usize) -> Vec<Point> {
    let layers = picture.panels[panel].layers.iter();
    let marks = layers.filter_map(|layer| match layer {
        Layer::Marks(points, _) => Some(points.clone()),
        _ => None,
    });
    marks
        .flatten()
        .filter(|point| *point != (1.0, 0.0))
        .collect()
}

#[test]
fn multipliers_have_their_conjugates() {
    let count = |spectrum: &str| {
        let multipliers = multipliers(spectrum);
        assert_eq!(captions(&multipliers), ["Re μ", "Im μ", "Re μ", ""]);
        for wanted in ["sector", "translation, μ = 1", "at δ = 0.1 [1]"] {
            assert!(explanations(&multipliers).contains(&wanted), "{wanted}");
        }
        points(&multipliers, 0).len()
    };
    // The sectors 0 and 4 are their own conjugates, that of 3 is 5, listed or not.
    assert_eq!(count("1,0,-0.1,3,0\n"), 2);
    assert_eq!(count("1,0,-2,0,0\n"), 1);
    assert_eq!(count("1,4,-0.1,3,0\n"), 2);
    assert_eq!(count("1,3,-0.1,3,0\n"), 2);
    assert_eq!(count("1,3,-0.1,3,0\n1,5,-0.1,-3,0\n"), 2);
}

/// μ = exp(λT) with T = 2π/(k|c|) as the picture says, and the enlarged view shows the foremost one.
#[test]
fn the_enlarged_view_is_where_the_foremost_multiplier_is() {
    let period = std::f64::consts::TAU / (8.0 * 1.241);
    for (growth, frequency) in [(0.1, 3.0), (-0.02, 0.1), (0.3, 0.0), (-0.001, 4.0)] {
        let multipliers = multipliers(&format!("1,3,{growth},{frequency},0\n1,3,-1.5,1,0\n"));
        assert!(explanations(&multipliers).iter().any(|text| {
            text.starts_with("μ = exp(λT), T = 2π/(k|c|) = ")
                && text.ends_with(&number::significant(period, 4))
        }));
        let size = f64::exp(growth * period);
        let (sine, cosine) = (frequency * period).sin_cos();
        let near = |point: &&Point| {
            (point.0 - size * cosine).abs() < 1e-12 && (point.1 - size * sine).abs() < 1e-12
        };
        for panel in [0, 1] {
            let points = points(&multipliers, panel);
            assert_eq!(
                points.iter().filter(near).count(),
                1,
                "{growth} {frequency}"
            );
        }
        // with both sides of the unit circle
        let enlarged = &multipliers.panels[1];
        let (Extent::Fixed(left, right), Extent::Fixed(low, high)) =
            (enlarged.x.extent, enlarged.y.extent)
        else {
            panic!("a window is fixed")
        };
        let corners = [(left, low), (left, high), (right, low), (right, high)];
        let inside = corners.iter().filter(|(re, im)| re.hypot(*im) < 1.0);
        assert!((1..4).contains(&inside.count()), "{growth} {frequency}");
    }
}

#[test]
fn odd_cells_do_no_harm() {
    let cells = [
        "NaN", "inf", "1e308", "-1e308", "", "abc", "1e-320", "0", "5",
    ];
    let mut rows = Vec::new();
    for (index, a) in cells.iter().enumerate() {
        for b in cells {
            rows.push(format!(
                "{index},{index},XX,a--b,{a},{b},,,,,,{b},{a} {b} x,{a},{b},{a},maybe,,{b},{a},,,{a},7,8\n"
            ));
        }
    }
    let folder = folder(&rows);
    let profiles = folder.path().join("profiles");
    fs::create_dir(&profiles).unwrap();
    for (index, a) in cells.iter().enumerate() {
        let samples: String = cells
            .iter()
            .map(|b| format!("{b},{a},{b},{a},{a},{b},{a},r{b}\n"))
            .collect();
        let text = format!("theta,U,V,U_dot,V_dot,P,Q,regime\n{samples}");
        fs::write(profiles.join(format!("{index}.csv")), text).unwrap();
    }
    let mut problem = problem(&all());
    problem.title = Some("a & b < c \u{0} \"d\" ".repeat(20));
    draw_of(folder.path(), &problem, Format::Svg).unwrap();
    #[cfg(feature = "raster")]
    draw_of(folder.path(), &problem, Format::Png).unwrap();
}

#[test]
fn missing_or_empty_branch_is_an_error() {
    let folder = TempDir::new().unwrap();
    let attempt = || draw(folder.path(), &all(), Format::Svg).unwrap_err();
    let damaged = |error: &StoreError| matches!(error, StoreError::Damaged { .. });
    assert!(is(&attempt(), damaged));
    fs::write(folder.path().join("branch.csv"), "").unwrap();
    assert!(is(&attempt(), damaged));
}

#[cfg(feature = "raster")]
#[test]
fn png_and_pdf_have_their_signatures() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
    add_profiles(folder.path());
    for file in draw(folder.path(), &all(), Format::Png).unwrap() {
        assert!(fs::read(&file).unwrap().starts_with(b"\x89PNG\r\n\x1a\n"));
    }
    for file in draw(folder.path(), &all(), Format::Pdf).unwrap() {
        assert!(fs::read(&file).unwrap().starts_with(b"%PDF-"));
    }
}

#[cfg(not(feature = "raster"))]
#[test]
fn formats_left_out_are_named() {
    let folder = folder(&[row("", "", 0.1, "", 1)]);
    for format in [Format::Png, Format::Pdf] {
        let error = draw(folder.path(), &[Plot::Diagram], format).unwrap_err();
        assert!(error.to_string().contains("raster"), "{error}");
    }
}

/// Characters that XML does not know, from a title, leave every format whole.
#[test]
fn titles_may_hold_any_character() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
    let mut problem = problem(&[Plot::Diagram]);
    problem.title = Some("a\u{fffe}b\u{ffff}c\u{1b}d\u{7f}e\u{0}f < & > \u{1f600}".to_owned());
    let mut formats = vec![Format::Svg];
    if cfg!(feature = "raster") {
        formats.extend([Format::Png, Format::Pdf]);
    }
    for format in formats {
        let files = draw_of(folder.path(), &problem, format).unwrap();
        let bytes = fs::read(&files[0]).unwrap();
        if let (Format::Svg, Ok(text)) = (format, String::from_utf8(bytes)) {
            assert!(text.contains("abcdef &lt; &amp; &gt; \u{1f600}"));
            // the characters of XML 1.0
            let known = |c: char| {
                matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}')
                    || c >= '\u{10000}'
            };
            assert!(text.chars().all(known));
        }
    }
}

/// A file grows with what can be seen: ten times the points, the same picture.
#[test]
fn many_points_make_no_large_picture() {
    let size = |count: u32| {
        let rows: Vec<String> = (0..count)
            .map(|index| {
                let part = f64::from(index) / f64::from(count);
                // a line that oscillates, and marks all along
                row("", "UZ", part + 0.01 * (60.0 * part).sin(), "yes", 1)
            })
            .collect();
        let folder = folder(&rows);
        svg(&folder, Plot::Diagram).len()
    };
    let (few, many) = (size(6_000), size(60_000));
    assert!(many < few + few / 2, "{few} {many}");
}
