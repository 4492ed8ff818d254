//! Checksums of what is stored: written with every change, looked at whenever rows are read.
//!
//! SQLite notices a damaged page only where its structure breaks; a flipped bit in a number reads as another number. So
//! every set of rows that is read together (a [`Subject`]) has a seal: a checksum over all of its values as SQLite gives
//! them, in order, so that a row that is missing, moved or changed is noticed. A change opens the seal (after a look at
//! it) and closes it again in the same transaction. Seals are of a schema: the migration
//! that makes it seals everything, and whoever finds none later has a damaged database.

mod checks;
mod seals;
mod subject;
#[cfg(test)]
mod tests;

pub(super) use seals::{Seal, Seals, add_row, close, finished, seal_all};
pub(super) use subject::Subject;
