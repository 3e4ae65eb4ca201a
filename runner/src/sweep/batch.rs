//! Several cases as the bytes of one file: a line that identifies the format, CBOR (RFC 8949), and a checksum.

use serde::{Deserialize, Serialize};

use super::case::{Case, Kept, Value};
use crate::checkpoint::Bits;

/// The first line, with the version of the format.
const FIRST: &[u8] = b"asperity sweep cases 1\n";
const CHECKSUM: usize = size_of::<u32>();

/// Several cases, column by column.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Batch {
    /// The numbers of the cases.
    pub cases: Vec<u64>,
    /// The paths of the entries that any of them has.
    pub columns: Vec<String>,
    /// The numbers of each column, NaN where there is none, and where there is a word.
    pub numbers: Vec<Bits>,
    /// Words: column, place among the cases, word.
    pub words: Vec<(u32, u32, String)>,
    /// The values of each curve, case by case.
    pub curves: Vec<Bits>,
    /// Why cases failed: place among the cases, reason.
    pub failures: Vec<(u32, String)>,
}

impl Batch {
    /// These cases.
    pub fn new(cases: &[Case]) -> Self {
        let mut batch =
            Self { cases: cases.iter().map(|case| case.number as u64).collect(), ..Self::default() };
        let kept = || cases.iter().map(|case| case.kept.as_ref());
        let lengths = kept().find_map(Result::ok).map(|kept| kept.curves.iter().map(Vec::len).collect());
        let lengths: Vec<usize> = lengths.unwrap_or_default();
        batch.curves = vec![Bits::default(); lengths.len()];
        for (place, kept) in kept().enumerate() {
            let empty = Kept::default();
            let kept = kept.unwrap_or_else(|reason| {
                batch.failures.push((place as u32, reason.clone()));
                &empty
            });
            for (path, value) in &kept.entries {
                batch.set(path, place, value);
            }
            for ((curve, length), all) in lengths.iter().enumerate().zip(&mut batch.curves) {
                match kept.curves.get(curve) {
                    Some(values) => all.0.extend(values),
                    None => all.0.resize(all.0.len() + length, f64::NAN),
                }
            }
        }
        batch
    }

    fn set(&mut self, path: &str, place: usize, value: &Value) {
        let column = self.columns.iter().position(|column| column == path).unwrap_or_else(|| {
            self.columns.push(path.to_owned());
            self.numbers.push(Bits(vec![f64::NAN; self.cases.len()]));
            self.columns.len() - 1
        });
        match value {
            Value::Number(number) => self.numbers[column].0[place] = *number,
            Value::Word(word) => self.words.push((column as u32, place as u32, word.clone())),
        }
    }

    /// The cases.
    pub fn unpacked(&self) -> Vec<Case> {
        let mut cases: Vec<Case> = self
            .cases
            .iter()
            .map(|&number| Case { number: number as usize, kept: Ok(Kept::default()) })
            .collect();
        for (place, case) in cases.iter_mut().enumerate() {
            let Ok(kept) = &mut case.kept else { continue };
            for (path, numbers) in self.columns.iter().zip(&self.numbers) {
                kept.entries.push((path.clone(), Value::Number(numbers.0[place])));
            }
            let each = |curve: &Bits| {
                let length = curve.0.len() / self.cases.len();
                curve.0[place * length..][..length].to_vec()
            };
            kept.curves = self.curves.iter().map(each).collect();
        }
        for (column, place, word) in &self.words {
            if let Ok(kept) = &mut cases[*place as usize].kept {
                kept.entries[*column as usize].1 = Value::Word(word.clone());
            }
        }
        for (place, reason) in &self.failures {
            cases[*place as usize].kept = Err(reason.clone());
        }
        cases
    }

    /// The bytes of a file.
    ///
    /// # Panics
    /// Never: memory does not refuse bytes.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = FIRST.to_vec();
        ciborium::into_writer(self, &mut bytes).expect("plain data, and memory does not refuse it");
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        bytes
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// Why these are not such bytes, in words.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let (body, checksum) = bytes
            .split_last_chunk::<CHECKSUM>()
            .ok_or_else(|| format!("it has only {} bytes", bytes.len()))?;
        if crc32fast::hash(body) != u32::from_le_bytes(*checksum) {
            return Err("its checksum is wrong".into());
        }
        let rest = body.strip_prefix(FIRST).ok_or("its first line is wrong")?;
        let batch: Self = ciborium::from_reader(rest).map_err(|error| error.to_string())?;
        let count = batch.cases.len();
        let fits = batch.columns.len() == batch.numbers.len()
            && batch.numbers.iter().all(|numbers| numbers.0.len() == count)
            && batch.curves.iter().all(|curve| count > 0 && curve.0.len().is_multiple_of(count))
            && batch
                .words
                .iter()
                .all(|word| (word.0 as usize) < batch.columns.len() && (word.1 as usize) < count)
            && batch.failures.iter().all(|failure| (failure.0 as usize) < count);
        if fits { Ok(batch) } else { Err("its parts do not fit together".into()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cases() -> Vec<Case> {
        let number = |path: &str, value| (path.to_owned(), Value::Number(value));
        let word = |path: &str, word: &str| (path.to_owned(), Value::Word(word.to_owned()));
        let first =
            Kept { entries: vec![number("a.b", 0.1), word("kind", "smooth")], curves: vec![vec![1.0, -0.0]] };
        let second = Kept {
            entries: vec![number("a.b", f64::INFINITY), number("kind", 2.0)],
            curves: vec![vec![3.0, 4.0]],
        };
        vec![
            Case { number: 7, kept: Ok(first) },
            Case { number: 3, kept: Err("too large".to_owned()) },
            Case { number: 9, kept: Ok(second) },
        ]
    }

    #[test]
    fn cases_are_read_as_they_were_written() {
        let batch = Batch::new(&cases());
        let read = Batch::decode(&batch.encode()).unwrap();
        assert_eq!(read.unpacked(), cases());
        assert_eq!(Batch::decode(&Batch::new(&[]).encode()).unwrap().unpacked(), []);
    }

    #[test]
    fn any_byte_that_changes_and_any_end_that_is_cut_off_is_found() {
        let bytes = Batch::new(&cases()).encode();
        for place in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[place] ^= 0x10;
            assert!(Batch::decode(&changed).is_err(), "byte {place}");
            assert!(Batch::decode(&bytes[..place]).is_err(), "{place} bytes");
        }
    }
}
