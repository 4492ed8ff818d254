//! What every verb stands on: errors, faults of the program, files that appear whole, commands of users.

pub mod allowed;
pub(super) mod command;
pub(super) mod error;
pub(super) mod fault;
pub mod mends;
pub(super) mod observer;
pub(super) mod own_folder;
pub mod whole_file;
