//! What the readings of a run rest on beside their files: profiles, clocks with their offsets, flags.

use std::sync::Arc;

use rusqlite::{Row, params};

use super::columns::{count_in, key_in};
use super::{StepError, Store, StoreError, Subject, Transaction};
use ieap_domain::{
    Channel, ClockOffset, FlaggedStretch, OffsetSource, ProfileUse, RunClock, RunOrigin, StartedAt, Timestamp,
};

impl Store {
    /// Clocks, offsets, flags and profiles of a run.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn origin(&self, run_id: i64) -> Result<RunOrigin, StoreError> {
        let _moment = self.snapshot()?;
        self.check_seal(&Subject::Run(run_id))?;
        self.origin_of_checked(run_id)
    }

    /// The same of a run that was held against its seal.
    pub(super) fn origin_of_checked(&self, run_id: i64) -> Result<RunOrigin, StoreError> {
        let clocks =
            "SELECT file, is_reference, first_channel, channels, time_column, time_unit, printed_column,
                             stamp_raw, stamp_kind, stamp_local, stamp_offset, stamp_basis
                      FROM run_clock WHERE run_id = ?1 ORDER BY ordinal";
        let offsets = "SELECT clock, source, offset_s, standard_error_s, applied, detail
                       FROM clock_offset WHERE run_id = ?1 ORDER BY clock, source DESC";
        let flags = "SELECT column_name, flag, from_s, to_s, readings, excludes
                     FROM sample_flag WHERE run_id = ?1 ORDER BY ordinal";
        let profiles =
            "SELECT ordinal, id, version, digest, text FROM run_profile JOIN profile USING (digest)
                        WHERE run_id = ?1 ORDER BY ordinal";
        Ok(RunOrigin {
            clocks: self.rows_of(run_id, clocks, read_clock)?,
            offsets: self.rows_of(run_id, offsets, read_offset)?,
            flags: self.rows_of(run_id, flags, read_flag)?,
            profiles: self.rows_of(run_id, profiles, read_profile)?,
        })
    }

    /// First channel, number of channels and offset, s, of every clock whose times are used with an offset.
    pub(super) fn applied_offsets(&self, run_id: i64) -> Result<Vec<(usize, usize, f64)>, StoreError> {
        let sql = "SELECT first_channel, channels, offset_s FROM clock_offset
                   JOIN run_clock ON run_clock.run_id = clock_offset.run_id AND ordinal = clock
                   WHERE clock_offset.run_id = ?1 AND applied = 1 AND offset_s IS NOT NULL";
        self.rows_of(run_id, sql, |row| {
            let (first, channels) = (count_in(row, "first_channel")?, count_in(row, "channels")?);
            Ok((first, channels, row.get("offset_s")?))
        })
    }

    /// First channel and number of channels of every clock beside the reference whose offset nobody stated.
    pub(super) fn own_clocks(&self, run_id: i64) -> Result<Vec<(usize, usize)>, StoreError> {
        let sql = "SELECT first_channel, channels FROM run_clock
                   WHERE run_id = ?1 AND is_reference = 0 AND NOT EXISTS
                         (SELECT 1 FROM clock_offset WHERE run_id = ?1 AND clock = ordinal AND applied = 1)";
        self.rows_of(run_id, sql, |row| {
            Ok((count_in(row, "first_channel")?, count_in(row, "channels")?))
        })
    }
}

type Times = Arc<[f64]>;

/// Adds `offset_s` to the times of channels; those that shared their times still do.
pub(super) fn shift(channels: &mut [Channel], offset_s: f64) {
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

/// The date and time that a file states, from the columns of its clock.
pub(super) fn read_stamp(row: &Row<'_>) -> Result<Option<StartedAt>, StepError> {
    let raw: Option<String> = row.get("stamp_raw")?;
    Ok(match raw {
        None => None,
        Some(raw) => Some(StartedAt {
            raw,
            kind: key_in(row, "stamp_kind", "the kind of a time stamp", Timestamp::from_key)?,
            local: row.get("stamp_local")?,
            offset: row.get("stamp_offset")?,
            basis: row.get("stamp_basis")?,
        }),
    })
}

fn read_clock(row: &Row<'_>) -> Result<RunClock, StepError> {
    let stamp = read_stamp(row)?;
    Ok(RunClock {
        file: row.get("file")?,
        is_reference: row.get("is_reference")?,
        first_channel: count_in(row, "first_channel")?,
        channels: count_in(row, "channels")?,
        time_column: row.get("time_column")?,
        time_unit: row.get("time_unit")?,
        printed_column: row.get("printed_column")?,
        stamp,
    })
}

fn read_offset(row: &Row<'_>) -> Result<ClockOffset, StepError> {
    let source = key_in(
        row,
        "source",
        "the source of a clock offset",
        OffsetSource::from_key,
    )?;
    Ok(ClockOffset {
        clock: count_in(row, "clock")?,
        source,
        offset_s: row.get("offset_s")?,
        standard_error_s: row.get("standard_error_s")?,
        applied: row.get("applied")?,
        detail: row.get("detail")?,
    })
}

fn read_flag(row: &Row<'_>) -> Result<FlaggedStretch, StepError> {
    Ok(FlaggedStretch {
        column: row.get("column_name")?,
        flag: row.get("flag")?,
        from_s: row.get("from_s")?,
        to_s: row.get("to_s")?,
        readings: count_in(row, "readings")?,
        excludes: row.get("excludes")?,
    })
}

fn read_profile(row: &Row<'_>) -> Result<ProfileUse, StepError> {
    Ok(ProfileUse {
        file: count_in(row, "ordinal")?,
        id: row.get("id")?,
        version: row.get("version")?,
        digest: row.get("digest")?,
        text: row.get("text")?,
    })
}

/// Stores what the readings of a new run rest on.
pub(super) fn insert_origin(
    transaction: &Transaction<'_>,
    now: &str,
    run_id: i64,
    origin: &RunOrigin,
) -> Result<(), StepError> {
    for profile in &origin.profiles {
        transaction
            .prepare_cached("INSERT OR IGNORE INTO profile VALUES (?1, ?2, ?3, ?4, ?5)")?
            .execute(params![
                profile.digest,
                profile.id,
                profile.version,
                profile.text,
                now
            ])?;
        transaction
            .prepare_cached("INSERT INTO run_profile VALUES (?1, ?2, ?3)")?
            .execute(params![run_id, profile.file as i64, profile.digest])?;
    }
    for (ordinal, clock) in origin.clocks.iter().enumerate() {
        insert_clock(transaction, run_id, ordinal, clock)?;
    }
    for offset in &origin.offsets {
        insert_offset(transaction, run_id, offset)?;
    }
    for (ordinal, flag) in origin.flags.iter().enumerate() {
        transaction
            .prepare_cached("INSERT INTO sample_flag VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)")?
            .execute(params![
                run_id,
                ordinal as i64,
                flag.column,
                flag.flag,
                flag.from_s,
                flag.to_s,
                flag.readings as i64,
                flag.excludes
            ])?;
    }
    Ok(())
}

fn insert_clock(
    transaction: &Transaction<'_>,
    run_id: i64,
    ordinal: usize,
    clock: &RunClock,
) -> Result<(), StepError> {
    let stamp = clock.stamp.as_ref();
    let sql = "INSERT INTO run_clock VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14)";
    transaction.prepare_cached(sql)?.execute(params![
        run_id,
        ordinal as i64,
        clock.file,
        clock.is_reference,
        clock.first_channel as i64,
        clock.channels as i64,
        clock.time_column,
        clock.time_unit,
        clock.printed_column,
        stamp.map(|stamp| &stamp.raw),
        stamp.map(|stamp| stamp.kind.key()),
        stamp.and_then(|stamp| stamp.local.as_ref()),
        stamp.and_then(|stamp| stamp.offset.as_ref()),
        stamp.map(|stamp| &stamp.basis),
    ])?;
    Ok(())
}

fn insert_offset(transaction: &Transaction<'_>, run_id: i64, offset: &ClockOffset) -> Result<(), StepError> {
    transaction
        .prepare_cached("INSERT INTO clock_offset VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")?
        .execute(params![
            run_id,
            offset.clock as i64,
            offset.source.key(),
            offset.offset_s,
            offset.standard_error_s,
            offset.applied,
            offset.detail
        ])?;
    Ok(())
}

/// Applies the offset that a tag states to every clock but the reference.
pub(super) fn insert_stated_offset(
    transaction: &Transaction<'_>,
    run_id: i64,
    offset_s: f64,
) -> Result<(), StepError> {
    let sql = "INSERT INTO clock_offset
               SELECT run_id, ordinal, 'stated', ?2, NULL, 1, 'the tag clock_offset_s'
               FROM run_clock WHERE run_id = ?1 AND NOT is_reference";
    transaction
        .prepare_cached(sql)?
        .execute(params![run_id, offset_s])?;
    Ok(())
}

/// Takes back what a tag stated before.
pub(super) fn delete_stated_offset(transaction: &Transaction<'_>, run_id: i64) -> Result<(), StepError> {
    transaction
        .prepare_cached("DELETE FROM clock_offset WHERE run_id = ?1 AND source = 'stated'")?
        .execute([run_id])?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use ieap_domain::Quantity;

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
