//! What decides in fits of the base model and of effects beside it: every number with its unit and where it comes from.
//!
//! How many evaluations a search has and at which fall it ends stands where it is made: that is method.

use ieap_domain::ClimateQuantity;
use ieap_domain::quantiles::CHI_SQUARE_95;

/// How far a resistance or capacitance may be from its start, as logarithm: a factor of about 1,100. Chosen.
pub(super) const REACH: f64 = 7.0;
/// Factors of time and resistance by which a branch that a run does not show may lie beside the one that it shows. Chosen.
pub(super) const HIDDEN_BRANCHES: [(f64, f64); 4] = [(10.0, 1.0), (10.0, 5.0), (0.1, 1.0), (0.1, 5.0)];
/// Times that a group is fitted and looked at for outliers, each without those of the time before. Chosen.
pub(super) const OUTLIER_ROUNDS: usize = 3;

/// Least width over which a strip's answer to what surrounds it turns, in the unit of the quantity: sorption isotherms and rates of
/// ionomers are smooth over 10 % of relative humidity and 10 °C, and over a tenth of the pressure of the air; of traces of gases over
/// half of the largest value. Chosen.
pub(super) fn least_width(quantity: ClimateQuantity, largest: f64) -> f64 {
    match quantity {
        ClimateQuantity::RelativeHumidity | ClimateQuantity::Temperature => 10.0,
        ClimateQuantity::Pressure => 1e4,
        _ => 0.5 * largest,
    }
}

/// Rise of the sum of squares at the ends of a 95 % interval: chi-square of one degree of freedom.
pub(super) const RISE_95: f64 = CHI_SQUARE_95[0];
/// Rise beyond which no interval reaches: above the 95 % points of chi-square of three degrees of freedom (7.8) and of four (9.5).
/// Chosen.
pub(super) const RISE_OF_NO_INTERVAL: f64 = 10.0;
/// Half width of the 95 % interval of a logarithm beyond which no value is given: a factor of ten to either side. Chosen.
pub(crate) const WIDEST_HALF_LOG: f64 = 2.3;
/// The same where a profile tells the ends: the upper over the lower. Chosen.
pub(super) const WIDEST_FACTOR: f64 = 100.0;
