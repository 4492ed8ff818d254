//! A campaign at work: its folder, its database, and which of its runs speak.

pub(super) mod batch;
pub(super) mod context;
pub(super) mod derived;
pub(super) mod group_tags;
pub(super) mod grouping;
pub(super) mod holdings;
pub(super) mod places;
pub mod planned;
pub(super) mod readings;
pub mod standing;
