"""`staya bridge` with pymavlink."""

import json
import math
import socket
import time
from pathlib import Path

import pytest
from bridge_client import AUTO, BOTH, GUIDED, HOLD, LAT, LON, POSITION, VELOCITY, Bridge
from pymavlink import mavutil

ACCEPTED, NOT_NOW, DENIED, UNSUPPORTED, INT_ONLY, BAD_FRAME = 0, 1, 2, 3, 8, 9
NAN = math.nan
TEN = "scenarios/bridge.toml"
# Simulated seconds per second.
SPEED = 5


@pytest.fixture
def bridge(staya, free_port):
    """A function that starts a bridge with a client."""
    started = []

    def start(scenario=TEN, *options, **more):
        started.append(Bridge(staya, free_port(), scenario, *options, **{"speed": SPEED, **more}))
        started[-1].next("HEARTBEAT")
        return started[-1]

    yield start
    for one in started:
        one.close()


def test_every_robot_is_a_vehicle_with_telemetry(bridge):
    ten = bridge()
    beats = {}
    while len(beats) < 10:
        beat = ten.next("HEARTBEAT")
        beats[beat.get_srcSystem()] = beat
    assert sorted(beats) == list(range(1, 11))
    assert all(b.type == 10 and b.autopilot == 3 and b.base_mode & 128 and b.custom_mode == AUTO for b in beats.values())
    # Robot 4 is 6 m east of the origin.
    local = ten.position(4)
    assert (local.x, local.y, local.z) == (0.0, 6.0, 0.0)
    place = ten.next("GLOBAL_POSITION_INT", 4)
    assert abs(place.lat / 1e7 - LAT) < 2e-7
    east = math.radians(place.lon / 1e7 - LON) * 6_388_000 * math.cos(math.radians(LAT))
    assert abs(east - 6.0) < 0.03
    assert place.alt == 488_000 and place.relative_alt == 0
    battery = ten.next("BATTERY_STATUS", 4)
    assert battery.battery_remaining == -1 and battery.voltages[0] == 65535
    for kind in ["ATTITUDE", "SYS_STATUS", "EXTENDED_SYS_STATE", "HOME_POSITION", "GPS_RAW_INT", "VFR_HUD", "SYSTEM_TIME"]:
        ten.next(kind, 4)
    assert ten.command(4, 512, 148) == ACCEPTED
    version = ten.next("AUTOPILOT_VERSION", 4)
    assert version.uid == 4 and version.capabilities & (1 << 13)


def parameters(one, system):
    """All parameters of a vehicle, by name."""
    one.drop()
    one.sink.param_request_list_send(system, 1)
    first = one.next("PARAM_VALUE", system)
    values = {first.param_id: first.param_value}
    while len(values) < first.param_count:
        told = one.next("PARAM_VALUE", system)
        values[told.param_id] = told.param_value
    return values


def test_parameters_are_listed_set_limited_and_have_an_effect(bridge):
    ten = bridge()
    values = parameters(ten, 2)
    assert values["SPEED_MPS"] == 1.0 and values["RADIUS_M"] == 0.25 and len(values) == 11
    ten.sink.param_set_send(2, 1, b"SPEED_MPS", 0.5, 9)
    assert ten.next("PARAM_VALUE", 2).param_value == 0.5
    ten.sink.param_set_send(2, 1, b"SPEED_MPS", 99.0, 9)
    assert ten.next("PARAM_VALUE", 2).param_value == 0.5
    ten.text(2, "SPEED_MPS: give 0 to 2")
    ten.sink.param_set_send(2, 1, b"RADIUS_M", 0.1, 9)
    assert ten.next("PARAM_VALUE", 2).param_value == 0.25
    ten.sink.param_request_read_send(2, 1, b"SPEED_MPS", -1)
    assert ten.next("PARAM_VALUE", 2).param_value == 0.5
    # It moves at the set speed, its neighbour at the default one.
    fastest = {}
    for system, limit in [(2, 0.5), (3, 1.0)]:
        assert ten.reposition(system, -20, 2.0 * system) == ACCEPTED
        time.sleep(0.4)
        ten.drop()
        speeds = [math.hypot(at.vx, at.vy) for at in (ten.position(system) for _ in range(4))]
        fastest[system] = max(speeds)
        assert abs(fastest[system] - limit) < 0.05, fastest


def test_goto_and_velocity_setpoints_and_their_end(bridge):
    ten = bridge()
    # Setpoints count in GUIDED only.
    ten.set_local(1, POSITION, (-5, 0, 0))
    ten.text(1, "arm and select GUIDED first")
    ten.mode(1, GUIDED)
    ten.set_local(1, POSITION, (-5, 1, 0))
    ten.arrives(1, -5, 1)
    # North while setpoints arrive, then for three more simulated seconds.
    for _ in range(3):
        ten.set_local(1, VELOCITY, velocity=(-1, 0, 0))
        time.sleep(0.1)
    ten.position(1, lambda at: at.vx < -0.8)
    ten.text(1, "holding")
    ten.position(1, lambda at: abs(at.vx) < 1e-3)
    # Position and velocity, in the frame of the body, which faces south.
    ten.set_local(1, BOTH, (1.0, 0, 0), (0.1, 0, 0), frame=8)
    ten.position(1, lambda at: at.vx < -0.1)
    assert ten.reposition(1, 0, -3) == ACCEPTED
    ten.arrives(1, 0, -3)
    # Home, then the behaviour of the scenario.
    ten.mode(1, 11)
    ten.arrives(1, 0, 0)
    ten.mode(1, AUTO)


def test_impossible_commands_get_the_right_result(bridge):
    ten = bridge()
    for command, params, result in [
        (400, (NAN,), DENIED),
        (400, (2,), DENIED),
        (176, (1, 99), DENIED),
        (176, (0, GUIDED), DENIED),
        (176, (1, NAN), DENIED),
        (22, (0, 0, 0, NAN, NAN, NAN, 10), UNSUPPORTED),
        (21, (), UNSUPPORTED),
        (183, (1, 1500), UNSUPPORTED),
        (31000, (), UNSUPPORTED),
        (300, (), DENIED),
        (178, (1, 50), DENIED),
        (192, (-1, 1, 0, NAN, LAT, LON, 0), INT_ONLY),
        (511, (32, 1), DENIED),
        (511, (9999, 100_000), UNSUPPORTED),
        (511, (0, -1), DENIED),
        (512, (9999,), UNSUPPORTED),
    ]:
        assert ten.command(5, command, *params) == result, (command, params)
    x, y = round(LAT * 1e7), round(LON * 1e7)
    assert ten.command_int(5, 192, (-1, 0, 0, NAN), x, y) == NOT_NOW
    assert ten.command_int(5, 192, (-1, 1, 0, NAN), x, y, frame=8) == BAD_FRAME
    assert ten.command_int(5, 192, (-1, 1, 0, NAN), 2_000_000_000, y) == DENIED
    assert ten.command_int(5, 192, (-1, 1, 0, NAN), -x, y) == DENIED
    assert ten.command(5, 400, 0) == ACCEPTED
    assert ten.command_int(5, 192, (-1, 1, 0, NAN), x, y) == NOT_NOW
    figures = ten.end()
    assert figures["commands"] == {"accepted": 1, "as COMMAND_INT only": 1, "denied": 11, "temporarily rejected": 2,
                                   "unsupported": 6, "unsupported frame": 1}


def test_commands_reach_their_target_only(bridge):
    ten = bridge()
    assert ten.command(3, 400, 0) == ACCEPTED
    armed = {}
    deadline = time.monotonic() + 2.5
    while time.monotonic() < deadline:
        beat = ten.next("HEARTBEAT")
        armed[beat.get_srcSystem()] = bool(beat.base_mode & 128)
    assert [system for system, is_armed in armed.items() if not is_armed] == [3]
    # No vehicle has these numbers, and none has a camera.
    for system, component in [(77, 1), (3, 100)]:
        ten.drop()
        ten.sink.command_long_send(system, component, 400, 0, 1, 0, 0, 0, 0, 0, 0)
        with pytest.raises(AssertionError, match="no COMMAND_ACK"):
            ten.next("COMMAND_ACK", timeout=0.7)
    # 0 addresses all vehicles.
    ten.sink.command_long_send(0, 0, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    answers = {ten.next("COMMAND_ACK").get_srcSystem() for _ in range(10)}
    assert answers == set(range(1, 11))


def test_streams_have_the_requested_rates(bridge):
    ten = bridge()
    ten.link.port.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)

    def waited():
        """Seconds for which the bridge's main thread was ready but did not run."""
        return int(Path(f"/proc/{ten.process.child.pid}/schedstat").read_text().split()[1]) / 1e9

    def count(kind, seconds):
        """Messages of vehicle 6 between two of its own timestamps, and the seconds between them,
        which do not depend on the client's delays."""

        def moment(number):
            ten.sink.timesync_send(0, number)
            seen = 0
            while True:
                message = ten.next([kind, "TIMESYNC"], 6)
                if message.get_type() == kind:
                    seen += 1
                elif message.ts1 == number:
                    return seen, message.tc1 / 1e9 / SPEED

        _, began = moment(1)
        time.sleep(seconds)
        seen, ended = moment(2)
        return seen, ended - began

    def has_rate(kind, hz, seconds=2.0):
        before = waited()
        seen, passed = count(kind, seconds)
        # An overdue message is sent once. The scheduler explains at most the messages that were due
        # while the bridge waited for a processor.
        # the bridge waiting, and no more.
        late = waited() - before
        assert passed + late > 0.9 * seconds
        assert hz * (0.95 * passed - late) - 2 <= seen <= hz * (passed + late) + 2, (kind, hz, seen, passed, late)

    has_rate("LOCAL_POSITION_NED", 10)
    assert ten.command(6, 511, 32, 25_000) == ACCEPTED
    has_rate("LOCAL_POSITION_NED", 40)
    assert ten.command(6, 510, 32) == ACCEPTED
    assert ten.next("MESSAGE_INTERVAL", 6).interval_us == 25_000
    assert ten.command(6, 511, 32, -1) == ACCEPTED
    assert count("LOCAL_POSITION_NED", 1.0)[0] == 0
    ten.sink.request_data_stream_send(6, 1, 6, 5, 1)
    has_rate("GLOBAL_POSITION_INT", 5)


def mission_item(seq, north, east, command=16, current=0):
    """North and east in metres from the origin, frame LOCAL_NED."""
    return dict(seq=seq, frame=1, command=command, current=current, autocontinue=1, param1=0, param2=0, param3=0, param4=NAN,
                x=round(north * 1e4), y=round(east * 1e4), z=0.0)


def upload(one, system, items):
    """Result of an upload."""
    one.drop()
    one.sink.mission_count_send(system, 1, len(items))
    while True:
        asked = one.next(["MISSION_REQUEST_INT", "MISSION_ACK"], system)
        if asked.get_type() == "MISSION_ACK":
            return asked.type
        one.sink.mission_item_int_send(system, 1, **items[asked.seq])


def test_missions_are_uploaded_downloaded_and_flown(bridge):
    ten = bridge()
    # Item 0 is home, as in ArduPilot.
    items = [mission_item(0, 0, 0), mission_item(1, 5, 8), mission_item(2, 5, 12)]
    assert upload(ten, 5, items) == 0
    ten.sink.mission_request_list_send(5, 1)
    assert ten.next("MISSION_COUNT", 5).count == 3
    ten.sink.mission_request_int_send(5, 1, 0)
    home = ten.next("MISSION_ITEM_INT", 5)
    assert (home.seq, home.frame, home.command) == (0, 0, 16) and abs(home.x / 1e7 - LAT) < 1e-6
    for item in items[1:]:
        ten.sink.mission_request_int_send(5, 1, item["seq"])
        told = ten.next("MISSION_ITEM_INT", 5)
        assert (told.seq, told.x, told.y, told.frame) == (item["seq"], item["x"], item["y"], 1)
    assert upload(ten, 4, [items[0], mission_item(1, 0, 0, command=82)]) == 3
    assert upload(ten, 4, [items[0], {**mission_item(1, 0, 0), "frame": 8}]) == 2
    assert ten.command(5, 300) == ACCEPTED
    assert ten.next("MISSION_ITEM_REACHED", 5).seq == 1
    assert ten.next("MISSION_ITEM_REACHED", 5).seq == 2
    ten.arrives(5, 5, 12)
    ten.sink.mission_clear_all_send(5, 1)
    assert ten.next("MISSION_ACK", 5).type == 0
    assert ten.command(5, 300) == DENIED
    # dronekit's goto: an item outside a mission, in degrees.
    ten.mode(5, GUIDED)
    ten.sink.mission_item_send(5, 1, 0, 3, 16, 2, 1, 0, 0, 0, 0, LAT + 0.00002, LON, 0)
    assert ten.next("MISSION_ACK", 5).type == 0
    ten.position(5, lambda at: at.vy < -0.3)


def test_orca_separates_two_robots_with_one_goal(bridge):
    ten = bridge()
    for system in (1, 5):
        ten.mode(system, GUIDED)
    for system in (1, 5):
        ten.set_local(system, POSITION, (-3, 4, 0))
    # One robot reaches the goal, the other stops beside it.
    for system in (1, 5):
        ten.arrives(system, -3, 4, near=0.9)
    # Head-on at full speed.
    for _ in range(15):
        ten.set_local(1, VELOCITY, velocity=(0, 2, 0))
        ten.set_local(5, VELOCITY, velocity=(0, -2, 0))
        time.sleep(0.1)
    figures = ten.end()
    assert figures["collisions"] == 0
    assert figures["least_gap_m"] > 0


GRID = """
name = "column"
ticks = 100000
tick_s = 0.2
[terrain]
cell_m = 2
uniform = { width = 40, height = 40, classes = 1 }
[robots.formation]
places = [[0, 0], [-3, 0], [-6, 0]]
edges = [[1, 2], [2, 3]]
start = [10, 20]
goal = [14, 20]
"""


def templates(places, edges):
    """The template of each robot: relative places of others, and the number of edges to them."""
    count = len(places)
    hops = [[0 if a == b else 99 for b in range(count)] for a in range(count)]
    for a, b in edges:
        hops[a][b] = hops[b][a] = 1
    for via in range(count):
        for a in range(count):
            for b in range(count):
                hops[a][b] = min(hops[a][b], hops[a][via] + hops[via][b])
    for own, (x, y) in enumerate(places):
        entries = [
            (places[other][0] - x, places[other][1] - y, other + 1, hops[own][other]) for other in range(count) if other != own
        ]
        yield own + 1, (x, y), entries


def test_the_formation_changes_while_it_runs(bridge, tmp_path):
    scenario = tmp_path / "column.toml"
    scenario.write_text(GRID)
    three = bridge(scenario, speed=20)

    def stands_like(places):
        """Waits until all robots are in place, in cells relative to the first one."""
        cells, deadline = {}, time.monotonic() + 20
        while time.monotonic() < deadline:
            at = three.position(None)
            cells[at.get_srcSystem()] = (round((at.y - 1) / 2), round((at.x - 1) / 2))
            if len(cells) == 3:
                (x, y) = cells[1]
                if [(cells[i][0] - x, cells[i][1] - y) for i in (1, 2, 3)] == places and (x, y) == goal:
                    return
        raise AssertionError(f"{cells} is not {places} at {goal}")

    goal = (14, 20)
    stands_like([(0, 0), (-3, 0), (-6, 0)])
    # Single goals and velocities are refused in a formation.
    assert three.reposition(2, 10, 10) == DENIED
    # From a column to a wedge, and to another goal.
    wedge = [(0, 0), (-3, 3), (-3, -3)]
    sequence = 0
    for _ in range(2):
        for system, offset, entries in templates(wedge, [(0, 1), (0, 2)]):
            parts = [entries[i : i + 2] for i in range(0, len(entries), 2)]
            for number, part in enumerate(parts):
                full = (part + [(0, 0, 0, 0)] * 2)[:2]
                x, y, ids, hops = (list(column) for column in zip(*full))
                three.sink.staya_template_send(
                    sequence, offset[0], offset[1], x, y, 1, system, 1, number, len(parts), system - 1, len(part), ids, hops
                )
                sequence += 1
        three.sink.staya_goal_send(sequence, 25, 25, 1, 0, 1)
        sequence += 1
        time.sleep(0.1)
    goal = (25, 25)
    stands_like(wedge)


def test_goals_of_the_dialect_set_the_robots_goals(bridge):
    ten = bridge()
    ten.sink.staya_place_send(-2000, 4000, 0, 0, 0, 0, 0, 1, 6, 1, 0)
    ten.arrives(6, 4, -2)
    # The behaviour of the scenario, without an operator's command.
    assert ten.next("HEARTBEAT", 6).custom_mode == AUTO


def test_takeoff_goto_and_landing_in_space(bridge):
    four = bridge("scenarios/bridge-fly.toml", "--disarmed")
    beat = four.next("HEARTBEAT", 1)
    assert beat.type == 2 and not beat.base_mode & 128
    assert four.command(1, 22, 0, 0, 0, NAN, NAN, NAN, 5) == NOT_NOW
    four.mode(1, 4)
    assert four.command(1, 400, 1) == ACCEPTED
    assert four.command(1, 22, 0, 0, 0, NAN, NAN, NAN, -1) == DENIED
    assert four.command(1, 22, 0, 0, 0, NAN, NAN, NAN, 5) == ACCEPTED
    four.next("EXTENDED_SYS_STATE", 1, where=lambda state: state.landed_state == 2)
    four.position(1, lambda at: abs(at.z + 5) < 0.2)
    assert four.command(1, 400, 0) == NOT_NOW
    assert four.reposition(1, 6, 6, 8) == ACCEPTED
    four.position(1, lambda at: math.hypot(at.x - 6, at.y - 6, at.z + 8) < 0.3)
    assert abs(four.next("GLOBAL_POSITION_INT", 1).relative_alt - 8000) < 300
    assert four.command(1, 20) == ACCEPTED
    four.next("HEARTBEAT", 1, 20, where=lambda beat: not beat.base_mode & 128)
    at = four.position(1)
    assert math.hypot(at.x, at.y, at.z) < 0.3
    four.next("EXTENDED_SYS_STATE", 1, where=lambda state: state.landed_state == 1)


def test_only_clients_with_the_key_are_accepted(bridge, tmp_path, staya, free_port):
    key = bytes(range(32))
    file = tmp_path / "key"
    file.write_text(key.hex())
    file.chmod(0o600)
    ten = bridge(TEN, "--key", file)
    ten.link.setup_signing(key, sign_outgoing=True, link_id=3)
    assert ten.next("HEARTBEAT").get_signed()
    assert ten.command(1, 400, 0) == ACCEPTED

    def is_ignored():
        ten.drop()
        ten.link.mav.command_long_send(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
        with pytest.raises(AssertionError, match="no COMMAND_ACK"):
            ten.next("COMMAND_ACK", timeout=0.7)

    ten.link.disable_signing()
    is_ignored()
    ten.link.setup_signing(bytes(32), sign_outgoing=True, allow_unsigned_callback=lambda *_: True, link_id=4)
    ten.link.mav.signing.secret_key = bytes(32)
    is_ignored()
    figures = ten.end()
    assert figures["frames_refused"] >= 2 and figures["commands"] == {"accepted": 1}


@pytest.mark.long
def test_a_hundred_vehicles_at_ten_positions_a_second_lose_nothing(bridge):
    hundred = bridge("scenarios/bridge-100.toml", speed=1)
    link = hundred.link
    link.port.setsockopt(1, 8, 4_000_000)
    hundred.drop()
    last, lost, positions = {}, 0, 0
    deadline = time.monotonic() + 5
    while time.monotonic() < deadline:
        message = link.recv_msg()
        if message is None:
            time.sleep(0.001)
            continue
        system, sequence = message.get_srcSystem(), message.get_seq()
        if system in last:
            lost += (sequence - last[system] - 1) % 256
        last[system] = sequence
        positions += message.get_type() == "LOCAL_POSITION_NED"
    figures = hundred.end()
    assert len(last) == 100
    assert lost == 0 and figures["lines"][0]["lost_out"] == 0
    assert positions / 5 / 100 == pytest.approx(10, rel=0.1)
    print(f"{figures['lines'][0]['bytes_out_per_s'] / 1000:.0f} kB/s")


def test_a_run_without_commands_equals_a_run_without_a_bridge(staya, free_port, tmp_path):
    for scenario in ["swap-circle", "six-robots"]:
        path, ticks = f"scenarios/{scenario}.toml", 60
        line = f"udpout:127.0.0.1:{free_port()}"
        bridged = staya("bridge", path, "--mavlink", line, "--ticks", ticks, "--speed", 500, "--json", "--quiet")
        plain = staya("run", path, "--ticks", ticks, "--json", "--quiet", "--out", tmp_path / scenario)
        assert bridged.wait() == 0 and plain.wait() == 0
        figures, expected = (json.loads(process.output()) for process in (bridged, plain))
        assert figures["trace_hash"] == expected["trace_hash"]
        assert figures["ticks"] == ticks


def test_late_ticks_are_counted(staya, free_port):
    # Ticks of 50 microseconds for a hundred robots.
    line = f"udpout:127.0.0.1:{free_port()}"
    hasty = staya("bridge", "scenarios/bridge-100.toml", "--mavlink", line, "--ticks", 50, "--speed", 1000, "--json", "--quiet")
    assert hasty.wait() == 0
    figures = json.loads(hasty.output())
    assert figures["ticks"] == 50 and figures["deadlines_missed"] > 25


def test_a_log_has_all_frames_both_ways(bridge, tmp_path):
    path = tmp_path / "bridge.tlog"
    ten = bridge(TEN, "--tlog", path)
    ten.next("HEARTBEAT", 10)
    assert ten.command(1, 400, 0) == ACCEPTED
    figures = ten.end()["lines"][0]
    log = mavutil.mavlink_connection(str(path))
    senders = {}
    while (message := log.recv_msg()) is not None:
        assert message.get_type() != "BAD_DATA"
        senders[message.get_srcSystem()] = senders.get(message.get_srcSystem(), 0) + 1
    assert senders.pop(255) == figures["frames_in"] == 1
    assert sum(senders.values()) == figures["frames_out"] and len(senders) == 10


def test_too_many_robots_are_an_error(staya, free_port):
    process = staya("bridge", "scenarios/scale-small.toml", "--mavlink", f"udpout:127.0.0.1:{free_port()}")
    assert process.wait() == 1
    assert "1 to 254" in process.output()


def test_clients_on_two_links_receive_the_same(staya, free_port):
    ports = [free_port(), free_port()]
    process = staya("bridge", TEN, "--mavlink", f"tcpin:127.0.0.1:{ports[0]}", "--mavlink", f"udpin:127.0.0.1:{ports[1]}", "--quiet")
    tcp = mavutil.mavlink_connection(f"tcp:127.0.0.1:{ports[0]}", source_system=254, retries=20)
    udp = mavutil.mavlink_connection(f"udpout:127.0.0.1:{ports[1]}", source_system=253)
    for link in (tcp, udp):
        deadline = time.monotonic() + 10
        while time.monotonic() < deadline:
            link.mav.heartbeat_send(6, 8, 0, 0, 0)
            if link.recv_match(type="HEARTBEAT", blocking=True, timeout=0.5):
                break
        else:
            raise AssertionError(process.output())
    tcp.mav.command_long_send(2, 1, 176, 0, 1, HOLD, 0, 0, 0, 0, 0)
    for link in (tcp, udp):
        assert link.recv_match(type="COMMAND_ACK", blocking=True, timeout=5).result == ACCEPTED
        link.close()
