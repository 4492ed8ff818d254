//! What campaign.toml says to be known of parameters before runs are fitted.

use toml::Spanned;

use super::check::Checker;
use super::error::CampaignFileError as Error;
use super::raw;
use ieap_domain::{Knowledge, KnownParameter, Sample};

impl Checker<'_> {
    /// The entries of `[[fit.known]]`; whether the model has such parameters is known when runs are fitted.
    pub(super) fn known(
        &self,
        entries: Vec<Spanned<raw::Known>>,
        samples: &[Sample],
    ) -> Result<Vec<KnownParameter>, Error> {
        let of = |entry: Spanned<raw::Known>| {
            let (line, _) = self.lines.place(entry.span().start);
            let place = format!("line {line}, [[fit.known]]");
            let entry = entry.into_inner();
            let parameter = self.filled(entry.parameter.clone(), &place, "parameter")?;
            let knowledge = knowledge(&entry).ok_or_else(|| Error::BadKnown {
                path: self.path.into(),
                place: place.clone(),
                found: stated(&entry),
            })?;
            if let Some(found) = &entry.sample
                && !samples.iter().any(|sample| sample.id == *found)
            {
                let known: Vec<&str> = samples.iter().map(|sample| sample.id.as_str()).collect();
                return Err(Error::UnknownSample {
                    path: self.path.into(),
                    place,
                    found: found.clone(),
                    known: known.join(", "),
                });
            }
            Ok(KnownParameter {
                parameter,
                knowledge,
                source: entry.source,
                sample: entry.sample,
            })
        };
        entries.into_iter().map(of).collect()
    }
}

fn knowledge(entry: &raw::Known) -> Option<Knowledge> {
    let found = match (entry.value, entry.standard_error, entry.low, entry.high) {
        (Some(value), None, None, None) => Knowledge::Exact { value },
        (Some(value), Some(standard_error), None, None) => Knowledge::About {
            value,
            standard_error,
        },
        (None, None, Some(low), Some(high)) => Knowledge::Within { low, high },
        _ => return None,
    };
    found.can_be().then_some(found)
}

/// The numbers of an entry, for an error.
fn stated(entry: &raw::Known) -> String {
    let numbers = [
        ("value", entry.value),
        ("standard_error", entry.standard_error),
        ("low", entry.low),
        ("high", entry.high),
    ];
    let said: Vec<String> = numbers
        .iter()
        .filter_map(|(key, number)| number.map(|number| format!("{key} = {number}")))
        .collect();
    if said.is_empty() {
        "no number".to_owned()
    } else {
        said.join(", ")
    }
}
