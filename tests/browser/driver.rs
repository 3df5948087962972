//! A headless Chromium, driven by the WebDriver protocol (W3C) through its chromedriver.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use serde_json::{Value, json};

/// One browser at a time: a machine may have one core.
static ONE: Mutex<()> = Mutex::new(());

/// A browser with one page, which ends with it.
pub struct Browser {
    driver: Child,
    session: String,
    agent: ureq::Agent,
    _profile: super::common::Folder,
    _one: MutexGuard<'static, ()>,
}

/// Whether a program is there.
fn is_there(program: &str) -> bool {
    let asked = Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    asked.is_ok_and(|status| status.success())
}

impl Browser {
    /// Starts one; says aloud that there is none where there is none.
    pub fn start(test: &str, width: u32) -> Option<Self> {
        let one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let chromium = ["chromium", "chromium-browser", "google-chrome"].into_iter().find(|p| is_there(p));
        let (Some(chromium), true) = (chromium, is_there("chromedriver")) else {
            // Not captured as what a test prints is.
            let _ = writeln!(std::io::stderr(), "SKIPPED {test}: there is no chromium with its chromedriver");
            return None;
        };
        let mut driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(driver.stdout.take().unwrap()).lines().map_while(Result::ok);
        let port = said.find_map(|line| {
            let (_, port) = line.split_once("started successfully on port ")?;
            Some(port.trim_end_matches('.').to_owned())
        });
        let profile = super::common::Folder::new(&format!("chromium-{test}"));
        let agent: ureq::Agent = ureq::Agent::config_builder()
            .timeout_global(Some(Duration::from_secs(120)))
            .http_status_as_error(false)
            .build()
            .into();
        let session = format!("http://127.0.0.1:{}/session", port.expect("chromedriver says its port"));
        let mut browser = Self { driver, session, agent, _profile: profile, _one: one };
        let mut arguments: Vec<String> =
            ["headless", "no-sandbox", "disable-gpu", "disable-quic", "no-first-run", "disable-sync"]
                .into_iter()
                .chain(["disable-background-networking", "disable-component-update", "disable-dev-shm-usage"])
                .map(|name| format!("--{name}"))
                .collect();
        arguments.push(format!("--user-data-dir={}", browser._profile.0.display()));
        let options = json!({"binary": which(chromium), "args": arguments});
        let wanted = json!({"goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}});
        let made = browser.post("", json!({"capabilities": {"alwaysMatch": wanted}}));
        let id = made["sessionId"].as_str().unwrap_or_else(|| panic!("no session: {made}")).to_owned();
        browser.session = format!("{}/{id}", browser.session);
        let size = json!({"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600});
        browser.devtools("Emulation.setDeviceMetricsOverride", size);
        Some(browser)
    }

    fn post(&self, path: &str, body: Value) -> Value {
        let asked = self.agent.post(format!("{}{path}", self.session)).content_type("application/json");
        let text = asked.send(body.to_string()).unwrap().body_mut().read_to_string().unwrap();
        let answer: Value = serde_json::from_str(&text).unwrap();
        assert!(answer["value"]["error"].is_null(), "{path} {body}: {}", answer["value"]["message"]);
        answer["value"].clone()
    }

    /// A command of the DevTools protocol.
    pub fn devtools(&self, command: &str, parameters: Value) -> Value {
        self.post("/goog/cdp/execute", json!({"cmd": command, "params": parameters}))
    }

    /// Opens a file.
    pub fn open(&self, file: &std::path::Path) {
        self.post("/url", json!({"url": format!("file://{}", file.display())}));
    }

    /// The value of the body of a function.
    pub fn run(&self, script: &str) -> Value {
        self.post("/execute/sync", json!({"script": script, "args": []}))
    }

    /// Moves the mouse over the picture `selector` through places in parts of its width and height; with the button down
    /// after the first where `drags`.
    pub fn mouse(&self, selector: &str, places: &[[f64; 2]], drags: bool) {
        let script = format!(
            "const e = document.querySelector({}); e.scrollIntoView({{block: 'center'}});
             const b = e.getBoundingClientRect(); return [b.x, b.y, b.width, b.height];",
            json!(selector)
        );
        let found = self.run(&script);
        let [x, y, w, h] = [0, 1, 2, 3].map(|k| found[k].as_f64().unwrap());
        let mut actions = Vec::new();
        for (k, [across, down]) in places.iter().enumerate() {
            let (x, y) = ((x + across * w).round() as i64, (y + down * h).round() as i64);
            actions.push(json!({"type": "pointerMove", "duration": 30, "x": x, "y": y}));
            if drags && k == 0 {
                actions.push(json!({"type": "pointerDown", "button": 0}));
            }
        }
        if drags {
            actions.push(json!({"type": "pointerUp", "button": 0}));
        }
        // What is not on the screen is drawn a moment later.
        actions.push(json!({"type": "pause", "duration": 400}));
        let parameters = json!({"pointerType": "mouse"});
        let mouse = json!({"type": "pointer", "id": "mouse", "parameters": parameters, "actions": actions});
        self.post("/actions", json!({"actions": [mouse]}));
    }

    /// Presses keys one after another.
    pub fn keys(&self, keys: &[&str]) {
        let each =
            keys.iter().flat_map(|key| ["keyDown", "keyUp"].map(|what| json!({"type": what, "value": key})));
        let actions: Vec<Value> = each.chain([json!({"type": "pause", "duration": 400})]).collect();
        self.post("/actions", json!({"actions": [{"type": "key", "id": "keys", "actions": actions}]}));
    }

    /// The page as a PDF.
    pub fn printed(&self) -> Vec<u8> {
        use base64::prelude::{BASE64_STANDARD, Engine};
        BASE64_STANDARD.decode(self.post("/print", json!({})).as_str().unwrap()).unwrap()
    }

    /// What the console was told, warnings and errors.
    pub fn complaints(&self) -> Vec<Value> {
        self.post("/se/log", json!({"type": "browser"})).as_array().cloned().unwrap_or_default()
    }
}

/// The path of a program.
fn which(program: &str) -> String {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let mut found = std::env::split_paths(&paths).map(|folder| folder.join(program));
    found.find(|path| path.is_file()).map_or_else(|| program.to_owned(), |path| path.display().to_string())
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Ends the browser, and then its driver.
        let _ = self.agent.delete(&self.session).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
