//! A campaign that is worked on: its folder, what campaign.toml says, its database.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use crate::domain::{Campaign, Issue, MadeBy};
use crate::ingest::campaign_file;
use crate::ingest::profiles::{self, Profiles};
use crate::ingest::run_sheet::RunSheets;
use crate::ingest::scan::{self, ReadFileError};
use crate::ingest::tags::TagFiles;
use crate::pipeline::{PipelineError, failed};
use crate::store::{InstanceLock, Store};
use crate::system::passing::Passing;

use super::holdings;

/// Version of this program, as fits and reports record it.
pub const CODE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// The commit that this program was built from, as [`MadeBy`] tells it.
pub const BUILT_FROM: &str = env!("IEAP_BUILT_FROM");

/// This program, as results record it.
pub(crate) static PROGRAM: MadeBy = MadeBy {
    version: Cow::Borrowed(CODE_VERSION),
    built_from: Cow::Borrowed(BUILT_FROM),
};

/// Gives the bytes of a file that is not larger than the limit, bytes: `read_stable` of the scan, or what stands in for a disk.
pub type ReadFile = fn(&Path, u64) -> Result<Vec<u8>, ReadFileError>;

/// The campaign at work.
#[derive(Debug)]
pub struct Context {
    /// The campaign folder.
    pub folder: PathBuf,
    /// What campaign.toml says.
    pub campaign: Campaign,
    /// What is odd in campaign.toml but no error.
    pub warnings: Vec<Issue>,
    /// Saved profiles of the campaign, by id, and those that cannot be read.
    pub profiles: Profiles,
    /// Run sheets among the runs, as they were read last; none until runs are tagged.
    pub sheets: RunSheets,
    /// Files that state tags of runs, as they were read last.
    pub stated: TagFiles,
    /// BLAKE3 of campaign.toml's text.
    pub campaign_digest: String,
    /// What a look at the campaign found that followed a disorderly end: raw files that are lost, a damaged journal.
    pub damage: Vec<Issue>,
    /// What the database and the journal lacked of each other and have now, and what may be lost until a person answers.
    pub agreed: Vec<Issue>,
    /// The database.
    pub store: Store,
    /// How data files are read.
    pub read_file: ReadFile,
    pub(crate) lock: Option<InstanceLock>,
    /// Where the database is, where it is made to take the place of another one.
    pub(crate) aside: Option<Passing>,
}

impl Context {
    /// The same campaign with a connection of its own, for another thread of this program.
    ///
    /// # Errors
    /// As [`Context::open`], but for the lock.
    pub fn beside(&self) -> Result<Context, PipelineError> {
        let loaded = campaign_file::read(&self.folder)?;
        holdings::refuse_lost_database(&self.folder)?;
        let store = Store::open(&self.folder)?;
        holdings::check(&self.folder, &store)?;
        Ok(Context::with(&self.folder, loaded, store, None))
    }

    /// Refuses to go on where the database or the archive was lost or replaced since they were opened.
    ///
    /// # Errors
    /// They were, or the archive cannot be looked at.
    pub fn check_in_place(&self) -> Result<(), PipelineError> {
        self.store.check_in_place()?;
        holdings::check(&self.folder, &self.store)
    }

    /// Reads campaign.toml and the profiles again, after they changed.
    ///
    /// # Errors
    /// campaign.toml is missing or wrong; the context keeps what it knew.
    pub fn reload(&mut self) -> Result<(), PipelineError> {
        let loaded = campaign_file::read(&self.folder)?;
        self.profiles = profiles::load(&self.folder);
        keep(&self.folder, &loaded)?;
        self.campaign_digest = digest(&loaded.text);
        self.campaign = loaded.campaign;
        self.warnings = loaded.warnings;
        Ok(())
    }

    /// Refuses settings that cannot be read, where the campaign was opened to be shown without them.
    ///
    /// # Errors
    /// campaign.toml or a profile is missing or wrong.
    pub fn refuse_unread(&self) -> Result<(), PipelineError> {
        campaign_file::read(&self.folder)?;
        profiles::load(&self.folder).strict()?;
        Ok(())
    }

    pub(crate) fn with(
        folder: &Path,
        loaded: campaign_file::Loaded,
        store: Store,
        lock: Option<InstanceLock>,
    ) -> Context {
        Context {
            folder: folder.to_owned(),
            profiles: profiles::load(folder),
            sheets: RunSheets::default(),
            stated: TagFiles::of(folder),
            campaign_digest: digest(&loaded.text),
            campaign: loaded.campaign,
            warnings: loaded.warnings,
            damage: Vec::new(),
            agreed: Vec::new(),
            store,
            read_file: scan::read_stable,
            lock,
            aside: None,
        }
    }
}

/// Keeps the text of campaign.toml that is worked with: what is shown while the file cannot be read is shown by it.
pub(crate) fn keep(folder: &Path, loaded: &campaign_file::Loaded) -> Result<(), PipelineError> {
    let kept = campaign_file::keep(folder, loaded);
    kept.map_err(failed(
        &folder.join(campaign_file::KEPT),
        "keeping the text of campaign.toml",
    ))
}

/// Now, RFC 3339 in UTC to the second: what the database records.
pub fn now() -> String {
    moment().strftime("%Y-%m-%dT%H:%M:%SZ").to_string()
}

/// Now. A clock that shows a year which no date has stands for 1970.
pub(crate) fn moment() -> jiff::Timestamp {
    jiff::Timestamp::try_from(crate::system::now()).unwrap_or(jiff::Timestamp::UNIX_EPOCH)
}

fn digest(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}
