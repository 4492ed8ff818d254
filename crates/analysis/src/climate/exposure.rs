//! Exposure dose: time above a humidity, as far as readings cover it.

/// Hours of a stretch of time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Dose {
    /// Time above the humidity, s.
    pub above_s: f64,
    /// Time that readings cover, s.
    pub covered_s: f64,
}

/// Adds up readings in the order of time, stretch by stretch, between `from_s` and `to_s`.
///
/// Between two readings that lie no farther apart than the rule the humidity is the straight line between them; a
/// longer gap is not covered. Stretches of `elsewhere` do not count.
#[derive(Debug, Clone)]
pub struct DoseMeter {
    /// Start, s since 1970 UTC.
    pub from_s: f64,
    /// End, s since 1970 UTC.
    pub to_s: f64,
    /// Humidity above which time counts, percent.
    pub above_percent: f64,
    /// Longest time between two readings that are joined, s.
    pub longest_gap_s: f64,
    /// Stretches in which the sample was elsewhere, in order, not overlapping.
    pub elsewhere: Vec<(f64, f64)>,
    last: Option<(f64, f64)>,
    dose: Dose,
}

impl DoseMeter {
    /// A meter with nothing added yet.
    pub fn new(
        (from_s, to_s): (f64, f64),
        above_percent: f64,
        longest_gap_s: f64,
        elsewhere: Vec<(f64, f64)>,
    ) -> DoseMeter {
        DoseMeter {
            from_s,
            to_s,
            above_percent,
            longest_gap_s,
            elsewhere,
            last: None,
            dose: Dose::default(),
        }
    }

    /// Adds readings, which lie after those added before.
    pub fn add(&mut self, times_s: &[f64], values: &[f64]) {
        let from = times_s.partition_point(|&t| t < self.from_s - self.longest_gap_s - 1.0);
        let to = times_s.partition_point(|&t| t <= self.to_s + self.longest_gap_s + 1.0);
        for (&time, &value) in times_s[from..to].iter().zip(&values[from..to]) {
            if let Some((t0, v0)) = self.last
                && time - t0 <= self.longest_gap_s + 1.0
            {
                self.stretch((t0, v0), (time, value));
            }
            self.last = Some((time, value));
        }
    }

    /// What was added up.
    pub fn dose(&self) -> Dose {
        self.dose
    }

    /// Adds the stretch between two neighbouring readings.
    fn stretch(&mut self, (t0, v0): (f64, f64), (t1, v1): (f64, f64)) {
        let at = |t: f64| v0 + (v1 - v0) * (t - t0) / (t1 - t0);
        let mut from = t0.max(self.from_s);
        let end = t1.min(self.to_s);
        let first = self.elsewhere.partition_point(|(_, end)| *end <= from);
        let stays: Vec<(f64, f64)> = self.elsewhere[first..]
            .iter()
            .take_while(|(start, _)| *start < end)
            .copied()
            .collect();
        for (away, back) in stays {
            self.part((from, at(from)), (away, at(away)));
            from = back;
        }
        self.part((from, at(from)), (end, at(end)));
    }

    fn part(&mut self, (t0, v0): (f64, f64), (t1, v1): (f64, f64)) {
        if t1 <= t0 {
            return;
        }
        self.dose.covered_s += t1 - t0;
        let (d0, d1) = (v0 - self.above_percent, v1 - self.above_percent);
        let share = match (d0 > 0.0, d1 > 0.0) {
            (true, true) => 1.0,
            (false, false) => 0.0,
            (true, false) => d0 / (d0 - d1),
            (false, true) => d1 / (d1 - d0),
        };
        self.dose.above_s += share * (t1 - t0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_crosses_exactly_and_gaps_do_not_count() {
        let mut meter = DoseMeter::new((0.0, 20_000.0), 60.0, 3600.0, vec![]);
        meter.add(&[-1000.0, 1000.0], &[50.0, 70.0]);
        // 60 % is crossed at 0 s; then nothing for two hours.
        meter.add(&[9000.0, 10_000.0], &[80.0, 80.0]);
        let dose = meter.dose();
        assert!(
            (dose.above_s - 2000.0).abs() < 1e-9 && (dose.covered_s - 2000.0).abs() < 1e-9,
            "{dose:?}"
        );
    }

    #[test]
    fn time_elsewhere_does_not_count_and_parts_add_up() {
        let times: Vec<f64> = (0..100).map(|k| f64::from(k) * 100.0).collect();
        let values = vec![75.0; 100];
        let meter = || {
            DoseMeter::new(
                (0.0, 9000.0),
                60.0,
                3600.0,
                vec![(1050.0, 2050.0), (2060.0, 2070.0)],
            )
        };
        let (mut whole, mut in_parts) = (meter(), meter());
        whole.add(&times, &values);
        in_parts.add(&times[..37], &values[..37]);
        in_parts.add(&times[37..], &values[37..]);
        assert!(
            (whole.dose().covered_s - 7990.0).abs() < 1e-9,
            "{:?}",
            whole.dose()
        );
        assert!((whole.dose().covered_s - in_parts.dose().covered_s).abs() < 1e-9);
        assert_eq!(whole.dose().above_s, whole.dose().covered_s);
    }
}
