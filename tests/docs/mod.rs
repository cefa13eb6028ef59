//! What the README and the pages of `docs` show is so: their commands are run, what they print is what stands below them,
//! their problem files are whole, and every link, option and file that they name is there.
//!
//! In a fence the word after the language says what a block is. `sh` has commands, which are run in the order of the page
//! in one folder with the problem files of the repository; `sh no-test: REASON` is not run. `text` is what the commands
//! before it print, in part. `ron NAME` is a problem file, which later commands of the page may name; `ron fragment` is a
//! part of one.

mod page;
mod printed;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use crate::cli::harness::{Bench, PROBLEMS};
use page::{Block, Page, ROOT};

/// No picture of the gallery has more bytes: pages stay quick to load.
const PICTURE_BYTES: u64 = 150_000;

/// A test for every page, so that they run side by side, and their list.
macro_rules! pages {
    ($($name:ident: $path:literal),* $(,)?) => {
        const PAGES: &[&str] = &[$($path),*];
        $(#[test]
        fn $name() {
            follow(&Page::read($path));
        })*
    };
}

pages! {
    readme: "README.md",
    index: "docs/README.md",
    accuracy: "docs/accuracy.md",
    code: "docs/code.md",
    contacts: "docs/contacts.md",
    curves: "docs/curves.md",
    equilibria: "docs/equilibria.md",
    files: "docs/files.md",
    filippov: "docs/filippov.md",
    gallery: "docs/gallery.md",
    glossary: "docs/glossary.md",
    proofs: "docs/proofs.md",
    python: "docs/python.md",
    simulation: "docs/simulation.md",
    start: "docs/start.md",
    systems: "docs/systems.md",
    theory: "docs/theory.md",
    waves: "docs/waves.md",
}

/// Does what a page says, from its first block to its last.
fn follow(page: &Page) {
    let bench = Bench::new();
    fs::create_dir(bench.path("problems")).expect("a folder");
    for name in names_in(Path::new(PROBLEMS), ".ron") {
        let copy = bench.path("problems").join(&name);
        fs::copy(Path::new(PROBLEMS).join(&name), copy).expect("a problem file");
    }
    let mut printed = None;
    for block in &page.blocks {
        let place = format!("{}:{}", page.path.display(), block.line);
        match block.language.as_str() {
            "sh" => printed = run(&bench, block, &place),
            "text" => {
                let printed = printed
                    .as_deref()
                    .unwrap_or_else(|| panic!("{place}: no command printed this"));
                if let Some(line) = printed::missing(&block.text, printed) {
                    panic!("{place}: not printed: {line}\n--- printed\n{printed}");
                }
            }
            "ron" if block.note == "fragment" => {}
            "ron" => {
                assert!(
                    block.note.ends_with(".ron"),
                    "{place}: neither `fragment` nor the name of a file"
                );
                let used =
                    |other: &Block| other.language == "sh" && other.text.contains(&block.note);
                assert!(
                    page.blocks.iter().any(used),
                    "{place}: no command of the page reads {}",
                    block.note
                );
                bench.put(&block.note, &block.text);
            }
            // python/test_program.py and python/test_brakewave.py test the package
            "python" => {}
            other => panic!("{place}: a block of `{other}`"),
        }
    }
}

/// Runs the commands of a block and returns what they print, or nothing where it is not to be run.
fn run(bench: &Bench, block: &Block, place: &str) -> Option<String> {
    if let Some(reason) = block.note.strip_prefix("no-test:") {
        assert!(!reason.trim().is_empty(), "{place}: no reason");
        return None;
    }
    assert!(
        block.note.is_empty(),
        "{place}: `{}` is no mark",
        block.note
    );
    let mut printed = String::new();
    for line in block.text.lines() {
        let command = line.split(" #").next().unwrap_or(line);
        let (command, target) = command
            .split_once(" > ")
            .map_or((command, None), |(some, file)| (some, Some(file)));
        let words: Vec<&str> = command.split_whitespace().collect();
        let arguments = match words.as_slice() {
            ["brakewave", arguments @ ..] | ["cargo", "run", "--release", "--", arguments @ ..] => {
                arguments
            }
            // this very program
            ["cargo", "test", ..] => continue,
            _ => panic!("{place}: `{line}` cannot be run here; mark the block `no-test: REASON`"),
        };
        let outcome = bench.run(arguments).expect(0);
        if let Some(file) = target {
            bench.put(file.trim(), &outcome.stdout);
        }
        printed += &outcome.stdout;
        printed += &outcome.stderr;
    }
    Some(printed)
}

/// The names of the files in a folder that end so.
fn names_in(folder: &Path, ending: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let names = entries.map(|entry| name(entry.expect("an entry")));
    names.filter(|name| name.ends_with(ending)).collect()
}

#[test]
fn every_page_is_tested_and_in_the_index() {
    let pages = names_in(&Path::new(ROOT).join("docs"), ".md");
    let index = Page::read("docs/README.md");
    for name in &pages {
        assert!(
            PAGES.contains(&format!("docs/{name}").as_str()),
            "docs/{name} has no test"
        );
        assert!(
            name == "README.md" || index.links().any(|link| link == name),
            "docs/{name} is not in the index"
        );
    }
    assert_eq!(PAGES.len(), pages.len() + 1);
}

#[test]
fn links_lead_somewhere() {
    for name in PAGES.iter().chain(&["CHANGELOG.md"]) {
        let page = Page::read(name);
        for link in page.links().filter(|link| !link.starts_with("http")) {
            let (file, anchor) = link
                .split_once('#')
                .map_or((link, None), |(file, anchor)| (file, Some(anchor)));
            let base = page.path.parent().expect("a folder");
            let target = if file.is_empty() {
                page.path.clone()
            } else {
                base.join(file)
            };
            assert!(target.exists(), "{name}: {link}");
            if let Some(anchor) = anchor {
                let target = target.to_str().expect("UTF-8");
                assert!(Page::read(target).has_anchor(anchor), "{name}: {link}");
            }
        }
    }
}

#[test]
fn every_problem_file_is_in_a_page() {
    let texts: Vec<String> = PAGES.iter().map(|name| Page::read(name).prose).collect();
    let text = texts.join("\n");
    for name in names_in(Path::new(PROBLEMS), ".ron") {
        assert!(
            text.contains(&format!("problems/{name}")),
            "{name} is in no page"
        );
    }
    for mention in text.split("problems/").skip(1) {
        let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let name = mention.split(|c| !is_name(c)).next().unwrap_or_default();
        let whole = mention[name.len()..].starts_with(".ron") && !name.is_empty();
        assert!(
            !whole || Path::new(PROBLEMS).join(format!("{name}.ron")).exists(),
            "there is no problems/{name}.ron"
        );
    }
}

/// Commands that are not run: those within sentences and tables, and those that take too long.
#[test]
fn verbs_and_options_that_are_named_exist() {
    let bench = Bench::new();
    let mut helps = BTreeMap::<String, String>::new();
    for name in PAGES {
        let page = Page::read(name);
        let blocks = page.blocks.iter().filter(|block| block.language == "sh");
        let commands = page
            .code_spans()
            .chain(blocks.flat_map(|block| block.text.lines()));
        for command in commands {
            let words: Vec<&str> = command.split_whitespace().collect();
            let ["brakewave" | "certify", arguments @ ..] = words.as_slice() else {
                continue;
            };
            let verb = if words[0] == "certify" {
                "certify"
            } else {
                arguments.first().unwrap_or(&"--help")
            };
            if !verb.starts_with(|c: char| c.is_ascii_lowercase()) {
                continue;
            }
            let help = helps.entry(verb.to_owned()).or_insert_with(|| {
                let said = bench.run(&[verb, "--help"]);
                assert_eq!(
                    said.code,
                    Some(0),
                    "{name}: `{command}`: there is no verb `{verb}`"
                );
                // `map merge` and `scan merge` have options of their own
                said.stdout + &bench.run(&[verb, "merge", "--help"]).stdout
            });
            for option in arguments
                .iter()
                .filter(|word| word.starts_with("--") && word.len() > 2)
            {
                let option = option.trim_end_matches([',', ';', ']']);
                assert!(
                    help.contains(option),
                    "{name}: `{command}`: `{verb}` has no option `{option}`"
                );
            }
        }
    }
}

#[test]
fn the_gallery_has_the_pictures_and_commands_of_its_script() {
    let script = fs::read_to_string(Path::new(ROOT).join("docs/gallery.sh")).expect("the script");
    let gallery = Page::read("docs/gallery.md");
    let mut pictures = BTreeSet::new();
    for line in script
        .lines()
        .filter_map(|line| line.strip_prefix("picture "))
    {
        let mut words = line.splitn(3, ' ');
        let mut word = || words.next().unwrap_or_else(|| panic!("{line}"));
        let (name, file, arguments) = (word(), word(), word());
        let extension = file.rsplit('.').next().expect("an extension");
        let picture = format!("{name}.{extension}");
        let shown = gallery
            .prose
            .split("\n\n![")
            .find(|part| part.contains(&format!("](gallery/{picture})")));
        let shown = shown.unwrap_or_else(|| panic!("{picture} is not in the gallery"));
        assert!(
            shown.contains(&format!("`brakewave {arguments}`, `{file}`")),
            "the command of {picture}"
        );
        pictures.insert(picture);
    }
    let folder = fs::read_dir(Path::new(ROOT).join("docs/gallery")).expect("the pictures");
    let there = folder.map(|entry| {
        let entry = entry.expect("an entry");
        let name = entry.file_name().to_string_lossy().into_owned();
        let bytes = entry.metadata().expect("its size").len();
        assert!(bytes < PICTURE_BYTES, "{name} has {bytes} bytes");
        name
    });
    assert_eq!(there.collect::<BTreeSet<_>>(), pictures);
}
