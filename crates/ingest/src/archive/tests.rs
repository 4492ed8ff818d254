//! Tests of the archive.

use super::*;

fn archive() -> (tempfile::TempDir, Archive) {
    let folder = tempfile::tempdir().unwrap();
    let archive = Archive::new(folder.path());
    (folder, archive)
}

#[test]
fn the_hash_is_blake3() {
    // The published test vector for the empty input.
    assert_eq!(
        hash(b""),
        "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262"
    );
}

#[test]
fn bytes_are_stored_once_and_read_back() {
    let (folder, archive) = archive();
    let (first, outcome) = archive.store(b"readings", Path::new("runs/A.CSV")).unwrap();
    assert_eq!(outcome, Outcome::Written);
    assert_eq!(
        first.path,
        format!("archive/{}/{}.csv", &first.hash[..2], first.hash)
    );
    let (second, outcome) = archive.store(b"readings", Path::new("b.txt")).unwrap();
    assert_eq!((second, outcome), (first.clone(), Outcome::AlreadyThere));
    assert_eq!(archive.read(&first.hash).unwrap(), b"readings");
    assert_eq!(archive.entries().unwrap(), std::slice::from_ref(&first));
    assert_eq!(fs::read(folder.path().join(&first.path)).unwrap(), b"readings");
}

#[test]
fn many_are_stored_together_and_the_same_bytes_once() {
    let (folder, archive) = archive();
    let texts: Vec<String> = (0..300).map(|k| format!("readings {}", k % 200)).collect();
    let hashes: Vec<String> = texts.iter().map(|text| hash(text.as_bytes())).collect();
    let name = |k: usize| Path::new(if k < 200 { "a.csv" } else { "a.txt" });
    let incoming: Vec<Incoming<'_>> = (0..300)
        .map(|k| Incoming {
            hash: &hashes[k],
            bytes: texts[k].as_bytes(),
            name: name(k),
        })
        .collect();
    let stored = archive.store_all(&incoming).unwrap();
    for (k, (archived, outcome)) in stored.iter().enumerate() {
        assert_eq!(archived.hash, hashes[k]);
        assert_eq!(*outcome == Outcome::Written, k < 200, "{k}");
        assert!(archived.path.ends_with(".csv"), "{k}");
        assert_eq!(
            fs::read(folder.path().join(&archived.path)).unwrap(),
            texts[k].as_bytes()
        );
    }
    assert_eq!(archive.entries().unwrap().len(), 200);
    assert_eq!(archive.remove_partial().unwrap(), 0);
    assert_eq!(archive.store_all(&[]).unwrap(), []);
}

#[test]
fn what_cannot_be_stored_leaves_no_half_file_and_no_name() {
    let (folder, archive) = archive();
    let (first, second) = (hash(b"first"), hash(b"second"));
    // A file where the folder of the second one belongs.
    fs::create_dir(folder.path().join(FOLDER)).unwrap();
    fs::write(folder.path().join(FOLDER).join(&second[..2]), "").unwrap();
    let name = Path::new("a.csv");
    let refused = archive.store_all(&[
        Incoming {
            hash: &first,
            bytes: b"first",
            name,
        },
        Incoming {
            hash: &second,
            bytes: b"second",
            name,
        },
    ]);
    assert!(refused.is_err());
    assert_eq!(archive.entries().unwrap(), []);
    assert_eq!(archive.remove_partial().unwrap(), 0);
}

#[test]
fn an_ending_that_is_no_plain_one_is_left_out() {
    for (name, expected) in [
        ("a.CSV", ".csv"),
        ("a", ""),
        ("a.b c", ""),
        ("a.abcdefghijklmnopq", ""),
        (".dta", ""),
        ("a.tar.gz", ".gz"),
        ("a.µ", ""),
    ] {
        assert_eq!(ending(Path::new(name)), expected, "{name}");
    }
}

#[test]
fn damage_is_found_and_a_wrong_size_is_repaired() {
    let (folder, archive) = archive();
    let (stored, _) = archive.store(b"readings", Path::new("a.csv")).unwrap();
    let path = folder.path().join(&stored.path);
    fs::remove_file(&path).unwrap();
    fs::write(&path, b"rEadings").unwrap();
    assert!(matches!(
        archive.read(&stored.hash),
        Err(ArchiveError::Damaged { .. })
    ));
    fs::write(&path, b"read").unwrap();
    let (again, outcome) = archive.store(b"readings", Path::new("a.csv")).unwrap();
    assert_eq!((again, outcome), (stored.clone(), Outcome::Repaired));
    assert_eq!(archive.read(&stored.hash).unwrap(), b"readings");
}

#[test]
fn what_is_not_there_or_no_hash_is_said() {
    let (_folder, archive) = archive();
    assert!(matches!(
        archive.read(&hash(b"x")),
        Err(ArchiveError::Absent { .. })
    ));
    for text in [
        "",
        "ab",
        "../../../../etc/passwd",
        &"g".repeat(64),
        &"A".repeat(64),
    ] {
        assert!(
            matches!(archive.read(text), Err(ArchiveError::NotAHash { .. })),
            "{text}"
        );
    }
    assert_eq!(archive.entries().unwrap(), []);
    assert_eq!(archive.remove_partial().unwrap(), 0);
}

#[test]
fn half_files_of_a_killed_program_are_no_entries_and_are_removed() {
    let (folder, archive) = archive();
    let (stored, _) = archive.store(b"readings", Path::new("a.csv")).unwrap();
    let partial = folder.path().join(&stored.path).with_file_name(".part-abc");
    fs::write(&partial, b"rea").unwrap();
    assert_eq!(archive.entries().unwrap().len(), 1);
    assert_eq!(archive.remove_partial().unwrap(), 1);
    assert!(!partial.exists());
    assert_eq!(archive.read(&stored.hash).unwrap(), b"readings");
}

#[test]
fn refusals_of_the_system_are_sorted() {
    let from = |code: rustix::io::Errno| sorted(Path::new("x"), "write", 5, code.into());
    assert!(matches!(
        from(rustix::io::Errno::NOSPC),
        ArchiveError::DiskFull { needed_bytes: 5, .. }
    ));
    assert!(matches!(
        from(rustix::io::Errno::DQUOT),
        ArchiveError::DiskFull { .. }
    ));
    assert!(matches!(
        from(rustix::io::Errno::FBIG),
        ArchiveError::DiskFull { .. }
    ));
    assert!(matches!(
        from(rustix::io::Errno::ACCESS),
        ArchiveError::Denied { doing: "write", .. }
    ));
    assert!(matches!(
        from(rustix::io::Errno::ROFS),
        ArchiveError::Denied { .. }
    ));
    assert!(matches!(from(rustix::io::Errno::IO), ArchiveError::Failed { .. }));
}

#[test]
fn bytes_that_changed_in_their_place_are_repaired_by_the_same_bytes() {
    let (folder, archive) = archive();
    let (stored, _) = archive.store(b"readings", Path::new("a.csv")).unwrap();
    let (other, _) = archive.store(b"others", Path::new("b.csv")).unwrap();
    let wanted = [stored.clone(), other.clone()];
    assert_eq!(archive.verify(&wanted).unwrap(), []);
    let replace = |archived: &Archived, bytes: &[u8]| {
        let path = folder.path().join(&archived.path);
        fs::remove_file(&path).unwrap();
        fs::write(path, bytes).unwrap();
    };
    // Of the same size: names and sizes do not tell, hashes do.
    replace(&stored, b"reAdings");
    assert_eq!(archive.missing(&wanted).unwrap(), []);
    let found = archive.verify(&wanted).unwrap();
    assert_eq!(found.len(), 1);
    assert!(matches!(&found[0].fault, BlobFault::Damaged { found } if *found == hash(b"reAdings")));
    let (_, outcome) = archive.store(b"readings", Path::new("a.csv")).unwrap();
    assert_eq!(outcome, Outcome::Repaired);
    assert_eq!(archive.verify(&wanted).unwrap(), []);
    replace(&other, b"other");
    fs::remove_file(folder.path().join(&stored.path)).unwrap();
    let faults: Vec<BlobFault> = archive
        .missing(&wanted)
        .unwrap()
        .into_iter()
        .map(|f| f.fault)
        .collect();
    assert_eq!(faults, [BlobFault::Missing, BlobFault::Size { found_bytes: 5 }]);
}

#[test]
fn an_archive_says_which_database_it_belongs_to() {
    let (folder, archive) = archive();
    assert_eq!(archive.owner().unwrap(), None);
    assert!(!archive.holds_anything().unwrap());
    archive.set_owner("an-id").unwrap();
    archive.set_owner("another-id").unwrap();
    assert_eq!(archive.owner().unwrap().as_deref(), Some("another-id"));
    assert!(!archive.holds_anything().unwrap());
    assert_eq!(archive.entries().unwrap(), []);
    fs::write(folder.path().join("archive/.part-x"), "left by a kill").unwrap();
    assert_eq!(archive.remove_partial().unwrap(), 1);
    archive.store(b"readings", Path::new("a.csv")).unwrap();
    assert!(archive.holds_anything().unwrap());
}
