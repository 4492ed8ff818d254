//! The verbs as values: the command line, the watcher and the tests call the same ones.

mod climate;
mod context;
mod diagnose;
pub mod diagnosis_document;
mod error;
pub mod export;
mod fit;
mod fit_groups;
pub mod fits_document;
mod grouping;
pub mod groups_document;
mod ingest;
mod init;
pub mod inspect;
mod observer;
mod report;
mod run;
pub mod simulate;
pub mod status;
mod swap;
mod tag;
mod watch;

pub use crate::numerics::global::methods;
pub use climate::LogSummary;
pub use context::{CODE_VERSION, Context};
pub use diagnose::{DiagnoseChoice, DiagnoseRuns, DiagnoseSummary};
pub use error::PipelineError;
pub use fit::{FitChoice, FitRuns, FitSummary};
pub use fit_groups::{FitGroups, Sharing};
pub use ingest::{Ingest, IngestSummary};
pub use init::init;
pub use observer::{Observer, Silent};
pub use report::{REPORT_FOLDER, RenderReport, ReportSummary};
pub use run::{Run, RunSummary};
pub use tag::{SetTags, TagSummary};
pub use watch::{Watch, WatchSettings};
