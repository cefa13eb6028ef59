//! What a shell knows of the program: completions and the manual, from the same description as the help.

use clap::CommandFactory;
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use super::failure::{Exit, Failure};
use super::{Arguments, print};

/// The script for a shell.
pub(super) fn completions(shell: Shell) -> Result<Exit, Failure> {
    let mut text = Vec::new();
    generate(shell, &mut Arguments::command(), "brakewave", &mut text);
    print(&String::from_utf8_lossy(&text)).map(|()| Exit::Done)
}

/// The pages of the program and of each verb, one after the other.
pub(super) fn manual() -> Result<Exit, Failure> {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let mut text = Vec::new();
    let verbs = program.get_subcommands().cloned();
    for page in std::iter::once(program.clone()).chain(verbs) {
        let page = Man::new(page).source(concat!("brakewave ", env!("CARGO_PKG_VERSION")));
        page.render(&mut text).map_err(Failure::Output)?;
    }
    print(&String::from_utf8_lossy(&text)).map(|()| Exit::Done)
}
