//! Readings: what the runs of a group say.
//!
//! In: runs as they are given, channels with a drive.
//! Out: a [`group::RunGroup`], the readings of all runs as rows of one whitened vector, block by block, with their noise.
//! Spikes and outliers are left out here, and said; no model is fitted in this room.

pub(crate) mod charges;
pub(crate) mod course;
pub(crate) mod drawn;
pub(crate) mod group;
pub(crate) mod left_open;
pub(crate) mod louder;
pub(crate) mod outliers;
mod policy;
pub(crate) mod power_law;
pub(crate) mod quantities;
pub(crate) mod record_length;
pub(crate) mod scatter;
mod zeros;
