//! The ends of a range of numbers.

/// The least and the greatest of `values`, NaNs left out; of none, infinity and minus infinity.
pub fn range_of(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let ends = (f64::INFINITY, f64::NEG_INFINITY);
    (values.into_iter()).fold(ends, |(low, high), value| (low.min(value), high.max(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_of_some_and_of_none() {
        assert_eq!(range_of([2.0, f64::NAN, -1.0]), (-1.0, 2.0));
        assert_eq!(range_of([]), (f64::INFINITY, f64::NEG_INFINITY));
    }
}
