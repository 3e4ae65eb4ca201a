//! The engine of the explorer in a notebook, and its page.

use std::sync::{Mutex, PoisonError};

use asperity_engine::page::{Server, page};
use asperity_runner::input;
use pyo3::prelude::*;

use crate::error;
use crate::result::Text;
use crate::watch::watched;

/// Answers requests of the page, texts of JSON both. It keeps what the last one has solved.
#[pyclass(frozen, name = "_Engine", module = "asperity._core")]
pub struct Engine(Mutex<asperity_engine::Engine>);

#[pymethods]
impl Engine {
    #[new]
    fn new() -> Self {
        Self(Mutex::default())
    }

    /// The answer to a request; `progress` hears of the fraction that is done.
    #[pyo3(signature = (request, progress: "_Progress" = None))]
    fn answer(
        &self,
        py: Python<'_>,
        request: String,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let answer = watched(progress, py, |monitor| {
            let mut engine = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            Ok(engine.answer_json(request.as_bytes(), monitor))
        });
        Ok(String::from_utf8_lossy(&answer?).into_owned())
    }
}

/// The text of a scenario, with the tables of the files that it names.
#[pyfunction(name = "_complete_text")]
#[pyo3(signature = (scenario: "str | PathLike[str] | Mapping[str, Any]"))]
pub fn complete_text(scenario: &Bound<'_, PyAny>) -> PyResult<String> {
    let Text { text, name, folder } = Text::of(scenario)?;
    input::complete(&text, &name, &folder).map_err(|e| error::scenario(&e))
}

/// The page, whose scripts have this nonce; its notebook puts the scenario into it.
#[pyfunction(name = "_explorer_page")]
pub fn explorer_page(nonce: &str) -> String {
    page(Server::Notebook, nonce, None)
}
