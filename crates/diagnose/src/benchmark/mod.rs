//! Benchmark: what a diagnosis is held against.
//!
//! In: runs whose hidden effect is known.
//! Out: how strong it is in standard deviations ([`effect_size`]).

pub(crate) mod effect_size;
