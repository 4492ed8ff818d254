//! The structure of a Gamry EXPLAIN file: objects, notes and tables, all as text.

use crate::text::Line;

/// One line `KEY TYPE value label`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Object<'a> {
    /// Key, `VSTEP1`.
    pub key: &'a str,
    /// Value as text.
    pub value: &'a str,
    /// Fields behind the value: flags and the label.
    pub rest: Vec<&'a str>,
}

/// One table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table<'a> {
    /// Name, `CURVE`.
    pub name: &'a str,
    /// Line of its start.
    pub line: usize,
    /// Number of rows planned; none where it is not declared.
    pub declared_rows: Option<usize>,
    /// Names of the columns.
    pub names: Vec<&'a str>,
    /// Units of the columns.
    pub units: Vec<&'a str>,
    /// Rows without their leading tab.
    pub rows: Vec<Line<'a>>,
}

/// A whole file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Explain<'a> {
    /// Objects in the file's order, notes among them.
    pub objects: Vec<Object<'a>>,
    /// Tables in the file's order.
    pub tables: Vec<Table<'a>>,
    /// Number of lines.
    pub lines: usize,
}

impl<'a> Explain<'a> {
    /// Value of the first object of that key.
    pub fn value(&self, key: &str) -> Option<&'a str> {
        self.objects
            .iter()
            .find(|object| object.key == key)
            .map(|object| object.value)
    }

    /// Keys with their values, in the file's order.
    pub fn metadata(&self) -> Vec<(String, String)> {
        let pair = |object: &Object<'_>| (object.key.to_owned(), object.value.to_owned());
        self.objects.iter().map(pair).collect()
    }
}

/// Takes the lines apart. What is no object and in no table is kept as an object without a value.
pub fn parse<'a>(lines: &[Line<'a>]) -> Explain<'a> {
    let mut explain = Explain {
        lines: lines.len(),
        ..Explain::default()
    };
    let mut at = 0;
    while let Some(line) = lines.get(at) {
        at += 1;
        let mut fields = line.text.trim_end().split('\t').map(str::trim);
        let key = fields.next().unwrap_or("");
        let kind = fields.next().unwrap_or("");
        let value = fields.next().unwrap_or("");
        match (key, kind) {
            ("", _) => {}
            ("EXPLAIN", "") => {}
            ("TAG", _) => explain.objects.push(object(key, kind, Vec::new())),
            (_, "TABLE") => at = table(&mut explain, lines, at, (key, value, line.number)),
            (_, "NOTES") => {
                let count = value.parse().unwrap_or(0);
                at = notes(&mut explain, lines, at, key, count);
            }
            _ => explain.objects.push(object(key, value, fields.collect())),
        }
    }
    explain
}

fn object<'a>(key: &'a str, value: &'a str, rest: Vec<&'a str>) -> Object<'a> {
    Object { key, value, rest }
}

/// Reads at most `count` lines of notes: they are indented or blank.
fn notes<'a>(
    explain: &mut Explain<'a>,
    lines: &[Line<'a>],
    start: usize,
    key: &'a str,
    count: usize,
) -> usize {
    let is_note = |line: &&Line<'a>| line.text.starts_with('\t') || line.text.trim().is_empty();
    let found = lines[start..].iter().take(count).take_while(is_note);
    let mut at = start;
    for line in found {
        at += 1;
        if !line.text.trim().is_empty() {
            explain.objects.push(object(key, line.text.trim(), Vec::new()));
        }
    }
    at
}

/// Reads a table: names, units, then rows while lines begin with a tab.
fn table<'a>(
    explain: &mut Explain<'a>,
    lines: &[Line<'a>],
    start: usize,
    (name, declared, line): (&'a str, &'a str, usize),
) -> usize {
    let mut indented = lines[start..]
        .iter()
        .map_while(|line| Some((line.number, line.text.strip_prefix('\t')?.trim_end_matches('\t'))));
    let mut cells = || -> Vec<&'a str> {
        let text = indented.next().map_or("", |(_, text)| text);
        text.split('\t').map(str::trim).collect()
    };
    let (names, units) = (cells(), cells());
    let rows: Vec<Line<'a>> = indented
        .map(|(number, text)| Line {
            number,
            text,
            ended: true,
        })
        .collect();
    let read = lines[start..]
        .iter()
        .take_while(|line| line.text.starts_with('\t'))
        .count();
    explain.tables.push(Table {
        name,
        line,
        declared_rows: declared.parse().ok(),
        names,
        units,
        rows,
    });
    start + read
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Lines;

    #[test]
    fn objects_notes_and_tables() {
        let text = "EXPLAIN\nTAG\tCHRONOA\nNOTES\tNOTES\t2\tNotes\n\tfirst\n\nVSTEP1\tPOTEN\t5,0E-1\tF\tVoltage\n\
                    CURVE\tTABLE\t9\n\tPt\tT\n\t#\ts\n\t0\t0\n\t1\t1\n\nEXPERIMENTABORTED\tTOGGLE\tT\tAborted\n";
        let explain = parse(&Lines::new(text).collect::<Vec<_>>());
        assert_eq!(explain.value("TAG"), Some("CHRONOA"));
        assert_eq!(explain.value("NOTES"), Some("first"));
        assert_eq!(explain.value("EXPERIMENTABORTED"), Some("T"));
        assert_eq!(explain.objects[2].rest, ["F", "Voltage"]);
        let table = &explain.tables[0];
        assert_eq!(
            (table.name, table.line, table.declared_rows),
            ("CURVE", 7, Some(9))
        );
        assert_eq!(
            (table.names.as_slice(), table.units.as_slice()),
            (&["Pt", "T"][..], &["#", "s"][..])
        );
        assert_eq!(
            (table.rows.len(), table.rows[1].text, table.rows[1].number),
            (2, "1\t1", 11)
        );
    }
}
