//! Cause: what may be behind a misfit, fitted and held out.
//!
//! In: the misfit beside the base model, a [`selection_input::SelectionInput`].
//! Out: equations of the library as [`candidates`], the promising ones fitted in full; the [`evidence`] of an equation, of
//! parameters that differ, and of what has no name; the [`proof`] of a model on readings that took no part in its fit; and what
//! it leaves ([`remainder`]).

pub(crate) mod candidates;
pub(crate) mod evidence;
pub(crate) mod extended_start;
pub(crate) mod policy;
pub(crate) mod proof;
pub(crate) mod remainder;
pub(crate) mod selection_input;
