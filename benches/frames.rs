//! Time to trace a frame of 1280 x 1024 pixels, with its decoding and without.

#[allow(dead_code)]
#[path = "../tests/it/rendered.rs"]
mod rendered;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use ieap::strip::{View, decode, trace};
use rendered::{Frame, Scene};

fn file(frame: &Frame) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, frame.width as u32, frame.height as u32);
    encoder.set_color(png::ColorType::Grayscale);
    let written = encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(&frame.pixels));
    written.expect("a picture in memory");
    file
}

fn frames(criterion: &mut Criterion) {
    let scene = Scene {
        dust: 30,
        root: 0.8,
        ..Scene::default()
    };
    let frame = scene.draw(1150.0, |s| 0.0012 * (-s / 400.0).exp());
    let bytes = file(&frame);
    let gray = decode(&bytes).expect("a picture just written");
    criterion.bench_function("trace 1280 x 1024, decoded", |bencher| {
        bencher.iter(|| trace(black_box(&gray), &View::default()));
    });
    criterion.bench_function("decode 1280 x 1024 PNG", |bencher| {
        bencher.iter(|| decode(black_box(&bytes)));
    });
}

criterion_group!(benches, frames);
criterion_main!(benches);
