//! How long a report of 200 runs takes.

use criterion::{Criterion, criterion_group, criterion_main};
use ieap::report::kept::Earlier;
use ieap::report::render;

#[path = "../tests/it/report_fixture.rs"]
#[allow(dead_code)]
mod report_fixture;

use report_fixture::{MadeUpCurves, input};

fn report_of_200_runs(criterion: &mut Criterion) {
    let mut input = input(&["CNaf", "CPvf"], 12);
    input.runs.truncate(200);
    let curves = MadeUpCurves::of(&input);
    let mut group = criterion.benchmark_group("report");
    group.sample_size(10);
    group.bench_function("200 runs, 2 curves each", |bencher| {
        bencher.iter(|| {
            let folder = tempfile::tempdir().expect("a folder");
            render(&input, &curves, &Earlier::none(), folder.path(), &|_, _| {}).expect("a site")
        });
    });
    group.finish();
}

criterion_group!(benches, report_of_200_runs);
criterion_main!(benches);
