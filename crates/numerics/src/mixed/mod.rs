//! A linear mixed model whose scatters are integrated, with errors of readings that are known beside those that are not.
//!
//! `y = X b + Z u + e`: what is fixed, what differs by chance from block to block (a sample, a sample in an environment), and
//! from reading to reading. A reading's variance is what is known of it (the error of its fit) and what all of them share.
//! Standard deviations are uncertain, at nothing as well: they are tried on a lattice over which the restricted likelihood
//! times the densities before them (`before`) is summed. At each place what is fixed follows the normal law in closed form,
//! so that what is told of it is a mixture of normal laws, whose tails are interval and chance: there are no degrees of freedom.

mod before;
mod estimated;
mod integrated;
mod likely;
mod mixture;
mod model;
mod odd;
#[cfg(test)]
mod tests;

pub use estimated::Estimated;
pub use mixture::Mixture;
pub use model::{MixedModel, Reading, Unit, Width};
pub use odd::Odd;
