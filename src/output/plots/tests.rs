//! Tests of the pictures as files.

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::axis::Axis;
use super::canvas::Place;
use super::curve;
use super::frame::Frame;
use super::quantity::Quantity;
use super::{Format, Picture, PlotError, Settings, draw};
use crate::curve::Region;

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

fn settings() -> Settings {
    Settings {
        parameter: "mismatch".to_owned(),
        title: None,
    }
}

fn all() -> Vec<Picture> {
    let column = |name: &str| Picture::Column(name.to_owned());
    vec![
        Picture::Diagram,
        Picture::Pressure,
        Picture::Displacement,
        Picture::PhasePlane,
        Picture::Friction,
        Picture::Spectrum,
        Picture::Multipliers,
        column("amplitude"),
        column("lead_re"),
        column("switches"),
    ]
}

fn svg(folder: &TempDir, picture: Picture) -> String {
    let files = draw(folder.path(), &[picture], Format::Svg, &settings()).unwrap();
    fs::read_to_string(&files[0]).unwrap()
}

#[test]
fn short_branches_give_every_picture() {
    for count in 0..3 {
        let rows: Vec<String> = (0..count)
            .map(|index| row("", "", 0.1 * f64::from(index), "", 1))
            .collect();
        let folder = folder(&rows);
        let files = draw(folder.path(), &all(), Format::Svg, &settings()).unwrap();
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
    assert!(svg(&folder, Picture::Diagram).contains("the branch has no points"));
    assert!(svg(&folder, Picture::Pressure).contains("no profiles were asked for"));
    for picture in [Picture::Spectrum, Picture::Multipliers] {
        assert!(svg(&folder, picture).contains("no spectrum was asked for"));
    }
}

#[test]
fn files_are_named_after_their_pictures() {
    let folder = folder(&[row("", "", 0.1, "", 1)]);
    let files = draw(folder.path(), &all(), Format::Svg, &settings()).unwrap();
    let expected: Vec<PathBuf> = [
        "diagram",
        "pressure",
        "displacement",
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
        let pictures = [Picture::Column(name.to_owned())];
        let error = draw(folder.path(), &pictures, Format::Svg, &settings()).unwrap_err();
        assert!(matches!(error, PlotError::UnknownColumn { .. }));
        assert!(error.to_string().contains("amplitude"), "{error}");
    }
    let settings = Settings {
        parameter: "switches".to_owned(),
        title: None,
    };
    let error = draw(folder.path(), &[Picture::Diagram], Format::Svg, &settings).unwrap_err();
    assert!(matches!(error, PlotError::UnknownColumn { .. }));
}

#[test]
fn unfinished_last_rows_are_ignored() {
    let whole = [row("", "", 0.1, "", 1), row("", "", 0.2, "", 1)];
    let expected = svg(&folder(&whole), Picture::Diagram);
    for cut in ["1,,,slip-st", "1,,,slip-stick,9.5,0.3,0", "1,,,\"slip"] {
        let mut rows = whole.to_vec();
        rows.push(cut.to_owned());
        assert_eq!(svg(&folder(&rows), Picture::Diagram), expected);
    }
    let mut rows = whole.to_vec();
    rows.push(row("", "", 9.5, "", 1).trim_end().to_owned());
    assert_eq!(svg(&folder(&rows), Picture::Diagram), expected);
}

#[test]
fn diagram_has_markers_and_labels() {
    let rows = [
        row("1", "EP", 0.1, "yes", 1),
        row("2", "GR", 0.2, "yes", 1),
        row("3", "HB", 0.3, "no", 1),
        row("", "", 0.4, "no", 1),
    ];
    let folder = folder(&rows);
    fs::write(
        folder.path().join("events.csv"),
        "label,type,mismatch,speed\n2,GR,0.2,-1.242\n7,CO,0.25,-1.2425\n",
    )
    .unwrap();
    let text = svg(&folder, Picture::Diagram);
    for wanted in [
        "mismatch δ",
        "speed c",
        "EP end",
        "GR take-off",
        "HB Hopf",
        "CO coalescence",
        "stable",
        "unstable",
    ] {
        assert!(text.contains(wanted), "{wanted}");
    }
    assert!(!text.contains("undecided"));
    assert!(!text.contains("LP fold"));
    // Each event once in the picture and once in the legend.
    assert_eq!(text.matches("<polygon").count(), 8);
}

#[test]
fn stability_is_explained_only_when_examined() {
    let rows = [row("", "", 0.1, "", 1), row("", "", 0.2, "", 1)];
    assert!(!svg(&folder(&rows), Picture::Diagram).contains("stable"));
}

#[test]
fn legs_are_not_joined() {
    let curves = |legs: [usize; 4]| {
        let rows: Vec<String> = legs
            .iter()
            .zip([0.1, 0.2, 0.3, 0.4])
            .map(|(leg, mismatch)| row("", "", mismatch, "", *leg))
            .collect();
        let text = svg(&folder(&rows), Picture::Diagram);
        text.matches("stroke-width=\"22\"").count()
    };
    assert_eq!(curves([1, 1, 1, 1]), 1);
    assert_eq!(curves([1, 1, 2, 2]), 2);
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
    let pressure = svg(&folder, Picture::Pressure);
    for wanted in ["pressure P", "position θ", "δ =", "0.1\n", "0.2\n", "0.3\n"] {
        assert!(pressure.contains(wanted), "{wanted}");
    }
    assert!(svg(&folder, Picture::PhasePlane).contains("stick, V\u{307} = 1"));
    assert!(svg(&folder, Picture::Displacement).contains("switching points"));
    let friction = svg(&folder, Picture::Friction);
    for wanted in ["friction force Q", "±f P", "separation", "stick"] {
        assert!(friction.contains(wanted), "{wanted}");
    }
}

#[test]
fn incomplete_profiles_are_refused_by_name() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1)]);
    let profiles = folder.path().join("profiles");
    fs::create_dir(&profiles).unwrap();
    fs::write(profiles.join("1.csv"), "theta,U\n0,1\n").unwrap();
    let error = draw(
        folder.path(),
        &[Picture::Pressure],
        Format::Svg,
        &settings(),
    )
    .unwrap_err();
    assert!(error.to_string().contains("1.csv"), "{error}");
    assert!(matches!(error, PlotError::MissingColumn { .. }));
}

#[test]
fn spectrum_names_sectors_and_labels() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
    fs::write(
        folder.path().join("spectrum.csv"),
        "label,sector,re,im,error\n1,0,-0.1,1,0\n1,3,0.1,2,0\n2,0,-0.2,NaN,0\n2,0,-0.2,1,0\n",
    )
    .unwrap();
    let text = svg(&folder, Picture::Spectrum);
    for wanted in ["Re λ", "Im λ", "sector", "0.1 [1]", "0.2 [2]"] {
        assert!(text.contains(wanted), "{wanted}");
    }
}

#[test]
fn multipliers_have_their_conjugates() {
    // Eight waves around: the sectors 0 and 4 are their own conjugates, sector 1 is not.
    let polygons = |spectrum: &str| {
        let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
        fs::write(
            folder.path().join("spectrum.csv"),
            format!("label,sector,re,im,error\n{spectrum}2,0,-0.1,5,0\n"),
        )
        .unwrap();
        let text = svg(&folder, Picture::Multipliers);
        for wanted in ["Re μ", "Im μ", "sector", "μ = 1", "at δ = 0.1 [1]"] {
            assert!(text.contains(wanted), "{wanted}");
        }
        text.matches("<polygon").count()
    };
    // Far from 1, so that only the left frame shows it; the legend and both discs are the rest.
    let rest = 3;
    assert_eq!(polygons("1,0,-0.1,3,0\n"), rest + 2);
    assert_eq!(polygons("1,0,-2,0,0\n"), rest + 1);
    assert_eq!(polygons("1,4,-0.1,3,0\n"), rest + 2);
    assert_eq!(polygons("1,3,-0.1,3,0\n"), rest + 1);
    assert_eq!(polygons("1,3,-0.1,-3,0\n"), rest + 1);
    // Near 1 both frames show it.
    assert_eq!(polygons("1,0,-0.1,0.1,0\n"), rest + 4);
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
    let settings = Settings {
        parameter: "mismatch".to_owned(),
        title: Some("a & b < c \u{0} \"d\" ".repeat(20)),
    };
    draw(folder.path(), &all(), Format::Svg, &settings).unwrap();
    #[cfg(feature = "raster")]
    draw(folder.path(), &all(), Format::Png, &settings).unwrap();
}

#[test]
fn missing_or_empty_branch_is_an_error() {
    let folder = TempDir::new().unwrap();
    let attempt = || draw(folder.path(), &all(), Format::Svg, &settings()).unwrap_err();
    assert!(matches!(attempt(), PlotError::Read { .. }));
    fs::write(folder.path().join("branch.csv"), "").unwrap();
    assert!(matches!(attempt(), PlotError::Empty { .. }));
}

#[cfg(feature = "raster")]
#[test]
fn png_and_pdf_have_their_signatures() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
    add_profiles(folder.path());
    for file in draw(folder.path(), &all(), Format::Png, &settings()).unwrap() {
        assert!(fs::read(&file).unwrap().starts_with(b"\x89PNG\r\n\x1a\n"));
    }
    for file in draw(folder.path(), &all(), Format::Pdf, &settings()).unwrap() {
        assert!(fs::read(&file).unwrap().starts_with(b"%PDF-"));
    }
}

#[cfg(feature = "raster")]
#[test]
fn png_shows_text_without_fonts_of_the_machine() {
    let dark = |text: &str| {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"510\" height=\"40\">\
             <text x=\"9\" y=\"30\" font-size=\"20\" \
             font-family=\"Helvetica, Arial, sans-serif\">{text}</text></svg>"
        );
        super::raster::png(&svg).unwrap()
    };
    // Every symbol has a glyph of its own, unlike a character that no font has.
    let missing = dark("\u{10fffd}");
    for symbol in "δνξαβγλθ−×±¹²³⁴⁵⁶⁷⁸⁹⁰⁻…".chars() {
        assert_ne!(dark(&symbol.to_string()), missing, "{symbol}");
    }
    assert_ne!(dark("V\u{307}"), dark("V"));
}

#[cfg(not(feature = "raster"))]
#[test]
fn formats_left_out_are_named() {
    let folder = folder(&[row("", "", 0.1, "", 1)]);
    for format in [Format::Png, Format::Pdf] {
        let error = draw(folder.path(), &[Picture::Diagram], format, &settings()).unwrap_err();
        assert!(error.to_string().contains("raster"), "{error}");
    }
}

/// Characters that XML does not know, from a title, leave every format whole.
#[test]
fn titles_may_hold_any_character() {
    let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
    let settings = Settings {
        title: Some("a\u{fffe}b\u{ffff}c\u{1b}d\u{7f}e\u{0}f < & > \u{1f600}".to_owned()),
        ..settings()
    };
    let mut formats = vec![Format::Svg];
    if cfg!(feature = "raster") {
        formats.extend([Format::Png, Format::Pdf]);
    }
    for format in formats {
        let files = draw(folder.path(), &[Picture::Diagram], format, &settings).unwrap();
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
        svg(&folder, Picture::Diagram).len()
    };
    let (few, many) = (size(6_000), size(60_000));
    assert!(many < few + few / 2, "{few} {many}");
}

/// A name stands with its middle at the place that it was computed for, or nowhere.
#[test]
fn names_stand_at_their_places() {
    let quantity = Quantity::new("parameter", "p");
    let frame = Frame {
        from: (60.0, 40.0),
        to: (460.0, 340.0),
        x: Axis::over(2.0, 4.0, &quantity, 5),
        y: Axis::over(0.0, 0.3, &quantity, 5),
        figures: 20.0,
        labelled_below: true,
    };
    let line: Vec<Place> = (0..=300)
        .map(|step| (260.0, 40.0 + f64::from(step)))
        .collect();
    let region = |stretch, left, place, name: &str| Region {
        stretch,
        left,
        place,
        name: name.to_owned(),
    };
    let regions = [
        // across the curve, then clear of it
        region(0, false, [3.05, 0.1], "slip-stick"),
        region(0, false, [3.5, 0.1], "slip-stick"),
        region(0, false, [3.6, 0.2], "slip-stick"),
        region(0, true, [2.5, 0.15], "3 waves slip-stick"),
        // over the edge of the frame
        region(1, true, [2.02, 0.05], "the pair grows"),
    ];
    let written = curve::labels(&frame, &line, &regions);
    assert_eq!(written.len(), 2);
    for ((found, text), (place, name)) in written
        .iter()
        .zip([((360.0, 240.0), "sl-st"), ((160.0, 190.0), "3 waves sl-st")])
    {
        assert_eq!(text, name);
        assert!((found.0 - place.0).abs() < 1e-9 && (found.1 - place.1).abs() < 1e-9);
    }
}
