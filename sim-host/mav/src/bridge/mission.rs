//! The mission of a vehicle: a list of goals, and the protocol that transfers it. As with
//! ArduPilot, item 0 is home: an uploaded one is ignored, and the list has it even without a
//! mission.

use core::ops::Range;
use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;

pub const ITEMS: u16 = 128;
pub(super) const MAV_MISSION_INVALID_PARAM2: u8 = 7;
const PATIENCE_US: u64 = 350_000;
const TRIES: u8 = 12;

/// A MAV_MISSION_RESULT, and its text for the operator.
pub type Refused = (u8, &'static str);

/// A mission item: 1e-7 degrees, or 1e-4 metres in local frames.
pub type Item = MISSION_ITEM_INT_DATA;
/// The same in degrees or metres.
type FloatItem = MISSION_ITEM_DATA;

const fn scale(frame: u8) -> f64 {
    match frame {
        MAV_FRAME_LOCAL_NED | MAV_FRAME_LOCAL_OFFSET_NED => 1e4,
        _ => 1e7,
    }
}

/// A position that is not finite becomes one that fails validation.
pub fn from_float(item: &FloatItem) -> Item {
    let int = |x: f32| if x.is_finite() { libm::round(f64::from(x) * scale(item.frame)) as i32 } else { i32::MAX };
    let [x, y] = [item.x, item.y].map(int);
    let FloatItem { param1, param2, param3, param4, z, seq, command, frame, current, autocontinue, .. } = *item;
    Item { param1, param2, param3, param4, x, y, z, seq, command, frame, current, autocontinue, ..Item::DEFAULT }
}

pub(super) fn to_float(item: Item) -> FloatItem {
    let [x, y] = [item.x, item.y].map(|x| (f64::from(x) / scale(item.frame)) as f32);
    let Item { param1, param2, param3, param4, z, seq, command, frame, current, autocontinue, .. } = item;
    let Item { target_system, target_component, mission_type, .. } = item;
    let to = FloatItem { target_system, target_component, mission_type, ..FloatItem::DEFAULT };
    FloatItem { param1, param2, param3, param4, x, y, z, seq, command, frame, current, autocontinue, ..to }
}

#[derive(Clone, Debug, PartialEq)]
struct Upload {
    from: Sender,
    /// Numbers of the items; all of a new mission, or some that replace those of the stored one.
    seqs: Range<u16>,
    is_whole: bool,
    items: Vec<Item>,
    asked_us: u64,
    tries: u8,
    /// Whether the last request was MISSION_REQUEST, which clients without MISSION_ITEM_INT know.
    asks_float: bool,
}

impl Upload {
    fn new(from: Sender, seqs: Range<u16>, is_whole: bool, now_us: u64) -> Self {
        Self { from, seqs, is_whole, items: Vec::new(), asked_us: now_us, tries: 1, asks_float: false }
    }

    fn next(&self) -> u16 {
        self.seqs.start + self.items.len() as u16
    }

    const fn request(&self, seq: u16) -> MavMessage {
        let (target_system, target_component) = (self.from.system, self.from.component);
        let mission_type = MAV_MISSION_TYPE_MISSION;
        if self.asks_float {
            MavMessage::MISSION_REQUEST(MISSION_REQUEST_DATA { seq, target_system, target_component, mission_type })
        } else {
            let asked = MISSION_REQUEST_INT_DATA { seq, target_system, target_component, mission_type };
            MavMessage::MISSION_REQUEST_INT(asked)
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mission {
    items: Vec<Item>,
    pub(super) current: u16,
    /// Whether the last item is completed, or started if it is a return.
    pub(super) is_complete: bool,
    upload: Option<Upload>,
    /// The client of the last upload, and its last item, which may arrive twice.
    done: Option<(Sender, u16)>,
}

impl Mission {
    pub fn len(&self) -> u16 {
        self.items.len() as u16
    }

    /// A mission with home alone is empty.
    pub fn is_empty(&self) -> bool {
        self.items.len() < 2
    }

    pub fn item(&self, seq: u16) -> Option<&Item> {
        self.items.get(usize::from(seq))
    }

    pub fn set_current(&mut self, seq: u16) -> bool {
        let is_there = seq < self.len();
        if is_there {
            (self.current, self.is_complete) = (seq, false);
        }
        is_there
    }

    /// Begins the upload of a mission. The error is a MAV_MISSION_RESULT with its text.
    pub fn count(&mut self, from: Sender, told: &MISSION_COUNT_DATA, now_us: u64) -> Result<MavMessage, Refused> {
        self.is_free(from, told.mission_type)?;
        if told.count > ITEMS {
            return Err((MAV_MISSION_NO_SPACE, "mission: at most 128 items"));
        }
        if told.count == 0 {
            return Ok(self.clear(from, MAV_MISSION_TYPE_MISSION));
        }
        Ok(self.begin(Upload::new(from, 0..told.count, true, now_us)))
    }

    /// Begins the replacement of some items.
    pub fn replace(
        &mut self,
        from: Sender,
        told: &MISSION_WRITE_PARTIAL_LIST_DATA,
        now_us: u64,
    ) -> Result<MavMessage, Refused> {
        self.is_free(from, told.mission_type)?;
        let seqs = u16::try_from(told.start_index).ok().zip(u16::try_from(told.end_index).ok());
        match seqs.filter(|(first, last)| first <= last && *last < self.len()) {
            Some((first, last)) => Ok(self.begin(Upload::new(from, first..last + 1, false, now_us))),
            None => Err((MAV_MISSION_INVALID_SEQUENCE, "mission: these items are not in the list")),
        }
    }

    fn is_free(&self, from: Sender, mission_type: u8) -> Result<(), Refused> {
        if let Some(text) = unsupported(mission_type) {
            return Err((MAV_MISSION_UNSUPPORTED, text));
        }
        if self.upload.as_ref().is_some_and(|upload| !same(upload.from, from)) {
            return Err((MAV_MISSION_DENIED, "mission: another client is uploading"));
        }
        Ok(())
    }

    fn begin(&mut self, upload: Upload) -> MavMessage {
        let request = upload.request(upload.seqs.start);
        (self.upload, self.done) = (Some(upload), None);
        request
    }

    /// Returns the answer to an uploaded item; `fault` returns a MAV_MISSION_RESULT, 0 if valid.
    /// An item that arrives twice has no answer, since it would double all later ones.
    pub fn take(
        &mut self,
        from: Sender,
        item: Item,
        now_us: u64,
        fault: impl FnOnce(&Item) -> u8,
    ) -> Option<MavMessage> {
        let end = |result| Some(ack(from, MAV_MISSION_TYPE_MISSION, result));
        let upload = self.upload.as_mut();
        let Some(upload) = upload.filter(|upload| same(upload.from, from)) else {
            let is_repeated = self.done.is_some_and(|(by, seq)| same(by, from) && seq == item.seq);
            return end(if is_repeated { MAV_MISSION_ACCEPTED } else { MAV_MISSION_INVALID_SEQUENCE });
        };
        let next = upload.next();
        if item.seq < next {
            return None;
        }
        if item.seq == next {
            // Home is never flown to, so it needs no validation.
            let fault = if item.seq == 0 { 0 } else { fault(&item) };
            if fault != 0 {
                self.upload = None;
                return end(fault);
            }
            upload.items.push(item);
        }
        let next = upload.next();
        if next < upload.seqs.end {
            (upload.asked_us, upload.tries) = (now_us, 1);
            return Some(upload.request(next));
        }
        let Upload { seqs, is_whole, items, .. } = self.upload.take()?;
        self.done = Some((from, seqs.end - 1));
        if is_whole {
            self.items = items;
            (self.current, self.is_complete) = (1.min(self.len() - 1), false);
        } else {
            self.items.splice(usize::from(seqs.start)..usize::from(seqs.end), items);
        }
        end(MAV_MISSION_ACCEPTED)
    }

    /// Repeats a request, in turn for both kinds of items until the client answers one.
    pub fn poll(&mut self, now_us: u64) -> Option<MavMessage> {
        let upload = self.upload.as_mut()?;
        if now_us.saturating_sub(upload.asked_us) < PATIENCE_US {
            return None;
        }
        let from = upload.from;
        if upload.tries >= TRIES {
            self.upload = None;
            return Some(ack(from, MAV_MISSION_TYPE_MISSION, MAV_MISSION_OPERATION_CANCELLED));
        }
        upload.tries += 1;
        upload.asked_us = now_us;
        upload.asks_float = !upload.asks_float;
        Some(upload.request(upload.next()))
    }

    /// Lists other than missions (fences, rally points) are empty.
    pub fn list(&self, from: Sender, mission_type: u8) -> MavMessage {
        let is_known = mission_type == MAV_MISSION_TYPE_MISSION;
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: if is_known { self.len().max(1) } else { 0 },
            target_system: from.system,
            target_component: from.component,
            mission_type,
        })
    }

    /// Returns an item of the list, which begins with `home`.
    pub fn tell(
        &self,
        from: Sender,
        home: Item,
        seq: u16,
        mission_type: u8,
        as_int: bool,
    ) -> Result<MavMessage, Refused> {
        let item = if seq == 0 { Some(&home) } else { self.item(seq) };
        let item = item.filter(|_| mission_type == MAV_MISSION_TYPE_MISSION);
        let item = item.ok_or((MAV_MISSION_INVALID_SEQUENCE, "mission: this item is not in the list"))?;
        let item = Item {
            seq,
            current: u8::from(seq == self.current),
            target_system: from.system,
            target_component: from.component,
            mission_type: MAV_MISSION_TYPE_MISSION,
            ..item.clone()
        };
        Ok(if as_int { MavMessage::MISSION_ITEM_INT(item) } else { MavMessage::MISSION_ITEM(to_float(item)) })
    }

    pub fn clear(&mut self, from: Sender, mission_type: u8) -> MavMessage {
        // 255 means all lists.
        if matches!(mission_type, MAV_MISSION_TYPE_MISSION | MAV_MISSION_TYPE_ALL) {
            *self = Self::default();
        }
        ack(from, mission_type, MAV_MISSION_ACCEPTED)
    }
}

const fn same(a: Sender, b: Sender) -> bool {
    a.system == b.system && a.component == b.component
}

/// The text for the operator about a list that vehicles do not have; `None` for missions.
const fn unsupported(mission_type: u8) -> Option<&'static str> {
    match mission_type {
        MAV_MISSION_TYPE_MISSION => None,
        MAV_MISSION_TYPE_FENCE => Some("geofences are unsupported: no fence is stored"),
        MAV_MISSION_TYPE_RALLY => Some("rally points are unsupported"),
        _ => Some("mission: unsupported kind of list"),
    }
}

pub const fn ack(to: Sender, mission_type: u8, result: u8) -> MavMessage {
    MavMessage::MISSION_ACK(MISSION_ACK_DATA {
        target_system: to.system,
        target_component: to.component,
        mavtype: result,
        mission_type,
    })
}

#[cfg(test)]
mod tests;
