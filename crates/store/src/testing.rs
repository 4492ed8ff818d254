//! Runs on their way into the database, for the tests of this crate.

use std::sync::Arc;

use crate::{Continues, NewRun, RunContent, Tagging};
use ieap_domain::data_hash::data_hash;
use ieap_domain::{Channel, Drive, Quantity, RunClock, RunKind, RunOrigin, RunState, RunStatus};

/// A run of one file with its clock, ready to be fitted; `current_a` are its readings, one a second.
pub fn new_run(path: &str, kind: RunKind, current_a: &[f64]) -> NewRun {
    let time_s: Arc<[f64]> = (0..current_a.len()).map(|k| k as f64).collect();
    let channels = vec![Channel::new(Quantity::Current, time_s, current_a.into())];
    let hash = data_hash(&channels);
    NewRun {
        kind,
        path: path.to_owned(),
        contents: vec![RunContent {
            path: path.to_owned(),
            archive_path: format!("archive/{hash}"),
            hash: hash.clone(),
            size_bytes: 1,
        }],
        format: "plain-table".to_owned(),
        reader_version: 1,
        technique: None,
        is_step_response: true,
        encoding: None,
        status: RunStatus::Complete,
        status_evidence: String::new(),
        time_zero_is_step: true,
        original_metadata: Vec::new(),
        data_hash: hash.clone(),
        measurement: hash,
        continues: Continues::Same,
        origin: RunOrigin {
            clocks: vec![RunClock {
                file: path.to_owned(),
                is_reference: true,
                first_channel: 0,
                channels: channels.len(),
                time_column: Some("time_s".to_owned()),
                time_unit: "s".to_owned(),
                printed_column: None,
                stamp: None,
            }],
            ..RunOrigin::default()
        },
        channels,
        issues: Vec::new(),
        tagging: Tagging {
            state: RunState::Ready,
            tags: Vec::new(),
            chosen: 0,
            issues: Vec::new(),
            drive: Some(Drive::step(2.0)),
            area_cm2: Some(0.1),
            length_cm: None,
            electrode_resistance_ohm_per_sq: None,
            clock_offset_s: None,
            digest: String::new(),
            climate: Vec::new(),
            climate_curves: Vec::new(),
        },
    }
}
