//! The text of campaign.toml that was worked with last, `archive/campaign.toml`: what is shown while the file itself cannot be
//! read is shown by it.

use std::io::{self, Write};
use std::path::Path;

use ieap_domain::Issue;
use ieap_system::{Temporary, fs};

use super::{CampaignFileError, Loaded, from_text, read};
use crate::archive::{FOLDER, PARTIAL};

/// Where the text is kept, below the campaign.
pub const KEPT: &str = "archive/campaign.toml";

/// Code of what is said where campaign.toml cannot be read.
pub const NOT_READ: &str = "campaign-file-not-read";

/// Keeps the text that is worked with.
///
/// # Errors
/// What the system says.
pub fn keep(folder: &Path, loaded: &Loaded) -> io::Result<()> {
    let (path, text) = (folder.join(KEPT), loaded.text.as_bytes());
    if fs::read_own(&path).is_ok_and(|kept| kept == text) {
        return Ok(());
    }
    let archive = folder.join(FOLDER);
    fs::create_dir_all(&archive)?;
    let mut file = Temporary::new_in(&archive, PARTIAL, "", 0o644)?;
    file.write_all(text)?;
    file.sync_all()?;
    file.persist(&path)?;
    fs::sync_names(&archive)
}

/// What [`read`] gives; where it fails, the campaign as it was worked with last, or as one that states nothing, with the fault
/// as the first of its warnings.
pub fn or_kept(folder: &Path) -> Loaded {
    match read(folder) {
        Ok(loaded) => loaded,
        Err(error) => kept(folder, &error),
    }
}

fn kept(folder: &Path, error: &CampaignFileError) -> Loaded {
    let path = folder.join(KEPT);
    let text = fs::read_own(&path)
        .ok()
        .and_then(|bytes| String::from_utf8(bytes).ok());
    let known = text.and_then(|text| from_text(text, &path).ok());
    let shown = if known.is_some() {
        "until then the campaign is shown by the campaign.toml of the last work"
    } else {
        "until then the campaign is shown as if campaign.toml stated nothing: samples have no sizes, folders their usual names"
    };
    let mut loaded = known.unwrap_or_else(|| stating_nothing(folder, &path));
    let issue = Issue::error(NOT_READ, error.to_string()).mend(shown);
    loaded.warnings = vec![issue];
    loaded
}

/// A campaign with the name of its folder.
fn stating_nothing(folder: &Path, path: &Path) -> Loaded {
    let name = fs::canonicalize(folder).ok();
    let name = name.as_deref().and_then(Path::file_name).unwrap_or_default();
    let id = toml::Value::String(name.to_string_lossy().into_owned());
    let text = |id: &toml::Value| format!("[campaign]\nid = {id}\n");
    from_text(text(&id), path).unwrap_or_else(|_| {
        let id = toml::Value::String("campaign".to_owned());
        from_text(text(&id), path).expect("an id is all that a campaign needs")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign_file::FILE_NAME;

    fn broken(text: &str) -> (tempfile::TempDir, Loaded) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join(FOLDER)).unwrap();
        std::fs::write(
            folder.path().join(FILE_NAME),
            "[campaign]\nid = \"A\"\ntitle = \"Known\"\n",
        )
        .unwrap();
        keep(folder.path(), &read(folder.path()).unwrap()).unwrap();
        std::fs::write(folder.path().join(FILE_NAME), text).unwrap();
        let loaded = or_kept(folder.path());
        (folder, loaded)
    }

    #[test]
    fn a_file_that_cannot_be_read_is_told_and_the_last_one_stands_for_it() {
        for text in [
            "[campaign\n",
            "[campaign]\nid = 3\n",
            "\u{0}",
            "",
            "[campaign]\nid = \"B\"\n[runs]\nfolder = \"..\"\n",
        ] {
            let (_folder, loaded) = broken(text);
            assert_eq!(loaded.campaign.title, "Known", "{text:?}");
            assert_eq!(loaded.warnings[0].code, "campaign-file-not-read");
            assert!(
                loaded.warnings[0].message.contains("campaign.toml"),
                "{:?}",
                loaded.warnings
            );
        }
        let (_folder, loaded) = broken("[campaign]\nid = \"B\"\n");
        assert_eq!(loaded.campaign.id, "B");
    }

    #[test]
    fn without_a_last_one_it_states_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let campaign = folder.path().join("quoted \" and \\ name");
        std::fs::create_dir(&campaign).unwrap();
        std::fs::write(campaign.join(FILE_NAME), "x").unwrap();
        let loaded = or_kept(&campaign);
        assert_eq!(loaded.campaign.id, "quoted \" and \\ name");
        assert_eq!(loaded.campaign.runs_folder, "runs");
    }
}
