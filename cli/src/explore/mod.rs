//! `asperity explore`: serves the page of the explorer to browsers on this machine, and answers its requests.

mod refusal;
mod server;
mod sessions;

use std::net::Ipv4Addr;
use std::path::Path;
use std::time::Duration;

use asperity_runner::input;
use serde_json::json;
use tokio::net::TcpListener;

use super::arguments::Explore;
use super::interrupt::Interrupts;
use super::{Failure, print, run, threads};
use server::{LARGEST, Server};

/// Bytes of a request beside the text of its scenario.
const REST: usize = 10_000;

/// Time between two checks for Ctrl-C.
const CHECK: Duration = Duration::from_millis(20);

/// Serves the page until a signal.
pub fn explore(arguments: &Explore) -> Result<(), Failure> {
    let interrupts = Interrupts::listen().map_err(Failure::run)?;
    let scenario = arguments.scenario.as_deref().map(complete_text).transpose()?;
    // The server leaves its work, and ends by itself.
    interrupts.take_over();
    threads::on(None, || serve(arguments, scenario, &interrupts))?
}

fn serve(arguments: &Explore, scenario: Option<String>, interrupts: &Interrupts) -> Result<(), Failure> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(Failure::run)?;
    let ended = runtime.block_on(async {
        let listener = listener(arguments.port).await?;
        let address = listener.local_addr().map_err(Failure::run)?;
        let server = Server::new(address.port(), scenario, arguments.max_time).map_err(Failure::run)?;
        let (url, opened) = (server.url(), server.url_once());
        print(&format!("the explorer is at {url}\nCtrl-C ends it\n"))?;
        tokio::spawn(server.serve(listener));
        if !arguments.no_open && open::that_detached(&opened).is_err() {
            run::say("no browser was found; open this address in one");
        }
        while interrupts.reason().is_none() {
            tokio::time::sleep(CHECK).await;
        }
        Err(Failure::Ended)
    });
    // What is at work ends with the process.
    runtime.shutdown_background();
    ended
}

/// A socket that only this machine reaches.
async fn listener(port: u16) -> Result<TcpListener, Failure> {
    let socket = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).await;
    socket.map_err(|why| Failure::run(format_args!("--port {port}: {why}")))
}

/// The text of a scenario, with the tables of the files that it names.
fn complete_text(path: &Path) -> Result<String, Failure> {
    // Reading says what is wrong with the file.
    input::read(path, &[])?;
    let text = std::fs::read_to_string(path).map_err(Failure::run)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let text = input::complete(&text, &path.display().to_string(), folder)?;
    check_size(path, &text)?;
    Ok(text)
}

/// The page sends the text as JSON, in which quotation marks and ends of lines take two bytes.
fn check_size(path: &Path, text: &str) -> Result<(), Failure> {
    let (size, most) = (json!(text).to_string().len(), LARGEST - REST);
    if size <= most {
        return Ok(());
    }
    let words = format!("the explorer takes up to {most} bytes of JSON with all tables, got {size}");
    Err(Failure::Input(format!("error: {}: {words}\n", path.display())))
}
