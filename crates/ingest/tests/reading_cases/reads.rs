//! Reading a file, and what may come of it.

use ieap_domain::{Channel, Quantity};
use ieap_ingest::formats::{ReadContext, ReadError, read};
use ieap_ingest::table::{Answers, Question};
use ieap_ingest::{Reading, RunTable};
use jiff::Timestamp;

/// What is read where nobody answered anything.
pub fn of(name: &str, bytes: impl AsRef<[u8]>) -> Reading {
    read(name, bytes.as_ref(), &ReadContext::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// What is read with one answer.
pub fn answered(name: &str, text: &str, key: &str, answer: &str) -> Reading {
    let mut answers = Answers::default();
    answers.add(key, answer).unwrap();
    let context = ReadContext {
        answers,
        ..ReadContext::default()
    };
    read(name, text.as_bytes(), &context).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The refusal of a file.
pub fn refused(name: &str, bytes: impl AsRef<[u8]>) -> ReadError {
    read(name, bytes.as_ref(), &ReadContext::default()).expect_err(name)
}

/// Asserts that a person is asked that, with these answers.
pub fn is_asked(name: &str, text: &str, key: &str, answers: &[&str]) {
    let error = refused(name, text);
    let ReadError::Asked(Question {
        key: found,
        answers: ways,
        ..
    }) = &error
    else {
        panic!("{name}: expected a question, found {}: {error}", error.code())
    };
    let ways: Vec<&str> = ways.iter().map(|(answer, _)| answer.as_str()).collect();
    assert_eq!((error.code(), *found), ("asked", key), "{name}: {error}");
    for answer in answers {
        assert!(ways.contains(answer), "{name}: {answer} is not among {ways:?}");
    }
}

/// The one table of a reading.
pub fn only_table(reading: &Reading) -> &RunTable {
    let [table] = reading.tables.as_slice() else {
        let names: Vec<&str> = reading.tables.iter().map(|table| table.name.as_str()).collect();
        panic!("expected one table, found {names:?}")
    };
    table
}

/// The one channel of a quantity.
pub fn only_channel(table: &RunTable, quantity: Quantity) -> &Channel {
    let is_it = |channel: &&Channel| channel.quantity == quantity;
    let found: Vec<&Channel> = table.channels.iter().filter(is_it).collect();
    let [channel] = found.as_slice() else {
        panic!(
            "expected one {quantity:?}, found {} in {:?}",
            found.len(),
            table.columns()
        )
    };
    channel
}

/// Asserts that the reading tells each of these.
pub fn tells(reading: &Reading, codes: &[&str]) {
    let found: Vec<&str> = reading.issues.iter().map(|issue| issue.code.as_str()).collect();
    for code in codes {
        assert!(found.contains(code), "{code} is not among {found:?}");
    }
}

/// The date that a file starts with on its own clock.
pub fn local_start(reading: &Reading) -> Option<&str> {
    reading.started_at.as_ref()?.local.as_deref()
}

/// The moment at which a file starts, where it tells the offset from UTC.
pub fn moment_of_start(reading: &Reading) -> Option<Timestamp> {
    let start = reading.started_at.as_ref()?;
    let text = format!("{}{}", start.local.as_deref()?, start.offset.as_deref()?);
    Some(text.parse().unwrap())
}
