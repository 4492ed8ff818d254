//! `ieap trace`.

use crate::domain::number::fixed;
use crate::domain::words::counted;
use std::path::PathBuf;

use clap::Args;

use super::exit::{CliError, DONE, SOME_REFUSED};
use super::output::Output;
use crate::ingest::frames::{FrameSettings, Numbers};
use crate::pipeline::intake::trace::{TraceFrames, TraceSummary};
use crate::strip::{Side, Tone};

/// Trace frames of a strip: curvature and tip
///
/// Writes a run table, its standard errors, and a picture of each frame with the traced line over it. What the view
/// is like stands in frames.toml beside the frames, in [frames] of campaign.toml, or in options here; docs/frames.md
/// says more.
#[derive(Debug, Args)]
pub struct TraceArgs {
    /// A folder of frames (PNG, JPEG, TIFF), or frames one by one
    #[arg(value_name = "FRAMES", required = true)]
    frames: Vec<PathBuf>,
    /// Folder to write [default: FRAMES.trace in the current folder]
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Scale, pixels to a millimetre
    #[arg(long, value_name = "N", conflicts_with = "length_mm")]
    px_per_mm: Option<f64>,
    /// Free length of the strip, mm, from which the scale follows
    #[arg(long, value_name = "MM")]
    length_mm: Option<f64>,
    /// Side at which the strip leaves the clamp: left, right, top or bottom [default: the only one that it reaches]
    #[arg(long, value_name = "SIDE", value_parser = side)]
    clamp: Option<Side>,
    /// Whether the strip is dark or bright [default: what the picture shows]
    #[arg(long, value_name = "TONE", value_parser = tone)]
    strip: Option<Tone>,
    /// Part of the picture that is looked at, pixels
    #[arg(
        long,
        value_name = "LEFT,TOP,WIDTH,HEIGHT",
        value_delimiter = ',',
        num_args = 4
    )]
    crop: Option<Vec<usize>>,
    /// Frames to a second
    #[arg(long, value_name = "N")]
    frames_per_second: Option<f64>,
    /// Time of the first frame after the voltage step, s
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    first_frame_s: Option<f64>,
    /// What numbers in names tell where some are left out: count (those frames are missing) or order [default: refused]
    #[arg(long, value_name = "WHAT", value_parser = numbers)]
    numbers: Option<Numbers>,
    /// Vectors of equal length into which the strip is cut [default: 20]
    #[arg(long, value_name = "N")]
    vectors: Option<usize>,
    /// Write no pictures
    #[arg(long)]
    no_overlays: bool,
    /// Replace a folder that is there
    #[arg(long)]
    overwrite: bool,
}

fn side(text: &str) -> Result<Side, String> {
    let found = Side::ALL.into_iter().find(|side| side.key() == text);
    found.ok_or_else(|| "needed left, right, top or bottom".to_owned())
}

fn tone(text: &str) -> Result<Tone, String> {
    let found = Tone::ALL.into_iter().find(|tone| tone.key() == text);
    found.ok_or_else(|| "needed dark or bright".to_owned())
}

fn numbers(text: &str) -> Result<Numbers, String> {
    let found = Numbers::ALL.into_iter().find(|numbers| numbers.key() == text);
    found.ok_or_else(|| "needed count or order".to_owned())
}

pub fn run(args: &TraceArgs, output: &Output) -> Result<u8, CliError> {
    let crop_px = args.crop.as_deref().and_then(|crop| crop.try_into().ok());
    let verb = TraceFrames {
        frames: args.frames.clone(),
        settings: FrameSettings {
            px_per_mm: args.px_per_mm,
            length_mm: args.length_mm,
            clamp: args.clamp,
            strip: args.strip,
            crop_px,
            frames_per_second: args.frames_per_second,
            first_frame_s: args.first_frame_s,
            numbers: args.numbers,
            vectors: args.vectors,
            ..FrameSettings::default()
        },
        output: args.output.clone(),
        overlays: !args.no_overlays,
        overwrite: args.overwrite,
    };
    let summary = verb.run(output)?;
    print(&summary, output);
    output.document(&summary)?;
    Ok(if summary.refused.is_empty() {
        DONE
    } else {
        SOME_REFUSED
    })
}

fn print(summary: &TraceSummary, output: &Output) {
    let view = &summary.view;
    output.result(&format!(
        "{} of {} traced: {} strip, clamp at the {}, {} mm long, {} mm thick",
        summary.traced,
        counted(summary.frames, "frame"),
        view.strip,
        view.clamp,
        fixed(view.length_mm, 2),
        fixed(view.thickness_mm, 3)
    ));
    output.result(&format!(
        "  scale {} px/mm ({}); bending counted from {}; edges known to {} px",
        fixed(view.px_per_mm, 3),
        view.scale_from,
        view.initial,
        fixed(view.edge_noise_px, 3)
    ));
    output.result(&format!("  table: {}", summary.table));
    if let Some(overlays) = &summary.overlays {
        output.result(&format!(
            "  look at the pictures before the table is used: {overlays}"
        ));
    }
    if !summary.refused.is_empty() {
        output.message(&format!("{} refused:", counted(summary.refused.len(), "frame")));
    }
    for refused in &summary.refused {
        output.message(&format!("  {}: {}", refused.frame, refused.reason));
    }
}
