//! A browser without a screen, driven by WebDriver (W3C) over a plain local connection.
use std::error::Error;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};

const DRIVER: &str = "chromedriver";
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// One browser with an empty profile; it ends when this is dropped.
pub struct Browser {
    driver: Child,
    /// The driver's output; the driver ends if this is closed.
    _output: BufReader<ChildStdout>,
    port: u16,
    session: String,
    _profile: tempfile::TempDir,
    _turn: MutexGuard<'static, ()>,
}

/// One browser at a time: several at once are slower than one after the other.
static TURN: Mutex<()> = Mutex::new(());

impl Browser {
    /// Starts a browser with a window of this size; panics if chromium or chromedriver is missing.
    pub fn start(width: u32, height: u32) -> Self {
        let installed = |name: &str| {
            let status =
                Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            status.is_ok_and(|status| status.success())
        };
        let browser = BROWSERS.into_iter().find(|name| installed(name)).filter(|_| installed(DRIVER));
        let browser = browser.expect("install chromium and chromedriver: the feature `browser` needs both");
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let mut driver = Command::new(DRIVER)
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(driver.stdout.take().unwrap());
        let port = port_of(&mut output);
        let profile = tempfile::tempdir().unwrap();
        let options = json!({
            "binary": path_of(browser),
            "args": [
                "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                "--disable-background-networking", "--disable-component-update", "--disable-sync",
                "--disable-dev-shm-usage", "--hide-scrollbars",
                format!("--window-size={width},{height}"),
                format!("--user-data-dir={}", profile.path().display()),
            ],
        });
        let wanted = json!({"capabilities": {"alwaysMatch": {
            "browserName": "chrome",
            "goog:chromeOptions": options,
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
        }}});
        let mut started =
            Self { driver, _output: output, port, session: String::new(), _profile: profile, _turn: turn };
        let session = started.ask("POST", "/session", &wanted).unwrap();
        started.session = format!("/session/{}", session["sessionId"].as_str().unwrap());
        started
    }

    pub fn open(&self, page: &Path) {
        self.post("/url", &json!({"url": format!("file://{}", page.display())}));
    }

    /// What a function with this body returns.
    pub fn run(&self, body: &str) -> Value {
        self.post("/execute/sync", &json!({"script": body, "args": []}))
    }

    /// Clicks the middle of the first element that a selector finds, as a person would.
    pub fn click(&self, selector: &str) {
        let found = self.post("/element", &json!({"using": "css selector", "value": selector}));
        let id = found.as_object().and_then(|found| found.values().next()).and_then(Value::as_str).unwrap();
        self.post(&format!("/element/{id}/click"), &json!({}));
    }

    /// Presses keys one after the other where the focus is; [`key`] has those without a letter.
    pub fn press(&self, keys: &str) {
        let stroke =
            |key: char| ["keyDown", "keyUp"].map(|kind| json!({"type": kind, "value": key.to_string()}));
        let actions: Vec<Value> = keys.chars().flat_map(stroke).collect();
        self.act(json!({"type": "key", "id": "keys", "actions": actions}));
    }

    /// Moves the mouse along points of the window with the button down; one point is a click.
    pub fn drag(&self, points: &[(f64, f64)]) {
        let to = |(x, y): &(f64, f64)| json!({"type": "pointerMove", "duration": 0, "x": x.round() as i64, "y": y.round() as i64});
        let mut actions = vec![to(&points[0]), json!({"type": "pointerDown", "button": 0})];
        actions.extend(points[1..].iter().map(to));
        actions.push(json!({"type": "pointerUp", "button": 0}));
        self.act(json!({"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": actions}));
    }

    /// Turns the wheel at a point of the window.
    pub fn wheel(&self, (x, y): (f64, f64), by: f64) {
        let turn = json!({"type": "scroll", "x": x.round() as i64, "y": y.round() as i64, "deltaX": 0, "deltaY": by as i64, "duration": 0});
        self.act(json!({"type": "wheel", "id": "wheel", "actions": [turn]}));
    }

    fn act(&self, device: Value) {
        self.post("/actions", &json!({"actions": [device]}));
    }

    /// A command of the browser's own protocol.
    pub fn command(&self, name: &str, parameters: &Value) -> Value {
        self.post("/goog/cdp/execute", &json!({"cmd": name, "params": parameters}))
    }

    /// The messages of a log since it was read last: `browser` is the console, `performance` has the network.
    pub fn log(&self, kind: &str) -> Vec<Value> {
        self.post("/se/log", &json!({"type": kind})).as_array().cloned().unwrap_or_default()
    }

    fn post(&self, path: &str, body: &Value) -> Value {
        self.ask("POST", &format!("{}{path}", self.session), body).unwrap()
    }

    fn ask(&self, method: &str, path: &str, body: &Value) -> Result<Value, Box<dyn Error>> {
        let body = body.to_string();
        let mut stream = TcpStream::connect(("127.0.0.1", self.port))?;
        let (port, length) = (self.port, body.len());
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json\r\n\
             Content-Length: {length}\r\nConnection: close\r\n\r\n"
        );
        stream.write_all((head + &body).as_bytes())?;
        let answer: Value = serde_json::from_slice(&content(BufReader::new(stream))?)?;
        let value = answer["value"].clone();
        match value.get("error").filter(|error| !error.is_null()) {
            Some(_) => Err(format!("{method} {path} {body}: {}", value["message"]).into()),
            None => Ok(value),
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Where it can't be ended as it should, its driver ends it; a test that failed fails for its own reason.
        let _ = self.ask("DELETE", &self.session, &json!({}));
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}

/// The port in a driver's output.
fn port_of(output: &mut impl BufRead) -> u16 {
    let mut line = String::new();
    while output.read_line(&mut line).unwrap() > 0 {
        let port =
            line.rsplit_once("successfully on port ").map(|(_, port)| port.trim_end().trim_end_matches('.'));
        if let Some(port) = port {
            return port.parse().unwrap();
        }
        line.clear();
    }
    panic!("{DRIVER} ends without a word of its port");
}

/// The body of an answer.
fn content(mut answer: impl BufRead) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        answer.read_line(&mut line)?;
        match line.split_once(':') {
            Some((name, value)) if name.eq_ignore_ascii_case("content-length") => {
                length = value.trim().parse()?
            }
            Some(_) => {}
            None if line.trim().is_empty() => break,
            None => {}
        }
    }
    let mut body = Vec::new();
    answer.take(length).read_to_end(&mut body)?;
    Ok(body)
}

/// The keys of WebDriver without a letter.
pub mod key {
    pub const ENTER: &str = "\u{e007}";
    pub const TAB: &str = "\u{e004}";
    pub const LEFT: &str = "\u{e012}";
    pub const UP: &str = "\u{e013}";
    pub const RIGHT: &str = "\u{e014}";
    pub const DOWN: &str = "\u{e015}";
}

/// Where a command is found.
fn path_of(name: &str) -> String {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&folders).map(|folder| folder.join(name)).find(|path| path.is_file());
    found.unwrap_or_else(|| name.into()).display().to_string()
}
