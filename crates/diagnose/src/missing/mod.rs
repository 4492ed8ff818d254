//! The missing law: which part of the model is a function of what, before it has a name.
//!
//! In: the misfit beside the base model. Every law of the model is asked as a smooth function of every variable, beside the
//! equations of the library, each of which is one curve of such a function; and whether runs merely differ.
//! Out: [`look::Found`]: the verdict, the account of the error, and for every law that pays by itself the deepest of place, law
//! and variable, name that the readings tell.

pub(crate) mod account;
mod columns;
mod drawn;
mod evidence;
pub(crate) mod look;
pub(crate) mod policy;
mod posterior;
mod simple;
mod told;
mod unnamed;
pub(crate) mod weighed;
