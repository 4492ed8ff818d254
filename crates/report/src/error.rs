//! Why a report could not be written.

use std::io;
use std::path::PathBuf;

use ieap_analysis::ExportError;

/// Why a report could not be written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file or folder of the site could not be written.
    #[error("cannot write {path}: {source}; check that the folder exists, may be written and has room")]
    Write {
        /// What was to be written.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The curves of a run could not be had.
    #[error("cannot draw run {run}: {reason}")]
    Curves {
        /// Path of the run.
        run: String,
        /// What the source of the curves says.
        reason: String,
    },
    /// A template does not fit its context: a fault of the program.
    #[error("page {page}: {source}")]
    Template {
        /// The page.
        page: String,
        /// What tera says.
        source: Box<tera::Error>,
    },
    /// A page's context cannot be serialised: a fault of the program.
    #[error("page {page}: {source}")]
    Context {
        /// The page.
        page: String,
        /// What serde says.
        source: serde_json::Error,
    },
    /// A figure could not be drawn: a fault of the program.
    #[error("figure {figure}: {reason}")]
    Figure {
        /// The figure's id.
        figure: String,
        /// What the drawing library says.
        reason: String,
    },
    /// A page or a part of it panicked: a fault of the program.
    #[error("{0}")]
    Fault(String),
    /// A table beside the pages could not be written.
    #[error(transparent)]
    Table(#[from] ExportError),
}

impl ReportError {
    /// Of a figure that could not be drawn, from the reason.
    pub fn of_figure(figure: &str) -> impl FnOnce(String) -> ReportError {
        move |reason| ReportError::Figure {
            figure: figure.to_owned(),
            reason,
        }
    }

    /// Whether the disk refused; every other is a fault of the program.
    pub fn is_of_disk(&self) -> bool {
        matches!(
            self,
            ReportError::Write { .. } | ReportError::Table(ExportError::Write { .. })
        )
    }
}
