//! Which file of a crate imports which, read from its text: `use` lines, paths in the code, and names that another file
//! hands on.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module by the names that lead to it: none for the root of the crate.
pub type Module = Vec<String>;

/// Files of a crate apart from its tests, each with those that it imports.
#[derive(Debug)]
pub struct Imports {
    pub of: BTreeMap<Module, BTreeSet<Module>>,
}

/// A file's code and the names that its `use` lines bring in, each with its path as it is written.
struct File {
    names: Vec<(String, Vec<String>)>,
    paths: Vec<Vec<String>>,
}

impl Imports {
    /// From the files of a crate's `src`, by their paths in it.
    pub fn of_files(files: &[(String, String)]) -> Imports {
        let all: BTreeMap<Module, &str> = files
            .iter()
            .map(|(path, text)| (module_of(path), text.as_str()))
            .collect();
        let tests: Vec<Module> = all
            .iter()
            .flat_map(|(module, text)| test_modules(module, text))
            .collect();
        let is_test = |module: &Module| tests.iter().any(|test| module.starts_with(test));
        let read: BTreeMap<Module, File> = all
            .into_iter()
            .filter(|(module, _)| !is_test(module))
            .map(|(module, text)| (module, File::read(text)))
            .collect();
        let of = read
            .keys()
            .map(|module| (module.clone(), imported(&read, module)));
        Imports { of: of.collect() }
    }

    /// From a folder `src`.
    pub fn of_folder(src: &Path) -> Imports {
        let files: Vec<(String, String)> = super::architecture::rust_files(src)
            .into_iter()
            .map(|path| {
                let text = std::fs::read_to_string(&path).unwrap();
                let path = path.strip_prefix(src).unwrap().to_str().unwrap().to_owned();
                (path, text)
            })
            .collect();
        Imports::of_files(&files)
    }

    /// Files from which each leads back to itself by way of the others, two at least.
    pub fn circles(&self) -> Vec<Vec<Module>> {
        let reach: BTreeMap<&Module, BTreeSet<&Module>> =
            self.of.keys().map(|m| (m, self.reached(m))).collect();
        let mut circles: Vec<Vec<Module>> = Vec::new();
        for from in self.of.keys() {
            let both = |other: &&Module| reach[from].contains(*other) && reach[*other].contains(from);
            let circle: Vec<Module> = self.of.keys().filter(both).cloned().collect();
            if circle.len() > 1 && circle[0] == *from {
                circles.push(circle);
            }
        }
        circles
    }

    fn reached<'s>(&'s self, from: &'s Module) -> BTreeSet<&'s Module> {
        let mut reached = BTreeSet::new();
        let mut ahead = vec![from];
        while let Some(next) = ahead.pop() {
            for other in &self.of[next] {
                if reached.insert(other) {
                    ahead.push(other);
                }
            }
        }
        reached
    }
}

fn module_of(path: &str) -> Module {
    let path = path.trim_end_matches(".rs");
    let path = path.trim_end_matches("/mod");
    match path {
        "lib" | "mod" => Vec::new(),
        path => path.split('/').map(str::to_owned).collect(),
    }
}

/// Modules that only tests have.
fn test_modules(of: &Module, text: &str) -> Vec<Module> {
    let lines: Vec<&str> = text.lines().collect();
    let after = lines.windows(2).filter(|pair| is_for_tests(pair[0]));
    let name = |pair: &[&str]| Some(pair[1].strip_prefix("mod ")?.strip_suffix(';')?.to_owned());
    after
        .filter_map(name)
        .map(|name| of.iter().cloned().chain([name]).collect())
        .collect()
}

/// `#[cfg(test)]`, `#[cfg(all(test, unix))]`
fn is_for_tests(line: &str) -> bool {
    let line = line.trim();
    line == "#[cfg(test)]" || line.starts_with("#[cfg(all(test,")
}

/// The lines of a file apart from its modules of tests.
fn without_tests(text: &str) -> Vec<&str> {
    let mut kept = Vec::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let next = lines.peek().map_or("", |next| next.trim());
        if is_for_tests(line) && next.starts_with("mod ") && next.ends_with('{') {
            let indent = &line[..line.len() - line.trim_start().len()];
            lines.by_ref().find(|line| line.strip_prefix(indent) == Some("}"));
        } else {
            kept.push(line);
        }
    }
    kept
}

impl File {
    fn read(text: &str) -> File {
        let code: Vec<&str> = without_tests(text)
            .into_iter()
            .map(|line| line.split("//").next().unwrap_or_default())
            .collect();
        let (mut names, mut rest, mut statement) = (Vec::new(), String::new(), String::new());
        for line in code {
            let start = line.trim_start();
            let is_use = ["use ", "pub use ", "pub(super) use ", "pub(crate) use "];
            if statement.is_empty() && !is_use.iter().any(|words| start.starts_with(words)) {
                rest.push_str(line);
                rest.push('\n');
                continue;
            }
            statement.push_str(start);
            statement.push(' ');
            if let Some(whole) = statement.trim_end().strip_suffix(';') {
                let tree = whole.split_once("use ").map_or("", |(_, tree)| tree);
                expand(&[], tree, &mut names);
                statement.clear();
            }
        }
        let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
        let paths = rest.split(|c| !is_path(c)).filter(|word| word.contains("::"));
        File {
            names,
            paths: paths.map(segments).collect(),
        }
    }
}

fn segments(path: &str) -> Vec<String> {
    let names = path.split("::").map(str::trim).filter(|name| !name.is_empty());
    names.map(str::to_owned).collect()
}

/// The names that a tree of a `use` line brings in.
fn expand(before: &[String], tree: &str, names: &mut Vec<(String, Vec<String>)>) {
    let tree = tree.trim();
    if let Some((head, inner)) = tree.strip_suffix('}').and_then(|tree| tree.split_once('{')) {
        let path: Vec<String> = before.iter().cloned().chain(segments(head)).collect();
        let (mut depth, mut part) = (0, String::new());
        for c in inner.chars().chain([',']) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            if c == ',' && depth == 0 {
                if !part.trim().is_empty() {
                    expand(&path, &part, names);
                }
                part.clear();
            } else {
                part.push(c);
            }
        }
        return;
    }
    let (path, alias) = tree
        .split_once(" as ")
        .map_or((tree, None), |(path, alias)| (path, Some(alias)));
    let mut path: Vec<String> = before.iter().cloned().chain(segments(path)).collect();
    if path.last().is_some_and(|last| last == "self") {
        path.pop();
    }
    let name = alias
        .map(|alias| alias.trim().to_owned())
        .or_else(|| path.last().cloned());
    names.extend(name.map(|name| (name, path)));
}

/// The modules that a file imports something of.
fn imported(files: &BTreeMap<Module, File>, module: &Module) -> BTreeSet<Module> {
    let file = &files[module];
    let paths = file.names.iter().map(|(_, path)| path).chain(&file.paths);
    paths
        .filter_map(|path| absolute(files, module, path))
        .map(|path| target(files, &path, 0))
        .filter(|other| other != module)
        .collect()
}

/// The path from the root of the crate; none for names of other crates.
fn absolute(files: &BTreeMap<Module, File>, module: &Module, path: &[String]) -> Option<Module> {
    let first = path.first()?.as_str();
    if first == "crate" {
        return Some(path[1..].to_vec());
    }
    if first == "self" {
        return Some(module.iter().chain(&path[1..]).cloned().collect());
    }
    let up = path.iter().take_while(|name| *name == "super").count();
    if up > 0 {
        let above = module.get(..module.len().checked_sub(up)?)?;
        return Some(above.iter().chain(&path[up..]).cloned().collect());
    }
    let below: Module = module.iter().cloned().chain([first.to_owned()]).collect();
    if files.contains_key(&below) {
        return Some(module.iter().chain(path).cloned().collect());
    }
    // A module that a `use` line names.
    let (_, used) = files[module]
        .names
        .iter()
        .find(|(name, used)| name == first && used.as_slice() != path)?;
    let used = absolute(files, module, used)?;
    files
        .contains_key(&used)
        .then(|| used.iter().chain(&path[1..]).cloned().collect())
}

/// The file that a name is written in: where one hands it on, the one that it has it from.
fn target(files: &BTreeMap<Module, File>, path: &[String], depth: usize) -> Module {
    let known = (0..=path.len())
        .rev()
        .find(|&count| files.contains_key(&path[..count]));
    let count = known.unwrap_or(0);
    let module = path[..count].to_vec();
    let Some(name) = path.get(count).filter(|_| depth < 8) else {
        return module;
    };
    let handed = files[&module].names.iter().find(|(own, _)| own == name);
    match handed.and_then(|(_, from)| absolute(files, &module, from)) {
        Some(from) if from != path => {
            let whole: Vec<String> = from.iter().chain(&path[count + 1..]).cloned().collect();
            target(files, &whole, depth + 1)
        }
        _ => module,
    }
}

#[test]
fn a_circle_of_files_is_seen_through_nested_imports_and_names_that_are_handed_on() {
    let file = |path: &str, text: &str| (path.to_owned(), text.to_owned());
    let files = [
        file(
            "lib.rs",
            "mod room;\npub use room::{one::One, two};\n#[cfg(test)]\nmod tests;\n",
        ),
        file(
            "room/mod.rs",
            "pub mod one;\npub mod two;\npub mod three;\npub use three::Three;\n",
        ),
        file(
            "room/one.rs",
            "use super::{\n    two::Two,\n};\n// use crate::room::three::Not;\n",
        ),
        file("room/two.rs", "fn f() { crate::room::Three::new(); }\n"),
        file(
            "room/three.rs",
            "mod unix {\n    #[cfg(all(test, unix))]\n    mod tests {\n        use crate::room::two::Two;\n    }\n}\n\
             #[cfg(test)]\nmod tests {\n    use super::super::two::Two;\n}\nuse crate::One;\n",
        ),
        file("tests.rs", "use super::room::two::Two;\n"),
    ];
    let imports = Imports::of_files(&files);
    let names = |module: &Module| module.join("::");
    let circles = imports.circles();
    let found: Vec<Vec<String>> = circles.iter().map(|c| c.iter().map(names).collect()).collect();
    assert_eq!(found, [["room::one", "room::three", "room::two"]]);
    let path = |names: [&str; 2]| names.map(str::to_owned).to_vec();
    let of_three = &imports.of[&path(["room", "three"])];
    assert_eq!(
        *of_three,
        BTreeSet::from([path(["room", "one"])]),
        "not of its tests"
    );
    assert!(!imports.of.contains_key(&vec!["tests".to_owned()]));
    let broken: Vec<(String, String)> = files
        .iter()
        .filter(|(path, _)| path != "room/three.rs")
        .cloned()
        .chain([file("room/three.rs", "pub struct Three;\n")])
        .collect();
    assert!(Imports::of_files(&broken).circles().is_empty());
}
