//! Humid air: vapour pressure, dew point and absolute humidity from temperature and relative humidity.
//!
//! Magnus formula over water with the coefficients of Sonntag (1990), as the World Meteorological Organization
//! prints it (WMO-No. 8, Guide to Instruments and Methods of Observation, annex on formulae for humidity):
//! `e_w(t) = 6.112 hPa · exp(17.62 t / (243.12 °C + t))`, -45 to 60 °C. The enhancement by the pressure of dry air
//! (0.4 % at 1 bar) is left out. The formula is accurate to 0.32 % from 0 to 60 °C, 0.05 K of dew point: well below
//! what hygrometers are (2 % of relative humidity are 4 % of vapour pressure at 50 %). A hygrometer's relative humidity
//! is that over water below 0 °C, too.

/// Saturation pressure at 0 °C, Pa.
const AT_ZERO_PA: f64 = 611.2;
/// Magnus coefficients over water: no unit, and °C.
const FACTOR: f64 = 17.62;
const TEMPERATURE_C: f64 = 243.12;
/// Gas constant of water vapour, J/(kg K): 8.314463 J/(mol K) over 18.01528 g/mol.
const WATER_VAPOUR_J_PER_KG_K: f64 = 461.52;
/// 0 °C, K.
const ZERO_C_IN_K: f64 = 273.15;

/// Pressure of saturated water vapour over water, Pa.
pub fn saturation_pressure_pa(temperature_c: f64) -> f64 {
    AT_ZERO_PA * (FACTOR * temperature_c / (TEMPERATURE_C + temperature_c)).exp()
}

/// Partial pressure of water vapour, Pa.
pub fn vapour_pressure_pa(temperature_c: f64, relative_humidity_percent: f64) -> f64 {
    relative_humidity_percent / 100.0 * saturation_pressure_pa(temperature_c)
}

/// Dew point over water, °C; none without water vapour.
pub fn dew_point_c(vapour_pressure_pa: f64) -> Option<f64> {
    let logarithm = (vapour_pressure_pa / AT_ZERO_PA).ln();
    let dew_point_c = TEMPERATURE_C * logarithm / (FACTOR - logarithm);
    dew_point_c.is_finite().then_some(dew_point_c)
}

/// Mass of water vapour in a volume of air, g/m³.
pub fn absolute_humidity_g_per_m3(temperature_c: f64, vapour_pressure_pa: f64) -> f64 {
    1e3 * vapour_pressure_pa / (WATER_VAPOUR_J_PER_KG_K * (temperature_c + ZERO_C_IN_K))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest relative deviation of the formula, at 28 °C.
    const ACCURACY: f64 = 3.2e-3;

    /// Saturation pressure of the International Association for the Properties of Water and Steam
    /// (Wagner and Pruss, J. Phys. Chem. Ref. Data 22, 783, 1993), Pa.
    fn wagner_pruss_pa(temperature_c: f64) -> f64 {
        let (critical_k, critical_pa) = (647.096, 22.064e6);
        let kelvin = temperature_c + 273.15;
        let v = 1.0 - kelvin / critical_k;
        let terms = [
            (-7.859_517_83, 1.0),
            (1.844_082_59, 1.5),
            (-11.786_649_7, 3.0),
            (22.680_741_1, 3.5),
            (-15.961_871_9, 4.0),
            (1.801_225_02, 7.5),
        ];
        let sum: f64 = terms
            .iter()
            .map(|(a, power): &(f64, f64)| a * v.powf(*power))
            .sum();
        critical_pa * (critical_k / kelvin * sum).exp()
    }

    #[test]
    fn the_saturation_pressure_agrees_with_another_statement() {
        for tenth in 1..=600 {
            let temperature_c = f64::from(tenth) / 10.0;
            let ratio = saturation_pressure_pa(temperature_c) / wagner_pruss_pa(temperature_c);
            assert!((ratio - 1.0).abs() < ACCURACY, "{temperature_c} °C: {ratio}");
        }
    }

    #[test]
    fn the_dew_point_turns_the_pressure_back() {
        for temperature_c in [-40.0, -10.0, 0.0, 9.3, 20.0, 55.0] {
            let back = dew_point_c(saturation_pressure_pa(temperature_c)).unwrap();
            assert!((back - temperature_c).abs() < 1e-9, "{temperature_c}: {back}");
        }
        assert_eq!(dew_point_c(0.0), None);
        assert_eq!(dew_point_c(-3.0), None);
    }

    #[test]
    fn a_room_at_20_degrees_and_50_percent() {
        // 17.3 g/m³ at saturation and 9.3 °C of dew point stand in every psychrometric table.
        let vapour_pa = vapour_pressure_pa(20.0, 50.0);
        let saturated = absolute_humidity_g_per_m3(20.0, 2.0 * vapour_pa);
        assert!((saturated / 17.3 - 1.0).abs() < ACCURACY + 0.05 / 17.3);
        assert!((dew_point_c(vapour_pa).unwrap() - 9.3).abs() < 0.05);
    }
}
