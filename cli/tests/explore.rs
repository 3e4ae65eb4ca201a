//! The server of the explorer: what it answers, what it refuses, and how it ends.
#![cfg(all(feature = "explore", unix))]

mod support;

use std::collections::VecDeque;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use asperity_engine::Engine;
use support::{Folder, errors, scenarios};

/// Nothing here takes as long on any machine.
const LONGEST: Duration = Duration::from_secs(300);

const QUICK: &str = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\npull.distance = 2.0\n";

/// Hours of events.
const LONG: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.count = 1024
initial.rectangular = { min = 0.0, max = 0.5 }
interface = { cells = [32, 32], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2, catalogue_from = 1e4 }
drive = { distance = 1e6, points = 11 }
";

/// A server that runs, and its address.
struct Explorer {
    child: Child,
    host: String,
    token: String,
    _output: BufReader<ChildStdout>,
}

impl Explorer {
    fn start(folder: &Folder, arguments: &[&str]) -> Self {
        Self::of(&mut folder.asperity(&[&["explore", "--no-open"], arguments].concat()))
    }

    fn of(command: &mut Command) -> Self {
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        output.read_line(&mut line).unwrap();
        let url = line.trim().strip_prefix("the explorer is at http://").expect(&line);
        let (host, token) = url.split_once('/').unwrap();
        let (host, token) = (host.to_owned(), token.trim_end_matches('/').to_owned());
        assert!(token.len() == 32, "{token}");
        Self { child, host, token, _output: output }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(LONGEST)).unwrap();
        stream
    }

    /// The headers of a request for a computation.
    fn headers(&self, session: &str) -> Vec<(&'static str, String)> {
        vec![
            ("host", self.host.clone()),
            ("origin", format!("http://{}", self.host)),
            ("asperity-token", self.token.clone()),
            ("asperity-session", session.into()),
            ("asperity-number", "1".into()),
            ("content-type", "application/octet-stream".into()),
        ]
    }

    /// Sends a request for a computation, and does not wait for its answer.
    fn ask(&self, session: &str, body: &str) -> TcpStream {
        self.ask_as(1, session, body)
    }

    /// The same, with the number of the request.
    fn ask_as(&self, number: u64, session: &str, body: &str) -> TcpStream {
        let mut headers = self.headers(session);
        headers.retain(|(name, _)| *name != "asperity-number");
        headers.push(("asperity-number", number.to_string()));
        let mut stream = self.connect();
        stream.write_all(&post(&headers, body)).unwrap();
        stream
    }

    fn answer(&self, session: &str, body: &str) -> Reply {
        Reply::read(&mut self.ask(session, body))
    }

    fn send(&self, request: &[u8]) -> Reply {
        let mut stream = self.connect();
        stream.write_all(request).unwrap();
        Reply::read(&mut stream)
    }

    fn get(&self, path: &str, headers: &str) -> Reply {
        self.send(format!("GET {path} HTTP/1.1\r\n{headers}\r\n").as_bytes())
    }

    fn signal(&self, signal: &str) {
        Command::new("kill").args([signal, &self.child.id().to_string()]).status().unwrap();
    }
}

impl Drop for Explorer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn post(headers: &[(&str, String)], body: &str) -> Vec<u8> {
    let headers: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
    format!("POST /compute HTTP/1.1\r\n{headers}content-length: {}\r\n\r\n{body}", body.len()).into_bytes()
}

fn body(text: &str, parts: &[&str]) -> String {
    serde_json::json!({ "text": text, "parts": parts, "position": 0.5 }).to_string()
}

struct Reply {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Reply {
    fn read(stream: &mut TcpStream) -> Self {
        let mut reader = BufReader::new(stream);
        let mut head = String::new();
        while !head.ends_with("\r\n\r\n") {
            assert!(reader.read_line(&mut head).unwrap() > 0, "the connection was closed after {head:?}");
        }
        let status = head[9..12].parse().unwrap();
        let length = head.lines().find_map(|line| line.strip_prefix("content-length: ")).unwrap();
        let mut body = vec![0; length.parse().unwrap()];
        reader.read_exact(&mut body).unwrap();
        Self { status, head, body }
    }

    fn text(&self) -> &str {
        std::str::from_utf8(&self.body).unwrap()
    }

    fn json(&self) -> serde_json::Value {
        assert_eq!(self.status, 200, "{}", self.text());
        serde_json::from_slice(&self.body).unwrap()
    }
}

#[test]
fn the_page_has_the_scenario_and_a_strict_policy() {
    let folder = Folder::new();
    folder.write("mine.toml", &format!("# </script> is text.\n{QUICK}"));
    let explorer = Explorer::start(&folder, &["mine.toml"]);
    let reply = explorer.get(&format!("/{}/", explorer.token), &format!("host: {}\r\n", explorer.host));
    assert_eq!(reply.status, 200);
    assert!(reply.text().contains(r##""scenario":"# \u003c/script> is text.\ncontacts.thresholds"##));
    let policy = reply.head.lines().find_map(|line| line.strip_prefix("content-security-policy: ")).unwrap();
    assert!(
        policy.starts_with("default-src 'none'; script-src 'nonce-") && !policy.contains("unsafe"),
        "{policy}"
    );
    assert!(policy.contains("connect-src 'self'") && policy.contains("frame-ancestors 'none'"), "{policy}");
    for header in
        ["x-content-type-options: nosniff", "referrer-policy: no-referrer", "cache-control: no-store"]
    {
        assert!(reply.head.contains(header), "{}", reply.head);
    }
    let again = explorer.get(&format!("/{}/", explorer.token), &format!("host: {}\r\n", explorer.host));
    assert!(!again.head.contains(policy), "a number was used twice");
}

#[test]
fn tables_of_files_are_in_the_text() {
    let explorer = Explorer::start(&Folder::new(), &[scenarios().join("compared.toml").to_str().unwrap()]);
    let reply = explorer.get(&format!("/{}/", explorer.token), &format!("host: {}\r\n", explorer.host));
    let page = reply.text();
    let settings = page.split("<script id=\"settings\" type=\"application/json\">").nth(1).unwrap();
    let settings: serde_json::Value =
        serde_json::from_str(settings.split("</script>").next().unwrap()).unwrap();
    let answer = explorer.answer("a", &body(settings["scenario"].as_str().unwrap(), &["task"])).json();
    assert!(answer["invalid"].is_null() && !answer["task"].is_null(), "{}", answer["invalid"]);
}

#[test]
fn answers_are_those_of_the_engine_to_the_bit() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    for name in ["fig2", "stick-slip-overdamped", "healing", "areas"] {
        let text = std::fs::read_to_string(scenarios().join(format!("{name}.toml"))).unwrap();
        let request = body(&text, &["force", "stretches", "block", "task"]);
        let reply = explorer.answer("a", &request);
        let expected = Engine::default().answer_json(request.as_bytes(), &mut ());
        assert!(reply.status == 200 && reply.body == expected, "{name}");
        let answer: serde_json::Value = serde_json::from_slice(&expected).unwrap();
        assert!(
            answer["task"]["record"]["variables"].as_array().is_some_and(|all| !all.is_empty()),
            "{name}"
        );
    }
}

#[test]
fn requests_from_elsewhere_are_refused() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    let (host, token) = (&explorer.host, &explorer.token);
    let port = host.split_once(':').unwrap().1;
    let request = body(QUICK, &["force"]);
    let with = |name: &str, value: Option<&str>| {
        let mut headers = explorer.headers("a");
        headers.retain(|(other, _)| *other != name);
        let mut sent: Vec<(&str, String)> = headers.into_iter().collect();
        sent.extend(value.map(|value| (name, value.to_owned())));
        explorer.send(&post(&sent, &request))
    };
    let wrong = "0".repeat(32);
    let elsewhere = format!("http://localhost:{port}");
    let cases = [
        ("host", Some("evil.example"), 403),
        ("host", Some("127.0.0.1"), 403),
        ("host", None, 403),
        ("origin", Some("http://evil.example"), 403),
        ("origin", Some("null"), 403),
        ("origin", Some(elsewhere.as_str()), 403),
        ("origin", None, 403),
        ("asperity-token", Some(wrong.as_str()), 403),
        ("asperity-token", Some(""), 403),
        ("asperity-token", None, 403),
        ("content-type", Some("text/plain"), 415),
        ("content-type", Some("application/json"), 415),
        ("content-type", None, 415),
        ("asperity-session", None, 400),
        ("asperity-number", Some("-1"), 400),
    ];
    let refused =
        cases.map(|(name, value, status)| (with(name, value), status, format!("{name}: {value:?}")));
    let own = format!("host: {host}\r\n");
    let pages = [
        ("/", own.clone(), 404),
        ("/compute", own.clone(), 405),
        ("/progress", own.clone(), 405),
        (&format!("/{wrong}/"), own.clone(), 404),
        (&format!("/{token}"), own.clone(), 404),
        (&format!("/{token}/../../../etc/passwd"), own.clone(), 404),
        (&format!("/{token}/%2e%2e/Cargo.toml"), own.clone(), 404),
        ("/../../etc/passwd", own.clone(), 404),
        (&format!("/{token}/"), "host: rebound.example\r\n".into(), 403),
        (&format!("/{token}/"), format!("{own}origin: http://evil.example\r\n"), 403),
        (&format!("/{token}/"), format!("{own}host: evil.example\r\n"), 403),
    ]
    .map(|(path, headers, status)| (explorer.get(path, &headers), status, format!("{path} {headers}")));
    let methods = ["OPTIONS", "PUT", "DELETE", "HEAD"].map(|method| {
        let sent = format!(
            "{method} /compute HTTP/1.1\r\nhost: {host}\r\norigin: http://{host}\r\naccess-control-request-method: POST\r\n\r\n"
        );
        (if method == "HEAD" { explorer.get("/compute", &own) } else { explorer.send(sent.as_bytes()) }, 405, method.into())
    });
    for (reply, status, what) in refused.into_iter().chain(pages).chain(methods) {
        assert_eq!(reply.status, status, "{what}: {}", reply.text());
        assert!(
            !reply.head.contains("access-control") && !reply.text().contains(token),
            "{what}: {}",
            reply.head
        );
        assert!(reply.head.contains("nosniff") && !reply.body.is_empty(), "{what}");
    }
    // None of them was in the way of the page.
    assert!(explorer.answer("a", &request).json()["force"].is_object());
}

#[test]
fn what_is_no_request_is_reported() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    let reply = explorer.answer("a", "{\"text\": 3}");
    assert!(reply.status == 400 && reply.text().starts_with("the request is invalid"), "{}", reply.text());
    let mut stream = explorer.connect();
    stream.write_all(b"\x16\x03\x01 what is this\r\n\r\n").unwrap();
    assert_eq!(Reply::read(&mut stream).status, 400);
}

#[test]
fn no_file_is_read_and_too_much_is_refused() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    let law = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\n";
    let interface = "interface = { cells = [1024, 1024], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2 }\ndrive.distance = 1.0\n";
    for (text, key, words) in [
        (format!("{law}protocol_file = '/etc/passwd'\n"), "protocol_file", "the values themselves"),
        (
            "contacts.thresholds.tabulated.file = '../Cargo.toml'\npull = {}\n".into(),
            "contacts.thresholds.tabulated.file",
            "no files are read",
        ),
        (format!("{law}pull.points = 1000000\n"), "pull.points", "at most 100000 points"),
        (
            format!("{law}pull = {{}}\nensemble.size = 2000000000\n"),
            "ensemble.size",
            "at most 100000000 contacts",
        ),
        (format!("{law}{interface}"), "interface.cells", "at most 262144 cells"),
    ] {
        let answer = explorer.answer("a", &body(&text, &["force", "task"])).json();
        let invalid = &answer["invalid"];
        assert_eq!(invalid["key"], key, "{answer}");
        assert!(invalid["message"].as_str().unwrap().contains(words), "{invalid}");
        assert!(answer["force"].is_null() && answer["task"].is_null());
    }
}

#[test]
fn bodies_are_small_and_come_soon() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    let large = body(&"#".repeat(1_000_001), &[]);
    let mut stream = explorer.connect();
    // The server may close before it has read all.
    let _ = stream.write_all(&post(&explorer.headers("a"), &large));
    assert_eq!(Reply::read(&mut stream).status, 413);
    let mut headers = explorer.headers("a");
    headers.push(("transfer-encoding", "chunked".into()));
    let head: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
    let mut endless = explorer.connect();
    endless.write_all(format!("POST /compute HTTP/1.1\r\n{head}\r\n").as_bytes()).unwrap();
    let chunk = format!("10000\r\n{}\r\n", "x".repeat(0x10000));
    for _ in 0..20 {
        let _ = endless.write_all(chunk.as_bytes());
    }
    assert_eq!(Reply::read(&mut endless).status, 413);
    // One that sends half a header, and one that sends half a body: others are answered, and these are ended.
    let mut half_header = explorer.connect();
    half_header.write_all(b"POST /compute HTTP/1.1\r\nhost: ").unwrap();
    let mut half_body = explorer.connect();
    let whole = post(&explorer.headers("a"), &body(QUICK, &["force"]));
    half_body.write_all(&whole[..whole.len() - 5]).unwrap();
    assert!(explorer.answer("b", &body(QUICK, &["force"])).json()["force"].is_object());
    assert_eq!(Reply::read(&mut half_body).status, 408);
    let mut rest = Vec::new();
    half_header.read_to_end(&mut rest).unwrap();
}

#[test]
fn the_last_of_a_thousand_requests_is_answered() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    let long = body(LONG, &["task"]);
    let mut open = VecDeque::new();
    for number in 1..=1000 {
        open.push_back(explorer.ask_as(number, "a", &long));
        if open.len() > 20 {
            assert_eq!(Reply::read(&mut open.pop_front().unwrap()).status, 409);
        }
    }
    let last = body(&QUICK.replace("2.0", "3.0"), &["force"]);
    let answer = Reply::read(&mut explorer.ask_as(1001, "a", &last));
    assert_eq!(answer.body, Engine::default().answer_json(last.as_bytes(), &mut ()));
    for mut stale in open {
        assert_eq!(Reply::read(&mut stale).status, 409);
    }
    // One that comes late is old all the same.
    assert_eq!(Reply::read(&mut explorer.ask_as(1000, "a", &long)).status, 409);
}

#[test]
fn four_pages_compute_and_a_closed_one_makes_room() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    let long = body(LONG, &["task"]);
    let quick = body(QUICK, &["force"]);
    // Idle pages make room at once.
    for page in 0..9 {
        assert_eq!(explorer.answer(&format!("idle {page}"), &quick).status, 200);
    }
    let mut busy: Vec<_> = ["a", "b", "c", "d"].map(|page| explorer.ask(page, &long)).into();
    let mut looks = 0..3000;
    let status = |wanted: u16, looks: &mut std::ops::Range<i32>| {
        looks.any(|_| {
            std::thread::sleep(Duration::from_millis(20));
            explorer.answer("e", &quick).status == wanted
        })
    };
    assert!(status(503, &mut looks), "a fifth page was never refused");
    drop(busy.pop());
    assert!(status(200, &mut looks), "a closed page kept its place");
}

#[test]
fn the_progress_of_long_work_is_reported() {
    let explorer = Explorer::start(&Folder::new(), &[]);
    let progress = |session: &str| {
        let request = String::from_utf8(post(&explorer.headers(session), "")).unwrap();
        let reply = explorer.send(request.replace("/compute", "/progress").as_bytes());
        assert_eq!(reply.status, 200, "{}", reply.text());
        reply.json()["progress"].as_f64().unwrap()
    };
    let _long = explorer.ask("a", &body(LONG, &["task"]));
    let started = Instant::now();
    let mut reported = vec![0.0];
    // Three different fractions, rising.
    while reported.len() < 4 {
        assert!(started.elapsed() < LONGEST, "{reported:?}");
        let now = progress("a");
        if now != reported[reported.len() - 1] {
            reported.push(now);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(reported.is_sorted() && reported[3] < 1.0, "{reported:?}");
    assert_eq!(progress("another"), 0.0);
    // Nothing is done of what has ended.
    assert_eq!(explorer.answer("b", &body(QUICK, &["task"])).status, 200);
    assert_eq!(progress("b"), 0.0);
}

/// Others on this machine can read the command line of the browser.
#[cfg(target_os = "linux")]
#[test]
fn the_address_that_is_opened_leads_to_the_page_once() {
    let folder = Folder::new();
    folder.write("xdg-open", "#!/bin/sh\ncd \"${0%/*}\" && echo \"$1\" > part && mv part opened\n");
    let opener = folder.path().join("xdg-open");
    assert!(Command::new("chmod").arg("+x").arg(&opener).status().unwrap().success());
    let path = format!("{}:/usr/bin:/bin", folder.path().display());
    let explorer = Explorer::of(folder.asperity(&["explore"]).env("PATH", path));
    let found = folder.path().join("opened");
    let started = Instant::now();
    while !found.exists() {
        assert!(started.elapsed() < LONGEST);
        std::thread::sleep(Duration::from_millis(20));
    }
    let opened = std::fs::read_to_string(found).unwrap();
    assert!(!opened.contains(&explorer.token), "{opened}");
    let path = opened.trim().strip_prefix(&format!("http://{}", explorer.host)).unwrap();
    let ticket = path.trim_matches('/');
    assert_eq!(explorer.get(&format!("/{ticket}/"), "host: evil.example\r\n").status, 403);
    let own = format!("host: {}\r\n", explorer.host);
    let reply = explorer.get(path, &own);
    let page = format!("location: http://{}/{}/\r\n", explorer.host, explorer.token);
    assert!(reply.status == 303 && reply.head.contains(&page), "{}", reply.head);
    assert_eq!(explorer.get(path, &own).status, 404);
}

#[test]
fn long_work_is_given_up() {
    let explorer = Explorer::start(&Folder::new(), &["--max-time", "1s"]);
    let answer = explorer.answer("a", &body(LONG, &["task"])).json();
    assert!(answer["task"].is_null());
    assert_eq!(answer["failures"][0], "given up after 1 s (asperity explore --max-time)");
}

#[test]
fn a_signal_ends_it_at_work_too() {
    for (signal, at_work) in [("-INT", false), ("-TERM", false), ("-INT", true)] {
        let mut explorer = Explorer::start(&Folder::new(), &[]);
        let _work = at_work.then(|| explorer.ask("a", &body(LONG, &["task"])));
        explorer.signal(signal);
        assert_eq!(explorer.child.wait().unwrap().code(), Some(130), "{signal}");
        let mut reported = String::new();
        explorer.child.stderr.take().unwrap().read_to_string(&mut reported).unwrap();
        assert_eq!(reported, "the explorer has ended\n");
    }
}

#[test]
fn what_cannot_be_served_is_reported() {
    let folder = Folder::new();
    folder.write("wrong.toml", &QUICK.replace("0.1", "-0.1"));
    let output = folder.run(&["explore", "--no-open", "wrong.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("contacts.thresholds.gaussian.std"), "{}", errors(&output));
    // Each quotation mark takes two bytes in a request.
    folder.write("quoted.toml", &format!("{QUICK}# {}\n", "\"".repeat(600_000)));
    let output = folder.run(&["explore", "--no-open", "quoted.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors(&output).contains("takes up to 990000 bytes of JSON with all tables, got 1200"),
        "{}",
        errors(&output)
    );
    let explorer = Explorer::start(&folder, &[]);
    let port = explorer.host.split_once(':').unwrap().1;
    let output = folder.run(&["explore", "--no-open", "--port", port]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).starts_with(&format!("error: --port {port}: ")), "{}", errors(&output));
}
