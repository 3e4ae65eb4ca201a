//! Answers requests natively, a line of JSON each, from standard input to standard output: what the test of the page compares
//! WebAssembly with.

#![allow(clippy::print_stdout)]

use std::io::BufRead as _;

use asperity_engine::Engine;

fn main() -> std::io::Result<()> {
    let mut engine = Engine::default();
    for request in std::io::stdin().lock().lines() {
        println!("{}", String::from_utf8_lossy(&engine.answer_json(request?.as_bytes(), &mut ())));
    }
    Ok(())
}
