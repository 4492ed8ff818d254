//! What pages show of the electrodes' resistance over the life of the samples.

use ieap_domain::quantiles::NORMAL_95_ROUNDED;
use ieap_show::{Block, Chart, Ink, Layer, Mark, Panel, Range};

use super::{Course, ProbeReading, cracks, life};
use crate::monitoring::charts::trend;

/// A part of its own, cracks first; none without readings of a probe.
pub fn view(courses: &[Course]) -> Option<Block> {
    let found = courses.iter().flat_map(|course| {
        let sample = &course.series.sample;
        let cracks = cracks(course).into_iter();
        cracks.map(move |crack| Block::say(format!("Electrodes of {sample}: {crack}")))
    });
    let mut blocks: Vec<Block> = found.collect();
    if blocks.is_empty() {
        blocks.push(Block::say("No crack of an electrode is seen by the probe."));
    }
    blocks.extend(courses.iter().map(|course| match chart(course) {
        Some(chart) => Block::Chart(chart),
        None => Block::Say(life(course)),
    }));
    blocks.push(Block::say(
        "Resistance of both electrodes along the strip by the four-point probe, bars 95\u{202f}%; a dashed line is a crack. The \
         same as a table: `ieap table electrodes`",
    ));
    (!courses.is_empty()).then(|| Block::part("Electrodes", blocks))
}

/// The readings of a sample with their trend and cracks; none where all stand at one moment.
fn chart(course: &Course) -> Option<Chart> {
    let (series, study) = (&course.over_days, &course.study);
    if study.span.length() <= 0.0 {
        return None;
    }
    let bar = |reading: &ProbeReading| {
        let reach = NORMAL_95_ROUNDED * reading.error_ohm_per_sq.unwrap_or(0.0);
        (reading.ohm_per_sq - reach, reading.ohm_per_sq + reach)
    };
    let readings = &course.series.readings;
    let points = series
        .x
        .iter()
        .zip(readings)
        .map(|(x, reading)| (*x, reading.ohm_per_sq));
    let marks =
        Layer::new("Readings", Mark::Marks, Ink::FIRST, points).with_bars(readings.iter().map(bar).collect());
    let crack = |&(at, _): &(usize, f64)| 0.5 * (series.x[at.saturating_sub(1)] + series.x[at]);
    let mut layers = vec![Layer::guides(Mark::Upright, course.cracks.iter().map(crack))];
    layers.extend(trend(series, study, f64::exp));
    layers.push(marks);
    let panel = Panel {
        x: Range::linear("Days since the first reading", ""),
        y: Range::linear("Electrode resistance", "Ω/sq"),
        layers,
    };
    Some(Chart::new(course.series.sample.as_str(), vec![panel]).told(life(course)))
}
