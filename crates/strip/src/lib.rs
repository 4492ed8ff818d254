//! The strip seen from its side: from a picture to its centre line and its curvature along it.
//!
//! Nothing here knows of files, campaigns or pages: bytes of a picture come in, geometry goes out. A strip is dark on
//! bright ground or the reverse, held at one side of the picture; it may turn through any angle. What cannot be traced
//! is refused with the reason ([`Untraceable`]).

mod believed;
mod bending;
mod curve;
mod decode;
mod edges;
mod first_curve;
mod gray;
mod ground;
mod march;
mod overlay;
mod refusal;
mod silhouette;
mod smooth;
mod spline;
mod steady;
mod thickness;
mod tip;
mod trace;
mod traced;
mod view;

pub use bending::{Bending, Initial, OtherLength, Positive, Reading, Scale};
pub use decode::{DecodeError, ENDINGS, decode, format};
pub use gray::{Crop, Gray};
pub use overlay::overlay;
pub use refusal::Untraceable;
pub use trace::trace;
pub use traced::Trace;
pub use view::{Side, Tone, View};

/// Version of what is traced: it rises where the same picture gives other numbers, so that folders are traced anew.
pub const VERSION: u32 = 2;
