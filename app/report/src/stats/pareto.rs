//! The Pareto front: points that no other point beats in one coordinate without losing in the
//! other.

/// First coordinates that differ by less than this share are the same: two results of 1,000 and of
/// 1,001 faces were made for one target.
const SAME: f64 = 0.01;

/// Places of the points on the front, small values being better in both coordinates, by the first
/// coordinate. First coordinates within 1 % count as equal. Of equal points all are on it.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<usize> {
    let is_beaten = |&(x, y): &(f64, f64)| {
        points.iter().any(|&(other_x, other_y)| {
            let is_no_larger = other_x - x <= SAME * x.abs().max(other_x.abs());
            is_no_larger && other_y < y
        })
    };
    // Of points with the same second coordinate, the ones that are clearly larger lose as well.
    let is_wider = |&(x, y): &(f64, f64)| {
        points.iter().any(|&(other_x, other_y)| {
            other_y == y && x - other_x > SAME * x.abs().max(other_x.abs())
        })
    };
    let mut front: Vec<usize> = (0..points.len())
        .filter(|place| !is_beaten(&points[*place]) && !is_wider(&points[*place]))
        .collect();
    front.sort_by(|a, b| points[*a].0.total_cmp(&points[*b].0));
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

    #[test]
    fn a_face_more_is_no_reason_to_stay() {
        let points = [(62003.0, 1e-3), (62004.0, 4e-4), (31000.0, 2e-3)];
        assert_eq!(pareto_front(&points), [2, 1]);
    }
}
