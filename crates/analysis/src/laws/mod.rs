//! What runs are compared by: what is known of each ([`facts`]), what of that may differ from run to run ([`covariate`]), the
//! values of a parameter on the scale on which they are compared ([`values`]), and which fits are in doubt ([`doubt`]).

pub mod covariate;
pub mod doubt;
pub mod facts;
pub mod policy;
pub mod values;
pub mod words;

pub use covariate::Covariate;
