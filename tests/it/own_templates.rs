//! Templates of pages that a campaign has of its own.

use crate::campaign::{CAMPAIGN_TOML, CampaignFolder, run_table};

fn folder() -> CampaignFolder {
    let folder = CampaignFolder::new();
    folder.write(
        "campaign.toml",
        format!("{CAMPAIGN_TOML}[report]\ntemplates = \"looks\"\n"),
    );
    folder.write("runs/1.csv", run_table(1));
    folder.write(
        "looks/blocks/say.html",
        "<p class=\"ours\">{{ block.text }}</p>\n",
    );
    folder
}

#[test]
fn a_template_of_the_campaigns_own_takes_the_place_of_ours() {
    let folder = folder();
    folder.ieap(&["run", "--no-diagnose", "--quiet"]).expect(0);
    let page = folder.report("climate.html");
    assert!(
        page.contains("<p class=\"ours\">No climate log was found"),
        "{page}"
    );
    // The same templates are the same report; another one is another.
    let again = |folder: &CampaignFolder| folder.ieap(&["report", "--json"]).expect(0).json();
    assert_eq!(again(&folder)["report"]["rendered"], false);
    folder.write("looks/page.html", "<h1>Mine: {{ page_title }}</h1>\n");
    assert_eq!(again(&folder)["report"]["rendered"], true);
    assert_eq!(folder.report("climate.html").trim(), "<h1>Mine: Climate</h1>");
    // Taken away, ours stands there again.
    std::fs::remove_dir_all(folder.join("looks/blocks")).unwrap();
    std::fs::remove_file(folder.join("looks/page.html")).unwrap();
    again(&folder);
    assert!(
        folder
            .report("climate.html")
            .contains("<p>No climate log was found")
    );
}

#[test]
fn a_name_that_no_template_has_and_one_that_is_broken_are_told_and_ours_stand() {
    let folder = folder();
    folder.write("looks/blocks/tabel.html", "");
    folder.write("looks/page.html", "{% for %}");
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(
        ended
            .stderr
            .contains("looks/blocks/tabel.html: no template has this name")
            && ended.stderr.contains("looks/page.html: "),
        "{}",
        ended.stderr
    );
    let page = folder.report("climate.html");
    assert!(
        page.contains("<h1>Climate</h1>") && page.contains("class=\"ours\""),
        "{page}"
    );
    std::fs::remove_dir_all(folder.join("looks")).unwrap();
    let ended = folder.ieap(&["report"]).expect(3);
    assert!(ended.stderr.contains("looks/: "), "{}", ended.stderr);
}

#[test]
fn a_template_that_goes_on_without_end_costs_its_page_and_nothing_else() {
    let folder = folder();
    let long = "x".repeat(10_000);
    let endless = format!(
        "{{% for a in range(end=90000) %}}{{% for b in range(end=90000) %}}{long}{{% endfor %}}{{% endfor %}}"
    );
    folder.write("looks/blocks/say.html", endless);
    let ended = folder.ieap(&["run", "--no-diagnose"]).expect(3);
    assert!(ended.stderr.contains("climate.html"), "{}", ended.stderr);
    let page = folder.report("climate.html");
    assert!(page.contains("more than 64 MB"), "{page}");
    assert!(folder.report("style.css").len() > 100);
}
