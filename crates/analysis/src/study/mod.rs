//! What the study asked: what environment, humidity, voltage and material do to each parameter.
//!
//! One mixed model for each parameter of a material ([`ieap_numerics::mixed`]): a mean for each condition, samples and samples
//! in environments by chance, the errors of the fits known. A contrast, a law over the voltage, a ratio of ratios are
//! combinations of those means; the law over the humidity is a slope in the same model. What shows no difference is told how
//! large one could be. The same model asks at every time since the step whether whole curves differ (`whole_curves`). Chances are judged together over what the study asked, and over its details by themselves.

mod also;
mod answer;
mod asked;
mod asking;
mod combinations;
mod combined;
mod course;
mod curves;
mod environments;
mod evidence;
mod grammar;
mod kept;
mod laws;
mod leveled;
mod made;
mod measured;
mod measures;
mod odd;
mod pairs;
mod placed;
mod policy;
pub mod power;
mod said;
mod scoped;
mod screen;
mod slope;
pub mod view;
mod whole_curves;
mod words;

#[cfg(test)]
mod curves_tests;
#[cfg(test)]
mod grammar_tests;
#[cfg(test)]
mod kept_tests;
#[cfg(test)]
mod likely_tests;
#[cfg(test)]
mod other_laws_tests;
#[cfg(test)]
mod power_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod two_scopes_tests;

pub use answer::{Answer, Basis, Certainty, Drawn, InScope, Kind, Point, Scale, Scope, Verdict};
pub use course::{Course, courses};
pub use evidence::Evidence;
pub use grammar::UNTOLD;
pub(crate) use grammar::{factor, in_short};
pub use made::Study;
pub use odd::{OddValue, odd_in_short};
pub use said::{first_parameter, lead};
pub use screen::{Beside, first_screen};
pub use words::{about, sentence, symbol};
