//! The pages. A page is one file here, one template, and one row in [`PAGES`]; navigation follows from the list.

pub mod against;
mod answers;
pub mod comparison;
mod estimates;
pub mod finding;
mod finding_alone;
mod finding_answer;
mod finding_differs;
mod finding_effect;
mod finding_gain;
mod finding_law;
mod finding_posterior;
pub mod finding_words;
pub mod findings;
pub mod index;
mod needs;
mod page;
pub mod parameters;
pub(crate) mod policy;
pub mod residuals;
pub mod run;
pub mod run_clocks;
mod run_condition;
mod run_evidence;
pub mod run_figures;
pub mod run_fit;
mod run_overlay;
pub mod run_page;
pub mod run_tables;
mod run_tags;
mod runs_table;
pub mod strip;
pub mod wording;

use super::blocks;
use super::input::Input;
use ieap_analysis::{
    along, climate, dma, files, frequency, impedance, methods, models_compared, monitoring, plan, stiffness,
    study, tables,
};
use ieap_domain::RunRecord;
use ieap_domain::fault::caught;

pub use finding::content as finding_content;
pub use page::{Content, Page};
pub use run::DrawnRun;
pub use run_page::{Outline, content as run_page_content, drawn_content};
pub use runs_table::{listed, numbers};
pub use strip::content as strip_content;

const PARAMETERS: Option<&str> = Some("parameters.html");

/// Every page that a site can have once, in the order of the navigation.
pub const PAGES: &[Page] = &[
    Page {
        file: "index.html",
        title: "Overview",
        under: None,
        template: ieap_templates::INDEX,
        is_shown: |_| true,
        content: index::content,
    },
    Page {
        file: "study.html",
        title: "Study",
        under: None,
        template: ieap_templates::PAGE,
        is_shown: |input| study::view::is_told(&input.study) || !input.next_runs.is_empty(),
        content: |site| {
            let Input { study, next_runs, .. } = site.input;
            let mut shown = study::view::view(study);
            shown.extend(plan::view::view(next_runs));
            blocks::content(site, "study.html", shown)
        },
    },
    Page {
        file: "parameters.html",
        title: "Parameters",
        under: None,
        template: ieap_templates::PARAMETERS,
        is_shown: |_| true,
        content: parameters::content,
    },
    Page {
        file: "methods.html",
        title: "Methods",
        under: PARAMETERS,
        template: ieap_templates::PAGE,
        is_shown: |input| !input.runs.is_empty(),
        content: |site| {
            let Input { study, origin, .. } = site.input;
            let shown = methods::view(&site.input.of_tables(), study, &origin.program);
            blocks::content(site, "methods.html", shown)
        },
    },
    Page {
        file: "along.html",
        title: "Along the strip",
        under: PARAMETERS,
        template: ieap_templates::PAGE,
        is_shown: |input| input.runs.iter().any(RunRecord::is_along),
        content: |site| {
            let input = site.input.of_tables();
            let table3 = tables::table3::make(&input);
            blocks::content(site, "along.html", along::view::view(&input, table3))
        },
    },
    Page {
        file: "dma.html",
        title: "Modulus (DMA)",
        under: PARAMETERS,
        template: ieap_templates::PAGE,
        is_shown: |input| !input.modulus_logs.is_empty(),
        content: |site| {
            let shown = dma::view::view(&site.input.modulus_logs, &site.input.campaign);
            blocks::content(site, "dma.html", shown)
        },
    },
    Page {
        file: "stiffness.html",
        title: "Stiffness or coupling",
        under: PARAMETERS,
        template: ieap_templates::PAGE,
        is_shown: |input| stiffness::view::is_told(&input.of_tables()),
        content: |site| {
            let input = site.input.of_tables();
            let shown = stiffness::view::view(&input, tables::stiffness::make(&input));
            blocks::content(site, "stiffness.html", shown)
        },
    },
    Page {
        file: "frequency.html",
        title: "Frequency response",
        under: PARAMETERS,
        template: ieap_templates::PAGE,
        is_shown: |input| !input.frequency.is_empty(),
        content: |site| {
            let shown = frequency::view::view(&site.input.frequency, &site.input.runs);
            blocks::content(site, "frequency.html", shown)
        },
    },
    Page {
        file: "models.html",
        title: "Models compared",
        under: PARAMETERS,
        template: ieap_templates::PAGE,
        is_shown: |input| !input.comparisons.is_empty(),
        content: |site| {
            blocks::content(
                site,
                "models.html",
                models_compared::view::view(site.input.compared()),
            )
        },
    },
    Page {
        file: "impedance.html",
        title: "Impedance",
        under: PARAMETERS,
        template: ieap_templates::PAGE,
        is_shown: |input| !input.spectra.runs.is_empty(),
        content: |site| {
            let shown = impedance::view(&site.input.spectra, &site.input.campaign);
            blocks::content(site, "impedance.html", shown)
        },
    },
    Page {
        file: "findings.html",
        title: "Findings",
        under: None,
        template: ieap_templates::PAGE,
        is_shown: |_| true,
        content: findings::content,
    },
    Page {
        file: residuals::FILE,
        title: "Residuals of all runs",
        under: Some("findings.html"),
        template: ieap_templates::RESIDUALS,
        is_shown: |input| input.runs.iter().any(|run| run.fit.is_some()),
        content: residuals::content,
    },
    Page {
        file: "monitoring.html",
        title: "Monitoring",
        under: None,
        template: ieap_templates::PAGE,
        is_shown: |input| monitoring::view::is_told(&input.monitoring, &input.of_tables()),
        content: |site| {
            let shown = monitoring::view::view(&site.lives());
            blocks::content(site, "monitoring.html", shown)
        },
    },
    Page {
        file: "climate.html",
        title: "Climate",
        under: None,
        template: ieap_templates::PAGE,
        is_shown: |_| true,
        content: |site| {
            let Input {
                climate,
                campaign,
                runs,
                run_spans_s,
                ..
            } = site.input;
            let shown = climate::view::view(climate, campaign, runs, run_spans_s);
            blocks::content(site, "climate.html", shown)
        },
    },
    Page {
        file: "files.html",
        title: "Files",
        under: None,
        template: ieap_templates::PAGE,
        is_shown: |input| !input.file_stories.is_empty(),
        content: |site| blocks::content(site, "files.html", files::view(&site.input.file_stories)),
    },
];

/// The pages that a report of that input has, in the order of the navigation.
pub fn shown(input: &Input) -> Vec<&'static Page> {
    // A page that cannot say so is shown: its box tells why.
    let is_shown = |page: &&Page| caught(|| (page.is_shown)(input)).unwrap_or(true);
    PAGES.iter().filter(is_shown).collect()
}
