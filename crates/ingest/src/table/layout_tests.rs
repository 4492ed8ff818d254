//! Texts under which delimiter, decimal sign, names and units are found, and what is refused.

use super::*;
use crate::text::Lines;

fn layout(text: &str) -> Result<Layout, ReadError> {
    decide(&Lines::new(text).collect::<Vec<_>>(), &ReadContext::default())
}

fn dialect(text: &str) -> (Delimiter, Decimal) {
    let layout = layout(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    (layout.dialect.delimiter, layout.dialect.numbers.decimal)
}

#[test]
fn every_delimiter_with_its_decimal_sign() {
    for (text, delimiter, decimal) in [
        ("time_s,current_a\n0.5,1.5\n", Delimiter::Comma, Decimal::Point),
        (
            "time_s;current_a\n0.5;1.5\n",
            Delimiter::Semicolon,
            Decimal::Point,
        ),
        (
            "time_s;current_a\n0,5;1,5\n",
            Delimiter::Semicolon,
            Decimal::Comma,
        ),
        ("time_s\tcurrent_a\n0,5\t1,5\n", Delimiter::Tab, Decimal::Comma),
        (
            "Time (s)  I/mA\n0.5  1.5\n",
            Delimiter::WideBlanks,
            Decimal::Point,
        ),
        ("Time (s) I/mA\n0.5 1.5\n", Delimiter::Blanks, Decimal::Point),
        (
            "Time (s) ;  I/mA\n  0,5;  1\n",
            Delimiter::Semicolon,
            Decimal::Comma,
        ),
        (
            "\"Time, s\",\"I/mA\"\n\"0,5\",\"1,5\"\n",
            Delimiter::Comma,
            Decimal::Comma,
        ),
    ] {
        assert_eq!(dialect(text), (delimiter, decimal), "{text}");
    }
}

#[test]
fn a_late_decimal_comma_is_found() {
    let mut text = "time_s;current_a\n".to_owned();
    (0..400).for_each(|k| text.push_str(&format!("{k};0\n")));
    text.push_str("400;0,5\n");
    assert_eq!(dialect(&text).1, Decimal::Comma);
}

#[test]
fn two_readings_are_refused() {
    for text in ["time_s,current_a\n0,5,1,5\n", "time_s;current_a\n0.5,0;1,5\n"] {
        let error = layout(text).unwrap_err();
        assert!(
            matches!(error, ReadError::NoReading { line: 2, .. }) && error.code() == "ambiguous-numbers",
            "{error}"
        );
    }
}

#[test]
fn mixed_decimal_signs_are_refused() {
    let error = layout("time_s;current_a\n0;1.5\n1;1,5\n").unwrap_err();
    assert!(
        error.to_string().contains("decimal point") && error.to_string().contains("decimal comma"),
        "{error}"
    );
}

#[test]
fn units_below_say_what_numbered_inputs_measure() {
    let scope = layout("x-axis,1,2\nsecond,Volt,Ampere\n-1.5E-03,0.5,1E-3\n0,1.0,2E-3\n").unwrap();
    let found: Vec<Option<Quantity>> = scope.headers().iter().map(|h| h.meaning.quantity()).collect();
    assert_eq!(
        found,
        [
            Some(Quantity::Time),
            Some(Quantity::Voltage),
            Some(Quantity::Current)
        ]
    );
    assert_eq!((scope.shape.names_at, scope.shape.data_at), (Some(0), 2));
    // Which of two voltages is the drive, nothing says.
    let two = layout("x-axis,1,2\nsecond,Volt,Volt\n0,0.5,1\n1,1,2\n").unwrap();
    assert!(two.headers()[1..].iter().all(|h| h.meaning == Meaning::Other));
    assert!(layout("x-axis,1\nmm,Volt\n0,0.5\n1,1\n").is_err());
}

#[test]
fn a_modulus_may_be_swept_over_the_frequency_without_times() {
    let sweep = layout("Nr;f;T;E'\n;Hz;\u{b0}C;MPa\n1;0,5;25;60,5\n2;1;25;61\n").unwrap();
    assert_eq!(sweep.dialect.numbers.decimal, Decimal::Comma);
    assert_eq!(sweep.headers()[1].meaning.quantity(), Some(Quantity::Frequency));
}

#[test]
fn a_preamble_may_speak_of_time() {
    let layout = layout("Date;17.7.2024\nTime;12:30:05\nTime (s);I/mA\n0;1\n").unwrap();
    assert_eq!((layout.shape.names_at, layout.shape.data_at), (Some(2), 3));
}

#[test]
fn units_may_stand_in_a_row_of_their_own() {
    let layout = layout("preamble\n\ntime,current\ns,mA\n0,1\n").unwrap();
    assert_eq!((layout.shape.names_at, layout.shape.data_at), (Some(2), 4));
    assert_eq!(layout.headers()[1].meaning.quantity(), Some(Quantity::Current));
    // Anton Paar: brackets, columns without a unit, and a blank line between.
    let text = "Project:\tx\nInterval data:\tPoint No.\tTime\tStorage Modulus\n\t\t\t\n\t\t[min]\t[Pa]\n\t1\t0.5\t2e6\n";
    let layout = self::layout(text).unwrap();
    assert_eq!((layout.shape.names_at, layout.shape.data_at), (Some(1), 4));
    let headers = layout.headers();
    let units: Vec<&str> = headers.iter().map(|header| header.raw_unit.as_str()).collect();
    assert_eq!(units, ["", "", "min", "Pa"]);
}

#[test]
fn a_mend_does_not_advise_what_is_there() {
    let mend = |text: &str| layout(text).unwrap_err().mend();
    assert!(!mend("time_s\tcurrent_a\n0\t1.5\n1\t1,5\n").contains("tabs"));
    assert!(mend("time_s,current_a\n0,5,1,5\n").contains("tabs"));
    assert!(mend("time_s\tcurrent_a\n0\t1\t2\n1\t1\t2\n").contains("as many fields"));
}

#[test]
fn a_missing_header_or_body_is_named() {
    assert!(matches!(
        layout("1,2\n3,4\n"),
        Err(ReadError::NoHeader { line: 1, .. })
    ));
    let spectrum = layout("# a comment\nfrequency_hz,impedance_magnitude_ohm\n1,2\n3,4\n").unwrap_err();
    assert!(matches!(spectrum, ReadError::NoImpedance { line: 2, .. }));
    assert!(spectrum.mend().contains("impedance_phase_degree"));
    assert!(matches!(
        layout("time_s,current_a\n# no more\n"),
        Err(ReadError::HeaderOnly { line: 1, .. })
    ));
}
