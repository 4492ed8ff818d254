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
use crate::pages::wording::{IssueText, RunLink};
use crate::site::Site;
use crate::slug::Slugs;
use ieap_analysis::readable::readable;
use ieap_domain::Issue;
use ieap_domain::words::counted;
use ieap_show::{Block, Chart, Form};

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
        /// Whether it is shown when it is asked for.
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        is_folded: bool,
    },
    Close {
        #[serde(skip_serializing_if = "std::ops::Not::not")]
        is_folded: bool,
    },
    Say {
        text: String,
        /// Where more is told.
        #[serde(skip_serializing_if = "Option::is_none")]
        more: Option<RunLink>,
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
    /// The runs that have it, where it is told once for several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    runs: Vec<RunText>,
}

impl IssueItem {
    fn of(site: &Site, issue: &Issue) -> IssueItem {
        let (RunText { name, href }, mut text) = (RunText::of(site, &issue.place), IssueText::from(issue));
        if href.is_some() {
            text.place = name;
        }
        IssueItem {
            text,
            href,
            runs: Vec::new(),
        }
    }
}

/// A run that is led to where it has a page.
#[derive(Debug, Serialize)]
pub(crate) struct RunText {
    name: String,
    href: Option<String>,
}

impl RunText {
    fn of(site: &Site, path: &str) -> RunText {
        RunText {
            name: site.input.campaign.run_name(path).to_owned(),
            href: site.run_of(path).map(|run| site.run_href(run)),
        }
    }
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
    page(site, file, |page| page.write(blocks))
}

/// The content of a page that is written piece by piece.
///
/// # Errors
/// Those of the pieces: a fault of the program.
pub(crate) fn page(
    site: &Site,
    file: &str,
    write: impl FnOnce(&mut Writer) -> Result<(), ReportError>,
) -> Result<Content, ReportError> {
    let mut figures = BTreeMap::new();
    let mut writer = Writer::new(site, 2, &mut figures);
    write(&mut writer)?;
    let blocks = writer.taken();
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
    let mut writer = Writer::new(site, level, figures);
    writer.write(blocks)?;
    Ok(writer.taken())
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
        if caption.is_empty() && charts.iter().all(|chart| chart.caption == charts[0].caption) {
            *caption = std::mem::take(&mut charts[0].caption);
            charts.iter_mut().for_each(|chart| chart.caption.clear());
        }
    }
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

/// Writes blocks as a page shows them, and what a page alone has: sentences that lead on, parts that are folded.
pub struct Writer<'s> {
    site: &'s Site<'s>,
    items: Vec<Item>,
    figures: &'s mut BTreeMap<String, String>,
    anchors: Slugs,
    /// Of the next heading.
    level: usize,
}

impl<'s> Writer<'s> {
    /// With headings from that level on; pictures go to `figures`.
    pub(crate) fn new(site: &'s Site, level: usize, figures: &'s mut BTreeMap<String, String>) -> Writer<'s> {
        Writer {
            site,
            items: Vec::new(),
            figures,
            anchors: Slugs::default(),
            level,
        }
    }

    /// What is written so far, for `templates/blocks/all.html`; the rest is written after it.
    pub(crate) fn taken(&mut self) -> Vec<Item> {
        self.items.iter_mut().for_each(Item::say_legend_once);
        std::mem::take(&mut self.items)
    }

    /// A sentence, and the page that tells more.
    pub(crate) fn leading(&mut self, text: &str, href: &str, name: String) {
        self.items.push(Item::Say {
            text: said(text),
            more: Some(RunLink {
                href: href.to_owned(),
                name,
            }),
        });
    }

    /// A part of that title.
    ///
    /// # Errors
    /// Those of what is inside.
    pub(crate) fn part(
        &mut self,
        title: &str,
        inside: impl FnOnce(&mut Self) -> Result<(), ReportError>,
    ) -> Result<(), ReportError> {
        let anchor = self.anchors.next(title);
        self.within((anchor, title), false, inside)
    }

    /// A part that is led to from elsewhere.
    ///
    /// # Errors
    /// Those of what is inside.
    pub(crate) fn anchored(
        &mut self,
        anchor: &str,
        title: &str,
        inside: impl FnOnce(&mut Self) -> Result<(), ReportError>,
    ) -> Result<(), ReportError> {
        self.within((anchor.to_owned(), title), false, inside)
    }

    /// A part that is shown when it is asked for.
    ///
    /// # Errors
    /// Those of what is inside.
    pub(crate) fn folded(
        &mut self,
        title: &str,
        inside: impl FnOnce(&mut Self) -> Result<(), ReportError>,
    ) -> Result<(), ReportError> {
        let anchor = self.anchors.next(title);
        self.within((anchor, title), true, inside)
    }

    fn within(
        &mut self,
        (anchor, title): (String, &str),
        is_folded: bool,
        inside: impl FnOnce(&mut Self) -> Result<(), ReportError>,
    ) -> Result<(), ReportError> {
        self.items.push(Item::Open {
            level: self.level.min(4),
            anchor,
            title: title.to_owned(),
            is_folded,
        });
        self.level += 1;
        inside(self)?;
        self.level -= 1;
        self.items.push(Item::Close { is_folded });
        Ok(())
    }

    /// Issues that are each told once for the runs of these paths.
    pub(crate) fn issues_of_runs(&mut self, issues: Vec<(Issue, Vec<String>)>) {
        let item = |(issue, runs): &(Issue, Vec<String>)| IssueItem {
            runs: runs.iter().map(|path| RunText::of(self.site, path)).collect(),
            ..IssueItem::of(self.site, issue)
        };
        let issues = issues.iter().map(item).collect();
        let open = OPEN_ISSUES;
        self.items.push(Item::Issues { issues, open });
    }

    /// A drawing of the page's own: its id, what stands above and below it, and itself.
    ///
    /// # Errors
    /// [`ReportError::Figure`] where it could not be drawn.
    pub(crate) fn drawing(
        &mut self,
        figure: &str,
        (title, caption): (&str, &str),
        drawn: Result<String, String>,
    ) -> Result<(), ReportError> {
        let svg = drawn.map_err(ReportError::of_figure(figure))?;
        self.figures.insert(figure.to_owned(), svg);
        self.beside(ChartText {
            figure: figure.to_owned(),
            title: title.to_owned(),
            is_wide: false,
            keys: Vec::new(),
            caption: caption.to_owned(),
            beyond: String::new(),
        });
        Ok(())
    }

    /// Runs set aside that lie beyond the axes of the drawing that stands last.
    pub(crate) fn beyond(&mut self, words: String) {
        if let Some(Item::Charts { charts, .. }) = self.items.last_mut()
            && let Some(last) = charts.last_mut()
        {
            last.beyond = words;
        }
    }

    /// What holds for all drawings that stand last, below them.
    pub(crate) fn below(&mut self, words: &str) {
        match self.items.last_mut() {
            Some(Item::Charts { caption, .. }) => words.clone_into(caption),
            _ => self.items.push(Item::Say {
                text: said(words),
                more: None,
            }),
        }
    }

    /// A picture beside those that stand last.
    fn beside(&mut self, chart: ChartText) {
        if let Some(Item::Charts { charts, .. }) = self.items.last_mut() {
            return charts.push(chart);
        }
        self.items.push(Item::Charts {
            keys: Vec::new(),
            caption: String::new(),
            charts: vec![chart],
        });
    }

    /// Blocks, one after the other.
    ///
    /// # Errors
    /// A chart cannot be drawn: a fault of the program.
    pub(crate) fn write(&mut self, blocks: impl IntoIterator<Item = Block>) -> Result<(), ReportError> {
        for block in blocks {
            let item = match block {
                Block::Say(text) => Item::Say {
                    text: said(&text),
                    more: None,
                },
                Block::Facts(facts) => Item::Facts { facts },
                Block::Table(table) => Item::Table(TableText::of(self.site, &table)),
                Block::Chart(chart) => {
                    let chart = self.chart(&chart)?;
                    self.beside(chart);
                    continue;
                }
                Block::Issues(issues) => Item::Issues {
                    issues: issues
                        .iter()
                        .map(|issue| IssueItem::of(self.site, issue))
                        .collect(),
                    open: OPEN_ISSUES,
                },
                Block::Runs(word, paths) => {
                    let runs = paths.iter().map(|path| RunText::of(self.site, path)).collect();
                    Item::Runs { word, runs }
                }
                Block::Part(title, blocks) => {
                    self.part(&title, |part| part.write(blocks))?;
                    continue;
                }
            };
            self.items.push(item);
        }
        Ok(())
    }

    fn chart(&mut self, chart: &Chart) -> Result<ChartText, ReportError> {
        let figure = format!("chart-{}", self.figures.len() + 1);
        let drawn = drawing(chart, chart::width_on_page(chart), Some(self.site));
        let drawing = drawn.map_err(ReportError::of_figure(&figure))?;
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
}
