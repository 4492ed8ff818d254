//! Finds runs that hold the same readings, whatever their files look like.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::now;
use crate::domain::SameReadings;
use crate::ingest::same_readings::{Alike, Record, VERSION, marks};
use crate::numerics::interrupt;
use crate::pipeline::{Context, Observer, PipelineError};

/// Looks at every run that has no marks yet, against all others; gives how many pairs were found.
///
/// # Errors
/// The database refuses.
pub fn find_copies(context: &mut Context, observer: &dyn Observer) -> Result<usize, PipelineError> {
    let fresh = context.store.unmarked(VERSION)?;
    if fresh.is_empty() {
        return Ok(0);
    }
    let known = context.store.marks(VERSION)?;
    observer.begin("looking for copies", fresh.len() as u64);
    let mut all: BTreeMap<i64, Vec<u64>> = known
        .into_iter()
        .filter_map(|(id, marks)| Some((id, marks?)))
        .collect();
    let mut new = Vec::new();
    for &id in &fresh {
        interrupt::check();
        let made = marks(&context.store.channels_as_read(id)?);
        all.insert(id, made.clone());
        new.push((id, made));
        observer.advance();
    }
    let same = pairs(context, &fresh, &all)?;
    context.store.save_marks(&now(), VERSION, &new, &same)?;
    observer.end();
    // Two that hold nothing more than each other stand there twice.
    Ok(same
        .iter()
        .filter(|pair| !pair.whole || pair.run_id < pair.in_run_id)
        .count())
}

/// Pairs with one of `fresh` among them.
fn pairs(
    context: &Context,
    fresh: &[i64],
    all: &BTreeMap<i64, Vec<u64>>,
) -> Result<Vec<SameReadings>, PipelineError> {
    let (mut alike, mut records) = (Alike::of(all), Records::of(context));
    let mut same = Vec::new();
    for &id in fresh {
        interrupt::check();
        let is_new = |other: &i64| fresh.binary_search(other).is_ok();
        // Of two new ones the first looks at the second.
        let others = alike.to(id, &all[&id]);
        let mut others = others.into_iter().filter(|other| !is_new(other) || *other > id);
        others.try_for_each(|other| -> Result<(), PipelineError> {
            same.extend(compared((id, &*records.get(id)?), (other, &*records.get(other)?)));
            Ok(())
        })?;
    }
    Ok(same)
}

/// Readings that stay in memory: 64 MB with their times.
const MOST_READINGS: usize = 4 << 20;

/// Records made ready once, however many others they are held against; a bounded number of readings stays in memory.
struct Records<'a> {
    context: &'a Context,
    ready: BTreeMap<i64, Rc<Record>>,
    readings: usize,
}

impl Records<'_> {
    fn of(context: &Context) -> Records<'_> {
        Records {
            context,
            ready: BTreeMap::new(),
            readings: 0,
        }
    }

    fn get(&mut self, id: i64) -> Result<Rc<Record>, PipelineError> {
        if let Some(record) = self.ready.get(&id) {
            return Ok(record.clone());
        }
        let record = Rc::new(Record::of(&self.context.store.channels_as_read(id)?));
        if self.readings + record.len() > MOST_READINGS {
            self.ready.clear();
            self.readings = 0;
        }
        self.readings += record.len();
        self.ready.insert(id, record.clone());
        Ok(record)
    }
}

fn compared((one, of_one): (i64, &Record), (other, of_other): (i64, &Record)) -> Vec<SameReadings> {
    let pair = |run_id, in_run_id, whole| SameReadings {
        run_id,
        in_run_id,
        whole,
    };
    match (of_one.stands_in(of_other), of_other.stands_in(of_one)) {
        (true, true) => vec![pair(one, other, true), pair(other, one, true)],
        (true, false) => vec![pair(one, other, false)],
        (false, true) => vec![pair(other, one, false)],
        (false, false) => Vec::new(),
    }
}
