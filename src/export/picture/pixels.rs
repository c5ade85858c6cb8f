//! Drawn pictures as PNG files, one by one or as an animation.

use std::io::{self, Write};
use std::path::Path;

use png::{BitDepth, ColorType, Encoder};
use resvg::tiny_skia::Pixmap;

use crate::export::{ExportError, write_file};

/// A drawn picture, which covers its ground.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    size: [u32; 2],
    /// Red, green and blue, row by row from the top.
    rgb: Vec<u8>,
}

impl Pixels {
    pub(super) fn new(drawn: &Pixmap) -> Self {
        let rgb = drawn.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
        Self { size: [drawn.width(), drawn.height()], rgb: rgb.collect() }
    }

    /// Width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// Whatever the file system reports.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), ExportError> {
        write_file(path, |file| {
            let mut writer = encoder(file, self.size).write_header()?;
            writer.write_image_data(&self.rgb)?;
            Ok(writer.finish()?)
        })
    }
}

/// Writes an animation as APNG (PNG with several frames, which repeat without end), from frames that are drawn one after the other.
///
/// # Errors
/// No frames, frames of different sizes, what `frame` reports of one of them, and whatever the file system reports. Then
/// there is no file.
pub fn write_animation<E: From<ExportError>>(
    path: impl AsRef<Path>,
    frames: u32,
    per_second: u16,
    mut frame: impl FnMut(u32) -> Result<Pixels, E>,
) -> Result<(), E> {
    let path = path.as_ref();
    if frames == 0 || per_second == 0 {
        return Err(ExportError::data(path, format!("{frames} frames at {per_second} a second")).into());
    }
    let first = frame(0)?;
    let mut failure = None;
    let written = write_file(path, |file| {
        let mut encoder = encoder(file, first.size);
        encoder.set_animated(frames, 0)?;
        encoder.set_frame_delay(1, per_second)?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&first.rgb)?;
        for number in 1..frames {
            let next = frame(number).and_then(|next| {
                let [old, new] = [first.size, next.size].map(|[width, height]| format!("{width} x {height}"));
                let reason = || format!("frame {number} has {new} pixels, those before {old}");
                if new == old { Ok(next) } else { Err(ExportError::data(path, reason()).into()) }
            });
            match next {
                Ok(next) => writer.write_image_data(&next.rgb)?,
                Err(error) => {
                    failure = Some(error);
                    return Err(io::Error::other("a frame is missing"));
                }
            }
        }
        Ok(writer.finish()?)
    });
    match failure {
        Some(failure) => Err(failure),
        None => Ok(written?),
    }
}

fn encoder<W: Write>(file: W, [width, height]: [u32; 2]) -> Encoder<'static, W> {
    let mut encoder = Encoder::new(file, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder
}
