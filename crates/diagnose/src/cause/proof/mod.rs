//! Proof: readings that took no part in a fit, predicted by it.
//!
//! In: a fitted model and its group.
//! Out: parts that were held out in turn and how far each lies from its prediction; later times by earlier ones ([`later`]); whether a
//! law pays on them ([`by_size`]).

pub(crate) mod beyond_doubt;
pub(crate) mod block_error;
pub(crate) mod by_size;
pub(crate) mod doubt;
pub(crate) mod held_out;
pub(crate) mod later;
pub(crate) mod predictive;
