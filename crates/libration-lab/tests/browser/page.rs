//! The report in a window of its own, with a reader's hands.

use std::sync::Arc;

use serde_json::{Value, json};

use crate::chromium::{self, Chromium};
use crate::devtools::DevTools;
use crate::report;

/// A desk and a phone, in CSS pixels.
pub(crate) const WIDTHS: [u32; 2] = [1440, 390];

/// Where a mouse is, in CSS pixels of the window.
pub(crate) type Point = (f64, f64);

/// An open report.
pub(crate) struct Page {
    devtools: DevTools,
    browser: Arc<Chromium>,
    target: String,
    address: String,
}

/// Opens the report `width` pixels wide, lets `look` use it, and insists that meanwhile nothing
/// went wrong and nothing was asked of anyone. Does nothing where there is no browser.
pub(crate) fn visit(width: u32, look: impl FnOnce(&mut Page)) {
    let Some(browser) = chromium::shared() else { return };
    let mut page = Page::open(browser, width);
    look(&mut page);
    // One more answer: all events that came before it have then arrived.
    page.eval("null");
    let complaints = page.complaints();
    assert!(complaints.is_empty(), "{complaints:#?}");
}

impl Page {
    fn open(browser: Arc<Chromium>, width: u32) -> Page {
        // A window each, since a browser draws only the foremost tab of a window.
        let target = DevTools::connect(&browser.host, &browser.path)
            .call("Target.createTarget", json!({"url": "about:blank", "newWindow": true}));
        let target = target["targetId"].as_str().unwrap().to_owned();
        let devtools = DevTools::connect(&browser.host, &format!("/devtools/page/{target}"));
        let mut page = Page { devtools, browser, target, address: String::new() };
        for domain in ["Page", "Runtime", "Network", "Log"] {
            page.devtools.call(&format!("{domain}.enable"), json!({}));
        }
        page.devtools.call("Performance.enable", json!({"timeDomain": "threadTicks"}));
        page.devtools.call("Emulation.setFocusEmulationEnabled", json!({"enabled": true}));
        page.devtools.call(
            "Emulation.setDeviceMetricsOverride",
            json!({"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}),
        );
        page.prefer("light");
        let file = format!("file://{}", report::file().display());
        let answer = page.devtools.call("Page.navigate", json!({"url": file}));
        assert!(answer["errorText"].is_null(), "{answer}");
        page.devtools.wait("Page.loadEventFired");
        page.frame();
        page.address = page.eval("location.href").as_str().unwrap().to_owned();
        page
    }

    /// Waits until the page has been painted as it is now.
    pub(crate) fn frame(&mut self) {
        self.eval(
            "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))",
        );
    }

    /// The value of a JavaScript expression, or of what it promises.
    pub(crate) fn eval(&mut self, expression: &str) -> Value {
        let question =
            json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        let mut answer = self.devtools.call("Runtime.evaluate", question);
        let error = &answer["exceptionDetails"];
        assert!(error.is_null(), "{expression}\n{error:#}");
        answer["result"]["value"].take()
    }

    /// The number that an expression gives.
    pub(crate) fn number(&mut self, expression: &str) -> f64 {
        let value = self.eval(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression} is {value}"))
    }

    /// The texts that an expression gives.
    pub(crate) fn texts(&mut self, expression: &str) -> Vec<String> {
        let value = self.eval(expression);
        serde_json::from_value(value).unwrap_or_else(|error| panic!("{expression}: {error}"))
    }

    /// Waits until an expression holds; false if it does not come to hold.
    pub(crate) fn comes_true(&mut self, expression: &str) -> bool {
        // The wait ends as soon as the thing happens; only a failure takes all of it.
        self.eval(&format!(
            "(async () => {{
               for (let i = 0; i < 500; i++) {{
                 if ({expression}) return true;
                 await new Promise((next) => setTimeout(next, 20));
               }}
               return false;
             }})()"
        )) == true
    }

    /// What the reader prefers: `light` or `dark`.
    pub(crate) fn prefer(&mut self, scheme: &str) {
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.devtools.call("Emulation.setEmulatedMedia", json!({"features": features}));
    }

    /// Presses a key and lets it go.
    pub(crate) fn press(&mut self, key: &str) {
        let (code, text) = match key {
            "Tab" => (9, ""),
            "Enter" => (13, "\r"),
            "Escape" => (27, ""),
            "ArrowRight" => (39, ""),
            character => (0, character),
        };
        let mut event = json!({"type": "keyDown", "key": key, "windowsVirtualKeyCode": code});
        if text.is_empty() {
            event["type"] = "rawKeyDown".into();
        } else {
            event["text"] = text.into();
        }
        self.devtools.call("Input.dispatchKeyEvent", event.clone());
        event["type"] = "keyUp".into();
        self.devtools.call("Input.dispatchKeyEvent", event);
    }

    /// Moves the mouse.
    pub(crate) fn point(&mut self, at: Point) {
        self.mouse("mouseMoved", at, 0);
    }

    /// Clicks.
    pub(crate) fn click(&mut self, at: Point) {
        self.point(at);
        self.mouse("mousePressed", at, 1);
        self.mouse("mouseReleased", at, 0);
    }

    /// Drags from one place to another.
    pub(crate) fn drag(&mut self, from: Point, to: Point) {
        self.point(from);
        self.mouse("mousePressed", from, 1);
        for share in [0.3, 0.7, 1.0] {
            let along = |a: f64, b: f64| a + share * (b - a);
            self.mouse("mouseMoved", (along(from.0, to.0), along(from.1, to.1)), 1);
        }
        self.mouse("mouseReleased", to, 0);
    }

    fn mouse(&mut self, kind: &str, (x, y): Point, buttons: u32) {
        let button = if kind == "mouseMoved" && buttons == 0 { "none" } else { "left" };
        let clicks = u32::from(kind != "mouseMoved");
        let event = json!({"type": kind, "x": x, "y": y, "button": button, "buttons": buttons,
            "clickCount": clicks});
        self.devtools.call("Input.dispatchMouseEvent", event);
    }

    /// Brings the element that an expression gives into the middle of the window, and gives its
    /// own middle there.
    pub(crate) fn bring(&mut self, element: &str) -> Point {
        let middle = self.eval(&format!(
            "(() => {{
               const element = {element};
               element.scrollIntoView({{ block: 'center', behavior: 'instant' }});
               const box = element.getBoundingClientRect();
               return [box.x + box.width / 2, box.y + box.height / 2];
             }})()"
        ));
        serde_json::from_value(middle).unwrap()
    }

    /// Answers a question that only the DevTools answer.
    pub(crate) fn ask(&mut self, method: &str, parameters: Value) -> Value {
        self.devtools.call(method, parameters)
    }

    /// Errors in the console, and requests for anything but the page itself.
    fn complaints(&self) -> Vec<String> {
        let own = |url: &str| {
            url == self.address || ["data:", "blob:", "about:"].iter().any(|s| url.starts_with(s))
        };
        let complaint = |event: &Value| {
            let text = &event["params"];
            match event["method"].as_str()? {
                "Network.requestWillBeSent" => {
                    let url = text["request"]["url"].as_str()?;
                    (!own(url)).then(|| format!("asks for {url}"))
                }
                "Network.webSocketCreated" => Some(format!("connects to {}", text["url"])),
                "Runtime.exceptionThrown" => Some(text["exceptionDetails"].to_string()),
                "Runtime.consoleAPICalled" if text["type"] == "error" => {
                    Some(text["args"].to_string())
                }
                "Log.entryAdded" if text["entry"]["level"] == "error" => {
                    Some(text["entry"].to_string())
                }
                _ => None,
            }
        };
        self.devtools.events().iter().filter_map(complaint).collect()
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        // A test that failed may have lost its connection, or the browser.
        if !std::thread::panicking() {
            DevTools::connect(&self.browser.host, &self.browser.path)
                .call("Target.closeTarget", json!({"targetId": self.target}));
        }
    }
}
