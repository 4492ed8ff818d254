//! Looks through the campaign folder: what lies there decides, events only say when to look.

mod display;
mod fingerprint;
mod found;
mod frame_folder;
mod names;
mod readiness;
mod stable_read;
#[cfg(all(test, unix))]
mod tests;
mod walk;
mod what_changed;

pub(crate) use fingerprint::{changed_ns, identity, modified_ns};

pub use display::{display_path, parse_display_path};
pub use found::{Scan, ScanError, ScanLimits, SeenFile};
pub use names::{StatesFor, compared, composed, is_own_product, is_passing_name, states_for};
pub use readiness::{Readiness, Sighting, readiness};
pub use stable_read::{DEFAULT_LIMIT_BYTES, ReadFileError, read_stable};
pub use walk::scan;
pub use what_changed::{Changes, Known, diff, is_another};
