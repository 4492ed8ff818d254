//! The verb `trace`: frames of a strip seen from its side to a run table, with a picture to check each frame by.

mod stream;
mod table;
mod view;

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::ingest::campaign_file;
use crate::ingest::frames::{self, FrameFile, FrameSettings};
use crate::pipeline::infra::own_folder::{self, Fresh};
use crate::pipeline::{Observer, PipelineError, failed};
use crate::system::fs;

pub use stream::{Source, Traced, trace_frames};
pub use view::{RefusedFrame, ViewSummary};

/// Name of the run table in the folder that is written.
pub const TABLE: &str = "curvature.csv";
/// Name of the table of standard errors at each position.
pub const ERRORS: &str = "standard_errors.csv";
/// Name of the folder of overlays.
pub const OVERLAYS: &str = "overlays";

/// What is to be traced.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceFrames {
    /// A folder of frames, or frames one by one.
    pub frames: Vec<PathBuf>,
    /// What the command line says of the view; it goes before `frames.toml`, that before campaign.toml.
    pub settings: FrameSettings,
    /// Folder to write; none: `<folder>.trace` in the current folder.
    pub output: Option<PathBuf>,
    /// Whether a picture is written for each frame.
    pub overlays: bool,
    /// Whether a folder that is there is replaced.
    pub overwrite: bool,
}

/// What was done.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct TraceSummary {
    /// Always `ieap/trace/1`.
    pub schema: &'static str,
    /// The run table.
    pub table: String,
    /// Standard errors of its curvatures, position by position.
    pub standard_errors: String,
    /// Folder of overlays; null where none were asked for.
    pub overlays: Option<String>,
    /// Frames looked at.
    pub frames: usize,
    /// Frames traced.
    pub traced: usize,
    /// Frames that could not be, each with its reason.
    pub refused: Vec<RefusedFrame>,
    /// The view as it was read.
    pub view: ViewSummary,
}

impl TraceFrames {
    /// Traces and writes; a folder that is half-written is never seen.
    ///
    /// # Errors
    /// There are no frames, scale or times; no frame of the initial shape can be traced; the folder is there already or
    /// cannot be written. A single frame that cannot be traced is listed in the summary.
    pub fn run(&self, observer: &dyn Observer) -> Result<TraceSummary, PipelineError> {
        let target = self.target()?;
        if target.exists() && !self.overwrite {
            return Err(PipelineError::FileExists { path: target });
        }
        let Described {
            files,
            settings,
            length_mm,
        } = described(&self.frames, &self.settings)?;
        let times_s = frames::times(&files, &settings)?;
        let parent = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        own_folder::check(&target, &is_of_earlier_version)?;
        let fresh = Fresh::begin(&parent, ".trace-").map_err(failed(&parent, "making a folder"))?;
        let overlays = fresh.path().join(OVERLAYS);
        if self.overlays {
            fs::create_dir(&overlays).map_err(failed(&overlays, "making a folder"))?;
        }
        let source = Source {
            files: &files,
            times_s: &times_s,
            settings: &settings,
            sample_length_mm: length_mm,
            overlays: self.overlays.then_some(overlays.as_path()),
        };
        let traced = trace_frames(&source, observer)?;
        for (name, text) in [(TABLE, &traced.table), (ERRORS, &traced.errors)] {
            let path = fresh.path().join(name);
            fs::write(&path, text).map_err(failed(&path, "writing the table"))?;
        }
        fresh
            .finish()
            .map_err(failed(fresh.path(), "listing what was written"))?;
        fresh.put(&target, &is_of_earlier_version)?;
        Ok(self.summary(&target, files.len(), traced))
    }

    fn summary(&self, target: &Path, frames: usize, traced: Traced) -> TraceSummary {
        let shown = |name: &str| target.join(name).display().to_string();
        TraceSummary {
            schema: "ieap/trace/1",
            table: shown(TABLE),
            standard_errors: shown(ERRORS),
            overlays: self.overlays.then(|| shown(OVERLAYS)),
            frames,
            traced: traced.rows,
            refused: traced.refused,
            view: traced.view,
        }
    }

    fn target(&self) -> Result<PathBuf, PipelineError> {
        if let Some(output) = &self.output {
            return Ok(output.clone());
        }
        let first = self
            .frames
            .first()
            .and_then(|first| std::path::absolute(first).ok());
        let stem = first.as_deref().and_then(|path| {
            if path.is_dir() {
                path.file_name()
            } else {
                path.file_stem()
            }
        });
        let stem = stem.ok_or_else(|| PipelineError::BadArgument {
            what: "FRAMES",
            found: "nothing".to_owned(),
            needed: "a folder of frames, or frames".to_owned(),
        })?;
        Ok(PathBuf::from(format!("{}.trace", stem.to_string_lossy())))
    }
}

/// Frames with what is stated of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Described {
    /// The frames in order.
    pub files: Vec<FrameFile>,
    /// The view.
    pub settings: FrameSettings,
    /// Length of the sample, mm, where the campaign has one sample only.
    pub length_mm: Option<f64>,
}

/// Lists a folder of frames, or frames one by one, with `told` before frames.toml beside them before campaign.toml.
///
/// # Errors
/// They cannot be listed, or a statement is wrong.
pub fn described(given: &[PathBuf], told: &FrameSettings) -> Result<Described, PipelineError> {
    let folder = match given {
        [one] if one.is_dir() => Some(one.as_path()),
        _ => None,
    };
    let files = match folder {
        Some(folder) => frames::list(folder)?,
        None => frames::of_paths(given)?,
    };
    let beside = folder.or_else(|| given.first().and_then(|first| first.parent()));
    let beside = beside.map(|beside| {
        if beside.as_os_str().is_empty() {
            Path::new(".")
        } else {
            beside
        }
    });
    let (mut base, mut length_mm) = (FrameSettings::default(), None);
    let campaign = beside.and_then(campaign_file::find);
    if let Some(campaign) = &campaign {
        let loaded = campaign_file::read(campaign)?;
        base = frames::of_campaign(&loaded.text)?;
        if let [sample] = &loaded.campaign.samples[..] {
            length_mm = sample.length_mm;
        }
    }
    if let Some(beside) = beside {
        base = frames::of_folder(campaign.as_deref().unwrap_or(beside), beside)?.over(base);
    }
    let told = told.clone().checked("the command line")?;
    Ok(Described {
        files,
        settings: told.over(base),
        length_mm,
    })
}

/// Whether a folder without a list of its files is one that an earlier version wrote: its names and no others.
fn is_of_earlier_version(folder: &Path) -> bool {
    let names = |folder: &Path| -> Option<Vec<PathBuf>> {
        let entries = fs::read_dir(folder).ok()?;
        entries.map(|entry| Some(entry.ok()?.path())).collect()
    };
    let is_overlay = |path: &PathBuf| path.is_file() && path.extension().is_some_and(|end| end == "png");
    let overlays_only = |folder: &Path| names(folder).is_some_and(|all| all.iter().all(is_overlay));
    let is_ours = |path: &PathBuf| {
        if path.is_dir() {
            path.ends_with(OVERLAYS) && overlays_only(path)
        } else {
            path.ends_with(TABLE) || path.ends_with(ERRORS)
        }
    };
    folder.join(TABLE).is_file() && names(folder).is_some_and(|all| all.iter().all(is_ours))
}
