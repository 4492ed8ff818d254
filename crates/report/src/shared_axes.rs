//! Figures of a page that share an axis: grid, ticks, labels and title that are the same to the byte stand in the page
//! once, and the other figures show them again (SVG `use`). The runs of a page have their time and their residuals in
//! common, which is a tenth of it.

use std::collections::HashMap;

/// How an axis begins in a page whose attributes have no quotes they do not need; its range follows.
const AXIS: &str = "<g class=axes";
const END: &str = "</g>";
/// Fewer bytes than this are not worth naming.
const WORTH_BYTES: usize = 60;

/// The same page, in which an axis that stands there again is shown again.
pub fn share(html: &str) -> String {
    let mut counts: HashMap<&str, usize> = HashMap::new();
    for (_, axis) in axes(html) {
        *counts.entry(axis).or_default() += 1;
    }
    let mut names: HashMap<&str, usize> = HashMap::new();
    let mut out = String::with_capacity(html.len());
    let mut copied = 0;
    for (start, axis) in axes(html) {
        if counts[axis] < 2 || axis.len() < WORTH_BYTES {
            continue;
        }
        let next = names.len() + 1;
        out.push_str(&html[copied..start]);
        copied = start;
        match names.get(axis) {
            Some(name) => {
                out.push_str(&format!("<use href=\"#axis-{name}\"/>"));
                copied += axis.len();
            }
            None => {
                out.push_str(&format!("{AXIS} id=\"axis-{next}\""));
                copied += AXIS.len();
                names.insert(axis, next);
            }
        }
    }
    out.push_str(&html[copied..]);
    out
}

/// Where each axis begins, and all of it.
fn axes(html: &str) -> impl Iterator<Item = (usize, &str)> {
    html.match_indices(AXIS).filter_map(|(at, _)| {
        let inner = at + AXIS.len();
        let end = inner + length(&html[inner..])? + END.len();
        Some((at, &html[at..end]))
    })
}

/// Bytes before the end tag of the group in which `text` begins; none where it does not end.
fn length(text: &str) -> Option<usize> {
    let mut open = 1;
    for (at, _) in text.match_indices('<') {
        let tag = &text[at..];
        if tag.starts_with("<g ") || tag.starts_with("<g>") {
            open += 1;
        } else if tag.starts_with(END) {
            open -= 1;
        }
        if open == 0 {
            return Some(at);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Axes with a group of labels in them, longer than what is not worth naming.
    fn with_labels(label: &str) -> String {
        let ticks = "v40m511-40".repeat(10);
        format!("<path d=\"M620 3299{ticks}\"/><g class=mid><text x=958 y=3450>{label}</text></g>")
    }

    #[test]
    fn axes_that_stand_there_again_are_shown_again() {
        let (time, other) = (with_labels("10"), with_labels("20"));
        let page = format!(
            "<p><g class=axes>{time}</g>a<g class=axes>{other}</g>b<g class=axes>{time}</g>c<g class=axes>{time}</g>d"
        );
        assert_eq!(
            share(&page),
            format!(
                "<p><g class=axes id=\"axis-1\">{time}</g>a<g class=axes>{other}</g>b<use href=\"#axis-1\"/>c<use href=\"#axis-1\"/>d"
            )
        );
    }

    #[test]
    fn short_or_open_axes_stay_as_they_are() {
        let long = with_labels("10");
        for page in [
            "<g class=axes>a</g><g class=axes>a</g>".to_owned(),
            format!("<g class=axes>{long}</g><g class=axes>{long}"),
        ] {
            assert_eq!(share(&page), page);
        }
    }
}
