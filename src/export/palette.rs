//! Colours that most colour-blind people can tell apart (Okabe & Ito 2008).

use plotters::style::RGBColor;

/// Red, green and blue.
pub(crate) type Colour = [u8; 3];

const BLUE: Colour = [0, 114, 178];
const ORANGE: Colour = [230, 159, 0];
const GREEN: Colour = [0, 158, 115];
const PURPLE: Colour = [204, 121, 167];
const VERMILION: Colour = [213, 94, 0];
const SKY: Colour = [86, 180, 233];
const YELLOW: Colour = [240, 228, 66];

/// What recedes behind the others.
pub(crate) const GREY: Colour = [110, 110, 110];

/// Areas, the strong colours first.
pub(crate) const AREAS: [Colour; 7] = [BLUE, ORANGE, GREEN, PURPLE, VERMILION, SKY, YELLOW];

/// Lines and symbols, of which yellow ones are hard to see on white.
pub(crate) const LINES: [Colour; 6] = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY];

/// The colour in the words of plotters.
pub(crate) const fn rgb([r, g, b]: Colour) -> RGBColor {
    RGBColor(r, g, b)
}
