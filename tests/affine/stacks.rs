//! Blocks that rub on one another: where one slip ends, every other one may change in the same instant.

use brakewave::affine::motion::{Motion, Step};

use super::systems::{self, at, place, system};

/// A stack of so many blocks on springs, the topmost one driven; the contacts in the order of the stack, or the other way round.
fn stack(blocks: usize, reversed: bool) -> String {
    let states: Vec<String> = (1..=blocks)
        .map(|i| format!("\"x{i}\", \"v{i}\""))
        .collect();
    let contact = |i: usize| {
        let below = if i > 1 {
            format!(" - v{}", i - 1)
        } else {
            String::new()
        };
        let bound = 0.3 + 0.13 * i as f64;
        format!("\"q{i}\": Friction(slip: \"v{i}{below}\", bound: \"{bound:.2}\")")
    };
    let rate = |i: usize| {
        let (below, above) = (i - 1, i + 1);
        let stiffness = 1.0 + 0.1 * i as f64;
        let mut force = format!("-{stiffness:.1}*x{i} - 0.1*v{i} + q{i}");
        if i > 1 {
            force += &format!(" - 0.7*(x{i} - x{below})");
        }
        force += &match i < blocks {
            true => format!(" - 0.7*(x{i} - x{above}) - q{above}"),
            false => " + A*sin(phase)".to_owned(),
        };
        let mass = 1.0 + 0.2 * i as f64;
        format!("\"x{i}\": \"v{i}\", \"v{i}\": \"({force})/{mass:.1}\"")
    };
    let mut contacts: Vec<String> = (1..=blocks).map(contact).collect();
    if reversed {
        contacts.reverse();
    }
    let rates: Vec<String> = (1..=blocks).map(rate).collect();
    let [states, contacts, rates] = [states, contacts, rates].map(|parts| parts.join(", "));
    format!(
        "(states: [{states}], parameters: {{\"A\": 3.0, \"w\": 0.9}}, forcing: \"w\", contacts: {{{contacts}}}, rates: {{{rates}}})"
    )
}

/// Where a stack at rest comes to by t = 30, and after how many switches; or the last thing that was said.
fn moved(blocks: usize, reversed: bool) -> Result<(Vec<f64>, usize), String> {
    let mode = vec!["stick"; blocks].join(".");
    let begin = vec![0.0; 2 * blocks];
    let (modes, end) = systems::moved(&stack(blocks, reversed), &mode, &begin, 30.0)?;
    Ok((end, modes.len()))
}

/// Positions and velocities by an integration with DOP853 at a tolerance of 1e-13, which tries at every switch all states of the contacts
/// without slip and goes on in the one that fits; with the number of switches.
#[test]
fn a_stack_moves_as_the_states_that_fit_say() {
    let known: [(&[f64], &[f64], usize); 3] = [
        (
            &[1.557_206_320_767, 2.930_005_376_859, 5.560_329_691_512],
            &[3.815_017_252_870, 4.682_478_589_573, 5.506_904_487_724],
            29,
        ),
        (
            &[
                -0.197_360_228_630,
                0.445_738_665_077,
                1.808_154_625_142,
                4.519_873_891_178,
            ],
            &[
                2.110_787_834_649,
                3.147_606_506_569,
                4.543_994_406_772,
                5.786_379_604_241,
            ],
            40,
        ),
        (
            &[
                -0.416_905_144_267,
                -0.489_443_744_729,
                -0.279_756_587_967,
                0.681_315_865_289,
                3.046_541_353_750,
            ],
            &[
                0.779_168_356_145,
                1.473_669_938_609,
                2.630_914_028_412,
                4.334_610_553_916,
                5.958_152_000_776,
            ],
            54,
        ),
    ];
    for (positions, velocities, switches) in known {
        for reversed in [false, true] {
            let (state, seen) = moved(positions.len(), reversed).unwrap();
            assert_eq!(seen, switches);
            let expected = positions.iter().zip(velocities).flat_map(|(x, v)| [x, v]);
            for (x, known) in state.iter().zip(expected) {
                assert!((x - known).abs() <= 1e-11, "{reversed}: {x} {known}");
            }
        }
    }
}

/// Of seven more states may follow than are looked at: said in words, at once.
#[test]
fn more_blocks_than_six_are_refused() {
    let (_, switches) = moved(6, false).unwrap();
    assert!(switches > 54);
    let said = moved(7, false).unwrap_err();
    assert!(
        said.contains("at most six that act on one another"),
        "{said}"
    );
}

/// Friction at rest above that of slip: as the slip of the first mass ends, it may slip back with the second one stuck to it, or stick while that
/// slips. It goes on by itself first, in any order of the file: then v = −(1.2 − F)/2 t.
#[test]
fn of_two_combinations_that_fit_the_contact_that_ends_has_the_first() {
    let first = r#""q": Friction(slip: "v", bound: "0.7", static: "0.935")"#;
    let second = r#""r": Friction(slip: "v - u", bound: "0.85", static: "1.15")"#;
    for ([one, other], mode) in [
        ([first, second], "forward.stick"),
        ([second, first], "stick.forward"),
    ] {
        let text = format!(
            r#"(states: ["v", "u"], contacts: {{{one}, {other}}}, rates: {{"v": "0.1 + q + r", "u": "-1.3 - r"}})"#
        );
        let system = system(&text);
        let affine = at(&system, &[]);
        let mut motion = Motion::new(&affine, place(&system, mode, &[0.5, 0.5], 0.0), 10.0);
        while motion.step(1.0).unwrap() != Step::Reached {}
        let expected = -0.25 * (1.0 - 0.5 / 0.95);
        for v in &motion.place().state {
            assert!((v - expected).abs() <= 1e-15, "{mode}: {v} {expected}");
        }
    }
}
