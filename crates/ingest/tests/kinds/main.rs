//! Kinds of inputs that were once misread, each drawn at random from a seed: what is read is right, asked or said, and a share of
//! them is read. `IEAP_LONG=1` draws a thousand of each.

mod again;
mod codes;
mod columns;
mod dates;
#[allow(dead_code)]
#[path = "../../examples/random_tables/dice.rs"]
mod dice;
mod names;
mod pairs;
mod run;
mod sheets;
mod zones;

use dice::Dice;

/// What came of one input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Came {
    /// What is there was read.
    Right,
    /// Nothing was read, and it was said why.
    Asked,
    /// Something else was read, or something was left out without a word.
    Wrong,
}

/// Draws inputs of a kind and holds the shares: none wrong, and so many percent right.
pub fn count(kind: &str, percent_right: usize, draw: impl Fn(&mut Dice) -> (Came, String)) {
    count_of(60, kind, percent_right, draw);
}

/// The same for inputs that take longer: so many are drawn, and some times more in the long count.
pub fn count_of(inputs: usize, kind: &str, percent_right: usize, draw: impl Fn(&mut Dice) -> (Came, String)) {
    let inputs = match std::env::var_os("IEAP_LONG") {
        Some(_) => inputs * 1000 / 60,
        None => inputs,
    };
    let base = std::env::var("IEAP_SEED")
        .ok()
        .and_then(|seed| seed.parse().ok())
        .unwrap_or(88_000);
    let (mut right, mut asked, mut wrong) = (0, 0, Vec::new());
    for seed in 0..inputs {
        match draw(&mut Dice::of(base + seed as u64)) {
            (Came::Right, _) => right += 1,
            (Came::Asked, _) => asked += 1,
            (Came::Wrong, what) => wrong.push(format!("seed {}: {what}", base + seed as u64)),
        }
    }
    println!(
        "{kind}: {right} right, {asked} asked, {} wrong of {inputs}",
        wrong.len()
    );
    let shown = &wrong[..wrong.len().min(3)];
    assert!(
        wrong.is_empty(),
        "{kind}: {} of {inputs} wrong\n{}",
        wrong.len(),
        shown.join("\n\n")
    );
    assert!(
        100 * right >= percent_right * inputs,
        "{kind}: {right} of {inputs} right, {asked} asked"
    );
}
