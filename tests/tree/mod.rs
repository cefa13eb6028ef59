//! The order of modules drawn in `src/lib.rs` is kept: nothing imports what stands further right, and no
//! files import each other in a circle.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The drawing of `src/lib.rs` from left to right; `messages` and `table` stand before what shows them. In the room
/// of the tube its files have an order of their own: the simulation sees the model alone.
const ORDER: [&str; 24] = [
    "linalg",
    "interval",
    "tube::model",
    "continuation",
    "orbit",
    "affine",
    "simulation",
    "tube::flow",
    "tube::wave",
    "tube::steady",
    "tube::stability",
    "tube",
    "problem",
    "branch",
    "hybrid",
    "certify",
    "curve",
    "map",
    "discretised",
    "accuracy",
    "messages",
    "table",
    "output",
    "cli",
];

/// A module by the names that lead to it.
type Module = Vec<String>;

/// The text of every module but tests, without comments and what only tests see.
fn modules() -> BTreeMap<Module, String> {
    fn collect(folder: &Path, module: &[String], found: &mut BTreeMap<Module, String>) {
        for entry in fs::read_dir(folder).expect("the folder can be read") {
            let path = entry.expect("an entry").path();
            let stem = path.file_stem().expect("a name").to_string_lossy();
            let mut name = module.to_vec();
            if !matches!(&*stem, "mod" | "lib") {
                name.push(stem.clone().into_owned());
            }
            if path.is_dir() {
                collect(&path, &name, found);
            } else if path.extension().is_some_and(|end| end == "rs")
                && !matches!(&*stem, "tests" | "main")
            {
                let text = fs::read_to_string(&path).expect("the file can be read");
                let text = text.split("#[cfg(test)]").next().unwrap_or_default();
                let lines = text.lines().map(|line| line.split("//").next());
                found.insert(name, lines.flatten().collect::<Vec<_>>().join("\n"));
            }
        }
    }
    let mut found = BTreeMap::new();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    collect(&source, &[], &mut found);
    found
}

/// The paths of a tree such as `a::{b, c::{d, e}}`.
fn paths(tree: &str) -> Vec<Module> {
    let (head, inside) = match tree.split_once('{') {
        Some((head, inside)) => (head, inside.trim_end().trim_end_matches('}')),
        None => (tree, ""),
    };
    let path = head.split("::").map(|name| {
        let name = name.trim();
        name.split(" as ").next().unwrap_or(name).to_owned()
    });
    let path: Module = path.filter(|name| !name.is_empty()).collect();
    if !tree.contains('{') {
        return vec![path];
    }
    // commas between the outermost parts
    let (mut parts, mut depth) = (vec![String::new()], 0);
    for letter in inside.chars() {
        depth += i32::from(letter == '{') - i32::from(letter == '}');
        match letter {
            ',' if depth == 0 => parts.push(String::new()),
            _ => parts.last_mut().expect("a part").push(letter),
        }
    }
    let parts = parts.iter().filter(|part| !part.trim().is_empty());
    let inner = parts.flat_map(|part| paths(part));
    inner.map(|inner| [&path[..], &inner].concat()).collect()
}

/// What a text imports, from the root of the crate, as far as it is of the crate.
fn imports(module: &Module, text: &str, all: &BTreeMap<Module, String>) -> Vec<Module> {
    let mut found = Vec::new();
    for piece in text.split("use ").skip(1) {
        let tree = piece.split(';').next().unwrap_or_default();
        for path in paths(tree) {
            let mut at = module.clone();
            let mut rest = path.as_slice();
            match rest.first().map(String::as_str) {
                Some("crate") => at.clear(),
                Some("super" | "self") => {}
                Some(name) if all.contains_key(&[&at[..], &[name.to_owned()]].concat()) => {}
                _ => continue,
            }
            while let Some(word @ ("crate" | "super" | "self")) = rest.first().map(String::as_str) {
                if word == "super" {
                    at.pop();
                }
                rest = &rest[1..];
            }
            at.extend_from_slice(rest);
            found.push(at);
        }
    }
    found
}

/// The module of a file in which a path ends: through what a folder hands on from its files.
fn home(path: &Module, all: &BTreeMap<Module, String>) -> Module {
    let mut module = path.clone();
    while !all.contains_key(&module) {
        module.pop();
    }
    let Some(item) = path.get(module.len()) else {
        return module;
    };
    let handed_on = imports(&module, &all[&module], all).into_iter();
    let mut handed_on = handed_on.filter(|inner| inner.len() > module.len() + 1);
    let inner = handed_on.find(|inner| inner.last() == Some(item) && inner.starts_with(&module));
    inner.map_or(module, |inner| home(&inner, all))
}

/// The files that every file imports.
fn tree() -> BTreeMap<Module, BTreeSet<Module>> {
    let all = modules();
    let of = |(module, text): (&Module, &String)| {
        let imported = imports(module, text, &all).into_iter();
        let imported = imported.map(|path| home(&path, &all));
        (
            module.clone(),
            imported.filter(|one| one != module).collect(),
        )
    };
    all.iter().map(of).collect()
}

#[test]
fn nothing_imports_what_stands_further_right() {
    let place = |module: &Module| {
        let room = module.first()?;
        let inner = module
            .iter()
            .take(2)
            .cloned()
            .collect::<Vec<_>>()
            .join("::");
        let place = |name: &str| ORDER.iter().position(|known| *known == name);
        let place = place(&inner).or_else(|| place(room));
        Some(place.unwrap_or_else(|| panic!("`{room}` has no place in the order")))
    };
    let mut imported = 0;
    for (module, files) in tree() {
        // the root hands on what users of the crate need
        let Some(own) = place(&module) else { continue };
        for file in files {
            imported += 1;
            let left = place(&file).is_some_and(|other| other <= own);
            assert!(left, "{} imports {}", module.join("::"), file.join("::"));
            let rooms = [module[0].as_str(), file[0].as_str()];
            let mixed = [["tube", "affine"], ["affine", "tube"]].contains(&rooms);
            assert!(!mixed, "{} imports {}", module.join("::"), file.join("::"));
        }
    }
    assert!(imported > 500, "{imported} imports are read");
    // and the order is that of the drawing, with every module in it
    let root = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/src/lib.rs"));
    let root = root.expect("the root");
    let drawing = root.split("```text").nth(1).expect("a drawing");
    let drawing = drawing.split("```").next().expect("a drawing");
    let drawn = drawing.split(|letter: char| !letter.is_ascii_alphabetic());
    let drawn: BTreeSet<&str> = drawn.filter(|word| !word.is_empty()).collect();
    let ordered: BTreeSet<&str> = ORDER
        .into_iter()
        .filter(|name| *name != "messages")
        .flat_map(|name| name.split("::"))
        .filter(|name| !["flow", "wave", "steady", "stability"].contains(name))
        .collect();
    assert_eq!(drawn, ordered);
}

/// A folder and its own files know each other: `mod.rs` is its front, and says what they have in common.
#[test]
fn no_files_import_each_other_in_a_circle() {
    let mut tree = tree();
    let front =
        |folder: &Module, file: &Module| file.len() > folder.len() && file.starts_with(folder);
    for (module, files) in &mut tree {
        files.retain(|file| !front(module, file) && !front(file, module));
    }
    let reaches = |from: &Module| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from]);
        while let Some(module) = next.pop() {
            next.extend(
                tree[module]
                    .iter()
                    .filter(|file| seen.insert((*file).clone())),
            );
        }
        seen
    };
    let circular = tree
        .keys()
        .filter(|module| reaches(module).contains(*module));
    let circular: Vec<String> = circular.map(|module| module.join("::")).collect();
    assert!(
        circular.is_empty(),
        "these files import each other: {circular:#?}"
    );
}

/// The reader of imports reads them.
#[test]
fn imports_are_read() {
    let found = paths("super::a::{self, b as c, d::{E, f::G}}");
    let words: Vec<String> = found.iter().map(|path| path.join(" ")).collect();
    let expected = ["super a self", "super a b", "super a d E", "super a d f G"];
    assert_eq!(words, expected);
    let all = modules();
    let named = |path: &str| path.split("::").map(str::to_owned).collect::<Module>();
    let event = named("orbit::event");
    assert_eq!(home(&named("orbit::EventType"), &all), event);
}
