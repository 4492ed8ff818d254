//! Derivatives by central differences.

/// Derivatives of a number by each coordinate of a place, each by its own step to either side.
pub fn gradient(at: &[f64], step: impl Fn(usize) -> f64, number: impl Fn(&[f64]) -> f64) -> Vec<f64> {
    let mut moved = at.to_vec();
    let mut along = |k: usize| {
        let step = step(k);
        let [above, below] = [step, -step].map(|by| {
            moved[k] = at[k] + by;
            number(&moved)
        });
        moved[k] = at[k];
        (above - below) / (2.0 * step)
    };
    (0..at.len()).map(&mut along).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_of_a_product_are_its_factors() {
        let found = gradient(&[2.0, 3.0], |k| 1e-5 * (k + 1) as f64, |at| at[0] * at[1]);
        assert!(
            (found[0] - 3.0).abs() < 1e-9 && (found[1] - 2.0).abs() < 1e-9,
            "{found:?}"
        );
    }
}
