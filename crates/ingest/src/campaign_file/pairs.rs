//! What campaign.toml says of runs in two files.

use toml::Spanned;

use super::check::Checker;
use super::error::CampaignFileError as Error;
use super::raw;
use crate::name_pattern::NamePattern;
use ieap_domain::pairs::{PairNames, PairRules, PairedBy};

impl Checker<'_> {
    /// How files of one run find each other.
    pub(super) fn pairs(
        &self,
        by: Option<Vec<String>>,
        rules: Vec<Spanned<raw::Pair>>,
    ) -> Result<PairRules, Error> {
        let usual = PairRules::default();
        let way = |found: &String| {
            let known = PairedBy::from_key(found).filter(|way| usual.by.contains(way));
            known.ok_or_else(|| Error::BadPair {
                path: self.path.into(),
                place: "[runs] pair_by".to_owned(),
                reason: format!("\"{found}\" is none of names, times"),
            })
        };
        let stated = by.map(|by| by.iter().map(way).collect::<Result<Vec<_>, _>>());
        Ok(PairRules {
            by: stated.transpose()?.unwrap_or(usual.by),
            named: rules
                .into_iter()
                .map(|rule| self.pair(rule))
                .collect::<Result<_, _>>()?,
        })
    }

    fn pair(&self, rule: Spanned<raw::Pair>) -> Result<PairNames, Error> {
        let (line, _) = self.lines.place(rule.span().start);
        let place = format!("line {line}, [[pair]]");
        let rule = rule.into_inner();
        let names = PairNames {
            current: self.filled(rule.current, &place, "current")?,
            bending: self.filled(rule.bending, &place, "bending")?,
        };
        let bad = |reason: String| Error::BadPair {
            path: self.path.into(),
            place: place.clone(),
            reason,
        };
        if !(names.current.contains('{') || names.bending.contains('{')) {
            return Ok(names);
        }
        let keys = |text: &str| {
            let pattern = NamePattern::compile(text).map_err(|error| bad(error.to_string()))?;
            Ok::<_, Error>(pattern.keys().map(str::to_owned).collect::<Vec<_>>())
        };
        let (of_current, of_bending) = (keys(&names.current)?, keys(&names.bending)?);
        if of_current.iter().any(|key| of_bending.contains(key)) {
            Ok(names)
        } else {
            let reason =
                "the two names share no word in braces, such as {run}: nothing says which belong together";
            Err(bad(reason.to_owned()))
        }
    }
}
