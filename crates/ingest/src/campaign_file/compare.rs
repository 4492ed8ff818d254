//! What campaign.toml says of comparisons.

use super::check::Checker;
use super::error::CampaignFileError as Error;
use super::raw;
use ieap_domain::{CompareRules, MaterialClass};

impl Checker<'_> {
    /// The rules.
    pub(super) fn compare(&self, raw: raw::Compare) -> Result<CompareRules, Error> {
        let by = match raw.by.as_deref() {
            None => None,
            Some(found) => Some(MaterialClass::from_key(found).ok_or_else(|| Error::BadClass {
                path: self.path.into(),
                found: found.to_owned(),
            })?),
        };
        Ok(CompareRules { by })
    }
}
