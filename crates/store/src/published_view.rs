//! Rows that follow from everything else, kept for whoever asks the database in SQL.
//!
//! They are no change of the campaign: nothing counts them, no result is made from them, and so they carry no hash.

use rusqlite::TransactionBehavior;

use super::{Store, StoreError};

/// Rows of one kind, as JSON.
pub type PublishedRows = (&'static str, Vec<String>);

impl Store {
    /// The change that the rows were made from; none where there are none yet.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn shown_of(&self) -> Result<Option<u64>, StoreError> {
        let found = self
            .connection
            .query_row("SELECT changes FROM shown_of", [], |row| row.get::<_, i64>(0));
        let changes = found.map_err(|e| self.failed("asking what is shown", e))?;
        Ok(u64::try_from(changes).ok())
    }

    /// Puts rows in place of those that stand, made from that change at `now` (RFC 3339 UTC).
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn put_shown(&self, rows: &[PublishedRows], changes: u64, now: &str) -> Result<(), StoreError> {
        self.check_in_place()?;
        let put = || -> rusqlite::Result<()> {
            let transaction =
                rusqlite::Transaction::new_unchecked(&self.connection, TransactionBehavior::Immediate)?;
            rows.iter().try_for_each(|rows| put_kind(&transaction, rows))?;
            let kinds: Vec<&str> = rows.iter().map(|(kind, _)| *kind).collect();
            let sql = "DELETE FROM shown WHERE kind NOT IN (SELECT value FROM json_each(?1))";
            transaction.execute(sql, [serde_json::json!(kinds).to_string()])?;
            let sql = "UPDATE shown_of SET changes = ?1, made_at = ?2";
            transaction.execute(sql, (changes as i64, now))?;
            transaction.commit()
        };
        put().map_err(|e| self.failed("storing what is shown", e))
    }

    /// Puts rows in place of those of their kind, where they differ; what the others are made from stays.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn put_shown_of_kind(&self, rows: &PublishedRows) -> Result<(), StoreError> {
        self.check_in_place()?;
        let put = || -> rusqlite::Result<()> {
            let sql = "SELECT document FROM shown WHERE kind = ?1 ORDER BY ordinal";
            let mut stand = self.connection.prepare_cached(sql)?;
            let stand = stand.query_map([rows.0], |row| row.get(0))?;
            if stand.collect::<rusqlite::Result<Vec<String>>>()? == rows.1 {
                return Ok(());
            }
            let transaction =
                rusqlite::Transaction::new_unchecked(&self.connection, TransactionBehavior::Immediate)?;
            put_kind(&transaction, rows)?;
            transaction.commit()
        };
        put().map_err(|e| self.failed("storing what is shown", e))
    }
}

/// Puts the rows of a kind in place of those that stand. What stands as it is is not written again: of a large campaign that
/// is nearly all.
fn put_kind(into: &rusqlite::Transaction<'_>, (kind, documents): &PublishedRows) -> rusqlite::Result<()> {
    let sql = "INSERT INTO shown VALUES (?1, ?2, ?3)
               ON CONFLICT (kind, ordinal) DO UPDATE SET document = excluded.document WHERE document <> excluded.document";
    let mut put = into.prepare_cached(sql)?;
    for (ordinal, document) in documents.iter().enumerate() {
        put.execute((kind, ordinal as i64, document))?;
    }
    let sql = "DELETE FROM shown WHERE kind = ?1 AND ordinal >= ?2";
    into.execute(sql, (kind, documents.len() as i64))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_put_in_place_of_others_and_are_no_change() {
        let store = Store::in_memory().unwrap();
        assert_eq!(store.shown_of().unwrap(), None);
        let before = store.changes().unwrap();
        let law = |material: &str| format!("{{\"material\":\"{material}\",\"p\":0.01}}");
        store
            .put_shown(&[("law", vec![law("A"), law("B")])], 7, "2026-01-01T00:00:00Z")
            .unwrap();
        store
            .put_shown(&[("law", vec![law("C")])], 8, "2026-01-02T00:00:00Z")
            .unwrap();
        assert_eq!(store.shown_of().unwrap(), Some(8));
        assert_eq!(store.changes().unwrap(), before);
        // What stands as it is is not written again.
        let written = store.connection.total_changes();
        let same = [("law", vec![law("C")])];
        store.put_shown(&same, 8, "2026-01-02T00:00:00Z").unwrap();
        assert_eq!(
            store.connection.total_changes() - written,
            1,
            "only what they are of"
        );
        let seen: (String, f64, String) = store
            .connection
            .query_row("SELECT material, p, made_at FROM laws_view", [], |row| {
                Ok((row.get("material")?, row.get("p")?, row.get("made_at")?))
            })
            .unwrap();
        assert_eq!(seen, ("C".to_owned(), 0.01, "2026-01-02T00:00:00Z".to_owned()));
        // Rows of another kind leave them, and what they were made from, as they are.
        let samples = ("sample", vec!["{\"sample\":\"A\",\"material\":\"M\"}".to_owned()]);
        store.put_shown_of_kind(&samples).unwrap();
        store.put_shown_of_kind(&samples).unwrap();
        let counts =
            "SELECT count(*) FILTER (WHERE kind = 'law'), count(*) FILTER (WHERE kind = 'sample') FROM shown";
        let counts: (i64, i64) = store
            .connection
            .query_row(counts, [], |row| Ok((row.get(0)?, row.get(1)?)))
            .unwrap();
        assert_eq!((counts, store.shown_of().unwrap()), ((1, 1), Some(8)));
    }

    #[test]
    fn a_finding_says_what_q_leaves_of_it_once_a_report_knows_it() {
        let store = Store::in_memory().unwrap();
        let found = r#"{"found":{"verdict":"law","sentence":"A law.","effects":[{"effect":"leak"}],"set":["leak"],
                       "posterior":[],"next_run":{"drive":"a longer step"},"members":[]}}"#;
        let sql = "INSERT INTO result (kind, name, key, version, built_from, document, made_at)
                   VALUES ('group', 'G', '', '', '', ?1, '2026-01-02T00:00:00Z')";
        store.connection.execute(sql, [found]).unwrap();
        let left = r#"{"kind":"group","name":"G","verdict":"undecided","sentence":"Chance.","effects":"[]",
                      "as_good":"[]","next_run":null,"q_misfit":0.2}"#;
        let view = |shown_at: &str| {
            store
                .put_shown(&[("finding", vec![left.to_owned()])], 1, shown_at)
                .unwrap();
            let sql = "SELECT verdict, sentence, effects, as_good, next_run, q_misfit FROM findings_view";
            let row = |row: &rusqlite::Row<'_>| {
                let text = |at: usize| row.get::<_, Option<String>>(at);
                let texts = [text(0)?, text(1)?, text(2)?, text(3)?, text(4)?];
                Ok((
                    texts.map(Option::unwrap_or_default),
                    row.get::<_, Option<f64>>(5)?,
                ))
            };
            store.connection.query_row(sql, [], row).unwrap()
        };
        let of = |texts: [&str; 5], q| (texts.map(str::to_owned), q);
        assert_eq!(
            view("2026-01-02T00:00:01Z"),
            of(["undecided", "Chance.", "[]", "[]", ""], Some(0.2))
        );
        assert_eq!(
            view("2026-01-01T00:00:00Z"),
            of(
                ["law", "A law.", r#"["leak"]"#, r#"["leak"]"#, "a longer step"],
                None
            )
        );
    }
}
