//! Columns of numbers in a CSV file, by their names.
//!
//! Cells are separated by tabs, semicolons or commas, the first of these that the heading has; where it is no comma, numbers may
//! have decimal commas. Names are compared without regard to case and to a unit in brackets. Columns are in any order, and others
//! are ignored; so are lines that begin with `#`, and a line of units below the heading. A file of one column needs no heading.

use std::path::Path;

use super::fault::Fault;
use super::{short, text};

/// Whether there is a file system. The code that reads files is left out of WebAssembly, which has none.
pub const HAS_FILES: bool = cfg!(not(target_family = "wasm"));

/// Other names of columns, as the explorer knows them, too.
const SYNONYMS: [(&str, &str); 4] =
    [("displacement", "position"), ("x", "position"), ("stress", "force"), ("f", "force")];

/// The columns of a CSV file with one of the given `layouts`.
pub fn read(path: &Path, layouts: &[&[&str]]) -> Result<Vec<Vec<f64>>, Fault> {
    read_one_of(path, layouts).map(|(_, columns)| columns)
}

/// The number of the layout of a CSV file, among the given ones, and its columns.
pub fn read_one_of(path: &Path, layouts: &[&[&str]]) -> Result<(usize, Vec<Vec<f64>>), Fault> {
    if !HAS_FILES {
        unreachable!("no file has a place without a file system");
    }
    let name = path.display();
    let expected = layouts.iter().map(|columns| columns.join(",")).collect::<Vec<_>>().join(" or ");
    let expected = format!("a CSV file with columns {expected}");
    let fault = |found: String| Fault::new(&expected, &found);
    let text = text::read(path).map_err(|why| fault(format!("{name}: {why}")))?;
    let separator = separator(&text);
    let rows = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let number = |cell: &str| -> Option<f64> {
        if separator == b',' { cell.parse().ok() } else { cell.replace(',', ".").parse().ok() }
    };
    let mut heading: Option<Heading> = None;
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for (row, record) in rows.into_records().enumerate() {
        let record = record.map_err(|error| fault(format!("{name}: {error}")))?;
        let cells: Vec<&str> = record.iter().collect();
        let line = record.position().map_or(0, csv::Position::line);
        let shown = || format!("\"{}\" in line {line} of {name}", short(&cells.join(",")));
        if heading.is_none() {
            let known = Heading::of(&cells, layouts).ok_or_else(|| fault(shown()))?;
            columns = vec![Vec::new(); known.places.len()];
            let has_none = known.width == 1 && number(cells[0]).is_some();
            heading = Some(known);
            if !has_none {
                continue;
            }
        }
        let Some(heading) = &heading else { continue };
        let numbers: Option<Vec<f64>> =
            heading.places.iter().map(|&place| cells.get(place).copied().and_then(number)).collect();
        let of_units = || row == 1 && cells.iter().all(|cell| !cell.is_empty() && number(cell).is_none());
        match numbers {
            Some(numbers)
                if cells.len() == heading.width && numbers.iter().all(|number| number.is_finite()) =>
            {
                columns.iter_mut().zip(numbers).for_each(|(column, number)| column.push(number));
            }
            None if heading.width > 1 && cells.len() == heading.width && of_units() => {}
            _ => {
                let expected =
                    format!("a number in each of the columns {}", layouts[heading.layout].join(","));
                return Err(Fault::new(&expected, &shown()));
            }
        }
    }
    match heading {
        Some(heading) if !columns[0].is_empty() => Ok((heading.layout, columns)),
        _ => Err(fault(format!("no rows in {name}"))),
    }
}

/// Where the columns of a layout are.
struct Heading {
    /// The number of the layout.
    layout: usize,
    /// The place of each of its columns.
    places: Vec<usize>,
    /// The number of all columns.
    width: usize,
}

impl Heading {
    /// The largest layout all of whose names are in a heading, if no other one is as large.
    fn of(cells: &[&str], layouts: &[&[&str]]) -> Option<Self> {
        let names: Vec<String> = cells.iter().map(|cell| plain(cell)).collect();
        let places = |layout: &[&str]| -> Option<Vec<usize>> {
            if cells.len() == 1 && layout.len() == 1 {
                return Some(vec![0]);
            }
            // Of several columns with one name none is meant for certain.
            let place = |name: &&str| {
                let mut found = (0..names.len()).filter(|&place| names[place] == **name);
                found.next().filter(|_| found.next().is_none())
            };
            layout.iter().map(place).collect()
        };
        let known =
            layouts.iter().enumerate().filter_map(|(i, layout)| places(layout).map(|places| (i, places)));
        let known: Vec<_> = known.collect();
        let most = known.iter().map(|(_, places)| places.len()).max()?;
        let mut largest = known.into_iter().filter(|(_, places)| places.len() == most);
        let (layout, places) = largest.next()?;
        largest.next().is_none().then_some(Self { layout, places, width: cells.len() })
    }
}

/// The name of a column: without its unit, in small letters, and as it is called here.
fn plain(cell: &str) -> String {
    let name = cell.split(['(', '[']).next().unwrap_or_default().trim().to_lowercase();
    let known = SYNONYMS.iter().find(|(other, _)| *other == name);
    known.map_or(name, |(_, name)| (*name).to_owned())
}

/// What separates the cells of a CSV file: the first of these marks that its heading has.
fn separator(text: &str) -> u8 {
    let heading =
        text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    [b'\t', b';'].into_iter().find(|mark| heading.as_bytes().contains(mark)).unwrap_or(b',')
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUTS: [&[&str]; 2] = [&["position", "force"], &["drive", "force"]];

    fn columns(text: &str, layouts: &[&[&str]]) -> Result<(usize, Vec<Vec<f64>>), Fault> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("measured.csv");
        std::fs::write(&path, text).unwrap();
        read_one_of(&path, layouts)
    }

    #[test]
    fn files_as_programs_and_machines_write_them_are_read() {
        let expected = vec![vec![0.5, 1.5], vec![2.0, 3.25]];
        for text in [
            "position,force\n0.5,2\n1.5,3.25\n",
            "position;force\r\n0,5;2,0\r\n1,5;3,25\r\n",
            "Position (mm)\tFORCE [N]\n0,5\t2\n1,5\t3,25\n",
            "# by a machine\nforce,time,position\n2,0,0.5\n# a pause\n3.25,1,1.5\n",
            "position,force\nmm,N\n0.5,2\n1.5,3.25\n",
            "Displacement,Stress\n0.5,2\n\n1.5,3.25\n",
            "\u{feff}\"X\",\"F\"\n0.5,2\n1.5,3.25\n",
        ] {
            let (layout, found) =
                columns(text, &LAYOUTS).unwrap_or_else(|fault| panic!("{text}: {}", fault.found));
            assert_eq!((layout, &found), (0, &expected), "{text}");
        }
        assert_eq!(columns("drive,force\n1,2\n", &LAYOUTS).unwrap(), (1, vec![vec![1.0], vec![2.0]]));
        // The larger layout that fits.
        let curves: [&[&str]; 2] = [&["velocity", "force"], &["velocity", "force", "error"]];
        assert_eq!(columns("velocity,force,error\n1,2,3\n", &curves).unwrap().0, 1);
        assert_eq!(columns("velocity,force,run\n1,2,3\n", &curves).unwrap().0, 0);
        let one: [&[&str]; 1] = [&["sample"]];
        for text in ["1\n2\n", "anything\n1\n2\n"] {
            assert_eq!(columns(text, &one).unwrap(), (0, vec![vec![1.0, 2.0]]), "{text}");
        }
    }

    #[test]
    fn a_cell_that_is_no_number_is_shown_with_its_line() {
        for (text, expected, found) in [
            (
                "position,force\n1,2\n3,\n",
                "a number in each of the columns position,force",
                "\"3,\" in line 3",
            ),
            ("position,force\n1,2\n3\n", "a number in each of the columns", "\"3\" in line 3"),
            ("position,force\n1,2\n3,4,5\n", "a number in each of the columns", "\"3,4,5\" in line 3"),
            ("position,force\nnan,2\n", "a number in each of the columns", "\"nan,2\" in line 2"),
            ("position,force\nmm,N\nmm,N\n", "a number in each of the columns", "\"mm,N\" in line 3"),
            ("drive,force\n1,2\nmm,N\n", "a number in each of the columns drive,force", "\"mm,N\" in line 3"),
            ("1,2\n3,4\n", "a CSV file with columns position,force or drive,force", "\"1,2\" in line 1"),
            (
                "position,drive,force\n1,2,3\n",
                "a CSV file with columns",
                "\"position,drive,force\" in line 1",
            ),
            (
                "position,force,stress\n1,2,3\n",
                "a CSV file with columns",
                "\"position,force,stress\" in line 1",
            ),
            ("position,force\n", "a CSV file with columns", "no rows"),
            ("", "a CSV file with columns", "no rows"),
        ] {
            let fault = columns(text, &LAYOUTS).unwrap_err();
            assert!(
                fault.expected.starts_with(expected) && fault.found.starts_with(found),
                "{text}: {fault:?}"
            );
        }
        assert!(columns("inf\n1\n", &[&["sample"]]).is_err());
    }
}
