//! What the decoders make of pictures written here, and of the same pictures damaged.

use proptest::prelude::*;

use super::*;

fn values(width: usize, height: usize) -> Vec<u8> {
    (0..width * height).map(|k| (k * 37 % 251) as u8).collect()
}

fn png_of(width: usize, height: usize, colour: png::ColorType, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header().unwrap().write_image_data(bytes).unwrap();
    file
}

fn tiff_of(pictures: usize) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).unwrap();
    for _ in 0..pictures {
        let samples: Vec<u16> = (0..20 * 12).map(|k| k * 200).collect();
        encoder
            .write_image::<tiff::encoder::colortype::Gray16>(20, 12, &samples)
            .unwrap();
    }
    file.into_inner()
}

#[test]
fn a_png_is_read_pixel_by_pixel() {
    let bytes = values(20, 12);
    let gray = decode(&png_of(20, 12, png::ColorType::Grayscale, &bytes)).unwrap();
    assert_eq!((gray.width(), gray.height()), (20, 12));
    assert!((gray.row(3)[5] - f32::from(bytes[65]) / 255.0).abs() < 1e-6);
    let rgb: Vec<u8> = bytes.iter().flat_map(|&v| [v, v, v]).collect();
    let of_colours = decode(&png_of(20, 12, png::ColorType::Rgb, &rgb)).unwrap();
    assert!((of_colours.row(3)[5] - gray.row(3)[5]).abs() < 1e-3);
}

/// A picture of a few pixels with a text of a megabyte, in less memory than the text has.
#[test]
fn a_text_in_a_png_is_passed_by_however_large_it_is() {
    let bytes = values(20, 12);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 20, 12);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let text = "a".repeat(1 << 20);
    encoder
        .add_text_chunk("Comment".to_owned(), text.clone())
        .unwrap();
    encoder.add_ztxt_chunk("Comment".to_owned(), text).unwrap();
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
    let gray = png_within(&file, 1 << 18).unwrap();
    assert_eq!((gray.width(), gray.height()), (20, 12));
}

#[test]
fn a_tiff_of_sixteen_bits_is_read_and_a_stack_is_not() {
    let gray = decode(&tiff_of(1)).unwrap();
    assert!((gray.row(1)[0] - 4000.0 / 65535.0).abs() < 1e-6);
    assert_eq!(decode(&tiff_of(2)).unwrap_err(), DecodeError::Stack);
}

#[test]
fn what_is_no_picture_is_said_to_be_none() {
    assert!(matches!(decode(b""), Err(DecodeError::Unknown { .. })));
    assert!(
        decode(b"time_s,current_a\n")
            .unwrap_err()
            .to_string()
            .contains("74 69 6d 65")
    );
}

#[test]
fn a_header_that_promises_too_much_takes_no_memory() {
    let mut file = png_of(20, 12, png::ColorType::Grayscale, &values(20, 12));
    file[16..20].copy_from_slice(&40_000u32.to_be_bytes());
    let crc = crc32fast::hash(&file[12..29]);
    file[29..33].copy_from_slice(&crc.to_be_bytes());
    assert!(
        matches!(decode(&file), Err(DecodeError::TooLarge { .. })),
        "{:?}",
        decode(&file)
    );
}

#[test]
fn a_file_cut_short_is_refused() {
    let png = png_of(40, 40, png::ColorType::Grayscale, &values(40, 40));
    let tiff = tiff_of(1);
    for (whole, most) in [(&png, png.len() - 20), (&tiff, tiff.len() - 40)] {
        for cut in (8..most).step_by(7) {
            assert!(decode(&whole[..cut]).is_err(), "{cut} of {}", whole.len());
        }
    }
}

proptest! {
    #[test]
    fn damaged_bytes_never_panic(
        which in 0..2usize,
        hits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut file = match which {
            0 => png_of(40, 40, png::ColorType::Grayscale, &values(40, 40)),
            _ => tiff_of(1),
        };
        for (at, value) in hits {
            let at = at.index(file.len());
            file[at] = value;
        }
        let _ = decode(&file);
    }
}
