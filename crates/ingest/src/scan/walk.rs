//! The way through the folders of a campaign.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::display::display_path;
use super::fingerprint::{changed_ns, identity, modified_ns};
use super::found::{Scan, ScanError, ScanLimits, SeenFile};
use super::frame_folder;
use super::names::{is_own_product, is_passing_name, states_for};
use ieap_domain::Issue;
use ieap_system::fs::{self, Metadata};

/// Looks through `runs_folder` and the `optional` folders (relative to `campaign`) and everything below them.
///
/// An optional folder that is not there is no fault; what is known below it is out of sight, not gone.
///
/// Hidden and passing files and what the program writes itself are left out, `.toml` files listed apart. Links are
/// followed only to what lies inside the campaign, and no folder is looked into twice. A folder below that
/// cannot be read is an issue, and the rest is looked through.
///
/// # Errors
/// Where the runs folder is missing, unreadable or outside, or holds more files than the limit.
pub fn scan(
    campaign: &Path,
    runs_folder: &str,
    optional: &[&str],
    limits: ScanLimits,
) -> Result<Scan, ScanError> {
    let path = campaign.join(runs_folder);
    let root = |source: io::Error| match source.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => {
            ScanError::FolderMissing { path: path.clone() }
        }
        _ => ScanError::FolderUnreadable {
            path: path.clone(),
            source,
        },
    };
    let campaign_real = fs::canonicalize(campaign).map_err(root)?;
    let runs_real = fs::canonicalize(&path).map_err(root)?;
    if !runs_real.starts_with(&campaign_real) {
        return Err(ScanError::FolderOutside { path: path.clone() });
    }
    if !fs::metadata(&runs_real).map_err(root)?.is_dir() {
        return Err(ScanError::FolderMissing { path: path.clone() });
    }
    fs::read_dir(&path).map_err(root)?;
    let mut walk = Walk {
        campaign,
        campaign_real,
        limits,
        now: ieap_system::now(),
        looked_into: BTreeSet::new(),
        links: Vec::new(),
        found: Scan::default(),
    };
    let mut starts = vec![plain(runs_folder)];
    for folder in optional {
        if walk.is_present(&plain(folder)) {
            starts.push(plain(folder))
        } else {
            walk.found.unreadable.push((*folder).to_owned())
        }
    }
    let whole = walk.everything(starts);
    if !whole {
        return Err(ScanError::TooManyFiles {
            path,
            limit: limits.files,
        });
    }
    Ok(walk.sorted())
}

/// A folder's path by its names alone.
fn plain(folder: &str) -> PathBuf {
    let names = Path::new(folder).components();
    names
        .filter(|part| matches!(part, std::path::Component::Normal(_)))
        .collect()
}

/// A scan under way.
pub(super) struct Walk<'a> {
    campaign: &'a Path,
    campaign_real: PathBuf,
    limits: ScanLimits,
    pub(super) now: SystemTime,
    /// The real path of each folder looked into, so that a link to one of them ends there.
    looked_into: BTreeSet<PathBuf>,
    /// Links met, to be followed when all real folders are known.
    links: Vec<(PathBuf, usize)>,
    pub(super) found: Scan,
}

impl Walk<'_> {
    /// Walks real folders first, then links in the order of their paths: a folder that is also reachable by
    /// a link is so always found under its own name. False where there are too many files.
    fn everything(&mut self, starts: Vec<PathBuf>) -> bool {
        for start in starts {
            self.folder_tree(start, 0);
        }
        while !self.links.is_empty() && self.found.files.len() <= self.limits.files {
            let mut links = std::mem::take(&mut self.links);
            links.sort();
            for (relative, depth) in links {
                self.link(relative, depth);
            }
        }
        self.found.files.len() <= self.limits.files
    }

    /// Whether an optional folder is there and lies in the campaign; a link that leads out of it is an issue.
    fn is_present(&mut self, relative: &Path) -> bool {
        let Ok(real) = fs::canonicalize(self.campaign.join(relative)) else {
            return false;
        };
        let is_inside = real.starts_with(&self.campaign_real);
        if !is_inside {
            self.link_outside(relative, &real);
        }
        is_inside && fs::is_dir(&real).unwrap_or(false)
    }

    fn folder_tree(&mut self, start: PathBuf, depth: usize) {
        let mut waiting = vec![(start, depth)];
        while let Some((relative, depth)) = waiting.pop() {
            if self.found.files.len() > self.limits.files {
                return;
            }
            if depth > self.limits.depth {
                self.too_deep(&relative);
                continue;
            }
            match self.folder(&relative, depth) {
                Ok(below) => waiting.extend(below.into_iter().map(|folder| (folder, depth + 1))),
                // Where it is gone, what was in it is gone too.
                Err(error) => self.unreadable(&relative, &error),
            }
        }
    }

    /// Notes the files of one folder and gives the folders in it.
    fn folder(&mut self, relative: &Path, depth: usize) -> io::Result<Vec<PathBuf>> {
        let path = self.campaign.join(relative);
        if !self.looked_into.insert(fs::canonicalize(&path)?) {
            return Ok(Vec::new());
        }
        let mut below = Vec::new();
        let entries = fs::entries(&path)?;
        if depth > 0 && frame_folder::is_one(&entries) {
            self.folder_of_frames(relative, &path, &entries)?;
            return Ok(Vec::new());
        }
        self.found.folders.push(relative.to_path_buf());
        for entry in entries {
            let name = entry.file_name();
            let relative = relative.join(&name);
            if is_passing_name(&name) || is_own_product(&relative) {
                continue;
            }
            let kind = match entry.file_type() {
                Ok(kind) => kind,
                Err(error) => {
                    self.unreadable(&relative, &error);
                    continue;
                }
            };
            if kind.is_symlink() {
                self.links.push((relative, depth));
            } else if kind.is_dir() {
                below.push(relative);
            } else if kind.is_file() {
                match entry.metadata() {
                    Ok(metadata) => self.file(relative, &metadata, None),
                    Err(error) => self.unreadable(&relative, &error),
                }
            } else {
                self.special(&relative);
            }
        }
        Ok(below)
    }

    fn link(&mut self, relative: PathBuf, depth: usize) {
        let target = match fs::canonicalize(self.campaign.join(&relative)) {
            Ok(target) => target,
            Err(error) => return self.broken_link(&relative, &error),
        };
        let Ok(inside) = target.strip_prefix(&self.campaign_real) else {
            return self.link_outside(&relative, &target);
        };
        if is_own_product(inside) || inside.components().next().is_none() {
            return self.link_to_own(&relative, &target);
        }
        match fs::metadata(&target) {
            Ok(metadata) if metadata.is_dir() => self.folder_tree(relative, depth + 1),
            Ok(metadata) if metadata.is_file() => self.file(relative, &metadata, Some(target)),
            Ok(_) => self.special(&relative),
            Err(error) => self.broken_link(&relative, &error),
        }
    }

    fn file(&mut self, relative: PathBuf, metadata: &Metadata, link_target: Option<PathBuf>) {
        let modified = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        let file = SeenFile {
            display: display_path(&relative),
            relative,
            size_bytes: metadata.len(),
            modified_ns: modified_ns(metadata),
            inode: identity(metadata).1,
            changed_ns: changed_ns(metadata),
            age: self.now.duration_since(modified).ok(),
            link_target,
        };
        let states = file.relative.file_name().and_then(states_for);
        let list = match states {
            Some(_) => &mut self.found.statements,
            None => &mut self.found.files,
        };
        list.push(file.into());
    }

    fn sorted(mut self) -> Scan {
        let bytes = |path: &Path| path.as_os_str().as_encoded_bytes().to_vec();
        self.found.files.sort_by_cached_key(|file| bytes(&file.relative));
        self.found
            .statements
            .sort_by_cached_key(|file| bytes(&file.relative));
        self.found.folders.sort_by_cached_key(|folder| bytes(folder));
        self.found.unreadable.sort();
        self.found
            .issues
            .sort_by(|a, b| (&a.place, &a.code).cmp(&(&b.place, &b.code)));
        self.found
    }

    /// Notes what cannot be read and may well be there. One that has gone since its folder was listed is no fault.
    fn unreadable(&mut self, relative: &Path, error: &io::Error) {
        if error.kind() == io::ErrorKind::NotFound && !self.is_listed(relative) {
            return;
        }
        let shown = display_path(relative);
        let issue = Issue::warning("folder-unreadable", format!("cannot be looked into: {error}"));
        let mend = "give your user the right to read it, or check the disk or share";
        self.found.issues.push(issue.at(&shown).mend(mend));
        self.found.unreadable.push(shown);
    }

    /// Whether a folder still has that name in it: some systems give names of which they say then that there is no such file.
    fn is_listed(&self, relative: &Path) -> bool {
        let above = relative.parent().unwrap_or(Path::new(""));
        match fs::entries(self.campaign.join(above)) {
            Ok(entries) => entries
                .iter()
                .any(|entry| Some(entry.file_name().as_os_str()) == relative.file_name()),
            Err(error) => error.kind() != io::ErrorKind::NotFound,
        }
    }

    fn too_deep(&mut self, relative: &Path) {
        let depth = self.limits.depth;
        let shown = display_path(relative);
        let issue = Issue::warning(
            "folder-too-deep",
            format!("lies more than {depth} folders deep: not looked into"),
        );
        self.found.issues.push(issue.at(&shown).mend("move the files up"));
        self.found.unreadable.push(shown);
    }

    fn link_outside(&mut self, relative: &Path, target: &Path) {
        let message = format!(
            "a link to {}, outside of the campaign: not followed",
            target.display()
        );
        let issue = Issue::warning("link-outside", message).at(display_path(relative));
        self.found
            .issues
            .push(issue.mend("copy the files into the campaign"));
    }

    fn link_to_own(&mut self, relative: &Path, target: &Path) {
        let message = format!(
            "a link to {}, which holds more than runs: not followed",
            target.display()
        );
        let issue = Issue::warning("link-not-followed", message).at(display_path(relative));
        self.found.issues.push(issue.mend("take the link away"));
    }

    fn broken_link(&mut self, relative: &Path, error: &io::Error) {
        let shown = display_path(relative);
        let issue = Issue::warning("link-broken", format!("a link that leads nowhere: {error}"));
        self.found.issues.push(
            issue
                .at(&shown)
                .mend("take the link away, or bring its target back"),
        );
        self.found.unreadable.push(shown);
    }

    fn special(&mut self, relative: &Path) {
        let issue = Issue::note("not-a-file", "neither a file nor a folder: left out");
        self.found.issues.push(issue.at(display_path(relative)));
    }
}
