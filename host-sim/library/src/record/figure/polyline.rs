//! From a signal to the few line pieces that a panel needs: split at gaps, thinned to the pixels, cut at the frame.

/// Time and value, in pixels.
pub(crate) type Point = (f64, f64);

/// Lines through `points`, broken where no value is a number for a pixel or more. Each pixel column keeps its lowest and
/// highest value, so that no spike is lost; `stepped` holds a value until the next; what lies beyond `bounds` is cut off.
pub(crate) fn polylines(points: &[Point], stepped: bool, bounds: (f64, f64)) -> Vec<Vec<Point>> {
    thin(points)
        .split(|p| !p.1.is_finite())
        .map(|line| if stepped { steps(line) } else { line.to_vec() })
        .flat_map(|line| cut(&line, bounds))
        .collect()
}

/// Keeps the lowest and the highest point of each pixel column, in the order of time; one that is no number if all are.
fn thin(points: &[Point]) -> Vec<Point> {
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| a.0.floor() == b.0.floor()) {
        let numbers = || column.iter().copied().filter(|p| p.1.is_finite());
        let lowest = numbers().min_by(|a, b| a.1.total_cmp(&b.1));
        let highest = numbers().max_by(|a, b| a.1.total_cmp(&b.1));
        match (lowest, highest) {
            (Some(low), Some(high)) if low == high => kept.push(low),
            (Some(low), Some(high)) if low.0 <= high.0 => kept.extend([low, high]),
            (Some(low), Some(high)) => kept.extend([high, low]),
            _ => kept.push((column[0].0, f64::NAN)),
        }
    }
    kept
}

/// Holds each value until the time of the next.
fn steps(line: &[Point]) -> Vec<Point> {
    let corners = line.windows(2).flat_map(|pair| [(pair[1].0, pair[0].1), pair[1]]);
    line.iter().copied().take(1).chain(corners).collect()
}

/// The pieces of a line between two heights.
fn cut(line: &[Point], bounds: (f64, f64)) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    for pair in line.windows(2) {
        let Some((a, b)) = cut_segment(pair[0], pair[1], bounds) else { continue };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&a) => piece.push(b),
            _ => pieces.push(vec![a, b]),
        }
    }
    pieces
}

fn cut_segment(a: Point, b: Point, (top, bottom): (f64, f64)) -> Option<(Point, Point)> {
    if a.1.max(b.1) < top || a.1.min(b.1) > bottom {
        return None;
    }
    let cross = |y: f64| (a.0 + (b.0 - a.0) * (y - a.1) / (b.1 - a.1), y);
    let inside = |p: Point| match p.1 {
        y if y < top => cross(top),
        y if y > bottom => cross(bottom),
        _ => p,
    };
    Some((inside(a), inside(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: (f64, f64) = (-1e3, 1e3);

    #[test]
    fn thinning_keeps_every_extreme_in_two_points_a_column() {
        let mut points: Vec<Point> = (0..10_000).map(|i| (f64::from(i) / 100.0, 0.0)).collect();
        points[1234].1 = 7.0;
        points[1250].1 = -5.0;
        let lines = polylines(&points, false, WIDE);
        let [line] = lines.as_slice() else { panic!("one line: {lines:?}") };
        assert!(line.contains(&(12.34, 7.0)) && line.contains(&(12.5, -5.0)));
        assert!(line.len() <= 200 && line.is_sorted_by(|a, b| a.0 <= b.0), "{}", line.len());
    }

    #[test]
    fn a_gap_breaks_the_line() {
        let points = [(0.0, 1.0), (1.0, 1.0), (2.0, f64::NAN), (3.0, 1.0), (4.0, 1.0)];
        let expected = vec![vec![(0.0, 1.0), (1.0, 1.0)], vec![(3.0, 1.0), (4.0, 1.0)]];
        assert_eq!(polylines(&points, false, WIDE), expected);
        let narrow = points.map(|(x, y)| (x / 2.5, y));
        assert_eq!(polylines(&narrow, false, WIDE), [[(0.0, 1.0), (0.4, 1.0), (1.2, 1.0), (1.6, 1.0)]]);
    }

    #[test]
    fn what_leaves_the_frame_is_cut_where_it_leaves() {
        let points = [(0.0, 0.0), (2.0, 20.0), (4.0, 0.0)];
        let expected = vec![vec![(0.0, 0.0), (1.0, 10.0)], vec![(3.0, 10.0), (4.0, 0.0)]];
        assert_eq!(polylines(&points, false, (0.0, 10.0)), expected);
    }

    #[test]
    fn a_step_holds_its_value() {
        let expected = vec![vec![(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)]];
        assert_eq!(polylines(&[(0.0, 0.0), (2.0, 1.0)], true, WIDE), expected);
    }
}
