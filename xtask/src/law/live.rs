//! A page's connection to `staya view`.

use crate::prelude::*;
use serde_json::{Value, json};
use std::io::{BufRead as _, BufReader};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::Duration;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// Longest wait for a message.
const PATIENCE: Duration = Duration::from_secs(60);

/// A paused live run, which ends with this value.
pub struct Live {
    view: Child,
    page: WebSocket<MaybeTlsStream<TcpStream>>,
}

impl Drop for Live {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.view.kill();
        let _ = self.view.wait();
    }
}

impl Live {
    /// Starts this `staya view` and connects to its page.
    pub fn start(view: &mut Command) -> Result<Self> {
        let mut view = view.args(["--paused", "--no-open"]).stdout(Stdio::piped()).spawn().context("cannot start")?;
        let mut address = String::new();
        let output = view.stdout.take().context("no output")?;
        let connected = BufReader::new(output).read_line(&mut address).context("no address").and_then(|_| {
            let live = address.trim().replace("http:", "ws:").replace("/?", "/live?");
            Ok(tungstenite::connect(&live).with_context(|| format!("cannot connect to {live:?}"))?.0)
        });
        let page = match connected {
            Ok(page) => page,
            Err(reason) => {
                let _ = view.kill();
                let _ = view.wait();
                return Err(reason);
            }
        };
        if let MaybeTlsStream::Plain(stream) = page.get_ref() {
            stream.set_read_timeout(Some(PATIENCE))?;
        }
        Ok(Self { view, page })
    }

    /// Sends a message of the page.
    pub fn say(&mut self, message: &Value) -> Result<()> {
        Ok(self.page.send(Message::text(message.to_string()))?)
    }

    /// The next message of a type; an `error` is one.
    pub fn next(&mut self, kind: &str) -> Result<Value> {
        loop {
            let Message::Text(text) = self.page.read().with_context(|| format!("no message {kind}"))? else { continue };
            let message: Value = serde_json::from_str(text.as_str())?;
            ensure!(message["type"] != json!("error"), "the view says: {}", message["text"]);
            if message["type"] == json!(kind) {
                return Ok(message);
            }
        }
    }
}
