//! Benchmark: what a diagnosis is held against.
//!
//! In: runs whose hidden effect is known.
//! Out: how strong it is in standard deviations ([`effect_size`]), what its right name would be worth ([`known_cause`]),
//! and what textbook criteria make of the same readings ([`textbook`]).

pub(crate) mod effect_size;
pub(crate) mod known_cause;
pub(crate) mod textbook;
