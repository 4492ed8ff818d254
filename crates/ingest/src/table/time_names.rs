//! Names of columns of times: dates, times of day, elapsed times.

use crate::text::header::Header;
use crate::text::policy::LONGEST_NAME;
use ieap_domain::Quantity;

/// Words that columns of times have in their names, in the languages of laboratories, with semicolons between them.
const WORDS: &str = "time;zeit;date;datum;timestamp;epoch;unix;uts;elapsed;clock;aeg;kell;kellaaeg;kuupäev;temps;heure;horodatage;tiempo;\
    fecha;hora;tempo;data/ora;ora;duration;dauer;durée;время;дата;时间;日期;時間;日時;時刻";
/// Parts of words by which a time counts from the start of something and not from midnight.
const ELAPSED: &str = "elapsed;test;run;step;total;duration;lauf;mess;dauer;écoul;durée;transcurrid;trascors;decorrid;relativ;\
    since;経過;kulunud";

/// Whether a name in small letters is that of a time which counts from the start of something.
pub fn counts_from_a_start(lower: &str) -> bool {
    ELAPSED.split(';').any(|word| lower.contains(word))
}

/// Whether a name is that of a time, a date or both.
pub fn names_time(name: &str) -> bool {
    if name.len() > LONGEST_NAME {
        return false;
    }
    let lower = name.to_lowercase();
    // Words stand inside others (`temps` in `tempsensor`): only those count that German and English compose of them.
    let parts = || lower.split(|c: char| !c.is_alphanumeric());
    let has_word = |word: &str| match word {
        "time" | "zeit" | "date" | "datum" => {
            parts().any(|part| part.starts_with(word) || part.ends_with(word))
        }
        word if word.is_ascii() => parts().any(|part| part == word),
        word => lower.contains(word),
    };
    is_unit_of_time(name)
        || Header::parse(name).meaning.named_quantity() == Some(Quantity::Time)
        || WORDS.split(';').any(has_word)
}

/// Whether a column is headed by a unit of time alone: `s`, `min`. A letter in upper case stands for something else.
pub fn is_unit_of_time(name: &str) -> bool {
    matches!(name.trim(), "s" | "ms" | "us" | "min" | "h")
}
