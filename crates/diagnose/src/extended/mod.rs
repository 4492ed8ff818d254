//! Extended models: what is asked of a group where the effects are given.
//!
//! In: runs, and effects that a person or other samples name.
//! Out: fits of the base model with them ([`fits`]), how much better they predict ([`from_others`]), and what they leave
//! ([`leftover`]).

pub(crate) mod fits;
pub(crate) mod from_others;
pub(crate) mod laws;
pub(crate) mod leftover;
mod policy;
