//! Readings as curves over a covariate see them. A curve has one value for each value of the covariate, and laws are held
//! against readings with thousands of curves: where a covariate has few values, as in a design, the readings are put
//! together once, and a curve costs no more however many readings there are.

use super::fitted::Material;
use ieap_numerics::grouped::dot;

/// Part of a column that must be left beside the columns before it for it to count.
const DEPENDENT_BELOW: f64 = 1e-10;

/// Readings with the distinct values of the covariate.
pub(super) struct Resolution<'a> {
    pub(super) material: &'a Material<'a>,
    /// Distinct values of the covariate, rising.
    pub(super) x: Vec<f64>,
    /// Place of each row's value among them.
    place: Vec<usize>,
    /// What nuisance leaves of the values of the rows.
    left: Vec<f64>,
    /// The same of a column for each value, which is 1 where the covariate has it; empty where there are many of them.
    columns: Vec<Vec<f64>>,
}

impl<'a> Resolution<'a> {
    pub(super) fn new(material: &'a Material<'a>) -> Resolution<'a> {
        let mut x = material.x.to_vec();
        x.sort_by(f64::total_cmp);
        x.dedup();
        let place: Vec<usize> = (material.x.iter())
            .map(|value| x.partition_point(|other| other < value))
            .collect();
        // Pairs of values are fewer than rows: putting rows together pays.
        let are_few = x.len() * x.len() <= material.x.len();
        let column = |k: usize| {
            let is_here = place.iter().map(|&own| f64::from(u8::from(own == k)));
            material.nuisance.residual(&is_here.collect::<Vec<f64>>())
        };
        Resolution {
            left: material.nuisance.residual(material.y),
            columns: (0..x.len()).filter(|_| are_few).map(column).collect(),
            x,
            place,
            material,
        }
    }

    /// Some of the rows.
    pub(super) fn over(&self, rows: Vec<usize>) -> Over<'_> {
        let together = (!self.columns.is_empty()).then(|| Together::of(self, &rows));
        Over {
            resolution: self,
            rows,
            together,
        }
    }
}

/// Rows that curves are held against.
pub(super) struct Over<'a> {
    resolution: &'a Resolution<'a>,
    rows: Vec<usize>,
    together: Option<Together>,
}

impl Over<'_> {
    /// Sum of squares that is left beside a curve.
    pub(super) fn square(&self, curve: &[f64]) -> f64 {
        match &self.together {
            Some(together) => together.square(curve),
            None => {
                let column = self.column(curve);
                let left = |&r: &usize| (self.resolution.left[r] - column[r]).powi(2);
                self.rows.iter().map(left).sum()
            }
        }
    }

    /// The factor of a curve that leaves least, and the curve's own square.
    pub(super) fn factor(&self, curve: &[f64]) -> (f64, f64) {
        let (product, square) = match &self.together {
            Some(together) => together.products(curve),
            None => {
                let column = self.column(curve);
                let rows = || self.rows.iter();
                (
                    rows().map(|&r| column[r] * self.resolution.left[r]).sum(),
                    rows().map(|&r| column[r].powi(2)).sum::<f64>(),
                )
            }
        };
        (product / square, square)
    }

    /// What nuisance leaves of a curve.
    fn column(&self, curve: &[f64]) -> Vec<f64> {
        let along: Vec<f64> = self.resolution.place.iter().map(|&k| curve[k]).collect();
        self.resolution.material.nuisance.residual(&along)
    }
}

/// Rows put together: columns by an orthonormal basis of them, and the readings by the same. No square is the small
/// difference of large ones.
struct Together {
    /// For each direction of the basis the part of each column.
    columns: Vec<Vec<f64>>,
    /// The part of the readings.
    readings: Vec<f64>,
    /// Square of the readings that no column reaches.
    beyond: f64,
}

impl Together {
    fn of(resolution: &Resolution, rows: &[usize]) -> Together {
        let some = |column: &Vec<f64>| -> Vec<f64> { rows.iter().map(|&r| column[r]).collect() };
        let count = resolution.columns.len();
        let mut basis: Vec<Vec<f64>> = Vec::new();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for (k, column) in resolution.columns.iter().map(some).enumerate() {
            let whole = dot(&column, &column).sqrt();
            let (parts, left) = taken_out(&basis, column);
            for (direction, part) in columns.iter_mut().zip(parts) {
                direction[k] = part;
            }
            let size = dot(&left, &left).sqrt();
            if size > DEPENDENT_BELOW * whole {
                let mut direction = vec![0.0; count];
                direction[k] = size;
                columns.push(direction);
                basis.push(left.iter().map(|value| value / size).collect());
            }
        }
        let (readings, beyond) = taken_out(&basis, some(&resolution.left));
        Together {
            columns,
            readings,
            beyond: dot(&beyond, &beyond),
        }
    }

    fn square(&self, curve: &[f64]) -> f64 {
        let left = |(column, reading): (&Vec<f64>, &f64)| (reading - dot(column, curve)).powi(2);
        self.beyond + self.columns.iter().zip(&self.readings).map(left).sum::<f64>()
    }

    /// Of a curve with the readings, and with itself.
    fn products(&self, curve: &[f64]) -> (f64, f64) {
        let parts: Vec<f64> = self.columns.iter().map(|column| dot(column, curve)).collect();
        (dot(&parts, &self.readings), dot(&parts, &parts))
    }
}

/// The parts of a column along an orthonormal basis, and what is left of it. Twice, for what rounding leaves the first
/// time.
fn taken_out(basis: &[Vec<f64>], mut column: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let mut parts = vec![0.0; basis.len()];
    for _ in 0..2 {
        for (direction, sum) in basis.iter().zip(&mut parts) {
            let part = dot(direction, &column);
            column.iter_mut().zip(direction).for_each(|(x, b)| *x -= part * b);
            *sum += part;
        }
    }
    (parts, column)
}

#[cfg(test)]
mod tests {
    use super::super::shape::Span;
    use super::*;
    use ieap_numerics::grouped::Grouped;

    #[test]
    fn rows_put_together_say_what_each_row_says() {
        let n = 120;
        let x: Vec<f64> = (0..n).map(|k| [20.0, 35.0, 50.0, 80.0][k % 4]).collect();
        let group: Vec<usize> = (0..n).map(|k| k / 12).collect();
        let wave = |k: usize, by: f64| (k as f64 * by).sin();
        let other: Vec<f64> = (0..n).map(|k| wave(k, 1.3)).collect();
        let y: Vec<f64> = (0..n)
            .map(|k| 0.03 * x[k] + 1e3 * group[k] as f64 + wave(k, 7.1))
            .collect();
        let variance: Vec<f64> = (0..n).map(|k| 1.5 + wave(k, 0.3)).collect();
        let nuisance = Grouped::new(&variance, &group, &[other]);
        let material = Material {
            y: &y,
            variance: &variance,
            sample: &group,
            nuisance: &nuisance,
            x: &x,
            levels: &[20.0, 35.0, 50.0, 80.0],
            span: Span::of(&x),
            is_log: true,
            readings: 100.0,
        };
        let few = Resolution::new(&material);
        assert_eq!(few.columns.len(), 4);
        let many = Resolution {
            columns: Vec::new(),
            ..Resolution::new(&material)
        };
        for rows in [
            (0..n).collect::<Vec<_>>(),
            (0..n).filter(|k| k % 5 != 1).collect(),
        ] {
            let (together, apart) = (few.over(rows.clone()), many.over(rows));
            assert!(together.together.is_some() && apart.together.is_none());
            for curve in [[0.0; 4], [0.1, -0.4, 1.0, 2.0], [1.0, 1.0, 1.0, 1.5]] {
                let (a, b) = (together.square(&curve), apart.square(&curve));
                assert!((a - b).abs() < 1e-9 * b, "{a} {b}");
            }
            let curve = [0.1, -0.4, 1.0, 2.0];
            let (a, b) = (together.factor(&curve), apart.factor(&curve));
            assert!(
                (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9 * b.1,
                "{a:?} {b:?}"
            );
        }
    }
}
