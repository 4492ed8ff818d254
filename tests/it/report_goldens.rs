//! What the pages say, as text: goldens of the contexts that the templates print.

use ieap::domain::CurveSource;
use ieap::report::pages::{Content, DrawnRun, PAGES, finding_content, run_page_content};
use ieap::report::{Input, Site};
use serde_json::Value;

use super::climate_fixture::climate_input;
use super::findings_fixture::input_with_findings;
use super::page_outline::outline;
use super::report_fixture::{MadeUpCurves, current_only_input, frequency_runs, troubled_input};

fn page(input: &Input, file: &str) -> Value {
    let page = PAGES.iter().find(|page| page.file == file).expect("a known page");
    (page.content)(&Site::new(input)).expect("its content").context
}

/// The page on which a run stands.
fn page_of_run(input: &Input, run: usize) -> Content {
    let site = Site::new(input);
    let source = MadeUpCurves::of(input);
    let page = site.page_of_run(run);
    let drawn = |&run: &usize| DrawnRun {
        failed: None,
        run,
        curves: source.curves(input.runs[run].id).expect("curves"),
        climate: vec![],
    };
    let drawn: Vec<DrawnRun> = site.run_pages[page].runs.iter().map(drawn).collect();
    run_page_content(&site, page, &drawn).expect("its content")
}

/// A run on its page.
fn run_section(input: &Input, run: usize) -> Value {
    let name = Site::new(input).run_name(run).to_owned();
    let page = page_of_run(input, run).context;
    let sections = page["runs"].as_array().expect("runs").iter();
    sections
        .into_iter()
        .find(|section| section["name"] == name.as_str())
        .expect("the run")
        .clone()
}

#[test]
fn overview_of_a_troubled_campaign() {
    insta::assert_snapshot!(outline(&page(&troubled_input(), "index.html")));
}

#[test]
fn frequency_response_of_a_chirp_and_a_sine() {
    let mut input = troubled_input();
    input.frequency = frequency_runs(&input);
    insta::assert_snapshot!("frequency", outline(&page(&input, "frequency.html")));
}

#[test]
fn marks_against_a_covariate_know_their_runs() {
    let input = troubled_input();
    let against = PAGES
        .iter()
        .find(|page| page.file == "parameters.html")
        .expect("a page");
    let figures = (against.content)(&Site::new(&input))
        .expect("its content")
        .figures;
    let figure = &figures["environment-r1-ohm-cm2-0"];
    assert!(figure.contains(" data-r=\""), "{figure}");
}

#[test]
fn parameters_of_a_troubled_campaign() {
    insta::assert_snapshot!(outline(&page(&troubled_input(), "parameters.html")));
}

#[test]
fn overview_and_parameters_of_a_campaign_with_currents_only() {
    let input = current_only_input();
    insta::assert_snapshot!("current_only_overview", outline(&page(&input, "index.html")));
    insta::assert_snapshot!(
        "current_only_parameters",
        outline(&page(&input, "parameters.html"))
    );
}

#[test]
fn runs_fitted_revised_hostile_and_untagged() {
    let input = troubled_input();
    insta::assert_snapshot!("run_not_converged", outline(&run_section(&input, 0)));
    insta::assert_snapshot!("run_revised", outline(&run_section(&input, 2)));
    insta::assert_snapshot!("run_hostile", outline(&run_section(&input, 18)));
    insta::assert_snapshot!("run_untagged", outline(&page_of_run(&input, 19).context));
}

#[test]
fn runs_of_a_group_stand_side_by_side_and_share_what_they_have_in_common() {
    let input = troubled_input();
    let mut page = page_of_run(&input, 0).context;
    let runs = page["runs"].as_array_mut().expect("runs");
    assert_eq!(runs.len(), 3);
    runs.truncate(1);
    insta::assert_snapshot!("runs_of_a_group", outline(&page));
}

#[test]
fn findings_of_a_campaign_and_of_its_groups() {
    let input = input_with_findings();
    insta::assert_snapshot!("findings", outline(&page(&input, "findings.html")));
    insta::assert_snapshot!(
        "findings_none",
        outline(&page(&current_only_input(), "findings.html"))
    );
    for (place, verdict) in ["named", "names", "right", "data_problem", "differs"]
        .into_iter()
        .enumerate()
    {
        let content = finding_content(&Site::new(&input), place).expect("its content");
        insta::assert_snapshot!(format!("finding_{verdict}"), outline(&content.context));
        assert_eq!(
            content.figures.contains_key("law-1"),
            ["named", "names"].contains(&verdict)
        );
    }
}

#[test]
fn climate_of_three_sensors_and_of_a_run() {
    let input = climate_input();
    insta::assert_snapshot!("climate", outline(&page(&input, "climate.html")));
    insta::assert_snapshot!("climate_of_a_run", outline(&run_section(&input, 6)["climate"]));
    insta::assert_snapshot!(
        "climate_without_logs",
        outline(&page(&troubled_input(), "climate.html"))
    );
}
