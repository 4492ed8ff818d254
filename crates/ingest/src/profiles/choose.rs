//! Which reader takes a file: a vendor's format, a saved profile, or the generic ones.

use schemars::JsonSchema;
use serde::Serialize;

use super::Profile;
use crate::Reading;
use crate::formats::recognition::{self, Candidate};
use crate::formats::unpacking;
use crate::formats::{FileHead, Format, ReadContext, ReadError};
use crate::profiles::policy::{FITS, GENERIC_BESIDE, OVER_VENDOR};

/// What reads a file.
#[derive(Clone, Copy)]
pub enum Reader<'p> {
    /// A format of the program.
    Format(&'static dyn Format),
    /// A saved profile.
    Profile(&'p Profile),
}

/// A format and how well it fits.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Claim {
    /// Format id, or `profile:ID`.
    #[serde(rename = "format")]
    pub id: String,
    /// How well it fits: 1 for a vendor's certain mark, 0.8 for a profile, 1.5 for one that goes before vendors.
    pub score: f64,
    /// What speaks for it.
    pub reason: String,
}

/// What reads a file, with everything that would, the best first.
#[derive(Clone)]
pub struct Choice<'p> {
    /// The reader.
    pub reader: Reader<'p>,
    /// Everything that would read it.
    pub claims: Vec<Claim>,
}

/// Chooses the reader of a file; `name` is its file name.
///
/// A profile that fits goes before the generic formats; before a vendor's format that recognises the file for certain
/// it goes only where it says `over_vendor = true`.
///
/// # Errors
/// As [`recognition::recognise`]; or several profiles fit.
pub fn choose<'p>(profiles: &'p [Profile], name: &str, bytes: &[u8]) -> Result<Choice<'p>, ReadError> {
    let head = FileHead::of(name, bytes);
    let fitting: Vec<&Profile> = if bytes.is_empty() {
        Vec::new()
    } else {
        profiles
            .iter()
            .filter(|profile| profile.fits(name, bytes).is_ok())
            .collect()
    };
    let highest = fitting.iter().map(|profile| score(profile)).fold(0.0, f64::max);
    let mut best = fitting.iter().filter(|profile| score(profile) == highest);
    let Some(profile) = best.next() else {
        let (format, candidates) = recognition::recognise(&head)?;
        return Ok(Choice {
            reader: Reader::Format(format),
            claims: candidates.iter().map(|c| claim(c, false)).collect(),
        });
    };
    if highest < OVER_VENDOR {
        crate::formats::sidecar::check(&head)?;
    }
    let candidates = recognition::candidates(&head);
    let mut claims: Vec<Claim> = fitting.iter().map(|profile| profile_claim(profile)).collect();
    claims.extend(candidates.iter().map(|c| claim(c, true)));
    claims.sort_by(|a, b| b.score.total_cmp(&a.score));
    let certain = candidates
        .iter()
        .find(|c| c.score >= 1.0 && !c.format.is_generic());
    match certain {
        Some(vendor) if highest < OVER_VENDOR => Ok(Choice {
            reader: Reader::Format(vendor.format),
            claims,
        }),
        _ if best.next().is_some() => Err(ReadError::AmbiguousFormat {
            candidates: fitting
                .iter()
                .map(|profile| format!("profile {}", profile.id))
                .collect::<Vec<_>>()
                .join(", "),
        }),
        _ => Ok(Choice {
            reader: Reader::Profile(profile),
            claims,
        }),
    }
}

/// Chooses the reader of a file and reads it; what gzip packed is unpacked first.
///
/// # Errors
/// As [`choose`], and as the reader.
pub fn read<'p>(
    profiles: &'p [Profile],
    name: &str,
    bytes: &[u8],
    context: &ReadContext,
) -> Result<(Reading, Option<&'p Profile>), ReadError> {
    let context = &context.within(bytes.len());
    let (name, bytes) = unpacking::of_gzip(name, bytes, context.max_unpacked_bytes)?;
    match choose(profiles, name, &bytes)?.reader {
        Reader::Format(format) => Ok((format.read(&bytes, context)?, None)),
        Reader::Profile(profile) => Ok((profile.read(&bytes, context)?, Some(profile))),
    }
}

fn score(profile: &Profile) -> f64 {
    if profile.over_vendor { OVER_VENDOR } else { FITS }
}

fn profile_claim(profile: &Profile) -> Claim {
    Claim {
        id: format!("profile:{}", profile.id),
        score: score(profile),
        reason: format!(
            "every column of profiles/{}.toml is there (version {})",
            profile.id, profile.version
        ),
    }
}

fn claim(candidate: &Candidate, beside_profile: bool) -> Claim {
    let lowered = beside_profile && candidate.format.is_generic();
    Claim {
        id: candidate.format.id().to_owned(),
        score: if lowered {
            candidate.score.min(GENERIC_BESIDE)
        } else {
            candidate.score
        },
        reason: candidate.reason.to_owned(),
    }
}
