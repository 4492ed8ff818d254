//! Why a verb could not do its work.

mod backup;
mod holdings;
mod spec;

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::analysis::ExportError;
use crate::fit::FitError;
use crate::ingest::archive::ArchiveError;
use crate::ingest::campaign_file::CampaignFileError;
use crate::ingest::frames::FramesError;
use crate::ingest::profiles::ProfileError;
use crate::ingest::scan::ScanError;
use crate::ingest::watch::WatchError;
use crate::model::scaling::ScalingError;
use crate::report::ReportError;
use crate::store::StoreError;

pub use backup::{BackupError, FILE_NAME as BACKUP_LIST};
pub use holdings::HoldingsError;
pub use spec::SpecError;

/// A failure of a verb. Files that cannot be read are no failure: they are refused, and the work goes on.
#[derive(Debug, Error)]
pub enum PipelineError {
    /// campaign.toml is missing or wrong.
    #[error(transparent)]
    Campaign(#[from] CampaignFileError),
    /// A saved profile is wrong.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// The database refused.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The database and the archive are not there, or not those of one campaign.
    #[error(transparent)]
    Holdings(#[from] HoldingsError),
    /// There is no backup, or it is not restored.
    #[error(transparent)]
    Backup(#[from] BackupError),
    /// The runs folder cannot be listed.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// Raw bytes cannot be archived.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// The folder cannot be watched.
    #[error(transparent)]
    Watch(#[from] WatchError),
    /// The report cannot be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A table cannot be exported.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// Frames cannot be read as they are described.
    #[error(transparent)]
    Frames(#[from] FramesError),
    /// The scale of the frames is not known.
    #[error(
        "how many pixels make a millimetre is said nowhere. State `px_per_mm`, or `length_mm` (the strip's free length), in frames.toml or as an option"
    )]
    NoScale,
    /// None of the frames of the initial shape can be traced.
    #[error(
        "the initial shape cannot be traced, so that no bending can be counted from it: {frame}: {reason}"
    )]
    NoInitialShape {
        /// The first of them.
        frame: String,
        /// Why.
        reason: String,
    },
    /// A simulation spec is wrong.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// A file that would be written is there already.
    #[error("{path}: the file is there already. Remove it, or pass --overwrite.")]
    FileExists {
        /// The file.
        path: PathBuf,
    },
    /// A folder that would be replaced holds what the program did not write.
    #[error(
        "{folder}: not replaced, and nothing in it was touched: {found} was not written by ieap. Move it out of the folder, or give the folder another name, then run again."
    )]
    NotOurs {
        /// The folder.
        folder: PathBuf,
        /// What is not ours in it; the folder itself where it is no folder.
        found: PathBuf,
    },
    /// A file cannot be read or written.
    #[error("{path}: {doing} failed: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What was being done.
        doing: &'static str,
        /// What the system says.
        source: std::io::Error,
    },
    /// The model is not known.
    #[error("{0} Mend `model` in campaign.toml or the --model option.")]
    Model(#[from] FitError),
    /// No run has that name.
    #[error("no run is called {found:?}.{nearest} `ieap status` lists the runs.")]
    UnknownRun {
        /// The name given.
        found: String,
        /// A sentence with the nearest name, or nothing.
        nearest: String,
    },
    /// Another file lies under the name of a run than at the last look, or one that was not looked at yet: it is not known which
    /// measurement is meant.
    #[error(
        "{file} is not the file that was there when the folder was looked at last, so that it is open which measurement is meant; nothing was set. Run `ieap run` (or let the running `ieap watch` come to it), then say it again."
    )]
    Unseen {
        /// The file.
        file: String,
    },
    /// A tag is set under a key that is neither known nor declared, or to a value that no run can have.
    #[error("{found}; nothing was set. Mend: {mend}.")]
    TagRefused {
        /// What is wrong with the key or the value.
        found: String,
        /// How to mend it.
        mend: String,
    },
    /// A figure cannot be drawn.
    #[error("{figure}: {reason}")]
    Figure {
        /// Which.
        figure: &'static str,
        /// What the campaign lacks, or what the drawing library says.
        reason: String,
    },
    /// A fault of the program stopped a step.
    #[error("{step}: a fault of the program stopped it: {reason}. Report it with the files of the campaign.")]
    Fault {
        /// Which step.
        step: String,
        /// What the panic says.
        reason: String,
    },
    /// A table has no such row or column.
    #[error("{0}")]
    NotInTable(String),
    /// Parameters do not carry over to the strip asked for.
    #[error(transparent)]
    Scaling(#[from] ScalingError),
    /// A file holds no table that a profile could describe.
    #[error("{path}: {found}; needed a delimited text or a workbook with a table of numbers")]
    NoTable {
        /// The file.
        path: PathBuf,
        /// What stands there.
        found: String,
    },
    /// A file that drives or steers a strip cannot be read.
    #[error("{path}, {place}: found {found}, needed {needed}")]
    DriveFile {
        /// The file.
        path: PathBuf,
        /// Which line.
        place: String,
        /// What stands there.
        found: String,
        /// What is needed.
        needed: &'static str,
    },
    /// A value with a unit cannot be read.
    #[error("{what}: {error}")]
    Typed {
        /// Which value.
        what: &'static str,
        /// What was found and needed.
        error: crate::domain::typed_value::TypedValueError,
    },
    /// An argument of a verb makes no sense.
    #[error("{what}: found {found}, needed {needed}")]
    BadArgument {
        /// Which argument.
        what: &'static str,
        /// What was given.
        found: String,
        /// What may be given.
        needed: String,
    },
}

/// What is wrong where the system refuses a file: which one, and what was being done.
pub(crate) fn failed(path: &Path, doing: &'static str) -> impl Fn(io::Error) -> PipelineError + use<> {
    let path = path.to_owned();
    move |source| PipelineError::File {
        path: path.clone(),
        doing,
        source,
    }
}

impl PipelineError {
    /// An argument that cannot be: which, what was found, what was needed.
    pub(crate) fn bad_argument(
        what: &'static str,
        found: impl Into<String>,
        needed: impl Into<String>,
    ) -> PipelineError {
        PipelineError::BadArgument {
            what,
            found: found.into(),
            needed: needed.into(),
        }
    }

    /// Whether the system could not give a file, which says nothing of the file itself.
    pub fn is_of_system(&self) -> bool {
        use PipelineError as E;
        matches!(self, E::File { .. } | E::Frames(FramesError::Unreadable { .. }))
    }

    /// Whether another program works on the campaign.
    pub fn is_second_instance(&self) -> bool {
        matches!(self, PipelineError::Store(StoreError::SecondInstance { .. }))
    }

    /// Whether the campaign cannot be written now and may well be read: another program works on it, or there is no right to
    /// write.
    pub fn cannot_write(&self) -> bool {
        use std::io::ErrorKind::{PermissionDenied, ReadOnlyFilesystem};
        let no_right = |source: &io::Error| matches!(source.kind(), PermissionDenied | ReadOnlyFilesystem);
        match self {
            PipelineError::Store(StoreError::File { source, .. }) | PipelineError::File { source, .. } => {
                no_right(source)
            }
            PipelineError::Store(StoreError::ReadOnly { .. } | StoreError::CannotOpen { .. }) => true,
            PipelineError::Archive(ArchiveError::Denied { .. }) => true,
            other => other.is_second_instance(),
        }
    }

    /// Whether the disk or the database refused, rather than the user's input being wrong.
    pub fn is_storage(&self) -> bool {
        use PipelineError as E;
        match self {
            E::Store(_)
            | E::Holdings(_)
            | E::Archive(_)
            | E::File { .. }
            | E::NotOurs { .. }
            | E::Export(ExportError::Write { .. }) => true,
            // A link that leads out of the campaign, or a pipe, is what somebody put there.
            E::Campaign(CampaignFileError::Unreadable { source, .. })
            | E::Profile(ProfileError::Unreadable { source, .. })
            | E::Scan(ScanError::FolderUnreadable { source, .. }) => {
                source.kind() != std::io::ErrorKind::InvalidInput
            }
            E::Report(error) => error.is_of_disk(),
            E::Backup(error) => !error.is_usage(),
            _ => false,
        }
    }

    /// Whether that may pass by itself: space may be freed, a share may come back, a lock may be released. A database that
    /// is gone, foreign or damaged stays so until somebody mends it.
    pub fn may_pass(&self) -> bool {
        use PipelineError as E;
        match self {
            E::Store(error) => !error.is_for_good(),
            E::Holdings(_) => false,
            E::Scan(_) => true,
            other => other.is_storage(),
        }
    }

    /// Whether the program is at fault, and neither the user nor the disk.
    pub fn is_fault(&self) -> bool {
        use PipelineError as E;
        match self {
            E::Export(ExportError::Table { .. }) | E::Fault { .. } => true,
            E::Report(error) => !error.is_of_disk(),
            _ => false,
        }
    }
}
