//! Tests of the pictures of a branch as values.

use super::*;
use crate::output::render::{Pattern, Pen, VERMILLION};
use crate::table::Table;

/// The pens of all lines.
fn pens(picture: &Picture) -> Vec<Pen> {
    let pen = |layer: &Layer| match layer {
        Layer::Line(_, pen) => Some(*pen),
        _ => None,
    };
    layers(picture).into_iter().filter_map(pen).collect()
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
    let diagram = picture(&folder, Plot::Diagram);
    assert_eq!(captions(&diagram), ["mismatch δ", "speed c"]);
    assert_eq!(
        explanations(&diagram),
        [
            "stable",
            "unstable",
            "EP end",
            "HB Hopf",
            "GR graze",
            "CO coalescence"
        ]
    );
    assert_eq!(marks(&diagram), 4);
    let text = svg(&folder, Plot::Diagram);
    for wanted in captions(&diagram)
        .iter()
        .map(String::as_str)
        .chain(explanations(&diagram))
    {
        assert!(text.contains(wanted), "{wanted}");
    }
    // Each event once in the picture and once in the legend.
    assert_eq!(text.matches("<polygon").count(), 6);
}

/// Solid is said of stable waves only, and one entry of the legend says what dotted means.
#[test]
fn what_is_not_known_to_be_stable_is_not_solid() {
    for (verdicts, pattern, words) in [
        (["", ""], Pattern::Dotted, "stability not asked for"),
        (
            ["undecided", "undecided"],
            Pattern::Dotted,
            "stability undecided",
        ),
        (["no", "no"], Pattern::Dashed, "unstable"),
        (["yes", "yes"], Pattern::Solid, "stable"),
    ] {
        let rows = [
            row("", "", 0.1, verdicts[0], 1),
            row("", "", 0.2, verdicts[1], 1),
        ];
        let diagram = picture(&folder(&rows), Plot::Diagram);
        assert_eq!(pens(&diagram).first().map(|pen| pen.pattern), Some(pattern));
        assert_eq!(explanations(&diagram), [words]);
    }
    let rows = ["", "", "undecided", "undecided"]
        .iter()
        .zip([0.1, 0.2, 0.3, 0.4]);
    let rows: Vec<String> = rows.map(|(stable, x)| row("", "", x, stable, 1)).collect();
    let diagram = picture(&folder(&rows), Plot::Diagram);
    assert!(
        pens(&diagram)
            .iter()
            .all(|pen| pen.pattern == Pattern::Dotted)
    );
    assert_eq!(
        explanations(&diagram),
        ["stability undecided or not asked for"]
    );
}

/// Where waves grow beyond the window only, the count of growing eigenvalues is zero and says so.
#[test]
fn growth_beyond_the_window_is_shown() {
    let count = |unstable: &str, stable: &str, mismatch: f64| {
        row("", "", mismatch, stable, 1)
            .replace(&format!("{stable},,,,"), &format!("{stable},{unstable},,,"))
    };
    let legend = |stable: [&str; 3]| {
        let rows: Vec<String> = ["2", "0", "0"]
            .iter()
            .zip(stable)
            .zip([0.3, 0.2, 0.1])
            .map(|((unstable, stable), mismatch)| count(unstable, stable, mismatch))
            .collect();
        let diagram = picture(&folder(&rows), Plot::Diagram);
        assert_eq!(diagram.panels.len(), 2);
        let thick = diagram.panels[1]
            .layers
            .iter()
            .find_map(|layer| match layer {
                Layer::Line(points, pen) if pen.colour == VERMILLION => Some(points.clone()),
                _ => None,
            });
        let words = explanations(&diagram);
        (
            thick,
            words.iter().any(|text| text.contains("high frequency")),
        )
    };
    let (thick, explained) = legend(["no", "no", "no"]);
    assert!(explained);
    assert_eq!(
        thick.map(|line| (line[0], line[1])),
        Some(((0.2, 0.0), (0.1, 0.0)))
    );
    assert_eq!(legend(["no", "yes", "yes"]), (None, false));
}

/// A branch that is followed both ways begins in the middle: no end is marked there. A Hopf point has
/// the same mark, however many there are.
#[test]
fn marks_are_those_of_their_events() {
    let rows = [
        row("1", "EP", 0.2, "", 1),
        row("2", "EP", 0.1, "", 1),
        row("3", "EP", 0.2, "", 2),
        row("4", "EP", 0.3, "", 2),
    ];
    let both = picture(&folder(&rows), Plot::Diagram);
    let ends: Vec<Point> = layers(&both)
        .into_iter()
        .filter_map(|layer| match layer {
            Layer::Marks(points, _) => Some(points.clone()),
            _ => None,
        })
        .flatten()
        .collect();
    assert_eq!(
        ends.iter().map(|point| point.0).collect::<Vec<_>>(),
        [0.1, 0.3]
    );
    let hopf = |count: u32| {
        let rows: Vec<String> = (1..=count)
            .map(|index| row(&index.to_string(), "HB", 0.01 * f64::from(index), "no", 1))
            .collect();
        let diagram = picture(&folder(&rows), Plot::Diagram);
        layers(&diagram).into_iter().find_map(|layer| match layer {
            Layer::Marks(_, mark) => Some(*mark),
            _ => None,
        })
    };
    assert_eq!(hopf(2), hopf(30));
}

#[test]
fn legs_are_not_joined() {
    let curves = |legs: [usize; 4]| {
        let rows: Vec<String> = legs
            .iter()
            .zip([0.1, 0.2, 0.3, 0.4])
            .map(|(leg, mismatch)| row("", "", mismatch, "", *leg))
            .collect();
        let diagram = picture(&folder(&rows), Plot::Diagram);
        let points = |layer: &&Layer| match layer {
            Layer::Line(points, _) => Some(points.len()),
            _ => None,
        };
        layers(&diagram)
            .iter()
            .filter_map(points)
            .collect::<Vec<_>>()
    };
    assert_eq!(curves([1, 1, 1, 1]), [4]);
    assert_eq!(curves([1, 1, 2, 2]), [2, 2]);
}

/// A band says of a value of the parameter which waves are there: its ends are events, its name and its
/// colour those of the sequence.
#[test]
fn bands_are_where_their_waves_are() {
    let mut rows: Vec<String> = [0.4, 0.3, 0.2, 0.1]
        .iter()
        .map(|mismatch| row("", "", *mismatch, "", 1))
        .collect();
    rows[1] = row("2", "RV", 0.3, "", 1);
    for row in &mut rows[1..] {
        *row = row.replace("slip-stick", "slip-reverse-stick");
    }
    let diagram = picture(&folder(&rows), Plot::Diagram);
    let bands: Vec<([f64; 2], String)> = layers(&diagram)
        .into_iter()
        .filter_map(|layer| match layer {
            Layer::Headings(headings) => Some(headings),
            _ => None,
        })
        .flatten()
        .map(|heading| (heading.ends, heading.names[0].clone()))
        .collect();
    let wanted = [
        ([0.1, 0.3], "1 slip-reverse-stick"),
        ([0.3, 0.4], "2 slip-stick"),
    ];
    assert_eq!(bands.len(), wanted.len());
    for ((ends, name), (wanted, known)) in bands.iter().zip(wanted) {
        assert_eq!((*ends, name.as_str()), (wanted, known));
    }
    // a narrow one goes by its number, which the legend explains
    for name in ["1 sl-rev-st", "2 sl-st"] {
        assert!(explanations(&diagram).contains(&name), "{name}");
    }
    // none where the branch turns back
    rows.push(row("", "", 0.2, "", 1));
    let folded = picture(&folder(&rows), Plot::Diagram);
    assert!(
        !layers(&folded)
            .iter()
            .any(|layer| matches!(layer, Layer::Cells(_)))
    );
}

/// Sequences of a user's own modes differ in colour within a picture.
#[test]
fn sequences_of_modes_have_colours() {
    let names = [
        "plus-minus",
        "plus-slide-minus-slide",
        "plus-minus-plus-minus",
    ];
    let rows: Vec<String> = (0..6)
        .map(|place| {
            let row = row("", "", 0.1 * f64::from(place), "yes", 1);
            row.replace("slip-stick", names[place as usize / 2])
        })
        .collect();
    let pens = pens(&picture(&folder(&rows), Plot::Diagram));
    let mut colours: Vec<_> = pens.iter().map(|pen| pen.colour).collect();
    colours.dedup();
    assert_eq!(colours.len(), names.len());
}

/// Sequences too long for the legend have letters there and above their bands, with a key below.
#[test]
fn long_sequences_have_a_key() {
    let names =
        ["backward.stick-", "stick.backward-"].map(|zones| format!("{}end.end", zones.repeat(4)));
    let rows: Vec<String> = (0..4_u8)
        .map(|place| {
            let row = row("", "", 0.1 * f64::from(place), "yes", 1);
            row.replace("slip-stick", &names[usize::from(place) / 2])
        })
        .collect();
    let drawn = picture(&folder(&rows), Plot::Diagram);
    let told = explanations(&drawn);
    let has = |wanted: &str| told.contains(&wanted);
    assert!(
        has("1 bs-bs-bs-bs-ee") && has("2 sb-sb-sb-sb-ee"),
        "{told:?}"
    );
    assert!(has("b = backward") && has("s = stick") && has("e = end"));
}

/// Values far apart get a logarithmic axis, unless one is asked for or not.
#[test]
fn wide_branches_have_a_logarithmic_axis() {
    let extent = |low: f64| {
        let rows = [row("", "", low, "", 1), row("", "", 0.2, "", 1)];
        picture(&folder(&rows), Plot::Diagram).panels[0].x.extent
    };
    assert!(matches!(extent(0.001), Extent::Logarithmic(_)));
    assert!(matches!(extent(0.01), Extent::Data(_)));
    assert!(matches!(extent(0.0), Extent::Data(_)));
}

/// Where the branch turns back the ends of zones are lines: the axis fits them, without the end of the wave,
/// which is the same everywhere.
#[test]
fn folded_switches_use_the_height() {
    let rows = [0.1, 0.2, 0.15].map(|mismatch| row("", "", mismatch, "", 1));
    let switches = |rows: &[String]| picture(&folder(rows), Plot::Column("switches".to_owned()));
    let folded = switches(&rows);
    assert!(matches!(folded.panels[0].y.extent, Extent::Data(_)));
    let heights = layers(&folded).into_iter().filter_map(|layer| match layer {
        Layer::Line(points, _) => Some(points.iter().map(|point| point.1).collect::<Vec<_>>()),
        _ => None,
    });
    assert_eq!(heights.collect::<Vec<_>>(), [[0.4, 0.4, 0.4]]);
    assert!(explanations(&folded).contains(&"the wave ends at θ = 0.78"));
    assert!(matches!(
        switches(&rows[..2]).panels[0].y.extent,
        Extent::Fixed(..)
    ));
}

/// Of two waves that look the same one is shown, and the one that was asked for.
#[test]
fn profiles_shown_are_told_apart() {
    let mut rows: Vec<String> = [(0.1, "EP"), (0.2, ""), (0.2005, "UZ"), (0.3, "EP")]
        .iter()
        .zip(1..)
        .map(|((mismatch, kind), label)| row(&label.to_string(), kind, *mismatch, "", 1))
        .collect();
    let shown = |rows: &[String]| {
        let folder = folder(rows);
        add_profiles(folder.path());
        fs::write(folder.path().join("profiles/4.csv"), PROFILE).unwrap();
        let tables = Tables::read(folder.path(), "mismatch").unwrap();
        let profiles = Profiles::read(folder.path(), &tables, &[]).unwrap();
        let shown = profiles.shown();
        shown
            .iter()
            .map(|one| one.profile.label.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(shown(&rows), ["1", "3", "4"]);
    // beyond a fold there is another wave at the same parameter
    rows[1] = rows[1].replace("-1.242", "-1.249");
    assert_eq!(shown(&rows), ["1", "2", "3", "4"]);
}

/// Axes carry units where the problem says what they are.
#[test]
fn dimensional_problems_have_units() {
    let mut problem = problem(&[Plot::Diagram, Plot::Pressure]);
    let draw = |problem: &Problem| -> Vec<String> {
        let folder = folder(&[row("1", "EP", 0.1, "", 1), row("2", "EP", 0.2, "", 1)]);
        add_profiles(folder.path());
        let files = draw_of(folder.path(), problem, Format::Svg).unwrap();
        files
            .iter()
            .map(|file| fs::read_to_string(file).unwrap())
            .collect()
    };
    assert!(!draw(&problem).concat().contains("(γI₀E)"));
    problem.output.rotation = Some(62.8);
    let pictures = draw(&problem);
    for (picture, wanted) in pictures.iter().zip([
        ["mismatch δ (R)", "(Ω)", "Ω = 62.8 rad/s"],
        ["position θ (rad)", "pressure P (γI₀E)", "Ω = 62.8 rad/s"],
    ]) {
        for text in wanted {
            assert!(picture.contains(text), "{text}");
        }
    }
}

/// What is not drawn of a branch has a title of its own.
#[test]
fn pictures_of_no_branch_say_what_they_show() {
    let modes = Table::parse(b"mode,growth,hopf_friction\n1,0.1,0.2\n").unwrap();
    let mut problem = problem(&[]);
    problem.title = Some("Mode 8".to_owned());
    let steady = super::super::of_problem(
        &problem,
        super::super::steady::picture(&modes, Some(&problem)),
    );
    assert_eq!(
        steady.title.as_deref(),
        Some("Perturbations of steady sliding, by mode")
    );
    assert_eq!(steady.subtitle.as_deref(), Some("Mode 8"));
    assert!(explanations(&steady).contains(&"f = 0.3, γ = 1, ν = 0.3, ξ = 1.5"));
    let methods = super::super::of_problem(&problem, super::super::accuracy::picture(&[]));
    assert_eq!(
        methods.title.as_deref(),
        Some("Methods: error against run time")
    );
    assert_eq!(methods.subtitle.as_deref(), Some("Mode 8"));
}
