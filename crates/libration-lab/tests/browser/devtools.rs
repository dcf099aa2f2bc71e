//! The DevTools protocol: commands, their answers, and the events in between.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::Duration;

use serde_json::{Value, json};
use tungstenite::client::client_with_config;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket};

/// An answer that takes longer than this will not come.
const PATIENCE: Duration = Duration::from_secs(300);

/// A connection to the browser or to one of its pages.
pub(crate) struct DevTools {
    socket: WebSocket<TcpStream>,
    sent: u64,
    events: Vec<Value>,
}

impl DevTools {
    /// Connects to `path` on `host`.
    pub(crate) fn connect(host: &str, path: &str) -> DevTools {
        let stream = TcpStream::connect(host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.set_nodelay(true).unwrap();
        // The accessibility tree of the whole page comes as one message of tens of megabytes.
        let any_size = WebSocketConfig::default().max_message_size(None).max_frame_size(None);
        let url = format!("ws://{host}{path}");
        let (socket, _) = client_with_config(url, stream, Some(any_size)).unwrap();
        DevTools { socket, sent: 0, events: Vec::new() }
    }

    /// Sends a command and gives its result; events that arrive before it are kept.
    pub(crate) fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.sent += 1;
        let command = json!({"id": self.sent, "method": method, "params": parameters});
        self.socket.send(Message::text(command.to_string())).unwrap();
        loop {
            let mut message = self.receive(method);
            if message["id"] == self.sent {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].take();
            }
            self.events.push(message);
        }
    }

    /// Waits for an event, which may have arrived already.
    pub(crate) fn wait(&mut self, event: &str) {
        while !self.events.iter().any(|e| e["method"] == event) {
            let message = self.receive(event);
            self.events.push(message);
        }
    }

    /// What has happened so far, in order.
    pub(crate) fn events(&self) -> &[Value] {
        &self.events
    }

    fn receive(&mut self, awaited: &str) -> Value {
        loop {
            match self.socket.read() {
                Ok(message) => return serde_json::from_str(message.to_text().unwrap()).unwrap(),
                // A process that was stopped and goes on finds its wait cut short; it waits anew.
                Err(Error::Io(error)) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => panic!("while waiting for {awaited}: {error}"),
            }
        }
    }
}
