//! Columns that a tag names: `storage_modulus_column = "E'/MPa"`.
//!
//! The columns of an instrument of which no file was ever seen are kept under their own names. Who has the
//! instrument knows what they are, and says so by a tag; nothing is guessed.

use std::sync::Arc;

use ieap_domain::tag::keys;
use ieap_domain::unit::conversion;
use ieap_domain::{Channel, Issue, Quantity, Tag};

/// The channels with those that a tag names made what the tag says, in its canonical unit, and what is wrong with
/// such tags. A tag that cannot be followed changes nothing.
pub fn named_columns(channels: &[Channel], tags: &[Tag]) -> (Vec<Channel>, Vec<Issue>) {
    let mut channels = channels.to_vec();
    let mut issues = Vec::new();
    for tag in tags {
        let quantity = tag.key.strip_suffix(keys::COLUMN).and_then(Quantity::from_key);
        if let Some(quantity) = quantity
            && let Err(issue) = name(&mut channels, tag, quantity)
        {
            issues.push(issue.at(&tag.key));
        }
    }
    (channels, issues)
}

fn name(channels: &mut [Channel], tag: &Tag, quantity: Quantity) -> Result<(), Issue> {
    let names: Vec<String> = channels.iter().map(|c| format!("\"{}\"", c.raw_name)).collect();
    let Some(at) = channels.iter().position(|c| c.raw_name == tag.value) else {
        let message = format!("there is no column \"{}\"", tag.value);
        let mend = format!("write one of {}", names.join(", "));
        return Err(Issue::warning("no-such-column", message).mend(mend));
    };
    if channels[at].quantity == quantity {
        return Ok(());
    }
    let convert = conversion(quantity, &channels[at].raw_unit).map_err(|error| {
        let mend = "export the column in one of these units, with the unit in its header";
        Issue::warning("column-refused", error.to_string()).mend(mend)
    })?;
    // What was read as the quantity before gives way.
    for other in channels.iter_mut().filter(|other| other.quantity == quantity) {
        other.quantity = Quantity::Other;
    }
    let channel = &mut channels[at];
    if channel.quantity == Quantity::Other {
        let values: Arc<[f64]> = channel.values.iter().map(|&v| convert.apply(v)).collect();
        channel.values = values;
    }
    channel.quantity = quantity;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::TagSource;

    fn column(name: &str, unit: &str, quantity: Quantity) -> Channel {
        Channel {
            raw_name: name.to_owned(),
            raw_unit: unit.to_owned(),
            ..Channel::new(quantity, Arc::from([0.0, 1.0]), Arc::from([2.0, 3.0]))
        }
    }

    fn tag(key: &str, value: &str) -> Tag {
        Tag {
            key: key.to_owned(),
            value: value.to_owned(),
            source: TagSource::Folder,
            detail: "dma/tags.toml".to_owned(),
        }
    }

    #[test]
    fn a_tag_says_what_a_column_is() {
        let columns = [
            column("E'/GPa", "GPa", Quantity::Other),
            column("tan(d)/-", "-", Quantity::Other),
        ];
        let tags = [
            tag("storage_modulus_column", "E'/GPa"),
            tag("loss_factor_column", "tan(d)/-"),
            tag("sample", "E'/GPa"),
        ];
        let (named, issues) = named_columns(&columns, &tags);
        assert_eq!(issues, []);
        assert_eq!(named[0].quantity, Quantity::StorageModulus);
        assert_eq!(&named[0].values[..], &[2000.0, 3000.0]);
        assert_eq!(
            (named[1].quantity, named[1].values[0]),
            (Quantity::LossFactor, 2.0)
        );
    }

    #[test]
    fn a_tag_that_cannot_be_followed_changes_nothing_and_says_why() {
        let columns = [column("dL/um", "um", Quantity::Other)];
        for (value, code) in [("dL/um", "column-refused"), ("E'", "no-such-column")] {
            let (named, issues) = named_columns(&columns, &[tag("storage_modulus_column", value)]);
            assert_eq!(named, columns);
            assert_eq!((issues.len(), issues[0].code.as_str()), (1, code), "{value}");
        }
    }
}
