use crate::page;
use crate::playback::Playback;
use crate::server::Server;
use crate::session::Session;
use anyhow::{Context as _, Result, ensure};
use clap::Args;
use serde_json::json;
use staya_console::say;
use staya_console::{Ended, Global, ScenarioArgs, Stop, print, print_json};
use staya_sim::scenario::text_with;
use staya_sim::shown::Shown as _;
use std::fs::OpenOptions;
use std::io::{self, Write as _};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Options of the page's address.
#[derive(Args, Clone, Copy, Debug)]
pub struct ListenArgs {
    /// Address and port of the page; port 0 selects a free port. With an address other than
    /// loopback, such as 0.0.0.0, anyone with the printed address and its token can watch and
    /// control the run; the connection is not encrypted.
    #[arg(long, value_name = "ADDRESS", default_value_t = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0))]
    pub listen: SocketAddr,
    /// Do not open a browser.
    #[arg(long)]
    pub no_open: bool,
}

impl ListenArgs {
    fn serve(&self, global: &Global) -> Result<Page> {
        let server = Server::start(self.listen, page::served()?)?;
        if !server.address().ip().is_loopback() {
            say(
                "The page is open to the network: anyone who knows its address can control this run, and the connection is \
                not encrypted.",
            );
        }
        let url = server.url();
        if global.json {
            print_json(&json!({ "url": url }))?;
        } else {
            print(&format!("{url}\n"))?;
        }
        let way_in = if self.no_open { None } else { open(&url, server.address().port()) };
        Ok(Page { server, _way_in: way_in })
    }
}

struct Page {
    server: Server,
    _way_in: Option<WayIn>,
}

/// Watch a run in the browser and interact with it, or play a recording.
#[derive(Args, Clone, Debug)]
pub struct ViewArgs {
    /// Scenario (.toml), or a recording made with `staya run --record`.
    #[command(flatten)]
    source: ScenarioArgs,
    #[command(flatten)]
    listen: ListenArgs,
    /// Start paused.
    #[arg(long)]
    paused: bool,
    /// Simulated seconds per real second [default: 1, or ten ticks per second if a tick is longer
    /// than 0.1 s].
    #[arg(long, value_name = "X", value_parser = speed)]
    speed: Option<f64>,
}

fn speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|speed| (0.001..=1e6).contains(speed));
    speed.ok_or_else(|| "give 0.001 to 1000000".to_owned())
}

impl ViewArgs {
    /// Runs the command until Ctrl-C.
    ///
    /// # Errors
    /// The scenario or recording is invalid, or the address is not available.
    pub fn run(&self, global: &Global) -> Result<Ended> {
        let path = self.source.path();
        let stop = Stop::on_ctrl_c()?;
        let is_scenario = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        let server = if is_scenario {
            // Errors refer to the file without the overrides.
            self.source.load()?;
            let text = text_with(path, self.source.settings())?;
            let mut session = Session::new(text, path, &self.source.overrides(), self.paused)?;
            if self.speed.is_some() {
                session.set_speed(self.speed);
            }
            let Page { server, _way_in } = self.listen.serve(global)?;
            session.run(&server, &|| stop.is_requested() || !server.is_alive());
            server
        } else {
            let mut playback = Playback::open(path, self.paused)?;
            if let Some(at) = playback.torn_at() {
                let (_, last) = playback.ticks();
                say(&format!("{}: incomplete file (ends at byte {at}); playing up to tick {last}", path.shown()));
            }
            if self.speed.is_some() {
                playback.set_speed(self.speed);
            }
            let Page { server, _way_in } = self.listen.serve(global)?;
            let over = || stop.is_requested() || !server.is_alive();
            playback.run(&server, &over).context("cannot continue the playback")?;
            server
        };
        ensure!(server.is_alive(), "the page server has failed; start the command again and report the messages above");
        Ok(Ended::by(&stop))
    }
}

/// A file that leads a browser to the page, since others can read a command's arguments.
struct WayIn(PathBuf);

impl WayIn {
    /// Creates the file, readable only by this user; an existing file is an error.
    fn new(url: &str, port: u16) -> io::Result<Self> {
        let path = std::env::temp_dir().join(format!("staya-{}-{port}.html", std::process::id()));
        let mut options = OpenOptions::new();
        options.write(true).create_new(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let mut file = options.open(&path)?;
        let this = Self(path);
        writeln!(
            file,
            "<!doctype html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">\
             <meta http-equiv=\"refresh\" content=\"0; url={url}\"><title>Staya</title><a href=\"{url}\">The page</a>"
        )?;
        Ok(this)
    }
}

impl Drop for WayIn {
    fn drop(&mut self) {
        // A file left behind leads to a page that no longer exists.
        let _ = std::fs::remove_file(&self.0);
    }
}

fn open(url: &str, port: u16) -> Option<WayIn> {
    let has_screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    let mut command = match std::env::consts::OS {
        "macos" => Command::new("open"),
        "windows" => Command::new("explorer"),
        _ if has_screen => Command::new("xdg-open"),
        _ => return None,
    };
    let way_in = WayIn::new(url, port).ok()?;
    let command = command.arg(&way_in.0).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().ok().map(|_| way_in)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_link_file_is_private_and_removed_with_the_page() {
        let url = "http://127.0.0.1:1/?token=0123abcd";
        let way_in = WayIn::new(url, 1).expect("it can be written");
        let path = way_in.0.clone();
        let text = std::fs::read_to_string(&path).expect("it is there");
        assert!(text.contains(&format!("0; url={url}\"")) && !path.to_string_lossy().contains("0123abcd"), "{text}");
        #[cfg(unix)]
        {
            let mode = std::os::unix::fs::PermissionsExt::mode(&path.metadata().expect("it is there").permissions());
            assert_eq!(mode & 0o777, 0o600);
        }
        // It may belong to another user.
        assert!(WayIn::new(url, 1).is_err() && path.exists());
        drop(way_in);
        assert!(!path.exists());
    }
}
