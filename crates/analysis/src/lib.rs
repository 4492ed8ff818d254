//! Comparison across conditions, and the climate of runs.

pub mod climate;
pub mod comparison;
pub mod conditions;
pub mod design;
mod disk_file;
pub mod dma;
pub mod export;
pub mod false_discovery;
pub mod findings;
pub mod forecast;
pub mod frequency;
pub mod groups;
pub mod impedance;
pub mod json_rows;
pub mod laws;
pub mod misread;
pub mod models_compared;
pub mod monitoring;
pub mod one_fit;
pub mod online;
pub mod parameters;
mod parquet_file;
pub mod plain_columns;
pub mod plan;
pub mod pooling;
pub mod probe;
pub mod run_rows;
pub mod run_tables;
pub mod same_tags;
#[doc(hidden)]
pub mod sample_campaign;
pub mod sequence;
pub mod shared_effects;
pub mod standing;
pub mod stiffness;
pub mod tables;
pub mod traces;

pub use conditions::{Condition, Conditions, HumidityLevel, Surroundings, conditions};
pub use design::confounding;
pub use export::{ExportError, TableFormat, conditions_table, fits_long, fits_wide, rounded, write_table};
pub use findings::{Contrast, contrasts};
pub use parameters::{PARAMETERS, ParameterInfo};
pub use parquet_file::About;
pub use traces::TraceWriter;
