//! Speed of reading a plain run table: 36,000 rows of four columns.

use std::fmt::Write;
use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use ieap::ingest::formats::{ReadContext, read};

fn plain_table(rows: u32) -> Vec<u8> {
    let mut text = "time_s,voltage_v,current_a,curvature_per_cm\n".to_owned();
    for k in 0..rows {
        let time_s = f64::from(k) * 0.1;
        let decay = (-time_s / 300.0).exp();
        let _ = writeln!(
            text,
            "{time_s:.3},2.5,{:e},{:.9}",
            1.234e-3 * decay,
            0.1 * (1.0 - decay)
        );
    }
    text.into_bytes()
}

fn read_plain_table(criterion: &mut Criterion) {
    let bytes = plain_table(36_000);
    let context = ReadContext::default();
    criterion.bench_function("plain table, 36000 x 4", |bencher| {
        bencher.iter(|| read("run.csv", black_box(&bytes), &context).map(|reading| reading.tables.len()));
    });
}

criterion_group!(benches, read_plain_table);
criterion_main!(benches);
