//! Tables for spreadsheets and scripts: a header, then numbers in the fewest digits that read back exactly.

use asperity::record::Record;

/// `value` in the fewest digits that give it back when read.
pub fn shortest(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-5..1e16).contains(&size) { value.to_string() } else { format!("{value:e}") }
}

/// The tables of a record: name and text of each that has any rows.
pub(super) fn tables(record: &Record) -> impl Iterator<Item = (&'static str, String)> {
    let force = table(record, &["position", "force", "breaking_rate"], &["ensemble_force", "ensemble_error"]);
    [("force.csv", force), ("atoms.csv", atoms(record))]
        .into_iter()
        .filter_map(|(name, text)| text.map(|text| (name, text)))
}

/// The columns `required`, and those of `optional` that are there, under their names.
fn table(record: &Record, required: &[&str], optional: &[&str]) -> Option<String> {
    let needed: Option<Vec<_>> = required.iter().map(|name| record.get(name)).collect();
    let columns: Vec<_> =
        needed?.into_iter().chain(optional.iter().filter_map(|name| record.get(name))).collect();
    let header: Vec<_> = columns.iter().map(|c| c.name.as_str()).collect();
    let mut text = header.join(",") + "\n";
    for row in 0..columns[0].values.len() {
        let cells: Vec<_> = columns.iter().map(|c| shortest(c.values[row])).collect();
        text += &cells.join(",");
        text.push('\n');
    }
    Some(text)
}

/// Point masses: the density that they complete, and the dimension along which they are listed.
const ATOMS: [(&str, &str); 4] = [
    ("breaking_rate", "breaking_atom"),
    ("stretch_density", "stretch_atom"),
    ("steady_stretch_density", "steady_atom"),
    ("threshold_density", "threshold_atom"),
];

/// The point masses of all distributions: position of the pull and stretch, where they have one, and weight.
fn atoms(record: &Record) -> Option<String> {
    let mut rows = String::new();
    for (density, dimension) in ATOMS {
        let column = |name| record.values(&format!("{dimension}_{name}"));
        let cell = |name, row: usize| column(name).map_or(String::new(), |values| shortest(values[row]));
        for row in 0..record.length(dimension).unwrap_or(0) {
            let (position, stretch, weight) =
                (cell("position", row), cell("stretch", row), cell("weight", row));
            rows += &format!("{density},{position},{stretch},{weight}\n");
        }
    }
    (!rows.is_empty()).then(|| "distribution,position,stretch,weight\n".to_owned() + &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_exactly_and_stay_short() {
        for value in [0.0, -0.0, 0.1, 1.0, 1e-5, 9.9e-6, 1e300, -5e-324, 123456.789, 1e16, f64::MAX] {
            let text = shortest(value);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
            assert!(text.len() <= 24, "{text}");
        }
    }
}
