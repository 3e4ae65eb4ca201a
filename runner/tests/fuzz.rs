//! Random changes of scenarios, tables, results, checkpoints and parameters of distributions: none makes the program panic, hang or
//! take memory without limit. The targets are those of cargo-fuzz (`fuzz/src/targets.rs`), the inputs are made of its corpus by a
//! seeded generator.
//!
//! A fixed number of inputs here; `make fuzz` goes on for `ASPERITY_FUZZ_SECONDS`. An input that fails is left in `target/fuzz`, and
//! belongs into `fuzz/corpus`, whose files are all tried unchanged.

#[path = "../../fuzz/src/targets.rs"]
mod targets;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use asperity::random::{Purpose, Stream};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Bytes that one input may take: tables of a distribution take some MB.
const MOST_BYTES: usize = 256 << 20;
/// An input is read in milliseconds. This is what a loaded machine needs for the slowest, times ten.
const LONGEST: Duration = Duration::from_secs(20);
/// Inputs of more bytes are cut.
const MOST: usize = 1 << 16;

/// Parts of texts and of files at which readers decide, and numbers at which arithmetic does.
const WORDS: [&[u8]; 26] = [
    b"0",
    b"-1",
    b"1e308",
    b"-1e308",
    b"1e-308",
    b"5e-324",
    b"nan",
    b"inf",
    b"-inf",
    b"18446744073709551616",
    b"9223372036854775807",
    b"[",
    b"]",
    b"{",
    b"}",
    b"\"",
    b"'",
    b"\n",
    b",",
    b"=",
    b".",
    b"#",
    b"\xff",
    b"\0\0\0\0",
    b"\xff\xff\xff\xff",
    b"\xe2\x82\xac",
];
/// The bits of such numbers.
const NUMBERS: [f64; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.1,
    20.0,
    1e3,
    1e16,
    1e150,
    1e300,
    f64::MAX,
    f64::MIN_POSITIVE,
    5e-324,
    1e-150,
    f64::INFINITY,
    f64::NAN,
];

/// A target, with its name and the number of inputs here.
struct Target {
    name: &'static str,
    run: fn(&[u8]),
    count: usize,
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// The files of a folder, in the order of their names.
fn files(folder: &Path) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<_> =
        entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).unwrap()).collect()
}

impl Target {
    fn corpus(&self) -> Vec<Vec<u8>> {
        let mut corpus = files(&folder("fuzz/corpus").join(self.name));
        match self.name {
            "scenario" => {
                ["scenarios", "scenarios/invalid"]
                    .iter()
                    .for_each(|name| corpus.extend(files(&folder(name))));
            }
            "table" => {
                let tables = files(&folder("scenarios")).into_iter().filter(|file| file.contains(&b','));
                corpus.extend(tables);
            }
            // One of another version is refused at its header.
            "checkpoint" => corpus.push(fresh_checkpoint()),
            _ => {}
        }
        corpus.retain(|file| file.len() <= MOST);
        corpus
    }

    /// Tries one input.
    fn try_one(&self, input: &[u8]) {
        let before = MEMORY.current_usage();
        MEMORY.reset_peak_usage();
        let begun = Instant::now();
        let panicked = catch_unwind(AssertUnwindSafe(|| (self.run)(input))).is_err();
        let (taken, most) = (begun.elapsed(), MEMORY.peak_usage().saturating_sub(before));
        if panicked || taken > LONGEST || most > MOST_BYTES {
            let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../fuzz");
            let path = place.join(format!("{}-{:08x}", self.name, crc32fast::hash(input)));
            fs::create_dir_all(&place).unwrap();
            fs::write(&path, input).unwrap();
            panic!("{}: panicked: {panicked}, {taken:?}, {most} bytes of memory", path.display());
        }
    }

    /// Tries the corpus, and inputs made of it.
    fn search(&self) {
        let corpus = self.corpus();
        assert!(!corpus.is_empty(), "{}: no corpus", self.name);
        corpus.iter().for_each(|input| self.try_one(input));
        let seconds = std::env::var("ASPERITY_FUZZ_SECONDS").ok().and_then(|text| text.parse().ok());
        let longer = seconds.map(|seconds| (Instant::now(), Duration::from_secs(seconds)));
        let mut made = 0;
        while longer.map_or(made < self.count, |(begun, limit)| begun.elapsed() < limit) {
            self.try_one(&changed(&corpus, made as u64));
            made += 1;
        }
        println!("{}: {} files, {made} inputs made of them", self.name, corpus.len());
    }
}

/// A checkpoint of this version.
fn fresh_checkpoint() -> Vec<u8> {
    let place = tempfile::tempdir().unwrap();
    targets::resume(place.path(), 1000);
    fs::read(place.path().join("run.checkpoint.0")).unwrap()
}

/// A source of whole numbers.
struct Dice(Stream);

impl Dice {
    /// A number below `limit`; 0 where that is 0.
    fn below(&mut self, limit: usize) -> usize {
        ((self.0.uniform() * limit as f64) as usize).min(limit.saturating_sub(1))
    }
}

/// A file of the corpus after some changes, the same for the same number.
fn changed(corpus: &[Vec<u8>], number: u64) -> Vec<u8> {
    let mut dice = Dice(Stream::new(22, Purpose::Posterior, number));
    let mut input = corpus[dice.below(corpus.len())].clone();
    for _ in 0..=dice.below(6) {
        change(&mut input, corpus, &mut dice);
    }
    input.truncate(MOST);
    input
}

fn change(input: &mut Vec<u8>, corpus: &[Vec<u8>], dice: &mut Dice) {
    let at = dice.below(input.len() + 1);
    let end = (at + 1 + dice.below(32)).min(input.len());
    match dice.below(9) {
        0 if at < input.len() => input[at] ^= 1 << dice.below(8),
        1 if at < input.len() => input[at] = dice.below(256) as u8,
        2 => drop(input.drain(at.min(end)..end)),
        3 => input.truncate(at),
        4 => {
            let part = input[at.min(end)..end].to_vec();
            insert(input, at, &part);
        }
        5 => {
            let other = &corpus[dice.below(corpus.len())];
            let from = dice.below(other.len() + 1);
            let to = (from + dice.below(64)).min(other.len());
            insert(input, at, &other[from..to]);
        }
        6 => insert(input, at, WORDS[dice.below(WORDS.len())]),
        7 => another_number(input, at, dice),
        _ => {
            let number = NUMBERS[dice.below(NUMBERS.len())].to_le_bytes();
            // Eight bytes from a place at which a number may begin in a binary file.
            let at = at - at % if dice.below(2) == 0 { 8 } else { 1 };
            input.iter_mut().skip(at).zip(number).for_each(|(byte, new)| *byte = new);
        }
    }
}

fn insert(input: &mut Vec<u8>, at: usize, bytes: &[u8]) {
    input.splice(at..at, bytes.iter().copied());
}

/// Puts another number in the place of the first one behind a place in a text.
fn another_number(input: &mut Vec<u8>, at: usize, dice: &mut Dice) {
    let is_part = |byte: &u8| byte.is_ascii_digit() || b".-+e".contains(byte);
    let Some(from) = input[at..].iter().position(u8::is_ascii_digit).map(|from| at + from) else { return };
    let length = input[from..].iter().take_while(|byte| is_part(byte)).count();
    input.splice(from..from + length, WORDS[dice.below(11)].iter().copied());
}

#[test]
fn scenarios() {
    Target { name: "scenario", run: targets::scenario, count: 3000 }.search();
}

#[test]
fn tables() {
    Target { name: "table", run: targets::table, count: 1000 }.search();
}

#[test]
fn results() {
    Target { name: "result", run: targets::result, count: 5000 }.search();
}

#[test]
fn checkpoints() {
    Target { name: "checkpoint", run: targets::checkpoint, count: 1000 }.search();
}

#[test]
fn laws() {
    Target { name: "law", run: targets::law, count: 5000 }.search();
}

/// What is changed is right before: every kind of table is read from some file, and a result is.
#[test]
fn the_corpus_is_read() {
    let tables = Target { name: "table", run: targets::table, count: 0 }.corpus();
    for text in targets::TABLES {
        let place = tempfile::tempdir().unwrap();
        let is_read = |table: &Vec<u8>| {
            fs::write(place.path().join("table.csv"), table).unwrap();
            asperity_runner::input::parse(text, "fuzz", place.path(), &[]).is_ok()
        };
        assert!(tables.iter().any(is_read), "no file of the corpus is a table of {text}");
    }
    let place = tempfile::tempdir().unwrap();
    for (name, from) in [
        ("summary.json", "seeds/summary.json"),
        ("scenario.toml", "seeds/pull.toml"),
        ("result.nc", "corpus/result/pull.nc"),
    ] {
        fs::copy(folder("fuzz").join(from), place.path().join(name)).unwrap();
    }
    let outcome = asperity_runner::output::read(place.path()).unwrap();
    assert_eq!(outcome.record.values("force").unwrap().len(), 3);
}

#[test]
fn the_same_inputs_are_made_every_time() {
    let corpus = [b"mean = 1.0".to_vec(), b"std = 0.1".to_vec()];
    for number in 0..100 {
        assert_eq!(changed(&corpus, number), changed(&corpus, number));
    }
    let different: std::collections::BTreeSet<_> = (0..100).map(|number| changed(&corpus, number)).collect();
    // By chance some are equal: a file that one change cut to nothing.
    assert!(different.len() > 80, "{}", different.len());
}

/// Writes the seeds in binary form anew: a result and a checkpoint of this version.
#[test]
#[ignore = "writes files of the repository"]
fn seeds() {
    let corpus = folder("fuzz/corpus");
    let pull = asperity_runner::input::read(&folder("fuzz/seeds/pull.toml"), &[]).unwrap();
    let outcome = asperity_runner::run(&pull.scenario, &mut ()).unwrap();
    let place = tempfile::tempdir().unwrap();
    let out = place.path().join("out");
    asperity_runner::output::write(&out, &outcome, &[]).unwrap();
    fs::copy(out.join("result.nc"), corpus.join("result/pull.nc")).unwrap();
    fs::copy(out.join("summary.json"), folder("fuzz/seeds/summary.json")).unwrap();
    fs::write(corpus.join("checkpoint/chain"), fresh_checkpoint()).unwrap();
}
