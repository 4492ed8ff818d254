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

/// A year of readings every minute.
fn climate_log() -> Vec<u8> {
    let mut text = "Time,Temperature (°C),Relative Humidity (%)\n".to_owned();
    let start = jiff::civil::date(2025, 1, 1).at(0, 0, 0, 0);
    for minute in 0..525_600i64 {
        let at = start + jiff::SignedDuration::from_mins(minute);
        let percent = 45.0 + (minute as f64 / 777.0).sin();
        let _ = writeln!(text, "{},21.35,{percent:.1}", at.strftime("%Y-%m-%d %H:%M:%S"));
    }
    text.into_bytes()
}

fn read_climate_log(criterion: &mut Criterion) {
    let bytes = climate_log();
    let context = ReadContext::default();
    let mut group = criterion.benchmark_group("climate");
    group.sample_size(10);
    group.bench_function("a year of minutes, 525600 x 2", |bencher| {
        bencher.iter(|| read("log.csv", black_box(&bytes), &context).map(|reading| reading.tables.len()));
    });
    group.finish();
}

criterion_group!(benches, read_plain_table, read_climate_log);
criterion_main!(benches);
