//! What is said where a user interrupts a computation that can go on later.

use std::io::{self, Write};
use std::process;

/// Exit code of a program that an interrupt has ended.
const INTERRUPTED: i32 = 130;

/// From now on an interrupt, as by Ctrl-C, ends the program and says with which command line the computation goes on.
pub(crate) fn say_how_to_go_on() {
    let command = going_on(std::env::args().skip(1));
    let interrupted = move || {
        let _ = writeln!(
            io::stderr(),
            "\ninterrupted: what is finished is kept, and `{command}` goes on"
        );
        process::exit(INTERRUPTED);
    };
    // where there can be no handler an interrupt ends the program all the same
    let _ = ctrlc::set_handler(interrupted);
}

/// The command line that resumes what another one began.
fn going_on(arguments: impl Iterator<Item = String>) -> String {
    let kept = arguments.filter(|word| !["--force", "--resume"].contains(&word.as_str()));
    let quoted = kept.map(|word| match word.contains(char::is_whitespace) {
        true => format!("'{word}'"),
        false => word,
    });
    let words = ["brakewave".to_owned()].into_iter().chain(quoted);
    let words: Vec<String> = words.chain(["--resume".to_owned()]).collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_line_is_resumed() {
        let words = ["run", "my file.ron", "--force", "--out", "r"].map(str::to_owned);
        let command = going_on(words.into_iter());
        assert_eq!(command, "brakewave run 'my file.ron' --out r --resume");
    }
}
