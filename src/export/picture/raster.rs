//! From SVG to pixels.

use std::sync::Arc;

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};
use svg::Document;

use super::pixels::Pixels;
use super::sheet::{FONT, Sheet};

/// The sheet in white.
///
/// # Errors
/// More pixels than there is memory for.
pub(super) fn white(sheet: &Sheet) -> Result<Pixmap, String> {
    let [width, height] = sheet.size();
    let mut pixels =
        Pixmap::new(width, height).ok_or_else(|| format!("{width} x {height} pixels are no picture"))?;
    pixels.fill(Color::WHITE);
    Ok(pixels)
}

/// Draws the document over what is there.
///
/// # Errors
/// A document that cannot be drawn.
pub(super) fn draw(document: &Document, mut pixels: Pixmap, sheet: &Sheet) -> Result<Pixels, String> {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    let options = Options { fontdb: Arc::new(fonts), font_family: FONT.to_owned(), ..Options::default() };
    let tree = Tree::from_str(&document.to_string(), &options).map_err(|error| error.to_string())?;
    let scale = sheet.pixels as f32;
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    Ok(Pixels::new(&pixels))
}
