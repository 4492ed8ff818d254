//! Cause: which effects the readings ask for.
//!
//! In: the misfit beside the base model, a [`selection_input::SelectionInput`].
//! Out: a [`select::Selection`]: the extended model, its candidates and rivals, what it leaves; its [`proof`] on readings
//! that took no part in a fit; its [`evidence`], how probable the readings are under every hypothesis; what of it [`lead`]s;
//! and what is [`decide`]d.

pub(crate) mod between;
pub(crate) mod candidates;
pub(crate) mod decide;
pub(crate) mod evidence;
pub(crate) mod extended_start;
pub(crate) mod lead;
pub(crate) mod multistart;
pub(crate) mod policy;
pub(crate) mod proof;
pub(crate) mod remainder;
pub(crate) mod select;
pub(crate) mod selection_input;
