//! Where an effect acts, and which mechanism it is one of: the order of the list of effects.
//!
//! Members of one mechanism do the same to a strip in words that a reader would use, and mostly resemble one another in the
//! drives that laboratories use. What a diagnosis tells is the law and the variable of an effect, its `Place`.

use ieap_domain::diagnosis::follows_a_tag;

/// Where an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Site {
    /// In what the current does, or in how it is read.
    Current,
    /// In how the strip bends, or in how that is read.
    Bending,
    /// From run to run.
    Runs,
}

impl Site {
    /// Printed name.
    pub fn name(self) -> &'static str {
        match self {
            Site::Current => "current",
            Site::Bending => "bending",
            Site::Runs => "runs",
        }
    }

    /// What is so where no more is told, as a clause.
    pub fn words(self) -> &'static str {
        match self {
            Site::Current => "the current is another than simulated",
            Site::Bending => "the strip bends otherwise than simulated",
            Site::Runs => "the runs differ",
        }
    }
}

/// What several effects have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mechanism {
    /// Stored id, `current-time-scales`; never renamed.
    pub id: &'static str,
    /// Where it acts.
    pub site: Site,
    /// What happens, as a clause: "the current relaxes over more than two time scales".
    pub words: &'static str,
    /// Ids of its effects.
    pub effects: &'static [&'static str],
}

/// Every mechanism. An effect is in one of them; those that follow a tag are in the last.
pub static MECHANISMS: &[Mechanism] = &[
    Mechanism {
        id: "current-time-scales",
        site: Site::Current,
        words: "the current relaxes over more than two time scales",
        effects: &[
            "slow-branch",
            "fast-branch",
            "dispersion",
            "warburg",
            "constant-phase",
        ],
    },
    Mechanism {
        id: "capacitance-by-voltage",
        site: Site::Current,
        words: "the capacitance depends on the voltage",
        effects: &[
            "voltage-dependent-capacitance",
            "asymmetric-capacitance",
            "redox-peak",
            "polarity-memory",
        ],
    },
    Mechanism {
        id: "resistance-in-time",
        site: Site::Current,
        words: "the circuit changes in the course of a run",
        effects: &[
            "resistance-drift",
            "water-exchange",
            "ambient-temperature",
            "electrolytic-drying",
            "contact-break",
            "parameter-wander",
        ],
    },
    Mechanism {
        id: "resistance-by-state",
        site: Site::Current,
        words: "the resistance follows what the strip does",
        effects: &[
            "joule-heating",
            "piezoresistive-electrode",
            "water-redistribution",
        ],
    },
    Mechanism {
        id: "leak",
        site: Site::Current,
        words: "a current flows that stores no charge",
        effects: &["faradaic-leak", "diffusion-limited-leak", "self-discharge"],
    },
    Mechanism {
        id: "source-or-contact",
        site: Site::Current,
        words: "the source or a contact is in the way",
        effects: &[
            "current-limit",
            "series-resistance",
            "source-rise",
            "lengthwise-resistance",
        ],
    },
    Mechanism {
        id: "current-reading",
        site: Site::Current,
        words: "the current begins or is read beside what flows",
        effects: &["current-offset", "current-event", "residual-charge"],
    },
    Mechanism {
        id: "bending-law",
        site: Site::Bending,
        words: "the bending is no straight line of the charge",
        effects: &[
            "coupling-saturation",
            "softening",
            "tip-formula",
            "noncircular-shape",
            "curvature-limit",
            "quadratic-coupling",
            "polarity-coupling",
            "even-bending",
            "sensing-feedback",
        ],
    },
    Mechanism {
        id: "strain-relaxation",
        site: Site::Bending,
        words: "the strain relaxes otherwise than at one rate",
        effects: &[
            "partial-relaxation",
            "second-relaxation",
            "fractional-relaxation",
            "counter-flow",
            "leak-coupling",
            "unequal-coupling",
            "threshold-relaxation",
        ],
    },
    Mechanism {
        id: "bending-by-itself",
        site: Site::Bending,
        words: "the strip bends by itself, or its stiffness changes",
        effects: &[
            "moisture-bending",
            "creep",
            "precurvature",
            "camera-zero",
            "bending-event",
            "modulus-drift",
        ],
    },
    Mechanism {
        id: "bending-late",
        site: Site::Bending,
        words: "the bending comes late, or is read so",
        effects: &[
            "camera-delay",
            "mechanical-lag",
            "exposure-smoothing",
            "resonance",
            "friction",
            "clock-rate",
        ],
    },
    Mechanism {
        id: "from-run-to-run",
        site: Site::Runs,
        words: "a parameter differs from run to run",
        effects: &[],
    },
];

/// The mechanism of that id.
pub fn mechanism(id: &str) -> Option<&'static Mechanism> {
    MECHANISMS.iter().find(|own| own.id == id)
}

/// The mechanism that an effect is one of; none of an unknown id.
pub fn mechanism_of(effect: &str) -> Option<&'static Mechanism> {
    if follows_a_tag(effect) {
        mechanism("from-run-to-run")
    } else {
        MECHANISMS.iter().find(|own| own.effects.contains(&effect))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::ALL;

    #[test]
    fn every_effect_has_one_place_in_the_tree_and_nothing_else_has() {
        for effect in ALL {
            let id = effect.about().id;
            let places = MECHANISMS.iter().filter(|own| own.effects.contains(&id));
            assert_eq!(places.count(), 1, "{id}");
        }
        let members: usize = MECHANISMS.iter().map(|own| own.effects.len()).sum();
        assert_eq!(members, ALL.len());
        assert_eq!(
            mechanism_of("follows:batch").map(|own| own.site),
            Some(Site::Runs)
        );
        assert_eq!(mechanism_of("no-such-effect"), None);
    }
}
