//! A serde deserialiser for the tree of a document, which keeps track of keys and of expected values.

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, IntoDeserializer, MapAccess, SeqAccess, VariantAccess,
    Visitor, value::StrDeserializer,
};
use serde::forward_to_deserialize_any;

use super::document::{Kind, Node};
use super::fault::{Fault, one_of};

/// Largest float up to which every whole number is one: 2⁵³.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// Reads a value out of a node.
pub struct Reader<'a>(pub &'a Node);

impl Reader<'_> {
    fn refuse<T>(&self, expected: &str) -> Result<T, Fault> {
        Err(Fault::new(expected, &self.0.kind.describe()))
    }
}

/// Each method calls those methods of the visitor only that take the kind of value it expects: of each type no others are compiled.
impl<'de> Deserializer<'de> for Reader<'_> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.0.kind {
            Kind::Text(text) | Kind::Date(text) => visitor.visit_str(text),
            Kind::Integer(number) => visitor.visit_i64(*number),
            Kind::Float(number) => visitor.visit_f64(*number),
            Kind::Boolean(truth) => visitor.visit_bool(*truth),
            Kind::List(items) => visitor.visit_seq(Items(items.iter().enumerate())),
            Kind::Table(entries) => visitor.visit_map(Entries { rest: entries.iter(), current: None }),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.0.kind {
            Kind::Integer(number) => visitor.visit_i64(number),
            Kind::Float(number) => visitor.visit_f64(number),
            _ => self.refuse("a number"),
        }
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.0.kind {
            Kind::Integer(number @ 0..) => visitor.visit_i64(number),
            // 1e5 is a float in TOML.
            Kind::Float(number) if (0.0..=LARGEST_WHOLE).contains(&number) && number.fract() == 0.0 => {
                visitor.visit_u64(number as u64)
            }
            Kind::Float(number) if number > LARGEST_WHOLE => {
                self.refuse("a whole number in digits, below 2^63")
            }
            _ => self.refuse("a whole number, 0 or above"),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.0.kind {
            Kind::Text(text) => visitor.visit_str(text),
            _ => self.refuse("text in quotes"),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match &self.0.kind {
            Kind::List(items) => visitor.visit_seq(Items(items.iter().enumerate())),
            _ => self.refuse("a list in [ ]"),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match &self.0.kind {
            Kind::Table(entries) => visitor.visit_map(Entries { rest: entries.iter(), current: None }),
            _ => self.refuse(&format!("a table with {}", fields.join(", "))),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match &self.0.kind {
            Kind::Text(name) => visitor.visit_enum(Choice { name, content: None }),
            Kind::Table(entries) => match &entries[..] {
                [(name, content)] => visitor.visit_enum(Choice { name, content: Some(content) }),
                [] => self.refuse(&one_of(variants)),
                _ => Err(several(entries, variants)),
            },
            _ => self.refuse(&one_of(variants)),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u128 f32 char str bytes byte_buf unit unit_struct newtype_struct
        tuple tuple_struct map identifier ignored_any
    }
}

/// The fault for several entries of which one must be chosen: a wrong name among them, or several right ones.
fn several(entries: &[(String, Node)], variants: &[&'static str]) -> Fault {
    if let Some((name, _)) = entries.iter().find(|(name, _)| !variants.contains(&name.as_str())) {
        return Fault::wrong_name(name, variants).under(name);
    }
    let names: Vec<_> = entries.iter().map(|(name, _)| name.clone()).collect();
    Fault { among: names.clone(), ..Fault::new("only one of them", &names.join(" and ")) }
}

struct Items<'a>(std::iter::Enumerate<std::slice::Iter<'a, Node>>);

impl<'de> SeqAccess<'de> for Items<'_> {
    type Error = Fault;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Fault> {
        let Some((i, item)) = self.0.next() else { return Ok(None) };
        seed.deserialize(Reader(item)).map(Some).map_err(|fault| fault.under(&i.to_string()))
    }
}

struct Entries<'a> {
    rest: std::slice::Iter<'a, (String, Node)>,
    current: Option<&'a (String, Node)>,
}

impl<'de> MapAccess<'de> for Entries<'_> {
    type Error = Fault;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Fault> {
        self.current = self.rest.next();
        let Some((key, _)) = self.current else { return Ok(None) };
        let name: StrDeserializer<'_, Fault> = key.as_str().into_deserializer();
        seed.deserialize(name).map(Some).map_err(|fault| fault.under(key))
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Fault> {
        let (key, node) = self.current.expect("a value follows its key");
        seed.deserialize(Reader(node)).map_err(|fault| fault.under(key))
    }
}

struct Choice<'a> {
    name: &'a str,
    content: Option<&'a Node>,
}

impl<'a, 'de> EnumAccess<'de> for Choice<'a> {
    type Error = Fault;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Fault> {
        let name: StrDeserializer<'_, Fault> = self.name.into_deserializer();
        match seed.deserialize(name) {
            Ok(variant) => Ok((variant, self)),
            Err(fault) if self.content.is_some() => Err(fault.under(self.name)),
            Err(fault) => Err(Fault { on_key: false, ..fault }),
        }
    }
}

impl Choice<'_> {
    /// Reads the value under the chosen name; `shape` is its expected form.
    fn read<T>(self, shape: &str, read: impl FnOnce(Reader<'_>) -> Result<T, Fault>) -> Result<T, Fault> {
        let Some(content) = self.content else {
            return Err(Fault::new(
                &format!("{} = {shape}", self.name),
                &format!("only the name \"{}\"", self.name),
            ));
        };
        read(Reader(content)).map_err(|fault| fault.under(self.name))
    }
}

impl<'de> VariantAccess<'de> for Choice<'_> {
    type Error = Fault;

    fn unit_variant(self) -> Result<(), Fault> {
        match self.content {
            None => Ok(()),
            Some(_) => Err(Fault::new(&format!("only the name \"{}\"", self.name), "a table")),
        }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Fault> {
        self.read("…", |content| seed.deserialize(content))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _length: usize, visitor: V) -> Result<V::Value, Fault> {
        self.read("[…]", |content| content.deserialize_seq(visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let shape = format!("{{ {} }}", fields.join(", "));
        self.read(&shape, |content| content.deserialize_struct("", fields, visitor))
    }
}
