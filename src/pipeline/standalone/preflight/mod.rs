//! Pre-flight of a run: which parameters it would determine and how well, and what to change, before it is made.
//!
//! The judge is the program's own fit: the run is simulated several times with its noise, and every simulation is fitted
//! as the run itself would be. (`analysis::plan` is another thing: which runs a campaign lacks.)

mod asked;
mod changes;
mod document;
mod judged;
mod subject;
#[cfg(test)]
mod tests;
mod trial;
mod verb;
mod words;

pub use asked::{DRAWS, Preflight};
pub use document::{ChangeEntry, PlanDocument, PlannedParameter, Verdict};
pub use subject::Subject;
pub use trial::Trial;
pub use words::table;
