//! Branches of equilibria against closed forms and figures of an independent program in 40 digits, in several units and orders
//! of the states.

use std::f64::consts::FRAC_1_SQRT_2;

use brakewave::EventType;
use brakewave::hybrid::equilibrium::run::EquilibriumProgress;
use brakewave::hybrid::equilibrium::{
    EquilibriumEvent, EquilibriumItem, EquilibriumRunner, NamedEquilibrium,
};
use brakewave::hybrid::{EarlierPoint, OrbitPoint, OrbitRunner};
use brakewave::orbit::legs::Run as _;
use brakewave::orbit::{Stability, special};
use brakewave::problem::SystemProblem;

use crate::affine::rests::{
    BRUSSELATOR, CHUA, Course, FITZHUGH, HARVEST, LORENZ, PITCHFORK, STARTS, events, followed,
    meets, number, runner, to_its_end,
};
use crate::affine::systems::in_order;
use EventType::{BE, BP, EP, HB, LP, MX};

#[test]
fn hopf_points_have_their_frequency_and_first_lyapunov_coefficient() {
    // ω = A, l₁ = −(2 + A²)/(2A(1 + 2A²)) at B = 1 + A²
    for a in [1.0, 0.6, 1.7] {
        let text = BRUSSELATOR.replace("\"A\": 1.0", &format!("\"A\": {a:?}"));
        let course = Course {
            system: &text,
            state: &[a, 1.5 / a],
            range: (1.0, 4.5),
            ..STARTS[0]
        };
        let lyapunov = -(2.0 + a * a) / (2.0 * a * (1.0 + 2.0 * a * a));
        let numbers = [
            ("omega", a),
            ("lyapunov", lyapunov),
            ("x", a),
            ("y", (1.0 + a * a) / a),
        ];
        meets(&course.events(), HB, "B", 1.0 + a * a, &numbers);
    }
    // a third state that follows changes nothing within the plane of the pair but the length of its vector: l₁|q|² is the same, where
    // |q|² is that of the first two states as a part of all
    for a in [1.0, 0.7, 1.2, 1.3] {
        let text = format!(
            r#"(states: ["x", "y", "z"], parameters: {{"A": {a:?}, "B": 1.0}}, modes: {{"flow": (rates:
                {{"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y", "z": "0.3*(x - A) - 1.4*z"}})}})"#
        );
        let course = Course {
            system: &text,
            state: &[a, 1.0 / a, 0.0],
            range: (0.5, 5.0),
            ..STARTS[0]
        };
        // (A − iω)q = 0 of x, y: q = (A², −A² + iA); z = 0.3 x/(1.4 + iA)
        let square = a * a;
        let plane = square * square + square * square + square;
        let follower = 0.09 * square * square / (1.96 + square);
        let lyapunov = -(2.0 + square) / (2.0 * a * (1.0 + 2.0 * square));
        let lyapunov = lyapunov * plane / (plane + follower);
        let numbers = [("omega", a), ("lyapunov", lyapunov), ("x", a), ("z", 0.0)];
        meets(&course.events(), HB, "B", 1.0 + square, &numbers);
    }
    // states that stay zero leave rounding of rounding in the slopes, by which no vector may be told: in every order of the states
    let rates = [
        ("x", "0.3*mu + x^2 - 0.25 - y^2 - z^2 + 0.2*x*y"),
        ("y", "(mu + x)*y - 1.7*z"),
        ("z", "(mu + x)*z + 1.7*y"),
    ];
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        let text = in_order(&rates, &order, r#"parameters: {"mu": 0.1}"#);
        let course = Course {
            system: &text,
            parameter: "mu",
            state: &order.map(|index| [-0.469, 0.0, 0.0][index]),
            range: (-0.5, 1.5),
            ..STARTS[0]
        };
        // 40 digits
        let numbers = [("omega", 1.7), ("lyapunov", -1.582_482_468_655_640_77)];
        let mu = 0.5 * (1.09_f64.sqrt() - 0.3);
        meets(&course.events(), HB, "mu", mu, &numbers);
    }
    let predators = STARTS[1].events();
    let omega = 0.414_039_335_605_412_530_68;
    let lyapunov = -1.199_286_351_408_781_123_3;
    let numbers = [
        ("omega", omega),
        ("lyapunov", lyapunov),
        ("y", 0.595_238_095_238_095_238_1),
    ];
    meets(&predators, HB, "K", 7.0 / 6.0, &numbers);
    let lorenz = STARTS[2].events();
    for x in [7.956_019_457_871_825_051_7, -7.956_019_457_871_825_051_7] {
        let (omega, lyapunov) = (9.624_530_063_715_756_438_9, 2.655_189_725_836_714_223e-4);
        let numbers = [("x", x), ("y", x), ("omega", omega), ("lyapunov", lyapunov)];
        meets(&lorenz, HB, "r", 24.736_842_105_263_158_078, &numbers);
    }
    for (b, current, v, lyapunov) in [
        (
            0.45,
            0.040_038_660_903_665_295_086,
            -0.981_835_016_690_686_175_08,
            -0.194_915_849_969_694_757_42,
        ),
        (
            0.45,
            3.071_072_450_207_445_816,
            0.981_835_016_690_686_175_08,
            -0.194_915_849_969_694_757_42,
        ),
        (
            0.85,
            0.353_246_389_356_172_089_14,
            -0.965_401_470_891_773_605_44,
            1.149_362_191_240_031_470_2,
        ),
        (
            0.85,
            1.293_812_434_173_239_675_6,
            0.965_401_470_891_773_605_44,
            1.149_362_191_240_031_470_2,
        ),
    ] {
        let text = FITZHUGH.replace("0.45", &format!("{b:?}"));
        let course = Course {
            system: &text,
            ..STARTS[4]
        };
        meets(
            &course.events(),
            HB,
            "I",
            current,
            &[("v", v), ("lyapunov", lyapunov)],
        );
    }
    let two = STARTS[10].events();
    for (m, omega, lyapunov) in [
        (
            -0.622_254_678_596_635_211_61,
            1.337_254_593_541_642_778_2,
            -0.113_582_789_147_992_597_2,
        ),
        (
            -0.254_323_987_131_998_359_73,
            1.020_513_438_918_347_407_9,
            -0.199_353_444_609_917_843_78,
        ),
        (
            0.526_578_665_728_633_571_34,
            1.465_538_287_810_599_706_1,
            -0.078_100_748_450_120_275_249,
        ),
    ] {
        meets(
            &two,
            HB,
            "m",
            m,
            &[("omega", omega), ("lyapunov", lyapunov)],
        );
    }
}

/// In a sliding mode eigenvalues and l₁ are those of the field in its surface.
#[test]
fn a_relay_loses_its_rest_in_sliding() {
    let events = STARTS[9].events();
    let numbers = [
        ("s", 0.0),
        ("x", -0.051_359_056_450_322_587_371),
        ("y", -9.227_887_506_676_062_378_8e-3),
        ("omega", 0.910_165_120_233_586_004_28),
        ("lyapunov", -2.195_034_368_307_056_97),
    ];
    meets(&events, HB, "mu", -0.144_554_186_825_393_419_35, &numbers);
    let all = STARTS[9].all(&[1.0; 3], false);
    assert!(all.iter().all(|item| item.point.eigenvalues.len() == 2));
}

#[test]
fn folds_and_branch_points_are_located_to_rounding() {
    let reaction = STARTS[3].events();
    let numbers = [
        ("u", 0.311_017_763_495_386_386_39),
        ("w", 1.451_416_229_645_136_469_8),
    ];
    meets(&reaction, LP, "p", 0.105_738_978_271_650_651_01, &numbers);
    let numbers = [
        ("u", 0.688_982_236_504_613_613_61),
        ("w", 3.215_250_437_021_530_196_8),
    ];
    meets(&reaction, LP, "p", 0.088_931_846_185_772_802_594, &numbers);
    let numbers = [
        ("omega", 4.007_774_662_864_486_653_1),
        ("lyapunov", -0.388_954_535_527_405_477),
    ];
    meets(&reaction, HB, "p", 0.130_900_044_820_043_324_64, &numbers);
    // the trace is zero at a saddle in between: no Hopf point
    assert_eq!(reaction.len(), 3, "{reaction:#?}");
    meets(
        &STARTS[1].events(),
        BP,
        "K",
        1.0 / 3.0,
        &[("x", 1.0 / 3.0), ("y", 0.0)],
    );
    // where the branch of x = y ≠ 0 comes to that of 0 the parameter turns, which is no fold
    let lorenz = STARTS[2].events();
    meets(&lorenz, BP, "r", 1.0, &[("x", 0.0), ("y", 0.0), ("z", 0.0)]);
    assert_eq!(lorenz.len(), 3, "{lorenz:#?}");
    meets(&STARTS[5].events(), BP, "mu", 0.0, &[("x", 0.0)]);
}

/// A fold of pseudo-equilibria between boundary equilibria of both kinds.
#[test]
fn beyond_a_boundary_the_neighbouring_mode_goes_on() {
    let found = STARTS[6].events();
    let kinds: Vec<_> = found
        .iter()
        .map(|one| {
            (
                one.kind,
                one.regimes_before.as_str(),
                one.regimes_after.as_str(),
            )
        })
        .collect();
    let expected = [
        (BE, "low", "slide"),
        (LP, "slide", "slide"),
        (BE, "slide", "high"),
    ];
    assert_eq!(kinds, expected);
    let al = [
        0.404_875_148_632_580_261_59,
        0.422_5,
        0.420_227_149_810_708_491_08,
    ];
    let x = [
        0.217_241_379_310_344_827_59,
        0.35,
        0.397_674_418_604_651_162_79,
    ];
    for ((kind, ..), (al, x)) in expected.into_iter().zip(al.into_iter().zip(x)) {
        meets(&found, kind, "al", al, &[("x", x), ("y", al)]);
    }
    assert!(
        found[0].what.starts_with("nonsmooth fold"),
        "{}",
        found[0].what
    );
    assert!(
        found[2].what.starts_with("persistence"),
        "{}",
        found[2].what
    );
    // with less harvest both turn
    let text = HARVEST.replace("0.15", "0.05");
    let found = Course {
        system: &text,
        ..STARTS[6]
    }
    .events();
    assert_eq!(found.len(), 2);
    meets(
        &found,
        BE,
        "al",
        0.415_450_338_198_647_205_41,
        &[("x", 0.266_037_735_849_056_603_77)],
    );
    assert!(
        found
            .iter()
            .all(|one| one.what.starts_with("nonsmooth fold"))
    );
    // two continuous modes: E = ∓αc, both equilibria on one side
    let found = STARTS[7].events();
    meets(
        &found,
        BE,
        "E",
        -6.0 / 7.0,
        &[("x", 1.0), ("y", 0.0), ("z", -1.0)],
    );
    meets(
        &found,
        BE,
        "E",
        6.0 / 7.0,
        &[("x", -1.0), ("y", 0.0), ("z", 1.0)],
    );
    assert!(
        found
            .iter()
            .all(|one| one.what.starts_with("nonsmooth fold"))
    );
    let found = STARTS[8].events();
    meets(&found, BE, "mu", 0.0, &[("x", 0.0), ("y", 0.0)]);
    assert!(
        found[0].what.starts_with("persistence"),
        "{}",
        found[0].what
    );
}

/// Chua's outer equilibrium: m(m − 1)α² + (m − 1)α + β = 0, ω² = β + α(m − 1).
#[test]
fn cycles_of_an_affine_mode_are_a_vertical_family() {
    let text = CHUA.replace("1.2857142857142857143", "0.0");
    let course = Course {
        system: &text,
        state: &[1.5, 0.0, -1.5],
        parameter: "alpha",
        range: (5.0, 8.0),
        ..STARTS[7]
    };
    let found = course.events();
    let numbers = [
        ("x", 1.5),
        ("omega", 3.070_130_003_457_097_263_9),
        ("lyapunov", 0.0),
    ];
    meets(&found, HB, "alpha", 6.796_022_466_621_533_519_6, &numbers);
    assert!(
        found[0].what.contains("vertical family"),
        "{}",
        found[0].what
    );
}

/// Where a wall is in the way and nothing else rests there the branch ends, and nothing is left undone.
#[test]
fn a_branch_ends_at_a_wall() {
    let text = r#"(states: ["x", "v"], parameters: {"f": 0.0}, modes: {"free": (
        rates: {"x": "v", "v": "f - x - 0.1*v"}, until: [(zero: "1 - x", to: "free", reset: {"v": "-0.8*v"})])})"#;
    let course = Course {
        system: text,
        mode: "free",
        state: &[0.0, 0.0],
        parameter: "f",
        range: (-0.5, 2.0),
    };
    let found = course.events();
    meets(&found, BE, "f", 1.0, &[("x", 1.0), ("v", 0.0)]);
    assert!(
        found[0].what.contains("the branch ends"),
        "{}",
        found[0].what
    );
}

/// Where the other field points away from the boundary motions leave it on both sides: the equilibria of the sliding field are none of a
/// motion, however slowly that field leads away, and the branch ends as at a wall. Where it points at the boundary they go on.
#[test]
fn a_branch_ends_where_the_field_beyond_points_away() {
    for push in [0.346, 1e-5, -0.346, -1e-5] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"mu": 0.2}}, modes: {{
                "left": (rates: {{"x": "-2.765*x - 1.284*y + 0.172*mu", "y": "7.131*x + 2.042*y + 0.192*mu"}},
                    until: [(zero: "-x", to: "right")]),
                "right": (rates: {{"x": "{push:?} - 0.003*y", "y": "-0.289 - 0.032*x"}}, until: [(zero: "x", to: "left")]),
            }}, sliding: {{"slide": ("left", "right")}})"#
        );
        let course = Course {
            system: &text,
            mode: "left",
            state: &[-0.034, 0.1],
            parameter: "mu",
            range: (-0.3, 0.3),
        };
        for (units, reversed) in [([1.0; 2], false), ([1e4, 1e-3], true)] {
            let found = events(&course.all(&units, reversed));
            let [end] = &found[..] else {
                panic!("{push}: {found:#?}");
            };
            assert_eq!(end.kind, BE);
            assert!(number(end, "mu").abs() < 1e-12);
            let ends = end.what.contains("the branch ends");
            assert_eq!(ends, push > 0.0, "{push}: {}", end.what);
        }
    }
}

/// An equilibrium of sliding comes to a point where both fields are tangent to the surface: there they are opposite, what pushes
/// vanishes on both sides at once, and beyond both lead away. It rests at x = 2/3, y = 1/3 with l = 1/3, for every value of the
/// parameter, and both pushes are multiples of mu + x.
#[test]
fn sliding_ends_where_both_fields_are_tangent() {
    let course = Course {
        system: r#"(states: ["x", "y", "z"], parameters: {"mu": 0.0}, modes: {
            "above": (rates: {"x": "1", "y": "y - x", "z": "-(mu + x)"}, until: [(zero: "z", to: "below")]),
            "below": (rates: {"x": "-2", "y": "1 - y", "z": "2*(mu + x) + x + y - 1"}, until: [(zero: "-z", to: "above")]),
        }, sliding: {"slide": ("above", "below")})"#,
        mode: "slide",
        state: &[0.66, 0.33, 0.0],
        parameter: "mu",
        range: (-2.0, 0.5),
    };
    for (units, reversed) in [([1.0; 3], false), ([1e3, 1.0, 1e-3], true)] {
        let found = events(&course.all(&units, reversed));
        let [end] = &found[..] else {
            panic!("{found:#?}");
        };
        assert_eq!(end.kind, BE);
        assert!((number(end, "mu") + 2.0 / 3.0).abs() < 1e-12, "{end:?}");
        assert!(end.what.contains("the branch ends"), "{}", end.what);
    }
    // in the plane an equilibrium in sliding comes to where neither field pushes: there is no field beside it that would tell how
    // perturbations grow. Of both fields the rates of x on x = 0 are zero together
    for (fields, state, at) in [
        (
            [
                "0.65*x + 0.66*y - 0.07 + 0.04*a",
                "-0.51*x - 1.65*y - 0.94 - 0.51*a",
                "0.17*x + 0.11*y - 0.1 + 0.59*a",
                "-1.23*x - 0.68*y + 0.1 + 0.89*a",
            ],
            -0.429_135_691_107_409_4,
            (1.0, 0.53 / 3.5),
        ),
        (
            [
                "2.04*x - 2.56*y - 0.87 - 0.28*a",
                "0.42*x - 0.57*y + 3.32 - 0.67*a",
                "-0.45*x - 0.22*y + 0.23 - 1.06*a",
                "-2.02*x - 0.23*y - 0.35 - 0.39*a",
            ],
            1.768_704_542_246_862_8,
            (-0.86, 0.7802 / 2.652),
        ),
    ] {
        let [u, v, p, q] = fields;
        let (first, value) = at;
        let system = format!(
            r#"(states: ["x", "y"], parameters: {{"a": {first:?}}}, modes: {{
                "plus": (rates: {{"x": "{u}", "y": "{v}"}}, until: [(zero: "x", to: "minus")]),
                "minus": (rates: {{"x": "{p}", "y": "{q}"}}, until: [(zero: "-x", to: "plus")]),
            }}, sliding: {{"slide": ("plus", "minus")}})"#
        );
        let course = Course {
            system: &system,
            mode: "slide",
            state: &[0.0, state],
            parameter: "a",
            range: (-3.0, 3.0),
        };
        for units in [[1.0; 2], [1e6, 1e-3]] {
            let all = course.all(&units, false);
            let ends = all.iter().filter(|item| item.point.kind == Some(BE));
            let [end] = &ends.collect::<Vec<_>>()[..] else {
                panic!("{:#?}", events(&all));
            };
            assert!((end.point.parameters[0] - value).abs() <= 1e-13);
            assert_eq!(end.point.stable, Stability::Undecided);
            let others = all.iter().filter(|item| item.point.kind.is_none());
            assert!(
                others
                    .clone()
                    .all(|item| item.point.stable == Stability::Yes)
            );
        }
    }
}

/// Of prey and predators that both are caught beyond y = al, sliding rests at d = x/(b + x) − (h/q)(1 − x − al/(b + x)), from (1 − x)(b + x) = al to
/// (1 − x − q)(b + x) = al: wherever on it the branch begins, in whatever units.
#[test]
fn a_branch_begins_anywhere_in_sliding_whose_direction_turns() {
    let (b, h, q, al) = (0.514, 0.398, 0.337, 0.124);
    let text = r#"(states: ["x", "y"], parameters: {"b": 0.514, "h": 0.398, "q": 0.337, "al": 0.124, "d": 0.535}, modes: {
        "low": (rates: {"x": "x*(1 - x) - x*y/(b + x)", "y": "x*y/(b + x) - d*y"}, until: [(zero: "al - y", to: "high")]),
        "high": (rates: {"x": "x*(1 - x) - x*y/(b + x) - q*x", "y": "x*y/(b + x) - (d + h)*y"}, until: [(zero: "y - al", to: "low")]),
        }, sliding: {"slide": ("low", "high")})"#;
    // the larger root of (u − x)(b + x) = al
    let root = |u: f64| 0.5 * (u - b + ((u + b) * (u + b) - 4.0 * al).sqrt());
    let [low, high] = [root(1.0), root(1.0 - q)];
    for part in [0.02, 0.2, 0.4, 0.6, 0.8, 0.98] {
        let x = high + part * (low - high);
        let d = x / (b + x) - (h / q) * (1.0 - x - al / (b + x));
        let text = text.replace("\"d\": 0.535", &format!("\"d\": {d:?}"));
        let course = Course {
            system: &text,
            mode: "slide",
            state: &[x, al],
            parameter: "d",
            range: (0.02, 0.9),
        };
        for (units, reversed) in [([1.0, 1.0], false), ([1e-6, 1e3], true)] {
            let found = events(&course.all(&units, reversed));
            let scaled = |x: f64| [("x", x / units[0])];
            meets(&found, BE, "d", low / (b + low), &scaled(low));
            meets(&found, BE, "d", high / (b + high) - h, &scaled(high));
        }
    }
}

/// x' = Ax + bm + d|kx - c|: on either side of the kink x is affine in m, and from one to the other the branch goes on whatever units
/// make of its corner. There the parameter turns back, or the number of eigenvalues that grow jumps, or nothing is said. At m = 0 the
/// kink is met at x = y = 0.
#[test]
fn a_branch_goes_round_the_corners_of_its_rates() {
    let bent = |rates: [&str; 2]| {
        format!(
            r#"(states: ["x", "y"], parameters: {{"m": 0.5}},
            modes: {{"bent": (rates: {{"x": "{}", "y": "{}"}})}})"#,
            rates[0], rates[1]
        )
    };
    // by A ± dk: both determinants have one sign, or not; and how many eigenvalues grow where the operand is negative, and positive
    for (rates, state, said) in [
        (
            ["0.2*x + 0.3*abs(x) - y", "x - 0.4*y + m"],
            [-0.48, 0.05],
            Some((HB, "jumps from 0 to 2")),
        ),
        (
            ["0.1*x - 0.3*abs(x) - y + m", "x - 0.2*y"],
            [0.096, 0.48],
            Some((HB, "jumps from 0 to 2")),
        ),
        (
            ["-x - 0.5*max(x, 0) - y + m", "x - 0.2*y"],
            [0.077, 0.38],
            None,
        ),
        (["m - abs(x)", "x - y"], [0.5, 0.5], Some((LP, "fold in m"))),
    ] {
        for (units, reversed) in [([1.0; 2], false), ([1e4, 1e-3], true), ([1e-2, 1e5], false)] {
            let system = bent(rates);
            let course = Course {
                system: &system,
                mode: "bent",
                state: &state,
                parameter: "m",
                range: (-1.0, 1.0),
            };
            let items = course.all(&units, reversed);
            let found = events(&items);
            match (&found[..], said) {
                ([], None) => {}
                ([one], Some((kind, words))) => {
                    assert_eq!(one.kind, kind, "{rates:?}");
                    assert!(number(one, "m").abs() < 1e-12, "{one:?}");
                    assert!(one.what.contains(words), "{}", one.what);
                }
                _ => panic!("{rates:?} {units:?}: {found:#?}"),
            }
        }
    }
}

/// The folds of ẋ = a + 2σ(k(x − 1)) − x are where 2kσ(1 − σ) = 1, however little of σ there is where the branch begins: there a step
/// and its slope are below rounding, and rates look linear as far as one likes.
#[test]
fn a_branch_begins_where_a_law_has_come_to_its_end() {
    for k in [20.0_f64, 100.0, 300.0] {
        for law in [
            format!("1 + tanh({:?}*(x - 1))", 0.5 * k),
            format!("2/(1 + exp({:?}*(x - 1)))", -k),
            format!("2*exp({k:?}*(x - 1))/(exp({k:?}*(x - 1)) + 1)"),
        ] {
            let s = 0.5 * (1.0 - (1.0 - 2.0 / k).sqrt());
            let fold = 1.0 + (s / (1.0 - s)).ln() / k - 2.0 * s;
            let system = format!(
                r#"(states: ["x"], parameters: {{"a": 0.2}}, modes: {{"flow": (rates: {{"x": "a + {law} - x"}})}})"#
            );
            let course = Course {
                system: &system,
                mode: "flow",
                state: &[0.2],
                parameter: "a",
                range: (-1.5, 1.5),
            };
            for units in [1.0, 1e6, 1e-5] {
                let found = course.all(&[units], false);
                let folds: Vec<f64> = events(&found).iter().map(|one| number(one, "a")).collect();
                assert_eq!(folds.len(), 2, "{law}: {folds:?}");
                for (one, other) in folds.iter().zip([fold, -fold]) {
                    assert!((one - other).abs() < 1e-12, "{law}: {one} {other}");
                }
            }
        }
    }
}

/// A state that is 1e-19 where the branch begins, and 2 elsewhere: v − v³/3 − w + I = 0 with w = 2σ(k(v − 0.1)) has its folds at v = −1,
/// where σ is nothing, and where 1 − v² = 2kσ(1 − σ).
#[test]
fn a_state_may_be_next_to_nothing_where_a_branch_begins() {
    let system = r#"(states: ["v", "w"], parameters: {"I": -2.0}, modes: {"flow": (rates:
        {"v": "v - v^3/3 - w + I", "w": "0.3*(1 + tanh(10*(v - 0.1)) - w)"})})"#;
    let course = Course {
        system,
        mode: "flow",
        state: &[-2.2, 0.0],
        parameter: "I",
        range: (-2.5, 4.0),
    };
    let found = course.all(&[1.0; 2], false);
    let all = events(&found);
    let folds = all.iter().filter(|one| one.kind == LP);
    let folds: Vec<f64> = folds.map(|one| number(one, "v")).collect();
    assert_eq!(folds.len(), 4, "{folds:?}");
    for v in folds {
        let slope = 10.0 / (10.0 * (v - 0.1)).cosh().powi(2);
        assert!((1.0 - v * v - slope).abs() < 1e-9, "{v}");
    }
}

/// A spring of Hertz, whose force has a slope where it is touched and no value before, from both sides: in one mode, and in one of its own.
#[test]
fn a_contact_of_hertz_is_touched_from_both_sides() {
    let rate = "F - x - 0.2*v";
    let whole = format!(
        r#"(states: ["x", "v"], parameters: {{"F": START}}, modes: {{"free":
        (rates: {{"x": "v", "v": "{rate} - 3*max(0, x - 0.5)^1.5"}})}})"#
    );
    let parted = format!(
        r#"(states: ["x", "v"], parameters: {{"F": START}}, modes: {{
        "free": (rates: {{"x": "v", "v": "{rate}"}}, until: [(zero: "0.5 - x", to: "touch")]),
        "touch": (rates: {{"x": "v", "v": "{rate} - 3*(x - 0.5)^1.5"}}, until: [(zero: "x - 0.5", to: "free")])}})"#
    );
    // F = x + 3(x − 1/2)^1.5
    let pressed = 0.5 + 0.25 + 3.0 * 0.125;
    for (start, x, modes) in [
        ("0.2", 0.2, ["free"; 2]),
        ("1.125", 0.75, ["free", "touch"]),
    ] {
        assert_eq!(pressed, 1.125);
        for (text, mode) in [&whole, &parted].into_iter().zip(modes) {
            let system = text.replace("START", start);
            let course = Course {
                system: &system,
                mode,
                state: &[x, 0.0],
                parameter: "F",
                range: (0.1, 1.2),
            };
            for units in [[1.0; 2], [1e4, 1e-3]] {
                let found = course.all(&units, false);
                let all = events(&found);
                if *text == whole {
                    assert!(all.is_empty(), "{all:?}");
                    continue;
                }
                assert_eq!(all.len(), 1, "{all:?}");
                assert_eq!(all[0].kind, BE);
                assert!((number(&all[0], "F") - 0.5).abs() < 1e-12, "{all:?}");
            }
        }
    }
}

/// What a power is of becomes negative with nothing that ends there: the rates have no value beyond, and the branch goes no further.
#[test]
fn a_branch_ends_where_its_rates_do() {
    let system = r#"(states: ["x"], parameters: {"F": 1.0}, modes: {"flow": (rates: {"x": "F - x - x^1.5"})})"#;
    let course = Course {
        system,
        mode: "flow",
        state: &[0.56],
        parameter: "F",
        range: (-0.5, 1.5),
    };
    let mut runner = runner(&course.problem(&[1.0], false, ""), None);
    let all = events(&to_its_end(&mut runner));
    assert_eq!(all.len(), 1, "{all:?}");
    assert_eq!(all[0].kind, MX);
    assert!(number(&all[0], "F").abs() < 1e-6, "{all:?}");
}

/// Without a load a contact of Hertz is open however far: the branch ends on that half-line, where F is zero all along.
#[test]
fn a_branch_ends_on_a_half_line_of_equilibria() {
    let course = Course {
        system: r#"(states: ["x", "v"], parameters: {"F": 0.5}, modes: {"flow": (rates: {"x": "v", "v": "F - 0.1*v - max(0, x)^1.5"})})"#,
        mode: "flow",
        state: &[0.6, 0.0],
        parameter: "F",
        range: (-0.5, 2.0),
    };
    for units in [[1.0; 2], [1e4, 1e-3]] {
        let found = course.all(&units, false);
        assert!(found.len() < 2000, "{}", found.len());
        let all = found.iter().filter_map(|item| item.event.clone());
        let ends = all.filter(|event| event.what.contains("grow without bound"));
        let [end] = &ends.collect::<Vec<_>>()[..] else {
            panic!("{:#?}", events(&found));
        };
        assert!(number(end, "F").abs() <= 1e-12 && number(end, "x") < 0.0);
    }
}

/// Where a relay leaves its sliding, no rate of the mode that it comes to has the state that slides: that mode is at rest at this value of
/// the parameter alone, with any such state. Nothing goes on, as at a wall. There px + ry is the bound of the relay.
#[test]
fn a_branch_ends_where_equilibria_have_one_value_of_the_parameter() {
    let text = r#"(states: ["s", "x", "y"],
        parameters: {"p": 0.96, "r": 0.09, "mu": -0.42, "k": 0.58, "c0": 0.0, "b1": -0.2, "M": 0.42},
        contacts: {"q": Friction(slip: "s", bound: "M")},
        rates: {"s": "p*x + r*y + q", "x": "mu*x - y - x*(x^2 + y^2) - k*q", "y": "x + mu*y - y*(x^2 + y^2) + c0 + b1*x^2"})"#;
    let course = Course {
        system: text,
        mode: "stick",
        state: &[0.0, 0.0, 0.0],
        parameter: "c0",
        range: (-3.0, 3.0),
    };
    let found = course.events();
    let ends: Vec<_> = found.iter().filter(|one| one.kind == BE).collect();
    assert!(!ends.is_empty() && ends.len() == found.len());
    for one in ends {
        let force = 0.96 * number(one, "x") + 0.09 * number(one, "y");
        assert!((force.abs() - 0.42).abs() < 1e-12, "{force}");
        assert!(one.what.contains("the branch ends"), "{}", one.what);
    }
}

/// A relay whose bound is the force of a closed stop, with no load along it: where the stop lifts off the bound is zero, and beyond it
/// every mode has the equilibrium on its boundary. The branch ends there in all units and orders, and says so.
#[test]
fn a_branch_ends_where_no_mode_has_the_equilibrium_within() {
    let first = r#""q": Friction(slip: "s", bound: "f*n"), "n": Stop(gap: "z", restitution: "0")"#;
    let second = r#""n": Stop(gap: "z", restitution: "0"), "q": Friction(slip: "s", bound: "f*n")"#;
    for (contacts, mode) in [(first, "stick.closed"), (second, "closed.stick")] {
        let text = format!(
            r#"(states: ["s", "x", "y", "z", "w"],
            parameters: {{"p": 0.43, "r": 0.15, "mu": -0.29, "k": 0.43, "b1": 0.05, "N": 1.31, "h": -0.74, "f": 0.4}},
            contacts: {{{contacts}}},
            rates: {{"s": "p*x + r*y - 0.5*s + q", "x": "mu*x - y - x*(x^2 + y^2) - k*q",
                "y": "x + mu*y - y*(x^2 + y^2) + b1*x^2", "z": "w", "w": "-N + h*x - 0.3*w - 0.5*z + n"}})"#
        );
        let course = Course {
            system: &text,
            mode,
            state: &[0.0; 5],
            parameter: "N",
            range: (-0.55, 2.0),
        };
        for (units, reversed) in [
            ([1.0; 5], false),
            ([1.0, 10.0, 0.1, 1.0, 3.0], true),
            ([1e3; 5], false),
        ] {
            let mut runner = runner(&course.problem(&units, reversed, ""), None);
            let all = to_its_end(&mut runner);
            let found = events(&all);
            let kinds: Vec<EventType> = found.iter().map(|one| one.kind).collect();
            assert_eq!(kinds, [BE, MX], "{mode} in {units:?}: {found:#?}");
            assert!(found.iter().all(|one| number(one, "N").abs() < 1e-12));
            assert!(
                found[1].what.contains("is zero but for rounding"),
                "{}",
                found[1].what
            );
        }
    }
}

/// Events do not depend on units and order of the states, however large or small.
#[test]
fn units_and_order_of_the_states_make_no_difference() {
    for course in STARTS {
        let own = course.events();
        for (units, reversed) in [
            ([1e6, 1e6, 1e6, 1e6], false),
            ([1e-6, 1e-6, 1e-6, 1e-6], true),
            ([1e6, 1e-6, 1e3, 1e-3], true),
        ] {
            let other = events(&course.all(&units, reversed));
            let kinds =
                |all: &[EquilibriumEvent]| all.iter().map(|one| one.kind).collect::<Vec<_>>();
            assert_eq!(kinds(&own), kinds(&other), "{}", course.system);
            for (one, other) in own.iter().zip(&other) {
                let [one_at, other_at] = [one, other].map(|event| number(event, course.parameter));
                let off = (one_at - other_at).abs();
                assert!(
                    off <= 1e-12 * one_at.abs().max(1e-2),
                    "{}: {off:e}",
                    course.system
                );
                assert_eq!(one.omega.is_some(), other.omega.is_some());
                let what =
                    |event: &EquilibriumEvent| event.what.split(' ').next().unwrap().to_owned();
                assert_eq!(what(one), what(other));
            }
        }
    }
}

/// The number of growing eigenvalues changes at events alone, by what passes there.
#[test]
fn stability_changes_at_events_only() {
    for course in STARTS {
        let all = course.all(&[1.0; 9], false);
        for pair in all.windows(2) {
            let [one, other] = [&pair[0].point, &pair[1].point];
            if one.leg != other.leg || pair.iter().any(|item| item.event.is_some()) {
                continue;
            }
            assert_eq!(one.unstable, other.unstable, "{}: {one:?}", course.system);
            let stable = if one.unstable == 0 {
                Stability::Yes
            } else {
                Stability::No
            };
            assert_eq!(one.stable, stable);
        }
    }
}

/// The problem of the branch that leaves that of a course at its first branch point, and this point.
fn switched(course: &Course, units: &[f64]) -> (SystemProblem, NamedEquilibrium) {
    let all = course.all(units, false);
    let at = all.iter().find(|item| item.point.kind == Some(BP)).unwrap();
    let named = NamedEquilibrium {
        saved: at.saved.clone().unwrap(),
        kind: Some(BP),
    };
    let mut problem = course.problem(units, false, "");
    let start = r#"(start: Switch(dir: "earlier", label: 2))"#;
    problem.equilibrium = Some(ron::from_str(start).unwrap());
    (problem, named)
}

/// On the branch that leaves a pitchfork y = x², mu = −x² + qx⁴: it turns at x = 1/√(2q), mu = −1/(4q).
#[test]
fn the_other_branch_leaves_a_branch_point() {
    for q in [1.0, 0.7] {
        let text = PITCHFORK.replace("\"q\": 1.0", &format!("\"q\": {q:?}"));
        let course = Course {
            system: &text,
            ..STARTS[5]
        };
        let (problem, named) = switched(&course, &[1.0; 2]);
        let found = events(&followed(runner(&problem, Some(&named))));
        let x = FRAC_1_SQRT_2 / f64::sqrt(q);
        let sign = number(&found[0], "x").signum();
        meets(
            &found,
            LP,
            "mu",
            -0.25 / q,
            &[("x", sign * x), ("y", 0.5 / q)],
        );
        // no other branch leaves at another label
        let named = NamedEquilibrium {
            kind: Some(EP),
            ..named
        };
        let section = problem.continuation.as_ref().unwrap();
        assert!(EquilibriumRunner::begin(&problem, section, Some(&named)).is_err());
    }
}

/// The problem of the cycles that are born at the first Hopf point of a course, this point, and its event.
fn to_cycles(course: &Course, units: &[f64]) -> (SystemProblem, EarlierPoint, EquilibriumEvent) {
    let all = course.all(units, false);
    let at = all.iter().find(|item| item.point.kind == Some(HB)).unwrap();
    let named = EarlierPoint::Equilibrium(NamedEquilibrium {
        saved: at.saved.clone().unwrap(),
        kind: Some(HB),
    });
    let mut problem = course.problem(units, false, "stability: ()");
    problem.equilibrium = None;
    problem.orbit = ron::from_str(r#"(start: Switch(dir: "earlier", label: 2))"#).unwrap();
    (problem, named, at.event.clone().unwrap())
}

/// The first of these cycles.
fn first_cycle(problem: &SystemProblem, named: &EarlierPoint) -> OrbitPoint {
    let section = problem.continuation.as_ref().unwrap();
    let mut runner = OrbitRunner::begin(problem, section, Some(named)).unwrap();
    runner.step().remove(0).point
}

/// Where the direction of the difference of two affine fields turns along the surface of sliding, its field is none that is affine: the cycle that is born
/// has the frequency of the Hopf point, which 40 digits of an independent program have, too.
#[test]
fn a_cycle_is_born_in_sliding() {
    let course = Course {
        system: r#"(states: ["x", "y", "z"], parameters: {"a": 1.22}, modes: {
            "plus": (rates: {"x": "-0.84*x - 0.22*y + 0.05*z - 0.96 + 1.68*a", "y": "-0.43*x - 0.7*y - 0.68*z + 0.35 + 0.77*a",
                "z": "-0.82*x - 1.57*y - 0.26*z - 1.97 + 0.05*a"}, until: [(zero: "x", to: "minus")]),
            "minus": (rates: {"x": "0.4*x + 0.91*y + 0.65*z + 0.9 - 0.75*a", "y": "2.46*x + 0.32*y - 0.46*z - 0.16 - 0.04*a",
                "z": "1.87*x - 1.05*y + 0.97*z - 0.97 - 0.16*a"}, until: [(zero: "-x", to: "plus")]),
            }, sliding: {"slide": ("plus", "minus")})"#,
        mode: "plus",
        state: &[
            2.292_766_503_350_064,
            -2.998_508_702_792_974_7,
            3.533_038_963_991_992,
        ],
        parameter: "a",
        range: (-3.0, 3.0),
    };
    for units in [[1.0; 3], [1e3, 1.0, 1e-3]] {
        let (problem, named, event) = to_cycles(&course, &units);
        let value = 0.255_685_903_927_820_137;
        let omega = 0.440_561_789_292_341;
        assert!((number(&event, "a") - value).abs() <= 2.0 * event.uncertainty);
        assert!((number(&event, "omega") - omega).abs() <= 1e-13);
        let first = first_cycle(&problem, &named);
        assert_eq!(first.stable, Some(Stability::Yes));
        let turn = std::f64::consts::TAU / omega;
        assert!((first.period / turn - 1.0).abs() < 0.1, "{}", first.period);
    }
}

/// The cycle of a supercritical Hopf point and that of a subcritical one, in the direction that l₁ says.
#[test]
fn cycles_are_born_at_hopf_points() {
    for (course, value, period) in [
        (STARTS[0], 2.5, 6.577_284_341_905_833_303_4),
        (STARTS[2], 24.0, 0.679_336_764_198_218_261_75),
    ] {
        let (mut problem, named, event) = to_cycles(&course, &[1.0; 3]);
        let born = number(&event, course.parameter);
        let section = problem.continuation.as_mut().unwrap();
        section.stop_at = vec![brakewave::problem::UserPoint::Parameter(value)];
        let section = section.clone();
        let mut runner = OrbitRunner::begin(&problem, &section, Some(&named)).unwrap();
        let first = runner.step().remove(0).point;
        let index = problem.parameter().unwrap();
        let moved = first.parameters[index] - born;
        assert!(
            moved * (value - born) > 0.0 && moved.abs() < 0.01 * born,
            "{moved}"
        );
        let stable = if value > born {
            Stability::Yes
        } else {
            Stability::No
        };
        assert_eq!(first.stable, Some(stable));
        let found = loop {
            let items = runner.step();
            assert!(runner.progress().end.is_none());
            let user = items
                .into_iter()
                .find(|item| item.point.kind == Some(EventType::UZ));
            if let Some(user) = user {
                break user;
            }
        };
        let off = found.point.period / period - 1.0;
        assert!(off.abs() <= 1e-12, "{off:e}");
    }
}

/// Beside a Hopf point of what is slow and fast the cycle that is born there repels, and a relaxation oscillation of five times its period lies
/// about it: the branch begins with the former.
#[test]
fn the_cycle_that_is_born_is_no_other_one() {
    let course = Course {
        system: r#"(states: ["v", "w"], parameters: {"I": 0.2, "e": 0.02, "g": 0.5}, modes: {"flow": (rates: {
            "v": "3*v - v^3 + 2 - w + I", "w": "e*(6*(1 + tanh(v/g)) - w)"})})"#,
        mode: "flow",
        state: &[-1.0, 0.2],
        parameter: "I",
        range: (0.15, 0.3),
    };
    let (problem, named, event) = to_cycles(&course, &[1.0; 2]);
    let turn = std::f64::consts::TAU / number(&event, "omega");
    let first = first_cycle(&problem, &named);
    assert_eq!(first.stable, Some(Stability::No));
    assert!((first.period / turn - 1.0).abs() < 0.1, "{}", first.period);
}

/// A run that goes on from its saved state finds the same points.
#[test]
fn a_saved_run_goes_on_as_if_it_had_not_been_interrupted() {
    for course in [STARTS[2], STARTS[6]] {
        let problem = course.problem(&[1.0; 3], false, "");
        let section = problem.continuation.as_ref().unwrap();
        let whole = followed(runner(&problem, None));
        let mut begun = runner(&problem, None);
        let mut all = Vec::new();
        for _ in 0..40 {
            all.extend(begun.step());
        }
        let saved = ron::to_string(&begun.state()).unwrap();
        let progress: EquilibriumProgress = ron::from_str(&saved).unwrap();
        let first = all[0].saved.clone().unwrap();
        let resumed = EquilibriumRunner::resume(&problem, section, &first, progress).unwrap();
        all.extend(followed(resumed));
        let points = |all: &[EquilibriumItem]| {
            all.iter()
                .map(|item| item.point.clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(points(&all), points(&whole));
        // what is not of the problem is refused
        let mut progress = begun.state();
        progress.beside.units.pop();
        let refused = EquilibriumRunner::resume(&problem, section, &first, progress);
        assert!(matches!(
            refused.err(),
            Some(special::ResumeMismatch::Progress)
        ));
    }
}

/// What is no equilibrium of the system is refused, and what is wrong with it told.
#[test]
fn a_start_that_is_none_is_refused() {
    let refused = |course: Course| {
        let problem = course.problem(&[1.0; 3], false, "");
        let section = problem.continuation.as_ref().unwrap();
        let error = EquilibriumRunner::begin(&problem, section, None).err();
        error.unwrap().to_string()
    };
    // beyond its own guard
    let words = refused(Course {
        mode: "high",
        ..STARTS[6]
    });
    assert!(words.contains("of `high`"), "{words}");
    // a line of equilibria
    let text = r#"(states: ["x", "y"], parameters: {"a": 1.0}, modes: {"m": (rates: {"x": "a*y - a", "y": "a*y - a"})})"#;
    let course = Course {
        system: text,
        mode: "m",
        state: &[0.0, 0.0],
        parameter: "a",
        range: (0.5, 2.0),
    };
    refused(course);
    // none at all
    let text =
        r#"(states: ["x"], parameters: {"a": 1.0}, modes: {"m": (rates: {"x": "a + x^2"})})"#;
    refused(Course {
        system: text,
        mode: "m",
        state: &[0.3],
        parameter: "a",
        range: (0.5, 2.0),
    });
}

/// Two equal cells: both eigenvalues of the middle are mu, with one vector or with two.
#[test]
fn two_eigenvalues_pass_zero_together() {
    for coupling in ["", " + y"] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"mu": -1.0}}, modes: {{"flow": (rates: {{"x": "mu*x{coupling} - x^3 - 0.3*x*y^2",
                "y": "mu*y - y^3 - 0.3*y*x^2"}})}})"#
        );
        let course = Course {
            system: &text,
            state: &[0.0, 0.0],
            parameter: "mu",
            range: (-1.5, 1.0),
            ..STARTS[0]
        };
        let all = course.events();
        assert_eq!(all.len(), 1, "{all:#?}");
        meets(&all, BP, "mu", 0.0, &[("x", 0.0), ("y", 0.0)]);
        assert!(all[0].what.starts_with("2 eigenvalues"), "{}", all[0].what);
    }
}

/// n cells x' = px - x² + 1 + k(sum of all - nx): the n - 1 eigenvalues across x = (p + √(p² + 4))/2 are -√(p² + 4) - nk, zero at
/// p = √5 for nk = -3.
#[test]
fn many_branches_cross_where_a_symmetry_makes_eigenvalues_equal() {
    for cells in 3..=5 {
        let names: Vec<String> = (1..=cells).map(|cell| format!("x{cell}")).collect();
        let sum = names.join(" + ");
        let rate = |x: &String| format!("\"{x}\": \"p*{x} - {x}^2 + 1 + k*({sum} - {cells}*{x})\"");
        let rates: Vec<String> = names.iter().map(rate).collect();
        let text = format!(
            "(states: {names:?}, parameters: {{\"p\": 3.0, \"k\": {:?}}}, modes: {{\"flow\": (rates: {{{}}})}})",
            -3.0 / f64::from(cells),
            rates.join(", ")
        );
        let state = vec![3.3; names.len()];
        let course = Course {
            system: &text,
            state: &state,
            parameter: "p",
            range: (0.5, 4.0),
            ..STARTS[0]
        };
        let all = course.events();
        assert_eq!(all.len(), 1, "{all:#?}");
        let off = (number(&all[0], "p") - 5.0_f64.sqrt()).abs();
        let told = all[0].uncertainty;
        assert!(off <= told && told < 1e-10, "{off:e}, told {told:e}");
        assert!(
            all[0]
                .what
                .starts_with(&format!("{} eigenvalues", cells - 1))
        );
    }
}

/// Of switches with one `zero` the first whose conditions hold leads on: x = (mu + s)/(1 + s) in the mode with s = 0.3, or 0.5.
#[test]
fn conditions_of_a_switch_tell_where_an_equilibrium_goes_on() {
    for (least, slope) in [("0.5 - y", 0.5), ("y - 0.5", 0.3)] {
        let text = format!(
            r#"(states: ["x", "y"], parameters: {{"mu": 0.0}}, modes: {{
                "flow": (rates: {{"x": "mu - x", "y": "x - y"}},
                    until: [(zero: "1 - x", to: "B", if: ["{least}"]), (zero: "1 - x", to: "C")]),
                "B": (rates: {{"x": "mu - x - 0.3*(x - 1)", "y": "x - y"}}, until: [(zero: "x - 1", to: "flow")]),
                "C": (rates: {{"x": "mu - x - 0.5*(x - 1)", "y": "x - y"}}, until: [(zero: "x - 1", to: "flow")])}})"#
        );
        let course = Course {
            system: &text,
            state: &[0.0, 0.0],
            parameter: "mu",
            range: (-1.0, 2.0),
            ..STARTS[0]
        };
        let all = course.all(&[1.0; 9], false);
        meets(&events(&all), BE, "mu", 1.0, &[("x", 1.0), ("y", 1.0)]);
        let mut points = all.iter().map(|item| &item.point);
        let last = points.find(|point| point.parameters[0] == 2.0).unwrap();
        let x = (2.0 + slope) / (1.0 + slope);
        assert!((last.state[0] - x).abs() <= 1e-14, "{:?}", last.state);
    }
}

/// The equations of Lorenz leave the origin at r = 1 on a branch (x, x, r − 1), x² = 8(r − 1)/3, in whatever units.
#[test]
fn the_other_branch_is_found_in_all_units() {
    let course = Course {
        system: LORENZ,
        mode: "flow",
        state: &[0.0; 3],
        parameter: "r",
        range: (0.2, 30.0),
    };
    for units in [
        [1.0; 3],
        [1.0, 1e-3, 1.0],
        [1e-3; 3],
        [1e3; 3],
        [1.0, 1.0, 1e3],
    ] {
        let (problem, named) = switched(&course, &units);
        let found = followed(runner(&problem, Some(&named)));
        assert!(found.len() > 3, "{units:?}");
        for item in &found {
            let (state, r) = (&item.point.state, item.point.parameters[0]);
            let [x, y, z] = [0, 1, 2].map(|index| state[index] * units[index]);
            let size = (8.0 / 3.0 * (r - 1.0)).sqrt();
            assert!(
                (x.abs() - size).abs() <= 1e-9 * size.max(1e-3),
                "{units:?} {r} {x}"
            );
            assert!((y - x).abs() <= 1e-12 * size && (z - (r - 1.0)).abs() <= 1e-12 * r);
        }
    }
}

/// x' = px − cx² has for its other branch x = p/c, which is as small as one likes: it begins within the range, and has its event and both
/// of its ends there.
#[test]
fn the_other_branch_begins_within_the_range() {
    for c in [1.0, 512.0, 65536.0, 1e9] {
        let system = format!(
            r#"(states: ["x"], parameters: {{"p": -0.5}}, modes: {{"flow": (rates: {{"x": "p*x - {c:?}*x^2"}})}})"#
        );
        let course = Course {
            system: &system,
            mode: "flow",
            state: &[0.0],
            parameter: "p",
            range: (-1.0, 1.0),
        };
        let (problem, named) = switched(&course, &[1.0]);
        let found = followed(runner(&problem, Some(&named)));
        let of_type = |kind| {
            found
                .iter()
                .filter(move |item| item.point.kind == Some(kind))
        };
        let ends = of_type(EP).map(|item| item.point.parameters[0]);
        let ends: Vec<f64> = ends.filter(|p| p.abs() == 1.0).collect();
        assert_eq!(ends.len(), 2, "{c}: {ends:?}");
        assert_eq!(of_type(BP).count(), 1, "{c}");
        for item in &found {
            let (x, p) = (item.point.state[0], item.point.parameters[0]);
            assert!(p.abs() <= 1.0, "{c}: {p}");
            assert!(
                (c * x - p).abs() <= 1e-12 * p.abs().max(1e-3),
                "{c}: {p} {x}"
            );
        }
    }
}

/// Where a predator can live, at K = d, the branch without it is crossed by y = 1 − d/K: a state that is zero there is no unit, and the
/// branch is found.
#[test]
fn a_branch_leaves_one_on_which_a_state_is_zero() {
    let system = r#"(states: ["x", "y"], parameters: {"K": 0.7, "d": 0.4}, modes: {"flow": (
        rates: {"x": "x*(1 - x/K) - x*y", "y": "x*y - d*y"})})"#;
    let course = Course {
        system,
        mode: "flow",
        state: &[0.7, 0.0],
        parameter: "K",
        range: (0.1, 3.0),
    };
    for units in [[1.0; 2], [1.0, 1e3], [1e-3, 1.0]] {
        let (problem, named) = switched(&course, &units);
        let saved = &named.saved;
        assert!((saved.values[0] - 0.4).abs() <= 1e-14);
        assert_eq!(saved.state[1], 0.0);
        let found = followed(runner(&problem, Some(&named)));
        assert!(found.len() > 3, "{units:?}");
        for item in &found {
            let y = item.point.state[1] * units[1];
            let off = y - (1.0 - 0.4 / item.point.parameters[0]);
            assert!(off.abs() <= 1e-12, "{units:?}: {off:e}");
        }
    }
}

/// A circle of radius √mu around the origin, with one of three states that only follows in a nonlinear coordinate; and one of
/// radius √(1000 mu) in units of 1e-3 and 1e3.
#[test]
fn cycles_are_born_in_all_coordinates() {
    let follower = r#"(states: ["X", "y", "z"], parameters: {"mu": -0.2}, modes: {"flow": (rates:
        {"X": "-x + 0.6*y*f + 0.2*g", "y": "f", "z": "g"})}, define: {"x": "X - 0.3*y^2 - 0.2*z",
        "f": "mu*y - z - y*(y^2 + z^2)", "g": "y + mu*z - z*(y^2 + z^2)"})"#;
    let weak = r#"(states: ["u", "w"], parameters: {"mu": -0.2}, modes: {"flow": (rates:
        {"u": "0.001*f", "w": "1000*g"})}, define: {"x": "u/0.001", "y": "w/1000",
        "f": "mu*x - y - 0.001*x*(x^2 + y^2)", "g": "x + mu*y - 0.001*y*(x^2 + y^2)"})"#;
    for (system, states) in [(follower, 3), (weak, 2)] {
        let course = Course {
            system,
            mode: "flow",
            state: &[0.0; 3][..states],
            parameter: "mu",
            range: (-0.2, 1.0),
        };
        let (problem, named, _) = to_cycles(&course, &[1.0; 3]);
        let first = first_cycle(&problem, &named);
        let mu = first.parameters[0];
        assert!(mu > 0.0 && mu < 0.01, "{mu}");
        let period = std::f64::consts::TAU;
        assert!(
            (first.period / period - 1.0).abs() <= 1e-10,
            "{}",
            first.period
        );
        assert_eq!(first.stable, Some(Stability::Yes));
    }
}

/// A pendulum with drag |v|v rests at sin x = 0.2/k, down to the fold at k = 0.2; its eigenvalues know of no drag.
#[test]
fn drag_by_the_square_of_speed_is_smooth_at_rest() {
    let course = Course {
        system: r#"(states: ["x", "v"], parameters: {"k": 1.0}, modes: {"flow": (rates:
            {"x": "v", "v": "-k*sin(x) + 0.2 - 0.3*abs(v)*v - 0.1*v"})})"#,
        mode: "flow",
        state: &[0.2, 0.0],
        parameter: "k",
        range: (0.15, 1.0),
    };
    let mut problem = course.problem(&[1.0; 2], false, "");
    problem.continuation.as_mut().unwrap().toward = brakewave::problem::Toward::Down;
    let found = followed(runner(&problem, None));
    assert!(found.iter().any(|item| item.point.kind == Some(LP)));
    for item in &found {
        let k = item.point.parameters[0];
        assert!((k * item.point.state[0].sin() - 0.2).abs() <= 1e-14, "{k}");
    }
}

/// With drag q|v|v the rates have no third derivatives at the Hopf point μ = 0 of v̇ = μv − x − q|v|v, and its cycles grow in proportion to μ: averaged
/// over a turn they have the amplitude 3πμ/(8q), up to its square. The branch begins with one of them on the side on which they lie.
#[test]
fn a_cycle_is_born_where_drag_has_no_third_derivative() {
    for (q, side) in [(0.5, 1.0), (-0.5, -1.0)] {
        let system = format!(
            r#"(states: ["x", "v"], parameters: {{"mu": -0.3}}, modes: {{"flow": (rates:
                {{"x": "v", "v": "mu*v - x - ({q:?})*abs(v)*v"}})}})"#
        );
        let course = Course {
            system: system.leak(),
            mode: "flow",
            state: &[0.0, 0.0],
            parameter: "mu",
            range: (-0.5, 0.5),
        };
        let (problem, named, _) = to_cycles(&course, &[1.0; 2]);
        let first = first_cycle(&problem, &named);
        let mu = first.parameters[0];
        let amplitude = 3.0 * std::f64::consts::PI * mu / (8.0 * q);
        let off = first.extremes[0].1 / amplitude - 1.0;
        assert!(mu * side > 0.0 && off.abs() <= mu.abs(), "{mu} {off:e}");
        let stable = if side > 0.0 {
            Stability::Yes
        } else {
            Stability::No
        };
        assert_eq!(first.stable, Some(stable));
    }
}

/// Where a double is further from the next than a sine is long, whatever Newton's method comes to is chance.
#[test]
fn an_equilibrium_beyond_the_digits_of_a_sine_is_refused() {
    let course = Course {
        system: r#"(states: ["x"], parameters: {"mu": 0.5}, modes: {"flow": (rates: {"x": "mu - sin(pi*x)"})})"#,
        mode: "flow",
        state: &[0.5],
        parameter: "mu",
        range: (0.4, 0.6),
    };
    let problem = course.problem(&[1.0], false, "");
    let section = problem.continuation.as_ref().unwrap();
    assert!(EquilibriumRunner::begin(&problem, section, None).is_err());
}
