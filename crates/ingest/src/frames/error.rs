//! Why a folder of frames cannot be read.

use std::path::PathBuf;

use thiserror::Error;

use super::settings::FILE_NAME;

/// Why a folder of frames cannot be read.
#[derive(Debug, Error)]
pub enum FramesError {
    /// A file or folder cannot be read.
    #[error("{}: cannot be read ({source})", path.display())]
    Unreadable {
        /// Which.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// There is no frame.
    #[error("{}: no PNG, JPEG or TIFF in the folder", path.display())]
    NoFrames {
        /// The folder.
        path: PathBuf,
    },
    /// The settings are wrong.
    #[error("{place}: {found}. {mend}")]
    Settings {
        /// File and line, or option.
        place: String,
        /// What is wrong.
        found: String,
        /// What to do.
        mend: String,
    },
    /// When the frames were taken is said nowhere.
    #[error(
        "{first}: when the frames were taken is said nowhere. State `frames_per_second` (and `first_frame_s`, the first frame's time after the voltage step) or `times_s` in {FILE_NAME}, or name the frames by their time, as in frame_012.5s.png"
    )]
    NoTimes {
        /// The first frame.
        first: String,
    },
    /// Numbers of frames are left out.
    #[error(
        "{before} and {after}: the numbers between them are left out. Say `numbers = \"count\"` in {FILE_NAME} where {} missing, or `numbers = \"order\"` where those that are there follow one another at `frames_per_second`",
        counted(*missing)
    )]
    Gap {
        /// The frame before the first gap.
        before: String,
        /// The frame behind it.
        after: String,
        /// Numbers left out, in steps of the others.
        missing: u64,
    },
    /// The times do not fit the frames.
    #[error("{place}: {found}, needed {needed}")]
    Times {
        /// Where they are stated.
        place: String,
        /// What is there.
        found: String,
        /// What is needed.
        needed: String,
    },
}

fn counted(missing: u64) -> String {
    match missing {
        1 => "1 frame is".to_owned(),
        many => format!("{many} frames are"),
    }
}
