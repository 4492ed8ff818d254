//! Finds runs that hold the same readings, whatever their files look like.

use std::collections::BTreeMap;

use super::now;
use crate::domain::{Channel, SameReadings};
use crate::ingest::same_readings::{Alike, VERSION, marks, stands_in};
use crate::numerics::interrupt;
use crate::pipeline::{Context, Observer, PipelineError};

/// Looks at every run that has no marks yet, against all others; gives how many pairs were found.
///
/// # Errors
/// The database refuses.
pub fn find_copies(context: &mut Context, observer: &dyn Observer) -> Result<usize, PipelineError> {
    let known = context.store.marks(VERSION)?;
    let fresh: Vec<i64> = known
        .iter()
        .filter(|(_, marks)| marks.is_none())
        .map(|(id, _)| *id)
        .collect();
    if fresh.is_empty() {
        return Ok(0);
    }
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
    let mut alike = Alike::of(all);
    let mut same = Vec::new();
    for &id in fresh {
        interrupt::check();
        let is_new = |other: &i64| fresh.binary_search(other).is_ok();
        // Of two new ones the first looks at the second.
        let others = alike.to(id, &all[&id]);
        let others = others.into_iter().filter(|other| !is_new(other) || *other > id);
        let mut own: Option<Vec<Channel>> = None;
        for other in others {
            let own = match &mut own {
                Some(own) => own,
                none => none.insert(context.store.channels_as_read(id)?),
            };
            let channels = context.store.channels_as_read(other)?;
            same.extend(compared((id, own), (other, &channels)));
        }
    }
    Ok(same)
}

fn compared((one, of_one): (i64, &[Channel]), (other, of_other): (i64, &[Channel])) -> Vec<SameReadings> {
    let pair = |run_id, in_run_id, whole| SameReadings {
        run_id,
        in_run_id,
        whole,
    };
    match (stands_in(of_one, of_other), stands_in(of_other, of_one)) {
        (true, true) => vec![pair(one, other, true), pair(other, one, true)],
        (true, false) => vec![pair(one, other, false)],
        (false, true) => vec![pair(other, one, false)],
        (false, false) => Vec::new(),
    }
}
