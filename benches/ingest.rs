//! Speed of the readers on one core: a plain run table of 36,000 rows, and long files of several formats in bytes a
//! second. Where the system tells (Linux), the processor time of the thread is measured and not the clock on the wall,
//! so that other work on the machine disturbs less.

use std::fmt::Write;
use std::hint::black_box;

use std::time::{Duration, Instant};

use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ieap::ingest::formats::{ReadContext, read};

/// Processor time of the thread; the clock on the wall where the system does not tell.
struct ThreadTime {
    begun: Instant,
}

impl ThreadTime {
    fn now(&self) -> Duration {
        let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
        let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse().ok());
        nanoseconds.map_or_else(|| self.begun.elapsed(), Duration::from_nanos)
    }
}

impl Measurement for ThreadTime {
    type Intermediate = Duration;
    type Value = Duration;

    fn start(&self) -> Duration {
        self.now()
    }

    fn end(&self, begun: Duration) -> Duration {
        self.now().saturating_sub(begun)
    }

    fn add(&self, a: &Duration, b: &Duration) -> Duration {
        *a + *b
    }

    fn zero(&self) -> Duration {
        Duration::ZERO
    }

    fn to_f64(&self, value: &Duration) -> f64 {
        value.as_nanos() as f64
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        WallTime.formatter()
    }
}

/// Rows of the long files.
const LONG: u32 = 200_000;

/// Time, current and curvature of a row.
fn readings(row: u32) -> (f64, f64, f64) {
    let time_s = f64::from(row) * 0.1;
    let decay = (-time_s / 300.0).exp();
    (time_s, 1.234e-3 * decay, 0.1 * (1.0 - decay))
}

/// A text with a header and a line a row.
fn text(header: &str, rows: u32, mut line: impl FnMut(&mut String, (f64, f64, f64))) -> Vec<u8> {
    let mut text = header.to_owned();
    (0..rows).for_each(|row| line(&mut text, readings(row)));
    text.into_bytes()
}

fn plain_table(rows: u32) -> Vec<u8> {
    text(
        "time_s,voltage_v,current_a,curvature_per_cm\n",
        rows,
        |text, (t, i, k)| {
            let _ = writeln!(text, "{t:.3},2.5,{i:e},{k:.9}");
        },
    )
}

fn long_files() -> Vec<(&'static str, Vec<u8>)> {
    let decimal_comma = text(
        "time_s;voltage_v;current_a;curvature_per_cm\r\n",
        LONG,
        |text, (t, i, k)| {
            let _ = write!(
                text,
                "{}\r\n",
                format!("{t:.3};2.5;{i:.9};{k:.9}").replace('.', ",")
            );
        },
    );
    let gamry = text(
        "EXPLAIN\r\nTAG\tCHRONOA\r\nCURVE\tTABLE\r\n\tPt\tT\tVf\tIm\tOver\r\n\t#\ts\tV vs. Ref.\tA\tbits\r\n",
        LONG,
        |text, (t, i, _)| {
            let _ = write!(text, "\t1\t{t:.4}\t2.50012E+000\t{i:.5E}\t...........\r\n");
        },
    );
    let biologic = text(
        "EC-Lab ASCII FILE\r\nNb header lines : 3\r\ntime/s\tEwe/V\tI/mA\tcycle number\t\r\n",
        LONG,
        |text, (t, i, _)| {
            let _ = write!(text, "{t:.15E}\t2.5000123E+000\t{:.15E}\t1\r\n", i * 1e3);
        },
    );
    let chi = text(
        "May 3, 2026   10:20:30\r\nAmperometric i-t Curve\r\nInstrument Model:  CHI760E\r\n\r\n\
         Time/sec, Current/A\r\n\r\n",
        LONG,
        |text, (t, i, _)| {
            let _ = write!(text, "{t:.7e}, {i:.4e}\r\n");
        },
    );
    vec![
        ("plain table", plain_table(LONG)),
        ("plain table, decimal comma", decimal_comma),
        ("Gamry", gamry),
        ("BioLogic text", biologic),
        ("CH Instruments", chi),
        ("TDMS", tdms(1_000_000)),
    ]
}

/// One segment with two channels of doubles, one after the other.
fn tdms(rows: u32) -> Vec<u8> {
    let text = |bytes: &mut Vec<u8>, text: &str| {
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
    };
    let mut meta = 2u32.to_le_bytes().to_vec();
    for (path, unit) in [("/'run'/'Current'", "A"), ("/'run'/'Voltage'", "V")] {
        text(&mut meta, path);
        meta.extend(20u32.to_le_bytes());
        meta.extend(10u32.to_le_bytes());
        meta.extend(1u32.to_le_bytes());
        meta.extend(u64::from(rows).to_le_bytes());
        meta.extend(2u32.to_le_bytes());
        text(&mut meta, "unit_string");
        meta.extend(0x20u32.to_le_bytes());
        text(&mut meta, unit);
        text(&mut meta, "wf_increment");
        meta.extend(10u32.to_le_bytes());
        meta.extend(0.001f64.to_le_bytes());
    }
    let data: Vec<u8> = (0..2)
        .flat_map(|channel| (0..rows).map(move |row| readings(row).1 + f64::from(channel)))
        .flat_map(f64::to_le_bytes)
        .collect();
    let mut bytes = b"TDSm".to_vec();
    bytes.extend(0b1110u32.to_le_bytes());
    bytes.extend(4713u32.to_le_bytes());
    bytes.extend(((meta.len() + data.len()) as u64).to_le_bytes());
    bytes.extend((meta.len() as u64).to_le_bytes());
    bytes.extend(meta);
    bytes.extend(data);
    bytes
}

fn read_plain_table(criterion: &mut Criterion<ThreadTime>) {
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

fn read_climate_log(criterion: &mut Criterion<ThreadTime>) {
    let bytes = climate_log();
    let context = ReadContext::default();
    let mut group = criterion.benchmark_group("climate");
    group.sample_size(10);
    group.bench_function("a year of minutes, 525600 x 2", |bencher| {
        bencher.iter(|| read("log.csv", black_box(&bytes), &context).map(|reading| reading.tables.len()));
    });
    group.finish();
}

fn read_long_files(criterion: &mut Criterion<ThreadTime>) {
    let context = ReadContext::default();
    let mut group = criterion.benchmark_group("long");
    group.sample_size(10);
    for (name, bytes) in long_files() {
        let rows = read("run.txt", &bytes, &context).map(|reading| reading.tables[0].rows);
        assert!(
            rows.is_ok_and(|rows| rows >= LONG as usize),
            "{name} is not read whole"
        );
        group.throughput(Throughput::Bytes(bytes.len() as u64));
        group.bench_function(name, |bencher| {
            bencher.iter(|| read("run.txt", black_box(&bytes), &context).map(|reading| reading.tables.len()));
        });
    }
    group.finish();
}

fn measured() -> Criterion<ThreadTime> {
    Criterion::default().with_measurement(ThreadTime {
        begun: Instant::now(),
    })
}

criterion_group! {
    name = benches;
    config = measured();
    targets = read_plain_table, read_long_files, read_climate_log
}
criterion_main!(benches);
