//! Scenarios drawn from the JSON Schema that the program exports: a case is its number.

use std::collections::BTreeMap;

use serde_json::Value as Json;
use toml::{Table, Value};

use super::distributions::{self, VARIATIONS};
use super::quantities::{self, Units};
use super::random::SplitMix;
use super::rules;

/// Keys that are not drawn: those that name a file, since other keys give the same values, and the table of sweeps, whose cases are
/// scenarios, and the friction of free contacts, which needs a delay.
const NOT_DRAWN: [&str; 4] = ["file", "free_friction", "protocol_file", "sweep"];
/// Values that are no measurement.
const ODD: [f64; 7] = [0.0, -1.0, f64::NAN, f64::INFINITY, 1e308, 5e-324, -0.0];
/// Whole numbers that ask for too much, or for nothing.
const ODD_COUNTS: [i64; 4] = [0, 1, 1_000_000_000, i64::MAX];

/// A scenario.
pub struct Case {
    /// From which it was drawn.
    pub number: u64,
    /// The scenario itself.
    pub scenario: Table,
    /// Which option was taken where there was a choice.
    pub options: BTreeMap<String, String>,
}

impl Case {
    /// The scenario as a file.
    pub fn text(&self) -> String {
        toml::to_string(&self.scenario).expect("a table of plain values")
    }

    /// Whether an option was taken, such as `contacts.ageing = logarithmic`.
    pub fn has(&self, option: &str) -> bool {
        option
            .split_once(" = ")
            .is_some_and(|(path, taken)| self.options.get(path).is_some_and(|of| of == taken))
    }

    /// Whether a key is there.
    pub fn given(&self, path: &str) -> bool {
        self.options.get(path).is_some_and(|taken| taken != "absent")
    }

    /// Takes a key out of a table, and says whether it was there.
    pub fn remove(&mut self, table: &str, key: &str) -> bool {
        let table = self.scenario.get_mut(table).and_then(Value::as_table_mut);
        table.is_some_and(|table| table.remove(key).is_some())
    }

    /// How often the contacts move at another velocity, or from another start: at each velocity and temperature of a curve,
    /// of each hold, and of each velocity and stiffness of a map.
    pub fn solutions(&self) -> usize {
        let key = |table: &str, key: &str| self.scenario.get(table).and_then(|table| table.get(key));
        let listed = |table: &str, name: &str| {
            key(table, name).and_then(Value::as_array).map(|list| list.len().max(1))
        };
        let points = |table: &str| {
            let points = key(table, "points").and_then(Value::as_integer).unwrap_or(41);
            self.scenario.get(table).map_or(1, |_| points.clamp(1, 41) as usize)
        };
        let velocities = listed("velocity_curve", "velocities").unwrap_or_else(|| points("velocity_curve"));
        let temperatures = listed("velocity_curve", "temperatures").unwrap_or(1);
        let map = ["velocities", "stiffnesses"].map(|name| listed("stability", name).unwrap_or(1));
        velocities * temperatures * points("hold_curve") * map[0] * map[1]
    }
}

/// The schema of scenarios.
pub struct Schema(Json);

impl Schema {
    /// That of the types of scenarios.
    pub fn of_types() -> Self {
        Self(asperity_runner::input::schema())
    }

    /// Adds a key that is true or false to a table.
    pub fn add_key(&mut self, table: &str, key: &str) {
        self.0["$defs"][table]["properties"][key] = serde_json::json!({ "type": "boolean" });
    }

    /// All options that a scenario of the schema can have, as [`Case::has`] takes them.
    pub fn options(&self) -> Vec<String> {
        let given = |table: &'static str, path: &'static str| {
            let keys = self.0.pointer(table).and_then(Json::as_object).expect("a table");
            keys.keys()
                .filter(|key| !NOT_DRAWN.contains(&key.as_str()))
                .map(move |key| format!("{path}{key} = given"))
        };
        let variants = |name: &str, path: &'static str| {
            let choices = self.0["$defs"][name]["oneOf"].as_array().expect("choices").iter();
            choices.map(variant_name).map(|name| format!("{path} = {name}")).collect::<Vec<_>>()
        };
        let tables = [
            ("/$defs/Interface/properties", "interface."),
            ("/$defs/Pull/properties", "pull."),
            ("/$defs/Drive/properties", "drive."),
        ];
        let optional = |option: &String| {
            // No choice is noted of keys that a table must have; of a choice of variants, or of true and false, it is the choice.
            let other = [
                "cells",
                "connection",
                "coupling",
                "turning_points",
                "force_to",
                "contacts",
                "derivatives",
                "edges",
                "loading",
                "slip",
                "start",
            ];
            !other.iter().any(|key| option.ends_with(&format!(".{key} = given")))
        };
        let mut options: Vec<_> =
            tables.into_iter().flat_map(|(table, path)| given(table, path)).filter(optional).collect();
        for (name, path) in [
            ("Law", "contacts.thresholds"),
            ("Law", "contacts.areas.law"),
            ("Law", "contacts.reforming"),
            ("Law", "initial"),
            ("Ageing", "contacts.ageing"),
            ("Barrier", "contacts.temperature.barrier"),
            ("Hazard", "contacts.temperature.hazard"),
            ("Slip", "block.slip"),
            ("CellSlip", "interface.slip"),
            ("PerCell", "interface.contacts"),
            ("Coupling", "interface.coupling"),
            ("Edges", "interface.edges"),
            ("Loading", "interface.loading"),
            ("Disorder", "ensemble.disorder"),
            ("TaskStart", "pull.start"),
            ("TaskStart", "drive.start"),
        ] {
            options.extend(variants(name, path));
        }
        options
    }

    /// The scenario of a number. Of an even number its tables go together as the rules of the documents want it; of an odd
    /// one they are drawn each for itself, and some numbers are none that a quantity can have.
    pub fn case(&self, number: u64) -> Case {
        let mut random = SplitMix::new(number);
        let units = units(&mut random);
        let consistent = number.is_multiple_of(2);
        let mut walk = Walk {
            root: &self.0,
            number,
            visits: BTreeMap::new(),
            random,
            units,
            consistent,
            options: BTreeMap::new(),
            lowest: 1.0,
        };
        for (name, unit) in [("length", units.length), ("force", units.force), ("time", units.time)] {
            walk.options.insert(format!("unit of {name}"), format!("{unit:e}"));
        }
        let mut scenario = walk.table(&self.0, "");
        if consistent {
            rules::in_units(&mut scenario, units);
        }
        Case { number, scenario, options: walk.options }
    }
}

/// Units: mostly those in which numbers are near 1.
fn units(random: &mut SplitMix) -> Units {
    let mut one = || *random.pick(&[1.0, 1.0, 1.0, 1e-6, 1e-30, 1e30]);
    Units { length: one(), force: one(), time: one() }
}

/// A walk through the schema.
pub(super) struct Walk<'a> {
    root: &'a Json,
    /// The number of the case.
    number: u64,
    /// How often a place has been reached: the items of a list are at one.
    visits: BTreeMap<String, u64>,
    /// The stream of the present place, so that a new key leaves the rest of a case as it is.
    random: SplitMix,
    units: Units,
    consistent: bool,
    /// Which option was taken where there was a choice.
    pub(super) options: BTreeMap<String, String>,
    /// The last value of a key `from`.
    lowest: f64,
}

impl<'a> Walk<'a> {
    /// The schema that a reference leads to, with its name.
    fn resolved(&self, schema: &'a Json) -> (&'a str, &'a Json) {
        if let Some(Json::Array(choices)) = schema.get("anyOf") {
            let something = choices.iter().find(|choice| choice["type"] != "null");
            return self.resolved(something.expect("something beside null"));
        }
        match schema["$ref"].as_str() {
            Some(reference) => {
                let path = reference.strip_prefix('#').expect("a reference within the schema");
                let name = reference.rsplit('/').next().unwrap_or_default();
                (name, self.root.pointer(path).expect("what is referred to"))
            }
            None => ("", schema),
        }
    }

    /// Goes on with the stream of a place.
    fn reach(&mut self, place: &str) {
        let visit = self.visits.entry(place.to_owned()).or_insert(0);
        *visit += 1;
        self.random = SplitMix::at(self.number, place, *visit);
    }

    fn value(&mut self, schema: &'a Json, path: &str, key: &str) -> Value {
        let (name, schema) = self.resolved(schema);
        let here = join(path, key);
        self.reach(&here);
        if name == "Law" {
            return self.distribution(schema, &here);
        }
        // One time; distributions of times are those of lengths.
        let schema = if name == "Delay" { &schema["anyOf"][0] } else { schema };
        if schema.get("properties").is_some() {
            return Value::Table(self.table(schema, &here));
        }
        if let Some(choices) = schema["oneOf"].as_array() {
            return self.variant(choices, &here);
        }
        match kind(schema) {
            "number" => Value::Float(self.number(schema, path, key)),
            "integer" => Value::Integer(self.count(key)),
            "boolean" => Value::Boolean(self.choose(&here, &["false", "true"]) == "true"),
            "string" => Value::String("µm".into()),
            "array" => self.list(schema, path, key),
            // A table with keys of its own, such as priors.
            "object" => Value::Table(Table::new()),
            other => panic!("{here}: no value is known of type {other}"),
        }
    }

    /// One of the variants of an enumeration.
    fn variant(&mut self, choices: &'a [Json], path: &str) -> Value {
        let names: Vec<_> = choices.iter().map(variant_name).collect();
        let allowed: Vec<_> = names.iter().copied().filter(|name| self.allows(path, name)).collect();
        let chosen = self.choose(path, &allowed);
        let choice = choices.iter().find(|choice| variant_name(choice) == chosen).expect("one of them");
        match choice["const"].as_str() {
            Some(word) => Value::String(word.to_owned()),
            None => {
                let content = &choice["properties"][chosen];
                Value::Table(Table::from_iter([(chosen.to_owned(), self.value(content, path, chosen))]))
            }
        }
    }

    /// A table: of alternatives that exclude each other one, of other keys those that are drawn.
    fn table(&mut self, schema: &'a Json, path: &str) -> Table {
        let properties = schema["properties"].as_object().expect("a table has keys");
        let (needed, excluded) = self.alternative(schema, path);
        let mut keys: Vec<_> = properties.keys().map(String::as_str).collect();
        // These decide what else can be.
        let first = ["contacts", "block", "interface", "ensemble", "velocity_to"];
        keys.sort_by_key(|key| first.iter().position(|one| one == key).unwrap_or(first.len()));
        let mut table = Table::new();
        for key in keys {
            let here = join(path, key);
            if NOT_DRAWN.contains(&key) || excluded.contains(&key) {
                continue;
            }
            if !(needed.contains(&key) || required(schema).contains(&key)) {
                self.reach(&format!("{here} given"));
                let given = match self.consistent.then(|| rules::given(self, path, key)).flatten() {
                    Some(given) => given,
                    None => self.random.chance(if self.consistent { 0.3 } else { 0.4 }),
                };
                self.options.insert(here, if given { "given" } else { "absent" }.into());
                if !given {
                    continue;
                }
            }
            table.insert(key.to_owned(), self.value(&properties[key], path, key));
        }
        table
    }

    /// Keys that one of the alternatives needs, and those that it excludes.
    fn alternative(&mut self, schema: &'a Json, path: &str) -> (Vec<&'a str>, Vec<&'a str>) {
        let Some(alternatives) = schema["oneOf"].as_array() else { return (Vec::new(), Vec::new()) };
        let names: Vec<_> = alternatives.iter().map(|one| required(one).join("+")).collect();
        let here = format!("{path}:alternative");
        let allowed: Vec<_> = names
            .iter()
            .map(String::as_str)
            .filter(|name| !NOT_DRAWN.contains(name) && self.allows(&here, name))
            .collect();
        let chosen = self.choose(&here, &allowed).to_owned();
        let chosen = &alternatives[names.iter().position(|name| *name == chosen).expect("one of them")];
        let needed = required(chosen);
        let others = alternatives.iter().flat_map(required);
        let excluded =
            forbidden(&chosen["not"]).into_iter().chain(others).filter(|key| !needed.contains(key)).collect();
        (needed, excluded)
    }

    fn allows(&self, path: &str, option: &str) -> bool {
        !self.consistent || rules::allows(self, path, option)
    }

    /// One of the options, which is noted: that of the largest number drawn for it, so that a new option changes few cases
    /// (rendezvous hashing; D. G. Thaler and C. V. Ravishankar, IEEE/ACM Trans. Netw. 6, 1 (1998)).
    fn choose<'b>(&mut self, path: &str, options: &[&'b str]) -> &'b str {
        let visit = self.visits.get(path).copied().unwrap_or(0);
        let drawn = |option: &&&str| SplitMix::at(self.number, &format!("{path} = {option}"), visit).next();
        let chosen = *options.iter().max_by_key(drawn).expect("options");
        self.options.insert(path.to_owned(), chosen.to_owned());
        chosen
    }

    /// A distribution: its family, and how broad it is.
    fn distribution(&mut self, schema: &'a Json, path: &str) -> Value {
        let families: Vec<_> =
            schema["oneOf"].as_array().expect("families").iter().map(variant_name).collect();
        let allowed: Vec<_> = families.into_iter().filter(|family| self.allows(path, family)).collect();
        let family = self.choose(path, &allowed);
        let variation = *self.random.pick(&VARIATIONS);
        self.options.insert(format!("{path}:variation"), format!("{variation:e}"));
        let unit = if path == "contacts.areas.law" { self.units.length.powi(2) } else { self.units.length };
        let mean = unit * rules::mean(self.consistent, path, &mut self.random);
        let parameters = distributions::parameters(family, mean, variation, &mut self.random);
        Value::Table(Table::from_iter([(family.to_owned(), parameters)]))
    }

    /// A number: mostly an ordinary one, at times one that is far off; where tables need not go together an odd one, too.
    fn number(&mut self, schema: &Json, path: &str, key: &str) -> f64 {
        let quantity = quantities::of(schema, path, key);
        let unit = quantity.unit(self.units);
        let level = self.random.uniform();
        let [low, high] = quantity.ordinary;
        let value = if level < 0.85 {
            self.random.decades(low, high) * unit
        } else if self.consistent || level < 0.95 {
            self.random.decades(-12.0, 12.0) * unit
        } else {
            *self.random.pick(&ODD)
        };
        match key {
            "from" => self.lowest = value,
            "to" if self.consistent => return self.lowest * self.random.decades(0.5, 3.0),
            _ => {}
        }
        value
    }

    /// A whole number: small, so that a case costs little.
    fn count(&mut self, key: &str) -> i64 {
        let most = match key {
            "points" => 30,
            "size" => 2000,
            "seed" => 1000,
            "pieces" | "runs" | "average" | "simulations" => 6,
            "cells" | "distance" => 8,
            "slip_rates" => 40,
            "kernels" => 40,
            "draws" | "chains" => 6,
            "states" => 3,
            _ => panic!("{key}: how large this number is is not listed"),
        };
        if !self.consistent && self.random.chance(0.06) {
            return *self.random.pick(&ODD_COUNTS);
        }
        // An error of fewer contacts is hardly known itself.
        let least = match key {
            "size" => 500,
            "states" => 1,
            _ => 2,
        };
        least + (self.random.next() % (most - 1)) as i64
    }

    fn list(&mut self, schema: &'a Json, path: &str, key: &str) -> Value {
        let items = &schema["items"];
        if kind(self.resolved(items).1) == "number" {
            let mut values: Vec<_> = (0..3).map(|_| self.number(schema, path, key)).collect();
            rules::order(self.consistent, key, &mut values);
            return Value::Array(values.into_iter().map(Value::Float).collect());
        }
        let length = 1 + self.random.next() % if key == "protocol" { 3 } else { 2 };
        Value::Array((0..length).map(|_| self.value(items, path, key)).collect())
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// Its type, if it is not null.
fn kind(schema: &Json) -> &str {
    match &schema["type"] {
        Json::Array(kinds) => {
            kinds.iter().filter_map(Json::as_str).find(|kind| *kind != "null").unwrap_or("")
        }
        kind => kind.as_str().unwrap_or(""),
    }
}

fn variant_name(schema: &Json) -> &str {
    schema["const"].as_str().or_else(|| required(schema).first().copied()).expect("a variant has a name")
}

fn required(schema: &Json) -> Vec<&str> {
    schema["required"].as_array().map_or_else(Vec::new, |keys| keys.iter().filter_map(Json::as_str).collect())
}

/// Keys that must not be there.
fn forbidden(not: &Json) -> Vec<&str> {
    match not["anyOf"].as_array() {
        Some(several) => several.iter().flat_map(required).collect(),
        None => required(not),
    }
}
