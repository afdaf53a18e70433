//! Who comes before whom: one order for everything that ranks episodes or transitions, so that ties fall alike everywhere.

/// Episodes by their return, highest first; between equal returns the earlier episode wins.
pub(crate) fn ranking(returns: &[f64]) -> Vec<usize> {
    let mut ranking: Vec<usize> = (0..returns.len()).collect();
    // Adding zero makes -0.0 the 0.0 that it compares as.
    let key = |i: usize| returns[i] + 0.0;
    ranking.sort_by(|&i, &j| key(j).total_cmp(&key(i)));
    ranking
}

/// The place of each value among all, 0 for the highest, ties sharing their mean place.
pub(crate) fn ranks(values: &[f64]) -> Vec<f64> {
    let order = ranking(values);
    // What is no number ties with itself, too.
    let equal = |i: usize, j: usize| (values[i] + 0.0).total_cmp(&(values[j] + 0.0)).is_eq();
    let mut ranks = vec![0.0; values.len()];
    let mut start = 0;
    while start < order.len() {
        let tied = order[start..]
            .iter()
            .take_while(|&&i| equal(i, order[start]))
            .count();
        for &i in &order[start..start + tied] {
            ranks[i] = start as f64 + (tied as f64 - 1.0) / 2.0;
        }
        start += tied;
    }
    ranks
}

/// How many of `count` are the top `k` percent, rounded to the nearest; between two, up.
pub(crate) fn share(count: usize, k: f64) -> usize {
    (count as f64 * k / 100.0).round() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_earlier_of_equal_values_comes_first_and_zero_has_no_sign() {
        assert_eq!(ranking(&[1.0, 3.0, 1.0, -0.0, 0.0]), [1, 0, 2, 3, 4]);
    }

    #[test]
    fn equal_values_share_their_mean_place() {
        assert_eq!(ranks(&[2.0, 5.0, 2.0, 1.0]), [1.5, 0.0, 1.5, 3.0]);
        assert_eq!(ranks(&[0.0, 5.0, -0.0]), [1.5, 0.0, 1.5]);
        assert_eq!(ranks(&[f64::NAN, 1.0, f64::NAN]), [0.5, 2.0, 0.5]);
    }

    #[test]
    fn half_an_episode_is_one() {
        assert_eq!([share(4, 12.5), share(4, 12.4), share(4, 100.0)], [1, 0, 4]);
    }
}
