//! Debian's Chromium, without a screen, driven by what its driver speaks: JSON over HTTP.

use std::io::{BufRead, BufReader};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};

use serde_json::{Value, json};

use super::axe;
use super::browser::send;
use crate::command::terminate;

/// A browser with one window.
pub struct Chromium {
    driver: Child,
    host: String,
    session: String,
}

impl Chromium {
    /// Starts one with a window of this size.
    pub fn start([width, height]: [u32; 2]) -> Self {
        let driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut driver =
            driver.expect("chromedriver: on Debian, apt-get install chromium chromium-driver");
        let mut said = BufReader::new(driver.stdout.take().unwrap()).lines();
        let port = said.find_map(|line| {
            let line = line.unwrap();
            let (_, port) = line.split_once("started successfully on port ")?;
            Some(port.trim_end_matches('.').to_owned())
        });
        let mut chromium = Self {
            driver,
            host: format!("127.0.0.1:{}", port.unwrap()),
            session: String::new(),
        };
        let size = format!("--window-size={width},{height}");
        let arguments = [
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            &size,
        ];
        let options = json!({"args": arguments});
        let wanted = json!({
            "browserName": "chrome",
            "goog:chromeOptions": options,
            "goog:loggingPrefs": {"browser": "ALL"},
            // Beside other tests a large page takes its time to be examined.
            "timeouts": {"script": 120_000},
        });
        let begun = chromium.ask(
            "POST",
            "/session",
            &json!({"capabilities": {"alwaysMatch": wanted}}),
        );
        chromium.session = format!("/session/{}", begun["sessionId"].as_str().unwrap());
        // The window has edges; the page is to have this size.
        let size =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        chromium.develop("Emulation.setDeviceMetricsOverride", &size);
        chromium
    }

    /// What Chromium's own protocol knows and the standard does not.
    pub fn develop(&self, command: &str, parameters: &Value) {
        self.post(
            "/goog/cdp/execute",
            &json!({"cmd": command, "params": parameters}),
        );
    }

    pub fn open(&self, address: &str) {
        self.post("/url", &json!({"url": address}));
    }

    /// Runs a script in the page.
    pub fn run(&self, script: &str) -> Value {
        self.post("/execute/sync", &json!({"script": script, "args": []}))
    }

    /// Waits until a script says true.
    pub fn until(&self, script: &str) {
        let script = format!(
            "const [done] = [...arguments].slice(-1); \
             const look = () => {{ if ({script}) done(true); else setTimeout(look, 10); }}; look();"
        );
        let done = self.post("/execute/async", &json!({"script": script, "args": []}));
        assert_eq!(done, true, "{script}");
    }

    /// Presses what this selector names, where a mouse would.
    pub fn click(&self, selector: &str) {
        let found = self.post(
            "/element",
            &json!({"using": "css selector", "value": selector}),
        );
        let id = found.as_object().unwrap().values().next().unwrap();
        let id = id
            .as_str()
            .unwrap_or_else(|| panic!("no {selector}: {found}"));
        self.post(&format!("/element/{id}/click"), &json!({}));
    }

    /// Presses and lets go of a key.
    pub fn key(&self, key: &str) {
        let actions = [
            json!({"type": "keyDown", "value": key}),
            json!({"type": "keyUp", "value": key}),
        ];
        let keyboard = json!({"type": "key", "id": "keyboard", "actions": actions});
        self.post("/actions", &json!({"actions": [keyboard]}));
    }

    /// Keeps what is to be seen, among what is built, and finds that everybody can use it.
    pub fn photograph(&self, name: &str) {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("pages");
        std::fs::create_dir_all(&folder).unwrap();
        let picture = self.ask("GET", &format!("{}/screenshot", self.session), &Value::Null);
        let bytes = base64(picture.as_str().unwrap());
        std::fs::write(folder.join(format!("{name}.png")), bytes).unwrap();
        self.run(axe::script());
        let hard = self.post(
            "/execute/async",
            &json!({"script": axe::EXAMINE, "args": []}),
        );
        assert_eq!(hard, json!([]), "{name}");
    }

    /// What the browser complained about.
    pub fn complaints(&self) -> Vec<Value> {
        let log = self.post("/se/log", &json!({"type": "browser"}));
        log.as_array().unwrap().clone()
    }

    fn post(&self, what: &str, body: &Value) -> Value {
        self.ask("POST", &format!("{}{what}", self.session), body)
    }

    #[track_caller]
    fn ask(&self, method: &str, path: &str, body: &Value) -> Value {
        let body = match body {
            Value::Null => String::new(),
            body => body.to_string(),
        };
        let length = body.len().to_string();
        let headers = [
            ("Host", self.host.as_str()),
            ("Connection", "close"),
            ("Content-Type", "application/json"),
            ("Content-Length", &length),
        ];
        let answer = send(&self.host, &format!("{method} {path}"), &headers, &body).with(200);
        let mut answer: Value = serde_json::from_str(&answer.body).unwrap();
        answer["value"].take()
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        // Also after a test that failed: a driver that is stopped leaves its browser behind.
        let end = || self.ask("DELETE", &self.session, &Value::Null);
        let _ = catch_unwind(AssertUnwindSafe(end)).is_ok();
        terminate(&self.driver);
        let _ = self.driver.wait();
    }
}

/// Bytes from their text in base 64.
fn base64(text: &str) -> Vec<u8> {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = text
        .bytes()
        .filter_map(|byte| DIGITS.iter().position(|it| *it == byte));
    let (mut bytes, mut held, mut bits) = (Vec::new(), 0_u32, 0);
    for digit in digits {
        held = held << 6 | digit as u32;
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            bytes.push((held >> bits) as u8);
        }
    }
    bytes
}
