//! Curvature that is made from a displacement, by the reader and by the model.

use ieap::domain::{Channel, Quantity};

#[test]
fn the_reader_derives_curvature_as_the_model_does() {
    let displacement_mm = [-4.0, 0.0, 0.3, 5.0, 7.5];
    let channel = Channel::new(
        Quantity::TipDisplacement,
        [0.0, 1.0, 2.0, 3.0, 4.0].into(),
        displacement_mm.into(),
    );
    let derived = ieap::ingest::derived::responses(&[channel], Some(0.5), None);
    for (curvature, displacement) in derived[1].values.iter().zip(displacement_mm) {
        let formula = ieap::model::geometry::curvature_from_displacement(displacement, 5.0);
        assert!((curvature - formula).abs() <= 1e-15 * formula.abs().max(1.0));
    }
}
