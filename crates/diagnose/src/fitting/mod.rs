//! Fitting: a model at its minimum.
//!
//! In: a group, the base model, and effects that are added to it.
//! Out: a [`fitted::Fitted`], where its minimum lies and what it leaves, with its [`tangent::Tangent`]: what a refit absorbs.
//! Profiles of a fitted effect's parameters are followed from there; nothing here asks whether a model is right.

pub(crate) mod base_fit;
pub(crate) mod edges;
pub(crate) mod ends;
pub(crate) mod fitted;
pub(crate) mod modes;
pub(crate) mod own_limits;
pub(crate) mod policy;
pub(crate) mod problem;
pub(crate) mod profile;
pub(crate) mod scale;
pub(crate) mod tangent;
pub(crate) mod without_outliers;
