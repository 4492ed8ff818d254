//! The JSON of a PalmSens session: measurements with their arrays. Keys are in lower case up to version 5.8 and
//! in Pascal case later; both are read.

use serde_json::{Map, Value};

/// One array of readings.
#[derive(Debug, Clone, PartialEq)]
pub struct DataArray {
    /// What the software calls it, `current`, `potential`.
    pub description: String,
    /// What it measures in the software's words, `Current`; empty where the unit does not say.
    pub quantity: String,
    /// Type of the unit, the last part of `PalmSens.Units.MicroAmpere`.
    pub unit_type: String,
    /// Readings; NaN where one is no number.
    pub values: Vec<f64>,
    /// Index and status (`S`) of the readings whose status is not 0.
    pub marked: Vec<(u32, i64)>,
}

/// Arrays of equal length that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayGroup {
    /// Title of the curve or the measurement.
    pub title: String,
    /// Arrays in the file's order.
    pub arrays: Vec<DataArray>,
}

/// One measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Title: the technique.
    pub title: String,
    /// Local time, ticks of 100 ns since the year 1.
    pub local_ticks: Option<i64>,
    /// The same in UTC.
    pub utc_ticks: Option<i64>,
    /// Serial number of the instrument; empty where it is not given.
    pub serial: String,
    /// The data set, or the curves where it is empty.
    pub groups: Vec<ArrayGroup>,
}

/// Value of a key in either case.
pub fn get<'a>(object: &'a Value, key: &str) -> Option<&'a Value> {
    let object: &Map<String, Value> = object.as_object()?;
    object.get(key).or_else(|| {
        object
            .iter()
            .find(|(name, _)| name.eq_ignore_ascii_case(key))
            .map(|(_, v)| v)
    })
}

fn text(object: &Value, key: &str) -> String {
    get(object, key).and_then(Value::as_str).unwrap_or("").to_owned()
}

fn list<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    get(object, key)
        .and_then(Value::as_array)
        .map_or(&[], Vec::as_slice)
}

/// The measurements of a session.
pub fn measurements(session: &Value) -> Vec<Measurement> {
    list(session, "measurements").iter().map(measurement).collect()
}

fn measurement(object: &Value) -> Measurement {
    let ticks = |key| {
        get(object, key)
            .and_then(Value::as_i64)
            .filter(|ticks| *ticks > 0)
    };
    let title = text(object, "title");
    let set = get(object, "dataset").map_or(&[][..], |set| list(set, "values"));
    let set: Vec<DataArray> = set
        .iter()
        .map(array)
        .filter(|array| !array.values.is_empty())
        .collect();
    let groups = if set.is_empty() {
        list(object, "curves").iter().map(curve).collect()
    } else {
        by_length(&title, set)
    };
    Measurement {
        local_ticks: ticks("timestamp"),
        utc_ticks: ticks("utctimestamp"),
        serial: text(object, "deviceserial"),
        title,
        groups,
    }
}

fn curve(object: &Value) -> ArrayGroup {
    let axes = ["xaxisdataarray", "yaxisdataarray"];
    ArrayGroup {
        title: text(object, "title"),
        arrays: axes
            .iter()
            .filter_map(|axis| get(object, axis))
            .map(array)
            .collect(),
    }
}

/// Groups the arrays of a data set by their length, so that each group is a table.
fn by_length(title: &str, arrays: Vec<DataArray>) -> Vec<ArrayGroup> {
    let mut groups: Vec<ArrayGroup> = Vec::new();
    for array in arrays {
        let length = array.values.len();
        match groups
            .iter_mut()
            .find(|group| group.arrays[0].values.len() == length)
        {
            Some(group) => group.arrays.push(array),
            None => groups.push(ArrayGroup {
                title: title.to_owned(),
                arrays: vec![array],
            }),
        }
    }
    groups
}

fn array(object: &Value) -> DataArray {
    let stated = get(object, "unit");
    let unit = stated.map_or(String::new(), |unit| text(unit, "type"));
    let value = |reading: &Value| get(reading, "v").and_then(Value::as_f64).unwrap_or(f64::NAN);
    DataArray {
        description: text(object, "description"),
        quantity: stated.map_or(String::new(), |unit| text(unit, "q")),
        unit_type: unit.rsplit('.').next().unwrap_or("").to_owned(),
        values: list(object, "datavalues").iter().map(value).collect(),
        marked: list(object, "datavalues")
            .iter()
            .enumerate()
            .filter_map(|(index, reading)| Some((index as u32, get(reading, "s")?.as_i64()?)))
            .filter(|(_, status)| *status != 0)
            .collect(),
    }
}
