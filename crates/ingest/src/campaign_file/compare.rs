//! What campaign.toml says of comparisons.

use super::check::Checker;
use super::error::CampaignFileError as Error;
use super::raw;
use ieap_domain::tag::keys;
use ieap_domain::{CompareRules, MaterialClass};

impl Checker<'_> {
    /// The rules; every tag of the reference must be one that a condition has.
    pub(super) fn compare(&self, raw: raw::Compare) -> Result<CompareRules, Error> {
        let mut reference = Vec::new();
        for (key, value) in raw.reference {
            let value = value.text();
            let is_known = match key.as_str() {
                keys::ENVIRONMENT => !value.trim().is_empty(),
                keys::RELATIVE_HUMIDITY_PERCENT | keys::VOLTAGE_V => {
                    value.parse::<f64>().is_ok_and(f64::is_finite)
                }
                _ => false,
            };
            if !is_known {
                return Err(Error::BadReference {
                    path: self.path.into(),
                    found: format!("{key} = {value}"),
                });
            }
            reference.push((key, value));
        }
        let by = match raw.by.as_deref() {
            None => None,
            Some(found) => Some(MaterialClass::from_key(found).ok_or_else(|| Error::BadClass {
                path: self.path.into(),
                found: found.to_owned(),
            })?),
        };
        Ok(CompareRules { reference, by })
    }
}
