//! From files to stored runs: measurements, climate logs, frames of a camera.

pub(super) mod climate;
pub(super) mod ingest;
pub mod trace;
