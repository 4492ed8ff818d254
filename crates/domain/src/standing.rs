//! Whether a run takes part in results, and if not, why.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::RunRecord;
use crate::safe_text::one_line;

/// What a person said of a whole run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunWord {
    /// The run's name.
    pub run_path: String,
    /// Whether it is taken out of all results; else it is put back.
    pub drops: bool,
    /// Why. A run that is put back with a reason was looked at and is right, whatever speaks against it; without one an
    /// earlier word is only taken back.
    pub why: Option<String>,
    /// Who said it.
    pub said_by: String,
    /// When, RFC 3339 UTC.
    pub said_at: String,
    /// Hash of the readings that it was said of.
    pub data_hash: String,
}

/// Two runs that hold the same readings.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SameReadings {
    /// Row id of the run whose readings stand in the other.
    pub run_id: i64,
    /// Row id of the other.
    pub in_run_id: i64,
    /// Whether the other holds nothing more.
    pub whole: bool,
}

/// Whether a run takes part in results.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum Standing {
    /// It does.
    #[default]
    Speaks,
    /// It does, on a person's word.
    Vouched(RunWord),
    /// A person took it out.
    Dropped(RunWord),
    /// Its readings are known to be wrong.
    Condemned {
        /// What is wrong, a sentence without its full stop.
        reason: String,
        /// How to mend it.
        mend: String,
    },
    /// What is stated of it contradicts itself in what results hang on, and nobody said yet what is right.
    Contradicted {
        /// Who says what, a sentence without its full stop.
        reason: String,
        /// How to answer.
        mend: String,
    },
    /// Another run holds the same readings and speaks for both.
    Copy {
        /// Name of the other run.
        of: String,
        /// Whether the other holds nothing more.
        whole: bool,
    },
}

impl Standing {
    /// Whether results may be made from it.
    pub fn speaks(&self) -> bool {
        matches!(self, Standing::Speaks | Standing::Vouched(_))
    }

    /// Whether a person said that it is right.
    pub fn is_vouched(&self) -> bool {
        matches!(self, Standing::Vouched(_))
    }

    /// Name for machines and counts.
    pub fn key(&self) -> &'static str {
        match self {
            Standing::Speaks => "speaks",
            Standing::Vouched(_) => "vouched",
            Standing::Dropped(_) => "dropped",
            Standing::Condemned { .. } => "condemned",
            Standing::Contradicted { .. } => "contradicted",
            Standing::Copy { .. } => "copy",
        }
    }

    /// Why it is as it is, a sentence without its full stop; nothing for a run that nobody said anything of.
    pub fn reason(&self) -> String {
        let said = |word: &RunWord, what: &str| {
            let day = word.said_at.split('T').next().unwrap_or_default();
            let why = one_line(word.why.as_deref().unwrap_or_default());
            format!("{why} ({what} by {}, {day})", one_line(&word.said_by))
        };
        match self {
            Standing::Speaks => String::new(),
            Standing::Vouched(word) => said(word, "looked at and found right"),
            Standing::Dropped(word) => said(word, "dropped"),
            Standing::Condemned { reason, .. } | Standing::Contradicted { reason, .. } => reason.clone(),
            Standing::Copy { of, whole: true } => format!("the same readings as {of}, which counts"),
            Standing::Copy { of, whole: false } => {
                format!("all its readings stand in {of} too, which counts")
            }
        }
    }

    /// How a run that does not speak comes to speak again; nothing for one that does.
    pub fn mend(&self, run: &str) -> String {
        let vouch = format!("ieap drop \"{run}\" --undo --why \"...\"");
        match self {
            Standing::Speaks | Standing::Vouched(_) => String::new(),
            Standing::Dropped(_) => format!("ieap drop \"{run}\" --undo takes that back"),
            Standing::Contradicted { mend, .. } => {
                format!("{mend}; if it is right as it is, say so: {vouch}")
            }
            Standing::Condemned { mend, .. } => {
                format!("{mend}; if you looked and it is right, say so: {vouch}")
            }
            Standing::Copy { .. } => {
                format!("remove one of the files; if it is a measurement of its own, say so: {vouch}")
            }
        }
    }
}

/// A run, or modulus log, that no result is made from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SetAside {
    /// Path relative to the campaign.
    pub run: String,
    /// `dropped` by a person, `condemned` for its readings, `contradicted` where what is stated of it is, or a `copy` of another
    /// run's.
    pub standing: &'static str,
    /// Why.
    pub reason: String,
    /// How it comes to speak again.
    pub mend: String,
}

impl SetAside {
    /// What is said of a run that does not speak.
    pub fn of(run: &RunRecord) -> SetAside {
        SetAside {
            run: run.path.clone(),
            standing: run.standing.key(),
            reason: run.standing.reason(),
            mend: run.standing.mend(&run.path),
        }
    }
}
