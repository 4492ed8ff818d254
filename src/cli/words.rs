//! Words that stand for others, before the command line is read: `run --only STEP` is the verb of the step, with options of its
//! own; words of earlier versions, which no help shows, are those that took their place.

use std::convert::Infallible;
use std::ffi::OsString;

use clap::{Args, Command};

use super::global::Global;

/// The steps that `run --only` takes, in their order.
pub const STEPS: [&str; 6] = ["ingest", "fit", "dma", "impedance", "diagnose", "report"];

/// Words of earlier versions that scripts may still use, each with those that took its place.
const FORMER: [(&str, &[&str]); 7] = [
    ("next", &["plan"]),
    ("drive", &["predict"]),
    ("undrop", &["drop", "--undo"]),
    ("formats", &["list", "formats"]),
    ("models", &["list", "models"]),
    ("effects", &["list", "effects"]),
    ("schema", &["list", "schemas"]),
];

/// The command line with the words that are meant.
pub fn taken(mut words: Vec<OsString>) -> Vec<OsString> {
    let Some(verb) = verb(&words) else {
        return words;
    };
    let is_help = words[verb] == "help";
    let at = verb + usize::from(is_help);
    let word = words.get(at).and_then(|word| word.to_str());
    if let Some((_, now)) = FORMER.iter().find(|(former, _)| Some(*former) == word) {
        let meant = if is_help { &now[..1] } else { now };
        drop(words.splice(at..=at, meant.iter().map(OsString::from)));
    }
    if words[verb] != "run" {
        return words;
    }
    let end = words.iter().position(|word| word == "--").unwrap_or(words.len());
    let found = (verb + 1..end).find_map(|at| {
        let (step, count) = match words[at].to_str()?.strip_prefix("--only")? {
            "" => (words.get(at + 1)?.to_str()?, 2),
            joined => (joined.strip_prefix('=')?, 1),
        };
        let known = STEPS.into_iter().find(|known| *known == step)?;
        Some((known, at..at + count))
    });
    if let Some((step, place)) = found {
        words.drain(place);
        words[verb] = step.into();
    }
    words
}

/// Where the verb stands: behind the options of every verb.
fn verb(words: &[OsString]) -> Option<usize> {
    let program = Global::augment_args(Command::new("ieap"))
        .disable_help_subcommand(true)
        .allow_external_subcommands(true);
    let found = program.try_get_matches_from(words).ok()?;
    let (_, rest) = found.subcommand()?;
    let count = rest.get_many::<OsString>("").map_or(0, Iterator::count);
    words.len().checked_sub(count + 1)
}

/// A step is taken before the command line is read, so that none is ever read.
pub fn read(_: String) -> Result<Infallible, String> {
    Err("it stands where no step is taken".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_that_are_meant_wherever_they_stand() {
        let of = |line: &str| {
            let words = taken(line.split(' ').map(OsString::from).collect());
            words.join(" ".as_ref()).into_string().unwrap()
        };
        for (line, means) in [
            ("ieap run --only fit --again here", "ieap fit --again here"),
            ("ieap run here --only=fit --group", "ieap fit here --group"),
            (
                "ieap -C run --color never run --only fit",
                "ieap -C run --color never fit",
            ),
            ("ieap --json run run --only report", "ieap --json report run"),
            ("ieap run --only fit --help", "ieap fit --help"),
            (
                "ieap -C next undrop a --why b",
                "ieap -C next drop --undo a --why b",
            ),
            ("ieap help formats", "ieap help list"),
        ] {
            assert_eq!(of(line), means);
        }
        for same in [
            "ieap run",
            "ieap run --only",
            "ieap run --only table",
            "ieap run -- --only fit",
            "ieap -C run fit",
            "ieap",
        ] {
            assert_eq!(of(same), same);
        }
    }
}
