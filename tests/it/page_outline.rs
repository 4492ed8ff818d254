//! The context of a page as lines that a reviewer reads: what stands in a row in one line, nothing of what is empty.

use serde_json::Value;

/// Characters up to which small things in a row stand in one line.
const WIDEST: usize = 320;

/// The outline of a context. Every word and number of it stands there; what is empty, null or false is left out.
pub fn outline(context: &Value) -> String {
    let mut out = String::new();
    write(context, 0, &mut out);
    out
}

/// A text, number or yes under its key; nothing of what is empty.
fn scalar(key: &str, value: &Value) -> Option<String> {
    match value {
        Value::String(text) if key == "text" && !text.is_empty() => Some(text.clone()),
        Value::String(text) if !text.is_empty() => Some(format!("{key}={text}")),
        Value::Number(number) => Some(format!("{key}={number}")),
        Value::Bool(true) => Some(key.to_owned()),
        _ => None,
    }
}

fn is_nested(value: &Value) -> bool {
    match value {
        Value::Array(items) => !items.is_empty(),
        Value::Object(members) => !members.is_empty(),
        _ => false,
    }
}

/// A thing in one line, where it is short or a mere word.
fn flat(value: &Value) -> Option<String> {
    let line = match value {
        Value::String(text) => return Some(text.clone()),
        Value::Array(items) => items.iter().map(flat).collect::<Option<Vec<_>>>()?.join(" | "),
        Value::Object(members) => {
            let member = |(key, value): (&String, &Value)| {
                if is_nested(value) {
                    Some(Some(format!("{key}=[{}]", flat(value)?)))
                } else {
                    Some(scalar(key, value))
                }
            };
            let members: Option<Vec<Option<String>>> = members.iter().map(member).collect();
            members?.into_iter().flatten().collect::<Vec<_>>().join("; ")
        }
        other => other.to_string(),
    };
    (line.len() <= WIDEST).then_some(line)
}

fn write(value: &Value, depth: usize, out: &mut String) {
    let line = |out: &mut String, text: &str| {
        *out += &"  ".repeat(depth);
        *out += text;
        out.push('\n');
    };
    match (flat(value), value) {
        (Some(text), _) => line(out, &text),
        (None, Value::Array(items)) => items.iter().for_each(|item| write(item, depth, out)),
        (None, Value::Object(members)) => {
            let scalars: Vec<String> = members
                .iter()
                .filter_map(|(key, value)| scalar(key, value))
                .collect();
            line(out, &format!("- {}", scalars.join("; ")));
            for (key, value) in members.iter().filter(|(_, value)| is_nested(value)) {
                line(out, &format!("  {key}:"));
                write(value, depth + 2, out);
            }
        }
        _ => {}
    }
}

#[test]
fn a_row_is_a_line_and_what_is_empty_is_left_out() {
    let context = serde_json::json!({
        "title": "Runs", "remarks": [], "rows": [[{"text": "a", "is_head": true}, {"text": "1.2", "is_head": false}]],
    });
    assert_eq!(outline(&context), "title=Runs; rows=[a; is_head | 1.2]\n");
}
