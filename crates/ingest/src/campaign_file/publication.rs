//! `[publication]` of campaign.toml: what a data set says of itself when it leaves the laboratory.

use std::path::Path;

use serde::Deserialize;

use super::{CampaignFileError, line_and_column};

/// What is said of a published campaign.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Publication {
    /// Title; none: the campaign's.
    pub title: Option<String>,
    /// What the data are of, in a paragraph.
    pub description: Option<String>,
    /// Licence: an SPDX identifier, `CC-BY-4.0`, or its address.
    pub license: Option<String>,
    /// Digital object identifier, `10.5281/zenodo.1234567`.
    pub doi: Option<String>,
    /// Who publishes: an institute, a repository.
    pub publisher: Option<String>,
    /// Date of publication, `2026-11-20`.
    pub date: Option<String>,
    /// Subject words.
    #[serde(default)]
    pub keywords: Vec<String>,
    /// Who made the data, in order.
    #[serde(default)]
    pub author: Vec<Author>,
}

/// Who made the data.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Author {
    /// `Family, Given`.
    pub name: String,
    /// ORCID iD, `0000-0002-1825-0097`.
    pub orcid: Option<String>,
    /// Institute.
    pub affiliation: Option<String>,
}

#[derive(Deserialize)]
struct File {
    publication: Option<Publication>,
}

/// Reads `[publication]` of the text of a campaign.toml; none where it has none.
///
/// # Errors
/// A key is not known, a value is of another type, a date is no date, an ORCID iD has a slip: with place and remedy.
pub fn publication(text: &str, path: &Path) -> Result<Option<Publication>, CampaignFileError> {
    let wrong = |at: usize, found: String| {
        let (line, column) = line_and_column(text, at);
        CampaignFileError::WrongType {
            path: path.into(),
            line,
            column,
            found,
        }
    };
    let file: File = toml::from_str(text).map_err(|error| {
        wrong(
            error.span().map_or(0, |span| span.start),
            error.message().to_owned(),
        )
    })?;
    let Some(publication) = file.publication else {
        return Ok(None);
    };
    let place = |value: &str| text.find(value).unwrap_or(0);
    if let Some(date) = publication
        .date
        .as_deref()
        .filter(|date| date.parse::<jiff::civil::Date>().is_err())
    {
        return Err(wrong(
            place(date),
            format!("found {date:?}, needed a date such as \"2026-11-20\""),
        ));
    }
    for orcid in publication
        .author
        .iter()
        .filter_map(|author| author.orcid.as_deref())
    {
        if !is_orcid(orcid) {
            return Err(wrong(
                place(orcid),
                format!(
                    "found {orcid:?}, needed an ORCID iD such as \"0000-0002-1825-0097\"; its last character is a check digit"
                ),
            ));
        }
    }
    Ok(Some(publication))
}

/// Whether the text is an ORCID iD: four blocks of four digits, the last a check digit after ISO 7064, mod 11-2.
fn is_orcid(text: &str) -> bool {
    let blocks: Vec<&str> = text.split('-').collect();
    if blocks.len() != 4 || blocks.iter().any(|block| block.len() != 4) {
        return false;
    }
    let characters: Vec<char> = blocks.concat().chars().collect();
    let Some((last, digits)) = characters.split_last() else {
        return false;
    };
    let Some(sum) = digits
        .iter()
        .try_fold(0, |sum, c| Some((sum + c.to_digit(10)?) * 2))
    else {
        return false;
    };
    match (12 - sum % 11) % 11 {
        10 => *last == 'X',
        digit => last.to_digit(10) == Some(digit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
[publication]
license = "CC-BY-4.0"
date = "2026-11-20"
[[publication.author]]
name = "Carberry, Josiah"
orcid = "0000-0002-1825-0097"
"#;

    fn read(text: &str) -> Result<Option<Publication>, String> {
        publication(text, Path::new("campaign.toml")).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_stated_is_read_and_slips_are_told_with_their_place() {
        let read_well = read(TEXT).unwrap().unwrap();
        assert_eq!(read_well.author[0].name, "Carberry, Josiah");
        assert_eq!(read("[campaign]\nid = \"a\"\n"), Ok(None));
        for (from, to, told) in [
            ("0097", "0079", "line 7"),
            ("2026-11-20", "20.11.2026", "a date such as"),
            ("license", "licence", "unknown field"),
            ("orcid =", "orchid =", "unknown field"),
        ] {
            let refused = read(&TEXT.replace(from, to)).unwrap_err();
            assert!(refused.contains(told), "{to}: {refused}");
        }
    }

    #[test]
    fn check_digits_of_orcid() {
        assert!(is_orcid("0000-0002-1694-233X") && is_orcid("0000-0001-5109-3700"));
        assert!(
            !is_orcid("0000-0002-1694-2330")
                && !is_orcid("0000-0002-1694")
                && !is_orcid("abcd-efgh-ijkl-mnop")
        );
    }
}
