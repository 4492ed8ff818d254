//! Runs whose readings are known to be wrong are shown, hollow and with the reason, and move nothing.

use ieap::analysis::laws::facts::facts;
use ieap::analysis::monitoring::view::view;
use ieap::analysis::monitoring::{Evidence, monitor};
use ieap::domain::tag::keys;
use ieap::domain::{CurveSource, RunCurve, RunRecord, Standing};
use ieap::report::figures::canvas::Shape;
use ieap::report::pages::{Content, DrawnRun, PAGES, run_page_content};
use ieap::report::print_figures::{FigureInput, Print, figure_named};
use ieap::report::{Input, Site};
use ieap::show::Block;

use super::report_fixture::{MadeUpCurves, input, run, tag};

const REASON: &str = "its current is 1000 times what the other runs of CNaf-01 have: its unit is wrong";

/// A run at 2.5 V in air whose parameters are `factor` times those of the others, condemned.
fn condemned(index: usize, factor: f64) -> RunRecord {
    let mut run = run(index, "CNaf", 2, 2.5, 9);
    run.path = format!("runs/odd-{index}.csv");
    run.standing = Standing::Condemned {
        reason: REASON.to_owned(),
        mend: "correct the unit".to_owned(),
    };
    for parameter in &mut run.fit.as_mut().expect("fitted").parameters {
        let estimate = &mut parameter.estimate;
        for number in [
            &mut estimate.value,
            &mut estimate.standard_error,
            &mut estimate.low_95,
            &mut estimate.high_95,
        ] {
            *number = number.map(|number| factor * number);
        }
    }
    run
}

/// Two runs in every condition; and the same with two more, one a thousand times off, one by a tenth.
fn without_and_with() -> (Input, Input) {
    let without = input(&["CNaf"], 2);
    let mut with = without.clone();
    with.set_aside = vec![condemned(90, 1e-3), condemned(91, 1.1)];
    (without, with)
}

fn page(input: &Input, file: &str) -> Content {
    let page = PAGES.iter().find(|page| page.file == file).expect("a known page");
    (page.content)(&Site::new(input)).expect("its content")
}

/// Takes what is said and drawn of runs set aside out of a page; gives the rest, and the sentences.
fn apart(mut content: Content) -> (Content, Vec<String>) {
    let mut said = Vec::new();
    strip(&mut content.context, &mut said);
    for svg in content.figures.values_mut() {
        while let Some(at) = svg.find(" data-aside=\"1\"") {
            let start = svg[..at].rfind('<').expect("a group");
            let end = at + svg[at..].find("</g>").expect("its end") + "</g>".len();
            svg.replace_range(start..end, "");
        }
        *svg = svg.replacen(", Set aside", "", 1);
    }
    (content, said)
}

fn strip(value: &mut serde_json::Value, said: &mut Vec<String>) {
    // On pages of blocks: the list of such runs, and what stands for them in legends.
    let is_aside = |item: &serde_json::Value| {
        item["is_aside"] == true
            || item["issues"]
                .as_array()
                .is_some_and(|all| all.iter().any(is_set_aside))
    };
    match value {
        serde_json::Value::Object(fields) => {
            said.extend(fields.remove("aside").map(|rows| rows.to_string()));
            said.extend(fields.remove("beyond").map(|text| text.to_string()));
            fields.values_mut().for_each(|field| strip(field, said));
        }
        serde_json::Value::Array(items) => {
            said.extend(
                items
                    .iter()
                    .filter(|item| is_aside(item))
                    .map(|item| item.to_string()),
            );
            items.retain(|item| !is_aside(item));
            items.iter_mut().for_each(|item| strip(item, said));
        }
        _ => {}
    }
}

fn is_set_aside(issue: &serde_json::Value) -> bool {
    let message = issue["message"].as_str();
    message.is_some_and(|message| message.starts_with("set aside for wrong readings"))
}

/// Holds that the page shows both runs, one of them beyond the axes, and is else the page without them.
fn shows_and_is_else_the_same(file: &str, (without, with): (&Input, &Input), figure: &str) {
    let shown = page(with, file);
    let svg = &shown.figures[figure];
    let groups = svg.matches("data-aside=\"1\"").count();
    assert_eq!(groups, with.set_aside.len(), "{file}: {svg}");
    assert!(
        svg.contains("data-s=\"odd-91.csv, set aside\" data-aside"),
        "{svg}"
    );
    assert!(svg.contains("data-s=\"\" data-aside"), "{file}: {svg}");
    let (rest, said) = apart(shown);
    assert_eq!(rest, page(without, file), "{file}");
    let said = said.join("\n");
    assert!(said.contains(REASON), "{said}");
    assert!(
        said.contains("Beyond the axes, at an arrow: odd-90.csv, set aside ("),
        "{said}"
    );
    assert!(
        !said.contains("\"drawn\":false") && !said.contains("not drawn here"),
        "{said}"
    );
}

#[test]
fn parameters_of_condemned_runs_stand_hollow_beside_the_others() {
    let (without, with) = without_and_with();
    let both = (&without, &with);
    for figure in [
        "rss-ohm-cm2-0",
        "voltage-rss-ohm-cm2-0",
        "environment-rss-ohm-cm2-0",
    ] {
        shows_and_is_else_the_same("parameters.html", both, figure);
    }
}

#[test]
fn a_run_in_a_condition_of_its_own_is_told_with_its_reason() {
    let (without, mut with) = without_and_with();
    with.set_aside.truncate(1);
    for tag in &mut with.set_aside[0].tags {
        if tag.key == keys::VOLTAGE_V {
            tag.value = "7".to_owned();
        }
    }
    let (rest, said) = apart(page(&with, "parameters.html"));
    assert_eq!(rest, page(&without, "parameters.html"));
    assert!(said[0].contains(REASON), "{said:?}");
}

/// Eight runs of one sample in one condition, watched.
fn watched(set_aside: Vec<RunRecord>) -> Input {
    let mut input = input(&["CNaf"], 1);
    input.runs = (0..8).map(|index| run(index, "CNaf", 2, 2.5, index)).collect();
    let facts = facts(&input.runs, &input.campaign);
    input.monitoring = monitor(Evidence {
        runs: &input.runs,
        campaign: &input.campaign,
        facts: &facts,
        doubts: &input.doubts,
    });
    input.set_aside = set_aside;
    input
}

#[test]
fn a_chart_shows_the_newest_run_at_its_edge_where_it_is_condemned() {
    let starts_at = |mut run: RunRecord, hour: u32| {
        run.tags.retain(|tag| tag.key != keys::STARTED_AT);
        let start = format!("2026-11-01T{hour:02}:30:00Z");
        run.tags.push(tag(keys::STARTED_AT, &start));
        run
    };
    let with = watched(vec![
        starts_at(condemned(90, 1e-3), 20),
        starts_at(condemned(91, 1.0), 3),
    ]);
    assert!(!with.monitoring.watched.is_empty());
    let place = |watched: &ieap::analysis::monitoring::Watched| watched.parameter == "rss_ohm_cm2";
    let number = with.monitoring.watched.iter().position(place).expect("watched");
    let site = Site::new(&with);
    let codes = view(&site.lives()).into_iter().filter_map(|block| match block {
        Block::Issues(issues) => Some(issues[0].code.clone()),
        _ => None,
    });
    assert_eq!(codes.collect::<Vec<_>>(), ["set-aside"]);
    let figure = format!("chart-{}", number + 1);
    shows_and_is_else_the_same("monitoring.html", (&watched(vec![]), &with), &figure);
}

/// Curves of runs that are set aside, `1` times those of the others.
struct Scaled(MadeUpCurves, f64);

impl CurveSource for Scaled {
    fn curves(&self, run_id: i64) -> Result<Vec<RunCurve>, String> {
        let mut curves = self.0.curves(run_id)?;
        if run_id > 90 {
            for curve in &mut curves {
                let all = curve.measured.iter_mut().chain(&mut curve.fitted);
                all.for_each(|value| *value *= self.1);
            }
        }
        Ok(curves)
    }
}

#[test]
fn its_own_page_has_open_dots_and_a_dashed_fit() {
    let (_, with) = without_and_with();
    let site = Site::new(&with);
    let source = MadeUpCurves::of(&with);
    let odd = with.runs.len();
    let drawn = |run: usize| DrawnRun {
        failed: None,
        run,
        curves: source.curves(with.record(run).id).expect("curves"),
        climate: vec![],
    };
    let page = run_page_content(&site, site.page_of_run(odd), &[drawn(odd)]).expect("its content");
    let figure = &page.figures["0-current-step"];
    assert_eq!(figure.matches("data-aside=\"1\"").count(), 3, "{figure}");
    assert!(figure.contains("dots dot-k-muted-o"), "{figure}");
    let said = page.context.to_string();
    assert!(
        said.contains("Open dots and dashed lines") && said.contains(REASON),
        "{said}"
    );
    // A run that results are made from is drawn as ever.
    let first: Vec<DrawnRun> = site.run_pages[0].runs.iter().map(|&run| drawn(run)).collect();
    let page = run_page_content(&site, 0, &first).expect("its content");
    assert!(page.figures.values().all(|svg| !svg.contains("data-aside")));
}

fn print(input: &Input, name: &str, factor: f64) -> Print {
    let site = Site::new(input);
    let curves = Scaled(MadeUpCurves::of(input), factor);
    let figure = figure_named(name).expect("a known figure");
    let input = FigureInput {
        parameter: None,
        site: &site,
        curves: &curves,
        run: None,
    };
    figure.print(&input, 170.0).expect("drawn")
}

/// Texts of a print, the notes under its panels last.
fn texts(print: &Print) -> Vec<String> {
    let text = |shape: &Shape| match shape {
        Shape::Text(label) => Some(label.text.clone()),
        _ => None,
    };
    print.drawing.shapes.iter().filter_map(text).collect()
}

fn rings(print: &Print) -> usize {
    let is_ring = |shape: &&Shape| matches!(shape, Shape::Ring { .. });
    print.drawing.shapes.iter().filter(is_ring).count()
}

#[test]
fn prints_show_them_open_and_dashed_and_say_why() {
    let (without, with) = without_and_with();
    for name in ["figure22", "figure23", "figure26"] {
        for factor in [1.0, 1e6] {
            let (plain, shown) = (print(&without, name, factor), print(&with, name, factor));
            let (plain_texts, mut shown_texts) = (texts(&plain), texts(&shown));
            let notes: Vec<String> = shown_texts
                .iter()
                .filter(|text| !plain_texts.contains(text))
                .cloned()
                .collect();
            let said = notes.join(" ");
            assert!(said.contains("its unit is wrong"), "{name}: {said}");
            let is_drawn = name == "figure26" || factor == 1.0;
            let expected = if is_drawn {
                "in no result: odd-9"
            } else {
                "Set aside, mostly outside the axes: odd-9"
            };
            assert!(said.contains(expected), "{name}, {factor}: {said}");
            assert_eq!(rings(&shown) > rings(&plain), is_drawn, "{name}, {factor}");
            // Ticks, titles and legend are those without them.
            shown_texts.retain(|text| plain_texts.contains(text));
            assert_eq!(shown_texts, plain_texts, "{name}");
        }
    }
}
