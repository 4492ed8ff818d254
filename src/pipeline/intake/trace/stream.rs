//! Frames one after another: a few in memory at a time, whatever their number, and the same table at any number of
//! threads.

use crate::numerics::robust::upper_median;
use std::path::Path;

use rayon::prelude::*;

use super::table::{Row, Tables};
use super::{RefusedFrame, ViewSummary};
use crate::ingest::frames::{FrameFile, FrameSettings, InitialShape};
use crate::ingest::scan::{ReadFileError, read_stable};
use crate::numerics::interrupt;
use crate::pipeline::{Observer, PipelineError, failed};
use crate::strip::{Gray, Initial, Positive, Scale, Trace, View, decode, overlay, trace};
use crate::system::fs;

/// Largest file of a frame, bytes.
const LARGEST_FRAME_BYTES: u64 = 512 << 20;
/// Frames before the step whose mean is the initial shape, at most.
const MOST_INITIAL: usize = 20;
/// Vectors into which a strip is cut where nothing else is said.
pub const VECTORS: usize = 20;

/// Frames with what is known of them.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// The frames in order.
    pub files: &'a [FrameFile],
    /// When each was taken, s after the voltage step.
    pub times_s: &'a [f64],
    /// What is stated of the view.
    pub settings: &'a FrameSettings,
    /// Free length of the sample, which gives the scale where the settings do not.
    pub sample_length_mm: Option<f64>,
    /// Folder into which a picture of each frame is written.
    pub overlays: Option<&'a Path>,
}

/// What the frames gave.
#[derive(Debug, Clone, PartialEq)]
pub struct Traced {
    /// The run table.
    pub table: String,
    /// Standard errors of the curvatures at each position.
    pub errors: String,
    /// Frames in the table.
    pub rows: usize,
    /// Frames that are not.
    pub refused: Vec<RefusedFrame>,
    /// What holds for all.
    pub view: ViewSummary,
}

/// Traces all frames.
///
/// # Errors
/// There is no scale, no frame of the initial shape can be traced, or an overlay cannot be written.
pub fn trace_frames(source: &Source, observer: &dyn Observer) -> Result<Traced, PipelineError> {
    let (initial, mut view, size_px) = initial(source)?;
    let mut tables = Tables::new(&initial, &view, source.files.len());
    let mut refused = Vec::new();
    let (mut noise, mut rows) = (Vec::with_capacity(source.files.len()), 0);
    let few = 4 * rayon::current_num_threads().max(1);
    let indices: Vec<usize> = (0..source.files.len()).collect();
    observer.begin("tracing", source.files.len() as u64);
    for chunk in indices.chunks(few) {
        interrupt::check();
        let traced: Vec<Result<Row, Failed>> = chunk
            .par_iter()
            .map(|&index| {
                let row = frame(source, index, &initial, size_px);
                observer.advance();
                row
            })
            .collect();
        for (&index, row) in chunk.iter().zip(traced) {
            match row {
                Ok(row) => {
                    noise.push(row.edge_noise_px);
                    tables.add(&row);
                    rows += 1;
                }
                Err(Failed::Frame(reason)) => refused.push(RefusedFrame {
                    frame: source.files[index].name.clone(),
                    reason,
                }),
                Err(Failed::Disk(error)) => {
                    observer.end();
                    return Err(error);
                }
            }
        }
    }
    observer.end();
    view.edge_noise_px = upper_median(&mut noise).unwrap_or(0.0);
    let (table, errors) = tables.finished(&refused);
    Ok(Traced {
        table,
        errors,
        rows,
        refused,
        view,
    })
}

/// Why there is no row of a frame.
enum Failed {
    /// The frame cannot be traced.
    Frame(String),
    /// The frame cannot be had from the system, or what was traced cannot be written.
    Disk(PipelineError),
}

/// The picture of a frame, with the hash of its file.
fn picture(file: &FrameFile) -> Result<(Gray, String), Failed> {
    let bytes = read_stable(&file.path, LARGEST_FRAME_BYTES).map_err(|error| match error {
        ReadFileError::Denied { path, source } | ReadFileError::Failed { path, source } => {
            Failed::Disk(failed(&path, "reading the frame")(source))
        }
        // The name stands beside it already.
        error => Failed::Frame(
            error
                .to_string()
                .replace(&format!("{}: ", file.path.display()), ""),
        ),
    })?;
    let gray = decode(&bytes).map_err(|error| Failed::Frame(error.to_string()))?;
    Ok((gray, blake3::hash(&bytes).to_hex().to_string()))
}

fn view_of(settings: &FrameSettings) -> View {
    View {
        crop: settings.crop(),
        clamp: settings.clamp,
        tone: settings.strip,
    }
}

fn frame(source: &Source, index: usize, initial: &Initial, size_px: (usize, usize)) -> Result<Row, Failed> {
    let file = &source.files[index];
    let (gray, hash) = picture(file)?;
    if (gray.width(), gray.height()) != size_px {
        return Err(Failed::Frame(format!(
            "{} x {} pixels, and the initial shape is from {} x {}: its scale and the place of its clamp may be others. Trace frames of one size together",
            gray.width(),
            gray.height(),
            size_px.0,
            size_px.1
        )));
    }
    let traced = trace(&gray, &view_of(source.settings)).map_err(|error| Failed::Frame(error.to_string()))?;
    let bending = initial
        .bending(&traced)
        .map_err(|error| Failed::Frame(error.to_string()))?;
    if let Some(folder) = source.overlays {
        let name = format!(
            "{}.png",
            file.name.rsplit_once('.').map_or(&*file.name, |parts| parts.0)
        );
        let path = folder.join(name);
        let drawn = overlay(&gray, &traced, vectors(source.settings)).map_err(Failed::Frame)?;
        fs::write(&path, drawn).map_err(|error| Failed::Disk(failed(&path, "writing the overlay")(error)))?;
    }
    Ok(Row {
        frame: file.name.clone(),
        hash,
        time_s: source.times_s[index],
        edge_noise_px: traced.edge_noise_px,
        bending,
    })
}

fn vectors(settings: &FrameSettings) -> usize {
    settings.vectors.unwrap_or(VECTORS)
}

/// A trace with columns and rows of its picture, or why there is none.
type SizedTrace = Result<(Trace, (usize, usize)), Failed>;

/// The initial shape with the scale, what is said of the view, and columns and rows of its pictures: those of the first.
fn initial(source: &Source) -> Result<(Initial, ViewSummary, (usize, usize)), PipelineError> {
    let settings = source.settings;
    let (shape, indices) = initial_frames(source);
    let traces: Vec<SizedTrace> = indices
        .par_iter()
        .map(|&index| {
            let (gray, _) = picture(&source.files[index])?;
            let size_px = (gray.width(), gray.height());
            let traced =
                trace(&gray, &view_of(settings)).map_err(|error| Failed::Frame(error.to_string()))?;
            Ok((traced, size_px))
        })
        .collect();
    let mut refusal = None;
    let mut good = Vec::new();
    let mut size_px = None;
    for (traced, &index) in traces.into_iter().zip(&indices) {
        match traced {
            Ok((traced, size)) if size == *size_px.get_or_insert(size) => good.push(traced),
            // Refused with its reason where its turn comes.
            Ok(_) => {}
            Err(Failed::Frame(reason)) => {
                refusal = refusal.or(Some((source.files[index].name.clone(), reason)));
            }
            Err(Failed::Disk(error)) => return Err(error),
        }
    }
    let (scale, scale_from) = scale(source)?;
    let positive = settings.positive.unwrap_or_default();
    let found = match (shape, good.first()) {
        (InitialShape::Straight, Some(first)) => Initial::straight(first, scale, vectors(settings), positive),
        _ => Initial::of(&good, scale, vectors(settings), positive),
    };
    let (Some(initial), Some(first)) = (found, good.first()) else {
        let (frame, reason) = refusal.unwrap_or_default();
        return Err(PipelineError::NoInitialShape { frame, reason });
    };
    let view = summary(
        &initial,
        first,
        scale_from,
        positive,
        shape_words(source, shape, good.len()),
    );
    Ok((initial, view, size_px.unwrap_or_default()))
}

fn summary(
    initial: &Initial,
    first: &Trace,
    scale_from: String,
    positive: Positive,
    shape: String,
) -> ViewSummary {
    ViewSummary {
        clamp: first.clamp.key(),
        strip: first.tone.key(),
        px_per_mm: initial.px_per_mm,
        scale_from,
        length_mm: initial.length_mm,
        thickness_mm: first.width_px() / initial.px_per_mm,
        positive: positive.key(),
        initial: shape,
        positions_mm: initial.joints_mm.clone(),
        edge_noise_px: 0.0,
    }
}

/// Which frames give the initial shape. A picture by itself has none but the straight strip.
fn initial_frames(source: &Source) -> (InitialShape, Vec<usize>) {
    let count = source.files.len();
    let shape = source.settings.initial.unwrap_or(match count {
        1 => InitialShape::Straight,
        _ => InitialShape::BeforeStep,
    });
    let before = source.times_s.partition_point(|&t| t <= 0.0);
    let indices = match shape {
        InitialShape::BeforeStep if before > 0 => (before.saturating_sub(MOST_INITIAL)..before).collect(),
        _ => vec![0],
    };
    (shape, indices)
}

fn shape_words(source: &Source, shape: InitialShape, frames: usize) -> String {
    let first_s = source.times_s.first().copied().unwrap_or(0.0);
    match shape {
        InitialShape::Straight => "a straight strip".to_owned(),
        InitialShape::BeforeStep if first_s <= 0.0 => {
            let frames = if frames == 1 {
                "the frame".to_owned()
            } else {
                format!("the mean of {frames} frames")
            };
            format!("{frames} up to 0 s")
        }
        _ => format!("the first frame, at {first_s} s"),
    }
}

/// Scale and where it comes from.
fn scale(source: &Source) -> Result<(Scale, String), PipelineError> {
    let settings = source.settings;
    match (settings.px_per_mm, settings.length_mm, source.sample_length_mm) {
        (Some(px_per_mm), _, _) => Ok((Scale::PixelsPerMm(px_per_mm), "stated".to_owned())),
        (None, Some(mm), _) => Ok((
            Scale::LengthMm(mm),
            format!("the strip is said to be {mm} mm long"),
        )),
        (None, None, Some(mm)) => Ok((Scale::LengthMm(mm), format!("the sample is {mm} mm long"))),
        _ => Err(PipelineError::NoScale),
    }
}
