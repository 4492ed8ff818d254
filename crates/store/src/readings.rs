//! Readings of runs: as their files have them, and as their clocks and tags say.

use std::sync::Arc;

use rusqlite::Row;

use super::blob::{hash_of, unpack_f64, unpack_u32, unpacked_json};
use super::columns::count_in;
use super::new_run::{ChannelDocument, RunRow};
use super::rows::RUN;
use super::{StepError, Store, StoreError};
use ieap_domain::data_hash::data_hash;
use ieap_domain::left_out;
use ieap_domain::tag::keys;
use ieap_domain::{Channel, ClimateCurve, ClockOffset, OffsetSource, Quantity, RunOrigin};

impl Store {
    /// Readings of a run, with the clock offsets applied that are stated, and those left out that its tags leave out.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn channels(&self, run_id: i64) -> Result<Vec<Channel>, StoreError> {
        let _moment = self.snapshot()?;
        let run = self.run_of(run_id)?;
        let mut channels = self.channels_of(&run)?;
        let (tagging, origin) = (&run.tagging, run.origin());
        let quantities = channels.iter().map(|channel| channel.quantity);
        if let Some((index, area_cm2)) = density_as_current(tagging.area_cm2, quantities) {
            channels[index] = channels[index].as_current(area_cm2);
        }
        if let Some(tag) = tagging.chosen.get(keys::LEAVE_OUT_MARKED) {
            left_out::leave_out_marked(&mut channels, tag, &origin.flags);
        }
        let count = channels.len();
        for (index, clock) in origin.clocks.iter().enumerate() {
            let timed = clock.first_channel.min(count)..(clock.first_channel + clock.channels).min(count);
            let mut applied = origin
                .offsets
                .iter()
                .filter(|offset| offset.clock == index && offset.applied);
            match applied.next() {
                Some(offset) => {
                    if let Some(offset_s) = offset.offset_s {
                        shift(&mut channels[timed], offset_s);
                    }
                }
                None if !clock.is_reference => {
                    channels[timed]
                        .iter_mut()
                        .for_each(|channel| channel.own_clock = true);
                }
                None => {}
            }
        }
        // What is no list of stretches was pointed out when the run was tagged.
        let stretches = tagging
            .chosen
            .get(keys::LEAVE_OUT)
            .and_then(|text| left_out::stretches(text));
        left_out::leave_out(&mut channels, &stretches.unwrap_or_default());
        Ok(channels)
    }

    /// Readings of a run with the times of their files.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn channels_as_read(&self, run_id: i64) -> Result<Vec<Channel>, StoreError> {
        let _moment = self.snapshot()?;
        let run = self.run_of(run_id)?;
        self.channels_of(&run)
    }

    fn channels_of(&self, run: &RunRow) -> Result<Vec<Channel>, StoreError> {
        let sql = "SELECT own.ordinal, own.time_of, coalesce(own.time_blob, shared.time_blob) AS time_blob, own.value_blob,
                       own.excluded_blob
                   FROM channel AS own JOIN channel AS shared ON shared.run_id = own.run_id AND shared.ordinal = own.time_of
                   WHERE own.run_id = ?1 ORDER BY own.ordinal";
        let blobs = self.rows("reading channels", sql, [run.id], |row| {
            let (time_of, time) = (count_in(row, "time_of")?, blob(row, "time_blob")?);
            Ok((
                time_of,
                time,
                blob(row, "value_blob")?,
                blob(row, "excluded_blob")?,
            ))
        })?;
        let damaged = || StoreError::Damaged {
            what: format!("readings of run {} ({})", run.id, run.path),
        };
        if blobs.len() != run.reading.channels.len() {
            return Err(damaged());
        }
        let mut channels: Vec<Channel> = Vec::new();
        for (document, (time_of, time, values, excluded)) in run.reading.channels.iter().zip(blobs) {
            if document.hash != hash_of(&[&time, &values, &excluded]) {
                return Err(damaged());
            }
            let time_s: Arc<[f64]> = match channels.get(time_of) {
                Some(shared) => shared.time_s.clone(),
                None => unpack_f64(&time)?.into(),
            };
            channels.push(channel(document, time_s, (&values, &excluded))?);
        }
        Ok(channels)
    }

    /// Holds the readings of a run against the hash that fits depend on.
    pub(super) fn check_readings(&self, run: &RunRow) -> Result<(), StoreError> {
        if run.data_hash == data_hash(&self.channels_of(run)?) {
            Ok(())
        } else {
            Err(StoreError::Damaged {
                what: format!("readings of run {} ({})", run.id, run.path),
            })
        }
    }

    /// Climate around a run, thinned for drawing.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn run_climate_curves(&self, run_id: i64) -> Result<Vec<ClimateCurve>, StoreError> {
        let read = |row: &Row<'_>| {
            let curves: Option<Vec<u8>> = row.get("climate_curves")?;
            Ok((RunRow::read(row)?, curves))
        };
        let rest = (", climate_curves", "WHERE id = ?1");
        let found = self.kept("reading the climate of a run", RUN, rest, [run_id], read)?;
        let Some((run, curves)) = found.into_iter().next() else {
            return Ok(Vec::new());
        };
        if curves.as_ref().map(|curves| hash_of(&[curves])) != run.tagging.climate_curves_hash {
            let what = format!("the climate around run {run_id}");
            return Err(StoreError::Damaged { what });
        }
        curves.map_or_else(
            || Ok(Vec::new()),
            |curves| unpacked_json("the climate around a run", &curves),
        )
    }

    /// Clocks, offsets, flags and profiles of a run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn origin(&self, run_id: i64) -> Result<RunOrigin, StoreError> {
        let mut origin = self.run_of(run_id)?.origin();
        self.fill_in_profiles(&mut origin)?;
        Ok(origin)
    }

    /// Fills in the texts of profiles.
    pub(super) fn fill_in_profiles(&self, origin: &mut RunOrigin) -> Result<(), StoreError> {
        for profile in &mut origin.profiles {
            let sql = "SELECT text FROM profile WHERE digest = ?1";
            let found = self.rows("reading a profile", sql, [&profile.digest], |row| {
                Ok(row.get::<_, String>(0)?)
            })?;
            let whole = |text: &String| blake3::hash(text.as_bytes()).to_hex().as_str() == profile.digest;
            let text = found.into_iter().find(whole);
            profile.text = text.ok_or_else(|| StoreError::Damaged {
                what: format!("the text of the profile {}", profile.id),
            })?;
        }
        Ok(())
    }
}

impl RunRow {
    /// What [`Store::channels`] gives follows from this and the active area alone: the hash of the readings, with the clock
    /// offsets that are applied and the tags that leave readings out.
    pub(super) fn readings_hash(&self) -> String {
        let mut hash = self.data_hash.clone();
        for offset in self.origin().offsets.iter().filter(|offset| offset.applied) {
            hash += &format!(":{}={:?}", offset.clock, offset.offset_s);
        }
        let chosen = |key: &str| self.tagging.chosen.get(key);
        // What is no list of stretches leaves nothing out.
        let stretches = chosen(keys::LEAVE_OUT).filter(|text| left_out::stretches(text).is_some());
        let marked = chosen(keys::LEAVE_OUT_MARKED);
        for (key, value) in [(keys::LEAVE_OUT, stretches), (keys::LEAVE_OUT_MARKED, marked)] {
            hash += &value.map_or_else(String::new, |value| format!(":{key}={value}"));
        }
        hash
    }

    /// Clocks, offsets, flags and profiles, with the offset that a tag states for every clock but the reference.
    pub(super) fn origin(&self) -> RunOrigin {
        let mut origin = self.reading.origin.clone();
        if let Some(offset_s) = self.tagging.clock_offset_s {
            let clocks = origin.clocks.iter().enumerate();
            let stated = clocks
                .filter(|(_, clock)| !clock.is_reference)
                .map(|(clock, _)| ClockOffset {
                    clock,
                    source: OffsetSource::Stated,
                    offset_s: Some(offset_s),
                    standard_error_s: None,
                    applied: true,
                    detail: "the tag clock_offset_s".to_owned(),
                });
            origin.offsets.extend(stated);
        }
        let rank = |offset: &ClockOffset| (offset.clock, std::cmp::Reverse(offset.source.key()));
        origin.offsets.sort_by_key(rank);
        origin
    }
}

fn blob(row: &Row<'_>, column: &str) -> Result<Vec<u8>, StepError> {
    Ok(row.get::<_, Option<Vec<u8>>>(column)?.unwrap_or_default())
}

fn channel(
    document: &ChannelDocument,
    time_s: Arc<[f64]>,
    (values, excluded): (&[u8], &[u8]),
) -> Result<Channel, StoreError> {
    let values: Arc<[f64]> = unpack_f64(values)?.into();
    if values.len() != time_s.len() {
        let detail = format!("{} times, {} values", time_s.len(), values.len());
        return Err(StoreError::BadValue {
            what: "a channel's readings",
            detail,
        });
    }
    let summary = &document.summary;
    Ok(Channel {
        quantity: summary.quantity,
        raw_name: summary.raw_name.clone(),
        raw_unit: summary.raw_unit.clone(),
        position_mm: summary.position_mm,
        time_s,
        values,
        excluded: unpack_u32(excluded)?.into(),
        own_clock: false,
        open_zero: None,
    })
}

/// Which channel is a current density that stands for the current, and the active area, cm2, that makes it one: the
/// first, where no current was measured and the area is known.
pub(super) fn density_as_current(
    area_cm2: Option<f64>,
    mut quantities: impl Iterator<Item = Quantity> + Clone,
) -> Option<(usize, f64)> {
    let has_current = quantities.clone().any(|quantity| quantity == Quantity::Current);
    let density = quantities.position(|quantity| quantity == Quantity::CurrentDensity);
    density.filter(|_| !has_current).zip(area_cm2)
}

type Times = Arc<[f64]>;

/// Adds `offset_s` to the times of channels; those that shared their times still do.
fn shift(channels: &mut [Channel], offset_s: f64) {
    let mut shifted: Vec<(Times, Times)> = Vec::new();
    for channel in channels {
        let known = shifted.iter().find(|(old, _)| Arc::ptr_eq(old, &channel.time_s));
        let moved = match known {
            Some((_, new)) => new.clone(),
            None => channel.time_s.iter().map(|time_s| time_s + offset_s).collect(),
        };
        shifted.push((channel.time_s.clone(), moved.clone()));
        channel.time_s = moved;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shift_keeps_shared_times_shared() {
        let time_s: Arc<[f64]> = Arc::from([0.0, 1.0]);
        let channel = |quantity| Channel::new(quantity, time_s.clone(), Arc::from([1.0, 2.0]));
        let mut channels = [channel(Quantity::Curvature), channel(Quantity::TipDisplacement)];
        shift(&mut channels, 0.25);
        assert_eq!(&channels[1].time_s[..], [0.25, 1.25]);
        assert!(Arc::ptr_eq(&channels[0].time_s, &channels[1].time_s));
    }
}
