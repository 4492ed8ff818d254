//! What a caller states of readings: the strip, the drive, tags.

use std::collections::BTreeMap;

use ieap::domain::tag::keys;
use ieap::pipeline::apart::at_hand;
use pyo3::prelude::*;

/// What a caller states of readings.
#[pyclass(frozen, module = "ieap._native")]
pub struct Stated {
    pub inner: at_hand::Stated,
}

#[pymethods]
impl Stated {
    #[new]
    #[pyo3(signature = (area_cm2 = None, length_mm = None, width_mm = None, electrode_resistance_ohm_per_sq = None,
                        baseline_v = 0.0, drive = Vec::new(), tags = BTreeMap::new()))]
    fn new(
        area_cm2: Option<f64>,
        length_mm: Option<f64>,
        width_mm: Option<f64>,
        electrode_resistance_ohm_per_sq: Option<f64>,
        baseline_v: f64,
        drive: Vec<(f64, Option<f64>)>,
        tags: BTreeMap<String, String>,
    ) -> Stated {
        let strip = at_hand::Strip {
            area_cm2,
            length_mm,
            width_mm,
            electrode_resistance_ohm_per_sq,
        };
        Stated {
            inner: at_hand::Stated {
                strip,
                baseline_v,
                drive,
                tags,
            },
        }
    }
}

/// What is stated now over what came with the readings.
pub fn over(own: &at_hand::Stated, before: Option<&at_hand::Stated>) -> at_hand::Stated {
    let Some(before) = before else {
        return own.clone();
    };
    let (strip, earlier) = (own.strip, before.strip);
    let has_size = strip.area_cm2.is_some() || (strip.length_mm.is_some() && strip.width_mm.is_some());
    let has_drive = !own.drive.is_empty() || own.tags.contains_key(keys::VOLTAGE_V);
    let drive = if has_drive { own } else { before };
    let mut tags = before.tags.clone();
    tags.extend(own.tags.clone());
    at_hand::Stated {
        strip: at_hand::Strip {
            // An area that came with the readings does not stand beside a length and width stated now.
            area_cm2: if has_size {
                strip.area_cm2
            } else {
                earlier.area_cm2
            },
            length_mm: strip.length_mm.or(earlier.length_mm),
            width_mm: strip.width_mm.or(earlier.width_mm),
            electrode_resistance_ohm_per_sq: strip
                .electrode_resistance_ohm_per_sq
                .or(earlier.electrode_resistance_ohm_per_sq),
        },
        baseline_v: drive.baseline_v,
        drive: drive.drive.clone(),
        tags,
    }
}
