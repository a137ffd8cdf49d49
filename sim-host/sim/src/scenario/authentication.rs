//! `[authentication]` and `[[attack]]`: the swarm's key, and attackers.

use super::source::Source;
use super::{
    Attack, AttackKind, AttackTable, AuthenticationTable, KeyRotation, Lie, Robot, Roll, ScenarioError, ScenarioFile,
};
use crate::key::{self, KeyFile};
use crate::radio::PEERS;
use staya_controller::auth::{Key, Master};
use staya_controller::robot::RobotId;
use staya_controller::wire::Format;
use staya_mavlink::any::max_robot;
use std::path::Path;

pub(super) fn key(source: &Source<'_>, file: &ScenarioFile, robots: &[Robot]) -> Result<Option<Keys>, ScenarioError> {
    let Some(table) = &file.authentication else {
        return Ok(None);
    };
    let from_file = |field: &str, name: &Path| {
        let read = KeyFile::read(&source.file(name)).map_err(|error| {
            let remedy = "file names are relative to the scenario file";
            source.error(&format!("authentication.{field}"), error.to_string(), remedy)
        })?;
        Ok((read.key, read.remark))
    };
    let from_text = |field: &str, text: &str| {
        let key = key::parse(text).map_err(|(_, problem)| {
            let remedy = "give 64 hexadecimal digits, or \"passphrase: \" and words";
            source.error(&format!("authentication.{field}"), problem, remedy)
        })?;
        Ok((key, None))
    };
    let (found, has_master) = match (&table.key_file, &table.key, &table.master_file, &table.master) {
        (Some(name), None, None, None) => (from_file("key_file", name)?, false),
        (None, Some(text), None, None) => (from_text("key", text)?, false),
        (None, None, Some(name), None) => (from_file("master_file", name)?, true),
        (None, None, None, Some(text)) => (from_text("master", text)?, true),
        _ => {
            let remedy = "give exactly one of key_file, key, master_file, master";
            return Err(source.error("authentication", "it is not clear which key is meant", remedy));
        }
    };
    let keeping = if has_master { Some(keeping(source, file, table, robots, &found.0)?) } else { None };
    if keeping.is_none() && (!table.roll.is_empty() || table.overlap_s.is_some() || table.place_m.is_some()) {
        let remedy = "give master_file or master, or leave roll, overlap_s and place_m out";
        return Err(source.error("authentication", "only robots with a master key receive new keys", remedy));
    }
    // The operators take two more entries of the peer table.
    if robots.len() + 2 > PEERS {
        let problem = format!("{} robots do not fit into a robot's table of peers", robots.len());
        let remedy = format!("give at most {}, or leave this table out", PEERS - 2);
        return Err(source.error("authentication", problem, remedy));
    }
    let most = max_robot(file.radio.format, true);
    if let Some(robot) = robots.iter().find(|robot| robot.id > most) {
        let problem = format!("robot {} has no number in frames with a tag", robot.id.0);
        let remedy = format!("give numbers up to {}", most.0);
        return Err(source.error("authentication", problem, remedy));
    }
    let (key, remark) = found;
    let key = if has_master { Master::new(&key).seed(0).key(0) } else { key };
    Ok(Some(Keys { key, remark, rotation: keeping }))
}

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

fn keeping(
    source: &Source<'_>,
    file: &ScenarioFile,
    table: &AuthenticationTable,
    robots: &[Robot],
    master: &Key,
) -> Result<KeyRotation, ScenarioError> {
    if file.radio.format != Format::Postcard {
        let remedy = "give radio.format = \"postcard\", or a key instead of a master";
        return Err(source.error("authentication.master", "MAVLink's signatures have one key", remedy));
    }
    if file.plane.as_ref().is_some_and(|plane| !plane.order.is_empty()) {
        let remedy = "give each robot its goal by [[intervention]], or a key instead of a master";
        return Err(source.error("plane.order", "robots with keys of their own take no order to all", remedy));
    }
    let place_m = table.place_m.unwrap_or_default();
    let ticks = |seconds: f64| libm::ceil(seconds / file.tick_s) as u32;
    let mut rolls = Vec::new();
    for (index, roll) in table.roll.iter().enumerate() {
        let revoke: Vec<_> = roll.revoke.iter().map(|&number| RobotId(number)).collect();
        let stranger = revoke.iter().find(|id| robots.binary_search_by_key(*id, |robot| robot.id).is_err());
        if let Some(stranger) = stranger {
            let field = format!("authentication.roll[{index}].revoke");
            let remedy = "give numbers of robots of this scenario";
            return Err(source.error(&field, format!("there is no robot {stranger}"), remedy));
        }
        rolls.push(Roll { tick: ticks(roll.at_s), revoke });
    }
    rolls.sort_by_key(|roll| roll.tick);
    let overlap_ticks = ticks(table.overlap_s.unwrap_or(5.0));
    Ok(KeyRotation { master: master.clone(), place_m, overlap_ticks, rolls })
}

pub(super) fn attacks(
    source: &Source<'_>,
    file: &ScenarioFile,
    robots: &[Robot],
) -> Result<Vec<Attack>, ScenarioError> {
    let tables = file.attack.iter().enumerate();
    tables.map(|(index, table)| attack(source, file, robots, table, &format!("attack[{index}]"))).collect()
}

fn attack(
    source: &Source<'_>,
    file: &ScenarioFile,
    robots: &[Robot],
    table: &AttackTable,
    field: &str,
) -> Result<Attack, ScenarioError> {
    let is_insider = table.kind == AttackKind::Insider;
    if is_insider == table.lies.is_empty() {
        let remedy = "give lies, one or more of \"orders\", \"radius\", \"speed\", \"jump\", \"ghosts\", or another kind without lies";
        return Err(source.error(field, "kind = \"insider\" requires lies, and no other kind has them", remedy));
    }
    let has_ghosts = table.lies.contains(&Lie::Ghosts);
    if table.ghosts.is_some() && !has_ghosts {
        let what = "lies does not contain \"ghosts\"";
        return Err(source.error(&format!("{field}.ghosts"), what, "give lies = [\"ghosts\"], or leave it out"));
    }
    let ghosts = table.ghosts.unwrap_or(16);
    let lure_m = match (table.kind, table.lure_m, table.delay_s) {
        (AttackKind::Replay, None, _) => [0.0; 2],
        (AttackKind::Forge | AttackKind::Unsigned | AttackKind::Insider, Some(lure_m), None) => lure_m,
        (AttackKind::Replay, Some(_), _) => {
            let remedy = "leave lure_m out, or choose another kind";
            return Err(source.error(field, "a replay says what others have said", remedy));
        }
        (_, None, _) => {
            let remedy = "give lure_m, metres";
            return Err(source.error(field, "it does not say where it orders the robots to", remedy));
        }
        (_, _, Some(_)) => {
            let remedy = "leave delay_s out, or give kind = \"replay\"";
            return Err(source.error(field, "only a replay has a delay", remedy));
        }
    };
    let tick = |seconds: f64| libm::ceil(seconds / file.tick_s) as u32;
    let last = robots.last().map_or(RobotId(1), |robot| robot.id);
    let claims = table.claims.map_or(last, RobotId);
    let most = max_robot(file.radio.format, true);
    if !claims.is_some() || claims > most {
        let remedy = format!("give 1 to {}", most.0);
        return Err(source.error(&format!("{field}.claims"), format!("{claims} is not a valid robot number"), remedy));
    }
    if is_insider && robots.binary_search_by_key(&claims, |robot| robot.id).is_err() {
        let remedy = "give the number of a robot of this scenario";
        return Err(source.error(&format!("{field}.claims"), format!("there is no robot {claims} to take"), remedy));
    }
    if has_ghosts && claims.0.max(last.0) + u32::from(ghosts) > most.0 {
        let remedy = format!("give fewer; numbers end at {}", most.0);
        let what = format!("there are not enough robot numbers for {ghosts} ghosts");
        return Err(source.error(&format!("{field}.ghosts"), what, remedy));
    }
    let from_tick = tick(table.from_s);
    let to_tick = table.to_s.map_or(u32::MAX, tick);
    if to_tick <= from_tick {
        let remedy = "give a tick or more after from_s";
        return Err(source.error(&format!("{field}.to_s"), "the attack is over before its first tick", remedy));
    }
    Ok(Attack {
        kind: table.kind,
        place_m: table.place_m,
        from_tick,
        to_tick,
        lure_m,
        claims,
        delay_ticks: tick(table.delay_s.unwrap_or(10.0)),
        lies: table.lies.clone(),
        ghosts: if has_ghosts { ghosts } else { 0 },
    })
}
