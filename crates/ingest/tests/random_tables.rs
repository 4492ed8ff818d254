//! Tables in random dialects: what is read is right, and what cannot be known is asked or refused.

#[allow(dead_code)]
#[path = "../examples/random_tables/clock.rs"]
mod clock;
#[allow(dead_code)]
#[path = "../examples/random_tables/compare.rs"]
mod compare;
#[allow(dead_code)]
#[path = "../examples/random_tables/count.rs"]
mod count;
#[allow(dead_code)]
#[path = "../examples/random_tables/dialect.rs"]
mod dialect;
#[allow(dead_code)]
#[path = "../examples/random_tables/dice.rs"]
mod dice;
#[allow(dead_code)]
#[path = "../examples/random_tables/ending.rs"]
mod ending;
#[allow(dead_code)]
#[path = "../examples/random_tables/expected.rs"]
mod expected;
#[allow(dead_code)]
#[path = "../examples/random_tables/head.rs"]
mod head;
#[allow(dead_code)]
#[path = "../examples/random_tables/judge.rs"]
mod judge;
#[allow(dead_code)]
#[path = "../examples/random_tables/names.rs"]
mod names;
#[allow(dead_code)]
#[path = "../examples/random_tables/number.rs"]
mod number;
#[allow(dead_code)]
#[path = "../examples/random_tables/odd.rs"]
mod odd;
#[allow(dead_code)]
#[path = "../examples/random_tables/shapes.rs"]
mod shapes;
#[allow(dead_code)]
#[path = "../examples/random_tables/start.rs"]
mod start;
#[allow(dead_code)]
#[path = "../examples/random_tables/table.rs"]
mod table;
#[allow(dead_code)]
#[path = "../examples/random_tables/times.rs"]
mod times;
#[allow(dead_code)]
#[path = "../examples/random_tables/truth.rs"]
mod truth;
#[allow(dead_code)]
#[path = "../examples/random_tables/units.rs"]
mod units;
#[allow(dead_code)]
#[path = "../examples/random_tables/wall.rs"]
mod wall;
#[allow(dead_code)]
#[path = "../examples/random_tables/words.rs"]
mod words;
#[allow(dead_code)]
#[path = "../examples/random_tables/write.rs"]
mod write;

#[test]
fn no_table_in_a_random_dialect_is_misread_in_silence() {
    let counts = count::count(300, 1);
    assert_eq!(counts.wrong(), 0, "\n{}", counts.text(3));
}
