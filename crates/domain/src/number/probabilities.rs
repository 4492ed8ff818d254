//! Probabilities, as people read them.

use super::fixed;

/// A probability with two digits and no power of ten: `0.31`, `0.001`, `< 0.0001`; a dash where there is none.
pub fn probability(p: impl Into<Option<f64>>) -> String {
    match p.into().filter(|p| p.is_finite()) {
        None => "–".to_owned(),
        Some(p) if p < 1e-4 => "< 0.0001".to_owned(),
        Some(p) => {
            let decimals = (1.0 - p.log10().floor()).clamp(1.0, 5.0) as usize;
            let text = fixed(p, decimals);
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

/// A probability with its symbol: `p = 0.31`, `p < 0.0001`.
pub fn equation(symbol: &str, p: impl Into<Option<f64>>) -> String {
    equation_of(symbol, &probability(p))
}

/// The same of a number as it is printed.
pub fn equation_of(symbol: &str, text: &str) -> String {
    if text.starts_with(['<', '≤']) {
        format!("{symbol} {text}")
    } else {
        format!("{symbol} = {text}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_have_two_digits_and_an_end() {
        assert_eq!(equation("p", 0.001), "p = 0.001");
        assert_eq!(equation("p", 0.3141), "p = 0.31");
        assert_eq!(equation("q", 1e-6), "q < 0.0001");
        assert_eq!(equation("q", None), "q = –");
    }
}
