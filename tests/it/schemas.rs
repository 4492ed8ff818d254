//! What `--json` prints is held against its schema: by every test that reads a document, and here verb by verb.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value};

use crate::campaign::{CampaignFolder, Ended, ieap, run_table};

/// Keywords of JSON Schema that schemas here use: all of them are understood below, so that none passes unseen.
const KEYWORDS: [&str; 19] = [
    "$schema",
    "$id",
    "$defs",
    "$ref",
    "title",
    "description",
    "type",
    "properties",
    "required",
    "items",
    "prefixItems",
    "minItems",
    "maxItems",
    "minimum",
    "maximum",
    "enum",
    "const",
    "anyOf",
    "oneOf",
];
/// Files, not documents of `--json`, that name a schema of their own.
const FILES: [&str; 3] = ["simulation-truth", "backup-contents", "fit-result"];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas")
}

/// The schema of that name, where there is one.
fn schema(name: &str) -> Option<Value> {
    let text = std::fs::read_to_string(folder().join(format!("{name}.json"))).ok()?;
    Some(serde_json::from_str(&text).unwrap_or_else(|error| panic!("schemas/{name}.json: {error}")))
}

/// Holds a document against the schema that it names; a file without a name passes, as does one of [`FILES`].
pub fn check(document: &Value) {
    let Some(title) = document["schema"].as_str() else {
        return;
    };
    let name = title.split('/').nth(1).unwrap_or_default();
    if FILES.contains(&name) {
        return;
    }
    let schema = schema(name).unwrap_or_else(|| panic!("{title} has no schema"));
    let mut faults = faults(&schema, document);
    cannot_be(document, "$", &mut faults);
    assert!(
        faults.is_empty(),
        "against schemas/{name}.json:\n{}",
        faults.join("\n")
    );
}

/// What in a document is not as its schema says, with places. An object may have no keys but those that are listed: a schema
/// that users get leaves that open, so that keys may be added, but here a forgotten one is a fault.
fn faults(schema: &Value, document: &Value) -> Vec<String> {
    let mut found = Vec::new();
    Held { root: schema }.hold(schema, document, "$", &mut found);
    found
}

/// No quantity of a strip, and no error of one in any unit, is as large.
const LARGEST: f64 = 1e30;

/// Numbers that cannot be, as numbers and in sentences: a fault of the program, wherever they stand.
fn cannot_be(value: &Value, place: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(number) if number.as_f64().is_none_or(|x| x.abs() > LARGEST) => {
            found.push(format!("{place}: {number} cannot be"));
        }
        Value::String(text) => found.extend(
            words_that_cannot_be(text)
                .into_iter()
                .map(|word| format!("{place}: {word:?} cannot be, in {text:?}")),
        ),
        Value::Array(each) => {
            let each = each.iter().enumerate();
            each.for_each(|(k, own)| cannot_be(own, &format!("{place}[{k}]"), found));
        }
        Value::Object(each) => {
            let each = each.iter();
            each.for_each(|(key, own)| cannot_be(own, &format!("{place}.{key}"), found));
        }
        _ => {}
    }
}

/// A sentence with its powers of ten as a machine reads them: `5.5·10¹⁵⁰` is `5.5e150`.
fn with_exponents(text: &str) -> String {
    let mut plain = text.replace("·10", "e").replace('⁻', "-");
    for (digit, raised) in "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().enumerate() {
        plain = plain.replace(raised, &digit.to_string());
    }
    plain
}

/// Words of a sentence that are no number, or one that is too large to be; what is quoted somebody else wrote.
fn words_that_cannot_be(text: &str) -> Vec<String> {
    let plain = with_exponents(text);
    let own = plain.split('"').step_by(2);
    let words = own.flat_map(|own| own.split(|c: char| !(c.is_ascii_alphanumeric() || "_.+-".contains(c))));
    let is_impossible = |word: &&str| {
        let plain = word.trim_matches(|c: char| "+-.".contains(c));
        matches!(plain, "NaN" | "inf" | "nan") || {
            let is_number = plain.starts_with(|c: char| c.is_ascii_digit()) && plain.contains('e');
            is_number && plain.parse::<f64>().is_ok_and(|x| x > LARGEST)
        }
    };
    words.filter(is_impossible).map(str::to_owned).collect()
}

#[test]
fn a_number_that_cannot_be_is_found_in_a_sentence() {
    let bad = "alpha was too large: 5.5·10¹⁵⁰ standard errors, 3 +- NaN, -inf ohm, 2·10⁻⁴⁰ A, 4e31 V, run 12e99x, 4.1e3 s, alpha_inf, cell \"NaN\"";
    assert_eq!(words_that_cannot_be(bad), ["5.5e150", "NaN", "-inf", "4e31"]);
}

struct Held<'a> {
    root: &'a Value,
}

impl Held<'_> {
    fn hold(&self, schema: &Value, value: &Value, place: &str, found: &mut Vec<String>) {
        if let Some(reference) = schema["$ref"].as_str() {
            let name = reference
                .strip_prefix("#/$defs/")
                .expect("a reference within the file");
            let meant = &self.root["$defs"][name];
            assert!(meant.is_object(), "{reference} leads nowhere");
            self.hold(meant, value, place, found);
        }
        if let Some(several) = schema["anyOf"].as_array() {
            let tried = several.iter().map(|one| {
                let mut own = Vec::new();
                self.hold(one, value, place, &mut own);
                own
            });
            let best = tried.min_by_key(Vec::len).unwrap_or_default();
            found.extend(best);
        }
        if let Some(several) = schema["oneOf"].as_array() {
            let fits = several.iter().filter(|one| {
                let mut own = Vec::new();
                self.hold(one, value, place, &mut own);
                own.is_empty()
            });
            let fits = fits.count();
            if fits != 1 {
                found.push(format!(
                    "{place}: {value} is {fits} of {several:?} in place of one"
                ));
            }
        }
        if !schema["const"].is_null() && schema["const"] != *value {
            found.push(format!("{place}: {value} in place of {}", schema["const"]));
        }
        if let Some(listed) = schema["enum"].as_array()
            && !listed.contains(value)
        {
            found.push(format!("{place}: {value} is none of {listed:?}"));
        }
        if !is_of_type(&schema["type"], value) {
            found.push(format!("{place}: {value} is no {}", schema["type"]));
        }
        let least = schema["minimum"].as_f64();
        if value
            .as_f64()
            .zip(least)
            .is_some_and(|(number, least)| number < least)
        {
            found.push(format!("{place}: {value} is below {}", schema["minimum"]));
        }
        let most = schema["maximum"].as_f64();
        if value
            .as_f64()
            .zip(most)
            .is_some_and(|(number, most)| number > most)
        {
            found.push(format!("{place}: {value} is above {}", schema["maximum"]));
        }
        match value {
            Value::Object(object) => self.object(schema, object, place, found),
            Value::Array(items) => self.array(schema, items, place, found),
            _ => {}
        }
    }

    fn object(&self, schema: &Value, object: &Map<String, Value>, place: &str, found: &mut Vec<String>) {
        for key in schema["required"].as_array().into_iter().flatten() {
            let key = key.as_str().expect("a key");
            if !object.contains_key(key) {
                found.push(format!("{place}: {key} is missing"));
            }
        }
        let others = &schema["additionalProperties"];
        for (key, value) in object {
            let place = format!("{place}.{key}");
            match (&schema["properties"][key], others) {
                (Value::Null, Value::Null) if schema["properties"].is_object() => {
                    found.push(format!("{place} is not in the schema"));
                }
                (Value::Null, Value::Null) => {}
                (Value::Null, others) => self.hold(others, value, &place, found),
                (own, _) => self.hold(own, value, &place, found),
            }
        }
    }

    fn array(&self, schema: &Value, items: &[Value], place: &str, found: &mut Vec<String>) {
        let limit = |key: &str| schema[key].as_u64().map(|count| count as usize);
        let too_few = limit("minItems").is_some_and(|least| items.len() < least);
        if too_few || limit("maxItems").is_some_and(|most| items.len() > most) {
            found.push(format!("{place}: {} items", items.len()));
        }
        for (at, item) in items.iter().enumerate() {
            let own = match &schema["prefixItems"][at] {
                Value::Null => &schema["items"],
                own => own,
            };
            self.hold(own, item, &format!("{place}[{at}]"), found);
        }
    }
}

fn is_of_type(wanted: &Value, value: &Value) -> bool {
    let one = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("{other} is no type"),
    };
    match wanted {
        Value::Null => true,
        Value::String(name) => one(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(one),
        other => panic!("{other} is no type"),
    }
}

/// Every schema in a schema, those within it counted.
fn schemas_in(schema: &Value) -> Vec<&Value> {
    let mut all = vec![schema];
    let Some(object) = schema.as_object() else {
        return all;
    };
    for (keyword, value) in object {
        match keyword.as_str() {
            "properties" | "$defs" => {
                let own = value.as_object().into_iter().flat_map(|named| named.values());
                all.extend(own.flat_map(schemas_in));
            }
            "items" | "additionalProperties" => all.extend(schemas_in(value)),
            "prefixItems" | "anyOf" | "oneOf" => {
                all.extend(value.as_array().into_iter().flatten().flat_map(schemas_in));
            }
            _ => {}
        }
    }
    all
}

#[test]
fn schemas_use_only_what_they_are_held_by() {
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let root: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        for schema in schemas_in(&root) {
            let Some(object) = schema.as_object() else {
                continue;
            };
            for keyword in object.keys() {
                let known = KEYWORDS.contains(&keyword.as_str()) || keyword == "additionalProperties";
                assert!(known, "{}: {keyword}", path.display());
            }
        }
    }
}

#[test]
fn a_document_that_is_not_as_its_schema_says_is_noticed() {
    let schema = schema("export").unwrap();
    let good = serde_json::json!({"schema": "ieap/export/1", "file": "a.csv", "rows": 3, "files": [{"file": "a.csv", "rows": 3}]});
    assert_eq!(faults(&schema, &good), Vec::<String>::new());
    let mut bad = good.clone();
    bad["rows"] = "3".into();
    bad["files"][0].as_object_mut().unwrap().remove("rows");
    bad["more"] = true.into();
    let said = faults(&schema, &bad);
    assert_eq!(said.len(), 3, "{said:?}");
    assert!(
        said.contains(&"$.files[0]: rows is missing".to_owned()),
        "{said:?}"
    );
    let issue = |severity: &str, line: i32| serde_json::json!({"severity": severity, "line": line});
    let schema = serde_json::json!({"properties": {
        "severity": {"oneOf": [{"type": "string", "const": "note"}, {"type": "string", "const": "error"}]},
        "line": {"type": "integer", "minimum": 0, "maximum": 9},
    }});
    assert_eq!(faults(&schema, &issue("note", 0)), Vec::<String>::new());
    assert_eq!(faults(&schema, &issue("grave", -1)).len(), 2);
    assert_eq!(faults(&schema, &issue("note", 10)).len(), 1);
}

/// Names of documents that stand in the code: `"ieap/fits/1"`.
fn in_code() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for folder in ["src", "crates"] {
        sources(&root.join(folder), &mut files);
    }
    let mut names: Vec<String> = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        for part in code.split("\"ieap/").skip(1) {
            let title = part.split('"').next().unwrap_or_default();
            let parts: Vec<&str> = title.split('/').collect();
            if parts.len() == 2 && parts[1].parse::<u32>().is_ok() {
                names.push(title.to_owned());
            }
        }
    }
    names.sort();
    names.dedup();
    names
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => sources(&path, found),
            false if path.extension().is_some_and(|ending| ending == "rs") => found.push(path),
            false => {}
        }
    }
}

#[test]
fn every_document_has_its_schema_and_every_schema_its_document() {
    let listed = ieap(Path::new("."), &["list", "schemas", "--json"])
        .expect(0)
        .json();
    let ids: Vec<String> = listed["schemas"]
        .as_array()
        .unwrap()
        .iter()
        .map(|entry| {
            entry["id"]
                .as_str()
                .unwrap()
                .trim_start_matches("ieap/")
                .to_owned()
        })
        .collect();
    for id in &ids {
        let (name, _) = id.split_once('/').unwrap();
        let printed = ieap(Path::new("."), &["list", "schemas", name]).expect(0);
        let file = std::fs::read_to_string(folder().join(format!("{name}.json"))).unwrap();
        assert_eq!(printed.stdout, file);
        assert_eq!(
            ieap(Path::new("."), &["list", "schemas", &format!("ieap/{id}")]).stdout,
            file
        );
    }
    let files = std::fs::read_dir(folder()).unwrap().count();
    assert_eq!(
        files,
        ids.len(),
        "a file in schemas/ without its row in SCHEMAS (src/cli/schema.rs)"
    );
    let in_code = in_code();
    assert!(in_code.len() > 30, "{in_code:?}");
    for title in &in_code {
        let name = title.split('/').next().unwrap_or_default();
        let is_elsewhere = FILES.contains(&name);
        assert!(
            ids.contains(title) || is_elsewhere,
            "ieap/{title} has no schema: write schemas/{name}.json and its row in SCHEMAS (src/cli/schema.rs)"
        );
    }
    for id in &ids {
        assert!(in_code.contains(id), "no verb prints ieap/{id}");
    }
    let unknown = ieap(Path::new("."), &["list", "schemas", "nothing"]).expect(2);
    assert!(unknown.stderr.contains("needed one of"), "{unknown:?}");
}

#[test]
fn what_each_verb_prints_is_as_its_schema_says() {
    let folder = CampaignFolder::new();
    folder.write("runs/a.csv", run_table(1));
    folder.write("runs/b.csv", run_table(2));
    folder.write(
        "laser.csv",
        "sensor export\n\nEpoch time (ms);Distance1 (mm)\n17289,0;12,50\n17290,0;12,51\n",
    );
    folder.write("runs/refused.csv", "nothing,that\na,reader knows\n");
    let seen = |ended: Ended| {
        let document = ended.json();
        document["schema"]
            .as_str()
            .unwrap_or_else(|| panic!("{document}"))
            .to_owned()
    };
    folder.run_json();
    let asked: [&[&str]; 22] = [
        &["ingest"],
        &["fit"],
        &["fit", "--group"],
        &["dma"],
        &["status"],
        &["status", "--alarms"],
        &["report"],
        &["next"],
        &["table"],
        &["table", "table5"],
        &["table", "fits-wide", "--moved"],
        &["explain", "fits-wide"],
        &["explain", "fits-wide", "1", "alpha"],
        &["figure"],
        &["figure", "currents", "-o", "currents.svg"],
        &["export", "--what", "all", "-o", "export"],
        &["inspect", "runs/a.csv"],
        &["inspect", "runs/refused.csv"],
        &["profile", "laser.csv"],
        &["tag", "runs/a.csv", "note=wet"],
        &["drop", "runs/b.csv", "--why", "clip slipped"],
        &["verify", "--deep"],
    ];
    let mut schemas: Vec<String> = Vec::new();
    for words in asked {
        let words = [words, &["--json"]].concat();
        schemas.push(seen(folder.ieap(&words)));
    }
    for words in [
        &["list", "formats"][..],
        &["list", "models"],
        &["list", "effects"],
        &["list", "effects", "faradaic-leak"],
        &["list", "schemas"],
    ] {
        schemas.push(seen(folder.ieap(&[words, &["--json"]].concat())));
    }
    let elsewhere = tempfile::tempdir().unwrap();
    let [copy, restored] = ["copy", "restored"].map(|name| elsewhere.path().join(name));
    let (copy, restored) = (copy.to_str().unwrap(), restored.to_str().unwrap());
    schemas.push(seen(folder.ieap(&["backup", copy, "--json"])));
    schemas.push(seen(folder.ieap(&["restore", copy, restored, "--json"])));
    schemas.push(seen(folder.ieap(&["rebuild", "--json"])));
    schemas.push(seen(folder.ieap(&["init", "made", "--json"])));
    schemas.push(seen(folder.ieap(&[
        "init",
        "made-from",
        "--from",
        "runs",
        "--json",
    ])));
    schemas.sort();
    schemas.dedup();
    assert!(schemas.len() >= 28, "{schemas:?}");
}
