//! Writes into the journal what only the database has.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::entry::Line;
use super::file::{FILE_NAME, Found, Locked, PARTIAL, failed, opened_in, path_in, read};
use super::{Compared, course, tail};
use crate::{FILE_NAME as DATABASE, StepError, StoreError};
use ieap_system::Temporary;
use ieap_system::fs;

/// Digits of the hash that tells journals that were set aside from each other.
const MARK_DIGITS: usize = 12;

/// Holds the lines of a database against the journal and writes into the journal what it lacks; gives the
/// journal as it is then. Lines of the database after `up_to` are of a transaction under way.
pub(super) fn brought_up(
    connection: &Connection,
    campaign: &Path,
    file: Locked,
    up_to: u64,
) -> Result<(Compared, Locked), StepError> {
    let stored = course::stored(connection, up_to)?;
    let found = read(campaign)?.unwrap_or_default();
    let compared = Compared::of(&stored, &found).map_err(|detail| parted(campaign, detail))?;
    if compared.of_database.is_empty() {
        return Ok((compared, file));
    }
    let file = completed(campaign, file, &found, &compared)?;
    Ok((compared, file))
}

/// Writes into the journal what only the database has. One that lacks no more than its end gets it; any other is written
/// anew, and kept under another name.
pub(super) fn completed(
    campaign: &Path,
    mut locked: Locked,
    found: &Found,
    compared: &Compared,
) -> Result<Locked, StoreError> {
    let path = path_in(campaign);
    let follow = compared.of_database.iter().all(|line| line.n > found.last_number);
    if follow && found.is_whole() {
        let file = &mut locked.file;
        let end = tail::mended(file).map_err(|source| failed(&path, source))?;
        let text = text_of(compared.of_database.iter());
        let added = file.write_all(text.as_bytes()).and_then(|()| file.sync_all());
        return match added {
            Ok(()) => Ok(locked),
            Err(source) => {
                let _ = file.set_len(end.bytes);
                Err(failed(&path, source))
            }
        };
    }
    let lines = found.lines.iter().chain(&compared.of_database);
    let lines: BTreeMap<u64, &Line> = lines.map(|line| (line.n, line)).collect();
    let anew = written_anew(&path, &text_of(lines.into_values()));
    anew.map_err(|source| failed(&path, source))?;
    opened_in(campaign, locked.held)
}

/// Puts another text in the place of the journal; what it said is kept beside it.
fn written_anew(path: &Path, text: &str) -> std::io::Result<()> {
    let old = fs::read_own(path)?;
    let mut mark = blake3::hash(&old).to_hex().to_string();
    mark.truncate(MARK_DIGITS);
    let folder = path.parent().map_or_else(PathBuf::new, Path::to_owned);
    let whole = |bytes: &[u8], name: &Path| -> std::io::Result<()> {
        let mut file = Temporary::new_in(&folder, PARTIAL, "", 0o644)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        file.persist(name)
    };
    whole(&old, &folder.join(format!("{FILE_NAME}.set-aside-{mark}")))?;
    whole(text.as_bytes(), path)?;
    fs::sync_names(&folder)
}

fn text_of<'a>(lines: impl Iterator<Item = &'a Line>) -> String {
    lines.map(|line| format!("{}\n", line.text)).collect()
}

pub(super) fn parted(campaign: &Path, detail: String) -> StoreError {
    StoreError::Parted {
        path: campaign.join(DATABASE),
        detail,
    }
}
