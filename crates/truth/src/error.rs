//! Why a truth cannot be simulated.

use thiserror::Error;

use ieap_numerics::rosenbrock::Stuck;

/// What is wrong with a truth, and how to mend it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TruthError {
    /// No effect has that id.
    #[error("effect {found:?} is not known; known are {known}")]
    UnknownEffect {
        /// The id given.
        found: String,
        /// All ids.
        known: String,
    },
    /// The effect has no such variant.
    #[error("effect {id}: variant {found:?} is not known; known are {known}")]
    UnknownVariant {
        /// The effect.
        id: String,
        /// The variant given.
        found: String,
        /// All variants of the effect, or that it has none.
        known: String,
    },
    /// The effect has no such foreign form.
    #[error("effect {id}: form {found:?} is not known; known are {known}")]
    UnknownForm {
        /// The effect.
        id: String,
        /// The form given.
        found: String,
        /// All foreign forms of the effect, or that it has none.
        known: String,
    },
    /// The effect has no such parameter.
    #[error("effect {id}: parameter {found:?} is not known; known are {known}")]
    UnknownParameter {
        /// The effect.
        id: String,
        /// The key given.
        found: String,
        /// All keys of the effect.
        known: String,
    },
    /// A parameter is not given.
    #[error("effect {id}: parameter {key} is missing; it needs {needed}, such as {example}")]
    MissingParameter {
        /// The effect.
        id: String,
        /// The key.
        key: &'static str,
        /// Which numbers it may be.
        needed: String,
        /// A value that may stand there.
        example: f64,
    },
    /// A parameter or a property of the sample makes no sense.
    #[error("{place}: found {found}, needed {needed}")]
    BadValue {
        /// Which value.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        needed: String,
    },
    /// The effect stands twice.
    #[error("effect {id} is named twice for one run; name it once")]
    Twice {
        /// The effect.
        id: String,
    },
    /// The sample has no second branch.
    #[error("effect {id} acts on branch 2, and the sample has {found} branch; give it a second one")]
    NoSecondBranch {
        /// The effect.
        id: String,
        /// Branches of the sample.
        found: usize,
    },
    /// The effect needs the free length.
    #[error("effect {id} needs the free length of the sample; give length_cm")]
    NoLength {
        /// The effect.
        id: String,
    },
    /// The equations have no solution with these parameters.
    #[error("{stuck}. A smaller strength of an effect may mend it.")]
    Stuck {
        /// Where and why.
        stuck: Stuck,
    },
}

impl From<Stuck> for TruthError {
    fn from(stuck: Stuck) -> TruthError {
        TruthError::Stuck { stuck }
    }
}
