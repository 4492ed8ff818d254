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

/// Whether `p` is the least that so many draws can tell, as 0.001 is of 999: the true one may be smaller by any amount.
pub fn is_least(p: f64, draws: usize) -> bool {
    draws > 0 && p * (draws as f64 + 1.0) <= 1.0 + 1e-6
}

/// A probability that was counted from draws of what chance does: `≤ 0.001` where no draw reached what was found.
pub fn counted(p: Option<f64>, draws: usize) -> String {
    counted_with_q(p, None, draws).0
}

/// The same with its q: one that rests on such a p is known no better.
pub fn counted_with_q(p: Option<f64>, q: Option<f64>, draws: usize) -> (String, String) {
    let at_most = |text: String| {
        if text.starts_with(['<', '–']) {
            text
        } else {
            format!("≤ {text}")
        }
    };
    if p.is_some_and(|p| is_least(p, draws)) {
        (at_most(probability(p)), at_most(probability(q)))
    } else {
        (probability(p), probability(q))
    }
}

/// What an explanation has of all probability, in percent: `62`, `6.2`, `> 99`, `< 0.1`.
pub fn share(probability: f64) -> String {
    match probability {
        most if most > 0.995 => "> 99".to_owned(),
        least if least < 0.001 => "< 0.1".to_owned(),
        mass => fixed(100.0 * mass, if mass < 0.095 { 1 } else { 0 }),
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
    #[test]
    fn a_chance_that_no_draw_reached_is_a_bound_and_so_is_its_q() {
        let printed = |p, q| counted_with_q(Some(p), Some(q), 999);
        let texts = |p: &str, q: &str| (p.to_owned(), q.to_owned());
        // One of 1000 is the least that 999 draws can tell, 3 of 1000 are counted.
        assert_eq!(printed(0.001, 0.004), texts("≤ 0.001", "≤ 0.004"));
        assert_eq!(printed(0.003, 0.012), texts("0.003", "0.012"));
        assert_eq!(printed(0.01, 0.02), texts("0.01", "0.02"));
        assert_eq!(counted_with_q(Some(1e-5), None, 999), texts("< 0.0001", "–"));
    }
}
