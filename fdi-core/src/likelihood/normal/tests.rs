extern crate std;

use std::vec::Vec;

use super::super::reference::Random;
use super::*;

type Tick = (Regressors, [f32; 2], f32);

fn ticks(random: &mut Random, n: usize) -> Vec<Tick> {
    let number = |random: &mut Random| (10.0 * random.gaussian()) as f32;
    (0..n)
        .map(|_| {
            let row = core::array::from_fn(|_| [number(random), number(random)]);
            (row, [number(random), number(random)], random.uniform() as f32)
        })
        .collect()
}

fn sums(ticks: &[Tick]) -> Normal {
    let mut normal = Normal::default();
    ticks.iter().for_each(|(row, z, weight)| normal.add(1.0, row, *z, *weight));
    normal
}

/// sum over ticks and both channels, weighted, in f64.
fn sum(ticks: &[Tick], of: impl Fn(&Regressors, &[f32; 2], usize) -> f64) -> f64 {
    ticks.iter().map(|(row, z, w)| f64::from(*w) * (of(row, z, 0) + of(row, z, 1))).sum()
}

fn close(x: f32, wanted: f64, scale: f64) {
    assert!((f64::from(x) - wanted).abs() < 2e-5 * scale, "{x}, not {wanted}");
}

#[test]
fn the_sums_are_those_of_the_definition() {
    let ticks = ticks(&mut Random::new(1), 200);
    let normal = sums(&ticks);
    for i in 0..COUNT {
        for j in 0..COUNT {
            let wanted = sum(&ticks, |row, _, m| f64::from(row[i][m]) * f64::from(row[j][m]));
            close(normal.a(i, j), wanted, 4e4);
            assert_eq!(normal.a(i, j), normal.a(j, i));
        }
        close(normal.b[i], sum(&ticks, |row, z, m| f64::from(row[i][m]) * f64::from(z[m])), 4e4);
    }
    close(normal.energy, sum(&ticks, |_, z, m| f64::from(z[m]) * f64::from(z[m])), 4e4);
    close(normal.count, sum(&ticks, |_, _, _| 1.0), 400.0);
}

/// Taking away what values explain gives the sums of residuals without it.
#[test]
fn what_is_explained_is_gone() {
    let mut random = Random::new(2);
    let ticks = ticks(&mut random, 100);
    let values: [f32; COUNT] = core::array::from_fn(|_| random.gaussian() as f32);
    let mut normal = sums(&ticks);
    normal.explain(&values);
    for i in 0..COUNT {
        let left = |row: &Regressors, z: &[f32; 2], m: usize| {
            let explained: f64 = (0..COUNT).map(|j| f64::from(values[j]) * f64::from(row[j][m])).sum();
            f64::from(row[i][m]) * (f64::from(z[m]) - explained)
        };
        close(normal.b[i], sum(&ticks, left), 2e5);
    }
}

/// A regressor that is forgotten has never been; all else stays to the bit.
#[test]
fn forgetting_columns_leaves_the_others() {
    let mut ticks = ticks(&mut Random::new(3), 50);
    let whole = sums(&ticks);
    let mut forgotten = whole;
    forgotten.forget(&[Regressor::Offset1, Regressor::Offset2, Regressor::Gain2]);
    for (row, ..) in &mut ticks {
        for regressor in [Regressor::Offset1, Regressor::Offset2, Regressor::Gain2] {
            row[regressor as usize] = [0.0; 2];
        }
    }
    let wanted = sums(&ticks);
    for i in 0..COUNT {
        assert_eq!(forgotten.b[i], wanted.b[i]);
        for j in 0..COUNT {
            assert_eq!(forgotten.a(i, j), wanted.a(i, j));
        }
    }
    assert_eq!((forgotten.energy, forgotten.count), (whole.energy, whole.count));
}

#[test]
fn keeping_a_share_scales_everything() {
    let ticks = ticks(&mut Random::new(4), 50);
    let (whole, mut half) = (sums(&ticks), sums(&ticks));
    half.add(0.5, &[[0.0; 2]; COUNT], [0.0; 2], 0.0);
    for i in 0..COUNT {
        assert_eq!(half.b[i], 0.5 * whole.b[i]);
        (0..COUNT).for_each(|j| assert_eq!(half.a(i, j), 0.5 * whole.a(i, j)));
    }
    assert_eq!((half.energy, half.count), (0.5 * whole.energy, 0.5 * whole.count));
    assert_eq!(whole.a(COUNT, COUNT), 0.0, "no regressor, no sum");
}
