//! The mission of a vehicle: a list of goals, and the protocol that transfers it. As with
//! ArduPilot, item 0 is home: it is stored but never flown to.

use staya_mavlink::constants::*;
use staya_mavlink::dialect::*;
use staya_mavlink::frame::Sender;

pub const ITEMS: u16 = 128;
pub(super) const MAV_MISSION_INVALID_PARAM2: u8 = 7;
const PATIENCE_US: u64 = 700_000;
const TRIES: u8 = 6;

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

fn to_float(item: Item) -> FloatItem {
    let [x, y] = [item.x, item.y].map(|x| (f64::from(x) / scale(item.frame)) as f32);
    let Item { param1, param2, param3, param4, z, seq, command, frame, current, autocontinue, .. } = item;
    let Item { target_system, target_component, mission_type, .. } = item;
    let to = FloatItem { target_system, target_component, mission_type, ..FloatItem::DEFAULT };
    FloatItem { param1, param2, param3, param4, x, y, z, seq, command, frame, current, autocontinue, ..to }
}

#[derive(Clone, Debug, PartialEq)]
struct Upload {
    from: Sender,
    count: u16,
    items: Vec<Item>,
    asked_us: u64,
    tries: u8,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mission {
    items: Vec<Item>,
    pub(super) current: u16,
    /// Whether the last item is completed, or started if it is a return.
    pub(super) is_complete: bool,
    upload: Option<Upload>,
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

    pub fn count(&mut self, from: Sender, told: &MISSION_COUNT_DATA, now_us: u64) -> MavMessage {
        if told.mission_type != MAV_MISSION_TYPE_MISSION {
            return ack(from, told.mission_type, MAV_MISSION_UNSUPPORTED);
        }
        if self.upload.as_ref().is_some_and(|upload| !same(upload.from, from)) {
            return ack(from, told.mission_type, MAV_MISSION_DENIED);
        }
        if told.count > ITEMS {
            return ack(from, told.mission_type, MAV_MISSION_NO_SPACE);
        }
        if told.count == 0 {
            return self.clear(from, MAV_MISSION_TYPE_MISSION);
        }
        self.upload = Some(Upload { from, count: told.count, items: Vec::new(), asked_us: now_us, tries: 1 });
        request(from, 0)
    }

    /// Returns the answer to an uploaded item; `fault` returns a MAV_MISSION_RESULT, 0 if valid.
    pub fn take(&mut self, from: Sender, item: Item, now_us: u64, fault: impl FnOnce(&Item) -> u8) -> MavMessage {
        let upload = self.upload.as_mut();
        let Some(upload) = upload.filter(|upload| same(upload.from, from)) else {
            return ack(from, MAV_MISSION_TYPE_MISSION, MAV_MISSION_INVALID_SEQUENCE);
        };
        let next = upload.items.len() as u16;
        if item.seq == next {
            // Home is never flown to, so it needs no validation.
            let fault = if item.seq == 0 { 0 } else { fault(&item) };
            if fault != 0 {
                self.upload = None;
                return ack(from, MAV_MISSION_TYPE_MISSION, fault);
            }
            upload.items.push(item);
        }
        let next = upload.items.len() as u16;
        if next < upload.count {
            // A repeated item is answered too: the request for the next one may have been lost.
            (upload.asked_us, upload.tries) = (now_us, 1);
            return request(from, next);
        }
        self.items = core::mem::take(&mut upload.items);
        self.upload = None;
        (self.current, self.is_complete) = (1.min(self.len() - 1), false);
        ack(from, MAV_MISSION_TYPE_MISSION, MAV_MISSION_ACCEPTED)
    }

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
        Some(request(from, upload.items.len() as u16))
    }

    /// Lists other than missions (fences, rally points) are empty.
    pub fn list(&self, from: Sender, mission_type: u8) -> MavMessage {
        let is_known = mission_type == MAV_MISSION_TYPE_MISSION;
        MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
            count: if is_known { self.len() } else { 0 },
            target_system: from.system,
            target_component: from.component,
            mission_type,
        })
    }

    pub fn tell(&self, from: Sender, seq: u16, mission_type: u8, as_int: bool) -> MavMessage {
        let item = self.item(seq);
        let Some(item) = item.filter(|_| mission_type == MAV_MISSION_TYPE_MISSION) else {
            return ack(from, mission_type, MAV_MISSION_INVALID_SEQUENCE);
        };
        let item = Item {
            seq,
            current: u8::from(seq == self.current),
            target_system: from.system,
            target_component: from.component,
            mission_type: MAV_MISSION_TYPE_MISSION,
            ..item.clone()
        };
        if as_int { MavMessage::MISSION_ITEM_INT(item) } else { MavMessage::MISSION_ITEM(to_float(item)) }
    }

    pub fn clear(&mut self, from: Sender, mission_type: u8) -> MavMessage {
        // 255 means all lists.
        if matches!(mission_type, MAV_MISSION_TYPE_MISSION | 255) {
            *self = Self::default();
        }
        ack(from, mission_type, MAV_MISSION_ACCEPTED)
    }
}

const fn same(a: Sender, b: Sender) -> bool {
    a.system == b.system && a.component == b.component
}

const fn request(to: Sender, seq: u16) -> MavMessage {
    MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
        seq,
        target_system: to.system,
        target_component: to.component,
        mission_type: MAV_MISSION_TYPE_MISSION,
    })
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
mod tests {
    use super::*;

    const GCS: Sender = Sender { system: 255, component: 190, sequence: 0 };

    fn count(count: u16) -> MISSION_COUNT_DATA {
        MISSION_COUNT_DATA { count, ..MISSION_COUNT_DATA::DEFAULT }
    }

    fn item(x: i32) -> Item {
        Item { command: MAV_CMD_NAV_WAYPOINT, x, ..Item::DEFAULT }
    }

    /// The requested item, or the negative result if the transfer ended.
    fn wanted(answer: &MavMessage) -> i32 {
        match answer {
            MavMessage::MISSION_REQUEST_INT(request) => request.seq.into(),
            MavMessage::MISSION_ACK(ack) => -i32::from(ack.mavtype) - 1,
            other => panic!("{other:?}"),
        }
    }

    fn ended(result: u8) -> i32 {
        -i32::from(result) - 1
    }

    fn give(mission: &mut Mission, seq: u16) -> i32 {
        wanted(&mission.take(GCS, Item { seq, ..item(seq.into()) }, 0, |_| 0))
    }

    #[test]
    fn an_uploaded_mission_reads_back_unchanged() {
        let mut mission = Mission::default();
        assert_eq!(wanted(&mission.count(GCS, &count(3), 0)), 0);
        assert_eq!(give(&mut mission, 0), 1);
        assert_eq!(give(&mut mission, 0), 1, "doubled");
        assert_eq!(give(&mut mission, 2), 1, "too early");
        assert_eq!(give(&mut mission, 1), 2);
        assert!(mission.is_empty(), "the mission is replaced only after its last item");
        assert_eq!(give(&mut mission, 2), ended(MAV_MISSION_ACCEPTED));
        assert_eq!((mission.len(), mission.current), (3, 1));
        assert_eq!(give(&mut mission, 2), ended(MAV_MISSION_INVALID_SEQUENCE));
        let MavMessage::MISSION_ITEM_INT(told) = mission.tell(GCS, 2, 0, true) else {
            panic!("an item");
        };
        assert_eq!((told.x, told.seq, told.current), (2, 2, 0));
        assert_eq!(wanted(&mission.tell(GCS, 3, 0, true)), ended(MAV_MISSION_INVALID_SEQUENCE));
        assert!(mission.set_current(2) && !mission.set_current(3));
        let _ = mission.clear(GCS, 0);
        assert_eq!(mission, Mission::default());
    }

    #[test]
    fn a_missing_item_is_requested_again_until_the_upload_fails() {
        let mut mission = Mission::default();
        let _ = mission.count(GCS, &count(2), 0);
        assert_eq!(mission.poll(PATIENCE_US - 1), None);
        let mut now = 0;
        for _ in 1..TRIES {
            now += PATIENCE_US;
            assert_eq!(mission.poll(now).as_ref().map(wanted), Some(0));
        }
        now += PATIENCE_US;
        let cancelled = Some(ended(MAV_MISSION_OPERATION_CANCELLED));
        assert_eq!(mission.poll(now).as_ref().map(wanted), cancelled);
        assert_eq!(mission.poll(now + PATIENCE_US), None);
    }

    #[test]
    fn uploads_that_are_too_long_or_invalid_or_from_another_client_are_refused() {
        let mut mission = Mission::default();
        let fences = MISSION_COUNT_DATA { mission_type: 1, ..count(2) };
        let refused = ended(MAV_MISSION_UNSUPPORTED);
        assert_eq!(wanted(&mission.count(GCS, &fences, 0)), refused);
        let refused = ended(MAV_MISSION_NO_SPACE);
        assert_eq!(wanted(&mission.count(GCS, &count(ITEMS + 1), 0)), refused);
        assert_eq!(wanted(&mission.count(GCS, &count(ITEMS), 0)), 0);
        let other = Sender { system: 254, ..GCS };
        let refused = ended(MAV_MISSION_DENIED);
        assert_eq!(wanted(&mission.count(other, &count(2), 0)), refused);
        let taken = mission.take(other, item(0), 0, |_| 0);
        assert_eq!(wanted(&taken), ended(MAV_MISSION_INVALID_SEQUENCE));
        assert_eq!(wanted(&mission.count(GCS, &count(2), 0)), 0);
        let home = mission.take(GCS, item(0), 0, |_| MAV_MISSION_UNSUPPORTED);
        assert_eq!(wanted(&home), 1, "home may be anything");
        let bad = mission.take(GCS, Item { seq: 1, ..item(1) }, 0, |_| MAV_MISSION_UNSUPPORTED);
        assert_eq!(wanted(&bad), ended(MAV_MISSION_UNSUPPORTED));
        assert_eq!(mission, Mission::default());
    }

    #[test]
    fn both_item_messages_describe_the_same_item() {
        for (frame, x) in [(MAV_FRAME_GLOBAL, 12.5), (MAV_FRAME_LOCAL_NED, -3.25)] {
            let float = MISSION_ITEM_DATA { frame, x, y: 7.0, z: 1.5, seq: 4, ..MISSION_ITEM_DATA::DEFAULT };
            let kept = from_float(&float);
            assert_eq!(kept.y, (7.0 * scale(frame)) as i32);
            let back = to_float(kept);
            assert_eq!((back.x, back.y, back.z, back.seq), (x, 7.0, 1.5, 4));
        }
        let nonsense = MISSION_ITEM_DATA { x: f32::NAN, ..MISSION_ITEM_DATA::DEFAULT };
        assert_eq!(from_float(&nonsense).x, i32::MAX);
    }
}
