//! Folders of frames: which files are frames, in what order, at what times, and how the view is to be read.

mod error;
mod listing;
mod settings;
mod times;

pub use error::FramesError;
pub use listing::{FrameFile, list, of_paths};
pub use settings::{FILE_NAME, FrameSettings, InitialShape, Numbers, of_campaign, of_folder};
pub use times::times;
