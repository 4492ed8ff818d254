//! The thesis's table 4: complex modulus before and after a humidity step, one row a material and step.

use super::TableInput;
use super::of_several::{Contribution, combined, pooled_where};
use crate::dma::sheet::STEP;
use ieap_domain::modulus::step_keys;
use ieap_domain::tag::keys;
use ieap_domain::{ModulusLog, ModulusStep};
use ieap_show::quantities::{MATERIAL, Quantity, SAMPLES};
use ieap_show::{Combined, Content, Sheet, Source, SourceOrigin, Table};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// The first numbers of a step.
const SHOWN: &[Quantity] = STEP.split_at(6).0;
const NUMBER: Quantity = Quantity::plain("step", "Step", "number of the humidity step in the log");
const LOGS: Quantity = Quantity::plain("logs", "Logs", "number of modulus logs");
/// Humidities that agree when rounded to this step (percentage points) are one step of the programme.
const HUMIDITY_STEP_PERCENT: f64 = 5.0;

/// Steps of the same programme on the same material.
struct Alike<'a> {
    material: String,
    ordinal: usize,
    humidity: (i64, i64),
    steps: Vec<(&'a ModulusLog, &'a ModulusStep)>,
}

/// Makes the table.
pub fn make(input: &TableInput) -> Table {
    Sheet::<Alike>::new(
        "table4",
        "Complex modulus of elasticity before and after changes of the humidity",
        2,
    )
    .said([pooled_where("a step was logged several times")])
    .called(Alike::label)
    .made_from(|of| of.logs().map(source).collect())
    .column(MATERIAL, |of| of.material.clone())
    .column(NUMBER, |of| of.ordinal + 1)
    .columns(SHOWN, Alike::number)
    .column(SAMPLES, |of| {
        let samples: BTreeSet<_> = of.logs().map(|log| log.run.tag(keys::SAMPLE)).collect();
        samples.len()
    })
    .column(LOGS, |of| of.steps.len())
    .over(alike(input))
}

/// Steps by material, place in the log and humidities, in the order of the logs.
fn alike<'a>(input: &TableInput<'a>) -> Vec<Alike<'a>> {
    let mut groups: Vec<Alike> = Vec::new();
    for log in input.modulus_logs {
        let sample = log.run.tag(keys::SAMPLE);
        let known = sample.and_then(|id| input.campaign.sample(id));
        let material = known.map_or_else(
            || sample.unwrap_or("–").to_owned(),
            |known| known.material.clone(),
        );
        for (ordinal, step) in log
            .analysis
            .iter()
            .flat_map(|found| found.steps.iter().enumerate())
        {
            let level = |key| {
                let percent = step.estimate(key).and_then(|estimate| estimate.value);
                percent.map_or(-1, |percent| (percent / HUMIDITY_STEP_PERCENT).round() as i64)
            };
            let humidity = (
                level(step_keys::HUMIDITY_BEFORE),
                level(step_keys::HUMIDITY_AFTER),
            );
            let same = |group: &&mut Alike| {
                (&group.material, group.ordinal, group.humidity) == (&material, ordinal, humidity)
            };
            match groups.iter_mut().find(same) {
                Some(group) => group.steps.push((log, step)),
                None => groups.push(Alike {
                    material: material.clone(),
                    ordinal,
                    humidity,
                    steps: vec![(log, step)],
                }),
            }
        }
    }
    // Steps of one material stand together, in the order in which materials first occur.
    let materials: Vec<String> = groups.iter().map(|group| group.material.clone()).collect();
    groups.sort_by_key(|group| {
        let first = materials.iter().position(|material| *material == group.material);
        (first, group.ordinal, group.humidity)
    });
    groups
}

fn source(log: &ModulusLog) -> Source {
    Source::of(SourceOrigin::ModulusLog(log.run.id), &log.run.path)
}

impl<'a> Alike<'a> {
    fn logs(&self) -> impl Iterator<Item = &'a ModulusLog> {
        self.steps.iter().map(|(log, _)| *log)
    }

    fn label(&self) -> String {
        let (material, number) = (&self.material, self.ordinal + 1);
        match self.humidity {
            (-1, _) | (_, -1) => format!("{material}, step {number}"),
            (before, after) => {
                let percent = |level: i64| level as f64 * HUMIDITY_STEP_PERCENT;
                format!(
                    "{material}, step {number}, {} to {} % RH",
                    percent(before),
                    percent(after)
                )
            }
        }
    }

    fn number(&self, of: &Quantity) -> Combined {
        let part = |(log, step): &(&'a ModulusLog, &'a ModulusStep)| Contribution {
            origin: SourceOrigin::ModulusLog(log.run.id),
            name: &log.run.path,
            sample: log.run.tag(keys::SAMPLE),
            shared: None,
            estimate: (step.estimate(of.key).map(Cow::Borrowed))
                .ok_or_else(|| "the log has no such number".to_owned()),
        };
        let parts: Vec<Contribution> = self.steps.iter().map(part).collect();
        let all = combined(&parts, of.key);
        match all.content {
            // A humidity between steps is a mean over many readings, whose last digits nobody wants: sensors are good to a
            // percent or two.
            Content::Measured(mean) if of.unit == "%" && of.key != step_keys::RELATIVE_CHANGE => Combined {
                content: Content::Exact(mean.value.round() + 0.0),
                ..all
            },
            _ => all,
        }
    }
}
