//! Stiffness or coupling as the page shows it.

use ieap_domain::blocked::LARGEST_BENDING_RAD;
use ieap_domain::number::fixed;
use ieap_domain::{BlockedRun, Issue};
use ieap_show::quantities::{Quantity, RUN};
use ieap_show::{
    Block, Chart, Ink, Layer, Mark, Panel, Range, Sheet, Source, SourceOrigin, Table, Value, rough,
};

use super::{SampleRow, answer, sample_rows, sentences};
use crate::tables::TableInput;

/// The line on which alpha is unchanged is drawn up to this ratio, in steps that its axes can end between.
const UNCHANGED: (f64, u32) = (20.0, 800);

/// Whether stiffness or coupling is known of a sample that was measured in two conditions, or a force was measured.
pub fn is_told(input: &TableInput) -> bool {
    let is_known = |row: &SampleRow| {
        let ratios = row.change.as_ref().map(|change| &change.ratios);
        ratios.is_some_and(|own| own.stiffness.value.is_some() || own.coupling.value.is_some())
    };
    !input.blocked.is_empty() || !input.modulus_logs.is_empty() && sample_rows(input).1.iter().any(is_known)
}

/// The page, with table `stiffness`.
pub fn view(input: &TableInput, numbers: Table) -> Vec<Block> {
    let (table, rows) = sample_rows(input);
    let mut blocks = vec![Block::Say(answer(&rows))];
    blocks.extend(chart(&rows).map(Block::Chart));
    blocks.extend(sentences(&table, &rows).into_iter().map(Block::Say));
    blocks.push(Block::Table(numbers));
    if !input.blocked.is_empty() {
        blocks.push(Block::Table(held(input, &rows)));
        let issues: Vec<Issue> = (input.blocked.iter())
            .flat_map(|run| run.issues.iter().map(|issue| issue.clone().at(&run.path)))
            .collect();
        blocks.extend(Block::issues(&issues));
    }
    blocks
}

/// Coupling against stiffness, both over the reference: a halved alpha lies to the right, or below.
fn chart(rows: &[SampleRow]) -> Option<Chart> {
    type At<'a> = (&'a str, (f64, f64), [(f64, f64); 2]);
    let told: Vec<At> = (rows.iter())
        .filter_map(|row| {
            let ratios = &row.change.as_ref()?.ratios;
            let (x, y) = (&ratios.stiffness, &ratios.coupling);
            Some((
                row.sample.as_str(),
                (x.value?, y.value?),
                [(x.low_95?, x.high_95?), (y.low_95?, y.high_95?)],
            ))
        })
        .collect();
    let mut samples: Vec<&str> = Vec::new();
    for (sample, ..) in &told {
        if !samples.contains(sample) {
            samples.push(sample);
        }
    }
    let diagonal = (0..=UNCHANGED.1).map(|k| UNCHANGED.0 * f64::from(k) / f64::from(UNCHANGED.1));
    let guides = [
        Layer::guides(Mark::Upright, [1.0]),
        Layer::guides(Mark::Level, [1.0]),
        Layer::new("α unchanged", Mark::Line, Ink::Guide, diagonal.map(|at| (at, at))),
    ];
    let of_sample = |(at, sample): (usize, &&str)| {
        let own = || told.iter().filter(|(of, ..)| of == sample);
        Layer::new(*sample, Mark::Marks, Ink::Series(at), own().map(|(_, at, _)| *at))
            .with_bars(own().map(|(.., [_, bar])| *bar).collect())
            .with_bars_across(own().map(|(.., [bar, _])| *bar).collect())
    };
    let marks = samples.iter().enumerate().map(of_sample);
    let panel = Panel {
        x: Range::linear("Stiffness E I over the driest", "")
            .with(0.5)
            .with(1.5),
        y: Range::linear("Coupling μ over the driest", "")
            .with(0.5)
            .with(1.5),
        layers: guides.into_iter().chain(marks).collect(),
    };
    let caption = "Both over those of the driest condition of the same sample at the same voltage, bars 95 %. A strip that bends less per charge because it is stiffer lies to the right; because a charge pulls less, below.";
    (!told.is_empty()).then(|| Chart::new("Coupling against stiffness", vec![panel]).told(caption))
}

/// Moment per charge of a held strip.
pub(crate) const PER_CHARGE: Quantity =
    Quantity::new("mu_mn_mm_per_c", "μ", "moment per charge", "mN mm C⁻¹").shown_in("mN m C⁻¹", 1e-3);

/// Runs of held strips.
fn held(input: &TableInput, rows: &[SampleRow]) -> Table {
    const FORCE: Quantity = Quantity::new(
        "largest_force_mn",
        "Largest force",
        "reading that is largest in size",
        "mN",
    );
    // mN mm to µN m: the same number.
    const PER_VOLT: Quantity = Quantity::new(
        "moment_un_m_per_v",
        "M/V",
        "moment per volt once charged",
        "µN m V⁻¹",
    );
    const RATE: Quantity = Quantity::new("relaxation_per_s", "λ", "rate at which the moment relaxes", "s⁻¹");
    const REMARK: Quantity = Quantity::plain(
        "remark",
        "Remark",
        "how far the free strip would bend up to the sensor",
    );
    Sheet::<&BlockedRun>::new("held", "Held strips", 1)
        .remarks(
            "The moment is 2 F a / 3 with the force F on a sensor at the distance a from the clamp. It takes a moment that is even along the strip and a sensor that does not give way. It is fitted with the law of the free strip's curvature.",
            "",
        )
        .made_from(|own| vec![Source::of(SourceOrigin::Run(own.run), &own.path)])
        .column(RUN, |own| own.path.clone())
        .column(FORCE, |own| rough(own.largest_force_mn))
        .column(PER_CHARGE, |own| Value::from(&own.per_charge_mn_mm_per_c))
        .column(PER_VOLT, |own| Value::from(&own.per_volt_mn_mm_per_v))
        .column(RATE, |own| Value::from(&own.relaxation_per_s))
        .column(REMARK, |own| bends(input, rows, own))
        .over(input.blocked)
}

fn bends(input: &TableInput, rows: &[SampleRow], own: &BlockedRun) -> String {
    let run = input.runs.iter().position(|run| run.path == own.path);
    let row = rows
        .iter()
        .find(|row| run.is_some_and(|run| row.held.contains(&run)));
    match row.and_then(|row| row.free_bending_rad) {
        Some(bending) if bending > LARGEST_BENDING_RAD => format!(
            "the free strip bends by {} rad up to the sensor: beyond {} rad the moment is wrong by more than 2\u{a0}%",
            fixed(bending, 1),
            fixed(LARGEST_BENDING_RAD, 0)
        ),
        Some(_) => String::new(),
        None => "how far the strip bends when free is not known here".to_owned(),
    }
}
