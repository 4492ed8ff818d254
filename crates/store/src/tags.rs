//! Tags set by hand.

use rusqlite::params;

use super::journal::Entry;
use super::{HandTag, StepError, Store, StoreError, Subject};

impl Store {
    /// Adds tags set by hand. They outlive revisions of the run and refits.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn add_hand_tags(&mut self, now: &str, tags: &[HandTag]) -> Result<(), StoreError> {
        self.write("setting tags", now, |transaction| {
            let sql =
                "INSERT INTO hand_tag (run_path, key, value, set_by, set_at) VALUES (?1, ?2, ?3, ?4, ?5)";
            for tag in tags {
                transaction.changes(Subject::HandTags(tag.run_path.clone()))?;
                transaction.prepare_cached(sql)?.execute(params![
                    tag.run_path,
                    tag.key,
                    tag.value,
                    tag.set_by,
                    tag.set_at
                ])?;
                transaction.says(&tag.set_at, Entry::Tag(tag.clone()));
            }
            Ok(())
        })
    }

    /// The newest hand tag of each key of a run, taken-back ones left out, in order of the keys.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn hand_tags(&self, run_path: &str) -> Result<Vec<HandTag>, StoreError> {
        let doing = "reading hand tags";
        self.check_seal(&Subject::HandTags(run_path.to_owned()))?;
        let sql = "SELECT run_path, key, value, set_by, set_at FROM hand_tag
                   WHERE id IN (SELECT max(id) FROM hand_tag WHERE run_path = ?1 GROUP BY key) AND value IS NOT NULL
                   ORDER BY key";
        self.rows(doing, sql, [run_path], read_hand_tag)
    }
}

pub(super) fn read_hand_tag(row: &rusqlite::Row<'_>) -> Result<HandTag, StepError> {
    Ok(HandTag {
        run_path: row.get("run_path")?,
        key: row.get("key")?,
        value: row.get("value")?,
        set_by: row.get("set_by")?,
        set_at: row.get("set_at")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_counts_and_can_be_taken_back() {
        let mut store = Store::in_memory().unwrap();
        let tag = |key: &str, value: Option<&str>| HandTag {
            run_path: "runs/a.csv".into(),
            key: key.into(),
            value: value.map(str::to_owned),
            set_by: "tester".into(),
            set_at: "2026-01-01T00:00:00Z".into(),
        };
        let now = "2026-01-01T00:00:00Z";
        store
            .add_hand_tags(now, &[tag("sample", Some("A")), tag("note", Some("x"))])
            .unwrap();
        store
            .add_hand_tags(now, &[tag("sample", Some("B")), tag("note", None)])
            .unwrap();
        let kept = store.hand_tags("runs/a.csv").unwrap();
        assert_eq!(kept, vec![tag("sample", Some("B"))]);
    }
}
