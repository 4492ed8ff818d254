//! What somebody else does in a campaign while a verb is at work.

use std::fs;
use std::path::Path;

use super::room::{CAMPAIGN, readings};
use super::verbs::{Ended, LOCK, Word, ended, rebuild, settle, tag};

/// Somebody else, who does one thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Meets {
    /// An instrument saves a run and its sidecar.
    Save,
    /// A person renames the file of a run.
    Rename,
    /// The same in two steps, between which a look sees both names.
    Move,
    /// A person tags a run.
    Tag,
    /// A second program takes in and fits.
    Run,
    /// The same, after somebody has deleted the lock file.
    RunWithoutLock,
    /// A second program rebuilds.
    Rebuild,
}

impl Meets {
    /// What is said by it.
    pub fn word(self) -> Option<Word> {
        (self == Meets::Tag).then_some(Word {
            key: "temperature_c",
            text: "21.5",
        })
    }

    /// Whether the campaign says something else afterwards.
    pub fn changes(self) -> bool {
        matches!(self, Meets::Save | Meets::Rename | Meets::Tag)
    }

    /// What a look may have seen of it.
    pub fn seen_as(self) -> Vec<Meets> {
        match self {
            Meets::Rename => vec![Meets::Rename, Meets::Move],
            other => vec![other],
        }
    }

    pub fn does(self, room: &Path) -> Ended {
        let campaign = room.join(CAMPAIGN);
        let settled = || Ok((settle(&campaign)?, None));
        ended(|| match self {
            Meets::Save => {
                fs::write(campaign.join("runs/e.csv"), readings(5)).unwrap();
                fs::write(campaign.join("runs/e.csv.toml"), "temperature_c = 30.0\n").unwrap();
                Ok((0, None))
            }
            Meets::Rename => {
                fs::create_dir_all(campaign.join("runs/day2")).unwrap();
                fs::rename(campaign.join("runs/b.csv"), campaign.join("runs/day2/b.csv")).unwrap();
                Ok((0, None))
            }
            Meets::Move => {
                fs::create_dir_all(campaign.join("runs/day2")).unwrap();
                fs::copy(campaign.join("runs/b.csv"), campaign.join("runs/day2/b.csv")).unwrap();
                settled()?;
                fs::remove_file(campaign.join("runs/b.csv")).unwrap();
                settled()
            }
            Meets::Tag => tag(&campaign, "runs/a.csv", "temperature_c", "21.5").map(|status| (status, None)),
            Meets::Run => settled(),
            Meets::RunWithoutLock => {
                let _ = fs::remove_file(campaign.join(LOCK));
                settled()
            }
            Meets::Rebuild => rebuild(&campaign),
        })
    }
}
