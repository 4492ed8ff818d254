//! Alarms that were told.

use std::collections::BTreeSet;

use rusqlite::params;

use super::journal::{Entry, ToldAlarm};
use super::{Store, StoreError, Subject};
use ieap_domain::Alarm;

impl Store {
    /// Ids of the alarms that were told.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn told_alarms(&self) -> Result<BTreeSet<String>, StoreError> {
        let doing = "reading alarms";
        self.check_seal(&Subject::Alarms)?;
        let ids = self.rows(doing, "SELECT id FROM alarm", [], |row| Ok(row.get(0)?))?;
        Ok(ids.into_iter().collect())
    }

    /// Id, run and message of the alarms that were told, by when.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn told_of_runs(&self) -> Result<Vec<[String; 3]>, StoreError> {
        let doing = "reading alarms";
        self.check_seal(&Subject::Alarms)?;
        let sql = "SELECT id, run_path, message FROM alarm ORDER BY raised_at, id";
        self.rows(doing, sql, [], |row| {
            Ok([row.get("id")?, row.get("run_path")?, row.get("message")?])
        })
    }

    /// Records an alarm as told. Whoever tells it does so after this: a crash in between loses a message and never
    /// sends one twice.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_alarm(&mut self, now: &str, alarm: &Alarm) -> Result<(), StoreError> {
        let told = ToldAlarm {
            id: alarm.id.clone(),
            sample: alarm.sample.clone(),
            parameter: alarm.parameter.clone(),
            chart: chart_that_tells(&alarm.chart).to_owned(),
            run: alarm.run.clone(),
            message: alarm.message.clone(),
        };
        self.save_told(now, &told)
    }

    /// The same of an alarm as the journal has it.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_told(&mut self, now: &str, alarm: &ToldAlarm) -> Result<(), StoreError> {
        self.write("storing an alarm", now, |transaction| {
            transaction.changes(Subject::Alarms)?;
            transaction.execute(
                "INSERT INTO alarm VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, NULL)",
                params![
                    alarm.id,
                    alarm.sample,
                    alarm.parameter,
                    alarm.chart,
                    alarm.run,
                    alarm.message,
                    now
                ],
            )?;
            transaction.says(now, Entry::Told(alarm.clone()));
            Ok(())
        })
    }

    /// Records how the command of an alarm ended.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn save_alarm_command(&mut self, now: &str, id: &str, status: &str) -> Result<(), StoreError> {
        self.write("storing how a command ended", now, |transaction| {
            transaction.changes(Subject::Alarms)?;
            transaction.execute("UPDATE alarm SET command_status = ?2 WHERE id = ?1", [id, status])?;
            let (id, status) = (id.to_owned(), status.to_owned());
            transaction.says(now, Entry::Command { id, status });
            Ok(())
        })
    }
}

/// The chart under whose name an alarm is stored: a jump is told under the id that the chart gives it, because the chart tells it
/// until it is known to be a jump.
fn chart_that_tells(shown_by: &str) -> &str {
    match shown_by {
        "jump" => "ewma",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The signs that monitoring gives alarms (`analysis::monitoring::events`).
    #[test]
    fn every_kind_of_alarm_can_be_stored() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = Store::open(folder.path()).unwrap();
        for kind in ["ewma", "jump", "limit"] {
            let alarm = Alarm {
                id: kind.to_owned(),
                sample: "S1".to_owned(),
                parameter: "rss_ohm_cm2".to_owned(),
                chart: kind.to_owned(),
                run: "runs/a.csv".to_owned(),
                message: "it left control".to_owned(),
                ..Alarm::default()
            };
            store.save_alarm("2026-01-01T00:00:00Z", &alarm).unwrap();
        }
        assert_eq!(store.told_alarms().unwrap().len(), 3);
    }
}
