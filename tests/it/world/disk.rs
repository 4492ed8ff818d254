//! A model of a disk: what of a campaign would be there if the power went now.
//!
//! Bytes are safe from when their file was waited for, names from when their folder was. What was not may be there, be
//! missing, be cut short, or read as zeros; of the changes of one folder's names a first part is there, and a change of two
//! folders is there in both or in neither. That is what POSIX promises and no more; file systems are kinder.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use ieap::system::{Call, Kind};
use rand::{Rng, RngExt};

/// Number of a file or folder.
type Id = usize;
/// A name in a folder.
type Name = (Id, OsString);

/// A file or folder that the program made.
#[derive(Debug, Clone, Default)]
struct Node {
    is_folder: bool,
    /// Its bytes when it was waited for last; none where they never were.
    synced: Option<Vec<u8>>,
    /// Whether it was written to since.
    is_dirty: bool,
    /// Whether waiting for it failed: a system forgets then what it had to write, and the next wait says that all is well.
    is_lost: bool,
    /// Its bytes when it lost its last name.
    last: Vec<u8>,
}

/// A change of names that happens as a whole.
#[derive(Debug, Clone)]
struct Change {
    sets: Vec<(Name, Option<Id>)>,
}

impl Change {
    fn touches(&self, folders: &BTreeSet<Id>) -> bool {
        self.sets.iter().any(|((folder, _), _)| folders.contains(folder))
    }

    fn folders(&self) -> impl Iterator<Item = Id> + '_ {
        self.sets.iter().map(|((folder, _), _)| *folder)
    }
}

type Names = BTreeMap<Name, Id>;

fn apply(names: &mut Names, change: &Change) {
    for (name, id) in &change.sets {
        match id {
            Some(id) => names.insert(name.clone(), *id),
            None => names.remove(name),
        };
    }
}

/// The disk below one folder.
#[derive(Debug)]
pub struct Disk {
    root: PathBuf,
    nodes: Vec<Node>,
    /// As the program sees them.
    names: Names,
    safe: Names,
    /// Changes of names that are not safe, in order.
    waiting: Vec<Change>,
}

/// What is there after a loss of power: files with their bytes, folders without.
pub type Image = BTreeMap<PathBuf, Option<Vec<u8>>>;

const ROOT: Id = 0;

impl Disk {
    /// One on which everything is safe that is there.
    pub fn new(root: &Path) -> Disk {
        Disk {
            root: root.to_owned(),
            nodes: vec![Node {
                is_folder: true,
                ..Node::default()
            }],
            names: Names::new(),
            safe: Names::new(),
            waiting: Vec::new(),
        }
    }

    /// Somebody else changed files of the program, or took some away, a while ago: all that is there is safe.
    pub fn settle(&mut self) {
        for (id, path) in self.paths(&self.names) {
            self.nodes[id].is_lost = false;
            if !self.root.join(path).exists() {
                self.names.retain(|_, other| *other != id);
            }
        }
        self.all_synced();
    }

    /// All that lies in the root now is safe, but for files of these names, which stay unknown.
    pub fn know_all(&mut self, unknown: &[&str]) {
        let mut folders = vec![self.root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
                let path = entry.path();
                if unknown.iter().any(|name| path.ends_with(name)) {
                    continue;
                }
                self.known(&path);
                if let Some(id) = self.id(&path).filter(|_| path.is_file()) {
                    self.nodes[id].synced = fs::read(&path).ok();
                }
                if path.is_dir() {
                    folders.push(path);
                }
            }
        }
    }

    /// Before a call: keeps the bytes of what will lose its name.
    pub fn before(&mut self, call: &Call<'_>) {
        let loses = match call.kind {
            Kind::Remove | Kind::RemoveFolder | Kind::RemoveTree => Some(call.path),
            Kind::Rename => call.to,
            _ => None,
        };
        if matches!(
            call.kind,
            Kind::Rename | Kind::Exchange | Kind::RenameToFree | Kind::Link
        ) {
            self.known(call.path);
            if let Some(to) = call.to {
                self.known(to);
            }
        }
        for (path, id) in loses.map_or_else(Vec::new, |path| self.below(path)) {
            if let Ok(bytes) = fs::read(path) {
                self.nodes[id].last = bytes;
            }
        }
    }

    /// After a call that was done.
    pub fn after(&mut self, call: &Call<'_>) {
        match (call.kind, call.to) {
            (Kind::Create, _) => self.made(call.path),
            (Kind::Write | Kind::Truncate, _) => {
                if let Some(id) = self.id(call.path) {
                    (self.nodes[id].is_dirty, self.nodes[id].is_lost) = (true, false);
                }
            }
            (Kind::Sync, _) => self.synced(call.path),
            (Kind::SyncAll, _) => self.all_synced(),
            (Kind::MakeFolder, _) => self.made_folders(call.path),
            (Kind::Rename | Kind::RenameToFree, Some(to)) => {
                if let (Some(id), Some(from), Some(to)) =
                    (self.id(call.path), self.name(call.path), self.name(to))
                {
                    self.change(vec![(from, None), (to, Some(id))]);
                }
            }
            (Kind::Link, Some(to)) => {
                if let (Some(id), Some(to)) = (self.id(call.path), self.name(to)) {
                    self.change(vec![(to, Some(id))]);
                }
            }
            (Kind::Exchange, Some(to)) => {
                if let (Some(one), Some(other), Some(from), Some(to)) = (
                    self.id(call.path),
                    self.id(to),
                    self.name(call.path),
                    self.name(to),
                ) {
                    self.change(vec![(from, Some(other)), (to, Some(one))]);
                }
            }
            (Kind::Remove | Kind::RemoveFolder | Kind::RemoveTree, _) => {
                // What is in a folder goes before it.
                for (path, _) in self.below(call.path).into_iter().rev() {
                    if let Some(name) = self.name(&path) {
                        self.change(vec![(name, None)]);
                    }
                }
            }
            _ => {}
        }
    }

    /// A wait for the disk failed.
    pub fn not_synced(&mut self, call: &Call<'_>) {
        let one = self.id(call.path);
        for (id, node) in self.nodes.iter_mut().enumerate() {
            let is_it = call.kind == Kind::SyncAll || one == Some(id);
            node.is_lost |= is_it && node.is_dirty;
        }
    }

    /// What would be there if the power went now.
    pub fn image(&self, rng: &mut impl Rng) -> Image {
        let mut names = self.safe.clone();
        let mut stopped: BTreeSet<Id> = BTreeSet::new();
        // Sometimes nearly all is there, sometimes nearly nothing.
        let kept = rng.random_range(0.0..1.0);
        for change in &self.waiting {
            if change.touches(&stopped) || !rng.random_bool(kept) {
                stopped.extend(change.folders());
            } else {
                apply(&mut names, change);
            }
        }
        let mut image = Image::new();
        let now = self.paths(&self.names);
        for (id, path) in self.paths(&names) {
            let there = now.iter().find(|(other, _)| *other == id);
            let bytes = there.and_then(|(_, path)| fs::read(self.root.join(path)).ok());
            let bytes = bytes.unwrap_or_else(|| self.nodes[id].last.clone());
            let node = &self.nodes[id];
            image.insert(path, (!node.is_folder).then(|| after_loss(node, bytes, rng)));
        }
        image
    }

    /// Makes the folder what the image says, as far as the program made it; everything in it is safe then.
    pub fn put(&mut self, image: &Image) {
        let mut there = self.paths(&self.names);
        there.reverse();
        for (id, path) in there {
            let full = self.root.join(&path);
            match (self.nodes[id].is_folder, image.get(&path)) {
                (true, Some(None)) => {}
                (false, Some(Some(bytes))) if fs::read(&full).is_ok_and(|there| there == *bytes) => {}
                (true, _) => drop(fs::remove_dir_all(&full)),
                (false, _) => drop(fs::remove_file(&full)),
            }
        }
        let root = self.root.clone();
        *self = Disk::new(&root);
        for (path, bytes) in image {
            let full = root.join(path);
            match bytes {
                None => fs::create_dir_all(&full).unwrap(),
                Some(bytes) if !full.exists() => fs::write(&full, bytes).unwrap(),
                Some(_) => {}
            }
            self.known(&full);
        }
    }

    fn id(&self, path: &Path) -> Option<Id> {
        let inside = path.strip_prefix(&self.root).ok()?;
        let mut id = ROOT;
        for part in inside.components() {
            id = *self.names.get(&(id, part.as_os_str().to_owned()))?;
        }
        Some(id)
    }

    fn name(&self, path: &Path) -> Option<Name> {
        Some((self.id(path.parent()?)?, path.file_name()?.to_owned()))
    }

    /// Takes what was there before into the model, as safe.
    fn known(&mut self, path: &Path) {
        let Ok(inside) = path.strip_prefix(&self.root).map(Path::to_owned) else {
            return;
        };
        let (mut id, mut at) = (ROOT, self.root.clone());
        for part in inside.components() {
            at.push(part);
            let name = (id, part.as_os_str().to_owned());
            id = match (self.names.get(&name), fs::metadata(&at)) {
                (Some(id), _) => *id,
                (None, Err(_)) => return,
                (None, Ok(found)) => {
                    let made = self.node(found.is_dir(), false);
                    self.names.insert(name.clone(), made);
                    self.safe.insert(name, made);
                    made
                }
            };
        }
    }

    fn node(&mut self, is_folder: bool, is_dirty: bool) -> Id {
        self.nodes.push(Node {
            is_folder,
            is_dirty,
            ..Node::default()
        });
        self.nodes.len() - 1
    }

    fn change(&mut self, sets: Vec<(Name, Option<Id>)>) {
        let change = Change { sets };
        apply(&mut self.names, &change);
        self.waiting.push(change);
    }

    fn made(&mut self, path: &Path) {
        if let Some(id) = self.id(path) {
            let is_emptied = fs::metadata(path).is_ok_and(|found| found.len() == 0);
            self.nodes[id].is_dirty |= is_emptied;
            return;
        }
        path.parent().into_iter().for_each(|folder| self.known(folder));
        if let Some(name) = self.name(path) {
            let id = self.node(false, true);
            self.change(vec![(name, Some(id))]);
        }
    }

    fn made_folders(&mut self, path: &Path) {
        let Ok(inside) = path.strip_prefix(&self.root).map(Path::to_owned) else {
            return;
        };
        let mut at = self.root.clone();
        for part in inside.components() {
            at.push(part);
            if let (None, Some(name)) = (self.id(&at), self.name(&at)) {
                let id = self.node(true, false);
                self.change(vec![(name, Some(id))]);
            }
        }
    }

    fn synced(&mut self, path: &Path) {
        let Some(id) = self.id(path) else { return };
        if self.nodes[id].is_folder {
            return self.names_synced(id);
        }
        let bytes = fs::read(path).unwrap_or_default();
        let node = &mut self.nodes[id];
        if !node.is_lost {
            (node.synced, node.is_dirty) = (Some(bytes), false);
        }
    }

    /// The changes of a folder's names become safe, with all that came before them in the folders that they touch.
    fn names_synced(&mut self, folder: Id) {
        let mut folders = BTreeSet::from([folder]);
        let mut goes = vec![false; self.waiting.len()];
        for (change, goes) in self.waiting.iter().zip(&mut goes).rev() {
            *goes = change.touches(&folders);
            if *goes {
                folders.extend(change.folders());
            }
        }
        let waiting = std::mem::take(&mut self.waiting);
        for (change, goes) in waiting.into_iter().zip(goes) {
            if goes {
                apply(&mut self.safe, &change)
            } else {
                self.waiting.push(change)
            }
        }
    }

    fn all_synced(&mut self) {
        for (id, path) in self.paths(&self.names) {
            if !self.nodes[id].is_folder {
                self.synced(&self.root.join(path));
            }
        }
        self.waiting.clear();
        self.safe = self.names.clone();
    }

    /// What can be reached by these names, a folder before what is in it; paths in the root.
    fn paths(&self, names: &Names) -> Vec<(Id, PathBuf)> {
        let mut found = vec![(ROOT, PathBuf::new())];
        let mut next = 0;
        while let Some((folder, path)) = found.get(next).cloned() {
            next += 1;
            let inside = names.range((folder, OsString::new())..);
            let inside = inside.take_while(|((parent, _), _)| *parent == folder);
            found.extend(inside.map(|((_, name), id)| (*id, path.join(name))));
        }
        found.remove(0);
        found
    }

    /// A path and all that is below it, a folder before what is in it.
    fn below(&self, path: &Path) -> Vec<(PathBuf, Id)> {
        let all = self.paths(&self.names).into_iter();
        let full = all.map(|(id, inside)| (self.root.join(inside), id));
        full.filter(|(found, _)| found.starts_with(path)).collect()
    }
}

/// What is left of the bytes of a file.
fn after_loss(node: &Node, now: Vec<u8>, rng: &mut impl Rng) -> Vec<u8> {
    if !node.is_dirty {
        return node.synced.clone().unwrap_or(now);
    }
    let before = node.synced.clone().unwrap_or_default();
    if node.is_lost {
        return before;
    }
    // What is as it was is safe.
    let safe = before
        .iter()
        .zip(&now)
        .take_while(|(before, now)| before == now)
        .count();
    let from = rng.random_range(safe..=now.len());
    match rng.random_range(0..4) {
        0 => before,
        1 => now,
        2 => now[..from].to_vec(),
        _ => {
            let mut zeroed = now;
            zeroed[from..].fill(0);
            zeroed
        }
    }
}
