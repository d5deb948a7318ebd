//! Short vectors: shift registers and inner products.

/// Puts `x` in front of what was there; the last is lost.
#[inline]
pub(crate) fn shift<const N: usize>(past: &mut [f32; N], x: f32) {
    for i in (1..N).rev() {
        past[i] = past[i - 1];
    }
    past[0] = x;
}

/// Inner product, summed from the first element on.
#[inline]
pub(crate) fn dot<const N: usize>(a: &[f32; N], b: &[f32; N]) -> f32 {
    let mut sum = a[0] * b[0];
    for i in 1..N {
        sum += a[i] * b[i];
    }
    sum
}

/// The sum of a list, four at a time. One function for lists of every length: unrolled for each of them it would take 2.5 kB of flash.
#[inline(never)]
pub(crate) fn sum(list: &[f32]) -> f32 {
    let (fours, rest) = list.as_chunks();
    let of_fours: f32 = fours.iter().map(|[a, b, c, d]| (a + b) + (c + d)).sum();
    of_fours + rest.iter().sum::<f32>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_first_and_the_oldest_is_lost() {
        let mut past = [3.0, 2.0, 1.0];
        shift(&mut past, 4.0);
        assert_eq!(past, [4.0, 3.0, 2.0]);
        assert_eq!(dot(&past, &[1.0, 10.0, 100.0]), 234.0);
    }
}
