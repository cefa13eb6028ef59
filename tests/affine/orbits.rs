//! Periodic orbits against figures of an independent program in 40 digits: by Newton's method from a guess beside
//! them, with their multipliers; what is not physical is refused.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use brakewave::affine::orbit::{
    AffineOrbit, Margin, Multiplier, Scales, Sequence, Setting, Way, Zone, ZonePoint,
};
use brakewave::continuation::newton::{self, Equations as _, Fixed, Settings};
use brakewave::linalg::{Matrix, Vector};
use brakewave::orbit::sign::SignVerdict;
use brakewave::orbit::{Examined, MarginFunction, Zones};

use crate::affine::systems::{
    BALL, BUCK, CHUA, FRICTION, IMPACT, RELAY, THERMOSTAT, system, values,
};

/// A zone of a reference orbit: its mode, guard and exit by which it ends, the states at its entry, its duration.
pub type Part<'a> = (&'a str, (usize, usize), &'a [f64], f64);

/// A reference orbit.
pub struct Reference<'a> {
    pub text: &'a str,
    /// Values of parameters other than those of the text.
    pub replaced: &'a [(&'a str, f64)],
    /// The continuation parameter.
    pub parameter: &'a str,
    pub periods: u32,
    /// Phase of the first entry.
    pub phase: f64,
    pub zones: Vec<Part<'a>>,
}

impl Reference<'_> {
    /// The orbit and its point.
    pub fn posed(&self) -> (AffineOrbit, Vector) {
        let system = system(self.text);
        let values = values(&system, self.replaced);
        let parameter = system.source.parameters.index(self.parameter).unwrap();
        let value = values[parameter];
        let zone = |(mode, (guard, exit), ..): &Part| {
            let (guard, exit) = (*guard, *exit);
            let number = system.mode(mode).unwrap();
            Zone::new(number, Some(Way { guard, exit }), (*mode).to_owned())
        };
        let sequence = Sequence(self.zones.iter().map(zone).collect());
        let zones = self.zones.iter();
        let point =
            |(_, _, state, duration): &Part| ZonePoint::new(state.to_vec(), *duration, self.phase);
        let points: Vec<ZonePoint> = zones.map(point).collect();
        let states = points[0].state.len();
        let largest = |state: usize| {
            let sizes = points.iter().map(|point| point.state[state].abs());
            let largest = sizes.fold(0.0, f64::max);
            if largest > 0.0 { largest } else { 1.0 }
        };
        let setting = Setting {
            scales: Scales {
                states: (0..states).map(largest).collect(),
                time: points.iter().map(|point| point.duration).sum(),
                parameter: value.abs(),
                free: None,
                section: None,
            },
            system,
            values: values.clone(),
            parameter,
            second: None,
            periods: self.periods,
            prescribed: None,
            stability: true,
        };
        let orbit = AffineOrbit::new(Arc::new(setting), sequence).unwrap();
        let point = orbit.pack(&points, &values);
        (orbit, point)
    }
}

/// The solution next to a guess at the same value of the parameter.
pub fn solved(orbit: &AffineOrbit, guess: &Vector) -> Vector {
    let index = guess.len() - 1;
    let mut fixed = Fixed {
        index,
        value: guess[index],
    };
    let settings = Settings {
        tolerance: 1e-9,
        most_iterations: 20,
        halvings: 10,
        polish: 1,
    };
    let solution = newton::solve(orbit, &mut fixed, guess, &settings);
    solution
        .unwrap_or_else(|failure| panic!("{}: {failure}", orbit.signature()))
        .point
}

/// A point beside another one, every unknown but the parameter off by a part of its size and of its unit.
fn beside(point: &Vector, part: f64) -> Vector {
    let last = point.len() - 1;
    Vector::from_fn(point.len(), |index, _| {
        let way = if index % 2 == 0 { 1.0 } else { -0.7 };
        let off = if index == last { 0.0 } else { way * part };
        point[index] + off * (point[index].abs() + 0.1)
    })
}

/// Newton's method finds the orbit from a guess beside it, it is admissible, and has these multipliers, of which
/// the trivial ones are left out.
fn agrees(reference: &Reference, multipliers: &[(f64, f64)], allowed: f64) {
    let (orbit, exact) = reference.posed();
    let found = solved(&orbit, &beside(&exact, 1e-3));
    let error = (&found - &exact).amax();
    assert!(error < allowed, "{}: {error:e}", orbit.signature());
    let examination = orbit.examination(&found).unwrap();
    assert_eq!(
        examination.verdict(),
        SignVerdict::Positive,
        "{}: {:?}",
        orbit.signature(),
        examination.margins
    );
    let found = orbit.multipliers(&found).unwrap();
    compare(&found, multipliers, 1e-9);
}

fn compare(found: &[Multiplier], expected: &[(f64, f64)], allowed: f64) {
    let found: Vec<&Multiplier> = found.iter().filter(|one| !one.trivial).collect();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (re, im) in expected {
        let off = |one: &&Multiplier| (one.value.re - re).hypot(one.value.im.abs() - im.abs());
        let nearest = found.iter().map(off).fold(f64::INFINITY, f64::min);
        assert!(nearest < allowed * re.hypot(*im), "{re} + {im}i: {found:?}");
    }
}

const HIT: (usize, usize) = (0, 0);

pub fn impact(
    a: f64,
    w: f64,
    e: f64,
    periods: u32,
    phase: f64,
    parts: &[(f64, f64)],
) -> Reference<'static> {
    // kept for the life of the test
    let replaced: &[(&str, f64)] = Box::leak(Box::new([("A", a), ("w", w), ("e", e)]));
    let of = |(speed, duration): &(f64, f64)| -> Part<'static> {
        let state: &[f64] = Box::leak(Box::new([1.0, *speed]));
        ("free", HIT, state, *duration)
    };
    Reference {
        text: IMPACT,
        replaced,
        parameter: "A",
        periods,
        phase,
        zones: parts.iter().map(of).collect(),
    }
}

/// One impact in n forcing periods: amplitude, frequency, restitution, n, phase, speed after the impact, multipliers.
type OneImpact = (f64, f64, f64, u32, f64, f64, [(f64, f64); 2]);

const ONE_IMPACT: [OneImpact; 14] = [
    (
        1.0,
        1.0,
        0.8,
        1,
        0.075952164938312386,
        -1.3565863500759056,
        [
            (-0.584295314341529552, 5.60035149247355755e-3),
            (-0.584295314341529552, -5.60035149247355755e-3),
        ],
    ),
    (
        0.099998594845103814244,
        1.0,
        0.8,
        1,
        1.570208303134306936,
        -0.8e-4,
        [(3.3384355810011e-3, 0.0), (102.27316658179, 0.0)],
    ),
    (
        0.10003073315438780089,
        1.0,
        0.8,
        1,
        1.511978949307511566,
        -0.8e-2,
        [
            (-0.070089671431112, 0.58010328068111),
            (-0.070089671431112, -0.58010328068111),
        ],
    ),
    (
        1.7649773273825757072,
        1.0,
        0.8,
        1,
        0.03248584904357498797,
        -2.4,
        [(-0.6246102297042, 0.0), (-0.54663270318195, 0.0)],
    ),
    (
        0.36881288515939937896,
        0.8,
        0.8,
        1,
        0.21861929576821872695,
        -0.8e-4,
        [(-7787.630094537, 0.0), (-3.7469730614829e-5, 0.0)],
    ),
    (
        0.5182098665978725691,
        0.8,
        0.8,
        1,
        0.05597833864927695721,
        -0.36670290799114123201,
        [(-1.0, 0.0), (-0.291800401770237592, 0.0)],
    ),
    (
        1.4131241721262939522,
        0.8,
        0.8,
        1,
        6.1025828823406835697,
        -2.4,
        [
            (0.073819286630373, 0.53511785121749),
            (0.073819286630373, -0.53511785121749),
        ],
    ),
    (
        5.7653321906727901991,
        2.6,
        0.7,
        2,
        3.096468115875804437,
        -0.7e-4,
        [(3.3667225527623e-6, 0.0), (89760.383074277, 0.0)],
    ),
    (
        5.2338259374000322173,
        2.6,
        0.7,
        2,
        3.0785628021425505526,
        -0.07,
        [(3.6624393913786e-3, 0.0), (82.512848336038, 0.0)],
    ),
    (
        2.6794379724589190947,
        2.6,
        0.7,
        2,
        0.51138759597703415028,
        -1.0562806335170225308,
        [(-1.0, 0.0), (-0.302198306040752821, 0.0)],
    ),
    (
        7.3751726459191770445,
        2.6,
        0.7,
        2,
        0.26506002366543639886,
        -1.68,
        [(-3.42250800771, 0.0), (-0.088297326218079, 0.0)],
    ),
    (
        0.5,
        0.96055686213853381406,
        0.8,
        1,
        0.14803208268686207947,
        -0.60458907330201400535,
        [(-1.0, 0.0), (-0.332735918638166108, 0.0)],
    ),
    (
        0.11478307967502043179,
        1.0,
        0.8,
        1,
        1.0329541521245160273,
        -0.08,
        [
            (-0.53562005488673, 0.23354557392818),
            (-0.53562005488673, -0.23354557392818),
        ],
    ),
    (
        1.0347704084642434168,
        2.6,
        0.7,
        2,
        1.9617602293515751033,
        -0.7,
        [(0.19779365069872, 0.0), (1.5278463437689, 0.0)],
    ),
];

#[test]
fn impacts() {
    for (a, w, e, n, phase, speed, multipliers) in ONE_IMPACT {
        let reference = impact(a, w, e, n, phase, &[(speed, f64::from(n) * TAU / w)]);
        // where the amplitude is stationary in the speed, within 1e-2, rounding is magnified, and the unit of the
        // speed is the speed itself
        let allowed = 1e-13 + 1e-13 / speed.abs();
        agrees(&reference, &multipliers, allowed);
    }
    // period-doubled orbits
    for (a, phase, parts, multipliers) in [
        (
            2.8,
            0.15121077162682111439,
            [
                (-1.0214201077067689684, 5.1123434903017271254),
                (-0.7 * 1.6414248106947637051, 4.5540954438207136083),
            ],
            [(0.434775112661035771, 0.0), (0.210048398619125646, 0.0)],
        ),
        (
            3.2,
            -0.2146873386551423724,
            [
                (-1.0149500376370072391, 5.39515058134726184),
                (-0.7 * 1.9181042983376358108, 4.2712883527751788937),
            ],
            [
                (-0.161077069650633067, 0.255691207918194964),
                (-0.161077069650633067, -0.255691207918194964),
            ],
        ),
    ] {
        agrees(&impact(a, 2.6, 0.7, 4, phase, &parts), &multipliers, 1e-12);
    }
    // just beyond the inner graze of w = 1: multipliers 1e10 apart
    let (period, first) = (TAU, 2.797151310021434837);
    let parts = [
        (-0.8 * 78.847407992867087994, first),
        (-0.8 * 5.7659228008979810471, period - first),
    ];
    agrees(
        &impact(43.392, 1.0, 0.8, 1, 6.2362448496821027968, &parts),
        &[(1.7915226877476, 0.0), (0.12197262340319, 0.0)],
        1e-11,
    );
}

/// A mirrored orbit of the friction oscillator or the relay: the half that is listed, and its mirror image.
fn mirrored<'a>(half: &[Part<'a>], sides: [&'a str; 2], leave: &[(usize, usize)]) -> Vec<Part<'a>> {
    let mirror = |(mode, _, state, duration): &Part<'a>| -> Part<'a> {
        let mode = match *mode {
            mode if mode == sides[0] => sides[1],
            mode if mode == sides[1] => sides[0],
            mode => mode,
        };
        let state: Vec<f64> = state
            .iter()
            .map(|x| if *x == 0.0 { 0.0 } else { -x })
            .collect();
        (mode, HIT, Box::leak(state.into_boxed_slice()), *duration)
    };
    let other: Vec<Part> = half.iter().map(mirror).collect();
    let zones = half.iter().copied().chain(other).enumerate();
    zones
        .map(|(index, (mode, _, state, duration))| (mode, leave[index], state, duration))
        .collect()
}

/// To the other side, without sliding.
const ACROSS: (usize, usize) = (0, 1);
/// Into the sliding mode.
const SLIDE: (usize, usize) = (0, 0);
/// Out of it to the second mode, to the first mode.
const TO_SECOND: (usize, usize) = (1, 0);
const TO_FIRST: (usize, usize) = (0, 0);

#[test]
fn friction() {
    let sides = ["forth", "back"];
    for (w, f, z, phase, x, multipliers) in [
        (
            1.2,
            2.0 / 3.0,
            0.05,
            -1.3520017654536612819,
            -0.53178101201976595333,
            [(0.51760175539119, 0.0), (3.856446833743e-3, 0.0)],
        ),
        (
            0.8,
            2.0 / 3.0,
            0.05,
            -2.1458443767657065708,
            -1.4305683932561448141,
            [(0.25025680515731, 0.0), (0.036553270353106, 0.0)],
        ),
        (
            0.9,
            0.75,
            0.0,
            -2.0264968488168334116,
            -2.3162708292482406403,
            [(0.67103161008247, 0.0), (0.27404594857436, 0.0)],
        ),
    ] {
        let half: [Part; 1] = [("forth", HIT, &[x, 0.0], PI / w)];
        let reference = Reference {
            text: FRICTION,
            replaced: &[("w", w), ("F", f), ("z", z)],
            parameter: "w",
            periods: 1,
            phase,
            zones: mirrored(&half, sides, &[ACROSS, ACROSS]),
        };
        agrees(&reference, &multipliers, 1e-12);
    }
    for (w, f, z, phase, x, slip, stick, multiplier) in [
        (
            0.71545240249376171008,
            2.0 / 3.0,
            0.05,
            -2.3032631942093973473,
            -1.3353725171623816806,
            4.357457671131014839,
            0.033599850850240830015,
            0.10321522321173,
        ),
        (
            0.6,
            2.0 / 3.0,
            0.05,
            -2.144505454379887619,
            -1.2094177143471619223,
            4.5094310304971641205,
            0.72655672548582461022,
            0.041769776878522,
        ),
        (
            0.4,
            2.0 / 3.0,
            0.05,
            -1.7869324414372865923,
            -0.88112391422562296071,
            4.7764075458096469758,
            3.0775740881648361204,
            4.0028077767552e-5,
        ),
        (
            0.2,
            2.0 / 3.0,
            0.05,
            -1.3611598268195805181,
            -0.45856229484652130874,
            5.1915201634710192233,
            10.516443104477946969,
            0.10034701602216,
        ),
        (
            0.4,
            0.75,
            0.0,
            -1.718308894762335938,
            -0.896978171847362657,
            4.6348638108596637439,
            3.2191178231148193523,
            5.9981209125613e-3,
        ),
    ] {
        let half: [Part; 2] = [
            ("forth", HIT, &[x, 0.0], slip),
            ("stick", HIT, &[-x, 0.0], stick),
        ];
        let reference = Reference {
            text: FRICTION,
            replaced: &[("w", w), ("F", f), ("z", z)],
            parameter: "w",
            periods: 1,
            phase,
            zones: mirrored(&half, sides, &[SLIDE, TO_SECOND, SLIDE, TO_FIRST]),
        };
        agrees(&reference, &[(multiplier, 0.0)], 1e-12);
    }
    // four sticks and four slips, two of them in the same direction
    let half: [Part; 4] = [
        (
            "forth",
            HIT,
            &[-0.39581608441272093131, 0.0],
            5.6852434031345579906,
        ),
        (
            "stick",
            HIT,
            &[0.20678852307105568831, 0.0],
            0.93085635789890329802,
        ),
        (
            "forth",
            HIT,
            &[0.20678852307105568831, 0.0],
            4.5179433021212761055,
        ),
        (
            "stick",
            HIT,
            &[0.39581608441272093131, 0.0],
            15.243729007288530771,
        ),
    ];
    let reference = Reference {
        text: FRICTION,
        replaced: &[("w", 0.1191)],
        parameter: "w",
        periods: 1,
        phase: -1.2965197946550612807,
        zones: mirrored(
            &half,
            sides,
            &[
                SLIDE, TO_FIRST, SLIDE, TO_SECOND, SLIDE, TO_SECOND, SLIDE, TO_FIRST,
            ],
        ),
    };
    agrees(&reference, &[(0.0139578317534, 0.0)], 1e-11);
}

#[test]
fn relays() {
    let sides = ["plus", "minus"];
    let free: [Part; 1] = [(
        "plus",
        HIT,
        &[0.0, 2.8030472330855041814, 17.239363217161394745],
        2.9685919143220531125,
    )];
    fn reference(rho: f64, zones: Vec<Part>) -> Reference {
        Reference {
            text: RELAY,
            replaced: Box::leak(Box::new([("rho", rho)])),
            parameter: "rho",
            periods: 1,
            phase: 0.0,
            zones,
        }
    }
    let zones = mirrored(&free, sides, &[ACROSS, ACROSS]);
    agrees(
        &reference(3.0, zones),
        &[(0.018632788447793, 0.0), (2.2182699260034e-7, 0.0)],
        1e-12,
    );
    for (rho, z, free, end, slide, multiplier) in [
        (
            1.5,
            5.9042339488895954598,
            3.6070512840146894694,
            [0.0, -0.097338342645248712855, -6.0447046475305034517],
            0.11933457429700025655,
            3.9512137696839e-3,
        ),
        (
            0.5,
            1.4312760161786456437,
            4.9045064704668107268,
            [0.0, 0.84933803786073901757, -1.380785392854124102],
            1.406113152054230406,
            9.1982112037262e-5,
        ),
        (
            0.1,
            0.26086655101946477598,
            7.0802971962724096051,
            [0.0, 0.99281394786928852765, -0.21678980709164326959],
            11.219983001198370774,
            9.81353316197e-8,
        ),
        (
            0.03,
            0.07778861270967187489,
            8.6646070974508249149,
            [0.0, 0.99930755049376905659, -0.061568513606677125778],
            40.911799079020991942,
            4.14040024348e-10,
        ),
        (
            0.005,
            0.012955887721080258838,
            10.90996627283181604,
            [0.0, 0.99997958242495423877, -0.010044997595005497276],
            253.90013110789295566,
            1.23413788349e-13,
        ),
    ] {
        let start = [0.0, 1.0, z];
        let half: [Part; 2] = [("plus", HIT, &start, free), ("slide", HIT, &end, slide)];
        let zones = mirrored(&half, sides, &[SLIDE, TO_SECOND, SLIDE, TO_FIRST]);
        // the end of sliding is known to rounding over the rate of the control, which is rho squared
        agrees(
            &reference(rho, zones),
            &[(multiplier, 0.0)],
            1e-14 + 1e-15 / (rho * rho),
        );
    }
}

#[test]
fn chua() {
    for (alpha, start, upper, middle, inner, multipliers) in [
        (
            8.1809777414353076395,
            [1.0, 0.2467001983555930489, -0.21924034688918569964],
            1.338525827827157177,
            [1.0, -0.3536888989448703975, -1.3363052912634863894],
            0.93927285343428993871,
            [(-1.0, 0.0), (-0.0134502166259260882, 0.0)],
        ),
        (
            7.5,
            [1.0, 0.19823249991803925762, -0.070232277145065278676],
            1.4233233713637363614,
            [1.0, -0.344025375990686281, -1.183059661087738212],
            0.74301292847891228079,
            [
                (0.0152428881320117445, 0.108623768275021707),
                (0.0152428881320117445, -0.108623768275021707),
            ],
        ),
        (
            9.0,
            [1.0, 0.24934250838638521547, -0.38123474668730309559],
            1.2996630822629325955,
            [1.0, -0.3410322959683813188, -1.4133968349972096408],
            1.1230122606892547764,
            [(-3.19514890568819688, 0.0), (-4.15922337056281281e-3, 0.0)],
        ),
        (
            11.703883877144144298,
            [1.0, 0.10871420863441418884, -0.64778703183271289752],
            1.4132939936156731835,
            [1.0, -0.27685064455486246519, -1.4149172173925535277],
            2.0437839857162793882,
            [(-1.0, 0.0), (-8.51510797873378169e-3, 0.0)],
        ),
    ] {
        let reference = Reference {
            text: CHUA,
            replaced: &[("alpha", alpha)],
            parameter: "alpha",
            periods: 1,
            phase: 0.0,
            zones: vec![
                ("upper", HIT, &start, upper),
                ("inner", HIT, &middle, inner),
            ],
        };
        // beside a fold, 2e-4 away, the orbit is known to the square root of rounding at worst
        agrees(&reference, &multipliers, 1e-11);
    }
}

#[test]
fn buck() {
    let t = 4e-4;
    // off until the control meets the ramp, until the ramp is reset; on until the ramp is reset
    let (meets, resets) = ((0, 0), (1, 0));
    for (e, zones, multipliers) in [
        (
            22.0,
            vec![
                (
                    "off",
                    meets,
                    [11.998231707599141418, 0.59963579835236821478, 3.8],
                    0.45511133260672490865,
                ),
                (
                    "on",
                    resets,
                    [
                        11.990772602793998762,
                        0.49013839601801179993,
                        5.802489863469589598,
                    ],
                    0.54488866739327509135,
                ),
            ],
            vec![
                (-0.752798368738600767, 0.335394524629484296),
                (-0.752798368738600767, -0.335394524629484296),
            ],
        ),
        (
            24.516572828563378702,
            vec![
                (
                    "off",
                    meets,
                    [12.0277089452064187, 0.60808428783834207779, 3.8],
                    0.50950967285868678582,
                ),
                (
                    "on",
                    resets,
                    [
                        12.019266971497407364,
                        0.48511117334590278824,
                        6.0418425605782218576,
                    ],
                    0.49049032714131321418,
                ),
            ],
            vec![(-1.0, 0.0), (-0.679194871126936077, 0.0)],
        ),
        (
            30.0,
            vec![
                (
                    "off",
                    meets,
                    [12.055394967299817369, 0.67784655675044991365, 3.8],
                    0.835743567260253405,
                ),
                (
                    "on",
                    resets,
                    [
                        12.19015139237441845,
                        0.47312643551033063168,
                        7.477271695945114982,
                    ],
                    0.164256432739746595,
                ),
                (
                    "off",
                    meets,
                    [12.120591376325857141, 0.53177199014997923269, 3.8],
                    0.3582049696430103667,
                ),
                (
                    "on",
                    resets,
                    [
                        11.940012126955862573,
                        0.44544353203569211352,
                        5.3761018664292456135,
                    ],
                    0.6417950303569896333,
                ),
            ],
            vec![
                (-0.50407701155997787, 0.455205491379329959),
                (-0.50407701155997787, -0.455205491379329959),
            ],
        ),
        (
            37.0,
            vec![
                (
                    "off",
                    resets,
                    [12.013009557666382482, 0.71673754312895039246, 3.8],
                    1.0,
                ),
                (
                    "off",
                    meets,
                    [12.293918143563106553, 0.46998538006024160985, 3.8],
                    0.34419470492367278527,
                ),
                (
                    "on",
                    resets,
                    [
                        11.932673416864780983,
                        0.38648601793672735097,
                        5.3144567016641602552,
                    ],
                    0.65580529507632721473,
                ),
            ],
            vec![(-3.060021930052532, 0.0), (-0.1507524075022612, 0.0)],
        ),
    ] {
        let zones = zones.into_iter().map(|(mode, way, state, duration)| {
            let state: &[f64] = Box::leak(Box::new(state));
            (mode, way, state, duration * t)
        });
        let reference = Reference {
            text: BUCK,
            replaced: Box::leak(Box::new([("E", e)])),
            parameter: "E",
            periods: 1,
            phase: 0.0,
            zones: zones.collect(),
        };
        agrees(&reference, &multipliers, 1e-12);
    }
}

#[test]
fn balls_and_thermostats() {
    for (g, e, phase, parts, multipliers) in [
        (
            1.0473022709517174059,
            0.5,
            0.014141546406084157704,
            vec![(2.0943951023931954923, TAU)],
            [(0.954858702754343219, 0.0), (0.261818842179330876, 0.0)],
        ),
        (
            1.5420919375242514729,
            0.5,
            0.62791042178503639973,
            vec![
                (2.1356873945607037383, 6.6506392908934755931),
                (0.5 * 4.1062056204513744927, 5.9157313234656973608),
            ],
            [(0.743002681301293528, 0.0), (0.0841181352004512489, 0.0)],
        ),
        // multipliers 1e21 apart
        (
            4.6452,
            0.5,
            0.74965850192110739035,
            vec![
                (0.24501232719918796603, 6.890901850342572745),
                (0.5 * 4.2298429082280484256, 6.2203422638098703624),
                (0.5 * 4.3885863735474891225, 6.9979097872687468706),
                (0.5 * 1.5644753415015737152, 3.0994047606740888759),
                (0.5 * 6.0822315414700767431, 1.9241825666230670539),
            ],
            [(69421.48796414171, 0.0), (1.406715022450144e-8, 0.0)],
        ),
    ] {
        let total: f64 = parts.iter().map(|(_, duration)| duration).sum();
        let zones = parts.iter().map(|(speed, duration)| -> Part {
            let state: &[f64] = Box::leak(Box::new([0.0, *speed]));
            ("flight", HIT, state, *duration)
        });
        let reference = Reference {
            text: BALL,
            replaced: Box::leak(Box::new([("G", g), ("e", e)])),
            parameter: "G",
            periods: (total / TAU).round() as u32,
            phase,
            zones: zones.collect(),
        };
        let (orbit, exact) = reference.posed();
        // a strongly unstable orbit is found from nearby only
        let found = solved(&orbit, &beside(&exact, 1e-6));
        // rounding of a period is magnified by the largest multiplier, and by 1/phase beside the fold
        let largest = multipliers
            .iter()
            .fold(1.0_f64, |largest, pair| largest.max(f64::abs(pair.0)));
        let error = (&found - &exact).amax();
        assert!(error < 1e-13 + 4e-15 * largest, "G = {g}: {error:e}");
        assert_eq!(
            orbit.examination(&found).unwrap().verdict(),
            SignVerdict::Positive
        );
        compare(&orbit.multipliers(&found).unwrap(), &multipliers, 1e-10);
    }
    for (q, y, on, end, off, multiplier) in [
        (
            2.0,
            0.32830697326469068393,
            0.81382155776529829173,
            1.6716930267353093161,
            0.81382155776529829173,
            7.5747923038839005e-3,
        ),
        (
            1.11,
            0.36189975591263201285,
            4.5541162199049703439,
            1.1099171476735016951,
            0.56033669683815291454,
            2.17002112109597008e-7,
        ),
        (
            1.1001,
            0.36191684628211006012,
            9.1465530068422472433,
            1.1000999916137243887,
            0.55587093854299627963,
            2.28492767728585887e-13,
        ),
    ] {
        let entries = [[0.9, y], [1.1, end]];
        let reference = Reference {
            text: THERMOSTAT,
            replaced: &[("Q", q)],
            parameter: "Q",
            periods: 1,
            phase: 0.0,
            zones: vec![("on", HIT, &entries[0], on), ("off", HIT, &entries[1], off)],
        };
        let (orbit, exact) = reference.posed();
        let found = solved(&orbit, &beside(&exact, 1e-7));
        // the equilibrium is on the threshold but for this: the period is known to rounding over that
        assert!((&found - &exact).amax() < 1e-14 / (q - 1.1), "Q = {q}");
        assert_eq!(
            orbit.examination(&found).unwrap().verdict(),
            SignVerdict::Positive
        );
        compare(
            &orbit.multipliers(&found).unwrap(),
            &[(multiplier, 0.0)],
            1e-9,
        );
    }
}

/// Every reference orbit against central differences, in all unknowns.
#[test]
fn derivatives_are_those_of_the_equations() {
    let sides = ["forth", "back"];
    let half: [Part; 2] = [
        (
            "forth",
            HIT,
            &[-1.2094177143471619223, 0.0],
            4.5094310304971641205,
        ),
        (
            "stick",
            HIT,
            &[1.2094177143471619223, 0.0],
            0.72655672548582461022,
        ),
    ];
    let friction = Reference {
        text: FRICTION,
        replaced: &[("w", 0.6)],
        parameter: "w",
        periods: 1,
        phase: -2.144505454379887619,
        zones: mirrored(&half, sides, &[SLIDE, TO_SECOND, SLIDE, TO_FIRST]),
    };
    let buck = Reference {
        text: BUCK,
        replaced: &[("E", 22.0)],
        parameter: "T",
        periods: 1,
        phase: 0.0,
        zones: vec![
            (
                "off",
                (0, 0),
                &[11.998231707599141418, 0.59963579835236821478, 3.8],
                0.45511133260672490865 * 4e-4,
            ),
            (
                "on",
                (1, 0),
                &[
                    11.990772602793998762,
                    0.49013839601801179993,
                    5.802489863469589598,
                ],
                0.54488866739327509135 * 4e-4,
            ),
        ],
    };
    let of_w = Reference {
        parameter: "w",
        ..impact(
            1.0,
            1.0,
            0.8,
            1,
            0.075952164938312386,
            &[(-1.3565863500759056, 2.0), (-0.5, TAU - 2.0)],
        )
    };
    let of_e = Reference {
        parameter: "e",
        ..impact(
            1.0,
            1.0,
            0.8,
            1,
            0.075952164938312386,
            &[(-1.3565863500759056, 1e-3), (-0.5, TAU - 1e-3)],
        )
    };
    for reference in [friction, buck, of_w, of_e] {
        let (orbit, point) = reference.posed();
        let n = point.len();
        let evaluate = |point: &Vector| {
            let mut residual = vec![0.0; n - 1];
            let mut jacobian = Matrix::zeros(n - 1, n);
            orbit.evaluate(point, &mut residual, &mut jacobian).unwrap();
            let examination = orbit.examination(point).unwrap();
            (Vector::from_vec(residual), jacobian, examination.margins)
        };
        let point = beside(&point, 1e-4);
        let (_, jacobian, margins) = evaluate(&point);
        assert!(!margins.is_empty());
        for column in 0..n {
            let step = 1e-6;
            let moved = |way: f64| {
                let mut point = point.clone();
                point[column] += way * step;
                evaluate(&point)
            };
            let (above, below) = (moved(1.0), moved(-1.0));
            let difference = (&above.0 - &below.0) / (2.0 * step);
            // third derivatives of order 1e2 times h²/6, and rounding over h
            let off = (difference - jacobian.column(column)).amax();
            assert!(
                off < 1e-7,
                "{}, column {column}: {off:e}",
                orbit.signature()
            );
            for margin in &margins {
                let same = |margins: &[Margin]| {
                    margins
                        .iter()
                        .find(|other| margin.is_same(other))
                        .unwrap()
                        .value
                };
                let difference = (same(&above.2) - same(&below.2)) / (2.0 * step);
                let terms = margin.gradient.iter().filter(|(index, _)| *index == column);
                let off = (difference - terms.map(|(_, by)| by).sum::<f64>()).abs();
                assert!(
                    off < 1e-7 * (1.0 + difference.abs()),
                    "{}: {margin:?}, column {column}: {difference}",
                    orbit.signature()
                );
            }
        }
    }
}

/// The equations go on into orbits that are none: through the wall, and with impacts from behind.
#[test]
fn what_is_not_physical_is_refused() {
    // beyond the inner graze at A = 2.09028, and at an impact speed below zero
    for (a, speed) in [(2.2, -4.1), (0.3683, 1e-3)] {
        let reference = impact(
            a,
            0.8,
            0.8,
            1,
            if speed < 0.0 { -0.22 } else { 0.22 },
            &[(speed, TAU / 0.8)],
        );
        let (orbit, guess) = reference.posed();
        let found = solved(&orbit, &guess);
        let examination = orbit.examination(&found).unwrap();
        assert_eq!(
            examination.verdict(),
            SignVerdict::Negative,
            "A = {a}: {found:?}"
        );
        assert!(
            examination
                .margins()
                .iter()
                .any(|margin| margin.value < 0.0)
        );
    }
}
