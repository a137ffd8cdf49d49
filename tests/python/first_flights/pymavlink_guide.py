"""The calls of pymavlink's and ArduPilot's guides: heartbeat, data streams, modes, arming, takeoff,
setpoints, parameters, a mission by MISSION_REQUEST alone, home, landing."""

import sys
import time

from pymavlink import mavutil

FLIES = sys.argv[2] == "copter"
mavlink = mavutil.mavlink
link = mavutil.mavlink_connection(sys.argv[1])
link.wait_heartbeat(timeout=20)
print("heartbeat of", link.target_system, link.target_component, flush=True)


def command(number, *params):
    link.mav.command_long_send(link.target_system, link.target_component, number, 0, *(list(params) + [0] * 7)[:7])
    while True:
        ack = link.recv_match(type="COMMAND_ACK", blocking=True, timeout=10)
        assert ack, f"no answer to {number}"
        if ack.command == number:
            return ack.result


def position(where):
    end = time.monotonic() + 40
    while time.monotonic() < end:
        at = link.recv_match(type="LOCAL_POSITION_NED", blocking=True, timeout=5)
        if at and where(at):
            return at
    raise AssertionError("not there")


link.mav.request_data_stream_send(link.target_system, link.target_component, mavlink.MAV_DATA_STREAM_ALL, 4, 1)
assert "GUIDED" in link.mode_mapping()
link.set_mode("GUIDED")
while link.flightmode != "GUIDED":
    assert link.recv_match(type="HEARTBEAT", blocking=True, timeout=5)
link.arducopter_arm()
link.motors_armed_wait()
if FLIES:
    assert command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 5) == 0
    position(lambda at: at.z < -4.8)
down = -8.0 if FLIES else 0.0
link.mav.set_position_target_local_ned_send(
    0, link.target_system, link.target_component, mavlink.MAV_FRAME_LOCAL_NED, 0b110111111000, 10, 5, down, 0, 0, 0, 0, 0, 0, 0, 0
)
position(lambda at: abs(at.x - 10) < 0.3 and abs(at.y - 5) < 0.3 and abs(at.z - down) < 0.3)
print("there", flush=True)
link.mav.param_request_list_send(link.target_system, link.target_component)
first = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=5)
names = {first.param_id}
while len(names) < first.param_count:
    names.add(link.recv_match(type="PARAM_VALUE", blocking=True, timeout=5).param_id)
link.mav.param_set_send(link.target_system, link.target_component, b"SPEED_MPS", 4, mavlink.MAV_PARAM_TYPE_REAL32)
value = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=5)
assert (value.param_id, value.param_value) == ("SPEED_MPS", 4), value
assert command(mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION) == 0
assert link.recv_match(type="AUTOPILOT_VERSION", blocking=True, timeout=5)
home = link.recv_match(type="HOME_POSITION", blocking=True, timeout=10)
latitude, longitude = home.latitude / 1e7, home.longitude / 1e7

link.waypoint_clear_all_send()
assert link.recv_match(type="MISSION_ACK", blocking=True, timeout=5).type == 0
places = [(0.0, 0.0), (2e-4, 0.0), (2e-4, 2e-4)]
link.waypoint_count_send(len(places))
for _ in places:
    asked = link.recv_match(type=["MISSION_REQUEST"], blocking=True, timeout=5)
    north, east = places[asked.seq]
    link.mav.mission_item_send(
        link.target_system, link.target_component, asked.seq, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
        mavlink.MAV_CMD_NAV_WAYPOINT, 0, 1, 0, 0, 0, 0, latitude + north, longitude + east, 10,
    )
assert link.recv_match(type="MISSION_ACK", blocking=True, timeout=5).type == 0
link.waypoint_request_list_send()
assert link.recv_match(type=["MISSION_COUNT"], blocking=True, timeout=5).count == 3
link.set_mode("AUTO")
for seq in (1, 2):
    assert link.recv_match(type="MISSION_ITEM_REACHED", blocking=True, timeout=40).seq == seq
print("mission", flush=True)
assert command(mavlink.MAV_CMD_DO_SET_HOME, 1) == mavlink.MAV_RESULT_UNSUPPORTED
assert "command 179" in link.recv_match(type="STATUSTEXT", blocking=True, timeout=5, condition="'179' in STATUSTEXT.text").text
link.set_mode_rtl()
if FLIES:
    link.motors_disarmed_wait()
else:
    position(lambda at: abs(at.x) < 0.5 and abs(at.y) < 0.5 and abs(at.vx) + abs(at.vy) < 0.02)
    link.arducopter_disarm()
    link.motors_disarmed_wait()
print("done")
