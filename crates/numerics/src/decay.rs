//! Many values of e^(-rate t) at little cost where the readings are evenly spaced.

/// Readings that are evaluated together.
pub const BLOCK: usize = 64;

/// A column of one block; entries beyond the block's length are zero.
pub type Column = [f64; BLOCK];

/// How far a reading may lie from the even grid, in steps: what rounding of a printed time stamp leaves.
/// The error of an exponential is below this times step/time constant.
const EVENNESS: f64 = 1e-5;

/// Up to [`BLOCK`] consecutive readings of one segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Index of the first reading.
    pub first: usize,
    /// Number of readings.
    pub len: usize,
    /// Spacing, s; none where the readings are not evenly spaced.
    pub step_s: Option<f64>,
}

/// Cuts the readings `first..end` at `elapsed_s` into blocks and finds the evenly spaced ones.
pub fn blocks(elapsed_s: &[f64], first: usize, end: usize) -> Vec<Block> {
    let mut found: Vec<Block> = Vec::with_capacity((end - first) / BLOCK + 1);
    let mut start = first;
    while start < end {
        let len = BLOCK.min(end - start);
        let readings = &elapsed_s[start..start + len];
        // The step of the block before is tried first, so that one table of powers serves many blocks.
        let earlier = found.last().and_then(|block| block.step_s);
        let own = (readings[len - 1] - readings[0]) / (len.max(2) - 1) as f64;
        let step_s = earlier
            .into_iter()
            .chain([own])
            .find(|&step| is_even(readings, step));
        found.push(Block {
            first: start,
            len,
            step_s,
        });
        start += len;
    }
    found
}

/// Spacing of the readings where it is even, s.
pub fn even_step(readings: &[f64]) -> Option<f64> {
    let (first, last) = (*readings.first()?, *readings.last()?);
    let step_s = (last - first) / (readings.len().max(2) - 1) as f64;
    is_even(readings, step_s).then_some(step_s)
}

fn is_even(readings: &[f64], step_s: f64) -> bool {
    let near = |(k, &t): (usize, &f64)| (t - readings[0] - k as f64 * step_s).abs() <= EVENNESS * step_s;
    // No early end: the whole is then one vector loop.
    readings.len() > 2 && step_s > 0.0 && readings.iter().enumerate().fold(true, |even, at| even & near(at))
}

/// e^(-rate t) of one rate, block after block; keeps the powers of one step between blocks.
#[derive(Debug, Clone)]
pub struct Decay {
    rate_per_s: f64,
    step_s: f64,
    powers: Column,
}

impl Decay {
    /// Decay with that rate, finite and not negative, 1/s.
    pub fn new(rate_per_s: f64) -> Decay {
        Decay {
            rate_per_s,
            step_s: f64::NAN,
            powers: [0.0; BLOCK],
        }
    }

    /// Writes e^(-rate t) for every reading of `block` and zero beyond its length.
    ///
    /// On an even block one exponential is multiplied by tabulated powers, each computed on its own, so no
    /// error builds up along the record.
    #[inline]
    pub fn fill(&mut self, block: &Block, elapsed_s: &[f64], out: &mut Column) {
        let Some(step_s) = block.step_s else {
            for (value, t) in out
                .iter_mut()
                .zip(&elapsed_s[block.first..block.first + block.len])
            {
                *value = (-self.rate_per_s * t).exp();
            }
            out[block.len..].fill(0.0);
            return;
        };
        if step_s != self.step_s {
            self.step_s = step_s;
            self.powers = std::array::from_fn(|k| (-self.rate_per_s * step_s * k as f64).exp());
        }
        let base = (-self.rate_per_s * elapsed_s[block.first]).exp();
        for (value, power) in out.iter_mut().zip(&self.powers) {
            *value = base * power;
        }
        out[block.len..].fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_uneven_and_changing_spacing_give_the_exponential() {
        let mut elapsed_s: Vec<f64> = (0..1000).map(|k| k as f64 * 0.01).collect();
        elapsed_s.extend((1..500).map(|k| 9.99 + k as f64 * 0.7));
        elapsed_s.extend((1..100).map(|k| 400.0 + (k as f64).powi(2)));
        let cut = blocks(&elapsed_s, 0, elapsed_s.len());
        assert!(cut.iter().filter(|block| block.step_s.is_some()).count() > 20);
        assert!(cut.iter().any(|block| block.step_s.is_none()));
        let (mut decay, mut column) = (Decay::new(0.013), [0.0; BLOCK]);
        for block in &cut {
            decay.fill(block, &elapsed_s, &mut column);
            for k in 0..block.len {
                let exact = (-0.013 * elapsed_s[block.first + k]).exp();
                assert!((column[k] / exact - 1.0).abs() < 1e-9, "{k} of {block:?}");
            }
            assert!(column[block.len..].iter().all(|&v| v == 0.0));
        }
        assert_eq!(cut.iter().map(|block| block.len).sum::<usize>(), elapsed_s.len());
    }
}
