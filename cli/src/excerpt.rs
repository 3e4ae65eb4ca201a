//! A text with long lines shortened around its marks. Tables in scenarios may be megabytes on one line.

use std::ops::Range;

use asperity_runner::input::{Mark, Source};
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Letters that are shown before a mark.
const BEFORE: usize = 60;
/// Letters that are shown from the beginning of a mark.
const BEHIND: usize = 90;
/// Placeholder of omitted text.
const GAP: &str = "…";

/// The text, its marks, and the shift of the first mark within its line.
#[derive(Debug)]
pub struct Excerpt {
    name: String,
    text: String,
    /// A mark and its label.
    pub marks: Vec<Mark>,
    moved: usize,
}

impl Excerpt {
    /// The visible part of a source.
    pub fn of(source: &Source) -> Self {
        let mut excerpt =
            Self { name: source.name.clone(), text: String::new(), marks: Vec::new(), moved: 0 };
        let mut start = 0;
        for line in source.text.split_inclusive('\n') {
            let end = start + line.len();
            let last = end == source.text.len();
            let within =
                |mark: &&Mark| (start..end).contains(&mark.span.start) || (last && mark.span.start >= end);
            excerpt.add(line, start, source.marks.iter().filter(within));
            start = end;
        }
        if source.text.is_empty() {
            excerpt.marks = source.marks.clone();
        }
        excerpt
    }

    /// Adds a line that begins at `start`, with the marks that begin in it.
    fn add<'a>(&mut self, line: &str, start: usize, marks: impl Iterator<Item = &'a Mark> + Clone) {
        let (content, ending) = line.strip_suffix('\n').map_or((line, ""), |content| (content, "\n"));
        let first = marks.clone().map(|mark| mark.span.start - start).next().unwrap_or(0);
        let shown = window(content, first.min(content.len()));
        let begin = self.text.len();
        let before = if shown.start > 0 { GAP } else { "" };
        let behind = if shown.end < content.len() { GAP } else { "" };
        self.text += &format!("{before}{}{behind}{ending}", &content[shown.clone()]);
        for mark in marks {
            let place = |at: usize| {
                let within = at.saturating_sub(start).clamp(shown.start, shown.end);
                begin + before.len() + within - shown.start
            };
            if self.marks.is_empty() {
                self.moved = shown.start.saturating_sub(before.len());
            }
            let span = place(mark.span.start)..place(mark.span.end);
            self.marks.push(Mark { span, label: mark.label.clone() });
        }
    }
}

/// The part of a line that is shown around a position.
fn window(line: &str, at: usize) -> Range<usize> {
    let ends = |from: &str, letters: usize| from.char_indices().nth(letters).map_or(from.len(), |end| end.0);
    let back: usize = line[..at].chars().rev().take(BEFORE).map(char::len_utf8).sum();
    let begin = at - back;
    // An omitted part that is not longer than its placeholder is shown.
    let begin = if begin <= GAP.len() { 0 } else { begin };
    begin..at + ends(&line[at..], BEHIND)
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let found = self.text.read_span(span, before, after)?;
        // Without context lines, the request is for the position of a mark only.
        let moved = if before == 0 { self.moved } else { 0 };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            found.data(),
            *found.span(),
            found.line(),
            found.column() + moved,
            found.line_count(),
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn excerpt(text: &str, span: Range<usize>) -> Excerpt {
        let marks = vec![Mark { span, label: "here".into() }];
        Excerpt::of(&Source { name: "a.toml".into(), text: text.into(), marks })
    }

    #[test]
    fn short_lines_are_shown_as_they_are() {
        let text = "a = 1\nbb = 2\nc = µ";
        for span in [0..1, 6..8, 13..19, 19..19] {
            let shown = excerpt(text, span.clone());
            assert_eq!((shown.text.as_str(), &shown.marks[0].span, shown.moved), (text, &span, 0));
        }
        assert_eq!(excerpt("", 0..0).marks.len(), 1);
    }

    #[test]
    fn long_lines_are_shown_around_the_mark_and_the_column_stays() {
        let samples = "0.125, ".repeat(10_000);
        let text = format!("title = 'a'\nx = [{samples}wrong, {samples}]\ny = 1\n");
        let at = text.find("wrong").unwrap();
        let shown = excerpt(&text, at..at + 5);
        assert!(shown.text.len() < 300, "{}", shown.text);
        assert_eq!(&shown.text[shown.marks[0].span.clone()], "wrong");
        let span = SourceSpan::from(shown.marks[0].span.clone());
        let contents = shown.read_span(&span, 0, 0).unwrap();
        assert_eq!((contents.line(), contents.column()), (1, at - "title = 'a'\n".len()));
    }

    #[test]
    fn a_mark_over_many_lines_ends_with_its_first() {
        let text = format!("x = [\n{}]\n", "0.125,\n".repeat(10_000));
        let shown = excerpt(&text, 4..text.len() - 1);
        assert_eq!(shown.marks[0].span, 4..5);
    }
}
