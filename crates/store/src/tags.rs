//! Tags set by hand, and those that were stated beside files that are gone.

use rusqlite::{Connection, params};

use super::columns::key_in;
use super::journal::Entry;
use super::{HandTag, StepError, Store, StoreError, Subject};
use ieap_domain::{Tag, TagSource};

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

    /// Gives the current runs in a file what was stated beside it, in place of what they have of it, and has them tagged again:
    /// of a file that is gone this holds ([`Entry::Gone`]).
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn keep_tags(&mut self, now: &str, path: &str, tags: &[Tag]) -> Result<(), StoreError> {
        self.write("keeping tags", now, |transaction| {
            let current = "SELECT id FROM run WHERE superseded_at IS NULL
                           AND id IN (SELECT run_id FROM run_file
                                      WHERE hash = (SELECT hash FROM source_file WHERE path = ?1) AND path = ?1)";
            let new = "INSERT INTO tag
                       SELECT ?1, coalesce(max(ordinal) + 1, 0), ?2, ?3, ?4, ?5, 0 FROM tag WHERE run_id = ?1";
            for run_id in transaction.ids(current, path)? {
                transaction.changes(Subject::Run(run_id))?;
                transaction.execute(
                    "DELETE FROM tag WHERE run_id = ?1 AND source IN ('sidecar', 'folder', 'run_sheet')",
                    [run_id],
                )?;
                for tag in tags {
                    let values = params![run_id, tag.key, tag.value, tag.source.key(), tag.detail];
                    transaction.prepare_cached(new)?.execute(values)?;
                }
                transaction.execute("UPDATE run SET tag_digest = '' WHERE id = ?1", [run_id])?;
            }
            Ok(())
        })
    }

    /// Says of a file that is gone what is stated beside it now: the files that state it may go as well.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn say_stated_beside(&mut self, now: &str, path: &str) -> Result<(), StoreError> {
        self.write("noting tags", now, |transaction| {
            let (path, tags) = (path.to_owned(), stated_beside(transaction, path)?);
            transaction.says(now, Entry::Gone { path, tags });
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

pub(super) fn read_tag(row: &rusqlite::Row<'_>) -> Result<Tag, StepError> {
    Ok(Tag {
        key: row.get("key")?,
        value: row.get("value")?,
        source: key_in(row, "source", "a tag's source", TagSource::from_key)?,
        detail: row.get("detail")?,
    })
}

/// What files beside a file and run sheets stated of the current runs in it, each once.
pub(super) fn stated_beside(connection: &Connection, path: &str) -> Result<Vec<Tag>, StepError> {
    let sql = "SELECT key, value, source, detail FROM tag JOIN run ON run.id = tag.run_id
               WHERE superseded_at IS NULL AND source IN ('sidecar', 'folder', 'run_sheet')
                   AND run_id IN (SELECT run_id FROM run_file
                                  WHERE hash = (SELECT hash FROM source_file WHERE path = ?1) AND path = ?1)
               ORDER BY run_id, ordinal";
    let mut statement = connection.prepare_cached(sql)?;
    let mut rows = statement.query([path])?;
    let mut tags = Vec::new();
    while let Some(row) = rows.next()? {
        let tag = read_tag(row)?;
        if !tags.contains(&tag) {
            tags.push(tag);
        }
    }
    Ok(tags)
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
