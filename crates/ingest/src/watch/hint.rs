//! What an event of the operating system is worth: nothing, a look, or a look at everything.

use std::path::{Path, PathBuf};

use notify::event::{
    AccessKind, AccessMode, CreateKind, Event, EventKind, MetadataKind, ModifyKind, RenameMode,
};

use crate::scan::{StatesFor, is_own_product, is_passing_name, states_for};

/// What an event is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hint {
    /// Something may have changed: scan.
    Look,
    /// A folder may have come: its files may have come before its events, so scan now and again soon.
    LookAgain,
    /// Events were lost: scan everything.
    Rescan,
}

/// The folders whose events count, both absolute and real.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Places {
    /// The campaign's folder.
    pub campaign: PathBuf,
    /// The runs folder in it.
    pub runs: PathBuf,
    /// Further folders with data, which need not be there.
    pub optional: Vec<PathBuf>,
}

impl Places {
    /// Whether a change at `path` can change runs, climate logs or tags.
    fn counts(&self, path: &Path) -> bool {
        let Ok(relative) = path.strip_prefix(&self.campaign) else {
            return false;
        };
        if is_own_product(relative) {
            return false;
        }
        let mut folders = self.folders();
        match folders.find_map(|folder| path.strip_prefix(folder).ok()) {
            Some(below) => !below.iter().any(is_passing_name),
            None => self.folders().any(|folder| folder.starts_with(path)) || self.is_statement_above(path),
        }
    }

    /// The folders with data, that of the runs first.
    pub(super) fn folders(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.runs).chain(&self.optional)
    }

    /// campaign.toml, or a tags.toml in a folder above the data.
    fn is_statement_above(&self, path: &Path) -> bool {
        let is_above = |folder: &Path| self.folders().any(|data| data.starts_with(folder));
        let above = path.parent().is_some_and(is_above);
        let name = path.file_name().unwrap_or_default();
        above && (name == "campaign.toml" || states_for(name) == Some(StatesFor::Folder))
    }
}

/// What `event` is worth; none where it comes of reading, or of what is no run and no tag.
///
/// Reading a file makes events of its own (open, close without writing, access time): were they hints, each
/// scan would call for the next.
pub fn hint_of(event: &Event, places: &Places) -> Option<Hint> {
    if event.need_rescan() {
        return Some(Hint::Rescan);
    }
    let hint = worth_of_kind(&event.kind)?;
    if event.paths.is_empty() {
        // Something happened and nobody says where.
        return Some(Hint::Rescan);
    }
    event.paths.iter().any(|path| places.counts(path)).then_some(hint)
}

fn worth_of_kind(kind: &EventKind) -> Option<Hint> {
    match kind {
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => Some(Hint::Look),
        EventKind::Access(_) | EventKind::Modify(ModifyKind::Metadata(MetadataKind::AccessTime)) => None,
        EventKind::Create(CreateKind::File) | EventKind::Modify(ModifyKind::Name(RenameMode::From)) => {
            Some(Hint::Look)
        }
        // What was renamed may be a folder with files in it.
        EventKind::Create(_) | EventKind::Modify(ModifyKind::Name(_)) => Some(Hint::LookAgain),
        EventKind::Any | EventKind::Other | EventKind::Modify(_) | EventKind::Remove(_) => Some(Hint::Look),
    }
}

#[cfg(test)]
mod tests {
    use notify::event::{DataChange, Flag, RemoveKind};

    use super::*;

    fn places() -> Places {
        Places {
            campaign: PathBuf::from("/c"),
            runs: PathBuf::from("/c/data/runs"),
            optional: vec![PathBuf::from("/c/dma"), PathBuf::from("/c/ambient")],
        }
    }

    fn hint(kind: EventKind, paths: &[&str]) -> Option<Hint> {
        let event = paths
            .iter()
            .fold(Event::new(kind), |event, path| event.add_path(path.into()));
        hint_of(&event, &places())
    }

    #[test]
    fn each_kind_of_event_has_its_worth() {
        use EventKind::{Access, Any, Create, Modify, Other, Remove};
        let named = |mode| Modify(ModifyKind::Name(mode));
        let (look, again) = (Some(Hint::Look), Some(Hint::LookAgain));
        for (kind, expected) in [
            (Access(AccessKind::Open(AccessMode::Any)), None),
            (Access(AccessKind::Close(AccessMode::Read)), None),
            (Access(AccessKind::Read), None),
            (Access(AccessKind::Any), None),
            (Access(AccessKind::Close(AccessMode::Write)), look),
            (Create(CreateKind::File), look),
            (Create(CreateKind::Folder), again),
            (Create(CreateKind::Any), again),
            (Modify(ModifyKind::Data(DataChange::Any)), look),
            (Modify(ModifyKind::Metadata(MetadataKind::Any)), look),
            (Modify(ModifyKind::Metadata(MetadataKind::AccessTime)), None),
            (named(RenameMode::To), again),
            (named(RenameMode::Both), again),
            (named(RenameMode::From), look),
            (Remove(RemoveKind::File), look),
            (Any, look),
            (Other, look),
        ] {
            assert_eq!(hint(kind, &["/c/data/runs/a.csv"]), expected, "{kind:?}");
        }
    }

    #[test]
    fn only_runs_and_tags_count() {
        let kind = EventKind::Modify(ModifyKind::Data(DataChange::Any));
        for path in [
            "/c/data/runs",
            "/c/data/runs/a.csv",
            "/c/data/runs/a.csv.toml",
            "/c/data/runs/deep/tags.toml",
            "/c/data/runs/report/a.csv",
            "/c/data/tags.toml",
            "/c/data",
            "/c/dma",
            "/c/dma/a.txt",
            "/c/dma/tags.toml",
            "/c/tags.toml",
            "/c/campaign.toml",
            "/c/ambient",
            "/c/ambient/box/a.csv",
            "/c",
        ] {
            assert_eq!(hint(kind, &[path]), Some(Hint::Look), "{path}");
        }
        for path in [
            "/c/campaign.db",
            "/c/campaign.db-wal",
            "/c/report/index.html",
            "/c/archive/ab/x.csv",
            "/c/notes.txt",
            "/c/other/tags.toml",
            "/c/dma-old/a.txt",
            "/c/dma/a.txt.part",
            "/c/data/runs/a.csv.part",
            "/c/ambient/a.csv.part",
            "/c/ambient2/a.csv",
            "/c/data/runs/.cache/a.csv",
            "/c/data/runs/~$book.xlsx",
            "/elsewhere/a.csv",
        ] {
            assert_eq!(hint(kind, &[path]), None, "{path}");
        }
    }

    #[test]
    fn a_rename_counts_by_either_name() {
        let kind = EventKind::Modify(ModifyKind::Name(RenameMode::Both));
        let into_place = ["/c/data/runs/a.csv.part", "/c/data/runs/a.csv"];
        assert_eq!(hint(kind, &into_place), Some(Hint::LookAgain));
        assert_eq!(
            hint(kind, &["/c/data/runs/a.csv", "/c/old/a.csv"]),
            Some(Hint::LookAgain)
        );
        assert_eq!(hint(kind, &["/c/data/runs/a.tmp", "/c/data/runs/b.tmp"]), None);
    }

    #[test]
    fn an_overflowing_queue_asks_for_everything() {
        let overflow = Event::new(EventKind::Other).set_flag(Flag::Rescan);
        assert_eq!(hint_of(&overflow, &places()), Some(Hint::Rescan));
        assert_eq!(hint(EventKind::Any, &[]), Some(Hint::Rescan));
        assert_eq!(hint(EventKind::Access(AccessKind::Any), &[]), None);
    }
}
