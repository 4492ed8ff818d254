//! Cells of a workbook that are shown in percent: 0.45 stands there, and the author sees 45.0 %.

use std::collections::BTreeSet;

use super::workbook_parts;

/// Row and column, from 0.
type Place = (u32, u32);

/// Number formats of every workbook that show percent: `0%` and `0.00%`.
const BUILT_IN: [&str; 2] = ["9", "10"];

/// The places of such cells by the name of their sheet; none of a workbook that has no such format.
pub(super) fn of_workbook(bytes: &[u8], limit: u64) -> Vec<(String, BTreeSet<Place>)> {
    let part = |name: &str| workbook_parts::text_of(bytes, name, limit);
    let styles = part("xl/styles.xml").map_or(BTreeSet::new(), |text| percent_styles(&text));
    if styles.is_empty() {
        return Vec::new();
    }
    let (Some(book), Some(links)) = (part("xl/workbook.xml"), part("xl/_rels/workbook.xml.rels")) else {
        return Vec::new();
    };
    let target = |id: &str| {
        let of_id = elements(&links, "Relationship").find(|mark| attribute(mark, "Id") == Some(id))?;
        let target = attribute(of_id, "Target")?;
        Some(match target.strip_prefix('/') {
            Some(whole) => whole.to_owned(),
            None => format!("xl/{target}"),
        })
    };
    let sheets: Vec<(String, String)> = elements(&book, "sheet")
        .filter_map(|mark| {
            Some((
                attribute(mark, "name")?.to_owned(),
                target(attribute(mark, "r:id")?)?,
            ))
        })
        .collect();
    let places = |(name, path): (String, String)| {
        let text = part(&path)?;
        let cells = elements(&text, "c")
            .filter(|mark| attribute(mark, "s").is_some_and(|style| styles.contains(style)));
        Some((
            name,
            cells.filter_map(|mark| place(attribute(mark, "r")?)).collect(),
        ))
    };
    sheets.into_iter().filter_map(places).collect()
}

/// The styles of cells, by their numbers, that show percent.
fn percent_styles(styles: &str) -> BTreeSet<String> {
    let custom = elements(styles, "numFmt").filter(|mark| {
        // What stands in quotes is shown as it is.
        let code = attribute(mark, "formatCode")
            .unwrap_or("")
            .replace("&quot;", "\"");
        code.split('"').step_by(2).any(|part| part.contains('%'))
    });
    let formats: BTreeSet<&str> = custom
        .filter_map(|mark| attribute(mark, "numFmtId"))
        .chain(BUILT_IN)
        .collect();
    let cells = styles.split_once("<cellXfs").map_or("", |(_, rest)| rest);
    let cells = cells.split_once("</cellXfs>").map_or(cells, |(own, _)| own);
    let of_percent =
        |(_, mark): &(usize, &str)| attribute(mark, "numFmtId").is_some_and(|id| formats.contains(id));
    elements(cells, "xf")
        .enumerate()
        .filter(of_percent)
        .map(|(at, _)| at.to_string())
        .collect()
}

/// The marks of elements of a name, each without its brackets.
fn elements<'t>(text: &'t str, name: &'t str) -> impl Iterator<Item = &'t str> {
    text.split('<').skip(1).filter_map(move |mark| {
        let rest = mark.strip_prefix(name)?;
        let ends = rest.starts_with([' ', '\t', '\n', '\r', '/', '>']);
        ends.then(|| rest.split_once('>').map_or(rest, |(own, _)| own))
    })
}

fn attribute<'t>(mark: &'t str, name: &str) -> Option<&'t str> {
    mark.match_indices(name).find_map(|(at, _)| {
        let is_whole = mark[..at].ends_with(char::is_whitespace);
        let rest = mark[at + name.len()..]
            .trim_start()
            .strip_prefix('=')?
            .trim_start();
        let quote = rest
            .chars()
            .next()
            .filter(|c| matches!(c, '"' | '\'') && is_whole)?;
        rest[1..].split_once(quote).map(|(value, _)| value)
    })
}

/// Row and column, from 0, of `B12`.
fn place(reference: &str) -> Option<Place> {
    let digits = reference.find(|c: char| c.is_ascii_digit())?;
    let (letters, row) = reference.split_at(digits);
    let column = letters.bytes().try_fold(0u32, |column, letter| {
        let letter = letter.to_ascii_uppercase();
        letter.is_ascii_uppercase().then(|| {
            26u32
                .checked_mul(column)?
                .checked_add(u32::from(letter - b'A') + 1)
        })?
    })?;
    Some((row.parse::<u32>().ok()?.checked_sub(1)?, column.checked_sub(1)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn styles_that_show_percent_are_found_and_words_in_quotes_are_none() {
        let styles = "<styleSheet><numFmts><numFmt numFmtId=\"164\" formatCode=\"0.0%\"/><numFmt numFmtId=\"165\" \
                      formatCode=\"0.0&quot; %&quot;\"/></numFmts><cellStyleXfs><xf numFmtId=\"9\"/></cellStyleXfs><cellXfs \
                      count=\"4\"><xf numFmtId=\"0\"/><xf numFmtId=\"164\"/><xf numFmtId=\"165\"/><xf numFmtId=\"10\"/></cellXfs>";
        assert_eq!(
            percent_styles(styles),
            BTreeSet::from(["1".to_owned(), "3".to_owned()])
        );
        assert_eq!(
            (place("A1"), place("AB12"), place("7")),
            (Some((0, 0)), Some((11, 27)), None)
        );
    }
}
