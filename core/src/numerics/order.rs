//! Items in the order of a number that each has.
//!
//! What depends on the type of the items is short: sorting itself is compiled once, for numbers and places.

/// Sorts items by a number; those of the same number stay in their order.
pub(crate) fn sort_by_number<T>(items: &mut [T], number: impl Fn(&T) -> f64) {
    let mut keys: Vec<(f64, usize)> = items.iter().enumerate().map(|(i, item)| (number(item), i)).collect();
    for (place, other) in exchanges(&mut keys) {
        items.swap(place, other);
    }
}

/// The largest of numbers of 0 or above; not a number if one of them is none, which no comparison with what is allowed lets pass.
pub(crate) fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |largest, number| if number.is_nan() || number > largest { number } else { largest })
}

/// The exchanges, one after the other, that bring items into the order of their numbers.
fn exchanges(keys: &mut [(f64, usize)]) -> Vec<(usize, usize)> {
    if keys.is_sorted_by(|a, b| a.0.total_cmp(&b.0).is_le()) {
        return vec![];
    }
    keys.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut found = Vec::with_capacity(keys.len());
    for first in 0..keys.len() {
        // Along a cycle, each place takes the item that belongs there.
        let mut place = first;
        while keys[place].1 != first {
            let from = keys[place].1;
            found.push((place, from));
            keys[place].1 = place;
            place = from;
        }
        keys[place].1 = place;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    #[test]
    fn a_number_that_is_none_is_the_largest() {
        assert_eq!(largest([1.0, 3.0, 2.0].into_iter()), 3.0);
        assert_eq!(largest(std::iter::empty()), 0.0);
        for numbers in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(largest(numbers.into_iter()).is_nan());
        }
    }

    #[test]
    fn it_sorts_as_the_standard_library_does() {
        for length in [0, 1, 2, 7, 100, 1000] {
            let mut stream = Stream::new(1, Purpose::Sample, length as u64);
            // Many equal numbers, and some that are none.
            let number =
                |uniform: f64| if uniform < 0.05 { f64::NAN } else { (20.0 * uniform).floor() - 10.0 };
            let items: Vec<(f64, usize)> = (0..length).map(|i| (number(stream.uniform()), i)).collect();
            let (mut found, mut expected) = (items.clone(), items);
            sort_by_number(&mut found, |item| item.0);
            expected.sort_by(|a, b| a.0.total_cmp(&b.0));
            let bits = |items: &[(f64, usize)]| -> Vec<(u64, usize)> {
                items.iter().map(|item| (item.0.to_bits(), item.1)).collect()
            };
            assert_eq!(bits(&found), bits(&expected), "{length}");
        }
    }
}
