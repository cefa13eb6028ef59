//! What a shell knows of the program: completions and the manual, from the same description as the help.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, Command, CommandFactory};
use clap_complete::{Shell, generate};
use clap_mangen::Man;

use super::failure::{VerbExit, VerbFailure};
use super::{Arguments, options, print};
use crate::output::store::io_error;

#[derive(Debug, Args)]
pub(super) struct ManualArguments {
    /// Write the pages and the completions as files instead, at the places below DIR at which a system looks
    /// for those of a package below /usr/share
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Where the completions of a shell stand below `share`. Others have no place that all systems agree on.
const COMPLETIONS: [(Shell, &str); 3] = [
    (Shell::Bash, "bash-completion/completions/brakewave"),
    (Shell::Zsh, "zsh/site-functions/_brakewave"),
    (Shell::Fish, "fish/vendor_completions.d/brakewave.fish"),
];

/// Prints the script for a shell.
pub(super) fn completions(shell: Shell) -> Result<VerbExit, VerbFailure> {
    print(&script(shell)).map(|()| VerbExit::Done)
}

/// The pages of the program and of each verb: printed one after the other, or as files.
pub(super) fn manual(arguments: &ManualArguments) -> Result<VerbExit, VerbFailure> {
    let pages = pages()?;
    let Some(folder) = &arguments.out else {
        let text: String = pages.into_iter().map(|(_, page)| page).collect();
        return print(&text).map(|()| VerbExit::Done);
    };
    let pages = pages
        .into_iter()
        .map(|(name, page)| (folder.join("man/man1").join(name), page));
    let scripts = COMPLETIONS.map(|(shell, place)| (folder.join(place), script(shell)));
    for (path, text) in pages.chain(scripts) {
        let folder = path.parent().unwrap_or(Path::new("."));
        fs::create_dir_all(folder).map_err(io_error("create it", folder))?;
        options::write(&path, &text)?;
        print(&format!("{}\n", path.display()))?;
    }
    Ok(VerbExit::Done)
}

fn script(shell: Shell) -> String {
    let mut text = Vec::new();
    generate(shell, &mut Arguments::command(), "brakewave", &mut text);
    String::from_utf8_lossy(&text).into_owned()
}

/// The pages of the manual with the names of their files.
fn pages() -> Result<Vec<(String, String)>, VerbFailure> {
    let mut program = without_help(Arguments::command());
    program.build();
    let page = |command| {
        let page = Man::new(command).source(concat!("brakewave ", env!("CARGO_PKG_VERSION")));
        let mut text = Vec::new();
        page.render(&mut text).map_err(VerbFailure::Output)?;
        let text = String::from_utf8_lossy(&text).into_owned();
        Ok((page.get_filename(), text))
    };
    with_verbs(&program).into_iter().map(page).collect()
}

/// A command without the verb `help`, here and below, which has nothing that is not in their pages.
fn without_help(command: Command) -> Command {
    command
        .disable_help_subcommand(true)
        .mut_subcommands(without_help)
}

/// A command and all verbs below it.
fn with_verbs(command: &Command) -> Vec<Command> {
    let below = command.get_subcommands().flat_map(with_verbs);
    std::iter::once(command.clone()).chain(below).collect()
}
