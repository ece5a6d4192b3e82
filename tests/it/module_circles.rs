//! Modules of a crate form no circle: each uses only modules that don't use it, so that it is understood and tested alone.
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use gcode_tests::{files_below, workspace};

/// A module's path below the crate's root, `["lookahead", "request"]`.
type Module = Vec<String>;

/// The modules that each module names, siblings only: where both lie deeper in different folders, the folders.
type Uses = BTreeMap<Module, BTreeSet<Module>>;

fn module_of(file: &Path, source: &Path) -> Module {
    let inside = file.strip_prefix(source).unwrap().with_extension("");
    let mut path: Module = inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    path.pop_if(|last| ["lib", "main", "mod"].contains(&&**last));
    path
}

/// A source without comments and without its tests.
fn code_of(text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    let lines = code.lines().map(|line| line.split("//").next().unwrap());
    lines.flat_map(|line| [line.trim(), " "]).collect()
}

/// The paths behind a prefix such as `crate::`, one by one or in braces, each as far as it is made of names.
pub(crate) fn paths_behind(code: &str, prefix: &str) -> Vec<Module> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices(prefix) {
        let is_inside_a_word = code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
        if !is_inside_a_word {
            collect(&code[at + prefix.len()..], &mut Vec::new(), &mut found);
        }
    }
    found
}

/// Reads a path, or a list in braces, and gives what is behind it.
fn collect<'t>(text: &'t str, before: &mut Module, found: &mut Vec<Module>) -> &'t str {
    if let Some(list) = text.strip_prefix('{') {
        let mut rest = list;
        loop {
            rest = collect(rest.trim_start(), before, found).trim_start();
            match rest.strip_prefix(',') {
                Some(next) => rest = next,
                None => return rest.strip_prefix('}').unwrap_or(rest),
            }
        }
    }
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    let (name, rest) = text.split_at(end);
    if name.is_empty() {
        return rest;
    }
    before.push(name.to_owned());
    let rest = match rest.strip_prefix("::") {
        Some(deeper) => collect(deeper, before, found),
        None => {
            found.push(before.clone());
            rest.trim_start()
                .strip_prefix("as ")
                .map_or(rest, |alias| alias.trim_start_matches(char::is_alphanumeric))
        }
    };
    before.pop();
    rest
}

/// Which sibling modules of a crate use which.
fn uses(source: &Path) -> Uses {
    let files = files_below(source, "rs");
    let modules: BTreeSet<Module> = files.iter().map(|file| module_of(file, source)).collect();
    let mut uses = Uses::new();
    for file in &files {
        let module = module_of(file, source);
        let code = code_of(&std::fs::read_to_string(file).unwrap());
        let parents =
            (0..module.len()).map(|up| ("super::".repeat(up + 1), module[..module.len() - up - 1].to_vec()));
        let roots =
            parents.chain([("crate::".to_owned(), Vec::new()), ("self::".to_owned(), module.clone())]);
        for (prefix, root) in roots {
            for path in paths_behind(&code, &prefix) {
                let mut target = [root.clone(), path].concat();
                while !modules.contains(&target) {
                    target.pop();
                }
                let shared = module.iter().zip(&target).take_while(|(a, b)| a == b).count();
                if shared < module.len() && shared < target.len() {
                    uses.entry(module[..=shared].to_vec()).or_default().insert(target[..=shared].to_vec());
                }
            }
        }
    }
    uses
}

/// Every module that leads back to itself.
fn in_circles(uses: &Uses) -> BTreeSet<&Module> {
    let leads_back = |start: &Module| {
        let mut open: Vec<&Module> = uses.get(start).into_iter().flatten().collect();
        let mut seen = BTreeSet::new();
        while let Some(module) = open.pop() {
            if module == start {
                return true;
            }
            if seen.insert(module) {
                open.extend(uses.get(module).into_iter().flatten());
            }
        }
        false
    };
    uses.keys().filter(|module| leads_back(module)).collect()
}

#[test]
fn paths_are_found_one_by_one_and_in_braces() {
    let found =
        paths_behind("use crate::{a::{B, c::D}, e as f}; x(crate::g::H::new()) mycrate::z", "crate::");
    let shown: Vec<_> = found.iter().map(|path| path.join("::")).collect();
    assert_eq!(shown, ["a::B", "a::c::D", "e", "g::H::new"]);
}

#[test]
fn a_circle_is_found_and_a_chain_is_none() {
    let module = |name: &str| vec![name.to_owned()];
    let uses = |pairs: &[(&str, &str)]| {
        let mut uses = Uses::new();
        for (from, to) in pairs {
            uses.entry(module(from)).or_default().insert(module(to));
        }
        uses
    };
    let circle = uses(&[("a", "b"), ("b", "c"), ("c", "a"), ("d", "a")]);
    assert_eq!(in_circles(&circle).into_iter().cloned().collect::<Vec<_>>(), ["a", "b", "c"].map(module));
    assert!(in_circles(&uses(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
}

#[test]
fn no_modules_of_a_crate_form_a_circle() {
    let crates = std::fs::read_dir(workspace().join("gcode-sim/crates")).unwrap();
    let crates = crates.map(|entry| entry.unwrap().path());
    for folder in crates.chain(["gcode-sim", "gcode-gen"].map(|name| workspace().join(name))) {
        let uses = uses(&folder.join("src"));
        assert!(!uses.is_empty() || folder.ends_with("gcode-session"), "{} has no modules", folder.display());
        let found: Vec<_> = in_circles(&uses).into_iter().map(|module| module.join("/")).collect();
        assert!(found.is_empty(), "{}: {} use one another in a circle", folder.display(), found.join(", "));
    }
}
