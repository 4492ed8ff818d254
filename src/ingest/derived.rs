//! Channels that follow from others through the sample's dimensions.

use std::sync::Arc;

use crate::domain::{Channel, Quantity};

/// The channels with a curvature added where only the tip displacement was measured: kappa = 2 d / (L^2 + d^2),
/// equation \[3\] of the thesis, for a strip of free length `length_cm`. Without a length nothing is added.
pub fn responses(channels: &[Channel], length_cm: Option<f64>) -> Vec<Channel> {
    let mut all = channels.to_vec();
    let has = |quantity| channels.iter().any(|c| c.quantity == quantity && !c.is_empty());
    if has(Quantity::Curvature) {
        return all;
    }
    let tip = channels.iter().find(|c| c.quantity == Quantity::TipDisplacement);
    if let Some((tip, length_cm)) = tip.zip(length_cm) {
        let curvature = |d_mm: &f64| {
            let d_cm = d_mm / 10.0;
            2.0 * d_cm / (length_cm * length_cm + d_cm * d_cm)
        };
        let values: Arc<[f64]> = tip.values.iter().map(curvature).collect();
        let derived = Channel {
            quantity: Quantity::Curvature,
            values,
            ..tip.clone()
        };
        all.push(derived);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_circle_has_twice_the_inverse_length() {
        // A tip that has moved by L at distance L: 2 L / (2 L^2) = 1/L.
        let tip = Channel::new(
            Quantity::TipDisplacement,
            Arc::from([0.0, 1.0]),
            Arc::from([0.0, 5.0]),
        );
        let all = responses(std::slice::from_ref(&tip), Some(0.5));
        assert_eq!(all[1].quantity, Quantity::Curvature);
        assert!((all[1].values[1] - 2.0).abs() < 1e-12);
        assert_eq!(responses(&[tip], None).len(), 1);
    }
}
