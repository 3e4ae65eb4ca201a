//! The numbers of contacts and slider, and the rule of slip.

use asperity::block::Slip;
use asperity::contacts::AgeingRule;
use asperity::scenario::{Elasticity, Scenario};

use super::Row;
use super::item::{Item, number_row};
use crate::{slip_rule, template};

const GROUP: &str = "slider";

/// A number that has a slider where the scenario has it: its key, its label, and its value.
type Number = (&'static str, &'static str, Option<f64>);

fn numbers(scenario: &Scenario) -> [Number; 13] {
    let (contacts, drive) = (&scenario.contacts, scenario.drive.as_ref());
    let (block, interface) = (scenario.block.as_ref(), scenario.interface.as_ref());
    let (damped, inertial) = match block.map(|block| block.slip) {
        Some(Slip::Damped { damping }) => (Some(damping), None),
        Some(Slip::Inertial { mass, damping }) => (None, Some((mass, damping))),
        _ => (None, None),
    };
    let ageing = match contacts.ageing {
        Some(AgeingRule::Logarithmic { growth, .. }) => Some(growth),
        _ => None,
    };
    let coupling = interface.and_then(|interface| match interface.coupling {
        Elasticity::Neighbours { stiffness, .. } => Some(stiffness),
        _ => None,
    });
    let disorder = interface.and_then(|interface| interface.disorder.as_ref()?.std);
    [
        ("block.stiffness", "<i>K</i>", block.map(|block| block.stiffness)),
        ("contacts.count", "<i>N</i><sub>c</sub>", Some(contacts.count)),
        ("contacts.stiffness", "⟨<i>k</i>⟩", contacts.stiffness),
        ("drive.distance", "distance", drive.and_then(|drive| drive.distance)),
        ("drive.velocity", "velocity", drive.and_then(|drive| drive.velocity)),
        ("block.slip.damped.damping", "<i>γ</i>", damped),
        ("block.slip.inertial.mass", "<i>M</i>", inertial.map(|(mass, _)| mass)),
        ("block.slip.inertial.damping", "<i>γ</i>", inertial.map(|(_, damping)| damping)),
        ("contacts.temperature.energy", "<i>T</i>", contacts.temperature.as_ref().map(|heat| heat.energy)),
        ("contacts.ageing.logarithmic.growth", "ageing", ageing),
        ("interface.connection", "<i>K</i><sub>0</sub>", interface.map(|interface| interface.connection)),
        ("interface.coupling.neighbours.stiffness", "<i>K</i><sub>int</sub>", coupling),
        ("interface.disorder.std", "disorder", disorder),
    ]
}

pub fn add(rows: &mut Vec<Row>, scenario: &Scenario) {
    let known = numbers(scenario).into_iter().filter_map(|(key, label, value)| Some((key, label, value?)));
    rows.extend(known.map(|(key, label, value)| number_row(GROUP, key, label, value, None)));
    if let Some(block) = &scenario.block {
        let (id, name) = ("block.slip", slip_rule::name(block.slip));
        let select = Item::select(String::new(), name, slip_rule::NAMES.to_vec(), template::slip(id));
        let items = vec![Item { id: id.to_owned(), ..select }];
        rows.push(Row {
            group: GROUP,
            id: id.to_owned(),
            class: "row wide",
            label: "slip rule".to_owned(),
            items,
        });
    }
}
