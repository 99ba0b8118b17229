//! The Pareto front: points that no other point beats in one coordinate without losing in the
//! other.

/// Places of the points on the front, small values being better in both coordinates, by the first
/// coordinate. Of equal points all are on it.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let by_place = |a: &usize, b: &usize| {
        let ((ax, ay), (bx, by)) = (points[*a], points[*b]);
        ax.total_cmp(&bx).then(ay.total_cmp(&by))
    };
    order.sort_by(by_place);
    let mut front: Vec<usize> = Vec::new();
    for place in order {
        let is_equal = front.last().is_some_and(|last| points[*last] == points[place]);
        let is_better = front.last().is_none_or(|last| points[place].1 < points[*last].1);
        if is_equal || is_better {
            front.push(place);
        }
    }
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_nothing_beats() {
        let points = [(1.0, 5.0), (2.0, 3.0), (2.0, 4.0), (3.0, 3.0), (4.0, 1.0), (0.5, 5.0)];
        assert_eq!(pareto_front(&points), [5, 1, 4]);
        assert_eq!(pareto_front(&[(1.0, 1.0), (1.0, 1.0), (2.0, 2.0)]), [0, 1]);
        assert_eq!(pareto_front(&[]), [0; 0]);
    }
}
