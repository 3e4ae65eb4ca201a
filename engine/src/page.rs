//! The page of the explorer, put together for a program that answers its requests itself.

use serde_json::json;

/// A file of the folder `explorer`.
macro_rules! shipped {
    ($name:literal) => {
        include_str!(concat!(env!("ASPERITY_SHIPPED"), "/explorer/", $name))
    };
}

/// The program that answers the requests of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Server {
    /// The command, by HTTP.
    Command,
    /// A notebook in whose frame the page is, by messages.
    Notebook,
}

/// The scripts, in the order in which they run.
const SCRIPTS: [&str; 5] = [
    shipped!("engine.js"),
    shipped!("csv.js"),
    shipped!("controls.js"),
    shipped!("panels.js"),
    shipped!("app.js"),
];
const STYLE: &str = shipped!("explorer.css");
const TEMPLATE: &str = shipped!("index.html");

/// What a browser may load and run in a page whose scripts and styles have this `nonce`.
pub fn policy(server: Server, nonce: &str) -> String {
    let requests = if server == Server::Command { "connect-src 'self'; " } else { "" };
    format!(
        "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; {requests}img-src blob: data:; \
         base-uri 'none'; form-action 'none'"
    )
}

/// The page that opens with `scenario`, or with its own first one. `nonce` is random and of letters and digits.
pub fn page(server: Server, nonce: &str, scenario: Option<&str>) -> String {
    let engine = if server == Server::Command { "command" } else { "notebook" };
    // A text cannot end the element that it stands in.
    let settings = json!({ "engine": engine, "scenario": scenario }).to_string().replace('<', "\\u003c");
    let styles = format!("<style nonce=\"{nonce}\">{STYLE}</style>");
    let scripts = SCRIPTS.map(|script| format!("<script nonce=\"{nonce}\">{script}</script>")).join("\n");
    // The settings come last, since a scenario may hold any text.
    TEMPLATE
        .replace("{{policy}}", &policy(server, nonce))
        .replace("{{styles}}", &styles)
        .replace("{{scripts}}", &scripts)
        .replace("{{data}}", "")
        .replace("{{settings}}", &settings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_stays_within_its_element() {
        let text = "# </script><script>alert(1)</script> {{scripts}}";
        let page = page(Server::Command, "abc", Some(text));
        assert!(!page.contains("alert(1)</script>") && page.contains(r"# \u003c/script>"));
        assert_eq!(page.matches("<script nonce=\"abc\">").count(), SCRIPTS.len());
        assert!(!page.contains("{{policy}}") && !page.contains("{{data}}"));
    }
}
