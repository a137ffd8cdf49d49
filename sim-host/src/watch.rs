//! `--view` of commands whose runs go on by themselves: a page that looks on.

use anyhow::Result;
use clap::Args;
use staya_sim::scenario::Scenario;
use staya_view::page;
use staya_view::server::Server;
use staya_view::watch::Watcher;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};

/// Pages that look on.
#[derive(Args, Clone, Copy, Debug)]
pub struct WatchArgs {
    /// Serve a page that looks on while this goes on, and ends with it; to take hold of a run, or to look at a short one, there is
    /// `staya view`. Nobody waits for the page, and nothing becomes different by it.
    #[arg(long, help_heading = "A page that looks on")]
    view: bool,
    /// Address and port of the page; port 0: any that is free. Beyond this machine (0.0.0.0) whoever has the address that is
    /// printed, with its token, can watch, unencrypted.
    #[arg(
        long,
        value_name = "ADDRESS",
        requires = "view",
        default_value_t = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0),
        help_heading = "A page that looks on"
    )]
    listen: SocketAddr,
}

impl WatchArgs {
    /// Begins to serve the page if it is wanted, and says where on standard error.
    ///
    /// # Errors
    /// The address cannot be listened on.
    pub fn watcher(&self, scenario: &Scenario) -> Result<Option<Watcher>> {
        if !self.view {
            return Ok(None);
        }
        let watcher = Watcher::new(Server::start(self.listen, page::served()?)?, scenario)?;
        eprintln!("{}", watcher.server().url());
        Ok(Some(watcher))
    }
}
