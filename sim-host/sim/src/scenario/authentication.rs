//! `[authentication]` and `[[attack]]`: the swarm's key, and attackers.

use super::source::Checked;
use super::{
    Attack, AttackKind, AttackTable, AuthenticationTable, Draft, KeyRotation, Lie, Robot, Roll, Secret, check,
};
use crate::key::{self, KeyFile};
use crate::radio::PEERS;
use staya_controller::auth::{Key, Master};
use staya_controller::robot::RobotId;
use staya_controller::wire::Format;
use staya_mavlink::any::max_robot;
use std::path::Path;

/// The keys of a swarm whose beacons are authenticated.
#[derive(Clone, Debug)]
pub struct Keys {
    /// The key that all robots share, or the operator's first one.
    pub key: Key,
    /// The operator's keys, if each robot has its own key.
    pub rotation: Option<KeyRotation>,
    /// Warning for the owner of the key file.
    pub remark: Option<String>,
}

pub(super) fn key(draft: &Draft<'_>, robots: &[Robot]) -> Checked<Option<Keys>> {
    let Some(table) = &draft.file.authentication else { return Ok(None) };
    let at = draft.at("authentication");
    let from_file = |field: &str, name: &Path| {
        let read = KeyFile::read(&draft.source.file(name))
            .map_err(|error| at.error(field, error.to_string(), "file names are relative to the scenario file"))?;
        Ok((read.key, read.remark))
    };
    let from_text = |field: &str, text: &str| {
        let key = key::parse(text).map_err(|(_, problem)| {
            at.error(field, problem, "give 64 hexadecimal digits, or \"passphrase: \" and words")
        })?;
        Ok((key, None))
    };
    let (secret, remark) = match &table.secret {
        Secret::KeyFile(name) => from_file("key_file", name),
        Secret::Key(text) => from_text("key", text),
        Secret::MasterFile(name) => from_file("master_file", name),
        Secret::Master(text) => from_text("master", text),
    }?;
    let (key, rotation) = if let Secret::Key(_) | Secret::KeyFile(_) = table.secret {
        let is_fixed = table.roll.is_empty() && table.overlap_s.is_none() && table.place_m.is_none();
        let remedy = "give master_file or master, or leave roll, overlap_s and place_m out";
        let what = "only robots with a master key receive new keys";
        draft.require(is_fixed, "authentication", what, remedy)?;
        (secret, None)
    } else {
        (Master::new(&secret).seed(0).key(0), Some(rotation(draft, table, robots, secret)?))
    };
    // The operators take two more entries of the peer table.
    let what = format!("{} robots do not fit into a robot's table of peers", robots.len());
    let remedy = format!("give at most {}, or leave this table out", PEERS - 2);
    draft.require(robots.len() + 2 <= PEERS, "authentication", what, remedy)?;
    let most = max_robot(draft.file.radio.format, true);
    if let Some(robot) = robots.iter().find(|robot| robot.id > most) {
        let problem = format!("robot {} has no number in frames with a tag", robot.id.0);
        return Err(draft.error("authentication", problem, format!("give numbers up to {}", most.0)));
    }
    Ok(Some(Keys { key, remark, rotation }))
}

fn rotation(draft: &Draft<'_>, table: &AuthenticationTable, robots: &[Robot], master: Key) -> Checked<KeyRotation> {
    let (has_keys, remedy) =
        (draft.file.radio.format == Format::Postcard, "give radio.format = \"postcard\", or a key instead of a master");
    draft.require(has_keys, "authentication.master", "MAVLink's signatures have one key", remedy)?;
    let has_orders = draft.file.plane.as_ref().is_some_and(|plane| !plane.order.is_empty());
    let remedy = "give each robot its goal by [[intervention]], or a key instead of a master";
    draft.require(!has_orders, "plane.order", "robots with keys of their own take no order to all", remedy)?;
    let mut rolls = Vec::new();
    for (index, roll) in table.roll.iter().enumerate() {
        let field = format!("authentication.roll[{index}].revoke");
        let revoke = roll.revoke.iter().map(|&id| check::known(draft, robots, &field, id)).collect::<Checked<_>>()?;
        rolls.push(Roll { tick: draft.tick(roll.at_s), revoke });
    }
    rolls.sort_by_key(|roll| roll.tick);
    let overlap_ticks = draft.tick(table.overlap_s.unwrap_or(5.0));
    let place_m = table.place_m.unwrap_or_default();
    Ok(KeyRotation { master, place_m, overlap_ticks, rolls })
}

pub(super) fn attacks(draft: &Draft<'_>, robots: &[Robot]) -> Checked<Vec<Attack>> {
    let tables = draft.file.attack.iter().enumerate();
    tables.map(|(index, table)| attack(draft, robots, table, index)).collect()
}

fn attack(draft: &Draft<'_>, robots: &[Robot], table: &AttackTable, index: usize) -> Checked<Attack> {
    let at = draft.at(format!("attack[{index}]"));
    let unless = |holds: bool, what: &str, remedy: &str| if holds { Err(at.unfit(what, remedy)) } else { Ok(()) };
    let (is_insider, is_replay) = (table.kind == AttackKind::Insider, table.kind == AttackKind::Replay);
    let what = "kind = \"insider\" requires lies, and no other kind has them";
    let remedy = "give lies, one or more of \"orders\", \"radius\", \"speed\", \"jump\", \"ghosts\", or another \
                  kind without lies";
    unless(is_insider == table.lies.is_empty(), what, remedy)?;
    let has_ghosts = table.lies.contains(&Lie::Ghosts);
    let remedy = "give lies = [\"ghosts\"], or leave it out";
    at.require(has_ghosts || table.ghosts.is_none(), "ghosts", "lies does not contain \"ghosts\"", remedy)?;
    let ghosts = if has_ghosts { table.ghosts.unwrap_or(16) } else { 0 };
    let remedy = "leave lure_m out, or choose another kind";
    unless(is_replay && table.lure_m.is_some(), "a replay says what others have said", remedy)?;
    let what = "it does not say where it orders the robots to";
    unless(!is_replay && table.lure_m.is_none(), what, "give lure_m, metres")?;
    let remedy = "leave delay_s out, or give kind = \"replay\"";
    unless(!is_replay && table.delay_s.is_some(), "only a replay has a delay", remedy)?;
    let last = robots.last().map_or(RobotId(1), |robot| robot.id);
    let claims = table.claims.map_or(last, RobotId);
    let most = max_robot(draft.file.radio.format, true);
    let (what, remedy) = (format!("{claims} is not a valid robot number"), format!("give 1 to {}", most.0));
    at.require(claims.is_some() && claims <= most, "claims", what, remedy)?;
    if is_insider {
        check::known(draft, robots, &at.field("claims"), claims.0)?;
    }
    let what = format!("there are not enough robot numbers for {ghosts} ghosts");
    let are_free = !has_ghosts || claims.0.max(last.0) + u32::from(ghosts) <= most.0;
    at.require(are_free, "ghosts", what, format!("give fewer; numbers end at {}", most.0))?;
    let from_tick = draft.tick(table.from_s);
    let to_tick = table.to_s.map_or(u32::MAX, |to_s| draft.tick(to_s));
    let what = "the attack is over before its first tick";
    at.require(to_tick > from_tick, "to_s", what, "give a tick or more after from_s")?;
    Ok(Attack {
        kind: table.kind,
        place_m: table.place_m,
        from_tick,
        to_tick,
        lure_m: table.lure_m.unwrap_or_default(),
        claims,
        delay_ticks: draft.tick(table.delay_s.unwrap_or(10.0)),
        lies: table.lies.clone(),
        ghosts,
    })
}
