//! A velocity step and a hold, of contacts that age: the slider is moved through a history of velocities.
//!
//! `cargo run --release -p asperity --example protocol`; the same in Python is `python/examples/protocol.py`.

use std::sync::Arc;

use asperity::contacts::{Ageing, Contacts, Initial};
use asperity::history::{History, Piece};
use asperity::law::{Gaussian, Point};
use asperity::master::Transport;

fn main() -> asperity::Result<()> {
    let mut contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
    contacts.rules.ageing = Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 });

    // Slow until sliding is steady, ten times as fast, a hold, and fast again.
    let motion = History::new(vec![
        Piece { velocity: 0.1, duration: 100.0 },
        Piece { velocity: 1.0, duration: 10.0 },
        Piece { velocity: 0.0, duration: 1000.0 },
        Piece { velocity: 1.0, duration: 10.0 },
    ])?;
    let times = [100.0, 100.5, 110.0, 1110.0, 1110.5, 1111.0, 1120.0];
    let trace = Transport::new(contacts, &Initial::default())?.follow(&motion, &times)?;
    for (time, force) in trace.time.iter().zip(&trace.force) {
        println!("t = {time:6.1}: F = {force:.4}");
    }
    Ok(())
}
