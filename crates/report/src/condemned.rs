//! Which runs are condemned, and where they would have stood.

use super::input::Input;
use ieap_analysis::Conditions;
use ieap_analysis::laws::facts::{RunFacts, facts_beside};
use ieap_domain::{RunRecord, Standing};

/// A run that is condemned, and where it would have stood.
#[derive(Debug, Clone, PartialEq)]
pub struct Aside {
    /// Its number among all that have a page.
    pub run: usize,
    /// What is known of it; none without a sample.
    pub facts: Option<RunFacts>,
    /// Material, surroundings and voltage; none where no other run has them.
    pub condition: Option<(usize, usize, usize)>,
}

/// The condemned runs of `input`, whose other runs have those conditions and facts.
pub fn aside(input: &Input, conditions: &Conditions, facts: &[RunFacts]) -> Vec<Aside> {
    let is_condemned = |run: &RunRecord| matches!(run.standing, Standing::Condemned { .. });
    let runs = input.set_aside.iter().enumerate();
    let condemned = runs.filter(|(_, run)| is_condemned(run));
    let aside = condemned.map(|(place, run)| Aside {
        run: input.runs.len() + place,
        facts: facts_beside(run, &input.runs, facts, &input.campaign),
        condition: conditions.place_of(run, &input.campaign),
    });
    aside.collect()
}
