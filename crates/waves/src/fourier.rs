//! The field of many plane waves at all pixels of a square: a sum over scattered frequencies.
//!
//! The waves are first spread onto a regular grid of frequencies by a smooth kernel, whose effect is divided out at the
//! end; the regular grid is transformed by two products with matrices (R. Soummer and others, "Fast computation of Lyot-style
//! coronagraph propagation", 2007). The kernel is the exponential of a semicircle (A. H. Barnett, J. Magland and L. af
//! Klinteberg, "A parallel nonuniform fast Fourier transform library", 2019).

use std::f64::consts::TAU;

use crate::quadrature::gauss_legendre;

/// A plane wave: its phase per pixel along x and y, radians, and its complex amplitude in the middle of the square.
#[derive(Clone, Copy, Debug)]
pub struct Wave {
    pub per_pixel: [f64; 2],
    pub amplitude: [f64; 2],
}

/// Width of the kernel in cells of the grid. The error is below 1e-8 of the sum of amplitudes.
const WIDTH: usize = 10;
/// The kernel is exp(SHAPE (√(1 - (2 t/WIDTH)²) - 1)).
const SHAPE: f64 = 2.3 * WIDTH as f64;
/// Number of cells of the grid per pixel.
const FINER: usize = 2;

fn kernel(t: f64) -> f64 {
    let part = 2.0 * t / WIDTH as f64;
    (SHAPE * ((1.0 - part * part).max(0.0).sqrt() - 1.0)).exp()
}

fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

fn phasor(phase: f64) -> [f64; 2] {
    let (sin, cos) = phase.sin_cos();
    [cos, sin]
}

/// Returns the field at the centres of `size` × `size` pixels, in rows of growing y: the sum over the waves of amplitude
/// times exp(i phase), with the phase counted from the middle of the square.
pub fn field(waves: &[Wave], size: usize) -> Vec<[f64; 2]> {
    let cells = FINER * size;
    let grid = spread(waves, size, cells);
    // exp(2π i k l/cells) for the pixels k - size/2 and the cells l, divided by the kernel's transform.
    let rule = gauss_legendre(3 * WIDTH);
    let pixels: Vec<(f64, f64)> = (0..size)
        .map(|k| {
            let pixel = k as f64 - (size / 2) as f64;
            (pixel, transform(&rule, pixel / cells as f64).recip())
        })
        .collect();
    let entries: Vec<[f64; 2]> = (0..cells)
        .flat_map(|l| pixels.iter().map(move |&(pixel, factor)| (l, pixel, factor)))
        .map(|(l, pixel, factor)| {
            phasor(TAU * (pixel * l as f64 / cells as f64).fract()).map(|part| factor * part)
        })
        .collect();
    let matrix = [0, 1].map(|part| entries.iter().map(|entry| entry[part]).collect::<Vec<f64>>());
    let along_x = times(&grid, cells, &matrix, cells, size);
    // The same product along y acts on the transposed array.
    let turned = along_x.map(|part| transposed(&part, cells, size));
    let [real, imaginary] = times(&turned, size, &matrix, cells, size);
    let at = |row: usize, column: usize| column * size + row;
    let pixels = (0..size).flat_map(|row| (0..size).map(move |column| (row, column)));
    pixels.map(|(row, column)| [real[at(row, column)], imaginary[at(row, column)]]).collect()
}

/// Spreads waves onto the grid of frequencies; a frequency beyond one cycle per pixel is one within it.
fn spread(waves: &[Wave], size: usize, cells: usize) -> [Vec<f64>; 2] {
    let mut grid = [0, 1].map(|_| vec![0.0; cells * cells]);
    // The middle of an even number of pixels lies between two of them.
    let shift = if size.is_multiple_of(2) { 0.5 } else { 0.0 };
    for wave in waves {
        let [x, y] = wave.per_pixel;
        let amplitude = product(wave.amplitude, phasor(shift * (x + y)));
        let [x, y] = [x, y].map(|phase| (phase / TAU).rem_euclid(1.0) * cells as f64);
        let along = |at: f64| {
            let first = (at - WIDTH as f64 / 2.0).ceil();
            let weights: [f64; WIDTH] = std::array::from_fn(|i| kernel(first + i as f64 - at));
            (first, weights)
        };
        let ((first_x, weights_x), (first_y, weights_y)) = (along(x), along(y));
        let cell = |first: f64, i: usize| (first as i64 + i as i64).rem_euclid(cells as i64) as usize;
        for (j, weight_y) in weights_y.iter().enumerate() {
            let row = cell(first_y, j) * cells;
            let [re, im] = amplitude.map(|part| part * weight_y);
            for (i, weight_x) in weights_x.iter().enumerate() {
                let at = row + cell(first_x, i);
                grid[0][at] += re * weight_x;
                grid[1][at] += im * weight_x;
            }
        }
    }
    grid
}

/// Returns the kernel's Fourier transform at a frequency in cycles per cell, by a rule of quadrature.
fn transform(rule: &[(f64, f64)], frequency: f64) -> f64 {
    let half = WIDTH as f64 / 2.0;
    let part =
        |&(at, weight): &(f64, f64)| half * weight * kernel(half * at) * (TAU * frequency * half * at).cos();
    rule.iter().map(part).sum()
}

/// Returns the product of an array of `rows` × `inner` complex numbers and a matrix of `inner` × `columns`.
fn times(
    array: &[Vec<f64>; 2],
    rows: usize,
    matrix: &[Vec<f64>; 2],
    inner: usize,
    columns: usize,
) -> [Vec<f64>; 2] {
    let mut result = [0, 1].map(|_| vec![0.0; rows * columns]);
    let [real, imaginary] = &mut result;
    for row in 0..rows {
        let (re, im) = (&mut real[row * columns..][..columns], &mut imaginary[row * columns..][..columns]);
        for k in 0..inner {
            let (a, b) = (array[0][row * inner + k], array[1][row * inner + k]);
            if a == 0.0 && b == 0.0 {
                continue;
            }
            let (c, d) = (&matrix[0][k * columns..][..columns], &matrix[1][k * columns..][..columns]);
            for i in 0..columns {
                re[i] += a * c[i] - b * d[i];
                im[i] += a * d[i] + b * c[i];
            }
        }
    }
    result
}

fn transposed(array: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    (0..rows * columns).map(|at| array[(at % rows) * columns + at / rows]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_is_the_direct_sum() {
        for size in [8, 15, 32] {
            let number = |i: usize, step: f64| (0.5 + i as f64 * step).fract();
            let waves: Vec<Wave> = (0..300)
                .map(|i| Wave {
                    // Some beyond half a cycle per pixel.
                    per_pixel: [9.0 * (number(i, 0.618_034) - 0.5), 4.0 * (number(i, 0.754_878) - 0.5)],
                    amplitude: phasor(TAU * number(i, 0.569_840)),
                })
                .collect();
            let found = field(&waves, size);
            let centre = (size as f64 - 1.0) / 2.0;
            for (at, own) in found.iter().enumerate() {
                let [x, y] = [at % size, at / size].map(|i| i as f64 - centre);
                let mut sum = [0.0; 2];
                for wave in &waves {
                    let [re, im] =
                        product(wave.amplitude, phasor(wave.per_pixel[0] * x + wave.per_pixel[1] * y));
                    sum = [sum[0] + re, sum[1] + im];
                }
                let error = (own[0] - sum[0]).hypot(own[1] - sum[1]);
                assert!(error < 1e-8 * waves.len() as f64, "{size} {at}: {error:e}");
            }
        }
    }
}
