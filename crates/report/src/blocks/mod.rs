//! Blocks on a page. The templates are `templates/page.html` and one a block in `templates/blocks`.

pub mod chart;
mod table;

pub use chart::drawing;

use std::collections::BTreeMap;

use serde::Serialize;

use self::chart::Key;
use self::table::TableText;
use crate::error::ReportError;
use crate::figures::svg;
use crate::pages::Content;
use crate::pages::policy::{MOST_SECTIONS, OPEN_ISSUES};
use crate::pages::wording::IssueText;
use crate::site::Site;
use crate::slug::slugs;
use ieap_analysis::readable::readable;
use ieap_domain::Issue;
use ieap_domain::words::counted;
use ieap_show::{Block, Chart, Form};

/// Template of pages that are blocks.
pub const PAGE: &str = include_str!("../../../../templates/page.html");

/// The templates of the blocks, by the names under which the page includes them.
pub const TEMPLATES: [(&str, &str); 8] = [
    (
        "blocks/keys.html",
        include_str!("../../../../templates/blocks/keys.html"),
    ),
    (
        "blocks/all.html",
        include_str!("../../../../templates/blocks/all.html"),
    ),
    (
        "blocks/say.html",
        include_str!("../../../../templates/blocks/say.html"),
    ),
    (
        "blocks/facts.html",
        include_str!("../../../../templates/blocks/facts.html"),
    ),
    (
        "blocks/table.html",
        include_str!("../../../../templates/blocks/table.html"),
    ),
    (
        "blocks/charts.html",
        include_str!("../../../../templates/blocks/charts.html"),
    ),
    (
        "blocks/issues.html",
        include_str!("../../../../templates/blocks/issues.html"),
    ),
    (
        "blocks/runs.html",
        include_str!("../../../../templates/blocks/runs.html"),
    ),
];

#[derive(Debug, Serialize)]
struct BlocksPage {
    blocks: Vec<Item>,
}

#[derive(Debug, Serialize)]
pub(crate) struct ChartText {
    figure: String,
    title: String,
    is_wide: bool,
    keys: Vec<Key>,
    caption: String,
    /// Runs set aside that lie beyond the axes.
    #[serde(skip_serializing_if = "String::is_empty")]
    beyond: String,
}

/// A block as templates go through them, one after the other.
#[derive(Debug, Serialize)]
#[serde(rename_all = "lowercase", tag = "kind")]
pub(crate) enum Item {
    Open {
        /// Of the heading.
        level: usize,
        anchor: String,
        title: String,
    },
    Close,
    Say {
        text: String,
    },
    Facts {
        facts: Vec<(&'static str, String)>,
    },
    Table(TableText),
    /// Charts that follow each other, beside each other where the page has room.
    Charts {
        /// The legend of all of them where they share it; each has its own else.
        keys: Vec<Key>,
        /// Their caption likewise.
        caption: String,
        charts: Vec<ChartText>,
    },
    Issues {
        issues: Vec<IssueItem>,
        /// So many are not folded.
        open: usize,
    },
    Runs {
        word: &'static str,
        runs: Vec<RunText>,
    },
}

/// An issue; its place leads to the page of the run that it names.
#[derive(Debug, Serialize)]
pub(crate) struct IssueItem {
    #[serde(flatten)]
    text: IssueText,
    #[serde(skip_serializing_if = "Option::is_none")]
    href: Option<String>,
}

/// A run that is led to where it has a page.
#[derive(Debug, Serialize)]
pub(crate) struct RunText {
    name: String,
    href: Option<String>,
}

/// The content of a page of blocks. Of many parts only the first are shown, and it is said.
///
/// # Errors
/// A chart cannot be drawn: a fault of the program.
pub fn content(site: &Site, file: &str, mut blocks: Vec<Block>) -> Result<Content, ReportError> {
    let is_part = |block: &Block| matches!(block, Block::Part(..));
    let mut shown = 0;
    let all = blocks.iter().filter(|block| is_part(block)).count();
    blocks.retain(|block| {
        shown += usize::from(is_part(block));
        !is_part(block) || shown <= MOST_SECTIONS
    });
    if all > MOST_SECTIONS {
        let more = counted(all - MOST_SECTIONS, "part");
        blocks.push(Block::say(format!(
            "{more} more stand in the tables and documents of this kind."
        )));
    }
    let mut figures = BTreeMap::new();
    let blocks = items(site, blocks, 2, &mut figures)?;
    Content::new(file, &BlocksPage { blocks }, figures)
}

/// Blocks for `templates/blocks/all.html`, their headings from that level on; their pictures go to `figures`.
///
/// # Errors
/// A chart cannot be drawn: a fault of the program.
pub(crate) fn items(
    site: &Site,
    blocks: Vec<Block>,
    level: usize,
    figures: &mut BTreeMap<String, String>,
) -> Result<Vec<Item>, ReportError> {
    let anchors = anchors(&blocks);
    let mut writer = Writer {
        site,
        items: Vec::new(),
        figures,
        anchors,
    };
    writer.write(blocks, level)?;
    writer.items.iter_mut().for_each(Item::say_legend_once);
    Ok(writer.items)
}

impl Item {
    /// Charts that follow each other and have one legend have it above them, and one caption below them.
    fn say_legend_once(&mut self) {
        let Item::Charts {
            keys,
            caption,
            charts,
        } = self
        else {
            return;
        };
        if charts.len() < 2 {
            return;
        }
        if charts.iter().all(|chart| chart.keys == charts[0].keys) {
            *keys = std::mem::take(&mut charts[0].keys);
            charts.iter_mut().for_each(|chart| chart.keys.clear());
        }
        if charts.iter().all(|chart| chart.caption == charts[0].caption) {
            *caption = std::mem::take(&mut charts[0].caption);
            charts.iter_mut().for_each(|chart| chart.caption.clear());
        }
    }
}

/// Anchors of all parts, the last one first.
fn anchors(blocks: &[Block]) -> Vec<String> {
    fn titles<'b>(blocks: &'b [Block], all: &mut Vec<&'b str>) {
        for block in blocks {
            if let Block::Part(title, blocks) = block {
                all.push(title);
                titles(blocks, all);
            }
        }
    }
    let mut all = Vec::new();
    titles(blocks, &mut all);
    let mut anchors = slugs(all.into_iter());
    anchors.reverse();
    anchors
}

/// A sentence as a page prints it; what is to be typed, between back quotes, stays as it is typed.
fn said(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let parts = parts.map(|(at, part)| {
        if at % 2 == 0 {
            readable(part)
        } else {
            part.to_owned()
        }
    });
    parts.collect::<Vec<_>>().join("`")
}

struct Writer<'s> {
    site: &'s Site<'s>,
    items: Vec<Item>,
    figures: &'s mut BTreeMap<String, String>,
    anchors: Vec<String>,
}

impl Writer<'_> {
    fn write(&mut self, blocks: Vec<Block>, level: usize) -> Result<(), ReportError> {
        for block in blocks {
            let item = match block {
                Block::Say(text) => Item::Say { text: said(&text) },
                Block::Facts(facts) => Item::Facts { facts },
                Block::Table(table) => Item::Table(TableText::of(self.site, &table)),
                Block::Chart(chart) => {
                    let chart = self.chart(&chart)?;
                    match self.items.last_mut() {
                        Some(Item::Charts { charts, .. }) => {
                            charts.push(chart);
                            continue;
                        }
                        _ => Item::Charts {
                            keys: Vec::new(),
                            caption: String::new(),
                            charts: vec![chart],
                        },
                    }
                }
                Block::Issues(issues) => {
                    let item = |issue: &Issue| {
                        let (RunText { name, href }, mut text) = (self.run(&issue.place), issue.into());
                        if href.is_some() {
                            text = IssueText { place: name, ..text };
                        }
                        IssueItem { text, href }
                    };
                    let issues = issues.iter().map(item).collect();
                    let open = OPEN_ISSUES;
                    Item::Issues { issues, open }
                }
                Block::Runs(word, paths) => {
                    let runs = paths.iter().map(|path| self.run(path)).collect();
                    Item::Runs { word, runs }
                }
                Block::Part(title, blocks) => {
                    let anchor = self.anchors.pop().unwrap_or_default();
                    self.items.push(Item::Open { level, anchor, title });
                    self.write(blocks, (level + 1).min(4))?;
                    Item::Close
                }
            };
            self.items.push(item);
        }
        Ok(())
    }

    fn chart(&mut self, chart: &Chart) -> Result<ChartText, ReportError> {
        let figure = format!("chart-{}", self.figures.len() + 1);
        let drawn = drawing(chart, chart::width_on_page(chart), Some(self.site));
        let drawing = drawn.map_err(|reason| ReportError::Figure {
            figure: figure.clone(),
            reason,
        })?;
        let svg = svg::inline(&drawing, &chart.title, &chart::described(chart));
        self.figures.insert(figure.clone(), svg);
        Ok(ChartText {
            figure,
            title: chart.title.clone(),
            is_wide: chart.form == Form::Wide,
            keys: chart::keys(chart),
            caption: chart.caption.clone(),
            beyond: chart::beyond(chart),
        })
    }

    fn run(&self, path: &str) -> RunText {
        let run = self.site.run_of(path);
        RunText {
            name: self.site.input.campaign.run_name(path).to_owned(),
            href: run.map(|run| self.site.run_href(run)),
        }
    }
}
