//! `ieap`: an environment-campaign database and report pipeline for ionic electroactive polymer actuators.
//!
//! A measurement goes one way: [`ingest`] (recognise, read, convert units, tag, archive) -> [`store`] ->
//! [`fit`] (parameters with uncertainty) -> [`analysis`] (comparison across conditions) -> [`report`].
//! [`pipeline`] holds the verbs, [`cli`] the command line; see ARCHITECTURE.md.

pub mod analysis;
pub mod cli;
pub mod diagnose;
pub mod domain;
pub mod fit;
pub mod ingest;
pub mod model;
pub mod numerics;
pub mod pipeline;
pub mod report;
pub mod store;
pub mod strip;
