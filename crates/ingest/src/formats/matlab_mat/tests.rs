//! Files as MATLAB lays them out, made here byte by byte; tests/formats/matlab-mat holds what scipy writes.

use std::io::Write;

use super::*;
use ieap_domain::Quantity;

/// An element with its tag, filled up.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A small element: size and type in one word, up to four bytes in the other.
fn small(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = ((data.len() as u32) << 16 | kind).to_le_bytes().to_vec();
    bytes.extend(data);
    bytes.resize(8, 0);
    bytes
}

fn array(class: u32, name: &str, dimensions: [i32; 2], data: &[u8]) -> Vec<u8> {
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    let dimensions = dimensions.map(i32::to_le_bytes).concat();
    let named = if name.len() <= 4 && !name.is_empty() {
        small(1, name.as_bytes())
    } else {
        element(1, name.as_bytes())
    };
    element(
        14,
        &[element(6, &flags), element(5, &dimensions), named, data.to_vec()].concat(),
    )
}

fn doubles(name: &str, numbers: &[f64]) -> Vec<u8> {
    let data: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    array(6, name, [numbers.len() as i32, 1], &element(9, &data))
}

fn file(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, Platform: GLNXA64, Created on: Mon Nov 23 2026".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(variables.concat());
    bytes
}

fn packed(variable: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(variable).unwrap();
    let data = encoder.finish().unwrap();
    // Packed elements are not filled up.
    [
        &15u32.to_le_bytes()[..],
        &(data.len() as u32).to_le_bytes(),
        &data,
    ]
    .concat()
}

const TIME_S: [f64; 4] = [-1.0, 0.0, 1.0, 2.0];
const CURRENT_MA: [f64; 4] = [0.0, 1.25, 0.5, 0.25];

fn read(bytes: &[u8]) -> Result<Reading, ReadError> {
    MatlabMat.read(bytes, &ReadContext::default())
}

fn current(reading: &Reading) -> Vec<f64> {
    let channels = reading.tables[0].channels.iter();
    let mut of_current = channels.filter(|channel| channel.quantity == Quantity::Current);
    of_current.next().expect("a current").values.to_vec()
}

#[test]
fn vectors_are_columns_packed_or_not_and_whole_doubles_may_be_small_integers() {
    let voltage = array(6, "voltage_V", [1, 4], &small(2, &[0, 2, 2, 2]));
    let plain = file(&[
        doubles("time_s", &TIME_S),
        voltage.clone(),
        doubles("current_mA", &CURRENT_MA),
    ]);
    let reading = read(&plain).unwrap();
    assert_eq!(current(&reading), [0.0, 1.25e-3, 0.5e-3, 0.25e-3]);
    assert_eq!((reading.tables[0].rows, reading.tables[0].channels.len()), (4, 2));
    let variables = [
        doubles("time_s", &TIME_S),
        voltage,
        doubles("current_mA", &CURRENT_MA),
    ];
    let all_packed: Vec<Vec<u8>> = variables.iter().map(|variable| packed(variable)).collect();
    assert_eq!(read(&file(&all_packed)).unwrap().tables, reading.tables);
    assert!(reading.original_metadata[0].1.contains("GLNXA64"));
}

#[test]
fn fields_of_a_struct_are_columns_too() {
    let mut names = b"time_s".to_vec();
    names.resize(16, 0);
    names.extend(b"current_mA");
    names.resize(32, 0);
    let parts = [
        small(5, &16i32.to_le_bytes()),
        element(1, &names),
        doubles("", &TIME_S),
        doubles("", &CURRENT_MA),
    ];
    let operator = array(4, "operator", [1, 2], &small(4, &[b'V', 0, b'V', 0]));
    let reading = read(&file(&[array(2, "data", [1, 1], &parts.concat()), operator])).unwrap();
    assert_eq!(current(&reading)[1], 1.25e-3);
    assert!(
        reading
            .original_metadata
            .contains(&("operator".to_owned(), "VV".to_owned()))
    );
}

fn text(name: &str, characters: &str) -> Vec<u8> {
    let units: Vec<u8> = characters.encode_utf16().flat_map(u16::to_le_bytes).collect();
    array(
        4,
        name,
        [1, characters.encode_utf16().count() as i32],
        &element(17, &units),
    )
}

#[test]
fn a_matrix_is_read_where_one_list_of_texts_names_its_columns() {
    let numbers: Vec<u8> = [TIME_S, CURRENT_MA]
        .concat()
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    let matrix = array(6, "run", [4, 2], &element(9, &numbers));
    let names = |name: &str| {
        array(
            1,
            name,
            [1, 2],
            &[text("", "Time_s_"), text("", "Current_mA_")].concat(),
        )
    };
    let reading = read(&file(&[names("names"), matrix.clone()])).unwrap();
    assert_eq!(current(&reading)[1], 1.25e-3);
    // An array of characters, stored column by column, its rows filled up with blanks.
    let rows = ["time_s    ", "current_mA"].map(|row| row.chars().collect::<Vec<_>>());
    let filled: String = (0..10).flat_map(|at| [rows[0][at], rows[1][at]]).collect();
    let units: Vec<u8> = filled.bytes().collect();
    let characters = array(4, "names", [2, 10], &element(16, &units));
    assert_eq!(
        current(&read(&file(&[characters, matrix.clone()])).unwrap())[1],
        1.25e-3
    );
    for lists in [vec![], vec![names("a"), names("b")]] {
        let refused = read(&file(&[lists.concat(), matrix.clone()])).unwrap_err();
        assert!(matches!(refused, ReadError::NoRunAmong { .. }), "{refused}");
    }
}

#[test]
fn what_cannot_be_used_says_where_and_how_to_name_it() {
    let refused = read(&file(&[doubles("t", &TIME_S), doubles("current", &CURRENT_MA)])).unwrap_err();
    let issue = refused.issue();
    assert!(
        issue.message.contains("variables of their own"),
        "{}",
        issue.message
    );
    assert!(
        issue.mend.contains("time_s") && !issue.mend.contains("profile"),
        "{}",
        issue.mend
    );
}

#[test]
fn what_is_no_column_is_named() {
    // A datetime: an object, without dimensions; its bytes stand in a last variable without a name.
    let flags = element(6, &[17u32.to_le_bytes(), [0; 4]].concat());
    let object = element(
        14,
        &[
            flags,
            element(1, b"started"),
            element(1, b"MCOS"),
            element(1, b"datetime"),
        ]
        .concat(),
    );
    let table: Vec<u8> = [1.0f64; 6]
        .iter()
        .flat_map(|number| number.to_le_bytes())
        .collect();
    let reading = read(&file(&[
        doubles("time_s", &TIME_S),
        doubles("current_mA", &CURRENT_MA),
        doubles("calibration", &[1.0, 2.0]),
        array(6, "raw", [2, 3], &element(9, &table)),
        array(
            1,
            "notes",
            [1, 1],
            &array(6, "", [1, 1], &element(9, &1.0f64.to_le_bytes())),
        ),
        object.clone(),
        array(9, "", [2, 1], &small(2, &[1, 2])),
    ]))
    .unwrap();
    let said: Vec<&str> = reading
        .issues
        .iter()
        .map(|issue| issue.message.as_str())
        .collect();
    let tells = |what: &str| said.iter().any(|message| message.contains(what));
    assert!(
        tells("calibration") && tells("2 x 3") && tells("a cell array") && tells("table2struct"),
        "{said:?}"
    );
}

#[test]
fn numbers_of_the_other_order_of_bytes_are_the_same() {
    let swap = |kind: u32, data: Vec<u8>| {
        let mut bytes = [kind.to_be_bytes(), (data.len() as u32).to_be_bytes()].concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    };
    let array = |name: &str, numbers: &[f64]| {
        let flags = [6u32.to_be_bytes(), [0; 4]].concat();
        let dimensions = [numbers.len() as i32, 1].map(i32::to_be_bytes).concat();
        let data = numbers.iter().flat_map(|number| number.to_be_bytes()).collect();
        let parts = [
            swap(6, flags),
            swap(5, dimensions),
            swap(1, name.as_bytes().to_vec()),
            swap(9, data),
        ];
        swap(14, parts.concat())
    };
    let mut bytes = file(&[]);
    bytes.truncate(124);
    bytes.extend([1, 0, b'M', b'I']);
    bytes.extend(array("time_s", &TIME_S));
    bytes.extend(array("current_mA", &CURRENT_MA));
    assert_eq!(current(&read(&bytes).unwrap()), [0.0, 1.25e-3, 0.5e-3, 0.25e-3]);
}

#[test]
fn damage_is_refused_at_any_byte_and_never_ends_the_program() {
    let whole = file(&[
        packed(&doubles("time_s", &TIME_S)),
        doubles("current_mA", &CURRENT_MA),
    ]);
    assert!(read(&whole).is_ok());
    for end in 0..whole.len() {
        assert!(read(&whole[..end]).is_err(), "cut at {end}");
    }
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << bit;
            let _ = read(&flipped);
        }
    }
}

#[test]
fn what_unpacks_to_too_much_and_what_is_hdf5_is_refused_with_a_way_out() {
    let many = file(&[packed(&doubles("time_s", &vec![0.0; 100_000]))]);
    let context = ReadContext {
        max_unpacked_bytes: 1000,
        ..ReadContext::default()
    };
    assert!(matches!(
        MatlabMat.read(&many, &context),
        Err(ReadError::TooLarge { .. })
    ));
    // Numbers take eight bytes each, whatever they are stored in.
    let small_numbers = file(&[array(9, "a", [1, 800], &element(2, &[0; 800]))]);
    assert!(matches!(
        MatlabMat.read(&small_numbers, &context),
        Err(ReadError::TooLarge { found: 6400, .. })
    ));
    let mut hdf5 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".to_vec();
    hdf5.resize(1024, 0);
    assert!(matches!(read(&hdf5), Err(ReadError::NotRead { mend, .. }) if mend.contains("-v7")));
}
