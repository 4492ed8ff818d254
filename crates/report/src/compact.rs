//! Pages without the bytes that say nothing: line breaks of templates between blocks, quotes around plain attribute
//! values, empty classes, and end tags that HTML itself puts where they are left out (HTML standard, 13.1.2.4).
//!
//! What it is given are this program's own templates with escaped text, in which every attribute is quoted and no text
//! holds a `<`.

/// Elements beside which white space is not seen. A link is not among them: the blank between two of them is.
const BLOCKS: [&str; 37] = [
    "!doctype",
    "html",
    "head",
    "meta",
    "title",
    "link",
    "script",
    "body",
    "header",
    "nav",
    "main",
    "footer",
    "section",
    "h1",
    "h2",
    "h3",
    "h4",
    "p",
    "ul",
    "ol",
    "li",
    "dl",
    "dt",
    "dd",
    "div",
    "table",
    "thead",
    "tbody",
    "tfoot",
    "tr",
    "th",
    "td",
    "figure",
    "figcaption",
    "details",
    "summary",
    "svg",
];
/// Elements that end where the next of their kind, or what holds them, says so.
const ENDED_BY_OTHERS: [&str; 6] = ["td", "th", "tr", "li", "dt", "dd"];
/// Attributes that stay quoted: scripts and checks look for links and their targets by them.
const QUOTED: [&str; 4] = ["id", "href", "src", "data-root"];

/// The same page in fewer bytes.
pub fn compact(html: &str) -> String {
    let mut out = String::with_capacity(html.len());
    let mut rest = html;
    let mut after_block = true;
    while let Some(start) = rest.find('<') {
        let (text, from_tag) = rest.split_at(start);
        let end = end_of_tag(from_tag);
        let (tag, following) = from_tag.split_at(end);
        let name = name_of(tag);
        let is_block = BLOCKS.contains(&name.as_str());
        add_text(&mut out, text, after_block, is_block);
        if !(tag.starts_with("</") && ENDED_BY_OTHERS.contains(&name.as_str())) {
            add_tag(&mut out, tag);
        }
        after_block = is_block;
        rest = following;
    }
    add_text(&mut out, rest, after_block, true);
    out
}

/// A script or a style sheet without its indentation and without lines that are a comment. Neither may have a text or a
/// comment of several lines.
pub fn without_comments(text: &str) -> String {
    let lines = text.lines().map(str::trim).filter(|line| {
        let is_comment = line.starts_with("//") || (line.starts_with("/*") && line.ends_with("*/"));
        !line.is_empty() && !is_comment
    });
    lines.fold(String::with_capacity(text.len()), |mut out, line| {
        out.push_str(line);
        out.push('\n');
        out
    })
}

/// Length of the tag at the start of `text`; a `>` within quotes does not end it.
fn end_of_tag(text: &str) -> usize {
    let mut quoted = false;
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b'>' if !quoted => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Name of the element, in lower case.
fn name_of(tag: &str) -> String {
    let name = tag.trim_start_matches(['<', '/']);
    let end = name
        .find(|c: char| c.is_whitespace() || c == '>' || c == '/')
        .unwrap_or(name.len());
    name[..end].to_ascii_lowercase()
}

/// Text as it is; where it is nothing but white space, nothing beside a block, else one blank.
fn add_text(out: &mut String, text: &str, after_block: bool, before_block: bool) {
    match text.trim_matches(['\n', ' ']).is_empty() {
        true if after_block || before_block || text.is_empty() => {}
        true => out.push(' '),
        false => {
            let text = if after_block {
                text.trim_start_matches('\n')
            } else {
                text
            };
            out.push_str(if before_block {
                text.trim_end_matches('\n')
            } else {
                text
            });
        }
    }
}

/// A tag with the quotes that it needs.
fn add_tag(out: &mut String, tag: &str) {
    let mut parts = tag.split('"');
    let mut before = parts.next().unwrap_or_default().to_owned();
    while let Some(value) = parts.next() {
        let after = parts.next().unwrap_or_default();
        let name = before
            .trim_end_matches('=')
            .rsplit(' ')
            .next()
            .unwrap_or_default();
        if name == "class" && value.trim().is_empty() {
            out.push_str(before[..before.len() - "class=".len()].trim_end());
        } else if is_plain(value) && !QUOTED.contains(&name) && !after.starts_with('/') {
            out.push_str(&before);
            out.push_str(value.trim());
        } else {
            out.push_str(&before);
            out.push('"');
            out.push_str(value);
            out.push('"');
        }
        before = after.to_owned();
    }
    out.push_str(&before);
}

/// Whether an attribute's value may stand without quotes.
fn is_plain(value: &str) -> bool {
    let value = value.trim_matches(' ');
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.:#()%,;+".contains(c);
    !value.is_empty() && value.chars().all(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn breaks_between_blocks_quotes_and_implied_ends_go() {
        let page = "<table class=\"plain wide\">\n<tr class=\"\"><th scope=\"row\">a</th><td class=\"number \">1\u{a0}V</td></tr>\n</table>\n<p>\n<a href=\"x.html\">x</a>\n<a href=\"y.html\" title=\"y &gt; x\">y</a> and\nz</p>\n";
        assert_eq!(
            compact(page),
            "<table class=\"plain wide\"><tr><th scope=row>a<td class=number>1\u{a0}V</table><p><a href=\"x.html\">x</a> <a href=\"y.html\" title=\"y &gt; x\">y</a> and\nz</p>"
        );
    }

    #[test]
    fn a_value_before_the_slash_of_an_empty_element_keeps_its_quotes() {
        let path = "<path class=\"s\" d=\"M0h1\"/><path d=\"M0 1l2 3\" class=\"s\"/>";
        assert_eq!(
            compact(path),
            "<path class=s d=\"M0h1\"/><path d=\"M0 1l2 3\" class=\"s\"/>"
        );
    }

    #[test]
    fn script_and_style_sheet_lose_comments_and_nothing_else() {
        assert_eq!(
            without_comments("/* a */\n:root {\n  --k: 1; /* b */\n}\n\n// c\n"),
            ":root {\n--k: 1; /* b */\n}\n"
        );
        for text in [
            include_str!("../../../templates/site.js"),
            include_str!("../../../templates/style.css"),
        ] {
            assert!(
                text.lines().all(|line| line.matches('`').count() % 2 == 0),
                "a text of several lines"
            );
            assert_eq!(
                text.matches("/*").count(),
                text.lines().filter(|line| line.contains("*/")).count()
            );
        }
    }

    #[test]
    fn a_sign_within_quotes_ends_no_tag() {
        let cell = "<span title=\"a > b\">1</span> <b>2</b>";
        assert_eq!(compact(cell), cell);
        assert_eq!(compact("no tag at all"), "no tag at all");
        assert_eq!(compact("an open <b"), "an open <b");
    }
}
