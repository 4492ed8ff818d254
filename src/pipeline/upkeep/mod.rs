//! What keeps a campaign true: tags and drops, agreement of its two stores, verification, rebuilding, backups, imports.

pub(super) mod agreement;
pub(super) mod answer;
pub mod backup;
pub(super) mod drop;
pub mod import_fits;
pub(super) mod opening;
pub(super) mod rebuild;
pub mod status;
pub(super) mod tag;
pub mod verify;
