//! What campaign.toml says of the study.

use super::check::Checker;
use super::error::CampaignFileError as Error;
use super::raw;
use ieap_domain::{Factor, StudyRules};

impl Checker<'_> {
    /// What the study asks.
    pub(super) fn study(&self, raw: raw::Study) -> Result<StudyRules, Error> {
        let compare = self.factors("compare", &raw.compare, &Factor::ALL)?;
        let holds = |key, stated: Option<Vec<String>>, factor: Factor| match stated {
            None => Ok(true),
            Some(stated) => Ok(!self.factors(key, &stated, &[factor])?.is_empty()),
        };
        Ok(StudyRules {
            compare,
            materials_together: !holds("within", raw.within, Factor::Material)?,
            voltages_together: !holds("at_equal", raw.at_equal, Factor::Voltage)?,
            scatter_percent: self.above_zero(raw.scatter_percent, "[study]", "scatter_percent")?,
            alike_percent: self.above_zero(raw.alike_percent, "[study]", "alike_percent")?,
        })
    }

    fn factors(&self, key: &'static str, stated: &[String], known: &[Factor]) -> Result<Vec<Factor>, Error> {
        let of = |found: &String| {
            let factor = Factor::from_key(found).filter(|factor| known.contains(factor));
            factor.ok_or_else(|| Error::BadFactor {
                path: self.path.into(),
                key,
                found: found.clone(),
                needed: known
                    .iter()
                    .map(|factor| factor.key())
                    .collect::<Vec<_>>()
                    .join(", "),
            })
        };
        stated.iter().map(of).collect()
    }
}
