//! Options of every verb.

use std::path::PathBuf;

use clap::{Args, ColorChoice};

/// Options of every verb.
#[derive(Debug, Clone, Args)]
pub struct Global {
    /// Work as if started in that folder, as with git and make
    #[arg(short = 'C', global = true, value_name = "DIR")]
    pub work_in: Option<PathBuf>,
    /// Print one JSON document on stdout and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// Print what was asked for and errors, no messages; `run` prints errors only
    #[arg(long, short, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more on stderr: every file and run that was touched
    #[arg(long, short, global = true)]
    pub verbose: bool,
    /// Show no progress bars
    #[arg(long, global = true)]
    pub no_progress: bool,
    /// Colour what people read: auto (on a terminal, unless NO_COLOR is set), always or never
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        value_enum,
        hide_possible_values = true,
        default_value = "auto"
    )]
    pub color: ColorChoice,
    /// Work on N threads; results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<usize>,
    /// Seed of everything random, in place of the stated one
    #[arg(long, global = true, value_name = "N")]
    pub seed: Option<u64>,
    /// Keep the database on a network file system at your own risk
    #[arg(long, global = true)]
    pub i_know: bool,
}
