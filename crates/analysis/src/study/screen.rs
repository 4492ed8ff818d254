//! What the overview says of a campaign first: the largest answers of each material, those of other parts among them.

use super::made::Study;
use super::policy::{FIRST_SCREEN_WORDS, MOST_OF_MATERIAL};
use super::said::{Before, Sentence, ranked};

/// What another part of the program found of the campaign, in sentences.
#[derive(Debug, Clone, PartialEq)]
pub struct Beside {
    /// Its size as the logarithm of a ratio, times how sure it is: answers of the study are ranked so.
    pub rank: f64,
    /// What is said.
    pub text: String,
}

/// The first screen: a paragraph a material and one of what was found beside, the largest change first, in no more words than
/// can be read at a glance.
pub fn first_screen(study: &Study, beside: Option<&Beside>) -> Vec<String> {
    let mut all: Vec<Vec<Sentence>> = study
        .materials()
        .into_iter()
        .map(|of| ranked(study, of))
        .collect();
    all.retain(|own| !own.is_empty());
    all.sort_by(|a, b| a[0].before(&b[0]));
    let place = beside.map(|own| all.iter().filter(|of| of[0].is_before(own.rank)).count());
    let mut told = None;
    let mut taken: Vec<Vec<Sentence>> = all.iter().map(|_| Vec::new()).collect();
    let fits = |taken: &[Vec<Sentence>], told: Option<&Beside>| {
        let beside = told.map_or(0, |own| words_of(&own.text));
        words_of(&paragraphs(taken).join(" ")) + beside <= FIRST_SCREEN_WORDS
    };
    // In turn, so that no material keeps the others out: what each says first, the rest of that sentence, then the next.
    for turn in 0..2 * MOST_OF_MATERIAL {
        for at in 0..=all.len() {
            if turn == 0 && place == Some(at) {
                told = beside.filter(|own| fits(&taken, Some(own)));
            }
            let Some(whole) = all.get(at).and_then(|own| own.get(turn / 2)) else {
                continue;
            };
            let before = taken[at].clone();
            taken[at].truncate(turn / 2);
            if taken[at].len() < turn / 2 {
                continue;
            }
            taken[at].push(if turn % 2 == 0 {
                whole.first_alone()
            } else {
                whole.clone()
            });
            if !fits(&taken, told) {
                taken[at] = before;
            }
        }
    }
    let mut said = paragraphs(&taken);
    if let (Some(own), Some(place)) = (told, place) {
        let above = taken[..place].iter().filter(|own| !own.is_empty()).count();
        said.insert(above, own.text.clone());
    }
    said
}

/// A paragraph of each that has a sentence.
fn paragraphs(all: &[Vec<Sentence>]) -> Vec<String> {
    let mut before = Before::default();
    let said = all.iter().map(|own| {
        let said: Vec<String> = own.iter().map(|own| own.said(&mut before)).collect();
        said.join(" ")
    });
    said.filter(|own| !own.is_empty()).collect()
}

/// How many words a text has; a sign by itself is none.
fn words_of(text: &str) -> usize {
    let is_word = |own: &&str| own.chars().any(char::is_alphanumeric);
    text.split_whitespace().filter(is_word).count()
}
