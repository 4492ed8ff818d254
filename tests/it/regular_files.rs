//! Pipes, devices and links in the place of a campaign's own files: no verb waits for them, and nobody's file is changed.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::campaign::{CampaignFolder, command, ieap, run_table};

/// Time after which a verb is taken to wait for ever: many times what one takes.
const PATIENCE: Duration = Duration::from_secs(60);

/// A campaign with everything that stands in files, and a backup of it.
fn campaign(elsewhere: &Path) -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder.write("runs/a.csv.toml", "cycle = 2\n");
    folder.write("runs/plan.csv", "planned,file,note\nP01,b,as planned\n");
    folder.write("runs/other.csv", "date\n3/4/2026\n");
    folder.write(
        "profiles/lab.toml",
        "[profile]\nversion = 1\n\n[recognise]\nname = \"*.lab\"\n\n[layout]\nseparator = \"semicolon\"\ndecimal = \"point\"\nheader_line = 1\n\n\
         [time]\nbase = \"epoch\"\ncolumn = \"t\"\nunit = \"ms\"\n\n[[column]]\ncolumn = \"d\"\nquantity = \"current\"\nunit = \"A\"\n",
    );
    // runs/other.csv has a date that may be of two days.
    folder.ieap(&["run", "--no-diagnose"]).expect(3);
    folder.ieap(&["tag", "runs/b.csv", "note=by hand"]).expect(0);
    let backup = elsewhere.join("backup");
    folder.ieap(&["backup", backup.to_str().unwrap()]).expect(0);
    folder
}

/// Whether it ends; what is left of it is ended.
fn ends(folder: &Path, arguments: &[&str]) -> bool {
    let mut command = command(folder, arguments);
    let quiet = command
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null());
    let mut child = quiet.spawn().unwrap();
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let _ = child.kill();
    let _ = child.wait();
    false
}

/// What is put in the place of a file.
const IN_ITS_PLACE: [&str; 3] = ["a pipe", "a link to a device", "a link to a file"];

fn put(what: &str, path: &Path, theirs: &Path) {
    use std::os::unix::fs::symlink;
    match what {
        "a pipe" => rustix::fs::mkfifoat(rustix::fs::CWD, path, rustix::fs::Mode::RWXU).unwrap(),
        "a link to a device" => symlink("/dev/zero", path).unwrap(),
        _ => symlink(theirs, path).unwrap(),
    }
}

/// A raw file of the campaign's archive, relative to the campaign. A backup has it in the same place, and keeps it as long as
/// the archive does: other bytes of a backup, its journals above all, go with the last list that names them.
fn raw_file(campaign: &Path) -> PathBuf {
    let mut folders: Vec<PathBuf> = std::fs::read_dir(campaign.join("archive"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    folders.sort();
    let first = folders.into_iter().find(|path| path.is_dir()).unwrap();
    let path = std::fs::read_dir(first).unwrap().next().unwrap().unwrap().path();
    path.strip_prefix(campaign).unwrap().to_owned()
}

/// Moves a file; where it cannot be moved the panic names it.
#[track_caller]
fn rename(from: &Path, to: &Path) {
    std::fs::rename(from, to)
        .unwrap_or_else(|error| panic!("{} to {}: {error}", from.display(), to.display()));
}

#[test]
fn no_verb_waits_for_what_stands_in_the_place_of_an_own_file_or_changes_it() {
    let elsewhere = tempfile::tempdir().unwrap();
    let folder = campaign(elsewhere.path());
    let backup = elsewhere.path().join("backup");
    let theirs = elsewhere.path().join("precious");
    let text = "first line\nlast line without an end";
    std::fs::write(&theirs, text).unwrap();
    let own = [
        "campaign.toml",
        "profiles/lab.toml",
        "runs/tags.toml",
        "runs/a.csv.toml",
        "runs/a.csv",
        "runs/plan.csv",
        "campaign.db",
        "campaign.db.lock",
        "archive/journal.jsonl",
        "archive/database-id",
        "report/.made-from",
        "report/.written",
        "report/index.html",
    ];
    let paths = own.iter().map(|name| folder.join(name));
    let raw = raw_file(folder.path());
    let paths: Vec<PathBuf> = paths
        .chain([
            folder.path().join(&raw),
            backup.join(&raw),
            backup.join("backup.json"),
        ])
        .collect();
    let backup_to = backup.to_str().unwrap();
    let verbs: [&[&str]; 5] = [
        &["tag", "runs/b.csv", "note=again"],
        &["run", "--no-diagnose"],
        &["verify"],
        &["status"],
        &["backup", backup_to],
    ];
    for path in &paths {
        let kept = elsewhere.path().join("kept");
        rename(path, &kept);
        for what in IN_ITS_PLACE {
            put(what, path, &theirs);
            for verb in verbs {
                assert!(
                    ends(folder.path(), verb),
                    "{verb:?} waits for {what}: {}",
                    path.display()
                );
                assert_eq!(
                    std::fs::read_to_string(&theirs).unwrap(),
                    text,
                    "{verb:?}, {}",
                    path.display()
                );
            }
            std::fs::remove_file(path).unwrap_or_else(|error| panic!("{what}, {}: {error}", path.display()));
        }
        rename(&kept, path);
    }
    // All is as it was.
    folder.ieap(&["tag", "runs/b.csv", "note=after"]).expect(0);
    assert!([0, 3].contains(&folder.ieap(&["run", "--no-diagnose"]).status));
    folder.ieap(&["verify"]).expect(0);
    assert!([0, 3].contains(&ieap(elsewhere.path(), &["restore", "backup", "new"]).status));
}

#[test]
fn what_stands_in_the_place_of_a_file_is_said() {
    let elsewhere = tempfile::tempdir().unwrap();
    let folder = campaign(elsewhere.path());
    let theirs = elsewhere.path().join("precious");
    std::fs::write(&theirs, "mine").unwrap();
    for (name, verb, status) in [
        ("campaign.toml", "status", 3),
        ("campaign.db", "status", 4),
        ("archive/journal.jsonl", "verify", 4),
        ("archive/database-id", "run", 4),
    ] {
        let (path, kept) = (folder.join(name), elsewhere.path().join("kept"));
        rename(&path, &kept);
        put("a pipe", &path, &theirs);
        let told = folder.ieap(&[verb]).expect(status);
        let said = format!("{}{}", told.stdout, told.stderr);
        assert!(
            said.contains(name) && said.contains("a regular file is needed"),
            "{name}: {said}"
        );
        std::fs::remove_file(&path).unwrap();
        rename(&kept, &path);
    }
}

/// Puts a link in the place of a file, whose content is then elsewhere.
fn replaced_by_link(path: &Path, target: &Path) {
    std::fs::create_dir_all(target.parent().unwrap()).unwrap();
    rename(path, target);
    std::os::unix::fs::symlink(target, path).unwrap();
}

fn put_back(path: &Path, target: &Path) {
    std::fs::remove_file(path).unwrap();
    rename(target, path);
}

#[test]
fn a_statement_may_be_a_link_to_a_file_of_the_campaign() {
    let elsewhere = tempfile::tempdir().unwrap();
    let folder = campaign(elsewhere.path());
    for name in ["campaign.toml", "runs/tags.toml", "profiles/lab.toml"] {
        let (path, shared) = (folder.join(name), folder.join("shared/one"));
        replaced_by_link(&path, &shared);
        let run = folder.ieap(&["run", "--no-diagnose"]);
        assert!([0, 3].contains(&run.status), "{name}: {run:#?}");
        assert!(!run.stderr.contains("a link"), "{name}: {run:#?}");
        put_back(&path, &shared);
    }
}

/// A campaign of somebody else must not put a file of its reader on a page, or into a backup.
#[test]
fn a_statement_that_is_a_link_out_of_the_campaign_is_refused_with_its_name_and_target() {
    let elsewhere = tempfile::tempdir().unwrap();
    let folder = campaign(elsewhere.path());
    folder.write("runs/c.csv", run_table(3));
    let shared = elsewhere.path().canonicalize().unwrap().join("shared");
    for (name, status) in [
        ("campaign.toml", 2),
        ("profiles/lab.toml", 3),
        ("runs/tags.toml", 3),
        ("runs/a.csv.toml", 3),
        ("runs/plan.csv", 3),
    ] {
        let path = folder.join(name);
        replaced_by_link(&path, &shared);
        let run = folder.ieap(&["run", "--no-diagnose"]).expect(status);
        for said in [name, "a link", shared.to_str().unwrap(), "outside of"] {
            assert!(run.stderr.contains(said), "{name}, {said}: {run:#?}");
        }
        put_back(&path, &shared);
    }
}

#[test]
fn no_value_and_no_byte_of_a_file_behind_a_link_comes_in() {
    let elsewhere = tempfile::tempdir().unwrap();
    let secret = elsewhere.path().join("secret.toml");
    std::fs::write(&secret, "sample = \"S1\"\nnote = \"TOPSECRET\"\n").unwrap();
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    std::fs::remove_file(folder.join("runs/tags.toml")).unwrap();
    let links = [
        "runs/tags.toml",
        "runs/a.csv.toml",
        "tags.toml",
        "profiles/lab.toml",
    ];
    std::fs::create_dir(folder.join("profiles")).unwrap();
    for link in &links[..3] {
        std::os::unix::fs::symlink(&secret, folder.join(link)).unwrap();
    }
    // So do the files of a folder that is a link.
    std::fs::create_dir_all(elsewhere.path().join("own")).unwrap();
    std::fs::write(elsewhere.path().join("own/overview.html"), "TOPSECRET").unwrap();
    std::os::unix::fs::symlink(elsewhere.path().join("own"), folder.join("own")).unwrap();
    let stated = std::fs::read_to_string(folder.join("campaign.toml")).unwrap();
    folder.write(
        "campaign.toml",
        format!("{stated}\n[report]\ntemplates = \"own\"\n"),
    );
    let run = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(
        run.stderr.contains("own/overview.html: a link leads to"),
        "{run:#?}"
    );
    std::os::unix::fs::symlink(&secret, folder.join(links[3])).unwrap();
    let refused = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(!refused.stderr.contains("TOPSECRET"), "{refused:#?}");
    std::fs::remove_file(folder.join(links[3])).unwrap();
    let backup = elsewhere.path().join("backup");
    let made = folder.ieap(&["backup", backup.to_str().unwrap()]).expect(3);
    for link in &links[..3] {
        let said = format!("{}{}", made.stdout, made.stderr);
        assert!(said.contains(&format!("{link}: a link leads to")), "{made:#?}");
    }
    for place in [
        folder.join("report"),
        folder.join("archive"),
        backup,
        folder.join("campaign.db"),
    ] {
        assert!(!holds(&place, b"TOPSECRET"), "{}", place.display());
    }
}

/// Whether a file, or one below a folder, has these bytes in it.
fn holds(place: &Path, bytes: &[u8]) -> bool {
    if place.is_dir() {
        let mut entries = std::fs::read_dir(place).unwrap();
        return entries.any(|entry| holds(&entry.unwrap().path(), bytes));
    }
    let found = std::fs::read(place).unwrap();
    found.windows(bytes.len()).any(|window| window == bytes)
}
