//! Saved profiles, `profiles/*.toml` of a campaign: how the delimited texts and workbooks of one source are read
//! where their own headers do not say it. See docs/profiles.md.

mod check;
mod check_time;
mod choose;
mod definition;
mod error;
mod glob;
mod guess;
mod load;
mod policy;
mod propose;
mod raw;
mod refused;
#[cfg(test)]
mod tests;

pub use choose::{Choice, Claim, Reader, choose, read};
pub use definition::Profile;
pub use error::ProfileError;
pub use load::{FOLDER, from_text, is_id, load};
pub use propose::{Proposal, StatedColumn, answered, propose};
pub use refused::{Profiles, RefusedProfile};
