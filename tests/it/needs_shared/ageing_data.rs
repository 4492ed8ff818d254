//! Real ageing data of others: batteries of the NASA Ames Prognostics Center and a fluidic actuator. They are no runs
//! of strips, so their numbers per cycle are put into the monitoring as series.

use calamine::{Data, Reader, Xlsx, open_workbook};
use ieap::analysis::monitoring::series::{Reaches, Series};
use ieap::numerics::control_chart;

use super::shared;

fn series(y: Vec<f64>, is_log: bool) -> Series {
    Series {
        x: (1..=y.len()).map(|cycle| cycle as f64).collect(),
        variance: vec![0.0; y.len()],
        y,
        is_log,
        breaks: Vec::new(),
    }
}

/// Capacity of every discharge of a cell, A h.
fn capacities(battery: &str) -> Option<Vec<f64>> {
    let path = shared("data/nasa-liion-cv-aging")?.join("metadata.csv");
    let mut table = csv::Reader::from_path(path).unwrap();
    let headers = table.headers().unwrap().clone();
    let column = |name: &str| headers.iter().position(|header| header == name).unwrap();
    let (kind, cell, capacity) = (column("type"), column("battery_id"), column("Capacity"));
    let rows = table.records().map(Result::unwrap);
    let of_cell = rows.filter(|row| &row[kind] == "discharge" && &row[cell] == battery);
    Some(
        of_cell
            .filter_map(|row| row[capacity].parse::<f64>().ok())
            .collect(),
    )
}

#[test]
fn batteries_fade_and_their_recoveries_are_no_jumps() {
    let limit = control_chart::limit(500.0);
    for (battery, count, first, last) in [("B0005", 168, 1.856, 1.325), ("B0018", 132, 1.855, 1.341)] {
        let Some(capacity) = capacities(battery) else {
            return;
        };
        assert_eq!(capacity.len(), count);
        assert!((capacity[0] - first).abs() < 5e-4 && (capacity[count - 1] - last).abs() < 5e-4);
        let fading = series(capacity.iter().map(|ah| ah.ln()).collect(), true);
        let study = fading.study(limit, 1);
        println!(
            "{battery}: {} over {count} discharges, factor {:.3} [{:.3}, {:.3}], {} jumps, p {:.1e}",
            study.trends[0].law.key(),
            study.trends[0].size.value.exp(),
            study.trends[0].size.low_95.unwrap().exp(),
            study.trends[0].size.high_95.unwrap().exp(),
            study.steps.len(),
            study.p_trend.unwrap()
        );
        assert!(study.steps.is_empty(), "{:?}", study.steps);
        assert!(study.p_trend.unwrap() < 1e-3);
        let fall = study.trends[0].size.value.exp();
        assert!((fall - last / first).abs() < 0.06, "{fall}");
        assert!(study.chart.first_alarm.is_some_and(|at| at < 60));
    }
}

#[test]
fn the_end_of_a_battery_is_foretold_or_refused() {
    let Some(capacity) = capacities("B0005") else {
        return;
    };
    let limit = control_chart::limit(500.0);
    let passed = capacity.iter().position(|ah| *ah < 1.4).unwrap() as f64 + 1.0;
    for known in [30, 60, 90, 110] {
        let early = series(capacity[..known].iter().map(|ah| ah.ln()).collect(), true);
        let study = early.study(limit, 1);
        let told = early.reaches(&study, 1.4_f64.ln(), true);
        println!("after {known} discharges: {told:?}; passed at {passed}");
        if let Reaches::At(at) = told {
            // The recoveries make the fade uneven: the interval of the trend alone must come near.
            let (low, high) = (at.low_95.unwrap(), at.high_95.unwrap_or(f64::INFINITY));
            assert!(
                low - 0.15 * passed <= passed && passed <= high + 0.15 * passed,
                "{known}: {at:?}"
            );
        }
    }
}

/// Lowest position and stroke of every cycle of the lifetime test, with the time at which it begins, s.
fn actuator() -> Option<Vec<(f64, f64, f64)>> {
    let path = shared("data/cavatappi-actuator")?.join("Clean DATA Life Time.xlsx");
    let mut book: Xlsx<_> = open_workbook(path).unwrap();
    let sheet = book.worksheet_range_at(0).unwrap().unwrap();
    let number = |cell: &Data| match cell {
        Data::Float(number) => Some(*number),
        Data::Int(number) => Some(*number as f64),
        _ => None,
    };
    let mut readings = Vec::new();
    for block in [0, 4, 8] {
        for row in sheet.rows() {
            let of = |column: usize| row.get(block + column).and_then(number);
            if let (Some(time), Some(pressure), Some(position)) = (of(0), of(1), of(2)) {
                readings.push((time, pressure, position));
            }
        }
    }
    // A cycle begins where the pressure rises through 150 psi after it was below 85.
    let (mut starts, mut is_low) = (Vec::new(), false);
    for (k, (_, pressure, _)) in readings.iter().enumerate() {
        is_low |= *pressure < 85.0;
        if is_low && *pressure > 150.0 {
            starts.push(k);
            is_low = false;
        }
    }
    let cycle = |pair: &[usize]| {
        let positions = readings[pair[0]..pair[1]].iter().map(|reading| reading.2);
        let (low, high) = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        (readings[pair[0]].0, low, high - low)
    };
    Some(starts.windows(2).map(cycle).collect())
}

#[test]
#[ignore = "slow: cargo test -- --ignored"]
fn a_sensor_that_was_zeroed_again_is_no_degradation() {
    let Some(cycles) = actuator() else {
        return;
    };
    assert!(cycles.len() > 2300, "{}", cycles.len());
    let limit = control_chart::limit(500.0);
    // Every third cycle: what is asked does not need more.
    let thinned: Vec<(f64, f64, f64)> = cycles.iter().copied().step_by(3).collect();
    let position = series(thinned.iter().map(|cycle| cycle.1).collect(), false);
    let study = position.study(limit, 1);
    let at: Vec<f64> = study.steps.iter().map(|step| thinned[step.at].0).collect();
    println!("position jumps at {at:?} s; drift {:?}", study.trends[0].size);
    for zeroed_s in [3550.0, 4840.0, 9834.0] {
        assert!(
            at.iter().any(|at| (at - zeroed_s).abs() < 30.0),
            "{zeroed_s}: {at:?}"
        );
    }
    // Within its stretches the position only sinks, by far more than its ends show.
    let ends = position.y[position.y.len() - 1] - position.y[0];
    assert!(
        study.trends[0].size.value < 3.0 * ends && ends < 0.0,
        "{:?} {ends}",
        study.trends[0].size
    );
    let stroke = series(thinned.iter().map(|cycle| cycle.2.ln()).collect(), true);
    let study = stroke.study(limit, 1);
    println!(
        "stroke: {} by {:.2}, jumps {:?}",
        study.trends[0].law.key(),
        study.trends[0].size.value.exp(),
        study.steps
    );
    assert!(study.p_trend.unwrap() < 1e-3 && study.trends[0].size.value < -0.2);
    assert!(
        study.steps.iter().all(|step| !at.contains(&thinned[step.at].0)),
        "{:?}",
        study.steps
    );
}
