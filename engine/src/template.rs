//! Changes that a page fills in, in JSON: `$x` and `$y` stand for what is chosen, numbers as in TOML.

/// A value of the scenario.
pub fn value(key: &str) -> String {
    format!("{{\"key\":\"{key}\",\"value\":\"$x\"}}")
}

/// The rule of slip.
pub fn slip(key: &str) -> String {
    format!("{{\"key\":\"{key}\",\"slip\":\"$x\"}}")
}

/// A change of a distribution, with its argument in JSON.
pub fn law(key: &str, change: &str, argument: &str) -> String {
    format!("{{\"key\":\"{key}\",\"law\":{{\"{change}\":{argument}}}}}")
}

/// The width of the thresholds, and the stiffness of the spring.
pub fn width_and_stiffness() -> String {
    format!(
        "[{},{}]",
        law("contacts.thresholds", "width", "$x"),
        value("block.stiffness").replace("$x", "$y")
    )
}
