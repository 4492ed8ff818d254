//! The verbs as values: the command line, the watcher and the tests call the same ones.
//!
//! Data go through its folders in this order, and each uses those before it: `infra`, `campaign`, `intake`, `fits`, `findings`,
//! `documents`, `standalone`, `show`, `upkeep`; then `run`, `watch` and `serve`.

pub mod campaign;
pub mod documents;
pub mod findings;
pub mod fits;
pub mod infra;
pub mod intake;
pub mod show;
pub mod standalone;
pub mod upkeep;

mod run;
pub mod serve;
mod watch;

pub use crate::analysis::models_compared::{ComparedCondition, ComparedModel};
pub use crate::diagnose::Draws;
pub use crate::numerics::global::methods;
pub use crate::numerics::interrupt::Interrupt;
pub use campaign::context::{BUILT_FROM, CODE_VERSION, Context};
pub(crate) use campaign::derived::left_words;
pub use campaign::places::REPORT_FOLDER;
pub use findings::adopt::{Adopt, AdoptSummary};
pub use findings::alarms::{AlarmSummary, RaiseAlarms, TakenBack};
pub use findings::compare::{CompareModels, CompareSummary, current_comparisons};
pub use findings::diagnose::{DiagnoseChoice, DiagnoseRuns, DiagnoseSummary, stands_in};
pub use findings::modulus::{AnalyseModulus, ModulusSummary};
pub use fits::choice::{ChosenBy, FitChoice, HeldChoice};
pub use fits::groups::{FitGroups, FitTogether, Sharing};
pub use fits::outcome::{FAULT, FitSummary};
pub use fits::runs::FitRuns;
pub use infra::allowed::AllowedCommands;
pub(crate) use infra::error::failed;
pub use infra::error::{HoldingsError, PipelineError};
pub use infra::observer::{Observer, Silent};
pub use intake::climate::LogSummary;
pub use intake::ingest::{Ingest, IngestSummary, UnreadableTags, files_due};
pub use run::{Made, Run, RunSummary};
pub use show::left::{Left, left};
pub use show::report::{RenderReport, ReportSummary, standing_report};
pub use standalone::init::{InitFrom, PlannedFile, Proposed, Seen, Taken, init};
pub use upkeep::answer::answer;
pub use upkeep::drop::{SpeakOfRuns, SpokenOf};
pub use upkeep::rebuild::{Rebuild, RebuildSummary};
pub use upkeep::tag::{SetTags, TagSummary};
pub use watch::{Intake, Look, Watch, WatchSettings, Watched};

pub use crate::analysis::zone::Zone;
pub use crate::store::Earlier;
