//! The database: all SQL stands here. One SQLite file a campaign, one writer, raw bytes beside it.
//!
//! [`Store::open`] takes the working instance's connection; [`Store::open_read_only`] serves `status` and the
//! like beside it. Every change goes through `Store::write`, one transaction a step, so nothing half-done
//! is ever visible.

mod blob;
mod checks;
mod climate;
mod columns;
mod content;
mod copy;
mod diagnoses;
mod error;
mod files;
mod fits;
mod hand_tag;
mod history;
mod in_place;
mod insert_run;
pub mod journal;
mod lists;
mod lock;
mod locks;
mod meanings;
mod measurement;
mod migration;
mod missing_files;
mod modulus;
mod moves;
mod new_run;
mod older;
mod place;
mod published_view;
mod read_files;
mod readings;
#[cfg(test)]
mod renamed_tests;
mod results;
mod rows;
mod run_changes;
mod runs;
mod schema;
#[cfg(test)]
mod schema_page_tests;
mod snapshot;
mod standing;
mod store;
mod table_by_table;
mod tag_sources;
#[cfg(test)]
mod testing;
mod transaction;
mod views;
mod whole_lists;
mod words;

pub use climate::{LogRecord, NewLog, NewSeries};
pub use content::Content;
pub use diagnoses::{Diagnosed, StoredDiagnosis};
use error::StepError;
pub use error::StoreError;
pub use files::FileRow;
pub use fits::{AskedOf, FitCurves, FitTask, StateOfRun};
pub use hand_tag::HandTag;
pub use history::Earlier;
pub use in_place::{Found, found, free_mark, put_in_place, set_aside};
pub use lock::{InstanceLock, host_name};
pub use meanings::{meaning, meanings};
pub use measurement::measurement;
pub use moves::{HeldFile, Moves};
pub use new_run::{Continues, NewRun, RunContent, Tagging};
pub use older::raw_files_named;
pub use place::FILE_NAME;
pub use published_view::PublishedRows;
pub use read_files::ReadFile;
pub use results::{NewResult, ResultDocument, ResultKind, ResultOrigin, StoredResult, Subject};
pub use snapshot::Snapshot;
pub use store::Store;
pub use table_by_table::{How, LEFT_OUT, RowDiffers};
pub use tag_sources::TagSources;
use transaction::Transaction;
pub use views::has_view;
