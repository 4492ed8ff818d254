//! Runs whose tag files or run sheets cannot be read now.

use rusqlite::params;

use super::columns::count_in;
use super::new_run::insert_issues;
use super::runs::read_issue;
use super::{Store, StoreError, Subject};
use ieap_domain::Issue;
use ieap_domain::tag::UNREADABLE;

impl Store {
    /// Leaves the tags of a run and what follows from them as they are, and records why: what states them cannot be read.
    /// `digest` is that of the sources as they are now.
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn hold_tags(
        &mut self,
        now: &str,
        run_id: i64,
        digest: &str,
        issues: &[Issue],
    ) -> Result<(), StoreError> {
        self.write("holding tags", now, |transaction| {
            transaction.changes(Subject::Run(run_id))?;
            let sql = "DELETE FROM run_issue WHERE run_id = ?1 AND stage = 'tag' AND code = ?2";
            for code in UNREADABLE {
                transaction.prepare_cached(sql)?.execute(params![run_id, code])?;
            }
            let sql = "UPDATE run SET tag_digest = ?2 WHERE id = ?1";
            transaction
                .prepare_cached(sql)?
                .execute(params![run_id, digest])?;
            let first: i64 = transaction
                .prepare_cached("SELECT coalesce(max(ordinal) + 1, 0) FROM run_issue WHERE run_id = ?1")?
                .query_row([run_id], |row| row.get(0))?;
            insert_issues(transaction, run_id, "tag", first, issues)
        })
    }

    /// What cannot be read of the tag files of current runs, and for how many runs each speaks, by place. Run sheets are
    /// files of their own ([`Store::unsettled_files`]).
    ///
    /// # Errors
    /// See [`StoreError`].
    pub fn unreadable_tag_files(&self) -> Result<Vec<(Issue, usize)>, StoreError> {
        let sql = "SELECT severity, code, place, message, mend, count(DISTINCT run_id) AS runs FROM run_issue
                   JOIN run ON run.id = run_id
                   WHERE run.superseded_at IS NULL AND stage = 'tag'
                     AND code IN ('tag-file-unreadable', 'tag-file-not-toml', 'tag-not-flat')
                   GROUP BY place, code ORDER BY place, code";
        self.rows("listing tag files that cannot be read", sql, [], |row| {
            Ok((read_issue(row)?, count_in(row, "runs")?))
        })
    }
}
