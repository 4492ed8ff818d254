//! Strips of known shape, drawn as a camera sees them, come back from their pictures; what cannot be traced is
//! refused with its reason.

use ieap::model::Branch;
use ieap::model::coupling::{ActiveArea, CurvaturePerTotalCharge};
use ieap::model::distributed::{DistributedModel, Laminate};
use ieap::strip::{Crop, Gray, Side, Tone, Trace, Untraceable, View, decode, overlay, trace};

use crate::campaign::CampaignFolder;
use crate::rendered::{Frame, Held, Scene};

/// Pixels to a centimetre: a strip of 45 mm fills most of a frame of 1280 pixels.
const PX_PER_CM: f64 = 260.0;
const ALL_HELD: [Held; 4] = [Held::Left, Held::Right, Held::Top, Held::Bottom];

fn gray(frame: &Frame) -> Gray {
    let values = frame.pixels.iter().map(|v| f32::from(*v) / 255.0).collect();
    Gray::new(frame.width, frame.height, values).unwrap()
}

pub fn png_bytes(frame: &Frame) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, frame.width as u32, frame.height as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::Fast);
    encoder
        .write_header()
        .unwrap()
        .write_image_data(&frame.pixels)
        .unwrap();
    file
}

/// PtNaf of table 3 of the thesis, a strip of 45 mm by 3 mm.
pub fn ptnaf() -> DistributedModel {
    let of = ActiveArea {
        length_cm: 4.5,
        width_cm: 0.3,
    };
    Laminate {
        electrode_resistance_ohm_per_sq: 4.5,
        branch: Branch {
            resistance_ohm_cm2: 3.0,
            capacitance_f_per_cm2: 0.0197,
        },
        steady_state_resistance_ohm_cm2: 42.9,
        coupling: CurvaturePerTotalCharge(29.5).areal(&of),
        relaxation_rate_per_s: 0.29,
    }
    .strip(&of)
}

/// Holds a trace against the truth: curvature within 1 % or 0.005/cm, whichever is more, the tip within 0.3 pixel.
fn assert_truth(what: &str, traced: &Trace, frame: &Frame, length: f64, curvature: &dyn Fn(f64) -> f64) {
    let tip = traced.tip_px();
    let off = (tip.0 - frame.tip.0).hypot(tip.1 - frame.tip.1);
    assert!(off < 0.3, "{what}: tip off by {off:.3} px");
    for k in 1..20 {
        let s = length * f64::from(k) / 20.0;
        let (found, error) = traced.curvature_per_px(s);
        let off = (found - curvature(s)) * PX_PER_CM;
        let allowed = (0.01 * curvature(s).abs() * PX_PER_CM).max(0.005);
        assert!(
            off.abs() < allowed,
            "{what}: curvature off by {off:.4}/cm at {k}/20 of the length, {allowed:.4} allowed, {:.4} stated",
            error * PX_PER_CM
        );
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn arcs_come_back_from_every_side_dark_and_bright() {
    for (k, held) in ALL_HELD.into_iter().enumerate() {
        for dark in [true, false] {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let per_cm = sign * [0.0, 0.35, 0.9, 0.6][(k + usize::from(dark)) % 4];
            let scene = Scene {
                held,
                dark,
                tilt_rad: 0.08,
                seed: 11 + k as u64,
                ..Scene::default()
            };
            let curvature = |_: f64| per_cm / PX_PER_CM;
            let frame = scene.draw(700.0, curvature);
            let what = format!("{held:?}, dark {dark}, {per_cm}/cm");
            let traced = trace(&gray(&frame), &View::default()).unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_truth(&what, &traced, &frame, 700.0, &curvature);
            let tone = if dark { Tone::Dark } else { Tone::Bright };
            assert_eq!((traced.tone, traced.clamp as usize), (tone, k), "{what}");
            let (mean, error) = traced.mean_curvature_per_px();
            assert!((mean - curvature(0.0)).abs() < 5.0 * error + 1e-6, "{what}");
        }
    }
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn shapes_of_the_distributed_model_come_back_through_a_bad_view() {
    let model = ptnaf();
    let length = 4.5 * PX_PER_CM;
    let places: Vec<f64> = (0..=450).map(|k| 0.01 * f64::from(k)).collect();
    for (k, time_s) in [0.05, 0.3, 1.0, 4.0].into_iter().enumerate() {
        let along = model.curvature_per_cm(0.25, &places, &[time_s]).values;
        let curvature = |s: f64| {
            let u = (s / PX_PER_CM * 100.0).clamp(0.0, 449.999);
            let (i, t) = (u as usize, u.fract());
            (along[i] * (1.0 - t) + along[i + 1] * t) / PX_PER_CM
        };
        for dirty in [false, true] {
            let scene = Scene {
                root: 0.8,
                thickness: 7.0,
                uneven: 0.5,
                blur: 1.3,
                noise: 2.5,
                dust: if dirty { 40 } else { 0 },
                reflection: dirty,
                dark: k % 2 == 0,
                seed: 3 + k as u64,
                ..Scene::default()
            };
            let frame = scene.draw(length, curvature);
            let what = format!("PtNaf at {time_s} s, dirty {dirty}");
            let traced = trace(&gray(&frame), &View::default()).unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_truth(&what, &traced, &frame, length, &curvature);
        }
    }
}

#[test]
fn a_strip_that_turns_back_is_followed() {
    // 165 degrees: the tip points back at the side of the clamp.
    let per_px = 165f64.to_radians() / 700.0;
    let scene = Scene {
        root: 0.75,
        ..Scene::default()
    };
    let frame = scene.draw(700.0, |_| per_px);
    let traced = trace(&gray(&frame), &View::default()).unwrap();
    assert_truth("165 degrees", &traced, &frame, 700.0, &|_| per_px);
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn stated_errors_are_those_that_are_made() {
    let (mut square, mut count) = (0.0, 0.0);
    for seed in 0..12 {
        let scene = Scene {
            seed,
            noise: 3.0,
            tilt_rad: 0.02 * seed as f64,
            ..Scene::default()
        };
        let curvature = |s: f64| 0.5 / PX_PER_CM * (-s / 300.0).exp();
        let frame = scene.draw(800.0, curvature);
        let traced = trace(&gray(&frame), &View::default()).unwrap();
        for k in 1..20 {
            let s = 40.0 * f64::from(k);
            let (found, error) = traced.curvature_per_px(s);
            square += ((found - curvature(s)) / error).powi(2);
            count += 1.0;
        }
    }
    let ratio = f64::sqrt(square / count);
    assert!(
        (0.6..1.5).contains(&ratio),
        "errors made are {ratio:.2} times those stated"
    );
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn what_cannot_be_traced_is_refused_with_its_reason() {
    let plain = Scene::default();
    let strip = |scene: &Scene, length: f64, per_cm: f64| gray(&scene.draw(length, |_| per_cm / PX_PER_CM));
    let empty = strip(
        &Scene {
            thickness: 0.0,
            ..plain.clone()
        },
        600.0,
        0.0,
    );
    let two = {
        let one = plain.draw(600.0, |_| 0.3 / PX_PER_CM);
        let other = Scene {
            root: 0.85,
            ..plain.clone()
        }
        .draw(600.0, |_| 0.3 / PX_PER_CM);
        let pixels = one.pixels.iter().zip(&other.pixels).map(|(a, b)| *a.min(b));
        let values = pixels.map(|v| f32::from(v) / 255.0).collect();
        Gray::new(one.width, one.height, values).unwrap()
    };
    let beyond = strip(&plain, 1400.0, 0.05);
    let whole = View::default();
    let crop = |left, top, width, height| View {
        crop: Some(Crop {
            left,
            top,
            width,
            height,
        }),
        ..whole
    };
    let held = View {
        clamp: Some(Side::Top),
        ..whole
    };
    let with_clamp = {
        let mut frame = plain.draw(600.0, |_| 0.2 / PX_PER_CM);
        for y in 400..620 {
            frame.pixels[y * 1280..y * 1280 + 90].fill(20);
        }
        gray(&frame)
    };
    let floating = crop(100, 0, 1180, 1024);
    let speckled = strip(
        &Scene {
            thickness: 0.0,
            dust: 400,
            ..plain.clone()
        },
        600.0,
        0.0,
    );
    let cases = [
        ("empty", trace(&empty, &whole)),
        (
            "two strips",
            trace(
                &two,
                &View {
                    clamp: Some(Side::Left),
                    ..whole
                },
            ),
        ),
        (
            "leaves the picture",
            trace(
                &beyond,
                &View {
                    clamp: Some(Side::Left),
                    ..whole
                },
            ),
        ),
        (
            "clamp on the other side",
            trace(&strip(&plain, 600.0, 0.1), &held),
        ),
        ("clamp in view", trace(&with_clamp, &whole)),
        ("crop beyond the picture", trace(&empty, &crop(900, 0, 900, 900))),
        ("crop too small", trace(&empty, &crop(0, 0, 20, 900))),
        (
            "strip hidden by a crop",
            trace(
                &strip(
                    &Scene {
                        held: Held::Top,
                        ..plain.clone()
                    },
                    600.0,
                    0.0,
                ),
                &crop(700, 0, 580, 1024),
            ),
        ),
        ("dust only", trace(&speckled, &whole)),
        ("dust only, cropped", trace(&speckled, &floating)),
    ];
    let told: Vec<String> = cases
        .iter()
        .map(|(what, traced)| match traced {
            Ok(_) => panic!("{what} was traced"),
            Err(refusal) => format!("{what}: {refusal}"),
        })
        .collect();
    insta::assert_snapshot!(told.join("\n"));
    assert!(matches!(cases[0].1, Err(Untraceable::Empty { .. })));
}

/// Frames of a strip that bends, as files of a folder: three before the step and nine after it.
fn write_frames(folder: &CampaignFolder, under: &str) -> Vec<f64> {
    let bent: Vec<f64> = (0..12).map(|k| 0.06 * f64::from((k - 2).max(0))).collect();
    for (k, per_cm) in bent.iter().enumerate() {
        let scene = Scene {
            width: 480,
            height: 320,
            root: 0.93,
            thickness: 6.0,
            tilt_rad: 0.02,
            seed: k as u64,
            ..Scene::default()
        };
        // An initial curvature, which is to be taken off.
        let frame = scene.draw(400.0, |_| (0.15 + per_cm) / 200.0);
        folder.write(&format!("{under}/f{k}.png"), png_bytes(&frame));
    }
    bent
}

fn columns(table: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let header = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let rows = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect());
    (header, rows.collect())
}

#[test]
fn a_folder_of_frames_becomes_a_run_table_with_pictures() {
    let folder = CampaignFolder::new();
    let bent = write_frames(&folder, "views/a");
    folder.write(
        "views/a/frames.toml",
        "px_per_mm = 20.0\nframes_per_second = 2.0\nfirst_frame_s = -1.0\nclamp = \"left\"\n",
    );
    let views = folder.path().join("views/a");
    let target = folder.path().join("traced");
    let (frames, out) = (views.to_str().unwrap(), target.to_str().unwrap());
    let summary = folder
        .ieap(&["trace", frames, "-o", out, "--json"])
        .expect(0)
        .json();
    assert_eq!(
        (&summary["frames"], &summary["traced"]),
        (&12.into(), &12.into()),
        "{summary:#}"
    );
    let table = std::fs::read_to_string(target.join("curvature.csv")).unwrap();
    let (header, rows) = columns(&table);
    assert_eq!(header[..3], ["time_s", "curvature_per_cm", "tip_displacement_mm"]);
    assert_eq!(rows.len(), 12);
    for (k, (row, truth)) in rows.iter().zip(&bent).enumerate() {
        assert!((row[0] - (0.5 * k as f64 - 1.0)).abs() < 1e-9);
        assert!((row[1] - truth).abs() < 0.005, "{} for {truth}", row[1]);
        for at in &row[3..22] {
            assert!((at - truth).abs() < 0.01f64.max(0.01 * truth), "{at} for {truth}");
        }
    }
    // Every picture is a picture of the frame's size, and the line is on it.
    for k in 0..12 {
        let drawn = decode(&std::fs::read(target.join(format!("overlays/f{k}.png"))).unwrap()).unwrap();
        assert_eq!((drawn.width(), drawn.height()), (480, 320));
    }
    // The same bytes at any number of threads, and nothing is replaced unasked.
    let refused = folder.ieap(&["trace", frames, "-o", out]).expect(2);
    assert!(refused.stderr.contains("--overwrite"), "{}", refused.stderr);
    folder
        .ieap(&[
            "trace",
            frames,
            "-o",
            out,
            "--overwrite",
            "--threads",
            "1",
            "--no-overlays",
        ])
        .expect(0);
    // What somebody put beside it is not overwritten with it.
    std::fs::write(target.join("thesis.tex"), "x").unwrap();
    let refused = folder
        .ieap(&["trace", frames, "-o", out, "--overwrite"])
        .expect(4);
    assert!(
        refused.stderr.contains("thesis.tex was not written"),
        "{refused:?}"
    );
    std::fs::remove_file(target.join("thesis.tex")).unwrap();
    assert_eq!(
        std::fs::read_to_string(target.join("curvature.csv")).unwrap(),
        table
    );
    // The program reads its own table.
    let read = folder
        .ieap(&[
            "inspect",
            target.join("curvature.csv").to_str().unwrap(),
            "--json",
        ])
        .expect(0)
        .json();
    let column = &read["runs"][0]["columns"][3];
    assert_eq!(
        (&column["canonical"], &column["position_mm"]),
        (&"curvature_per_cm".into(), &1.0.into()),
        "{column:#}"
    );
}

#[test]
fn a_frame_that_cannot_be_traced_is_listed_and_the_others_are_not_lost() {
    let folder = CampaignFolder::new();
    write_frames(&folder, "views/a");
    folder.write("views/a/f5.png", &b"\x89PNG\r\n\x1a\nbroken"[..]);
    let blank = Scene {
        width: 480,
        height: 320,
        thickness: 0.0,
        ..Scene::default()
    };
    folder.write("views/a/f7.png", png_bytes(&blank.draw(400.0, |_| 0.0)));
    let views = folder.path().join("views/a");
    let frames = views.to_str().unwrap();
    let out = folder.path().join("out");
    let out = out.to_str().unwrap();
    let untimed = folder
        .ieap(&["trace", frames, "-o", out, "--px-per-mm", "20"])
        .expect(2);
    assert!(untimed.stderr.contains("frames_per_second"), "{}", untimed.stderr);
    let unscaled = folder.ieap(&["trace", frames, "-o", out, "--frames-per-second", "2"]);
    let told = unscaled.expect(3);
    assert!(told.stdout.contains("the sample is"), "{told:?}");
    let options = [
        "--px-per-mm",
        "20",
        "--frames-per-second",
        "2",
        "--overwrite",
        "--json",
    ];
    let summary = folder
        .ieap(&[&["trace", frames, "-o", out], &options[..]].concat())
        .expect(3)
        .json();
    assert_eq!(summary["traced"], 10);
    let reasons: Vec<String> = summary["refused"]
        .as_array()
        .unwrap()
        .iter()
        .map(|refused| format!("{}: {}", refused["frame"], refused["reason"]))
        .collect();
    insta::assert_snapshot!(reasons.join("\n"));
}

#[test]
fn inspect_says_what_a_picture_is_and_where_to_go_with_it() {
    let folder = CampaignFolder::new();
    let whole = png_bytes(&Scene::default().draw(700.0, |_| 0.0));
    folder.write("f0.png", &whole);
    folder.write("f1.png", &whole[..whole.len() / 2]);
    let inspected = |name: &str| {
        let file = folder.join(name);
        let told = folder.ieap(&["inspect", file.to_str().unwrap(), "--json"]);
        told.expect(3).json()
    };
    let (frame, cut) = (inspected("f0.png"), inspected("f1.png"));
    assert_eq!(frame["status"], "frame", "{frame:#}");
    let text = frame["issues"][0].to_string();
    assert!(
        text.contains("PNG of 1280 x 1024") && text.contains("ieap trace"),
        "{text}"
    );
    assert_eq!(cut["status"], "refused", "{cut:#}");
    assert!(cut["issues"][0].to_string().contains("cannot be read"), "{cut:#}");
}

/// Against what lies beside the project.
mod needs_shared {
    use super::*;
    use crate::needs_shared::shared;

    #[test]
    fn real_views_of_textile_strips_are_traced() {
        let Some(folder) = shared("data/cantilever-textile-images") else {
            return;
        };
        let view = |name: &str| decode(&std::fs::read(folder.join(name)).unwrap()).unwrap();
        // Place of the tip as a person reads it off the picture, and how well.
        for (name, tip) in [
            ("test_image.jpg", (2018.0, 1226.0)),
            ("example_image.jpg", (2064.0, 1156.0)),
        ] {
            let gray = view(name);
            let traced = trace(&gray, &View::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
            let found = traced.tip_px();
            let off = (found.0 - tip.0).hypot(found.1 - tip.1);
            assert!(off < 25.0, "{name}: tip at {found:?}");
            assert_eq!((traced.tone, traced.clamp), (Tone::Bright, Side::Left));
            // It hangs by its own weight: bent most at the clamp, clockwise.
            let at = |share: f64| traced.curvature_per_px(share * traced.length_px()).0;
            assert!(
                at(0.05) < -3e-4 && at(0.05) < 2.0 * at(0.5),
                "{name}: {} {}",
                at(0.05),
                at(0.5)
            );
            assert!(overlay(&gray, &traced, 20).unwrap().len() > 100_000);
        }
        // Its authors mean it to break a method: the edge fades half-way.
        let broken = trace(&view("break_test_image.jpg"), &View::default());
        assert!(broken.is_err(), "{:?}", broken.map(|traced| traced.tip_px()));
    }
}
