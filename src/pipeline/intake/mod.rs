//! From files to stored runs: measurements, climate logs, frames of a camera.

pub(super) mod climate;
pub mod files;
pub(super) mod ingest;
pub mod trace;
