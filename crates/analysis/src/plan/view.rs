//! The runs to make next, on a page.

use ieap_show::quantities::Quantity;
use ieap_show::{Block, Sheet};

use super::PlannedRun;

const PLANNED: Quantity = Quantity::plain("planned", "Planned", "id on the run sheet");
const PLACE: Quantity = Quantity::plain("place", "What", "strip and surroundings");
const DRIVE: Quantity = Quantity::plain("drive", "Drive", "what is applied");
const WHY: Quantity = Quantity::plain("why", "Why", "what it tells");
const FILE: Quantity = Quantity::plain("file", "Save as", "name of its file");
const SHEET: Quantity = Quantity::plain("on_sheet", "On the sheet", "run sheet that it stands on");

/// The list, the first to make first; nothing of none.
pub fn view(runs: &[PlannedRun]) -> Option<Block> {
    let sheet = Sheet::<&PlannedRun>::new("next-runs", "Runs to make next", 2)
        .remarks(
            "`ieap plan --sheet runs/next.run-sheet.csv` writes them as a run sheet.",
            "",
        )
        .column(PLANNED, |own| own.planned.clone())
        .column(PLACE, |own| own.place())
        .column(DRIVE, |own| own.run.drive.clone())
        .column(WHY, |own| own.run.why.join("; "))
        .column(FILE, |own| own.file.clone())
        .column(SHEET, |own| own.on_sheet.clone());
    (!runs.is_empty()).then(|| Block::part("Runs to make next", vec![Block::Table(sheet.over(runs))]))
}
