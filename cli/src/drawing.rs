//! Display of wrong input, with line and key marked.

use std::fmt;

use asperity_runner::input::Diagnostic;
use miette::{LabeledSpan, MietteHandlerOpts, ReportHandler, SourceCode};

use super::excerpt::Excerpt;

/// A diagnostic in the form for miette.
#[derive(Debug)]
struct Drawn {
    diagnostic: Diagnostic,
    source: Option<Excerpt>,
}

impl fmt::Display for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.fmt(f)
    }
}

impl std::error::Error for Drawn {}

impl miette::Diagnostic for Drawn {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.diagnostic.help.as_ref().map(|help| Box::new(help) as _)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|source| source as _)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let marks = &self.source.as_ref()?.marks;
        Some(Box::new(
            marks
                .iter()
                .map(|mark| LabeledSpan::new(Some(mark.label.clone()), mark.span.start, mark.span.len())),
        ))
    }
}

/// The diagnostic as text; coloured only if the standard error supports it and `NO_COLOR` is not set.
pub fn draw(diagnostic: Diagnostic) -> String {
    struct Report(Drawn);
    impl fmt::Display for Report {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            MietteHandlerOpts::new().wrap_lines(false).build().debug(&self.0, f)
        }
    }
    let source = diagnostic.source.as_ref().map(Excerpt::of);
    Report(Drawn { diagnostic, source }).to_string()
}
