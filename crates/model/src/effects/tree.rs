//! Where an effect acts, and the mechanisms of which it is one.
//!
//! Members of one mechanism do the same to a strip in words that a reader would use, and mostly resemble one another in the
//! drives that laboratories use. What a diagnosis tells is the law and the variable of an effect, its `Place`.

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
}

const fn one(id: &'static str, site: Site, words: &'static str) -> Mechanism {
    Mechanism { id, site, words }
}

/// Every mechanism. Effects that follow a tag are in the last.
#[rustfmt::skip]
pub(super) static MECHANISMS: &[Mechanism] = &[
    one("current-time-scales", Site::Current, "the current relaxes over more than two time scales"),
    one("capacitance-by-voltage", Site::Current, "the capacitance depends on the voltage"),
    one("resistance-in-time", Site::Current, "the circuit changes in the course of a run"),
    one("resistance-by-state", Site::Current, "the resistance follows what the strip does"),
    one("leak", Site::Current, "a current flows that stores no charge"),
    one("source-or-contact", Site::Current, "the source or a contact is in the way"),
    one("current-reading", Site::Current, "the current begins or is read beside what flows"),
    one("bending-law", Site::Bending, "the bending is no straight line of the charge"),
    one("strain-relaxation", Site::Bending, "the strain relaxes otherwise than at one rate"),
    one("bending-by-itself", Site::Bending, "the strip bends by itself, or its stiffness changes"),
    one("bending-late", Site::Bending, "the bending comes late, or is read so"),
    one("from-run-to-run", Site::Runs, "a parameter differs from run to run"),
];

/// The mechanism of that id.
pub(super) fn mechanism(id: &str) -> Option<&'static Mechanism> {
    MECHANISMS.iter().find(|own| own.id == id)
}
