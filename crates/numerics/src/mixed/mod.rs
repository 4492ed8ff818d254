//! A linear mixed model by restricted maximum likelihood, with errors of readings that are known beside those that are not.
//!
//! `y = X b + Z u + e`: what is fixed, what differs by chance from block to block (a sample, a sample in an environment), and
//! from reading to reading. A reading's variance is what is known of it (the error of its fit) and what all of them share.
//! Errors of what is fixed are those of Kenward and Roger (Biometrics 53, 983, 1997), degrees of freedom those of
//! Satterthwaite, to which theirs come down for one number. Anchors: lme4, emmeans, pbkrtest and metafor of R
//! (docs/validation/study.md).

mod at;
mod block;
mod estimated;
mod model;
mod odd;
mod search;
#[cfg(test)]
mod tests;

pub use estimated::{Combined, Estimated};
pub use model::{MixedModel, Reading, Unit};
pub use odd::Odd;
