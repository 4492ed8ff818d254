//! `ieap`: an environment-campaign database and report pipeline for ionic electroactive polymer actuators.
//!
//! A measurement goes one way: [`ingest`] (recognise, read, convert units, tag, archive) -> [`store`] ->
//! [`fit`] (parameters with uncertainty) -> [`analysis`] (comparison across conditions) -> [`report`].
//! [`pipeline`] holds the verbs, [`cli`] the command line; see ARCHITECTURE.md.

pub mod cli;
pub mod pipeline;

pub use ieap_analysis as analysis;
pub use ieap_diagnose as diagnose;
pub use ieap_domain as domain;
pub use ieap_fit as fit;
pub use ieap_ingest as ingest;
pub use ieap_model as model;
pub use ieap_numerics as numerics;
pub use ieap_report as report;
pub use ieap_show as show;
pub use ieap_store as store;
pub use ieap_strip as strip;
pub use ieap_system as system;
pub use ieap_truth as truth;
