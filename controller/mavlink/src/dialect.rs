//!MAVLink staya dialect.
//!
//!This file was automatically generated, do not edit.
#![allow(deprecated)]
#![allow(clippy::match_single_binding)]
#![allow(rustdoc::broken_intra_doc_links)]
#[allow(unused_imports)]
use mavlink_core::{
    MavlinkVersion, Message, MessageData, bytes::Bytes, bytes_mut::BytesMut,
    types::CharArray,
};
///As in the public common dialect.
///
///ID: 30
#[derive(Debug, Clone, PartialEq)]
pub struct ATTITUDE_DATA {
    pub time_boot_ms: u32,
    pub roll: f32,
    pub pitch: f32,
    pub yaw: f32,
    pub rollspeed: f32,
    pub pitchspeed: f32,
    pub yawspeed: f32,
}
impl ATTITUDE_DATA {
    pub const ENCODED_LEN: usize = 28usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        roll: 0.0_f32,
        pitch: 0.0_f32,
        yaw: 0.0_f32,
        rollspeed: 0.0_f32,
        pitchspeed: 0.0_f32,
        yawspeed: 0.0_f32,
    };
}
impl Default for ATTITUDE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for ATTITUDE_DATA {
    type Message = MavMessage;
    const ID: u32 = 30u32;
    const NAME: &'static str = "ATTITUDE";
    const EXTRA_CRC: u8 = 39u8;
    const ENCODED_LEN: usize = 28usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.roll = buf.get_f32_le()?;
        __struct.pitch = buf.get_f32_le()?;
        __struct.yaw = buf.get_f32_le()?;
        __struct.rollspeed = buf.get_f32_le()?;
        __struct.pitchspeed = buf.get_f32_le()?;
        __struct.yawspeed = buf.get_f32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.roll);
        __tmp.put_f32_le(self.pitch);
        __tmp.put_f32_le(self.yaw);
        __tmp.put_f32_le(self.rollspeed);
        __tmp.put_f32_le(self.pitchspeed);
        __tmp.put_f32_le(self.yawspeed);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 148
#[derive(Debug, Clone, PartialEq)]
pub struct AUTOPILOT_VERSION_DATA {
    pub capabilities: u64,
    pub uid: u64,
    pub flight_sw_version: u32,
    pub middleware_sw_version: u32,
    pub os_sw_version: u32,
    pub board_version: u32,
    pub vendor_id: u16,
    pub product_id: u16,
    pub flight_custom_version: [u8; 8],
    pub middleware_custom_version: [u8; 8],
    pub os_custom_version: [u8; 8],
    pub uid2: [u8; 18],
}
impl AUTOPILOT_VERSION_DATA {
    pub const ENCODED_LEN: usize = 78usize;
    pub const DEFAULT: Self = Self {
        capabilities: 0_u64,
        uid: 0_u64,
        flight_sw_version: 0_u32,
        middleware_sw_version: 0_u32,
        os_sw_version: 0_u32,
        board_version: 0_u32,
        vendor_id: 0_u16,
        product_id: 0_u16,
        flight_custom_version: [0_u8; 8usize],
        middleware_custom_version: [0_u8; 8usize],
        os_custom_version: [0_u8; 8usize],
        uid2: [0_u8; 18usize],
    };
}
impl Default for AUTOPILOT_VERSION_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for AUTOPILOT_VERSION_DATA {
    type Message = MavMessage;
    const ID: u32 = 148u32;
    const NAME: &'static str = "AUTOPILOT_VERSION";
    const EXTRA_CRC: u8 = 178u8;
    const ENCODED_LEN: usize = 78usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.capabilities = buf.get_u64_le()?;
        __struct.uid = buf.get_u64_le()?;
        __struct.flight_sw_version = buf.get_u32_le()?;
        __struct.middleware_sw_version = buf.get_u32_le()?;
        __struct.os_sw_version = buf.get_u32_le()?;
        __struct.board_version = buf.get_u32_le()?;
        __struct.vendor_id = buf.get_u16_le()?;
        __struct.product_id = buf.get_u16_le()?;
        for v in &mut __struct.flight_custom_version {
            let val = buf.get_u8()?;
            *v = val;
        }
        for v in &mut __struct.middleware_custom_version {
            let val = buf.get_u8()?;
            *v = val;
        }
        for v in &mut __struct.os_custom_version {
            let val = buf.get_u8()?;
            *v = val;
        }
        for v in &mut __struct.uid2 {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.capabilities);
        __tmp.put_u64_le(self.uid);
        __tmp.put_u32_le(self.flight_sw_version);
        __tmp.put_u32_le(self.middleware_sw_version);
        __tmp.put_u32_le(self.os_sw_version);
        __tmp.put_u32_le(self.board_version);
        __tmp.put_u16_le(self.vendor_id);
        __tmp.put_u16_le(self.product_id);
        for val in &self.flight_custom_version {
            __tmp.put_u8(*val);
        }
        for val in &self.middleware_custom_version {
            __tmp.put_u8(*val);
        }
        for val in &self.os_custom_version {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            for val in &self.uid2 {
                __tmp.put_u8(*val);
            }
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 147
#[derive(Debug, Clone, PartialEq)]
pub struct BATTERY_STATUS_DATA {
    pub current_consumed: i32,
    pub energy_consumed: i32,
    pub temperature: i16,
    pub voltages: [u16; 10],
    pub current_battery: i16,
    pub id: u8,
    pub battery_function: u8,
    pub mavtype: u8,
    pub battery_remaining: i8,
    pub time_remaining: i32,
    pub charge_state: u8,
    pub voltages_ext: [u16; 4],
    pub mode: u8,
    pub fault_bitmask: u32,
}
impl BATTERY_STATUS_DATA {
    pub const ENCODED_LEN: usize = 54usize;
    pub const DEFAULT: Self = Self {
        current_consumed: 0_i32,
        energy_consumed: 0_i32,
        temperature: 0_i16,
        voltages: [0_u16; 10usize],
        current_battery: 0_i16,
        id: 0_u8,
        battery_function: 0_u8,
        mavtype: 0_u8,
        battery_remaining: 0_i8,
        time_remaining: 0_i32,
        charge_state: 0_u8,
        voltages_ext: [0_u16; 4usize],
        mode: 0_u8,
        fault_bitmask: 0_u32,
    };
}
impl Default for BATTERY_STATUS_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for BATTERY_STATUS_DATA {
    type Message = MavMessage;
    const ID: u32 = 147u32;
    const NAME: &'static str = "BATTERY_STATUS";
    const EXTRA_CRC: u8 = 154u8;
    const ENCODED_LEN: usize = 54usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.current_consumed = buf.get_i32_le()?;
        __struct.energy_consumed = buf.get_i32_le()?;
        __struct.temperature = buf.get_i16_le()?;
        for v in &mut __struct.voltages {
            let val = buf.get_u16_le()?;
            *v = val;
        }
        __struct.current_battery = buf.get_i16_le()?;
        __struct.id = buf.get_u8()?;
        __struct.battery_function = buf.get_u8()?;
        __struct.mavtype = buf.get_u8()?;
        __struct.battery_remaining = buf.get_i8()?;
        __struct.time_remaining = buf.get_i32_le()?;
        __struct.charge_state = buf.get_u8()?;
        for v in &mut __struct.voltages_ext {
            let val = buf.get_u16_le()?;
            *v = val;
        }
        __struct.mode = buf.get_u8()?;
        __struct.fault_bitmask = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.current_consumed);
        __tmp.put_i32_le(self.energy_consumed);
        __tmp.put_i16_le(self.temperature);
        for val in &self.voltages {
            __tmp.put_u16_le(*val);
        }
        __tmp.put_i16_le(self.current_battery);
        __tmp.put_u8(self.id);
        __tmp.put_u8(self.battery_function);
        __tmp.put_u8(self.mavtype);
        __tmp.put_i8(self.battery_remaining);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_i32_le(self.time_remaining);
            __tmp.put_u8(self.charge_state);
            for val in &self.voltages_ext {
                __tmp.put_u16_le(*val);
            }
            __tmp.put_u8(self.mode);
            __tmp.put_u32_le(self.fault_bitmask);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 77
#[derive(Debug, Clone, PartialEq)]
pub struct COMMAND_ACK_DATA {
    pub command: u16,
    pub result: u8,
    pub progress: u8,
    pub result_param2: i32,
    pub target_system: u8,
    pub target_component: u8,
}
impl COMMAND_ACK_DATA {
    pub const ENCODED_LEN: usize = 10usize;
    pub const DEFAULT: Self = Self {
        command: 0_u16,
        result: 0_u8,
        progress: 0_u8,
        result_param2: 0_i32,
        target_system: 0_u8,
        target_component: 0_u8,
    };
}
impl Default for COMMAND_ACK_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMMAND_ACK_DATA {
    type Message = MavMessage;
    const ID: u32 = 77u32;
    const NAME: &'static str = "COMMAND_ACK";
    const EXTRA_CRC: u8 = 143u8;
    const ENCODED_LEN: usize = 10usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.command = buf.get_u16_le()?;
        __struct.result = buf.get_u8()?;
        __struct.progress = buf.get_u8()?;
        __struct.result_param2 = buf.get_i32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.result);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.progress);
            __tmp.put_i32_le(self.result_param2);
            __tmp.put_u8(self.target_system);
            __tmp.put_u8(self.target_component);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 75
#[derive(Debug, Clone, PartialEq)]
pub struct COMMAND_INT_DATA {
    pub param1: f32,
    pub param2: f32,
    pub param3: f32,
    pub param4: f32,
    pub x: i32,
    pub y: i32,
    pub z: f32,
    pub command: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub frame: u8,
    pub current: u8,
    pub autocontinue: u8,
}
impl COMMAND_INT_DATA {
    pub const ENCODED_LEN: usize = 35usize;
    pub const DEFAULT: Self = Self {
        param1: 0.0_f32,
        param2: 0.0_f32,
        param3: 0.0_f32,
        param4: 0.0_f32,
        x: 0_i32,
        y: 0_i32,
        z: 0.0_f32,
        command: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        frame: 0_u8,
        current: 0_u8,
        autocontinue: 0_u8,
    };
}
impl Default for COMMAND_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMMAND_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 75u32;
    const NAME: &'static str = "COMMAND_INT";
    const EXTRA_CRC: u8 = 158u8;
    const ENCODED_LEN: usize = 35usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param1 = buf.get_f32_le()?;
        __struct.param2 = buf.get_f32_le()?;
        __struct.param3 = buf.get_f32_le()?;
        __struct.param4 = buf.get_f32_le()?;
        __struct.x = buf.get_i32_le()?;
        __struct.y = buf.get_i32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.command = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.frame = buf.get_u8()?;
        __struct.current = buf.get_u8()?;
        __struct.autocontinue = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param1);
        __tmp.put_f32_le(self.param2);
        __tmp.put_f32_le(self.param3);
        __tmp.put_f32_le(self.param4);
        __tmp.put_i32_le(self.x);
        __tmp.put_i32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.frame);
        __tmp.put_u8(self.current);
        __tmp.put_u8(self.autocontinue);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 76
#[derive(Debug, Clone, PartialEq)]
pub struct COMMAND_LONG_DATA {
    pub param1: f32,
    pub param2: f32,
    pub param3: f32,
    pub param4: f32,
    pub param5: f32,
    pub param6: f32,
    pub param7: f32,
    pub command: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub confirmation: u8,
}
impl COMMAND_LONG_DATA {
    pub const ENCODED_LEN: usize = 33usize;
    pub const DEFAULT: Self = Self {
        param1: 0.0_f32,
        param2: 0.0_f32,
        param3: 0.0_f32,
        param4: 0.0_f32,
        param5: 0.0_f32,
        param6: 0.0_f32,
        param7: 0.0_f32,
        command: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        confirmation: 0_u8,
    };
}
impl Default for COMMAND_LONG_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMMAND_LONG_DATA {
    type Message = MavMessage;
    const ID: u32 = 76u32;
    const NAME: &'static str = "COMMAND_LONG";
    const EXTRA_CRC: u8 = 152u8;
    const ENCODED_LEN: usize = 33usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param1 = buf.get_f32_le()?;
        __struct.param2 = buf.get_f32_le()?;
        __struct.param3 = buf.get_f32_le()?;
        __struct.param4 = buf.get_f32_le()?;
        __struct.param5 = buf.get_f32_le()?;
        __struct.param6 = buf.get_f32_le()?;
        __struct.param7 = buf.get_f32_le()?;
        __struct.command = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.confirmation = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param1);
        __tmp.put_f32_le(self.param2);
        __tmp.put_f32_le(self.param3);
        __tmp.put_f32_le(self.param4);
        __tmp.put_f32_le(self.param5);
        __tmp.put_f32_le(self.param6);
        __tmp.put_f32_le(self.param7);
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.confirmation);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public ardupilotmega dialect.
///
///ID: 193
#[derive(Debug, Clone, PartialEq)]
pub struct EKF_STATUS_REPORT_DATA {
    pub velocity_variance: f32,
    pub pos_horiz_variance: f32,
    pub pos_vert_variance: f32,
    pub compass_variance: f32,
    pub terrain_alt_variance: f32,
    pub flags: u16,
    pub airspeed_variance: f32,
}
impl EKF_STATUS_REPORT_DATA {
    pub const ENCODED_LEN: usize = 26usize;
    pub const DEFAULT: Self = Self {
        velocity_variance: 0.0_f32,
        pos_horiz_variance: 0.0_f32,
        pos_vert_variance: 0.0_f32,
        compass_variance: 0.0_f32,
        terrain_alt_variance: 0.0_f32,
        flags: 0_u16,
        airspeed_variance: 0.0_f32,
    };
}
impl Default for EKF_STATUS_REPORT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for EKF_STATUS_REPORT_DATA {
    type Message = MavMessage;
    const ID: u32 = 193u32;
    const NAME: &'static str = "EKF_STATUS_REPORT";
    const EXTRA_CRC: u8 = 71u8;
    const ENCODED_LEN: usize = 26usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.velocity_variance = buf.get_f32_le()?;
        __struct.pos_horiz_variance = buf.get_f32_le()?;
        __struct.pos_vert_variance = buf.get_f32_le()?;
        __struct.compass_variance = buf.get_f32_le()?;
        __struct.terrain_alt_variance = buf.get_f32_le()?;
        __struct.flags = buf.get_u16_le()?;
        __struct.airspeed_variance = buf.get_f32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.velocity_variance);
        __tmp.put_f32_le(self.pos_horiz_variance);
        __tmp.put_f32_le(self.pos_vert_variance);
        __tmp.put_f32_le(self.compass_variance);
        __tmp.put_f32_le(self.terrain_alt_variance);
        __tmp.put_u16_le(self.flags);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_f32_le(self.airspeed_variance);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 230
#[derive(Debug, Clone, PartialEq)]
pub struct ESTIMATOR_STATUS_DATA {
    pub time_usec: u64,
    pub vel_ratio: f32,
    pub pos_horiz_ratio: f32,
    pub pos_vert_ratio: f32,
    pub mag_ratio: f32,
    pub hagl_ratio: f32,
    pub tas_ratio: f32,
    pub pos_horiz_accuracy: f32,
    pub pos_vert_accuracy: f32,
    pub flags: u16,
}
impl ESTIMATOR_STATUS_DATA {
    pub const ENCODED_LEN: usize = 42usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        vel_ratio: 0.0_f32,
        pos_horiz_ratio: 0.0_f32,
        pos_vert_ratio: 0.0_f32,
        mag_ratio: 0.0_f32,
        hagl_ratio: 0.0_f32,
        tas_ratio: 0.0_f32,
        pos_horiz_accuracy: 0.0_f32,
        pos_vert_accuracy: 0.0_f32,
        flags: 0_u16,
    };
}
impl Default for ESTIMATOR_STATUS_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for ESTIMATOR_STATUS_DATA {
    type Message = MavMessage;
    const ID: u32 = 230u32;
    const NAME: &'static str = "ESTIMATOR_STATUS";
    const EXTRA_CRC: u8 = 163u8;
    const ENCODED_LEN: usize = 42usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.vel_ratio = buf.get_f32_le()?;
        __struct.pos_horiz_ratio = buf.get_f32_le()?;
        __struct.pos_vert_ratio = buf.get_f32_le()?;
        __struct.mag_ratio = buf.get_f32_le()?;
        __struct.hagl_ratio = buf.get_f32_le()?;
        __struct.tas_ratio = buf.get_f32_le()?;
        __struct.pos_horiz_accuracy = buf.get_f32_le()?;
        __struct.pos_vert_accuracy = buf.get_f32_le()?;
        __struct.flags = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_f32_le(self.vel_ratio);
        __tmp.put_f32_le(self.pos_horiz_ratio);
        __tmp.put_f32_le(self.pos_vert_ratio);
        __tmp.put_f32_le(self.mag_ratio);
        __tmp.put_f32_le(self.hagl_ratio);
        __tmp.put_f32_le(self.tas_ratio);
        __tmp.put_f32_le(self.pos_horiz_accuracy);
        __tmp.put_f32_le(self.pos_vert_accuracy);
        __tmp.put_u16_le(self.flags);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 245
#[derive(Debug, Clone, PartialEq)]
pub struct EXTENDED_SYS_STATE_DATA {
    pub vtol_state: u8,
    pub landed_state: u8,
}
impl EXTENDED_SYS_STATE_DATA {
    pub const ENCODED_LEN: usize = 2usize;
    pub const DEFAULT: Self = Self {
        vtol_state: 0_u8,
        landed_state: 0_u8,
    };
}
impl Default for EXTENDED_SYS_STATE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for EXTENDED_SYS_STATE_DATA {
    type Message = MavMessage;
    const ID: u32 = 245u32;
    const NAME: &'static str = "EXTENDED_SYS_STATE";
    const EXTRA_CRC: u8 = 130u8;
    const ENCODED_LEN: usize = 2usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.vtol_state = buf.get_u8()?;
        __struct.landed_state = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.vtol_state);
        __tmp.put_u8(self.landed_state);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 110
#[derive(Debug, Clone, PartialEq)]
pub struct FILE_TRANSFER_PROTOCOL_DATA {
    pub target_network: u8,
    pub target_system: u8,
    pub target_component: u8,
    pub payload: [u8; 251],
}
impl FILE_TRANSFER_PROTOCOL_DATA {
    pub const ENCODED_LEN: usize = 254usize;
    pub const DEFAULT: Self = Self {
        target_network: 0_u8,
        target_system: 0_u8,
        target_component: 0_u8,
        payload: [0_u8; 251usize],
    };
}
impl Default for FILE_TRANSFER_PROTOCOL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for FILE_TRANSFER_PROTOCOL_DATA {
    type Message = MavMessage;
    const ID: u32 = 110u32;
    const NAME: &'static str = "FILE_TRANSFER_PROTOCOL";
    const EXTRA_CRC: u8 = 84u8;
    const ENCODED_LEN: usize = 254usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.target_network = buf.get_u8()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        for v in &mut __struct.payload {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.target_network);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.payload {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 33
#[derive(Debug, Clone, PartialEq)]
pub struct GLOBAL_POSITION_INT_DATA {
    pub time_boot_ms: u32,
    pub lat: i32,
    pub lon: i32,
    pub alt: i32,
    pub relative_alt: i32,
    pub vx: i16,
    pub vy: i16,
    pub vz: i16,
    pub hdg: u16,
}
impl GLOBAL_POSITION_INT_DATA {
    pub const ENCODED_LEN: usize = 28usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        lat: 0_i32,
        lon: 0_i32,
        alt: 0_i32,
        relative_alt: 0_i32,
        vx: 0_i16,
        vy: 0_i16,
        vz: 0_i16,
        hdg: 0_u16,
    };
}
impl Default for GLOBAL_POSITION_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for GLOBAL_POSITION_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 33u32;
    const NAME: &'static str = "GLOBAL_POSITION_INT";
    const EXTRA_CRC: u8 = 104u8;
    const ENCODED_LEN: usize = 28usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.lat = buf.get_i32_le()?;
        __struct.lon = buf.get_i32_le()?;
        __struct.alt = buf.get_i32_le()?;
        __struct.relative_alt = buf.get_i32_le()?;
        __struct.vx = buf.get_i16_le()?;
        __struct.vy = buf.get_i16_le()?;
        __struct.vz = buf.get_i16_le()?;
        __struct.hdg = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_i32_le(self.lat);
        __tmp.put_i32_le(self.lon);
        __tmp.put_i32_le(self.alt);
        __tmp.put_i32_le(self.relative_alt);
        __tmp.put_i16_le(self.vx);
        __tmp.put_i16_le(self.vy);
        __tmp.put_i16_le(self.vz);
        __tmp.put_u16_le(self.hdg);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 124
#[derive(Debug, Clone, PartialEq)]
pub struct GPS2_RAW_DATA {
    pub time_usec: u64,
    pub lat: i32,
    pub lon: i32,
    pub alt: i32,
    pub dgps_age: u32,
    pub eph: u16,
    pub epv: u16,
    pub vel: u16,
    pub cog: u16,
    pub fix_type: u8,
    pub satellites_visible: u8,
    pub dgps_numch: u8,
    pub yaw: u16,
    pub alt_ellipsoid: i32,
    pub h_acc: u32,
    pub v_acc: u32,
    pub vel_acc: u32,
    pub hdg_acc: u32,
}
impl GPS2_RAW_DATA {
    pub const ENCODED_LEN: usize = 57usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        lat: 0_i32,
        lon: 0_i32,
        alt: 0_i32,
        dgps_age: 0_u32,
        eph: 0_u16,
        epv: 0_u16,
        vel: 0_u16,
        cog: 0_u16,
        fix_type: 0_u8,
        satellites_visible: 0_u8,
        dgps_numch: 0_u8,
        yaw: 0_u16,
        alt_ellipsoid: 0_i32,
        h_acc: 0_u32,
        v_acc: 0_u32,
        vel_acc: 0_u32,
        hdg_acc: 0_u32,
    };
}
impl Default for GPS2_RAW_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for GPS2_RAW_DATA {
    type Message = MavMessage;
    const ID: u32 = 124u32;
    const NAME: &'static str = "GPS2_RAW";
    const EXTRA_CRC: u8 = 87u8;
    const ENCODED_LEN: usize = 57usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.lat = buf.get_i32_le()?;
        __struct.lon = buf.get_i32_le()?;
        __struct.alt = buf.get_i32_le()?;
        __struct.dgps_age = buf.get_u32_le()?;
        __struct.eph = buf.get_u16_le()?;
        __struct.epv = buf.get_u16_le()?;
        __struct.vel = buf.get_u16_le()?;
        __struct.cog = buf.get_u16_le()?;
        __struct.fix_type = buf.get_u8()?;
        __struct.satellites_visible = buf.get_u8()?;
        __struct.dgps_numch = buf.get_u8()?;
        __struct.yaw = buf.get_u16_le()?;
        __struct.alt_ellipsoid = buf.get_i32_le()?;
        __struct.h_acc = buf.get_u32_le()?;
        __struct.v_acc = buf.get_u32_le()?;
        __struct.vel_acc = buf.get_u32_le()?;
        __struct.hdg_acc = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_i32_le(self.lat);
        __tmp.put_i32_le(self.lon);
        __tmp.put_i32_le(self.alt);
        __tmp.put_u32_le(self.dgps_age);
        __tmp.put_u16_le(self.eph);
        __tmp.put_u16_le(self.epv);
        __tmp.put_u16_le(self.vel);
        __tmp.put_u16_le(self.cog);
        __tmp.put_u8(self.fix_type);
        __tmp.put_u8(self.satellites_visible);
        __tmp.put_u8(self.dgps_numch);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u16_le(self.yaw);
            __tmp.put_i32_le(self.alt_ellipsoid);
            __tmp.put_u32_le(self.h_acc);
            __tmp.put_u32_le(self.v_acc);
            __tmp.put_u32_le(self.vel_acc);
            __tmp.put_u32_le(self.hdg_acc);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 49
#[derive(Debug, Clone, PartialEq)]
pub struct GPS_GLOBAL_ORIGIN_DATA {
    pub latitude: i32,
    pub longitude: i32,
    pub altitude: i32,
    pub time_usec: u64,
}
impl GPS_GLOBAL_ORIGIN_DATA {
    pub const ENCODED_LEN: usize = 20usize;
    pub const DEFAULT: Self = Self {
        latitude: 0_i32,
        longitude: 0_i32,
        altitude: 0_i32,
        time_usec: 0_u64,
    };
}
impl Default for GPS_GLOBAL_ORIGIN_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for GPS_GLOBAL_ORIGIN_DATA {
    type Message = MavMessage;
    const ID: u32 = 49u32;
    const NAME: &'static str = "GPS_GLOBAL_ORIGIN";
    const EXTRA_CRC: u8 = 39u8;
    const ENCODED_LEN: usize = 20usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.latitude = buf.get_i32_le()?;
        __struct.longitude = buf.get_i32_le()?;
        __struct.altitude = buf.get_i32_le()?;
        __struct.time_usec = buf.get_u64_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.latitude);
        __tmp.put_i32_le(self.longitude);
        __tmp.put_i32_le(self.altitude);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u64_le(self.time_usec);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 24
#[derive(Debug, Clone, PartialEq)]
pub struct GPS_RAW_INT_DATA {
    pub time_usec: u64,
    pub lat: i32,
    pub lon: i32,
    pub alt: i32,
    pub eph: u16,
    pub epv: u16,
    pub vel: u16,
    pub cog: u16,
    pub fix_type: u8,
    pub satellites_visible: u8,
    pub alt_ellipsoid: i32,
    pub h_acc: u32,
    pub v_acc: u32,
    pub vel_acc: u32,
    pub hdg_acc: u32,
    pub yaw: u16,
}
impl GPS_RAW_INT_DATA {
    pub const ENCODED_LEN: usize = 52usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        lat: 0_i32,
        lon: 0_i32,
        alt: 0_i32,
        eph: 0_u16,
        epv: 0_u16,
        vel: 0_u16,
        cog: 0_u16,
        fix_type: 0_u8,
        satellites_visible: 0_u8,
        alt_ellipsoid: 0_i32,
        h_acc: 0_u32,
        v_acc: 0_u32,
        vel_acc: 0_u32,
        hdg_acc: 0_u32,
        yaw: 0_u16,
    };
}
impl Default for GPS_RAW_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for GPS_RAW_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 24u32;
    const NAME: &'static str = "GPS_RAW_INT";
    const EXTRA_CRC: u8 = 24u8;
    const ENCODED_LEN: usize = 52usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.lat = buf.get_i32_le()?;
        __struct.lon = buf.get_i32_le()?;
        __struct.alt = buf.get_i32_le()?;
        __struct.eph = buf.get_u16_le()?;
        __struct.epv = buf.get_u16_le()?;
        __struct.vel = buf.get_u16_le()?;
        __struct.cog = buf.get_u16_le()?;
        __struct.fix_type = buf.get_u8()?;
        __struct.satellites_visible = buf.get_u8()?;
        __struct.alt_ellipsoid = buf.get_i32_le()?;
        __struct.h_acc = buf.get_u32_le()?;
        __struct.v_acc = buf.get_u32_le()?;
        __struct.vel_acc = buf.get_u32_le()?;
        __struct.hdg_acc = buf.get_u32_le()?;
        __struct.yaw = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_i32_le(self.lat);
        __tmp.put_i32_le(self.lon);
        __tmp.put_i32_le(self.alt);
        __tmp.put_u16_le(self.eph);
        __tmp.put_u16_le(self.epv);
        __tmp.put_u16_le(self.vel);
        __tmp.put_u16_le(self.cog);
        __tmp.put_u8(self.fix_type);
        __tmp.put_u8(self.satellites_visible);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_i32_le(self.alt_ellipsoid);
            __tmp.put_u32_le(self.h_acc);
            __tmp.put_u32_le(self.v_acc);
            __tmp.put_u32_le(self.vel_acc);
            __tmp.put_u32_le(self.hdg_acc);
            __tmp.put_u16_le(self.yaw);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 0
#[derive(Debug, Clone, PartialEq)]
pub struct HEARTBEAT_DATA {
    pub custom_mode: u32,
    pub mavtype: u8,
    pub autopilot: u8,
    pub base_mode: u8,
    pub system_status: u8,
    pub mavlink_version: u8,
}
impl HEARTBEAT_DATA {
    pub const ENCODED_LEN: usize = 9usize;
    pub const DEFAULT: Self = Self {
        custom_mode: 0_u32,
        mavtype: 0_u8,
        autopilot: 0_u8,
        base_mode: 0_u8,
        system_status: 0_u8,
        mavlink_version: 0_u8,
    };
}
impl Default for HEARTBEAT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for HEARTBEAT_DATA {
    type Message = MavMessage;
    const ID: u32 = 0u32;
    const NAME: &'static str = "HEARTBEAT";
    const EXTRA_CRC: u8 = 50u8;
    const ENCODED_LEN: usize = 9usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.custom_mode = buf.get_u32_le()?;
        __struct.mavtype = buf.get_u8()?;
        __struct.autopilot = buf.get_u8()?;
        __struct.base_mode = buf.get_u8()?;
        __struct.system_status = buf.get_u8()?;
        __struct.mavlink_version = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.custom_mode);
        __tmp.put_u8(self.mavtype);
        __tmp.put_u8(self.autopilot);
        __tmp.put_u8(self.base_mode);
        __tmp.put_u8(self.system_status);
        __tmp.put_u8(self.mavlink_version);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 242
#[derive(Debug, Clone, PartialEq)]
pub struct HOME_POSITION_DATA {
    pub latitude: i32,
    pub longitude: i32,
    pub altitude: i32,
    pub x: f32,
    pub y: f32,
    pub z: f32,
    pub q: [f32; 4],
    pub approach_x: f32,
    pub approach_y: f32,
    pub approach_z: f32,
    pub time_usec: u64,
}
impl HOME_POSITION_DATA {
    pub const ENCODED_LEN: usize = 60usize;
    pub const DEFAULT: Self = Self {
        latitude: 0_i32,
        longitude: 0_i32,
        altitude: 0_i32,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        q: [0.0_f32; 4usize],
        approach_x: 0.0_f32,
        approach_y: 0.0_f32,
        approach_z: 0.0_f32,
        time_usec: 0_u64,
    };
}
impl Default for HOME_POSITION_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for HOME_POSITION_DATA {
    type Message = MavMessage;
    const ID: u32 = 242u32;
    const NAME: &'static str = "HOME_POSITION";
    const EXTRA_CRC: u8 = 104u8;
    const ENCODED_LEN: usize = 60usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.latitude = buf.get_i32_le()?;
        __struct.longitude = buf.get_i32_le()?;
        __struct.altitude = buf.get_i32_le()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        for v in &mut __struct.q {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.approach_x = buf.get_f32_le()?;
        __struct.approach_y = buf.get_f32_le()?;
        __struct.approach_z = buf.get_f32_le()?;
        __struct.time_usec = buf.get_u64_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.latitude);
        __tmp.put_i32_le(self.longitude);
        __tmp.put_i32_le(self.altitude);
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        for val in &self.q {
            __tmp.put_f32_le(*val);
        }
        __tmp.put_f32_le(self.approach_x);
        __tmp.put_f32_le(self.approach_y);
        __tmp.put_f32_le(self.approach_z);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u64_le(self.time_usec);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 32
#[derive(Debug, Clone, PartialEq)]
pub struct LOCAL_POSITION_NED_DATA {
    pub time_boot_ms: u32,
    pub x: f32,
    pub y: f32,
    pub z: f32,
    pub vx: f32,
    pub vy: f32,
    pub vz: f32,
}
impl LOCAL_POSITION_NED_DATA {
    pub const ENCODED_LEN: usize = 28usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        vx: 0.0_f32,
        vy: 0.0_f32,
        vz: 0.0_f32,
    };
}
impl Default for LOCAL_POSITION_NED_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for LOCAL_POSITION_NED_DATA {
    type Message = MavMessage;
    const ID: u32 = 32u32;
    const NAME: &'static str = "LOCAL_POSITION_NED";
    const EXTRA_CRC: u8 = 185u8;
    const ENCODED_LEN: usize = 28usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.vx = buf.get_f32_le()?;
        __struct.vy = buf.get_f32_le()?;
        __struct.vz = buf.get_f32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_f32_le(self.vx);
        __tmp.put_f32_le(self.vy);
        __tmp.put_f32_le(self.vz);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 69
#[derive(Debug, Clone, PartialEq)]
pub struct MANUAL_CONTROL_DATA {
    pub x: i16,
    pub y: i16,
    pub z: i16,
    pub r: i16,
    pub buttons: u16,
    pub target: u8,
    pub buttons2: u16,
    pub enabled_extensions: u8,
    pub s: i16,
    pub t: i16,
    pub aux1: i16,
    pub aux2: i16,
    pub aux3: i16,
    pub aux4: i16,
    pub aux5: i16,
    pub aux6: i16,
}
impl MANUAL_CONTROL_DATA {
    pub const ENCODED_LEN: usize = 30usize;
    pub const DEFAULT: Self = Self {
        x: 0_i16,
        y: 0_i16,
        z: 0_i16,
        r: 0_i16,
        buttons: 0_u16,
        target: 0_u8,
        buttons2: 0_u16,
        enabled_extensions: 0_u8,
        s: 0_i16,
        t: 0_i16,
        aux1: 0_i16,
        aux2: 0_i16,
        aux3: 0_i16,
        aux4: 0_i16,
        aux5: 0_i16,
        aux6: 0_i16,
    };
}
impl Default for MANUAL_CONTROL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MANUAL_CONTROL_DATA {
    type Message = MavMessage;
    const ID: u32 = 69u32;
    const NAME: &'static str = "MANUAL_CONTROL";
    const EXTRA_CRC: u8 = 243u8;
    const ENCODED_LEN: usize = 30usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.x = buf.get_i16_le()?;
        __struct.y = buf.get_i16_le()?;
        __struct.z = buf.get_i16_le()?;
        __struct.r = buf.get_i16_le()?;
        __struct.buttons = buf.get_u16_le()?;
        __struct.target = buf.get_u8()?;
        __struct.buttons2 = buf.get_u16_le()?;
        __struct.enabled_extensions = buf.get_u8()?;
        __struct.s = buf.get_i16_le()?;
        __struct.t = buf.get_i16_le()?;
        __struct.aux1 = buf.get_i16_le()?;
        __struct.aux2 = buf.get_i16_le()?;
        __struct.aux3 = buf.get_i16_le()?;
        __struct.aux4 = buf.get_i16_le()?;
        __struct.aux5 = buf.get_i16_le()?;
        __struct.aux6 = buf.get_i16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i16_le(self.x);
        __tmp.put_i16_le(self.y);
        __tmp.put_i16_le(self.z);
        __tmp.put_i16_le(self.r);
        __tmp.put_u16_le(self.buttons);
        __tmp.put_u8(self.target);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u16_le(self.buttons2);
            __tmp.put_u8(self.enabled_extensions);
            __tmp.put_i16_le(self.s);
            __tmp.put_i16_le(self.t);
            __tmp.put_i16_le(self.aux1);
            __tmp.put_i16_le(self.aux2);
            __tmp.put_i16_le(self.aux3);
            __tmp.put_i16_le(self.aux4);
            __tmp.put_i16_le(self.aux5);
            __tmp.put_i16_le(self.aux6);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 244
#[derive(Debug, Clone, PartialEq)]
pub struct MESSAGE_INTERVAL_DATA {
    pub interval_us: i32,
    pub message_id: u16,
}
impl MESSAGE_INTERVAL_DATA {
    pub const ENCODED_LEN: usize = 6usize;
    pub const DEFAULT: Self = Self {
        interval_us: 0_i32,
        message_id: 0_u16,
    };
}
impl Default for MESSAGE_INTERVAL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MESSAGE_INTERVAL_DATA {
    type Message = MavMessage;
    const ID: u32 = 244u32;
    const NAME: &'static str = "MESSAGE_INTERVAL";
    const EXTRA_CRC: u8 = 95u8;
    const ENCODED_LEN: usize = 6usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.interval_us = buf.get_i32_le()?;
        __struct.message_id = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.interval_us);
        __tmp.put_u16_le(self.message_id);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 47
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_ACK_DATA {
    pub target_system: u8,
    pub target_component: u8,
    pub mavtype: u8,
    pub mission_type: u8,
}
impl MISSION_ACK_DATA {
    pub const ENCODED_LEN: usize = 4usize;
    pub const DEFAULT: Self = Self {
        target_system: 0_u8,
        target_component: 0_u8,
        mavtype: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_ACK_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_ACK_DATA {
    type Message = MavMessage;
    const ID: u32 = 47u32;
    const NAME: &'static str = "MISSION_ACK";
    const EXTRA_CRC: u8 = 153u8;
    const ENCODED_LEN: usize = 4usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.mavtype = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.mavtype);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 45
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_CLEAR_ALL_DATA {
    pub target_system: u8,
    pub target_component: u8,
    pub mission_type: u8,
}
impl MISSION_CLEAR_ALL_DATA {
    pub const ENCODED_LEN: usize = 3usize;
    pub const DEFAULT: Self = Self {
        target_system: 0_u8,
        target_component: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_CLEAR_ALL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_CLEAR_ALL_DATA {
    type Message = MavMessage;
    const ID: u32 = 45u32;
    const NAME: &'static str = "MISSION_CLEAR_ALL";
    const EXTRA_CRC: u8 = 232u8;
    const ENCODED_LEN: usize = 3usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 44
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_COUNT_DATA {
    pub count: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub mission_type: u8,
}
impl MISSION_COUNT_DATA {
    pub const ENCODED_LEN: usize = 5usize;
    pub const DEFAULT: Self = Self {
        count: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_COUNT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_COUNT_DATA {
    type Message = MavMessage;
    const ID: u32 = 44u32;
    const NAME: &'static str = "MISSION_COUNT";
    const EXTRA_CRC: u8 = 221u8;
    const ENCODED_LEN: usize = 5usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.count = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.count);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 42
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_CURRENT_DATA {
    pub seq: u16,
    pub total: u16,
    pub mission_state: u8,
    pub mission_mode: u8,
}
impl MISSION_CURRENT_DATA {
    pub const ENCODED_LEN: usize = 6usize;
    pub const DEFAULT: Self = Self {
        seq: 0_u16,
        total: 0_u16,
        mission_state: 0_u8,
        mission_mode: 0_u8,
    };
}
impl Default for MISSION_CURRENT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_CURRENT_DATA {
    type Message = MavMessage;
    const ID: u32 = 42u32;
    const NAME: &'static str = "MISSION_CURRENT";
    const EXTRA_CRC: u8 = 28u8;
    const ENCODED_LEN: usize = 6usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.seq = buf.get_u16_le()?;
        __struct.total = buf.get_u16_le()?;
        __struct.mission_state = buf.get_u8()?;
        __struct.mission_mode = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.seq);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u16_le(self.total);
            __tmp.put_u8(self.mission_state);
            __tmp.put_u8(self.mission_mode);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 39
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_ITEM_DATA {
    pub param1: f32,
    pub param2: f32,
    pub param3: f32,
    pub param4: f32,
    pub x: f32,
    pub y: f32,
    pub z: f32,
    pub seq: u16,
    pub command: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub frame: u8,
    pub current: u8,
    pub autocontinue: u8,
    pub mission_type: u8,
}
impl MISSION_ITEM_DATA {
    pub const ENCODED_LEN: usize = 38usize;
    pub const DEFAULT: Self = Self {
        param1: 0.0_f32,
        param2: 0.0_f32,
        param3: 0.0_f32,
        param4: 0.0_f32,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        seq: 0_u16,
        command: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        frame: 0_u8,
        current: 0_u8,
        autocontinue: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_ITEM_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_ITEM_DATA {
    type Message = MavMessage;
    const ID: u32 = 39u32;
    const NAME: &'static str = "MISSION_ITEM";
    const EXTRA_CRC: u8 = 254u8;
    const ENCODED_LEN: usize = 38usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param1 = buf.get_f32_le()?;
        __struct.param2 = buf.get_f32_le()?;
        __struct.param3 = buf.get_f32_le()?;
        __struct.param4 = buf.get_f32_le()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.seq = buf.get_u16_le()?;
        __struct.command = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.frame = buf.get_u8()?;
        __struct.current = buf.get_u8()?;
        __struct.autocontinue = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param1);
        __tmp.put_f32_le(self.param2);
        __tmp.put_f32_le(self.param3);
        __tmp.put_f32_le(self.param4);
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_u16_le(self.seq);
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.frame);
        __tmp.put_u8(self.current);
        __tmp.put_u8(self.autocontinue);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 73
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_ITEM_INT_DATA {
    pub param1: f32,
    pub param2: f32,
    pub param3: f32,
    pub param4: f32,
    pub x: i32,
    pub y: i32,
    pub z: f32,
    pub seq: u16,
    pub command: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub frame: u8,
    pub current: u8,
    pub autocontinue: u8,
    pub mission_type: u8,
}
impl MISSION_ITEM_INT_DATA {
    pub const ENCODED_LEN: usize = 38usize;
    pub const DEFAULT: Self = Self {
        param1: 0.0_f32,
        param2: 0.0_f32,
        param3: 0.0_f32,
        param4: 0.0_f32,
        x: 0_i32,
        y: 0_i32,
        z: 0.0_f32,
        seq: 0_u16,
        command: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        frame: 0_u8,
        current: 0_u8,
        autocontinue: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_ITEM_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_ITEM_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 73u32;
    const NAME: &'static str = "MISSION_ITEM_INT";
    const EXTRA_CRC: u8 = 38u8;
    const ENCODED_LEN: usize = 38usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param1 = buf.get_f32_le()?;
        __struct.param2 = buf.get_f32_le()?;
        __struct.param3 = buf.get_f32_le()?;
        __struct.param4 = buf.get_f32_le()?;
        __struct.x = buf.get_i32_le()?;
        __struct.y = buf.get_i32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.seq = buf.get_u16_le()?;
        __struct.command = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.frame = buf.get_u8()?;
        __struct.current = buf.get_u8()?;
        __struct.autocontinue = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param1);
        __tmp.put_f32_le(self.param2);
        __tmp.put_f32_le(self.param3);
        __tmp.put_f32_le(self.param4);
        __tmp.put_i32_le(self.x);
        __tmp.put_i32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_u16_le(self.seq);
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.frame);
        __tmp.put_u8(self.current);
        __tmp.put_u8(self.autocontinue);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 46
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_ITEM_REACHED_DATA {
    pub seq: u16,
}
impl MISSION_ITEM_REACHED_DATA {
    pub const ENCODED_LEN: usize = 2usize;
    pub const DEFAULT: Self = Self { seq: 0_u16 };
}
impl Default for MISSION_ITEM_REACHED_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_ITEM_REACHED_DATA {
    type Message = MavMessage;
    const ID: u32 = 46u32;
    const NAME: &'static str = "MISSION_ITEM_REACHED";
    const EXTRA_CRC: u8 = 11u8;
    const ENCODED_LEN: usize = 2usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.seq = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.seq);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 40
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_REQUEST_DATA {
    pub seq: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub mission_type: u8,
}
impl MISSION_REQUEST_DATA {
    pub const ENCODED_LEN: usize = 5usize;
    pub const DEFAULT: Self = Self {
        seq: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_REQUEST_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_REQUEST_DATA {
    type Message = MavMessage;
    const ID: u32 = 40u32;
    const NAME: &'static str = "MISSION_REQUEST";
    const EXTRA_CRC: u8 = 230u8;
    const ENCODED_LEN: usize = 5usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.seq = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.seq);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 51
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_REQUEST_INT_DATA {
    pub seq: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub mission_type: u8,
}
impl MISSION_REQUEST_INT_DATA {
    pub const ENCODED_LEN: usize = 5usize;
    pub const DEFAULT: Self = Self {
        seq: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_REQUEST_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_REQUEST_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 51u32;
    const NAME: &'static str = "MISSION_REQUEST_INT";
    const EXTRA_CRC: u8 = 196u8;
    const ENCODED_LEN: usize = 5usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.seq = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.seq);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 43
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_REQUEST_LIST_DATA {
    pub target_system: u8,
    pub target_component: u8,
    pub mission_type: u8,
}
impl MISSION_REQUEST_LIST_DATA {
    pub const ENCODED_LEN: usize = 3usize;
    pub const DEFAULT: Self = Self {
        target_system: 0_u8,
        target_component: 0_u8,
        mission_type: 0_u8,
    };
}
impl Default for MISSION_REQUEST_LIST_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_REQUEST_LIST_DATA {
    type Message = MavMessage;
    const ID: u32 = 43u32;
    const NAME: &'static str = "MISSION_REQUEST_LIST";
    const EXTRA_CRC: u8 = 132u8;
    const ENCODED_LEN: usize = 3usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.mission_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.mission_type);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 41
#[derive(Debug, Clone, PartialEq)]
pub struct MISSION_SET_CURRENT_DATA {
    pub seq: u16,
    pub target_system: u8,
    pub target_component: u8,
}
impl MISSION_SET_CURRENT_DATA {
    pub const ENCODED_LEN: usize = 4usize;
    pub const DEFAULT: Self = Self {
        seq: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
    };
}
impl Default for MISSION_SET_CURRENT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MISSION_SET_CURRENT_DATA {
    type Message = MavMessage;
    const ID: u32 = 41u32;
    const NAME: &'static str = "MISSION_SET_CURRENT";
    const EXTRA_CRC: u8 = 28u8;
    const ENCODED_LEN: usize = 4usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.seq = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.seq);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 21
#[derive(Debug, Clone, PartialEq)]
pub struct PARAM_REQUEST_LIST_DATA {
    pub target_system: u8,
    pub target_component: u8,
}
impl PARAM_REQUEST_LIST_DATA {
    pub const ENCODED_LEN: usize = 2usize;
    pub const DEFAULT: Self = Self {
        target_system: 0_u8,
        target_component: 0_u8,
    };
}
impl Default for PARAM_REQUEST_LIST_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_REQUEST_LIST_DATA {
    type Message = MavMessage;
    const ID: u32 = 21u32;
    const NAME: &'static str = "PARAM_REQUEST_LIST";
    const EXTRA_CRC: u8 = 159u8;
    const ENCODED_LEN: usize = 2usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 20
#[derive(Debug, Clone, PartialEq)]
pub struct PARAM_REQUEST_READ_DATA {
    pub param_index: i16,
    pub target_system: u8,
    pub target_component: u8,
    pub param_id: CharArray<16>,
}
impl PARAM_REQUEST_READ_DATA {
    pub const ENCODED_LEN: usize = 20usize;
    pub const DEFAULT: Self = Self {
        param_index: 0_i16,
        target_system: 0_u8,
        target_component: 0_u8,
        param_id: CharArray::new([0_u8; 16usize]),
    };
}
impl Default for PARAM_REQUEST_READ_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_REQUEST_READ_DATA {
    type Message = MavMessage;
    const ID: u32 = 20u32;
    const NAME: &'static str = "PARAM_REQUEST_READ";
    const EXTRA_CRC: u8 = 214u8;
    const ENCODED_LEN: usize = 20usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param_index = buf.get_i16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        let mut tmp = [0_u8; 16usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.param_id = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i16_le(self.param_index);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.param_id {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 23
#[derive(Debug, Clone, PartialEq)]
pub struct PARAM_SET_DATA {
    pub param_value: f32,
    pub target_system: u8,
    pub target_component: u8,
    pub param_id: CharArray<16>,
    pub param_type: u8,
}
impl PARAM_SET_DATA {
    pub const ENCODED_LEN: usize = 23usize;
    pub const DEFAULT: Self = Self {
        param_value: 0.0_f32,
        target_system: 0_u8,
        target_component: 0_u8,
        param_id: CharArray::new([0_u8; 16usize]),
        param_type: 0_u8,
    };
}
impl Default for PARAM_SET_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_SET_DATA {
    type Message = MavMessage;
    const ID: u32 = 23u32;
    const NAME: &'static str = "PARAM_SET";
    const EXTRA_CRC: u8 = 168u8;
    const ENCODED_LEN: usize = 23usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param_value = buf.get_f32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        let mut tmp = [0_u8; 16usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.param_id = CharArray::new(tmp);
        __struct.param_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param_value);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.param_id {
            __tmp.put_u8(*val);
        }
        __tmp.put_u8(self.param_type);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 22
#[derive(Debug, Clone, PartialEq)]
pub struct PARAM_VALUE_DATA {
    pub param_value: f32,
    pub param_count: u16,
    pub param_index: u16,
    pub param_id: CharArray<16>,
    pub param_type: u8,
}
impl PARAM_VALUE_DATA {
    pub const ENCODED_LEN: usize = 25usize;
    pub const DEFAULT: Self = Self {
        param_value: 0.0_f32,
        param_count: 0_u16,
        param_index: 0_u16,
        param_id: CharArray::new([0_u8; 16usize]),
        param_type: 0_u8,
    };
}
impl Default for PARAM_VALUE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_VALUE_DATA {
    type Message = MavMessage;
    const ID: u32 = 22u32;
    const NAME: &'static str = "PARAM_VALUE";
    const EXTRA_CRC: u8 = 220u8;
    const ENCODED_LEN: usize = 25usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param_value = buf.get_f32_le()?;
        __struct.param_count = buf.get_u16_le()?;
        __struct.param_index = buf.get_u16_le()?;
        let mut tmp = [0_u8; 16usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.param_id = CharArray::new(tmp);
        __struct.param_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param_value);
        __tmp.put_u16_le(self.param_count);
        __tmp.put_u16_le(self.param_index);
        for val in &self.param_id {
            __tmp.put_u8(*val);
        }
        __tmp.put_u8(self.param_type);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 4
#[derive(Debug, Clone, PartialEq)]
pub struct PING_DATA {
    pub time_usec: u64,
    pub seq: u32,
    pub target_system: u8,
    pub target_component: u8,
}
impl PING_DATA {
    pub const ENCODED_LEN: usize = 14usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        seq: 0_u32,
        target_system: 0_u8,
        target_component: 0_u8,
    };
}
impl Default for PING_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PING_DATA {
    type Message = MavMessage;
    const ID: u32 = 4u32;
    const NAME: &'static str = "PING";
    const EXTRA_CRC: u8 = 237u8;
    const ENCODED_LEN: usize = 14usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.seq = buf.get_u32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_u32_le(self.seq);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 87
#[derive(Debug, Clone, PartialEq)]
pub struct POSITION_TARGET_GLOBAL_INT_DATA {
    pub time_boot_ms: u32,
    pub lat_int: i32,
    pub lon_int: i32,
    pub alt: f32,
    pub vx: f32,
    pub vy: f32,
    pub vz: f32,
    pub afx: f32,
    pub afy: f32,
    pub afz: f32,
    pub yaw: f32,
    pub yaw_rate: f32,
    pub type_mask: u16,
    pub coordinate_frame: u8,
}
impl POSITION_TARGET_GLOBAL_INT_DATA {
    pub const ENCODED_LEN: usize = 51usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        lat_int: 0_i32,
        lon_int: 0_i32,
        alt: 0.0_f32,
        vx: 0.0_f32,
        vy: 0.0_f32,
        vz: 0.0_f32,
        afx: 0.0_f32,
        afy: 0.0_f32,
        afz: 0.0_f32,
        yaw: 0.0_f32,
        yaw_rate: 0.0_f32,
        type_mask: 0_u16,
        coordinate_frame: 0_u8,
    };
}
impl Default for POSITION_TARGET_GLOBAL_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for POSITION_TARGET_GLOBAL_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 87u32;
    const NAME: &'static str = "POSITION_TARGET_GLOBAL_INT";
    const EXTRA_CRC: u8 = 150u8;
    const ENCODED_LEN: usize = 51usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.lat_int = buf.get_i32_le()?;
        __struct.lon_int = buf.get_i32_le()?;
        __struct.alt = buf.get_f32_le()?;
        __struct.vx = buf.get_f32_le()?;
        __struct.vy = buf.get_f32_le()?;
        __struct.vz = buf.get_f32_le()?;
        __struct.afx = buf.get_f32_le()?;
        __struct.afy = buf.get_f32_le()?;
        __struct.afz = buf.get_f32_le()?;
        __struct.yaw = buf.get_f32_le()?;
        __struct.yaw_rate = buf.get_f32_le()?;
        __struct.type_mask = buf.get_u16_le()?;
        __struct.coordinate_frame = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_i32_le(self.lat_int);
        __tmp.put_i32_le(self.lon_int);
        __tmp.put_f32_le(self.alt);
        __tmp.put_f32_le(self.vx);
        __tmp.put_f32_le(self.vy);
        __tmp.put_f32_le(self.vz);
        __tmp.put_f32_le(self.afx);
        __tmp.put_f32_le(self.afy);
        __tmp.put_f32_le(self.afz);
        __tmp.put_f32_le(self.yaw);
        __tmp.put_f32_le(self.yaw_rate);
        __tmp.put_u16_le(self.type_mask);
        __tmp.put_u8(self.coordinate_frame);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 85
#[derive(Debug, Clone, PartialEq)]
pub struct POSITION_TARGET_LOCAL_NED_DATA {
    pub time_boot_ms: u32,
    pub x: f32,
    pub y: f32,
    pub z: f32,
    pub vx: f32,
    pub vy: f32,
    pub vz: f32,
    pub afx: f32,
    pub afy: f32,
    pub afz: f32,
    pub yaw: f32,
    pub yaw_rate: f32,
    pub type_mask: u16,
    pub coordinate_frame: u8,
}
impl POSITION_TARGET_LOCAL_NED_DATA {
    pub const ENCODED_LEN: usize = 51usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        vx: 0.0_f32,
        vy: 0.0_f32,
        vz: 0.0_f32,
        afx: 0.0_f32,
        afy: 0.0_f32,
        afz: 0.0_f32,
        yaw: 0.0_f32,
        yaw_rate: 0.0_f32,
        type_mask: 0_u16,
        coordinate_frame: 0_u8,
    };
}
impl Default for POSITION_TARGET_LOCAL_NED_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for POSITION_TARGET_LOCAL_NED_DATA {
    type Message = MavMessage;
    const ID: u32 = 85u32;
    const NAME: &'static str = "POSITION_TARGET_LOCAL_NED";
    const EXTRA_CRC: u8 = 140u8;
    const ENCODED_LEN: usize = 51usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.vx = buf.get_f32_le()?;
        __struct.vy = buf.get_f32_le()?;
        __struct.vz = buf.get_f32_le()?;
        __struct.afx = buf.get_f32_le()?;
        __struct.afy = buf.get_f32_le()?;
        __struct.afz = buf.get_f32_le()?;
        __struct.yaw = buf.get_f32_le()?;
        __struct.yaw_rate = buf.get_f32_le()?;
        __struct.type_mask = buf.get_u16_le()?;
        __struct.coordinate_frame = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_f32_le(self.vx);
        __tmp.put_f32_le(self.vy);
        __tmp.put_f32_le(self.vz);
        __tmp.put_f32_le(self.afx);
        __tmp.put_f32_le(self.afy);
        __tmp.put_f32_le(self.afz);
        __tmp.put_f32_le(self.yaw);
        __tmp.put_f32_le(self.yaw_rate);
        __tmp.put_u16_le(self.type_mask);
        __tmp.put_u8(self.coordinate_frame);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 66
#[derive(Debug, Clone, PartialEq)]
pub struct REQUEST_DATA_STREAM_DATA {
    pub req_message_rate: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub req_stream_id: u8,
    pub start_stop: u8,
}
impl REQUEST_DATA_STREAM_DATA {
    pub const ENCODED_LEN: usize = 6usize;
    pub const DEFAULT: Self = Self {
        req_message_rate: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        req_stream_id: 0_u8,
        start_stop: 0_u8,
    };
}
impl Default for REQUEST_DATA_STREAM_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for REQUEST_DATA_STREAM_DATA {
    type Message = MavMessage;
    const ID: u32 = 66u32;
    const NAME: &'static str = "REQUEST_DATA_STREAM";
    const EXTRA_CRC: u8 = 148u8;
    const ENCODED_LEN: usize = 6usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.req_message_rate = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.req_stream_id = buf.get_u8()?;
        __struct.start_stop = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.req_message_rate);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.req_stream_id);
        __tmp.put_u8(self.start_stop);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 256
#[derive(Debug, Clone, PartialEq)]
pub struct SETUP_SIGNING_DATA {
    pub initial_timestamp: u64,
    pub target_system: u8,
    pub target_component: u8,
    pub secret_key: [u8; 32],
}
impl SETUP_SIGNING_DATA {
    pub const ENCODED_LEN: usize = 42usize;
    pub const DEFAULT: Self = Self {
        initial_timestamp: 0_u64,
        target_system: 0_u8,
        target_component: 0_u8,
        secret_key: [0_u8; 32usize],
    };
}
impl Default for SETUP_SIGNING_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SETUP_SIGNING_DATA {
    type Message = MavMessage;
    const ID: u32 = 256u32;
    const NAME: &'static str = "SETUP_SIGNING";
    const EXTRA_CRC: u8 = 71u8;
    const ENCODED_LEN: usize = 42usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.initial_timestamp = buf.get_u64_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        for v in &mut __struct.secret_key {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.initial_timestamp);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.secret_key {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 48
#[derive(Debug, Clone, PartialEq)]
pub struct SET_GPS_GLOBAL_ORIGIN_DATA {
    pub latitude: i32,
    pub longitude: i32,
    pub altitude: i32,
    pub target_system: u8,
    pub time_usec: u64,
}
impl SET_GPS_GLOBAL_ORIGIN_DATA {
    pub const ENCODED_LEN: usize = 21usize;
    pub const DEFAULT: Self = Self {
        latitude: 0_i32,
        longitude: 0_i32,
        altitude: 0_i32,
        target_system: 0_u8,
        time_usec: 0_u64,
    };
}
impl Default for SET_GPS_GLOBAL_ORIGIN_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SET_GPS_GLOBAL_ORIGIN_DATA {
    type Message = MavMessage;
    const ID: u32 = 48u32;
    const NAME: &'static str = "SET_GPS_GLOBAL_ORIGIN";
    const EXTRA_CRC: u8 = 41u8;
    const ENCODED_LEN: usize = 21usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.latitude = buf.get_i32_le()?;
        __struct.longitude = buf.get_i32_le()?;
        __struct.altitude = buf.get_i32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.time_usec = buf.get_u64_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.latitude);
        __tmp.put_i32_le(self.longitude);
        __tmp.put_i32_le(self.altitude);
        __tmp.put_u8(self.target_system);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u64_le(self.time_usec);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 11
#[derive(Debug, Clone, PartialEq)]
pub struct SET_MODE_DATA {
    pub custom_mode: u32,
    pub target_system: u8,
    pub base_mode: u8,
}
impl SET_MODE_DATA {
    pub const ENCODED_LEN: usize = 6usize;
    pub const DEFAULT: Self = Self {
        custom_mode: 0_u32,
        target_system: 0_u8,
        base_mode: 0_u8,
    };
}
impl Default for SET_MODE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SET_MODE_DATA {
    type Message = MavMessage;
    const ID: u32 = 11u32;
    const NAME: &'static str = "SET_MODE";
    const EXTRA_CRC: u8 = 89u8;
    const ENCODED_LEN: usize = 6usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.custom_mode = buf.get_u32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.base_mode = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.custom_mode);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.base_mode);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 86
#[derive(Debug, Clone, PartialEq)]
pub struct SET_POSITION_TARGET_GLOBAL_INT_DATA {
    pub time_boot_ms: u32,
    pub lat_int: i32,
    pub lon_int: i32,
    pub alt: f32,
    pub vx: f32,
    pub vy: f32,
    pub vz: f32,
    pub afx: f32,
    pub afy: f32,
    pub afz: f32,
    pub yaw: f32,
    pub yaw_rate: f32,
    pub type_mask: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub coordinate_frame: u8,
}
impl SET_POSITION_TARGET_GLOBAL_INT_DATA {
    pub const ENCODED_LEN: usize = 53usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        lat_int: 0_i32,
        lon_int: 0_i32,
        alt: 0.0_f32,
        vx: 0.0_f32,
        vy: 0.0_f32,
        vz: 0.0_f32,
        afx: 0.0_f32,
        afy: 0.0_f32,
        afz: 0.0_f32,
        yaw: 0.0_f32,
        yaw_rate: 0.0_f32,
        type_mask: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        coordinate_frame: 0_u8,
    };
}
impl Default for SET_POSITION_TARGET_GLOBAL_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SET_POSITION_TARGET_GLOBAL_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 86u32;
    const NAME: &'static str = "SET_POSITION_TARGET_GLOBAL_INT";
    const EXTRA_CRC: u8 = 5u8;
    const ENCODED_LEN: usize = 53usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.lat_int = buf.get_i32_le()?;
        __struct.lon_int = buf.get_i32_le()?;
        __struct.alt = buf.get_f32_le()?;
        __struct.vx = buf.get_f32_le()?;
        __struct.vy = buf.get_f32_le()?;
        __struct.vz = buf.get_f32_le()?;
        __struct.afx = buf.get_f32_le()?;
        __struct.afy = buf.get_f32_le()?;
        __struct.afz = buf.get_f32_le()?;
        __struct.yaw = buf.get_f32_le()?;
        __struct.yaw_rate = buf.get_f32_le()?;
        __struct.type_mask = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.coordinate_frame = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_i32_le(self.lat_int);
        __tmp.put_i32_le(self.lon_int);
        __tmp.put_f32_le(self.alt);
        __tmp.put_f32_le(self.vx);
        __tmp.put_f32_le(self.vy);
        __tmp.put_f32_le(self.vz);
        __tmp.put_f32_le(self.afx);
        __tmp.put_f32_le(self.afy);
        __tmp.put_f32_le(self.afz);
        __tmp.put_f32_le(self.yaw);
        __tmp.put_f32_le(self.yaw_rate);
        __tmp.put_u16_le(self.type_mask);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.coordinate_frame);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 84
#[derive(Debug, Clone, PartialEq)]
pub struct SET_POSITION_TARGET_LOCAL_NED_DATA {
    pub time_boot_ms: u32,
    pub x: f32,
    pub y: f32,
    pub z: f32,
    pub vx: f32,
    pub vy: f32,
    pub vz: f32,
    pub afx: f32,
    pub afy: f32,
    pub afz: f32,
    pub yaw: f32,
    pub yaw_rate: f32,
    pub type_mask: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub coordinate_frame: u8,
}
impl SET_POSITION_TARGET_LOCAL_NED_DATA {
    pub const ENCODED_LEN: usize = 53usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        vx: 0.0_f32,
        vy: 0.0_f32,
        vz: 0.0_f32,
        afx: 0.0_f32,
        afy: 0.0_f32,
        afz: 0.0_f32,
        yaw: 0.0_f32,
        yaw_rate: 0.0_f32,
        type_mask: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        coordinate_frame: 0_u8,
    };
}
impl Default for SET_POSITION_TARGET_LOCAL_NED_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SET_POSITION_TARGET_LOCAL_NED_DATA {
    type Message = MavMessage;
    const ID: u32 = 84u32;
    const NAME: &'static str = "SET_POSITION_TARGET_LOCAL_NED";
    const EXTRA_CRC: u8 = 143u8;
    const ENCODED_LEN: usize = 53usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.vx = buf.get_f32_le()?;
        __struct.vy = buf.get_f32_le()?;
        __struct.vz = buf.get_f32_le()?;
        __struct.afx = buf.get_f32_le()?;
        __struct.afy = buf.get_f32_le()?;
        __struct.afz = buf.get_f32_le()?;
        __struct.yaw = buf.get_f32_le()?;
        __struct.yaw_rate = buf.get_f32_le()?;
        __struct.type_mask = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.coordinate_frame = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_f32_le(self.vx);
        __tmp.put_f32_le(self.vy);
        __tmp.put_f32_le(self.vz);
        __tmp.put_f32_le(self.afx);
        __tmp.put_f32_le(self.afy);
        __tmp.put_f32_le(self.afz);
        __tmp.put_f32_le(self.yaw);
        __tmp.put_f32_le(self.yaw_rate);
        __tmp.put_u16_le(self.type_mask);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.coordinate_frame);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 253
#[derive(Debug, Clone, PartialEq)]
pub struct STATUSTEXT_DATA {
    pub severity: u8,
    pub text: CharArray<50>,
    pub id: u16,
    pub chunk_seq: u8,
}
impl STATUSTEXT_DATA {
    pub const ENCODED_LEN: usize = 54usize;
    pub const DEFAULT: Self = Self {
        severity: 0_u8,
        text: CharArray::new([0_u8; 50usize]),
        id: 0_u16,
        chunk_seq: 0_u8,
    };
}
impl Default for STATUSTEXT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STATUSTEXT_DATA {
    type Message = MavMessage;
    const ID: u32 = 253u32;
    const NAME: &'static str = "STATUSTEXT";
    const EXTRA_CRC: u8 = 83u8;
    const ENCODED_LEN: usize = 54usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.severity = buf.get_u8()?;
        let mut tmp = [0_u8; 50usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.text = CharArray::new(tmp);
        __struct.id = buf.get_u16_le()?;
        __struct.chunk_seq = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.severity);
        for val in &self.text {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u16_le(self.id);
            __tmp.put_u8(self.chunk_seq);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///Answer to a STAYA_MESSAGE to one robot.
///
///ID: 9500003
#[derive(Debug, Clone, PartialEq)]
pub struct STAYA_ACK_DATA {
    ///Counts the sender's Staya messages; wraps.
    pub sequence: u16,
    ///Changes with each start of the sender.
    pub boot: u8,
    ///System that sent the message.
    pub target_system: u8,
    ///Boot of that system, as in its message.
    pub message_boot: u8,
    ///The message's number.
    pub number: u8,
}
impl STAYA_ACK_DATA {
    pub const ENCODED_LEN: usize = 6usize;
    pub const DEFAULT: Self = Self {
        sequence: 0_u16,
        boot: 0_u8,
        target_system: 0_u8,
        message_boot: 0_u8,
        number: 0_u8,
    };
}
impl Default for STAYA_ACK_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STAYA_ACK_DATA {
    type Message = MavMessage;
    const ID: u32 = 9500003u32;
    const NAME: &'static str = "STAYA_ACK";
    const EXTRA_CRC: u8 = 192u8;
    const ENCODED_LEN: usize = 6usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.sequence = buf.get_u16_le()?;
        __struct.boot = buf.get_u8()?;
        __struct.target_system = buf.get_u8()?;
        __struct.message_boot = buf.get_u8()?;
        __struct.number = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.sequence);
        __tmp.put_u8(self.boot);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.message_boot);
        __tmp.put_u8(self.number);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///Position, velocity and state of a robot, and what its law says. Sent once per period.
///
///ID: 9500000
#[derive(Debug, Clone, PartialEq)]
pub struct STAYA_BEACON_DATA {
    ///East.
    pub x_mm: i32,
    ///North.
    pub y_mm: i32,
    ///Up.
    pub z_mm: i32,
    ///Commanded velocity, east.
    pub vx_mmps: i16,
    ///Commanded velocity, north.
    pub vy_mmps: i16,
    ///Commanded velocity, up.
    pub vz_mmps: i16,
    ///Radius of the ball around the body.
    pub radius_mm: u16,
    ///Counts the sender's Staya messages; wraps.
    pub sequence: u16,
    ///Changes with each start of the sender.
    pub boot: u8,
    ///0 idle, 1 forming, 2 cruise, 3 hold, 4 arrived, 5 fault, 6 passive (motors off, or steered externally).
    pub mode: u8,
    ///Number of its flock.
    pub flock: u8,
    ///Protocol of its law: 0 none, 1 grid, 2 waypoints, 64 to 255 of users.
    pub protocol: u8,
    ///Number of bytes used.
    pub count: u8,
    ///Payload of its law. Protocol 1, little-endian: cell x, y and target x, y (int16), busy_ms (uint16), heading (0 to 7: neighbouring cells, 8: stays), slot (uint8), leader (in groups of 7 bits, the lowest first; 0: none).
    pub bytes: [u8; 16],
}
impl STAYA_BEACON_DATA {
    pub const ENCODED_LEN: usize = 43usize;
    pub const DEFAULT: Self = Self {
        x_mm: 0_i32,
        y_mm: 0_i32,
        z_mm: 0_i32,
        vx_mmps: 0_i16,
        vy_mmps: 0_i16,
        vz_mmps: 0_i16,
        radius_mm: 0_u16,
        sequence: 0_u16,
        boot: 0_u8,
        mode: 0_u8,
        flock: 0_u8,
        protocol: 0_u8,
        count: 0_u8,
        bytes: [0_u8; 16usize],
    };
}
impl Default for STAYA_BEACON_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STAYA_BEACON_DATA {
    type Message = MavMessage;
    const ID: u32 = 9500000u32;
    const NAME: &'static str = "STAYA_BEACON";
    const EXTRA_CRC: u8 = 212u8;
    const ENCODED_LEN: usize = 43usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.x_mm = buf.get_i32_le()?;
        __struct.y_mm = buf.get_i32_le()?;
        __struct.z_mm = buf.get_i32_le()?;
        __struct.vx_mmps = buf.get_i16_le()?;
        __struct.vy_mmps = buf.get_i16_le()?;
        __struct.vz_mmps = buf.get_i16_le()?;
        __struct.radius_mm = buf.get_u16_le()?;
        __struct.sequence = buf.get_u16_le()?;
        __struct.boot = buf.get_u8()?;
        __struct.mode = buf.get_u8()?;
        __struct.flock = buf.get_u8()?;
        __struct.protocol = buf.get_u8()?;
        __struct.count = buf.get_u8()?;
        for v in &mut __struct.bytes {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.x_mm);
        __tmp.put_i32_le(self.y_mm);
        __tmp.put_i32_le(self.z_mm);
        __tmp.put_i16_le(self.vx_mmps);
        __tmp.put_i16_le(self.vy_mmps);
        __tmp.put_i16_le(self.vz_mmps);
        __tmp.put_u16_le(self.radius_mm);
        __tmp.put_u16_le(self.sequence);
        __tmp.put_u8(self.boot);
        __tmp.put_u8(self.mode);
        __tmp.put_u8(self.flock);
        __tmp.put_u8(self.protocol);
        __tmp.put_u8(self.count);
        for val in &self.bytes {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///A goal on the grid for a formation's leader and all its followers.
///
///ID: 9500005
#[derive(Debug, Clone, PartialEq)]
pub struct STAYA_GOAL_DATA {
    ///Counts the sender's Staya messages; wraps.
    pub sequence: u16,
    ///Cell, east.
    pub target_x: i16,
    ///Cell, north.
    pub target_y: i16,
    ///Changes with each start of the sender.
    pub boot: u8,
    ///System addressed; 0: all.
    pub target_system: u8,
    ///A newer one replaces all before; wraps.
    pub version: u8,
}
impl STAYA_GOAL_DATA {
    pub const ENCODED_LEN: usize = 9usize;
    pub const DEFAULT: Self = Self {
        sequence: 0_u16,
        target_x: 0_i16,
        target_y: 0_i16,
        boot: 0_u8,
        target_system: 0_u8,
        version: 0_u8,
    };
}
impl Default for STAYA_GOAL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STAYA_GOAL_DATA {
    type Message = MavMessage;
    const ID: u32 = 9500005u32;
    const NAME: &'static str = "STAYA_GOAL";
    const EXTRA_CRC: u8 = 165u8;
    const ENCODED_LEN: usize = 9usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.sequence = buf.get_u16_le()?;
        __struct.target_x = buf.get_i16_le()?;
        __struct.target_y = buf.get_i16_le()?;
        __struct.boot = buf.get_u8()?;
        __struct.target_system = buf.get_u8()?;
        __struct.version = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.sequence);
        __tmp.put_i16_le(self.target_x);
        __tmp.put_i16_le(self.target_y);
        __tmp.put_u8(self.boot);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.version);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///A robot that fell silent, for robots that never heard it; sent in turn behind beacons. A ground station clears a place with is_lost 0 and age 0.
///
///ID: 9500009
#[derive(Debug, Clone, PartialEq)]
pub struct STAYA_LOST_DATA {
    ///Centre of the ball in which it stands, east.
    pub x_mm: i32,
    ///The same, north.
    pub y_mm: i32,
    ///The same, up.
    pub z_mm: i32,
    ///Radius of that ball.
    pub radius_mm: u16,
    ///Time since its last beacon.
    pub age_cs: u16,
    ///Counts the sender's Staya messages; wraps.
    pub sequence: u16,
    ///Changes with each start of the sender.
    pub boot: u8,
    ///System of the silent robot.
    pub robot: u8,
    ///1: it is silent near that position; 0: it was heard since, or is no longer there.
    pub is_lost: u8,
}
impl STAYA_LOST_DATA {
    pub const ENCODED_LEN: usize = 21usize;
    pub const DEFAULT: Self = Self {
        x_mm: 0_i32,
        y_mm: 0_i32,
        z_mm: 0_i32,
        radius_mm: 0_u16,
        age_cs: 0_u16,
        sequence: 0_u16,
        boot: 0_u8,
        robot: 0_u8,
        is_lost: 0_u8,
    };
}
impl Default for STAYA_LOST_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STAYA_LOST_DATA {
    type Message = MavMessage;
    const ID: u32 = 9500009u32;
    const NAME: &'static str = "STAYA_LOST";
    const EXTRA_CRC: u8 = 64u8;
    const ENCODED_LEN: usize = 21usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.x_mm = buf.get_i32_le()?;
        __struct.y_mm = buf.get_i32_le()?;
        __struct.z_mm = buf.get_i32_le()?;
        __struct.radius_mm = buf.get_u16_le()?;
        __struct.age_cs = buf.get_u16_le()?;
        __struct.sequence = buf.get_u16_le()?;
        __struct.boot = buf.get_u8()?;
        __struct.robot = buf.get_u8()?;
        __struct.is_lost = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.x_mm);
        __tmp.put_i32_le(self.y_mm);
        __tmp.put_i32_le(self.z_mm);
        __tmp.put_u16_le(self.radius_mm);
        __tmp.put_u16_le(self.age_cs);
        __tmp.put_u16_le(self.sequence);
        __tmp.put_u8(self.boot);
        __tmp.put_u8(self.robot);
        __tmp.put_u8(self.is_lost);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///Message of a law to one robot (up to 12 bytes) or to all robots, or an order to a law with a protocol of users.
///
///ID: 9500002
#[derive(Debug, Clone, PartialEq)]
pub struct STAYA_MESSAGE_DATA {
    ///Counts the sender's Staya messages; wraps.
    pub sequence: u16,
    ///Changes with each start of the sender.
    pub boot: u8,
    ///System addressed; 0: all.
    pub target_system: u8,
    ///0 message to one robot, 1 message to all, 2 order.
    pub kind: u8,
    ///Distinguishes the sender's messages; of orders, a newer one replaces all before.
    pub number: u8,
    ///Protocol of the bytes.
    pub protocol: u8,
    ///Number of bytes used.
    pub count: u8,
    ///The message in postcard. Protocol 1: 0 stop, origin, valid_ms (uint16); 1 resume, origin; 2 redirect; 3 land, corner x, y (int16), 32 tiles.
    pub bytes: [u8; 38],
}
impl STAYA_MESSAGE_DATA {
    pub const ENCODED_LEN: usize = 46usize;
    pub const DEFAULT: Self = Self {
        sequence: 0_u16,
        boot: 0_u8,
        target_system: 0_u8,
        kind: 0_u8,
        number: 0_u8,
        protocol: 0_u8,
        count: 0_u8,
        bytes: [0_u8; 38usize],
    };
}
impl Default for STAYA_MESSAGE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STAYA_MESSAGE_DATA {
    type Message = MavMessage;
    const ID: u32 = 9500002u32;
    const NAME: &'static str = "STAYA_MESSAGE";
    const EXTRA_CRC: u8 = 245u8;
    const ENCODED_LEN: usize = 46usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.sequence = buf.get_u16_le()?;
        __struct.boot = buf.get_u8()?;
        __struct.target_system = buf.get_u8()?;
        __struct.kind = buf.get_u8()?;
        __struct.number = buf.get_u8()?;
        __struct.protocol = buf.get_u8()?;
        __struct.count = buf.get_u8()?;
        for v in &mut __struct.bytes {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.sequence);
        __tmp.put_u8(self.boot);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.kind);
        __tmp.put_u8(self.number);
        __tmp.put_u8(self.protocol);
        __tmp.put_u8(self.count);
        for val in &self.bytes {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///A waypoint, one of several that may move.
///
///ID: 9500006
#[derive(Debug, Clone, PartialEq)]
pub struct STAYA_PLACE_DATA {
    ///East.
    pub x_mm: i32,
    ///North.
    pub y_mm: i32,
    ///Up.
    pub z_mm: i32,
    ///Velocity, east.
    pub vx_mmps: i16,
    ///Velocity, north.
    pub vy_mmps: i16,
    ///Velocity, up.
    pub vz_mmps: i16,
    ///Counts the sender's Staya messages; wraps.
    pub sequence: u16,
    ///Changes with each start of the sender.
    pub boot: u8,
    ///System addressed; 0: all.
    pub target_system: u8,
    ///A newer one replaces all before; wraps.
    pub version: u8,
    ///Number of the waypoint, from 0.
    pub index: u8,
}
impl STAYA_PLACE_DATA {
    pub const ENCODED_LEN: usize = 24usize;
    pub const DEFAULT: Self = Self {
        x_mm: 0_i32,
        y_mm: 0_i32,
        z_mm: 0_i32,
        vx_mmps: 0_i16,
        vy_mmps: 0_i16,
        vz_mmps: 0_i16,
        sequence: 0_u16,
        boot: 0_u8,
        target_system: 0_u8,
        version: 0_u8,
        index: 0_u8,
    };
}
impl Default for STAYA_PLACE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STAYA_PLACE_DATA {
    type Message = MavMessage;
    const ID: u32 = 9500006u32;
    const NAME: &'static str = "STAYA_PLACE";
    const EXTRA_CRC: u8 = 225u8;
    const ENCODED_LEN: usize = 24usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.x_mm = buf.get_i32_le()?;
        __struct.y_mm = buf.get_i32_le()?;
        __struct.z_mm = buf.get_i32_le()?;
        __struct.vx_mmps = buf.get_i16_le()?;
        __struct.vy_mmps = buf.get_i16_le()?;
        __struct.vz_mmps = buf.get_i16_le()?;
        __struct.sequence = buf.get_u16_le()?;
        __struct.boot = buf.get_u8()?;
        __struct.target_system = buf.get_u8()?;
        __struct.version = buf.get_u8()?;
        __struct.index = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.x_mm);
        __tmp.put_i32_le(self.y_mm);
        __tmp.put_i32_le(self.z_mm);
        __tmp.put_i16_le(self.vx_mmps);
        __tmp.put_i16_le(self.vy_mmps);
        __tmp.put_i16_le(self.vz_mmps);
        __tmp.put_u16_le(self.sequence);
        __tmp.put_u8(self.boot);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.version);
        __tmp.put_u8(self.index);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///One part of a robot's place in a formation: the place and its neighbours.
///
///ID: 9500004
#[derive(Debug, Clone, PartialEq)]
pub struct STAYA_TEMPLATE_DATA {
    ///Counts the sender's Staya messages; wraps.
    pub sequence: u16,
    ///Cells from the top leader's place to this robot's, east.
    pub offset_x: i16,
    ///The same, north.
    pub offset_y: i16,
    ///Each neighbour's place relative to this robot's, cells east.
    pub entry_x: [i16; 2],
    ///The same, north.
    pub entry_y: [i16; 2],
    ///Changes with each start of the sender.
    pub boot: u8,
    ///System that has this place.
    pub target_system: u8,
    ///A newer one replaces all before; wraps.
    pub version: u8,
    ///Number of this part, from 0.
    pub part: u8,
    ///Number of parts.
    pub parts: u8,
    ///Number of the place.
    pub slot: u8,
    ///Neighbours in this part.
    pub count: u8,
    ///The neighbours' systems.
    pub entry_id: [u8; 2],
    ///Edges between this place and each.
    pub entry_hops: [u8; 2],
}
impl STAYA_TEMPLATE_DATA {
    pub const ENCODED_LEN: usize = 25usize;
    pub const DEFAULT: Self = Self {
        sequence: 0_u16,
        offset_x: 0_i16,
        offset_y: 0_i16,
        entry_x: [0_i16; 2usize],
        entry_y: [0_i16; 2usize],
        boot: 0_u8,
        target_system: 0_u8,
        version: 0_u8,
        part: 0_u8,
        parts: 0_u8,
        slot: 0_u8,
        count: 0_u8,
        entry_id: [0_u8; 2usize],
        entry_hops: [0_u8; 2usize],
    };
}
impl Default for STAYA_TEMPLATE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STAYA_TEMPLATE_DATA {
    type Message = MavMessage;
    const ID: u32 = 9500004u32;
    const NAME: &'static str = "STAYA_TEMPLATE";
    const EXTRA_CRC: u8 = 150u8;
    const ENCODED_LEN: usize = 25usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.sequence = buf.get_u16_le()?;
        __struct.offset_x = buf.get_i16_le()?;
        __struct.offset_y = buf.get_i16_le()?;
        for v in &mut __struct.entry_x {
            let val = buf.get_i16_le()?;
            *v = val;
        }
        for v in &mut __struct.entry_y {
            let val = buf.get_i16_le()?;
            *v = val;
        }
        __struct.boot = buf.get_u8()?;
        __struct.target_system = buf.get_u8()?;
        __struct.version = buf.get_u8()?;
        __struct.part = buf.get_u8()?;
        __struct.parts = buf.get_u8()?;
        __struct.slot = buf.get_u8()?;
        __struct.count = buf.get_u8()?;
        for v in &mut __struct.entry_id {
            let val = buf.get_u8()?;
            *v = val;
        }
        for v in &mut __struct.entry_hops {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.sequence);
        __tmp.put_i16_le(self.offset_x);
        __tmp.put_i16_le(self.offset_y);
        for val in &self.entry_x {
            __tmp.put_i16_le(*val);
        }
        for val in &self.entry_y {
            __tmp.put_i16_le(*val);
        }
        __tmp.put_u8(self.boot);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.version);
        __tmp.put_u8(self.part);
        __tmp.put_u8(self.parts);
        __tmp.put_u8(self.slot);
        __tmp.put_u8(self.count);
        for val in &self.entry_id {
            __tmp.put_u8(*val);
        }
        for val in &self.entry_hops {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 2
#[derive(Debug, Clone, PartialEq)]
pub struct SYSTEM_TIME_DATA {
    pub time_unix_usec: u64,
    pub time_boot_ms: u32,
}
impl SYSTEM_TIME_DATA {
    pub const ENCODED_LEN: usize = 12usize;
    pub const DEFAULT: Self = Self {
        time_unix_usec: 0_u64,
        time_boot_ms: 0_u32,
    };
}
impl Default for SYSTEM_TIME_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SYSTEM_TIME_DATA {
    type Message = MavMessage;
    const ID: u32 = 2u32;
    const NAME: &'static str = "SYSTEM_TIME";
    const EXTRA_CRC: u8 = 137u8;
    const ENCODED_LEN: usize = 12usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_unix_usec = buf.get_u64_le()?;
        __struct.time_boot_ms = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_unix_usec);
        __tmp.put_u32_le(self.time_boot_ms);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 1
#[derive(Debug, Clone, PartialEq)]
pub struct SYS_STATUS_DATA {
    pub onboard_control_sensors_present: u32,
    pub onboard_control_sensors_enabled: u32,
    pub onboard_control_sensors_health: u32,
    pub load: u16,
    pub voltage_battery: u16,
    pub current_battery: i16,
    pub drop_rate_comm: u16,
    pub errors_comm: u16,
    pub errors_count1: u16,
    pub errors_count2: u16,
    pub errors_count3: u16,
    pub errors_count4: u16,
    pub battery_remaining: i8,
    pub onboard_control_sensors_present_extended: u32,
    pub onboard_control_sensors_enabled_extended: u32,
    pub onboard_control_sensors_health_extended: u32,
}
impl SYS_STATUS_DATA {
    pub const ENCODED_LEN: usize = 43usize;
    pub const DEFAULT: Self = Self {
        onboard_control_sensors_present: 0_u32,
        onboard_control_sensors_enabled: 0_u32,
        onboard_control_sensors_health: 0_u32,
        load: 0_u16,
        voltage_battery: 0_u16,
        current_battery: 0_i16,
        drop_rate_comm: 0_u16,
        errors_comm: 0_u16,
        errors_count1: 0_u16,
        errors_count2: 0_u16,
        errors_count3: 0_u16,
        errors_count4: 0_u16,
        battery_remaining: 0_i8,
        onboard_control_sensors_present_extended: 0_u32,
        onboard_control_sensors_enabled_extended: 0_u32,
        onboard_control_sensors_health_extended: 0_u32,
    };
}
impl Default for SYS_STATUS_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SYS_STATUS_DATA {
    type Message = MavMessage;
    const ID: u32 = 1u32;
    const NAME: &'static str = "SYS_STATUS";
    const EXTRA_CRC: u8 = 124u8;
    const ENCODED_LEN: usize = 43usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.onboard_control_sensors_present = buf.get_u32_le()?;
        __struct.onboard_control_sensors_enabled = buf.get_u32_le()?;
        __struct.onboard_control_sensors_health = buf.get_u32_le()?;
        __struct.load = buf.get_u16_le()?;
        __struct.voltage_battery = buf.get_u16_le()?;
        __struct.current_battery = buf.get_i16_le()?;
        __struct.drop_rate_comm = buf.get_u16_le()?;
        __struct.errors_comm = buf.get_u16_le()?;
        __struct.errors_count1 = buf.get_u16_le()?;
        __struct.errors_count2 = buf.get_u16_le()?;
        __struct.errors_count3 = buf.get_u16_le()?;
        __struct.errors_count4 = buf.get_u16_le()?;
        __struct.battery_remaining = buf.get_i8()?;
        __struct.onboard_control_sensors_present_extended = buf.get_u32_le()?;
        __struct.onboard_control_sensors_enabled_extended = buf.get_u32_le()?;
        __struct.onboard_control_sensors_health_extended = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.onboard_control_sensors_present);
        __tmp.put_u32_le(self.onboard_control_sensors_enabled);
        __tmp.put_u32_le(self.onboard_control_sensors_health);
        __tmp.put_u16_le(self.load);
        __tmp.put_u16_le(self.voltage_battery);
        __tmp.put_i16_le(self.current_battery);
        __tmp.put_u16_le(self.drop_rate_comm);
        __tmp.put_u16_le(self.errors_comm);
        __tmp.put_u16_le(self.errors_count1);
        __tmp.put_u16_le(self.errors_count2);
        __tmp.put_u16_le(self.errors_count3);
        __tmp.put_u16_le(self.errors_count4);
        __tmp.put_i8(self.battery_remaining);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u32_le(self.onboard_control_sensors_present_extended);
            __tmp.put_u32_le(self.onboard_control_sensors_enabled_extended);
            __tmp.put_u32_le(self.onboard_control_sensors_health_extended);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 111
#[derive(Debug, Clone, PartialEq)]
pub struct TIMESYNC_DATA {
    pub tc1: i64,
    pub ts1: i64,
}
impl TIMESYNC_DATA {
    pub const ENCODED_LEN: usize = 16usize;
    pub const DEFAULT: Self = Self { tc1: 0_i64, ts1: 0_i64 };
}
impl Default for TIMESYNC_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for TIMESYNC_DATA {
    type Message = MavMessage;
    const ID: u32 = 111u32;
    const NAME: &'static str = "TIMESYNC";
    const EXTRA_CRC: u8 = 34u8;
    const ENCODED_LEN: usize = 16usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.tc1 = buf.get_i64_le()?;
        __struct.ts1 = buf.get_i64_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i64_le(self.tc1);
        __tmp.put_i64_le(self.ts1);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 385
#[derive(Debug, Clone, PartialEq)]
pub struct TUNNEL_DATA {
    pub payload_type: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub payload_length: u8,
    pub payload: [u8; 128],
}
impl TUNNEL_DATA {
    pub const ENCODED_LEN: usize = 133usize;
    pub const DEFAULT: Self = Self {
        payload_type: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        payload_length: 0_u8,
        payload: [0_u8; 128usize],
    };
}
impl Default for TUNNEL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for TUNNEL_DATA {
    type Message = MavMessage;
    const ID: u32 = 385u32;
    const NAME: &'static str = "TUNNEL";
    const EXTRA_CRC: u8 = 147u8;
    const ENCODED_LEN: usize = 133usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.payload_type = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.payload_length = buf.get_u8()?;
        for v in &mut __struct.payload {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.payload_type);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.payload_length);
        for val in &self.payload {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
///As in the public common dialect.
///
///ID: 74
#[derive(Debug, Clone, PartialEq)]
pub struct VFR_HUD_DATA {
    pub airspeed: f32,
    pub groundspeed: f32,
    pub alt: f32,
    pub climb: f32,
    pub heading: i16,
    pub throttle: u16,
}
impl VFR_HUD_DATA {
    pub const ENCODED_LEN: usize = 20usize;
    pub const DEFAULT: Self = Self {
        airspeed: 0.0_f32,
        groundspeed: 0.0_f32,
        alt: 0.0_f32,
        climb: 0.0_f32,
        heading: 0_i16,
        throttle: 0_u16,
    };
}
impl Default for VFR_HUD_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for VFR_HUD_DATA {
    type Message = MavMessage;
    const ID: u32 = 74u32;
    const NAME: &'static str = "VFR_HUD";
    const EXTRA_CRC: u8 = 20u8;
    const ENCODED_LEN: usize = 20usize;
    fn deser(
        _version: MavlinkVersion,
        __input: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.airspeed = buf.get_f32_le()?;
        __struct.groundspeed = buf.get_f32_le()?;
        __struct.alt = buf.get_f32_le()?;
        __struct.climb = buf.get_f32_le()?;
        __struct.heading = buf.get_i16_le()?;
        __struct.throttle = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})", Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.airspeed);
        __tmp.put_f32_le(self.groundspeed);
        __tmp.put_f32_le(self.alt);
        __tmp.put_f32_le(self.climb);
        __tmp.put_i16_le(self.heading);
        __tmp.put_u16_le(self.throttle);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[derive(Clone, PartialEq, Debug)]
#[repr(u32)]
pub enum MavMessage {
    ///As in the public common dialect.
    ///
    ///ID: 30
    ATTITUDE(ATTITUDE_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 148
    AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 147
    BATTERY_STATUS(BATTERY_STATUS_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 77
    COMMAND_ACK(COMMAND_ACK_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 75
    COMMAND_INT(COMMAND_INT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 76
    COMMAND_LONG(COMMAND_LONG_DATA),
    ///As in the public ardupilotmega dialect.
    ///
    ///ID: 193
    EKF_STATUS_REPORT(EKF_STATUS_REPORT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 230
    ESTIMATOR_STATUS(ESTIMATOR_STATUS_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 245
    EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 110
    FILE_TRANSFER_PROTOCOL(FILE_TRANSFER_PROTOCOL_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 33
    GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 124
    GPS2_RAW(GPS2_RAW_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 49
    GPS_GLOBAL_ORIGIN(GPS_GLOBAL_ORIGIN_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 24
    GPS_RAW_INT(GPS_RAW_INT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 0
    HEARTBEAT(HEARTBEAT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 242
    HOME_POSITION(HOME_POSITION_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 32
    LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 69
    MANUAL_CONTROL(MANUAL_CONTROL_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 244
    MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 47
    MISSION_ACK(MISSION_ACK_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 45
    MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 44
    MISSION_COUNT(MISSION_COUNT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 42
    MISSION_CURRENT(MISSION_CURRENT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 39
    MISSION_ITEM(MISSION_ITEM_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 73
    MISSION_ITEM_INT(MISSION_ITEM_INT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 46
    MISSION_ITEM_REACHED(MISSION_ITEM_REACHED_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 40
    MISSION_REQUEST(MISSION_REQUEST_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 51
    MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 43
    MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 41
    MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 21
    PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 20
    PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 23
    PARAM_SET(PARAM_SET_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 22
    PARAM_VALUE(PARAM_VALUE_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 4
    PING(PING_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 87
    POSITION_TARGET_GLOBAL_INT(POSITION_TARGET_GLOBAL_INT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 85
    POSITION_TARGET_LOCAL_NED(POSITION_TARGET_LOCAL_NED_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 66
    REQUEST_DATA_STREAM(REQUEST_DATA_STREAM_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 256
    SETUP_SIGNING(SETUP_SIGNING_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 48
    SET_GPS_GLOBAL_ORIGIN(SET_GPS_GLOBAL_ORIGIN_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 11
    SET_MODE(SET_MODE_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 86
    SET_POSITION_TARGET_GLOBAL_INT(SET_POSITION_TARGET_GLOBAL_INT_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 84
    SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 253
    STATUSTEXT(STATUSTEXT_DATA),
    ///Answer to a STAYA_MESSAGE to one robot.
    ///
    ///ID: 9500003
    STAYA_ACK(STAYA_ACK_DATA),
    ///Position, velocity and state of a robot, and what its law says. Sent once per period.
    ///
    ///ID: 9500000
    STAYA_BEACON(STAYA_BEACON_DATA),
    ///A goal on the grid for a formation's leader and all its followers.
    ///
    ///ID: 9500005
    STAYA_GOAL(STAYA_GOAL_DATA),
    ///A robot that fell silent, for robots that never heard it; sent in turn behind beacons. A ground station clears a place with is_lost 0 and age 0.
    ///
    ///ID: 9500009
    STAYA_LOST(STAYA_LOST_DATA),
    ///Message of a law to one robot (up to 12 bytes) or to all robots, or an order to a law with a protocol of users.
    ///
    ///ID: 9500002
    STAYA_MESSAGE(STAYA_MESSAGE_DATA),
    ///A waypoint, one of several that may move.
    ///
    ///ID: 9500006
    STAYA_PLACE(STAYA_PLACE_DATA),
    ///One part of a robot's place in a formation: the place and its neighbours.
    ///
    ///ID: 9500004
    STAYA_TEMPLATE(STAYA_TEMPLATE_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 2
    SYSTEM_TIME(SYSTEM_TIME_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 1
    SYS_STATUS(SYS_STATUS_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 111
    TIMESYNC(TIMESYNC_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 385
    TUNNEL(TUNNEL_DATA),
    ///As in the public common dialect.
    ///
    ///ID: 74
    VFR_HUD(VFR_HUD_DATA),
}
impl MavMessage {
    pub const fn all_ids() -> &'static [u32] {
        &[
            0u32, 1u32, 2u32, 4u32, 11u32, 20u32, 21u32, 22u32, 23u32, 24u32, 30u32,
            32u32, 33u32, 39u32, 40u32, 41u32, 42u32, 43u32, 44u32, 45u32, 46u32, 47u32,
            48u32, 49u32, 51u32, 66u32, 69u32, 73u32, 74u32, 75u32, 76u32, 77u32, 84u32,
            85u32, 86u32, 87u32, 110u32, 111u32, 124u32, 147u32, 148u32, 193u32, 230u32,
            242u32, 244u32, 245u32, 253u32, 256u32, 385u32, 9500000u32, 9500002u32,
            9500003u32, 9500004u32, 9500005u32, 9500006u32, 9500009u32,
        ]
    }
    pub const fn all_messages() -> &'static [(&'static str, u32)] {
        &[
            (HEARTBEAT_DATA::NAME, HEARTBEAT_DATA::ID),
            (SYS_STATUS_DATA::NAME, SYS_STATUS_DATA::ID),
            (SYSTEM_TIME_DATA::NAME, SYSTEM_TIME_DATA::ID),
            (PING_DATA::NAME, PING_DATA::ID),
            (SET_MODE_DATA::NAME, SET_MODE_DATA::ID),
            (PARAM_REQUEST_READ_DATA::NAME, PARAM_REQUEST_READ_DATA::ID),
            (PARAM_REQUEST_LIST_DATA::NAME, PARAM_REQUEST_LIST_DATA::ID),
            (PARAM_VALUE_DATA::NAME, PARAM_VALUE_DATA::ID),
            (PARAM_SET_DATA::NAME, PARAM_SET_DATA::ID),
            (GPS_RAW_INT_DATA::NAME, GPS_RAW_INT_DATA::ID),
            (ATTITUDE_DATA::NAME, ATTITUDE_DATA::ID),
            (LOCAL_POSITION_NED_DATA::NAME, LOCAL_POSITION_NED_DATA::ID),
            (GLOBAL_POSITION_INT_DATA::NAME, GLOBAL_POSITION_INT_DATA::ID),
            (MISSION_ITEM_DATA::NAME, MISSION_ITEM_DATA::ID),
            (MISSION_REQUEST_DATA::NAME, MISSION_REQUEST_DATA::ID),
            (MISSION_SET_CURRENT_DATA::NAME, MISSION_SET_CURRENT_DATA::ID),
            (MISSION_CURRENT_DATA::NAME, MISSION_CURRENT_DATA::ID),
            (MISSION_REQUEST_LIST_DATA::NAME, MISSION_REQUEST_LIST_DATA::ID),
            (MISSION_COUNT_DATA::NAME, MISSION_COUNT_DATA::ID),
            (MISSION_CLEAR_ALL_DATA::NAME, MISSION_CLEAR_ALL_DATA::ID),
            (MISSION_ITEM_REACHED_DATA::NAME, MISSION_ITEM_REACHED_DATA::ID),
            (MISSION_ACK_DATA::NAME, MISSION_ACK_DATA::ID),
            (SET_GPS_GLOBAL_ORIGIN_DATA::NAME, SET_GPS_GLOBAL_ORIGIN_DATA::ID),
            (GPS_GLOBAL_ORIGIN_DATA::NAME, GPS_GLOBAL_ORIGIN_DATA::ID),
            (MISSION_REQUEST_INT_DATA::NAME, MISSION_REQUEST_INT_DATA::ID),
            (REQUEST_DATA_STREAM_DATA::NAME, REQUEST_DATA_STREAM_DATA::ID),
            (MANUAL_CONTROL_DATA::NAME, MANUAL_CONTROL_DATA::ID),
            (MISSION_ITEM_INT_DATA::NAME, MISSION_ITEM_INT_DATA::ID),
            (VFR_HUD_DATA::NAME, VFR_HUD_DATA::ID),
            (COMMAND_INT_DATA::NAME, COMMAND_INT_DATA::ID),
            (COMMAND_LONG_DATA::NAME, COMMAND_LONG_DATA::ID),
            (COMMAND_ACK_DATA::NAME, COMMAND_ACK_DATA::ID),
            (
                SET_POSITION_TARGET_LOCAL_NED_DATA::NAME,
                SET_POSITION_TARGET_LOCAL_NED_DATA::ID,
            ),
            (POSITION_TARGET_LOCAL_NED_DATA::NAME, POSITION_TARGET_LOCAL_NED_DATA::ID),
            (
                SET_POSITION_TARGET_GLOBAL_INT_DATA::NAME,
                SET_POSITION_TARGET_GLOBAL_INT_DATA::ID,
            ),
            (POSITION_TARGET_GLOBAL_INT_DATA::NAME, POSITION_TARGET_GLOBAL_INT_DATA::ID),
            (FILE_TRANSFER_PROTOCOL_DATA::NAME, FILE_TRANSFER_PROTOCOL_DATA::ID),
            (TIMESYNC_DATA::NAME, TIMESYNC_DATA::ID),
            (GPS2_RAW_DATA::NAME, GPS2_RAW_DATA::ID),
            (BATTERY_STATUS_DATA::NAME, BATTERY_STATUS_DATA::ID),
            (AUTOPILOT_VERSION_DATA::NAME, AUTOPILOT_VERSION_DATA::ID),
            (EKF_STATUS_REPORT_DATA::NAME, EKF_STATUS_REPORT_DATA::ID),
            (ESTIMATOR_STATUS_DATA::NAME, ESTIMATOR_STATUS_DATA::ID),
            (HOME_POSITION_DATA::NAME, HOME_POSITION_DATA::ID),
            (MESSAGE_INTERVAL_DATA::NAME, MESSAGE_INTERVAL_DATA::ID),
            (EXTENDED_SYS_STATE_DATA::NAME, EXTENDED_SYS_STATE_DATA::ID),
            (STATUSTEXT_DATA::NAME, STATUSTEXT_DATA::ID),
            (SETUP_SIGNING_DATA::NAME, SETUP_SIGNING_DATA::ID),
            (TUNNEL_DATA::NAME, TUNNEL_DATA::ID),
            (STAYA_BEACON_DATA::NAME, STAYA_BEACON_DATA::ID),
            (STAYA_MESSAGE_DATA::NAME, STAYA_MESSAGE_DATA::ID),
            (STAYA_ACK_DATA::NAME, STAYA_ACK_DATA::ID),
            (STAYA_TEMPLATE_DATA::NAME, STAYA_TEMPLATE_DATA::ID),
            (STAYA_GOAL_DATA::NAME, STAYA_GOAL_DATA::ID),
            (STAYA_PLACE_DATA::NAME, STAYA_PLACE_DATA::ID),
            (STAYA_LOST_DATA::NAME, STAYA_LOST_DATA::ID),
        ]
    }
}
impl Message for MavMessage {
    fn parse(
        version: MavlinkVersion,
        id: u32,
        payload: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        match id {
            ATTITUDE_DATA::ID => {
                ATTITUDE_DATA::deser(version, payload).map(Self::ATTITUDE)
            }
            AUTOPILOT_VERSION_DATA::ID => {
                AUTOPILOT_VERSION_DATA::deser(version, payload)
                    .map(Self::AUTOPILOT_VERSION)
            }
            BATTERY_STATUS_DATA::ID => {
                BATTERY_STATUS_DATA::deser(version, payload).map(Self::BATTERY_STATUS)
            }
            COMMAND_ACK_DATA::ID => {
                COMMAND_ACK_DATA::deser(version, payload).map(Self::COMMAND_ACK)
            }
            COMMAND_INT_DATA::ID => {
                COMMAND_INT_DATA::deser(version, payload).map(Self::COMMAND_INT)
            }
            COMMAND_LONG_DATA::ID => {
                COMMAND_LONG_DATA::deser(version, payload).map(Self::COMMAND_LONG)
            }
            EKF_STATUS_REPORT_DATA::ID => {
                EKF_STATUS_REPORT_DATA::deser(version, payload)
                    .map(Self::EKF_STATUS_REPORT)
            }
            ESTIMATOR_STATUS_DATA::ID => {
                ESTIMATOR_STATUS_DATA::deser(version, payload)
                    .map(Self::ESTIMATOR_STATUS)
            }
            EXTENDED_SYS_STATE_DATA::ID => {
                EXTENDED_SYS_STATE_DATA::deser(version, payload)
                    .map(Self::EXTENDED_SYS_STATE)
            }
            FILE_TRANSFER_PROTOCOL_DATA::ID => {
                FILE_TRANSFER_PROTOCOL_DATA::deser(version, payload)
                    .map(Self::FILE_TRANSFER_PROTOCOL)
            }
            GLOBAL_POSITION_INT_DATA::ID => {
                GLOBAL_POSITION_INT_DATA::deser(version, payload)
                    .map(Self::GLOBAL_POSITION_INT)
            }
            GPS2_RAW_DATA::ID => {
                GPS2_RAW_DATA::deser(version, payload).map(Self::GPS2_RAW)
            }
            GPS_GLOBAL_ORIGIN_DATA::ID => {
                GPS_GLOBAL_ORIGIN_DATA::deser(version, payload)
                    .map(Self::GPS_GLOBAL_ORIGIN)
            }
            GPS_RAW_INT_DATA::ID => {
                GPS_RAW_INT_DATA::deser(version, payload).map(Self::GPS_RAW_INT)
            }
            HEARTBEAT_DATA::ID => {
                HEARTBEAT_DATA::deser(version, payload).map(Self::HEARTBEAT)
            }
            HOME_POSITION_DATA::ID => {
                HOME_POSITION_DATA::deser(version, payload).map(Self::HOME_POSITION)
            }
            LOCAL_POSITION_NED_DATA::ID => {
                LOCAL_POSITION_NED_DATA::deser(version, payload)
                    .map(Self::LOCAL_POSITION_NED)
            }
            MANUAL_CONTROL_DATA::ID => {
                MANUAL_CONTROL_DATA::deser(version, payload).map(Self::MANUAL_CONTROL)
            }
            MESSAGE_INTERVAL_DATA::ID => {
                MESSAGE_INTERVAL_DATA::deser(version, payload)
                    .map(Self::MESSAGE_INTERVAL)
            }
            MISSION_ACK_DATA::ID => {
                MISSION_ACK_DATA::deser(version, payload).map(Self::MISSION_ACK)
            }
            MISSION_CLEAR_ALL_DATA::ID => {
                MISSION_CLEAR_ALL_DATA::deser(version, payload)
                    .map(Self::MISSION_CLEAR_ALL)
            }
            MISSION_COUNT_DATA::ID => {
                MISSION_COUNT_DATA::deser(version, payload).map(Self::MISSION_COUNT)
            }
            MISSION_CURRENT_DATA::ID => {
                MISSION_CURRENT_DATA::deser(version, payload).map(Self::MISSION_CURRENT)
            }
            MISSION_ITEM_DATA::ID => {
                MISSION_ITEM_DATA::deser(version, payload).map(Self::MISSION_ITEM)
            }
            MISSION_ITEM_INT_DATA::ID => {
                MISSION_ITEM_INT_DATA::deser(version, payload)
                    .map(Self::MISSION_ITEM_INT)
            }
            MISSION_ITEM_REACHED_DATA::ID => {
                MISSION_ITEM_REACHED_DATA::deser(version, payload)
                    .map(Self::MISSION_ITEM_REACHED)
            }
            MISSION_REQUEST_DATA::ID => {
                MISSION_REQUEST_DATA::deser(version, payload).map(Self::MISSION_REQUEST)
            }
            MISSION_REQUEST_INT_DATA::ID => {
                MISSION_REQUEST_INT_DATA::deser(version, payload)
                    .map(Self::MISSION_REQUEST_INT)
            }
            MISSION_REQUEST_LIST_DATA::ID => {
                MISSION_REQUEST_LIST_DATA::deser(version, payload)
                    .map(Self::MISSION_REQUEST_LIST)
            }
            MISSION_SET_CURRENT_DATA::ID => {
                MISSION_SET_CURRENT_DATA::deser(version, payload)
                    .map(Self::MISSION_SET_CURRENT)
            }
            PARAM_REQUEST_LIST_DATA::ID => {
                PARAM_REQUEST_LIST_DATA::deser(version, payload)
                    .map(Self::PARAM_REQUEST_LIST)
            }
            PARAM_REQUEST_READ_DATA::ID => {
                PARAM_REQUEST_READ_DATA::deser(version, payload)
                    .map(Self::PARAM_REQUEST_READ)
            }
            PARAM_SET_DATA::ID => {
                PARAM_SET_DATA::deser(version, payload).map(Self::PARAM_SET)
            }
            PARAM_VALUE_DATA::ID => {
                PARAM_VALUE_DATA::deser(version, payload).map(Self::PARAM_VALUE)
            }
            PING_DATA::ID => PING_DATA::deser(version, payload).map(Self::PING),
            POSITION_TARGET_GLOBAL_INT_DATA::ID => {
                POSITION_TARGET_GLOBAL_INT_DATA::deser(version, payload)
                    .map(Self::POSITION_TARGET_GLOBAL_INT)
            }
            POSITION_TARGET_LOCAL_NED_DATA::ID => {
                POSITION_TARGET_LOCAL_NED_DATA::deser(version, payload)
                    .map(Self::POSITION_TARGET_LOCAL_NED)
            }
            REQUEST_DATA_STREAM_DATA::ID => {
                REQUEST_DATA_STREAM_DATA::deser(version, payload)
                    .map(Self::REQUEST_DATA_STREAM)
            }
            SETUP_SIGNING_DATA::ID => {
                SETUP_SIGNING_DATA::deser(version, payload).map(Self::SETUP_SIGNING)
            }
            SET_GPS_GLOBAL_ORIGIN_DATA::ID => {
                SET_GPS_GLOBAL_ORIGIN_DATA::deser(version, payload)
                    .map(Self::SET_GPS_GLOBAL_ORIGIN)
            }
            SET_MODE_DATA::ID => {
                SET_MODE_DATA::deser(version, payload).map(Self::SET_MODE)
            }
            SET_POSITION_TARGET_GLOBAL_INT_DATA::ID => {
                SET_POSITION_TARGET_GLOBAL_INT_DATA::deser(version, payload)
                    .map(Self::SET_POSITION_TARGET_GLOBAL_INT)
            }
            SET_POSITION_TARGET_LOCAL_NED_DATA::ID => {
                SET_POSITION_TARGET_LOCAL_NED_DATA::deser(version, payload)
                    .map(Self::SET_POSITION_TARGET_LOCAL_NED)
            }
            STATUSTEXT_DATA::ID => {
                STATUSTEXT_DATA::deser(version, payload).map(Self::STATUSTEXT)
            }
            STAYA_ACK_DATA::ID => {
                STAYA_ACK_DATA::deser(version, payload).map(Self::STAYA_ACK)
            }
            STAYA_BEACON_DATA::ID => {
                STAYA_BEACON_DATA::deser(version, payload).map(Self::STAYA_BEACON)
            }
            STAYA_GOAL_DATA::ID => {
                STAYA_GOAL_DATA::deser(version, payload).map(Self::STAYA_GOAL)
            }
            STAYA_LOST_DATA::ID => {
                STAYA_LOST_DATA::deser(version, payload).map(Self::STAYA_LOST)
            }
            STAYA_MESSAGE_DATA::ID => {
                STAYA_MESSAGE_DATA::deser(version, payload).map(Self::STAYA_MESSAGE)
            }
            STAYA_PLACE_DATA::ID => {
                STAYA_PLACE_DATA::deser(version, payload).map(Self::STAYA_PLACE)
            }
            STAYA_TEMPLATE_DATA::ID => {
                STAYA_TEMPLATE_DATA::deser(version, payload).map(Self::STAYA_TEMPLATE)
            }
            SYSTEM_TIME_DATA::ID => {
                SYSTEM_TIME_DATA::deser(version, payload).map(Self::SYSTEM_TIME)
            }
            SYS_STATUS_DATA::ID => {
                SYS_STATUS_DATA::deser(version, payload).map(Self::SYS_STATUS)
            }
            TIMESYNC_DATA::ID => {
                TIMESYNC_DATA::deser(version, payload).map(Self::TIMESYNC)
            }
            TUNNEL_DATA::ID => TUNNEL_DATA::deser(version, payload).map(Self::TUNNEL),
            VFR_HUD_DATA::ID => VFR_HUD_DATA::deser(version, payload).map(Self::VFR_HUD),
            _ => {
                Err(::mavlink_core::error::ParserError::UnknownMessage {
                    id,
                })
            }
        }
    }
    fn message_name(&self) -> &'static str {
        match self {
            Self::ATTITUDE(..) => ATTITUDE_DATA::NAME,
            Self::AUTOPILOT_VERSION(..) => AUTOPILOT_VERSION_DATA::NAME,
            Self::BATTERY_STATUS(..) => BATTERY_STATUS_DATA::NAME,
            Self::COMMAND_ACK(..) => COMMAND_ACK_DATA::NAME,
            Self::COMMAND_INT(..) => COMMAND_INT_DATA::NAME,
            Self::COMMAND_LONG(..) => COMMAND_LONG_DATA::NAME,
            Self::EKF_STATUS_REPORT(..) => EKF_STATUS_REPORT_DATA::NAME,
            Self::ESTIMATOR_STATUS(..) => ESTIMATOR_STATUS_DATA::NAME,
            Self::EXTENDED_SYS_STATE(..) => EXTENDED_SYS_STATE_DATA::NAME,
            Self::FILE_TRANSFER_PROTOCOL(..) => FILE_TRANSFER_PROTOCOL_DATA::NAME,
            Self::GLOBAL_POSITION_INT(..) => GLOBAL_POSITION_INT_DATA::NAME,
            Self::GPS2_RAW(..) => GPS2_RAW_DATA::NAME,
            Self::GPS_GLOBAL_ORIGIN(..) => GPS_GLOBAL_ORIGIN_DATA::NAME,
            Self::GPS_RAW_INT(..) => GPS_RAW_INT_DATA::NAME,
            Self::HEARTBEAT(..) => HEARTBEAT_DATA::NAME,
            Self::HOME_POSITION(..) => HOME_POSITION_DATA::NAME,
            Self::LOCAL_POSITION_NED(..) => LOCAL_POSITION_NED_DATA::NAME,
            Self::MANUAL_CONTROL(..) => MANUAL_CONTROL_DATA::NAME,
            Self::MESSAGE_INTERVAL(..) => MESSAGE_INTERVAL_DATA::NAME,
            Self::MISSION_ACK(..) => MISSION_ACK_DATA::NAME,
            Self::MISSION_CLEAR_ALL(..) => MISSION_CLEAR_ALL_DATA::NAME,
            Self::MISSION_COUNT(..) => MISSION_COUNT_DATA::NAME,
            Self::MISSION_CURRENT(..) => MISSION_CURRENT_DATA::NAME,
            Self::MISSION_ITEM(..) => MISSION_ITEM_DATA::NAME,
            Self::MISSION_ITEM_INT(..) => MISSION_ITEM_INT_DATA::NAME,
            Self::MISSION_ITEM_REACHED(..) => MISSION_ITEM_REACHED_DATA::NAME,
            Self::MISSION_REQUEST(..) => MISSION_REQUEST_DATA::NAME,
            Self::MISSION_REQUEST_INT(..) => MISSION_REQUEST_INT_DATA::NAME,
            Self::MISSION_REQUEST_LIST(..) => MISSION_REQUEST_LIST_DATA::NAME,
            Self::MISSION_SET_CURRENT(..) => MISSION_SET_CURRENT_DATA::NAME,
            Self::PARAM_REQUEST_LIST(..) => PARAM_REQUEST_LIST_DATA::NAME,
            Self::PARAM_REQUEST_READ(..) => PARAM_REQUEST_READ_DATA::NAME,
            Self::PARAM_SET(..) => PARAM_SET_DATA::NAME,
            Self::PARAM_VALUE(..) => PARAM_VALUE_DATA::NAME,
            Self::PING(..) => PING_DATA::NAME,
            Self::POSITION_TARGET_GLOBAL_INT(..) => POSITION_TARGET_GLOBAL_INT_DATA::NAME,
            Self::POSITION_TARGET_LOCAL_NED(..) => POSITION_TARGET_LOCAL_NED_DATA::NAME,
            Self::REQUEST_DATA_STREAM(..) => REQUEST_DATA_STREAM_DATA::NAME,
            Self::SETUP_SIGNING(..) => SETUP_SIGNING_DATA::NAME,
            Self::SET_GPS_GLOBAL_ORIGIN(..) => SET_GPS_GLOBAL_ORIGIN_DATA::NAME,
            Self::SET_MODE(..) => SET_MODE_DATA::NAME,
            Self::SET_POSITION_TARGET_GLOBAL_INT(..) => {
                SET_POSITION_TARGET_GLOBAL_INT_DATA::NAME
            }
            Self::SET_POSITION_TARGET_LOCAL_NED(..) => {
                SET_POSITION_TARGET_LOCAL_NED_DATA::NAME
            }
            Self::STATUSTEXT(..) => STATUSTEXT_DATA::NAME,
            Self::STAYA_ACK(..) => STAYA_ACK_DATA::NAME,
            Self::STAYA_BEACON(..) => STAYA_BEACON_DATA::NAME,
            Self::STAYA_GOAL(..) => STAYA_GOAL_DATA::NAME,
            Self::STAYA_LOST(..) => STAYA_LOST_DATA::NAME,
            Self::STAYA_MESSAGE(..) => STAYA_MESSAGE_DATA::NAME,
            Self::STAYA_PLACE(..) => STAYA_PLACE_DATA::NAME,
            Self::STAYA_TEMPLATE(..) => STAYA_TEMPLATE_DATA::NAME,
            Self::SYSTEM_TIME(..) => SYSTEM_TIME_DATA::NAME,
            Self::SYS_STATUS(..) => SYS_STATUS_DATA::NAME,
            Self::TIMESYNC(..) => TIMESYNC_DATA::NAME,
            Self::TUNNEL(..) => TUNNEL_DATA::NAME,
            Self::VFR_HUD(..) => VFR_HUD_DATA::NAME,
        }
    }
    fn message_id(&self) -> u32 {
        match self {
            Self::ATTITUDE(..) => ATTITUDE_DATA::ID,
            Self::AUTOPILOT_VERSION(..) => AUTOPILOT_VERSION_DATA::ID,
            Self::BATTERY_STATUS(..) => BATTERY_STATUS_DATA::ID,
            Self::COMMAND_ACK(..) => COMMAND_ACK_DATA::ID,
            Self::COMMAND_INT(..) => COMMAND_INT_DATA::ID,
            Self::COMMAND_LONG(..) => COMMAND_LONG_DATA::ID,
            Self::EKF_STATUS_REPORT(..) => EKF_STATUS_REPORT_DATA::ID,
            Self::ESTIMATOR_STATUS(..) => ESTIMATOR_STATUS_DATA::ID,
            Self::EXTENDED_SYS_STATE(..) => EXTENDED_SYS_STATE_DATA::ID,
            Self::FILE_TRANSFER_PROTOCOL(..) => FILE_TRANSFER_PROTOCOL_DATA::ID,
            Self::GLOBAL_POSITION_INT(..) => GLOBAL_POSITION_INT_DATA::ID,
            Self::GPS2_RAW(..) => GPS2_RAW_DATA::ID,
            Self::GPS_GLOBAL_ORIGIN(..) => GPS_GLOBAL_ORIGIN_DATA::ID,
            Self::GPS_RAW_INT(..) => GPS_RAW_INT_DATA::ID,
            Self::HEARTBEAT(..) => HEARTBEAT_DATA::ID,
            Self::HOME_POSITION(..) => HOME_POSITION_DATA::ID,
            Self::LOCAL_POSITION_NED(..) => LOCAL_POSITION_NED_DATA::ID,
            Self::MANUAL_CONTROL(..) => MANUAL_CONTROL_DATA::ID,
            Self::MESSAGE_INTERVAL(..) => MESSAGE_INTERVAL_DATA::ID,
            Self::MISSION_ACK(..) => MISSION_ACK_DATA::ID,
            Self::MISSION_CLEAR_ALL(..) => MISSION_CLEAR_ALL_DATA::ID,
            Self::MISSION_COUNT(..) => MISSION_COUNT_DATA::ID,
            Self::MISSION_CURRENT(..) => MISSION_CURRENT_DATA::ID,
            Self::MISSION_ITEM(..) => MISSION_ITEM_DATA::ID,
            Self::MISSION_ITEM_INT(..) => MISSION_ITEM_INT_DATA::ID,
            Self::MISSION_ITEM_REACHED(..) => MISSION_ITEM_REACHED_DATA::ID,
            Self::MISSION_REQUEST(..) => MISSION_REQUEST_DATA::ID,
            Self::MISSION_REQUEST_INT(..) => MISSION_REQUEST_INT_DATA::ID,
            Self::MISSION_REQUEST_LIST(..) => MISSION_REQUEST_LIST_DATA::ID,
            Self::MISSION_SET_CURRENT(..) => MISSION_SET_CURRENT_DATA::ID,
            Self::PARAM_REQUEST_LIST(..) => PARAM_REQUEST_LIST_DATA::ID,
            Self::PARAM_REQUEST_READ(..) => PARAM_REQUEST_READ_DATA::ID,
            Self::PARAM_SET(..) => PARAM_SET_DATA::ID,
            Self::PARAM_VALUE(..) => PARAM_VALUE_DATA::ID,
            Self::PING(..) => PING_DATA::ID,
            Self::POSITION_TARGET_GLOBAL_INT(..) => POSITION_TARGET_GLOBAL_INT_DATA::ID,
            Self::POSITION_TARGET_LOCAL_NED(..) => POSITION_TARGET_LOCAL_NED_DATA::ID,
            Self::REQUEST_DATA_STREAM(..) => REQUEST_DATA_STREAM_DATA::ID,
            Self::SETUP_SIGNING(..) => SETUP_SIGNING_DATA::ID,
            Self::SET_GPS_GLOBAL_ORIGIN(..) => SET_GPS_GLOBAL_ORIGIN_DATA::ID,
            Self::SET_MODE(..) => SET_MODE_DATA::ID,
            Self::SET_POSITION_TARGET_GLOBAL_INT(..) => {
                SET_POSITION_TARGET_GLOBAL_INT_DATA::ID
            }
            Self::SET_POSITION_TARGET_LOCAL_NED(..) => {
                SET_POSITION_TARGET_LOCAL_NED_DATA::ID
            }
            Self::STATUSTEXT(..) => STATUSTEXT_DATA::ID,
            Self::STAYA_ACK(..) => STAYA_ACK_DATA::ID,
            Self::STAYA_BEACON(..) => STAYA_BEACON_DATA::ID,
            Self::STAYA_GOAL(..) => STAYA_GOAL_DATA::ID,
            Self::STAYA_LOST(..) => STAYA_LOST_DATA::ID,
            Self::STAYA_MESSAGE(..) => STAYA_MESSAGE_DATA::ID,
            Self::STAYA_PLACE(..) => STAYA_PLACE_DATA::ID,
            Self::STAYA_TEMPLATE(..) => STAYA_TEMPLATE_DATA::ID,
            Self::SYSTEM_TIME(..) => SYSTEM_TIME_DATA::ID,
            Self::SYS_STATUS(..) => SYS_STATUS_DATA::ID,
            Self::TIMESYNC(..) => TIMESYNC_DATA::ID,
            Self::TUNNEL(..) => TUNNEL_DATA::ID,
            Self::VFR_HUD(..) => VFR_HUD_DATA::ID,
        }
    }
    fn message_id_from_name(name: &str) -> Option<u32> {
        match name {
            ATTITUDE_DATA::NAME => Some(ATTITUDE_DATA::ID),
            AUTOPILOT_VERSION_DATA::NAME => Some(AUTOPILOT_VERSION_DATA::ID),
            BATTERY_STATUS_DATA::NAME => Some(BATTERY_STATUS_DATA::ID),
            COMMAND_ACK_DATA::NAME => Some(COMMAND_ACK_DATA::ID),
            COMMAND_INT_DATA::NAME => Some(COMMAND_INT_DATA::ID),
            COMMAND_LONG_DATA::NAME => Some(COMMAND_LONG_DATA::ID),
            EKF_STATUS_REPORT_DATA::NAME => Some(EKF_STATUS_REPORT_DATA::ID),
            ESTIMATOR_STATUS_DATA::NAME => Some(ESTIMATOR_STATUS_DATA::ID),
            EXTENDED_SYS_STATE_DATA::NAME => Some(EXTENDED_SYS_STATE_DATA::ID),
            FILE_TRANSFER_PROTOCOL_DATA::NAME => Some(FILE_TRANSFER_PROTOCOL_DATA::ID),
            GLOBAL_POSITION_INT_DATA::NAME => Some(GLOBAL_POSITION_INT_DATA::ID),
            GPS2_RAW_DATA::NAME => Some(GPS2_RAW_DATA::ID),
            GPS_GLOBAL_ORIGIN_DATA::NAME => Some(GPS_GLOBAL_ORIGIN_DATA::ID),
            GPS_RAW_INT_DATA::NAME => Some(GPS_RAW_INT_DATA::ID),
            HEARTBEAT_DATA::NAME => Some(HEARTBEAT_DATA::ID),
            HOME_POSITION_DATA::NAME => Some(HOME_POSITION_DATA::ID),
            LOCAL_POSITION_NED_DATA::NAME => Some(LOCAL_POSITION_NED_DATA::ID),
            MANUAL_CONTROL_DATA::NAME => Some(MANUAL_CONTROL_DATA::ID),
            MESSAGE_INTERVAL_DATA::NAME => Some(MESSAGE_INTERVAL_DATA::ID),
            MISSION_ACK_DATA::NAME => Some(MISSION_ACK_DATA::ID),
            MISSION_CLEAR_ALL_DATA::NAME => Some(MISSION_CLEAR_ALL_DATA::ID),
            MISSION_COUNT_DATA::NAME => Some(MISSION_COUNT_DATA::ID),
            MISSION_CURRENT_DATA::NAME => Some(MISSION_CURRENT_DATA::ID),
            MISSION_ITEM_DATA::NAME => Some(MISSION_ITEM_DATA::ID),
            MISSION_ITEM_INT_DATA::NAME => Some(MISSION_ITEM_INT_DATA::ID),
            MISSION_ITEM_REACHED_DATA::NAME => Some(MISSION_ITEM_REACHED_DATA::ID),
            MISSION_REQUEST_DATA::NAME => Some(MISSION_REQUEST_DATA::ID),
            MISSION_REQUEST_INT_DATA::NAME => Some(MISSION_REQUEST_INT_DATA::ID),
            MISSION_REQUEST_LIST_DATA::NAME => Some(MISSION_REQUEST_LIST_DATA::ID),
            MISSION_SET_CURRENT_DATA::NAME => Some(MISSION_SET_CURRENT_DATA::ID),
            PARAM_REQUEST_LIST_DATA::NAME => Some(PARAM_REQUEST_LIST_DATA::ID),
            PARAM_REQUEST_READ_DATA::NAME => Some(PARAM_REQUEST_READ_DATA::ID),
            PARAM_SET_DATA::NAME => Some(PARAM_SET_DATA::ID),
            PARAM_VALUE_DATA::NAME => Some(PARAM_VALUE_DATA::ID),
            PING_DATA::NAME => Some(PING_DATA::ID),
            POSITION_TARGET_GLOBAL_INT_DATA::NAME => {
                Some(POSITION_TARGET_GLOBAL_INT_DATA::ID)
            }
            POSITION_TARGET_LOCAL_NED_DATA::NAME => {
                Some(POSITION_TARGET_LOCAL_NED_DATA::ID)
            }
            REQUEST_DATA_STREAM_DATA::NAME => Some(REQUEST_DATA_STREAM_DATA::ID),
            SETUP_SIGNING_DATA::NAME => Some(SETUP_SIGNING_DATA::ID),
            SET_GPS_GLOBAL_ORIGIN_DATA::NAME => Some(SET_GPS_GLOBAL_ORIGIN_DATA::ID),
            SET_MODE_DATA::NAME => Some(SET_MODE_DATA::ID),
            SET_POSITION_TARGET_GLOBAL_INT_DATA::NAME => {
                Some(SET_POSITION_TARGET_GLOBAL_INT_DATA::ID)
            }
            SET_POSITION_TARGET_LOCAL_NED_DATA::NAME => {
                Some(SET_POSITION_TARGET_LOCAL_NED_DATA::ID)
            }
            STATUSTEXT_DATA::NAME => Some(STATUSTEXT_DATA::ID),
            STAYA_ACK_DATA::NAME => Some(STAYA_ACK_DATA::ID),
            STAYA_BEACON_DATA::NAME => Some(STAYA_BEACON_DATA::ID),
            STAYA_GOAL_DATA::NAME => Some(STAYA_GOAL_DATA::ID),
            STAYA_LOST_DATA::NAME => Some(STAYA_LOST_DATA::ID),
            STAYA_MESSAGE_DATA::NAME => Some(STAYA_MESSAGE_DATA::ID),
            STAYA_PLACE_DATA::NAME => Some(STAYA_PLACE_DATA::ID),
            STAYA_TEMPLATE_DATA::NAME => Some(STAYA_TEMPLATE_DATA::ID),
            SYSTEM_TIME_DATA::NAME => Some(SYSTEM_TIME_DATA::ID),
            SYS_STATUS_DATA::NAME => Some(SYS_STATUS_DATA::ID),
            TIMESYNC_DATA::NAME => Some(TIMESYNC_DATA::ID),
            TUNNEL_DATA::NAME => Some(TUNNEL_DATA::ID),
            VFR_HUD_DATA::NAME => Some(VFR_HUD_DATA::ID),
            _ => None,
        }
    }
    fn default_message_from_id(id: u32) -> Option<Self> {
        match id {
            ATTITUDE_DATA::ID => Some(Self::ATTITUDE(ATTITUDE_DATA::default())),
            AUTOPILOT_VERSION_DATA::ID => {
                Some(Self::AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA::default()))
            }
            BATTERY_STATUS_DATA::ID => {
                Some(Self::BATTERY_STATUS(BATTERY_STATUS_DATA::default()))
            }
            COMMAND_ACK_DATA::ID => Some(Self::COMMAND_ACK(COMMAND_ACK_DATA::default())),
            COMMAND_INT_DATA::ID => Some(Self::COMMAND_INT(COMMAND_INT_DATA::default())),
            COMMAND_LONG_DATA::ID => {
                Some(Self::COMMAND_LONG(COMMAND_LONG_DATA::default()))
            }
            EKF_STATUS_REPORT_DATA::ID => {
                Some(Self::EKF_STATUS_REPORT(EKF_STATUS_REPORT_DATA::default()))
            }
            ESTIMATOR_STATUS_DATA::ID => {
                Some(Self::ESTIMATOR_STATUS(ESTIMATOR_STATUS_DATA::default()))
            }
            EXTENDED_SYS_STATE_DATA::ID => {
                Some(Self::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA::default()))
            }
            FILE_TRANSFER_PROTOCOL_DATA::ID => {
                Some(
                    Self::FILE_TRANSFER_PROTOCOL(FILE_TRANSFER_PROTOCOL_DATA::default()),
                )
            }
            GLOBAL_POSITION_INT_DATA::ID => {
                Some(Self::GLOBAL_POSITION_INT(GLOBAL_POSITION_INT_DATA::default()))
            }
            GPS2_RAW_DATA::ID => Some(Self::GPS2_RAW(GPS2_RAW_DATA::default())),
            GPS_GLOBAL_ORIGIN_DATA::ID => {
                Some(Self::GPS_GLOBAL_ORIGIN(GPS_GLOBAL_ORIGIN_DATA::default()))
            }
            GPS_RAW_INT_DATA::ID => Some(Self::GPS_RAW_INT(GPS_RAW_INT_DATA::default())),
            HEARTBEAT_DATA::ID => Some(Self::HEARTBEAT(HEARTBEAT_DATA::default())),
            HOME_POSITION_DATA::ID => {
                Some(Self::HOME_POSITION(HOME_POSITION_DATA::default()))
            }
            LOCAL_POSITION_NED_DATA::ID => {
                Some(Self::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA::default()))
            }
            MANUAL_CONTROL_DATA::ID => {
                Some(Self::MANUAL_CONTROL(MANUAL_CONTROL_DATA::default()))
            }
            MESSAGE_INTERVAL_DATA::ID => {
                Some(Self::MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA::default()))
            }
            MISSION_ACK_DATA::ID => Some(Self::MISSION_ACK(MISSION_ACK_DATA::default())),
            MISSION_CLEAR_ALL_DATA::ID => {
                Some(Self::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA::default()))
            }
            MISSION_COUNT_DATA::ID => {
                Some(Self::MISSION_COUNT(MISSION_COUNT_DATA::default()))
            }
            MISSION_CURRENT_DATA::ID => {
                Some(Self::MISSION_CURRENT(MISSION_CURRENT_DATA::default()))
            }
            MISSION_ITEM_DATA::ID => {
                Some(Self::MISSION_ITEM(MISSION_ITEM_DATA::default()))
            }
            MISSION_ITEM_INT_DATA::ID => {
                Some(Self::MISSION_ITEM_INT(MISSION_ITEM_INT_DATA::default()))
            }
            MISSION_ITEM_REACHED_DATA::ID => {
                Some(Self::MISSION_ITEM_REACHED(MISSION_ITEM_REACHED_DATA::default()))
            }
            MISSION_REQUEST_DATA::ID => {
                Some(Self::MISSION_REQUEST(MISSION_REQUEST_DATA::default()))
            }
            MISSION_REQUEST_INT_DATA::ID => {
                Some(Self::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA::default()))
            }
            MISSION_REQUEST_LIST_DATA::ID => {
                Some(Self::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA::default()))
            }
            MISSION_SET_CURRENT_DATA::ID => {
                Some(Self::MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA::default()))
            }
            PARAM_REQUEST_LIST_DATA::ID => {
                Some(Self::PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA::default()))
            }
            PARAM_REQUEST_READ_DATA::ID => {
                Some(Self::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA::default()))
            }
            PARAM_SET_DATA::ID => Some(Self::PARAM_SET(PARAM_SET_DATA::default())),
            PARAM_VALUE_DATA::ID => Some(Self::PARAM_VALUE(PARAM_VALUE_DATA::default())),
            PING_DATA::ID => Some(Self::PING(PING_DATA::default())),
            POSITION_TARGET_GLOBAL_INT_DATA::ID => {
                Some(
                    Self::POSITION_TARGET_GLOBAL_INT(
                        POSITION_TARGET_GLOBAL_INT_DATA::default(),
                    ),
                )
            }
            POSITION_TARGET_LOCAL_NED_DATA::ID => {
                Some(
                    Self::POSITION_TARGET_LOCAL_NED(
                        POSITION_TARGET_LOCAL_NED_DATA::default(),
                    ),
                )
            }
            REQUEST_DATA_STREAM_DATA::ID => {
                Some(Self::REQUEST_DATA_STREAM(REQUEST_DATA_STREAM_DATA::default()))
            }
            SETUP_SIGNING_DATA::ID => {
                Some(Self::SETUP_SIGNING(SETUP_SIGNING_DATA::default()))
            }
            SET_GPS_GLOBAL_ORIGIN_DATA::ID => {
                Some(Self::SET_GPS_GLOBAL_ORIGIN(SET_GPS_GLOBAL_ORIGIN_DATA::default()))
            }
            SET_MODE_DATA::ID => Some(Self::SET_MODE(SET_MODE_DATA::default())),
            SET_POSITION_TARGET_GLOBAL_INT_DATA::ID => {
                Some(
                    Self::SET_POSITION_TARGET_GLOBAL_INT(
                        SET_POSITION_TARGET_GLOBAL_INT_DATA::default(),
                    ),
                )
            }
            SET_POSITION_TARGET_LOCAL_NED_DATA::ID => {
                Some(
                    Self::SET_POSITION_TARGET_LOCAL_NED(
                        SET_POSITION_TARGET_LOCAL_NED_DATA::default(),
                    ),
                )
            }
            STATUSTEXT_DATA::ID => Some(Self::STATUSTEXT(STATUSTEXT_DATA::default())),
            STAYA_ACK_DATA::ID => Some(Self::STAYA_ACK(STAYA_ACK_DATA::default())),
            STAYA_BEACON_DATA::ID => {
                Some(Self::STAYA_BEACON(STAYA_BEACON_DATA::default()))
            }
            STAYA_GOAL_DATA::ID => Some(Self::STAYA_GOAL(STAYA_GOAL_DATA::default())),
            STAYA_LOST_DATA::ID => Some(Self::STAYA_LOST(STAYA_LOST_DATA::default())),
            STAYA_MESSAGE_DATA::ID => {
                Some(Self::STAYA_MESSAGE(STAYA_MESSAGE_DATA::default()))
            }
            STAYA_PLACE_DATA::ID => Some(Self::STAYA_PLACE(STAYA_PLACE_DATA::default())),
            STAYA_TEMPLATE_DATA::ID => {
                Some(Self::STAYA_TEMPLATE(STAYA_TEMPLATE_DATA::default()))
            }
            SYSTEM_TIME_DATA::ID => Some(Self::SYSTEM_TIME(SYSTEM_TIME_DATA::default())),
            SYS_STATUS_DATA::ID => Some(Self::SYS_STATUS(SYS_STATUS_DATA::default())),
            TIMESYNC_DATA::ID => Some(Self::TIMESYNC(TIMESYNC_DATA::default())),
            TUNNEL_DATA::ID => Some(Self::TUNNEL(TUNNEL_DATA::default())),
            VFR_HUD_DATA::ID => Some(Self::VFR_HUD(VFR_HUD_DATA::default())),
            _ => None,
        }
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        match self {
            Self::ATTITUDE(body) => body.ser(version, bytes),
            Self::AUTOPILOT_VERSION(body) => body.ser(version, bytes),
            Self::BATTERY_STATUS(body) => body.ser(version, bytes),
            Self::COMMAND_ACK(body) => body.ser(version, bytes),
            Self::COMMAND_INT(body) => body.ser(version, bytes),
            Self::COMMAND_LONG(body) => body.ser(version, bytes),
            Self::EKF_STATUS_REPORT(body) => body.ser(version, bytes),
            Self::ESTIMATOR_STATUS(body) => body.ser(version, bytes),
            Self::EXTENDED_SYS_STATE(body) => body.ser(version, bytes),
            Self::FILE_TRANSFER_PROTOCOL(body) => body.ser(version, bytes),
            Self::GLOBAL_POSITION_INT(body) => body.ser(version, bytes),
            Self::GPS2_RAW(body) => body.ser(version, bytes),
            Self::GPS_GLOBAL_ORIGIN(body) => body.ser(version, bytes),
            Self::GPS_RAW_INT(body) => body.ser(version, bytes),
            Self::HEARTBEAT(body) => body.ser(version, bytes),
            Self::HOME_POSITION(body) => body.ser(version, bytes),
            Self::LOCAL_POSITION_NED(body) => body.ser(version, bytes),
            Self::MANUAL_CONTROL(body) => body.ser(version, bytes),
            Self::MESSAGE_INTERVAL(body) => body.ser(version, bytes),
            Self::MISSION_ACK(body) => body.ser(version, bytes),
            Self::MISSION_CLEAR_ALL(body) => body.ser(version, bytes),
            Self::MISSION_COUNT(body) => body.ser(version, bytes),
            Self::MISSION_CURRENT(body) => body.ser(version, bytes),
            Self::MISSION_ITEM(body) => body.ser(version, bytes),
            Self::MISSION_ITEM_INT(body) => body.ser(version, bytes),
            Self::MISSION_ITEM_REACHED(body) => body.ser(version, bytes),
            Self::MISSION_REQUEST(body) => body.ser(version, bytes),
            Self::MISSION_REQUEST_INT(body) => body.ser(version, bytes),
            Self::MISSION_REQUEST_LIST(body) => body.ser(version, bytes),
            Self::MISSION_SET_CURRENT(body) => body.ser(version, bytes),
            Self::PARAM_REQUEST_LIST(body) => body.ser(version, bytes),
            Self::PARAM_REQUEST_READ(body) => body.ser(version, bytes),
            Self::PARAM_SET(body) => body.ser(version, bytes),
            Self::PARAM_VALUE(body) => body.ser(version, bytes),
            Self::PING(body) => body.ser(version, bytes),
            Self::POSITION_TARGET_GLOBAL_INT(body) => body.ser(version, bytes),
            Self::POSITION_TARGET_LOCAL_NED(body) => body.ser(version, bytes),
            Self::REQUEST_DATA_STREAM(body) => body.ser(version, bytes),
            Self::SETUP_SIGNING(body) => body.ser(version, bytes),
            Self::SET_GPS_GLOBAL_ORIGIN(body) => body.ser(version, bytes),
            Self::SET_MODE(body) => body.ser(version, bytes),
            Self::SET_POSITION_TARGET_GLOBAL_INT(body) => body.ser(version, bytes),
            Self::SET_POSITION_TARGET_LOCAL_NED(body) => body.ser(version, bytes),
            Self::STATUSTEXT(body) => body.ser(version, bytes),
            Self::STAYA_ACK(body) => body.ser(version, bytes),
            Self::STAYA_BEACON(body) => body.ser(version, bytes),
            Self::STAYA_GOAL(body) => body.ser(version, bytes),
            Self::STAYA_LOST(body) => body.ser(version, bytes),
            Self::STAYA_MESSAGE(body) => body.ser(version, bytes),
            Self::STAYA_PLACE(body) => body.ser(version, bytes),
            Self::STAYA_TEMPLATE(body) => body.ser(version, bytes),
            Self::SYSTEM_TIME(body) => body.ser(version, bytes),
            Self::SYS_STATUS(body) => body.ser(version, bytes),
            Self::TIMESYNC(body) => body.ser(version, bytes),
            Self::TUNNEL(body) => body.ser(version, bytes),
            Self::VFR_HUD(body) => body.ser(version, bytes),
        }
    }
    fn extra_crc(id: u32) -> u8 {
        match id {
            ATTITUDE_DATA::ID => ATTITUDE_DATA::EXTRA_CRC,
            AUTOPILOT_VERSION_DATA::ID => AUTOPILOT_VERSION_DATA::EXTRA_CRC,
            BATTERY_STATUS_DATA::ID => BATTERY_STATUS_DATA::EXTRA_CRC,
            COMMAND_ACK_DATA::ID => COMMAND_ACK_DATA::EXTRA_CRC,
            COMMAND_INT_DATA::ID => COMMAND_INT_DATA::EXTRA_CRC,
            COMMAND_LONG_DATA::ID => COMMAND_LONG_DATA::EXTRA_CRC,
            EKF_STATUS_REPORT_DATA::ID => EKF_STATUS_REPORT_DATA::EXTRA_CRC,
            ESTIMATOR_STATUS_DATA::ID => ESTIMATOR_STATUS_DATA::EXTRA_CRC,
            EXTENDED_SYS_STATE_DATA::ID => EXTENDED_SYS_STATE_DATA::EXTRA_CRC,
            FILE_TRANSFER_PROTOCOL_DATA::ID => FILE_TRANSFER_PROTOCOL_DATA::EXTRA_CRC,
            GLOBAL_POSITION_INT_DATA::ID => GLOBAL_POSITION_INT_DATA::EXTRA_CRC,
            GPS2_RAW_DATA::ID => GPS2_RAW_DATA::EXTRA_CRC,
            GPS_GLOBAL_ORIGIN_DATA::ID => GPS_GLOBAL_ORIGIN_DATA::EXTRA_CRC,
            GPS_RAW_INT_DATA::ID => GPS_RAW_INT_DATA::EXTRA_CRC,
            HEARTBEAT_DATA::ID => HEARTBEAT_DATA::EXTRA_CRC,
            HOME_POSITION_DATA::ID => HOME_POSITION_DATA::EXTRA_CRC,
            LOCAL_POSITION_NED_DATA::ID => LOCAL_POSITION_NED_DATA::EXTRA_CRC,
            MANUAL_CONTROL_DATA::ID => MANUAL_CONTROL_DATA::EXTRA_CRC,
            MESSAGE_INTERVAL_DATA::ID => MESSAGE_INTERVAL_DATA::EXTRA_CRC,
            MISSION_ACK_DATA::ID => MISSION_ACK_DATA::EXTRA_CRC,
            MISSION_CLEAR_ALL_DATA::ID => MISSION_CLEAR_ALL_DATA::EXTRA_CRC,
            MISSION_COUNT_DATA::ID => MISSION_COUNT_DATA::EXTRA_CRC,
            MISSION_CURRENT_DATA::ID => MISSION_CURRENT_DATA::EXTRA_CRC,
            MISSION_ITEM_DATA::ID => MISSION_ITEM_DATA::EXTRA_CRC,
            MISSION_ITEM_INT_DATA::ID => MISSION_ITEM_INT_DATA::EXTRA_CRC,
            MISSION_ITEM_REACHED_DATA::ID => MISSION_ITEM_REACHED_DATA::EXTRA_CRC,
            MISSION_REQUEST_DATA::ID => MISSION_REQUEST_DATA::EXTRA_CRC,
            MISSION_REQUEST_INT_DATA::ID => MISSION_REQUEST_INT_DATA::EXTRA_CRC,
            MISSION_REQUEST_LIST_DATA::ID => MISSION_REQUEST_LIST_DATA::EXTRA_CRC,
            MISSION_SET_CURRENT_DATA::ID => MISSION_SET_CURRENT_DATA::EXTRA_CRC,
            PARAM_REQUEST_LIST_DATA::ID => PARAM_REQUEST_LIST_DATA::EXTRA_CRC,
            PARAM_REQUEST_READ_DATA::ID => PARAM_REQUEST_READ_DATA::EXTRA_CRC,
            PARAM_SET_DATA::ID => PARAM_SET_DATA::EXTRA_CRC,
            PARAM_VALUE_DATA::ID => PARAM_VALUE_DATA::EXTRA_CRC,
            PING_DATA::ID => PING_DATA::EXTRA_CRC,
            POSITION_TARGET_GLOBAL_INT_DATA::ID => {
                POSITION_TARGET_GLOBAL_INT_DATA::EXTRA_CRC
            }
            POSITION_TARGET_LOCAL_NED_DATA::ID => {
                POSITION_TARGET_LOCAL_NED_DATA::EXTRA_CRC
            }
            REQUEST_DATA_STREAM_DATA::ID => REQUEST_DATA_STREAM_DATA::EXTRA_CRC,
            SETUP_SIGNING_DATA::ID => SETUP_SIGNING_DATA::EXTRA_CRC,
            SET_GPS_GLOBAL_ORIGIN_DATA::ID => SET_GPS_GLOBAL_ORIGIN_DATA::EXTRA_CRC,
            SET_MODE_DATA::ID => SET_MODE_DATA::EXTRA_CRC,
            SET_POSITION_TARGET_GLOBAL_INT_DATA::ID => {
                SET_POSITION_TARGET_GLOBAL_INT_DATA::EXTRA_CRC
            }
            SET_POSITION_TARGET_LOCAL_NED_DATA::ID => {
                SET_POSITION_TARGET_LOCAL_NED_DATA::EXTRA_CRC
            }
            STATUSTEXT_DATA::ID => STATUSTEXT_DATA::EXTRA_CRC,
            STAYA_ACK_DATA::ID => STAYA_ACK_DATA::EXTRA_CRC,
            STAYA_BEACON_DATA::ID => STAYA_BEACON_DATA::EXTRA_CRC,
            STAYA_GOAL_DATA::ID => STAYA_GOAL_DATA::EXTRA_CRC,
            STAYA_LOST_DATA::ID => STAYA_LOST_DATA::EXTRA_CRC,
            STAYA_MESSAGE_DATA::ID => STAYA_MESSAGE_DATA::EXTRA_CRC,
            STAYA_PLACE_DATA::ID => STAYA_PLACE_DATA::EXTRA_CRC,
            STAYA_TEMPLATE_DATA::ID => STAYA_TEMPLATE_DATA::EXTRA_CRC,
            SYSTEM_TIME_DATA::ID => SYSTEM_TIME_DATA::EXTRA_CRC,
            SYS_STATUS_DATA::ID => SYS_STATUS_DATA::EXTRA_CRC,
            TIMESYNC_DATA::ID => TIMESYNC_DATA::EXTRA_CRC,
            TUNNEL_DATA::ID => TUNNEL_DATA::EXTRA_CRC,
            VFR_HUD_DATA::ID => VFR_HUD_DATA::EXTRA_CRC,
            _ => 0,
        }
    }
    fn target_system_id(&self) -> Option<u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(inner.target_system),
            Self::COMMAND_INT(inner) => Some(inner.target_system),
            Self::COMMAND_LONG(inner) => Some(inner.target_system),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(inner.target_system),
            Self::MANUAL_CONTROL(inner) => Some(inner.target),
            Self::MISSION_ACK(inner) => Some(inner.target_system),
            Self::MISSION_CLEAR_ALL(inner) => Some(inner.target_system),
            Self::MISSION_COUNT(inner) => Some(inner.target_system),
            Self::MISSION_ITEM(inner) => Some(inner.target_system),
            Self::MISSION_ITEM_INT(inner) => Some(inner.target_system),
            Self::MISSION_REQUEST(inner) => Some(inner.target_system),
            Self::MISSION_REQUEST_INT(inner) => Some(inner.target_system),
            Self::MISSION_REQUEST_LIST(inner) => Some(inner.target_system),
            Self::MISSION_SET_CURRENT(inner) => Some(inner.target_system),
            Self::PARAM_REQUEST_LIST(inner) => Some(inner.target_system),
            Self::PARAM_REQUEST_READ(inner) => Some(inner.target_system),
            Self::PARAM_SET(inner) => Some(inner.target_system),
            Self::PING(inner) => Some(inner.target_system),
            Self::REQUEST_DATA_STREAM(inner) => Some(inner.target_system),
            Self::SETUP_SIGNING(inner) => Some(inner.target_system),
            Self::SET_GPS_GLOBAL_ORIGIN(inner) => Some(inner.target_system),
            Self::SET_MODE(inner) => Some(inner.target_system),
            Self::SET_POSITION_TARGET_GLOBAL_INT(inner) => Some(inner.target_system),
            Self::SET_POSITION_TARGET_LOCAL_NED(inner) => Some(inner.target_system),
            Self::STAYA_ACK(inner) => Some(inner.target_system),
            Self::STAYA_GOAL(inner) => Some(inner.target_system),
            Self::STAYA_MESSAGE(inner) => Some(inner.target_system),
            Self::STAYA_PLACE(inner) => Some(inner.target_system),
            Self::STAYA_TEMPLATE(inner) => Some(inner.target_system),
            Self::TUNNEL(inner) => Some(inner.target_system),
            _ => None,
        }
    }
    fn target_system_id_mut(&mut self) -> Option<&mut u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(&mut inner.target_system),
            Self::COMMAND_INT(inner) => Some(&mut inner.target_system),
            Self::COMMAND_LONG(inner) => Some(&mut inner.target_system),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(&mut inner.target_system),
            Self::MANUAL_CONTROL(inner) => Some(&mut inner.target),
            Self::MISSION_ACK(inner) => Some(&mut inner.target_system),
            Self::MISSION_CLEAR_ALL(inner) => Some(&mut inner.target_system),
            Self::MISSION_COUNT(inner) => Some(&mut inner.target_system),
            Self::MISSION_ITEM(inner) => Some(&mut inner.target_system),
            Self::MISSION_ITEM_INT(inner) => Some(&mut inner.target_system),
            Self::MISSION_REQUEST(inner) => Some(&mut inner.target_system),
            Self::MISSION_REQUEST_INT(inner) => Some(&mut inner.target_system),
            Self::MISSION_REQUEST_LIST(inner) => Some(&mut inner.target_system),
            Self::MISSION_SET_CURRENT(inner) => Some(&mut inner.target_system),
            Self::PARAM_REQUEST_LIST(inner) => Some(&mut inner.target_system),
            Self::PARAM_REQUEST_READ(inner) => Some(&mut inner.target_system),
            Self::PARAM_SET(inner) => Some(&mut inner.target_system),
            Self::PING(inner) => Some(&mut inner.target_system),
            Self::REQUEST_DATA_STREAM(inner) => Some(&mut inner.target_system),
            Self::SETUP_SIGNING(inner) => Some(&mut inner.target_system),
            Self::SET_GPS_GLOBAL_ORIGIN(inner) => Some(&mut inner.target_system),
            Self::SET_MODE(inner) => Some(&mut inner.target_system),
            Self::SET_POSITION_TARGET_GLOBAL_INT(inner) => Some(&mut inner.target_system),
            Self::SET_POSITION_TARGET_LOCAL_NED(inner) => Some(&mut inner.target_system),
            Self::STAYA_ACK(inner) => Some(&mut inner.target_system),
            Self::STAYA_GOAL(inner) => Some(&mut inner.target_system),
            Self::STAYA_MESSAGE(inner) => Some(&mut inner.target_system),
            Self::STAYA_PLACE(inner) => Some(&mut inner.target_system),
            Self::STAYA_TEMPLATE(inner) => Some(&mut inner.target_system),
            Self::TUNNEL(inner) => Some(&mut inner.target_system),
            _ => None,
        }
    }
    fn target_component_id(&self) -> Option<u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(inner.target_component),
            Self::COMMAND_INT(inner) => Some(inner.target_component),
            Self::COMMAND_LONG(inner) => Some(inner.target_component),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(inner.target_component),
            Self::MISSION_ACK(inner) => Some(inner.target_component),
            Self::MISSION_CLEAR_ALL(inner) => Some(inner.target_component),
            Self::MISSION_COUNT(inner) => Some(inner.target_component),
            Self::MISSION_ITEM(inner) => Some(inner.target_component),
            Self::MISSION_ITEM_INT(inner) => Some(inner.target_component),
            Self::MISSION_REQUEST(inner) => Some(inner.target_component),
            Self::MISSION_REQUEST_INT(inner) => Some(inner.target_component),
            Self::MISSION_REQUEST_LIST(inner) => Some(inner.target_component),
            Self::MISSION_SET_CURRENT(inner) => Some(inner.target_component),
            Self::PARAM_REQUEST_LIST(inner) => Some(inner.target_component),
            Self::PARAM_REQUEST_READ(inner) => Some(inner.target_component),
            Self::PARAM_SET(inner) => Some(inner.target_component),
            Self::PING(inner) => Some(inner.target_component),
            Self::REQUEST_DATA_STREAM(inner) => Some(inner.target_component),
            Self::SETUP_SIGNING(inner) => Some(inner.target_component),
            Self::SET_POSITION_TARGET_GLOBAL_INT(inner) => Some(inner.target_component),
            Self::SET_POSITION_TARGET_LOCAL_NED(inner) => Some(inner.target_component),
            Self::TUNNEL(inner) => Some(inner.target_component),
            _ => None,
        }
    }
    fn target_component_id_mut(&mut self) -> Option<&mut u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(&mut inner.target_component),
            Self::COMMAND_INT(inner) => Some(&mut inner.target_component),
            Self::COMMAND_LONG(inner) => Some(&mut inner.target_component),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(&mut inner.target_component),
            Self::MISSION_ACK(inner) => Some(&mut inner.target_component),
            Self::MISSION_CLEAR_ALL(inner) => Some(&mut inner.target_component),
            Self::MISSION_COUNT(inner) => Some(&mut inner.target_component),
            Self::MISSION_ITEM(inner) => Some(&mut inner.target_component),
            Self::MISSION_ITEM_INT(inner) => Some(&mut inner.target_component),
            Self::MISSION_REQUEST(inner) => Some(&mut inner.target_component),
            Self::MISSION_REQUEST_INT(inner) => Some(&mut inner.target_component),
            Self::MISSION_REQUEST_LIST(inner) => Some(&mut inner.target_component),
            Self::MISSION_SET_CURRENT(inner) => Some(&mut inner.target_component),
            Self::PARAM_REQUEST_LIST(inner) => Some(&mut inner.target_component),
            Self::PARAM_REQUEST_READ(inner) => Some(&mut inner.target_component),
            Self::PARAM_SET(inner) => Some(&mut inner.target_component),
            Self::PING(inner) => Some(&mut inner.target_component),
            Self::REQUEST_DATA_STREAM(inner) => Some(&mut inner.target_component),
            Self::SETUP_SIGNING(inner) => Some(&mut inner.target_component),
            Self::SET_POSITION_TARGET_GLOBAL_INT(inner) => {
                Some(&mut inner.target_component)
            }
            Self::SET_POSITION_TARGET_LOCAL_NED(inner) => {
                Some(&mut inner.target_component)
            }
            Self::TUNNEL(inner) => Some(&mut inner.target_component),
            _ => None,
        }
    }
}
