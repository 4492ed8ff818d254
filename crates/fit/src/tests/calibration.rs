//! The short form of `examples/calibration.rs`: what intervals say over the conditions of table 5.

use super::*;

/// One condition of each material and environment of table 5, as [`AIR_2V`].
const ROWS: [[f64; 8]; 6] = [
    [92.8, 0.137, 1533.7, 0.06, 67590.0, 17.57, 9.4e-5, 2.5],
    [173.1, 0.033, 316.2, 0.11, 109860.0, 21.50, 1.2e-4, 1.2],
    AIR_2V,
    [35.4, 0.031, 63.9, 1.44, 1850.0, 2.06, 6.4e-5, 2.0],
    [38.6, 0.030, 72.0, 1.35, 930.0, 4.74, 4.9e-6, 2.0],
    [23.4, 0.060, 43.1, 1.94, 1720.0, 3.02, 2.8e-4, 1.2],
];

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn intervals_hold_from_sixty_points_to_thousands_and_down_to_loud_noise() {
    let (mut inside, mut determined, mut bounds, mut bounds_held, mut asked) = (0, 0, 0, 0, 0);
    for (index, points) in [60, 150, 400, 1200, 4000]
        .into_iter()
        .cycle()
        .take(counted(30, 150) as usize)
        .enumerate()
    {
        let row = &ROWS[index % ROWS.len()];
        let (model, drive) = (model(row), Drive::step(row[7]));
        let rho = [0.0, 0.3, 0.6, 0.8][index % 4];
        let relative = [0.01, 0.03, 0.1, 0.3][index / 4 % 4];
        let seed = 5000 + index as u64;
        let run = channels(&model, &drive, &times(0.0, 3600.0, points), relative, rho, seed);
        let fit = fitted(&run, &drive);
        for (key, expected) in truth(&model) {
            let estimate = fit.parameter(key).unwrap();
            let low = estimate.low_95.unwrap_or(f64::NEG_INFINITY);
            let high = estimate.high_95.unwrap_or(f64::INFINITY);
            let holds = i32::from(low <= expected && expected <= high);
            asked += 1;
            if estimate.value.is_some() {
                determined += 1;
                inside += holds;
            } else if low.is_finite() || high.is_finite() {
                bounds += 1;
                bounds_held += holds;
            }
        }
    }
    let share = f64::from(inside) / f64::from(determined);
    println!(
        "{inside} of {determined} determined ({share:.3}), {bounds_held} of {bounds} bounds, {asked} asked"
    );
    // Nine estimates of a run lean on each other: the spread is that of a third as many.
    let spread = |of: i32| 2.5 * (0.05 * 0.95 * 3.0 / f64::from(of.max(1))).sqrt();
    assert!((share - 0.95).abs() <= spread(determined), "{share}");
    let held = f64::from(bounds_held) / f64::from(bounds.max(1));
    assert!(held >= 0.95 - spread(bounds), "{bounds_held} of {bounds}");
    assert!(
        determined * 3 > asked && determined < asked,
        "{determined} of {asked}"
    );
}
