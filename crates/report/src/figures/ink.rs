//! The inks of all figures.

use plotters::prelude::RGBColor;
use plotters_backend::BackendColor;

/// The inks of all figures. Series colours are those of Okabe and Ito (2008), told apart with any colour vision.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Text, axes and marks.
    Text,
    /// Secondary text and tick labels.
    Muted,
    /// Grid lines.
    Grid,
    /// A fitted curve or the first series.
    Blue,
    /// The second series.
    Vermillion,
    /// The third series.
    Green,
    /// The fourth series.
    Purple,
    /// The fifth series.
    Orange,
    /// The sixth series.
    Sky,
    /// The first of an ordered series, dark to light.
    First,
    /// The second of an ordered series, dark to light.
    Second,
    /// The third of an ordered series, dark to light.
    Third,
    /// The fourth of an ordered series, dark to light.
    Fourth,
    /// The fifth of an ordered series, dark to light.
    Fifth,
    /// The sixth of an ordered series, dark to light.
    Sixth,
}

impl Ink {
    /// Colours of series, in the order in which they are given out.
    pub const SERIES: [Ink; ieap_show::Ink::COLOURS] = [
        Ink::Blue,
        Ink::Vermillion,
        Ink::Green,
        Ink::Purple,
        Ink::Orange,
        Ink::Sky,
    ];
    /// Inks of series that have an order, as times and places: lightness rises by equal steps (0.30 to 0.68 in the Oklab
    /// space), so that the order is seen with any colour vision and in grey, while the hue goes from blue over red to
    /// orange.
    pub const ORDERED: [Ink; 6] = [
        Ink::First,
        Ink::Second,
        Ink::Third,
        Ink::Fourth,
        Ink::Fifth,
        Ink::Sixth,
    ];
    const ALL: [Ink; 15] = [
        Ink::Text,
        Ink::Muted,
        Ink::Grid,
        Ink::Blue,
        Ink::Vermillion,
        Ink::Green,
        Ink::Purple,
        Ink::Orange,
        Ink::Sky,
        Ink::First,
        Ink::Second,
        Ink::Third,
        Ink::Fourth,
        Ink::Fifth,
        Ink::Sixth,
    ];

    /// Ink of series number `at` of `count` that have an order.
    pub fn ordered(at: usize, count: usize) -> Ink {
        let last = Ink::ORDERED.len() - 1;
        Ink::ORDERED[(at * last / count.saturating_sub(1).max(1)).min(last)]
    }

    /// Colour for plotters; also what is seen where no style sheet is.
    pub fn color(self) -> RGBColor {
        let (red, green, blue) = self.rgb();
        RGBColor(red, green, blue)
    }

    fn rgb(self) -> (u8, u8, u8) {
        match self {
            Ink::Text => (0x1d, 0x23, 0x29),
            Ink::Muted => (0x5c, 0x66, 0x70),
            Ink::Grid => (0xe3, 0xe6, 0xe8),
            Ink::Blue => (0x00, 0x72, 0xb2),
            Ink::Vermillion => (0xd5, 0x5e, 0x00),
            Ink::Green => (0x00, 0x9e, 0x73),
            Ink::Purple => (0xcc, 0x79, 0xa7),
            Ink::Orange => (0xe6, 0x9f, 0x00),
            Ink::Sky => (0x56, 0xb4, 0xe9),
            Ink::First => (0x1f, 0x19, 0x76),
            Ink::Second => (0x55, 0x22, 0x7f),
            Ink::Third => (0x8b, 0x28, 0x68),
            Ink::Fourth => (0xb1, 0x3e, 0x46),
            Ink::Fifth => (0xc8, 0x5e, 0x27),
            Ink::Sixth => (0xd0, 0x86, 0x0b),
        }
    }

    /// Its class in the style sheet.
    pub fn class_of(ink: Ink) -> &'static str {
        let (r, g, b) = ink.rgb();
        Ink::class(BackendColor {
            rgb: (r, g, b),
            alpha: 1.0,
        })
    }

    /// Class in the style sheet, which strokes and fills follow.
    pub(super) fn class(color: BackendColor) -> &'static str {
        match Ink::ALL.into_iter().find(|ink| ink.rgb() == color.rgb) {
            Some(Ink::Muted) => "k-muted",
            Some(Ink::Grid) => "k-grid",
            Some(Ink::Blue) => "k-1",
            Some(Ink::Vermillion) => "k-2",
            Some(Ink::Green) => "k-3",
            Some(Ink::Purple) => "k-4",
            Some(Ink::Orange) => "k-5",
            Some(Ink::Sky) => "k-6",
            Some(Ink::First) => "k-o1",
            Some(Ink::Second) => "k-o2",
            Some(Ink::Third) => "k-o3",
            Some(Ink::Fourth) => "k-o4",
            Some(Ink::Fifth) => "k-o5",
            Some(Ink::Sixth) => "k-o6",
            Some(Ink::Text) | None => "k-text",
        }
    }
}
