//! Every call of a run refused once, under each error that such a call may have, and the power lost before every call.

use std::path::Path;
use std::sync::Arc;

use ieap::pipeline::upkeep::verify::Verify;
use ieap::pipeline::{
    Context, FitRuns, Ingest, PipelineError, Rebuild, RenderReport, SetTags, Silent, SpeakOfRuns, answer,
};
use ieap::store::Store;
use ieap::store::journal::Entry;
use tempfile::TempDir;

use super::computer::{Computer, Weather};
use super::{each, folder, on};
use crate::campaign::counted;

/// Most errors that a call may have.
const MOST_ERRORS: u64 = 6;

/// What a campaign of some files says when it was taken in under that weather, and then again without any; and the number
/// of calls of the first time.
fn taken_in(files: u32, weather: Weather) -> (String, u64) {
    let folder = folder();
    for k in 0..files {
        let mut table = "time_s,voltage_v,current_a,curvature_per_cm\n".to_owned();
        for step in 0..12 {
            table += &format!("{step},2,{}e-4,0.{step:02}\n", k + 1);
        }
        std::fs::write(folder.path().join(format!("runs/{k}.csv")), table).unwrap();
    }
    let computer = Arc::new(Computer::new(folder.path(), 1));
    let path = folder.path();
    let run = || -> Result<(), PipelineError> {
        let mut context = Context::open(path, false)?;
        Ingest { ready: &mut |_| true }.run(&mut context, &Silent)?;
        RenderReport::default().run(&context, &Silent).map(drop)
    };
    computer.have(weather);
    let outcome = on(&computer, run);
    let (calls, refused) = computer.calls();
    match outcome {
        None => computer.restart(),
        Some(Err(error)) => assert!(refused > 0, "refused for no reason of the system: {error}"),
        Some(Ok(())) => {}
    }
    computer.have(Weather::default());
    on(&computer, run)
        .unwrap()
        .unwrap_or_else(|error| panic!("{weather:?}: it stays refused: {error}"));
    let verified = on(&computer, || Verify::default().run(path, &Silent))
        .unwrap()
        .unwrap();
    assert!(verified.is_sound(), "{weather:?}: {verified:#?}");
    (verified.content_hash.unwrap_or_default(), calls)
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn whichever_call_fails_or_is_the_last_the_next_run_makes_it_good() {
    let files = counted(6, 50) as u32;
    let (expected, calls) = taken_in(files, Weather::default());
    // In the short form each seventh call is tried, with one of its errors by turns.
    let (step, is_long) = (counted(7, 1), counted(0, 1) == 1);
    let is_tried = |nth: u64, which: u64| is_long || which == nth % 2;
    let refused = (1..=calls)
        .step_by(step)
        .flat_map(|nth| (0..MOST_ERRORS).map(move |which| (nth, which)));
    let refused = refused
        .filter(|(nth, which)| is_tried(*nth, *which))
        .map(|(nth, which)| Weather {
            refused: Some((nth, which as usize)),
            ..Weather::default()
        });
    let lost = (1..=calls).step_by(step).map(|nth| Weather {
        power_lost_at: Some(nth),
        ..Weather::default()
    });
    let tried: Vec<Weather> = refused.chain(lost).collect();
    eprintln!("{} tries at {calls} calls of a run of {files} files", tried.len());
    let differs = |weather: Weather| (taken_in(files, weather).0 != expected).then_some(weather);
    let wrong: Vec<Weather> = each(tried.into_iter(), differs);
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Every file of a folder, copied into another.
fn copied(from: &Path, to: &Path) {
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let (path, to) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            std::fs::create_dir_all(&to).unwrap();
            copied(&path, &to);
        } else {
            std::fs::copy(&path, &to).unwrap();
        }
    }
}

/// A campaign of two runs, taken in and fitted.
fn two_runs() -> TempDir {
    let folder = folder();
    for k in 0..2 {
        let table = crate::campaign::run_table(k);
        std::fs::write(folder.path().join(format!("runs/{k}.csv")), table).unwrap();
    }
    let mut context = Context::open(folder.path(), false).unwrap();
    Ingest { ready: &mut |_| true }
        .run(&mut context, &Silent)
        .unwrap();
    FitRuns::default().run(&mut context, &Silent).unwrap();
    folder
}

/// A person drops a run and tags another under that weather; then the campaign is opened again without any. Gives the number
/// of calls.
fn spoken(campaign: &Path, weather: Weather) -> u64 {
    let folder = folder();
    let path = folder.path();
    copied(campaign, path);
    let computer = Arc::new(Computer::new(path, 1));
    let speak = || -> Result<(), PipelineError> {
        let mut context = Context::open_beside(path, false)?;
        let said_by = "ann".to_owned();
        let drop = SpeakOfRuns {
            runs: vec!["runs/0.csv".to_owned()],
            deleted: false,
            drops: true,
            why: Some("wet".to_owned()),
            said_by: said_by.clone(),
        };
        drop.run(&mut context)?;
        let tags = SetTags {
            runs: vec!["runs/1.csv".to_owned()],
            pairs: vec![("note".to_owned(), "dry".to_owned())],
            even_so: false,
            set_by: said_by,
        };
        tags.run(&mut context, &Silent).map(|_| ())
    };
    computer.have(weather);
    let outcome = on(&computer, speak);
    let (calls, refused) = computer.calls();
    match &outcome {
        None => computer.restart(),
        Some(Err(error)) => assert!(refused > 0, "refused for no reason of the system: {error}"),
        Some(Ok(())) => {}
    }
    computer.have(Weather::default());
    let opened = on(&computer, || {
        Context::open_read_only(path).map(|context| context.store.course())
    });
    let lines = opened.unwrap().unwrap().unwrap();
    let said = lines
        .iter()
        .filter(|line| matches!(line.entry, Entry::Word(_) | Entry::Tag(_)));
    let said = said.count();
    assert!(
        said == 2 || !matches!(outcome, Some(Ok(()))),
        "{weather:?}: {said} words are there"
    );
    // What was tagged shows in the run's tags at the next look.
    let look = || -> Result<_, PipelineError> {
        let mut context = Context::open(path, false)?;
        Ingest { ready: &mut |_| true }.run(&mut context, &Silent)?;
        FitRuns::default().run(&mut context, &Silent)
    };
    on(&computer, look).unwrap().unwrap();
    let verify = || Verify::default().run(path, &Silent);
    let verified = on(&computer, verify).unwrap().unwrap();
    assert!(verified.is_sound(), "{weather:?}: {verified:#?}");
    let content = || Store::open_read_only(path).unwrap().unwrap().content().unwrap();
    let before = content();
    on(&computer, || Rebuild::default().run(path, &Silent))
        .unwrap()
        .unwrap();
    assert_eq!(content().differences(&before), [], "{weather:?}");
    calls
}

/// Ended anywhere in it, or refused anything, a word is in both stores or in none.
#[test]
fn whichever_call_of_a_person_s_word_fails_or_is_the_last_both_stores_agree() {
    let campaign = two_runs();
    let path = campaign.path();
    let calls = spoken(path, Weather::default());
    let (step, errors) = (counted(3, 1), counted(1, MOST_ERRORS as usize));
    let refused = (1..=calls).flat_map(|nth| {
        (0..errors).map(move |which| Weather {
            refused: Some((nth, which)),
            ..Weather::default()
        })
    });
    let lost = (1..=calls).map(|nth| Weather {
        power_lost_at: Some(nth),
        ..Weather::default()
    });
    let tried: Vec<Weather> = refused.chain(lost).step_by(step).collect();
    eprintln!("{} tries at {calls} calls", tried.len());
    each(tried.into_iter(), |weather| Some(spoken(path, weather)));
}

/// A rebuilding of which any call fails leaves the old database, or says what the old one said.
#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn whichever_call_of_a_rebuilding_fails_no_half_database_takes_a_place() {
    let campaign = two_runs();
    let rebuilt = |weather: Weather| -> (u64, bool) {
        let folder = folder();
        let path = folder.path();
        copied(campaign.path(), path);
        let content = || Store::open_read_only(path).unwrap().unwrap().content().unwrap();
        let before = content();
        let computer = Arc::new(Computer::new(path, 1));
        computer.have(weather);
        let outcome = on(&computer, || Rebuild::default().run(path, &Silent)).unwrap();
        let (calls, refused) = computer.calls();
        assert!(
            outcome.is_ok() || refused > 0,
            "refused for no reason of the system: {outcome:?}"
        );
        computer.have(Weather::default());
        if !path.join("campaign.db").exists() {
            // Refused between the two namings: the next rebuilding puts it in place.
            assert!(outcome.is_err(), "{weather:?}");
            on(&computer, || Rebuild::default().run(path, &Silent))
                .unwrap()
                .unwrap();
        }
        if outcome.as_ref().is_ok_and(|done| done.ingest.left_out_inputs()) {
            // A file or folder could not be read, which it said, and the database has it so: the next reading takes it in. A
            // run of which a tag file could not be read says so, too.
            let store = Store::open_read_only(path).unwrap().unwrap();
            let held: Vec<String> = store
                .issues_of_code("tag-file-unreadable")
                .unwrap()
                .into_iter()
                .map(|(run, _)| run)
                .collect();
            drop(store);
            let differing = content().differences(&before);
            assert!(
                differing
                    .iter()
                    .all(|(kind, name)| *kind == "file" || *kind == "run" && held.contains(name)),
                "{weather:?}: {differing:?}"
            );
            on(&computer, || Rebuild::default().run(path, &Silent))
                .unwrap()
                .unwrap();
        }
        assert_eq!(content().differences(&before), [], "{weather:?}");
        let verify = || Verify::default().run(path, &Silent);
        let mut verified = on(&computer, verify).unwrap().unwrap();
        // The old database could not be read: what it alone may have said is asked for until a person looked.
        let asked = || -> Result<_, PipelineError> {
            let mut context = Context::open(path, false)?;
            answer(&mut context, "nothing is missing", "tester".to_owned())
        };
        if on(&computer, asked).unwrap().unwrap().len() == 1 {
            let findings = verified.parts.iter().flat_map(|part| &part.findings);
            // That the diagnosis waits is no fault: a rebuilding makes none.
            let faults = findings.filter(|found| found.code != "result-waits");
            let codes: Vec<&str> = faults.map(|found| found.code.as_ref()).collect();
            assert!(
                refused > 0 && codes == ["words-may-be-lost"],
                "{weather:?}: {verified:#?}"
            );
            verified = on(&computer, verify).unwrap().unwrap();
        }
        assert!(verified.is_sound(), "{weather:?}: {verified:#?}");
        on(&computer, || Context::open(path, false).map(drop))
            .unwrap()
            .unwrap();
        assert!(!path.join(".ieap-rebuild").exists(), "{weather:?}");
        (calls, outcome.is_ok())
    };
    let (calls, _) = rebuilt(Weather::default());
    let step = counted(5, 1);
    let tried: Vec<Weather> = (1..=calls)
        .flat_map(|nth| (0..2).map(move |which| (nth, which)))
        .step_by(step)
        .map(|refused| Weather {
            refused: Some(refused),
            ..Weather::default()
        })
        .collect();
    eprintln!("{} tries at {calls} calls", tried.len());
    let done = each(tried.into_iter(), |weather| Some(rebuilt(weather).1));
    eprintln!(
        "{} of them done all the same",
        done.iter().filter(|done| **done).count()
    );
}
