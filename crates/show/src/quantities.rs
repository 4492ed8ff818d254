//! Quantities, each said once: how it is stored, named and shown in every medium.

use ieap_domain::{DisplayUnit, ParameterInfo};

use crate::table::Column;

/// A quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Key under which it is stored, with its unit: `c1_f`.
    pub key: &'static str,
    /// Symbol or short title: `C₁`.
    pub symbol: &'static str,
    /// What it is, in words.
    pub name: &'static str,
    /// Unit in which it is stored; empty for words and pure numbers.
    pub unit: &'static str,
    /// Unit in which people read it, where that is another.
    pub display: Option<DisplayUnit>,
}

impl Quantity {
    /// A quantity that is shown as it is stored.
    pub const fn new(
        key: &'static str,
        symbol: &'static str,
        name: &'static str,
        unit: &'static str,
    ) -> Quantity {
        Quantity {
            key,
            symbol,
            name,
            unit,
            display: None,
        }
    }

    /// Words, or a number without a unit.
    pub const fn plain(key: &'static str, symbol: &'static str, name: &'static str) -> Quantity {
        Quantity::new(key, symbol, name, "")
    }

    /// The same, of which people read `factor` times the stored number in another unit.
    pub const fn shown_in(self, unit: &'static str, factor: f64) -> Quantity {
        Quantity {
            display: Some(DisplayUnit { unit, factor }),
            ..self
        }
    }

    /// The same under another symbol.
    pub const fn called(self, symbol: &'static str, name: &'static str) -> Quantity {
        Quantity { symbol, name, ..self }
    }

    /// Its column.
    pub fn of_column(&self) -> Column {
        Column {
            display: self.display,
            ..Column::of(self.key, self.symbol, self.name, self.unit)
        }
    }
}

impl From<&ParameterInfo> for Quantity {
    fn from(info: &ParameterInfo) -> Quantity {
        Quantity {
            display: info.display,
            ..Quantity::new(info.key, info.symbol, info.name, info.unit())
        }
    }
}

/// Run.
pub const RUN: Quantity = Quantity::plain("run", "Run", "run");
/// Material.
pub const MATERIAL: Quantity = Quantity::plain("material", "Material", "material");
/// Sample.
pub const SAMPLE: Quantity = Quantity::plain("sample", "Sample", "sample");
/// Environment.
pub const ENVIRONMENT: Quantity = Quantity::plain("environment", "Environment", "environment");
/// Relative humidity.
pub const HUMIDITY: Quantity = Quantity::new("relative_humidity_percent", "RH", "relative humidity", "%");
/// Step voltage.
pub const VOLTAGE: Quantity = Quantity::new("voltage_v", "V₀", "step voltage", "V");
/// Coefficient of determination of the current.
pub const R_SQUARED_CURRENT: Quantity = Quantity::plain(
    "r_squared_current",
    "R² (current)",
    "coefficient of determination of the current",
);
/// Coefficient of determination of the curvature.
pub const R_SQUARED_CURVATURE: Quantity = Quantity::plain(
    "r_squared_curvature",
    "R² (curvature)",
    "coefficient of determination of the curvature",
);
/// Number of samples.
pub const SAMPLES: Quantity = Quantity::plain("samples", "Samples", "number of samples");
/// Number of runs.
pub const RUNS: Quantity = Quantity::plain("runs", "Runs", "number of runs");
