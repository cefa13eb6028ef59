//! What is said where a user interrupts a computation that can go on later.

use std::io::{self, Write};
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::problem::STANDARD_INPUT;

/// Exit code of a program that an interrupt has ended.
const INTERRUPTED: i32 = 130;

/// Characters that a shell takes as they are.
const PLAIN: &str = "_-./=:,@%+";

/// Whether the folder holds something to go on with.
static KEPT: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt, as by Ctrl-C, ends the program and says with which command line the computation goes on.
pub(crate) fn say_how_to_go_on() {
    let words: Vec<String> = std::env::args().collect();
    let interrupted = move || {
        let said = said(&words, KEPT.load(Ordering::SeqCst));
        let _ = writeln!(io::stderr(), "\n{said}");
        process::exit(INTERRUPTED);
    };
    // where there can be no handler an interrupt ends the program all the same
    let _ = ctrlc::set_handler(interrupted);
}

/// From now on the folder holds something to go on with.
pub(crate) fn progress_is_kept() {
    KEPT.store(true, Ordering::SeqCst);
}

/// What is said of the interrupt of a command line.
fn said(words: &[String], kept: bool) -> String {
    let command = going_on(words, kept);
    let given = words.iter().any(|word| word == STANDARD_INPUT);
    let given = if given {
        ", given the same problem, "
    } else {
        " "
    };
    match kept {
        true => format!("interrupted: what is finished is kept, and `{command}`{given}goes on"),
        false => format!("interrupted: nothing is kept yet, and `{command}`{given}begins anew"),
    }
}

/// The command line that goes on where something is kept, or does the same once more. Without `--force` it resumes what there is:
/// nothing, or results that may only have been begun.
fn going_on(words: &[String], kept: bool) -> String {
    let forced = words.iter().any(|word| word == "--force");
    let (program, arguments) = match words.split_first() {
        // a program that was found by its name is found by it again
        Some((program, arguments)) if program.contains(['/', '\\']) => {
            (program.as_str(), arguments)
        }
        Some((_, arguments)) => ("brakewave", arguments),
        None => ("brakewave", words),
    };
    let again = if forced && !kept {
        "--force"
    } else {
        "--resume"
    };
    let arguments = arguments.iter().map(String::as_str);
    let arguments = arguments.filter(|word| !["--force", "--resume"].contains(word));
    let words = [program].into_iter().chain(arguments).chain([again]);
    let words: Vec<String> = words.map(quoted).collect();
    words.join(" ")
}

/// A word as a shell reads it back.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || PLAIN.contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &[&str]) -> Vec<String> {
        line.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_command_line_is_resumed() {
        let line = words(&["brakewave", "run", "my file.ron", "--force", "--out", "r"]);
        let command = going_on(&line, true);
        assert_eq!(command, "brakewave run 'my file.ron' --out r --resume");
        // results that are to be replaced are not gone on with
        let command = going_on(&line, false);
        assert_eq!(command, "brakewave run 'my file.ron' --out r --force");
        let line = words(&["target/release/brakewave", "map", "it's.ron", "-q"]);
        for kept in [true, false] {
            let command = going_on(&line, kept);
            assert_eq!(
                command,
                "target/release/brakewave map 'it'\\''s.ron' -q --resume"
            );
        }
    }

    #[test]
    fn what_came_from_standard_input_is_given_again() {
        let said = said(&words(&["brakewave", "curve", "-"]), true);
        assert!(said.ends_with("`brakewave curve - --resume`, given the same problem, goes on"));
    }
}
