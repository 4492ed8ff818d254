//! How a view is to be read: `frames.toml` in the folder of frames, else `[frames]` of campaign.toml.

use std::path::Path;

use serde::Deserialize;

use super::FramesError;
use ieap_strip::{Crop, Positive, Side, Tone};
use ieap_system::fs;

/// The file in a folder of frames that says how they are to be read.
pub const FILE_NAME: &str = "frames.toml";

/// From which shape bending is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InitialShape {
    /// The mean of the last frames up to time zero, or the first frame where there are none.
    BeforeStep,
    /// The first frame.
    First,
    /// A straight strip: curvature is that of the shape itself.
    Straight,
}

/// What the numbers in the names of frames tell where some are left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Numbers {
    /// They count frames: those left out were taken, and are missing.
    Count,
    /// Their order only: the frames there are follow one another.
    Order,
}

impl Numbers {
    /// Both.
    pub const ALL: [Numbers; 2] = [Numbers::Count, Numbers::Order];

    /// As it is written in settings.
    pub fn key(self) -> &'static str {
        match self {
            Numbers::Count => "count",
            Numbers::Order => "order",
        }
    }
}

/// What is stated of a view; all of it may be left out.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameSettings {
    /// Scale, pixels to a millimetre.
    pub px_per_mm: Option<f64>,
    /// Free length of the strip, mm, from which the scale follows.
    pub length_mm: Option<f64>,
    /// The side of the crop at which the strip leaves the clamp.
    pub clamp: Option<Side>,
    /// Whether the strip is dark or bright.
    pub strip: Option<Tone>,
    /// The part of the picture that is looked at: left, top, width, height.
    pub crop_px: Option<[usize; 4]>,
    /// Which turn counts as positive.
    pub positive: Option<Positive>,
    /// From which shape bending is counted.
    pub initial: Option<InitialShape>,
    /// Number of vectors of equal length into which the strip is cut.
    pub vectors: Option<usize>,
    /// Frames to a second.
    pub frames_per_second: Option<f64>,
    /// Time of the first frame after the voltage step, s.
    pub first_frame_s: Option<f64>,
    /// What numbers in names tell where some are left out.
    pub numbers: Option<Numbers>,
    /// Time of each frame after the voltage step, s.
    pub times_s: Option<Vec<f64>>,
}

impl FrameSettings {
    /// These settings where they say something, else those of `base`.
    pub fn over(self, base: FrameSettings) -> FrameSettings {
        // A scale of one kind replaces one of the other, and so does a source of times.
        let scaled = self.px_per_mm.is_some() || self.length_mm.is_some();
        let timed = self.frames_per_second.is_some() || self.times_s.is_some();
        FrameSettings {
            px_per_mm: if scaled { self.px_per_mm } else { base.px_per_mm },
            length_mm: if scaled { self.length_mm } else { base.length_mm },
            clamp: self.clamp.or(base.clamp),
            strip: self.strip.or(base.strip),
            crop_px: self.crop_px.or(base.crop_px),
            positive: self.positive.or(base.positive),
            initial: self.initial.or(base.initial),
            vectors: self.vectors.or(base.vectors),
            frames_per_second: if timed {
                self.frames_per_second
            } else {
                base.frames_per_second
            },
            first_frame_s: self.first_frame_s.or(base.first_frame_s),
            numbers: self.numbers.or(base.numbers),
            times_s: if timed { self.times_s } else { base.times_s },
        }
    }

    /// The crop as a rectangle.
    pub fn crop(&self) -> Option<Crop> {
        let [left, top, width, height] = self.crop_px?;
        Some(Crop {
            left,
            top,
            width,
            height,
        })
    }

    /// Checks what types cannot; `place` says where the settings stand.
    ///
    /// # Errors
    /// A number that cannot be.
    pub fn checked(self, place: &str) -> Result<FrameSettings, FramesError> {
        let above_zero = [
            ("px_per_mm", self.px_per_mm),
            ("length_mm", self.length_mm),
            ("frames_per_second", self.frames_per_second),
        ];
        let wrong = |found: String, mend: &str| {
            Err(FramesError::Settings {
                place: place.to_owned(),
                found,
                mend: mend.to_owned(),
            })
        };
        for (key, value) in above_zero {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return wrong(format!("`{key}` is {value}"), "It is a number above zero.");
            }
        }
        if self.px_per_mm.is_some() && self.length_mm.is_some() {
            return wrong(
                "both `px_per_mm` and `length_mm` are given".to_owned(),
                "The scale follows from either: state one.",
            );
        }
        if let Some(vectors) = self.vectors.filter(|v| !(4..=200).contains(v)) {
            return wrong(format!("`vectors` is {vectors}"), "It is a number from 4 to 200.");
        }
        if self.first_frame_s.is_some_and(|t| !t.is_finite()) {
            return wrong(
                "`first_frame_s` is no number".to_owned(),
                "It is a time in seconds.",
            );
        }
        Ok(self)
    }
}

/// What `frames.toml` in a folder, which lies in that campaign or is it, says; nothing where there is none.
///
/// # Errors
/// It cannot be read, is no TOML, or states what cannot be.
pub fn of_folder(campaign: &Path, folder: &Path) -> Result<FrameSettings, FramesError> {
    let path = folder.join(FILE_NAME);
    let text = match fs::read_stated_text(campaign, &path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(FrameSettings::default()),
        Err(source) => return Err(FramesError::Unreadable { path, source }),
    };
    let settings = toml::from_str::<FrameSettings>(&text).map_err(|error| wrong(FILE_NAME, &text, &error))?;
    settings.checked(FILE_NAME)
}

/// What `[frames]` of campaign.toml says; nothing where there is none.
///
/// # Errors
/// It states what cannot be.
pub fn of_campaign(text: &str) -> Result<FrameSettings, FramesError> {
    #[derive(Deserialize)]
    struct File {
        frames: Option<FrameSettings>,
    }
    let file =
        toml::from_str::<File>(text).map_err(|error| wrong("campaign.toml, [frames]", text, &error))?;
    file.frames.unwrap_or_default().checked("campaign.toml, [frames]")
}

fn wrong(place: &str, text: &str, error: &toml::de::Error) -> FramesError {
    let line = error
        .span()
        .map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1);
    FramesError::Settings {
        place: match line {
            Some(line) => format!("{place}, line {line}"),
            None => place.to_owned(),
        },
        found: error.message().replace('\n', ", "),
        mend: "docs/frames.md lists the keys.".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_speaks_before_the_campaign() {
        let base = of_campaign(
            "[campaign]\nid = \"x\"\n[frames]\npx_per_mm = 20.0\nclamp = \"left\"\nframes_per_second = 2.0\n",
        )
        .unwrap();
        let folder: FrameSettings =
            toml::from_str("length_mm = 45\nstrip = \"dark\"\ntimes_s = [0, 1]").unwrap();
        let both = folder.over(base);
        assert_eq!((both.px_per_mm, both.length_mm), (None, Some(45.0)));
        assert_eq!((both.clamp, both.strip), (Some(Side::Left), Some(Tone::Dark)));
        assert_eq!(
            (both.frames_per_second, both.times_s),
            (None, Some(vec![0.0, 1.0]))
        );
    }

    #[test]
    fn what_cannot_be_is_refused_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let mut told = String::new();
        for text in [
            "clamp = \"up\"",
            "\nscale = 3",
            "px_per_mm = -1.0",
            "px_per_mm = 1.0\nlength_mm = 2.0",
            "vectors = 2",
        ] {
            std::fs::write(folder.path().join(FILE_NAME), text).unwrap();
            told += &format!("{}\n", of_folder(folder.path(), folder.path()).unwrap_err());
        }
        insta::assert_snapshot!(told);
    }
}
