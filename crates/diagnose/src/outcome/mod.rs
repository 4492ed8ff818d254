//! Outcome: what is told.
//!
//! In: misfit, selection and evidence of a group.
//! Out: an [`ieap_domain::GroupDiagnosis`]: verdict, sentence, effects with intervals, set, gain, next run; and what the
//! runs say each by itself ([`alone`]), or along the strip ([`lengthwise`]).

pub(crate) mod alone;
pub(crate) mod finding;
pub(crate) mod gain;
pub(crate) mod lengthwise;
pub(crate) mod next_run;
pub(crate) mod noise_words;
mod policy;
