//! PNG, JPEG and TIFF to shades of grey. A damaged or oversized file is an error, never a panic and never a guess.

use std::io::Cursor;

use thiserror::Error;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::gray::Gray;

/// Pixels at most: a camera has fewer, and a file must not take all memory by what its header says.
const MOST_PIXELS: usize = 48_000_000;
/// Columns or rows at most.
const MOST_TO_A_SIDE: usize = 20_000;
/// Bytes that a decoder may take beside the picture: with four for each of its pixels less than 512 MB.
const MOST_BYTES: usize = 5 * MOST_PIXELS;

/// Why a file gives no picture.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum DecodeError {
    /// Its first bytes are those of no known format.
    #[error("this is no PNG, JPEG or TIFF: it begins with {found}. Save the frame as one of them")]
    Unknown {
        /// The first bytes, hexadecimal.
        found: String,
    },
    /// The file is damaged, cut short, or of a kind that the decoder does not know.
    #[error("the {format} cannot be read: {reason}. Is the file complete? Save or copy it again")]
    Damaged {
        /// Format.
        format: &'static str,
        /// What the decoder says.
        reason: String,
    },
    /// The picture is too large.
    #[error(
        "the {format} says that it has {width} x {height} pixels; up to {MOST_TO_A_SIDE} to a side and {MOST_PIXELS} in all are read"
    )]
    TooLarge {
        /// Format.
        format: &'static str,
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// Shades or colours that are not read.
    #[error("the {format} holds {found}; shades of grey or RGB with 8 or 16 bits are read. Save it so")]
    Colours {
        /// Format.
        format: &'static str,
        /// What it holds.
        found: String,
    },
    /// Several pictures in a file: which belongs to what time is not said.
    #[error("the TIFF holds several pictures; one frame a file is read. Save the stack as numbered files")]
    Stack,
}

/// Endings of files that are looked at.
pub const ENDINGS: [&str; 5] = ["png", "jpg", "jpeg", "tif", "tiff"];

/// Name of the format that the first bytes are of; none for what is no picture.
pub fn format(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("PNG"),
        [0xff, 0xd8, 0xff, ..] => Some("JPEG"),
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => Some("TIFF"),
        _ => None,
    }
}

/// Reads the bytes of a file; the format is told by its first bytes.
///
/// # Errors
/// [`DecodeError`] for whatever is no complete picture.
pub fn decode(bytes: &[u8]) -> Result<Gray, DecodeError> {
    match format(bytes) {
        Some("PNG") => png(bytes),
        Some("JPEG") => jpeg(bytes),
        Some(_) => tiff(bytes),
        None => Err(DecodeError::Unknown {
            found: match bytes {
                [] => "nothing, the file is empty".to_owned(),
                _ => bytes
                    .iter()
                    .take(4)
                    .map(|byte| format!("{byte:02x} "))
                    .collect::<String>()
                    .trim_end()
                    .to_owned(),
            },
        }),
    }
}

fn check_size(format: &'static str, width: usize, height: usize) -> Result<(), DecodeError> {
    let fits = width.max(height) <= MOST_TO_A_SIDE && width.saturating_mul(height) <= MOST_PIXELS;
    if fits {
        Ok(())
    } else {
        Err(DecodeError::TooLarge {
            format,
            width,
            height,
        })
    }
}

fn damaged(format: &'static str, reason: impl ToString) -> DecodeError {
    DecodeError::Damaged {
        format,
        reason: reason.to_string().trim_end_matches('.').to_owned(),
    }
}

fn png(bytes: &[u8]) -> Result<Gray, DecodeError> {
    png_within(bytes, MOST_BYTES)
}

fn png_within(bytes: &[u8], most_bytes: usize) -> Result<Gray, DecodeError> {
    const FORMAT: &str = "PNG";
    let limits = png::Limits { bytes: most_bytes };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Texts and profiles say nothing of the strip, and may be many times as large as the picture.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|error| damaged(FORMAT, error))?;
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    check_size(FORMAT, width, height)?;
    let size = reader.output_buffer_size().ok_or(DecodeError::TooLarge {
        format: FORMAT,
        width,
        height,
    })?;
    if size > most_bytes {
        return Err(damaged(
            FORMAT,
            format!("its samples take {size} bytes, {most_bytes} are read"),
        ));
    }
    let mut buffer = vec![0; size];
    let frame = reader
        .next_frame(&mut buffer)
        .map_err(|error| damaged(FORMAT, error))?;
    let channels = frame.color_type.samples();
    match frame.bit_depth {
        png::BitDepth::Eight => gray(
            FORMAT,
            width,
            height,
            channels,
            buffer.iter().map(|&v| f32::from(v) / 255.0),
        ),
        png::BitDepth::Sixteen => {
            let values = buffer
                .chunks_exact(2)
                .map(|pair| f32::from(u16::from_be_bytes([pair[0], pair[1]])) / 65535.0);
            gray(FORMAT, width, height, channels, values)
        }
        other => Err(DecodeError::Colours {
            format: FORMAT,
            found: format!("samples of {} bits", other as u8),
        }),
    }
}

fn jpeg(bytes: &[u8]) -> Result<Gray, DecodeError> {
    const FORMAT: &str = "JPEG";
    // Strict: a file that was cut short is an error rather than a picture with an even rest.
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(MOST_TO_A_SIDE)
        .set_max_height(MOST_TO_A_SIDE)
        .jpeg_set_out_colorspace(ColorSpace::Luma);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| damaged(FORMAT, error))?;
    let info = decoder
        .info()
        .ok_or_else(|| damaged(FORMAT, "it has no header"))?;
    let (width, height) = (usize::from(info.width), usize::from(info.height));
    check_size(FORMAT, width, height)?;
    let pixels = decoder.decode().map_err(|error| damaged(FORMAT, error))?;
    let channels = pixels.len() / (width * height).max(1);
    gray(
        FORMAT,
        width,
        height,
        channels,
        pixels.iter().map(|&v| f32::from(v) / 255.0),
    )
}

fn tiff(bytes: &[u8]) -> Result<Gray, DecodeError> {
    use tiff::decoder::{Decoder, DecodingResult, Limits};
    const FORMAT: &str = "TIFF";
    let mut limits = Limits::default();
    limits.decoding_buffer_size = MOST_BYTES;
    limits.intermediate_buffer_size = MOST_BYTES;
    let mut decoder = Decoder::new(Cursor::new(bytes))
        .map_err(|error| damaged(FORMAT, error))?
        .with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(|error| damaged(FORMAT, error))?;
    let (width, height) = (width as usize, height as usize);
    check_size(FORMAT, width, height)?;
    let colours = decoder.colortype().map_err(|error| damaged(FORMAT, error))?;
    use tiff::ColorType as C;
    let channels = match colours {
        C::Gray(8 | 16) => 1,
        C::GrayA(8 | 16) => 2,
        C::RGB(8 | 16) => 3,
        C::RGBA(8 | 16) => 4,
        other => {
            return Err(DecodeError::Colours {
                format: FORMAT,
                found: match other {
                    C::Gray(bits) => format!("grey of {bits} bits"),
                    C::Palette(_) => "colours of a palette".to_owned(),
                    C::CMYK(_) => "CMYK".to_owned(),
                    other => format!("{other:?}"),
                },
            });
        }
    };
    let pixels = decoder.read_image().map_err(|error| damaged(FORMAT, error))?;
    if decoder.more_images() {
        return Err(DecodeError::Stack);
    }
    match pixels {
        DecodingResult::U8(values) => gray(
            FORMAT,
            width,
            height,
            channels,
            values.iter().map(|&v| f32::from(v) / 255.0),
        ),
        DecodingResult::U16(values) => gray(
            FORMAT,
            width,
            height,
            channels,
            values.iter().map(|&v| f32::from(v) / 65535.0),
        ),
        _ => Err(DecodeError::Colours {
            format: FORMAT,
            found: "samples that are no whole numbers of 8 or 16 bits".to_owned(),
        }),
    }
}

/// Luminance of interleaved samples; what is transparent is taken as it stands.
fn gray(
    format: &'static str,
    width: usize,
    height: usize,
    channels: usize,
    samples: impl Iterator<Item = f32>,
) -> Result<Gray, DecodeError> {
    let mut samples = samples;
    let mut values = Vec::with_capacity(width * height);
    // All samples of a large picture are not held beside its pixels.
    while let Some(first) = samples.next() {
        let further: [Option<f32>; 3] =
            std::array::from_fn(|k| if k + 1 < channels { samples.next() } else { None });
        match (channels, further) {
            (1, _) | (2, [Some(_), ..]) => values.push(first),
            (_, [Some(green), Some(blue), _]) => values.push(0.299 * first + 0.587 * green + 0.114 * blue),
            _ => break,
        }
    }
    Gray::new(width, height, values)
        .ok_or_else(|| damaged(format, "it has fewer pixels than its header says"))
}

#[cfg(test)]
mod tests;
