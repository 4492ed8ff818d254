//! Where each run stands on a covariate that parameters are shown against.

use std::collections::BTreeMap;

use crate::conditions::{compared_material, nominal_voltage_v};
use crate::laws::covariate::Covariate;
use crate::laws::facts::{Known, RunFacts, start_s};
use ieap_domain::tag::keys;
use ieap_domain::{Campaign, RunRecord};

/// What parameters are shown against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Against {
    /// Relative humidity, percent.
    Humidity,
    /// Nominal step voltage, V.
    Voltage,
    /// Environment.
    Environment,
    /// Material of the sample.
    Material,
    /// Sample.
    Sample,
    /// Start of the run, s since 1970 UTC.
    Time,
}

/// Where the runs stand.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// Names in the order in which they stand; empty for numbers.
    pub names: Vec<String>,
    /// Of each run the number with its standard error, or the index of its name; none where it is not stated.
    pub of_run: Vec<Option<Known>>,
}

impl Against {
    /// Every one, in the order of the pages.
    pub const ALL: [Against; 6] = [
        Against::Humidity,
        Against::Voltage,
        Against::Environment,
        Against::Material,
        Against::Sample,
        Against::Time,
    ];

    /// Places of `runs`; none where fewer than two differ. `facts` hold what is known of the climate of runs.
    pub fn places(self, runs: &[RunRecord], campaign: &Campaign, facts: &[RunFacts]) -> Option<Places> {
        let named = runs.iter().filter_map(|run| self.name_of(run, campaign));
        let mut names: Vec<String> = named.map(str::to_owned).collect();
        names.sort();
        names.dedup();
        let stated = self.stated(campaign);
        let rank = |name: &String| stated.iter().position(|known| known == name);
        names.sort_by_key(|name| rank(name).unwrap_or(usize::MAX));
        let facts: BTreeMap<usize, &RunFacts> = facts.iter().map(|fact| (fact.run, fact)).collect();
        let mut places = Places {
            names,
            of_run: Vec::new(),
        };
        let place = |(at, run)| self.place_of(run, campaign, facts.get(&at).copied(), &places);
        places.of_run = runs.iter().enumerate().map(place).collect();
        let mut known = places.of_run.iter().flatten().map(|known| known.value);
        let first = known.next()?;
        known.any(|value| value != first).then_some(places)
    }

    /// Where a run that is not among those of `places` would stand; `facts` is what is known of it. None where it states
    /// nothing, or a name that none of them has.
    pub fn place_of(
        self,
        run: &RunRecord,
        campaign: &Campaign,
        facts: Option<&RunFacts>,
        places: &Places,
    ) -> Option<Known> {
        match self {
            Against::Humidity => facts?.numbers.get(&Covariate::RelativeHumidity).copied(),
            Against::Voltage => nominal_voltage_v(run).map(exact),
            Against::Time => start_s(run).map(exact),
            Against::Environment | Against::Material | Against::Sample => {
                let name = self.name_of(run, campaign)?;
                let at = places.names.iter().position(|known| known == name)?;
                Some(exact(at as f64))
            }
        }
    }

    /// Environment, material or sample; none of numbers.
    fn name_of<'a>(self, run: &'a RunRecord, campaign: &'a Campaign) -> Option<&'a str> {
        match self {
            Against::Environment => run.tag(keys::ENVIRONMENT),
            Against::Material => compared_material(run, campaign),
            Against::Sample => run.tag(keys::SAMPLE),
            Against::Humidity | Against::Voltage | Against::Time => None,
        }
    }

    /// Names in the order of campaign.toml.
    fn stated(self, campaign: &Campaign) -> Vec<&str> {
        match self {
            Against::Environment => campaign
                .environments
                .iter()
                .map(|known| known.id.as_str())
                .collect(),
            Against::Material => campaign
                .materials
                .iter()
                .map(|known| known.id.as_str())
                .chain(campaign.samples.iter().map(|sample| sample.material.as_str()))
                .map(|own| campaign.compared_as(own))
                .collect(),
            _ => campaign.samples.iter().map(|known| known.id.as_str()).collect(),
        }
    }
}

fn exact(value: f64) -> Known {
    Known {
        value,
        standard_error: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::facts::facts;
    use ieap_domain::testing::{campaign, run};

    #[test]
    fn runs_stand_by_number_and_by_name_and_what_does_not_differ_is_not_shown() {
        let campaign = campaign();
        let runs = [
            run("a", "CPvf-01", "air", Some(34.0), 2.0),
            run("b", "CNaf-01", "vacuum", None, 2.0),
        ];
        let facts = facts(&runs, &campaign);
        let places = |against: Against| against.places(&runs, &campaign, &facts);
        // One stated humidity is nothing to compare.
        assert_eq!(places(Against::Humidity), None);
        assert_eq!(places(Against::Voltage), None);
        let environments = places(Against::Environment).unwrap();
        assert_eq!(environments.names, ["vacuum", "air"]);
        assert_eq!(environments.of_run[0].unwrap().value, 1.0);
        assert_eq!(places(Against::Material).unwrap().names, ["CNaf", "CPvf"]);
    }
}
