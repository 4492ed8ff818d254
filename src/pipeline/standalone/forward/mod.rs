//! Fits used forward: what another strip, voltage or drive will do, and which drive makes a strip do something.

mod asked;
mod course_drive;
pub mod document;
pub mod drive_file;
mod figure;
pub(super) mod grounds;
mod misfit;
mod predict;
pub(super) mod source;
mod surroundings;

pub use crate::analysis::forecast::Forecast;
pub use asked::AskedStrip;
pub use course_drive::{DriveCourse, DriveDocument, ReachedRow, Wanted};
pub use document::{PredictedRow, PredictionDocument, Told};
pub use figure::{course_figure, prediction_figure};
pub use predict::Predict;
pub use source::fitted_covariance;
