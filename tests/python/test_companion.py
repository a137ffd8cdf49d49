"""`staya companion` beside autopilots that are not there: see fake_autopilot.py."""

import json
import math
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import wait_until
from fake_autopilot import GUIDED, ORIGIN, PILOT, Faults, Fleet, Line, Server, Vehicle

AUTOPILOTS = {"rover": "ardupilot-rover", "copter": "ardupilot-copter", "px4": "px4-copter"}
# Of all scenarios here.
RADIUS = 0.4
STAND = (0.0, 0.0, 0.0)


def write_scenario(folder, robots, *, tick_s=0.1, speed=1.5, packets="postcard"):
    text = f"""
name = "test"
ticks = 1000
tick_s = {tick_s}
[radio]
range_m = 100
delay_ms = 50
format = "{packets}"
[plane]
radius_m = {RADIUS}
max_speed_mps = {speed}
max_acceleration_mps2 = 2
tolerance_m = 0.3
[plane.orca]
horizon_s = 3
margin_m = 0.2
[plane.robots]
list = [
"""
    for start, goal in robots:
        text += f"    {{ start_m = {list(start)}, goal_m = {list(goal)} }},\n"
    (folder / "scenario.toml").write_text(text + "]\n")


def write_config(folder, ports, kind, rules="", air="", scenario="scenario.toml", name="config.toml", robots=None):
    text = f'scenario = "{scenario}"\n[origin]\nlatitude_deg = {ORIGIN[0]}\nlongitude_deg = {ORIGIN[1]}\naltitude_m = {ORIGIN[2]}\n'
    text += f"[rules]\n{rules}\n{air}\n"
    for robot, port in zip(robots or range(1, len(ports) + 1), ports):
        text += f'[[vehicle]]\nrobot = {robot}\nlink = "udpin:127.0.0.1:{port}"\nautopilot = "{AUTOPILOTS[kind]}"\n'
    path = folder / name
    path.write_text(text)
    return path


@pytest.fixture
def one(tmp_path, free_port, staya):
    """One vehicle that is to go 6 m to the east; `(vehicle, fleet to enter, function that starts the companion)`."""

    def make(kind="rover", rules="", faults=None, goal=(6.0, 0.0), **options):
        port = free_port()
        write_scenario(tmp_path, [((0.0, 0.0), goal)])
        config = write_config(tmp_path, [port], kind, rules)
        vehicle = Vehicle(1, kind, Line("127.0.0.1", port, faults), **options)
        return vehicle, Fleet([vehicle], RADIUS), lambda *arguments: staya("companion", config, *arguments)

    return make


def rate(vehicle, since, until):
    return sum(since <= at < until for at, *_ in vehicle.setpoints) / (until - since)


def ends_well(process):
    """Ends it as a person does; returns what it printed."""
    assert process.interrupt() == 130, process.output()
    return process.output()


@pytest.mark.parametrize("kind", ["rover", "copter", "px4"])
def test_goes_to_its_goal_in_a_mode_that_the_pilot_chose(one, kind):
    vehicle, fleet, start = one(kind, armed=True, airborne=kind != "rover")
    with fleet:
        process = start()
        process.wait_for("the pilot steers")
        time.sleep(1.5)
        # PX4 must be offered zeros, or it would refuse the mode.
        assert all(setpoint[1:] == STAND for setpoint in vehicle.setpoints)
        assert (kind == "px4") == bool(vehicle.setpoints)
        assert {command for _, command in vehicle.commands} == {511}, "it asked for telemetry only"
        vehicle.pilot(GUIDED)
        process.wait_for("robot 1: steers")
        begun = time.monotonic()
        process.wait_for("arrived")
        found = rate(vehicle, begun + 0.5, begun + 2.5)
        assert 15 <= found <= 22, f"{found} setpoints a second"
        time.sleep(0.7)
        assert math.hypot(vehicle.east - 6.0, vehicle.north) < 0.35
        beats = [at for at, what, source in vehicle.heard if what == "HEARTBEAT" and source == (1, 191)]
        gaps = [b - a for a, b in zip(beats, beats[1:])]
        assert max(gaps) < 2.0 and 0.8 < sum(gaps) / len(gaps) < 1.2, gaps
        output = ends_well(process)
        assert "steers, arrived, at" in output
        assert [setpoint[1:] for setpoint in vehicle.setpoints[-3:]] == [STAND] * 3, "it ends with zeros"


@pytest.mark.parametrize("kind", ["rover", "copter", "px4"])
def test_asks_arms_and_takes_off_if_it_is_told_to(one, kind):
    rules = 'entry = "once"\narm = true' + ("\ntakeoff = true\naltitude_m = 3" if kind != "rover" else "")
    vehicle, fleet, start = one(kind, rules, goal=(2.0, 0.0), position_after=1.5)
    with fleet:
        process = start()
        process.wait_for("robot 1: steers", 30)
        assert vehicle.mode == GUIDED and vehicle.armed
        assert kind == "rover" or vehicle.up > 2.3
        process.wait_for("arrived")
        if kind != "rover":
            wait_until(lambda: abs(vehicle.up - 3.0) < 0.3, 10, "its height")
        asked = [command for _, command in vehicle.commands if command != 511]
        assert asked == {"rover": [176, 400], "copter": [176, 400, 22], "px4": [176, 400]}[kind], asked
        ends_well(process)


def test_a_late_position_is_waited_for(one):
    vehicle, fleet, start = one(position_after=4.0, mode=GUIDED, armed=True)
    with fleet:
        process = start()
        process.wait_for("no position yet")
        time.sleep(2.0)
        assert not vehicle.setpoints
        process.wait_for("robot 1: steers")
        assert vehicle.is_ready
        ends_well(process)


def test_stale_telemetry_stops_and_fresh_telemetry_goes_on(one):
    vehicle, fleet, start = one(goal=(30.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start()
        process.wait_for("robot 1: steers")
        wait_until(lambda: vehicle.velocity[0] > 1.0, what="motion")
        vehicle.mute_position = True
        at = time.monotonic()
        process.wait_for("position is stale")
        assert 0.8 < time.monotonic() - at < 2.5
        wait_until(lambda: abs(vehicle.velocity[0]) < 0.05, 5, "standing")
        since = time.monotonic()
        time.sleep(1.0)
        assert rate(vehicle, since, since + 1.0) > 15, "it says so again and again"
        assert all(setpoint[1:] == STAND for setpoint in vehicle.setpoints if setpoint[0] >= since)
        vehicle.mute_position = False
        wait_until(lambda: vehicle.velocity[0] > 1.0, 5, "motion again")
        ends_well(process)


def test_a_lost_link_ends_setpoints_and_the_vehicle_stops(one):
    vehicle, fleet, start = one(goal=(40.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start()
        wait_until(lambda: vehicle.velocity[0] > 1.0, what="motion")
        vehicle.line.is_cut = True
        process.wait_for("no heartbeat", 10)
        wait_until(lambda: abs(vehicle.velocity[0]) < 0.05, 6, "standing")
        vehicle.line.is_cut = False
        process.wait_for("heard again")
        wait_until(lambda: vehicle.velocity[0] > 1.0, 5, "motion again")
        ends_well(process)


@pytest.mark.parametrize("kind", ["rover", "px4"])
@pytest.mark.parametrize("entry", ["wait", "once"])
def test_the_pilot_takes_over_and_nothing_is_taken_back(one, kind, entry):
    vehicle, fleet, start = one(
        kind, f'entry = "{entry}"', goal=(60.0, 0.0), armed=True, airborne=kind == "px4", mode=PILOT if entry == "once" else GUIDED
    )
    with fleet:
        # PX4 leaves OFFBOARD at once when nobody streams.
        process = start()
        if kind == "px4" and entry == "wait":
            wait_until(lambda: vehicle._has_stream(time.monotonic()), what="a stream")
            vehicle.pilot(GUIDED)
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        with fleet.lock:
            vehicle.pilot()
            # Tells of it at once, as autopilots do.
            vehicle.due[0] = 0.0
        process.wait_for("handed over")
        at = time.monotonic()
        commands = len(vehicle.commands)
        time.sleep(4.0)
        assert rate(vehicle, at + 0.1, at + 4.0) == 0.0
        assert [c for c in vehicle.commands[commands:] if c[1] != 511] == []
        assert vehicle.mode == PILOT
        time.sleep(2.0)
        vehicle.pilot(GUIDED)
        wait_until(lambda: vehicle.velocity[0] > 0.5, 5, "motion, once the pilot has chosen the mode again")
        ends_well(process)


def test_a_lost_ground_station_is_a_hand_over_too(one):
    vehicle, fleet, start = one(goal=(60.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start()
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        # The last heartbeat of a ground station, long ago: the companion's own do not count.
        vehicle.ground_station = time.monotonic() - 4.0
        process.wait_for("handed over", 10)
        at = time.monotonic()
        time.sleep(2.0)
        assert rate(vehicle, at + 0.1, at + 2.0) == 0.0
        ends_well(process)


def test_a_restarted_autopilot_is_the_pilots(one):
    vehicle, fleet, start = one(rules='entry = "once"\narm = true', goal=(60.0, 0.0))
    with fleet:
        process = start()
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        with fleet.lock:
            # It comes up in the mode and armed, which is nobody's choice.
            vehicle.reboot(0.5, GUIDED)
            vehicle.armed = True
            vehicle.commands.clear()
        process.wait_for("restarted: choose the mode anew", 10)
        at = time.monotonic()
        time.sleep(2.0)
        assert rate(vehicle, at + 0.1, at + 2.0) == 0.0
        assert {command for _, command in vehicle.commands} == {511}, "telemetry is asked for again, and nothing else"
        told = process.output().count("the pilot steers")
        vehicle.pilot()
        wait_until(lambda: process.output().count("the pilot steers") > told, 5, "the pilot's turn")
        vehicle.pilot(GUIDED)
        wait_until(lambda: vehicle.velocity[0] > 0.5, 5, "motion")
        ends_well(process)


def test_px4_leaves_offboard_when_the_companion_dies(one):
    vehicle, fleet, start = one("px4", 'entry = "once"', goal=(60.0, 0.0), armed=True, airborne=True)
    with fleet:
        process = start()
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        process.child.kill()
        at = time.monotonic()
        wait_until(lambda: vehicle.mode != GUIDED, 5, "the failsafe")
        assert 0.8 < time.monotonic() - at < 2.0


def test_links_that_lose_delay_and_damage_frames(one):
    faults = Faults(drop=0.2, delay_s=0.15, corrupt=0.05, seed=7)
    vehicle, fleet, start = one(rules='entry = "once"\narm = true', faults=faults)
    with fleet:
        process = start("--json", "--quiet")
        wait_until(lambda: math.hypot(vehicle.east - 6.0, vehicle.north) < 0.3, 30, "arrival")
        output = ends_well(process)
    report = json.loads(output)
    assert report["links"][0]["junk_bytes"] > 0, "damage was seen"
    assert report["interrupted"] and report["vehicles"][0]["restarts"] == 0


def test_a_link_over_tcp_that_breaks_is_made_anew(tmp_path, free_port, staya):
    port = free_port()
    write_scenario(tmp_path, [((0.0, 0.0), (40.0, 0.0))])
    config = write_config(tmp_path, [port], "rover")
    config.write_text(config.read_text().replace("udpin", "tcpout"))
    vehicle = Vehicle(1, "rover", Server("127.0.0.1", port), mode=GUIDED, armed=True)
    with Fleet([vehicle]) as fleet:
        process = staya("companion", config)
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        with fleet.lock:
            vehicle.line._hang_up()
            vehicle.setpoints.clear()
        wait_until(lambda: len(vehicle.setpoints) > 20, 10, "setpoints again")
        ends_well(process)


def test_a_wrong_origin_moves_nothing(tmp_path, free_port, staya):
    port = free_port()
    write_scenario(tmp_path, [((0.0, 0.0), (6.0, 0.0))])
    config = write_config(tmp_path, [port], "rover")
    config.write_text(config.read_text().replace(str(ORIGIN[0]), str(ORIGIN[0] + 0.2)))
    with Fleet([Vehicle(1, "rover", Line("127.0.0.1", port), mode=GUIDED, armed=True)]) as fleet:
        process = staya("companion", config)
        process.wait_for("too far from the origin")
        time.sleep(1.5)
        assert all(setpoint[1:] == STAND for setpoint in fleet.vehicles[0].setpoints)
        ends_well(process)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs Linux's /proc")
def test_waiting_costs_little(one):
    vehicle, fleet, start = one(armed=True)
    with fleet:
        process = start()
        process.wait_for("the pilot steers")
        time.sleep(3.0)
        # User and system time in clock ticks: proc_pid_stat(5).
        times = Path(f"/proc/{process.child.pid}/stat").read_text().rsplit(")", 1)[1].split()[11:13]
        seconds = sum(map(int, times)) / os.sysconf("SC_CLK_TCK")
        assert seconds < 1.5, f"{seconds} s of processor time in 3 s"
        ends_well(process)


def test_dry_run_shows_and_sends_nothing(one):
    vehicle, fleet, start = one(rules='entry = "once"\narm = true', armed=True)
    with fleet:
        process = start("--dry-run", "--seconds", "3")
        assert process.wait() == 0
        time.sleep(0.2)
        assert vehicle.heard == []
    shown = re.findall(r"robot 1: ([A-Z_]+)\(", process.output())
    assert {"HEARTBEAT", "COMMAND_LONG", "STATUSTEXT"} <= set(shown), process.output()
    assert "nothing was sent" in process.output()


def test_log_is_read_by_pymavlink(one, tmp_path, dialect):
    from pymavlink import mavutil

    vehicle, fleet, start = one(mode=GUIDED, armed=True)
    log = tmp_path / "flight.tlog"
    with fleet:
        assert start("--seconds", "3", "--tlog", log).wait() == 0
    link = mavutil.mavlink_connection(str(log))
    counts = {}
    while (message := link.recv_match()) is not None:
        key = message.get_type(), message.get_srcComponent()
        counts[key] = counts.get(key, 0) + 1
    assert ("BAD_DATA", 0) not in counts
    assert counts["HEARTBEAT", 1] >= 2 and counts["HEARTBEAT", 191] >= 3
    assert counts["SET_POSITION_TARGET_LOCAL_NED", 191] > 30
    assert counts["GLOBAL_POSITION_INT", 1] > 15
    dump = Path(sys.executable).with_name("mavlogdump.py")
    text = subprocess.run([sys.executable, dump, "--types", "STATUSTEXT", str(log)], capture_output=True, text=True, check=True).stdout
    assert "staya: steers" in text


def circle(count, radius):
    places = [(radius * math.cos(2 * math.pi * i / count), radius * math.sin(2 * math.pi * i / count)) for i in range(count)]
    return [(place, (-place[0], -place[1])) for place in places]


def arrive(robots, fleet, timeout):
    def all_there():
        return all(math.hypot(v.east - goal[0], v.north - goal[1]) < 0.5 for v, (_, goal) in zip(fleet.vehicles, robots))

    wait_until(all_there, timeout, "arrival of all")


@pytest.mark.parametrize("faults", [None, dict(drop=0.1, delay_s=0.1, corrupt=0.02)], ids=["good", "bad"])
def test_six_cross_and_keep_their_distance(tmp_path, free_port, staya, faults):
    robots, port = circle(6, 5.0), free_port()
    write_scenario(tmp_path, robots)
    config = write_config(tmp_path, [port] * 6, "rover")
    lines = [Line("127.0.0.1", port, Faults(**faults, seed=i) if faults else None) for i in range(6)]
    vehicles = [Vehicle(i + 1, "rover", lines[i], start, mode=GUIDED, armed=True) for i, (start, _) in enumerate(robots)]
    with Fleet(vehicles, RADIUS) as fleet:
        process = staya("companion", config, "--json", "--quiet")
        arrive(robots, fleet, 45)
        report = json.loads(ends_well(process))
        assert fleet.least_gap > 0.0, f"they touched: {fleet.least_gap} m"
        assert all(vehicle["neighbors"] == 5 for vehicle in report["vehicles"])


@pytest.mark.parametrize("way", ["multicast", "peers", "tunnel"])
def test_companions_in_two_processes_hear_each_other(tmp_path, free_port, staya, way):
    robots = [((0.0, 0.0), (8.0, 0.0)), ((8.0, 0.2), (0.0, 0.2))]
    write_scenario(tmp_path, robots)
    ports, lan = [free_port(), free_port()], [free_port(), free_port()]
    airs = {
        "multicast": ['[air]\nmulticast = "239.255.77.1:%d"\ninterface = "127.0.0.1"' % lan[0]] * 2,
        "peers": ['[air]\nbind = "127.0.0.1:%d"\npeers = ["127.0.0.1:%d"]' % pair for pair in [tuple(lan), tuple(lan[::-1])]],
        "tunnel": ["[air]\ntunnel = true"] * 2,
    }[way]
    vehicles = [Vehicle(i + 1, "rover", Line("127.0.0.1", ports[i]), robots[i][0], mode=GUIDED, armed=True) for i in range(2)]
    with Fleet(vehicles, RADIUS) as fleet:
        processes = []
        for i in range(2):
            config = write_config(tmp_path, [ports[i]], "rover", air=airs[i], name=f"config-{i}.toml", robots=[i + 1])
            processes.append(staya("companion", config))
        arrive(robots, fleet, 30)
        for i, process in enumerate(processes):
            assert f"hears robot {2 - i}" in ends_well(process)
        assert fleet.least_gap > 0.0, f"they touched: {fleet.least_gap} m"


def two_that_meet(tmp_path, free_port, staya, keys, packets):
    """Two companions, each in a process of its own with its key, in a group; their reports after 3 s."""
    write_scenario(tmp_path, [((0.0, 0.0), (8.0, 0.0)), ((8.0, 0.2), (0.0, 0.2))], packets=packets)
    group, processes = free_port(), []
    for i, key in enumerate(keys):
        air = f'[air]\nmulticast = "239.255.77.1:{group}"\ninterface = "127.0.0.1"\n'
        if key:
            (tmp_path / f"{i}.key").write_text(f"passphrase: {key}\n")
            (tmp_path / f"{i}.key").chmod(0o600)
            air += f'key = "{i}.key"'
        port = free_port()
        config = write_config(tmp_path, [port], "rover", air=air, name=f"config-{i}.toml", robots=[i + 1])
        processes.append((port, config))
    # The pilots keep them.
    vehicles = [Vehicle(i + 1, "rover", Line("127.0.0.1", processes[i][0]), (8.0 * i, 0.0)) for i in range(2)]
    with Fleet(vehicles, RADIUS):
        running = [staya("companion", config, "--json", "--quiet", "--seconds", "3") for _, config in processes]
        assert [process.wait() for process in running] == [0, 0]
    return [json.loads(process.output())["vehicles"][0] for process in running]


@pytest.mark.parametrize("packets", ["postcard", "mavlink"])
def test_sealed_packets_are_heard_by_who_has_the_key(tmp_path, free_port, staya, packets):
    for report in two_that_meet(tmp_path, free_port, staya, ["one for all", "one for all"], packets):
        assert report["neighbors"] == 1 and report["packets_heard"] > 10 and report["packets_refused"] == 0, report


@pytest.mark.parametrize("packets", ["postcard", "mavlink"])
@pytest.mark.parametrize("keys", [("one for all", "another"), ("one for all", None)], ids=["wrong", "none"])
def test_packets_without_the_right_key_are_refused(tmp_path, free_port, staya, keys, packets):
    first, _ = two_that_meet(tmp_path, free_port, staya, keys, packets)
    assert first["neighbors"] == 0 and first["packets_heard"] == 0 and first["packets_refused"] > 10, first


def test_signed_links_take_the_right_key_and_no_other(one, tmp_path):
    key = bytes(range(32))
    file = tmp_path / "link.key"
    file.write_text(key.hex() + "\n")
    file.chmod(0o600)
    vehicle, fleet, start = one(mode=GUIDED, armed=True, key=key)
    with fleet:
        process = start("--link-key", file)
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        ends_well(process)
    for other in (bytes(32), None):
        vehicle, fleet, start = one(mode=GUIDED, armed=True, key=other)
        with fleet:
            process = start("--link-key", file, "--json", "--quiet", "--seconds", "2.5")
            assert process.wait() == 0
            report = json.loads(process.output())
            assert report["links"][0]["refused"] >= 2
            assert report["vehicles"][0]["state"] == "silent" and vehicle.setpoints == []


def test_the_others_go_around_one_that_its_pilot_has_taken(tmp_path, free_port, staya):
    robots = [((0.0, 0.0), (10.0, 0.0)), ((5.0, 0.1), (5.0, 8.0))]
    write_scenario(tmp_path, robots)
    port = free_port()
    config = write_config(tmp_path, [port] * 2, "rover")
    modes = [GUIDED, PILOT]
    vehicles = [Vehicle(i + 1, "rover", Line("127.0.0.1", port), robots[i][0], mode=modes[i], armed=True) for i in range(2)]
    with Fleet(vehicles, RADIUS) as fleet:
        process = staya("companion", config)
        arrive(robots[:1], fleet, 30)
        assert (vehicles[1].east, vehicles[1].north) == (5.0, 0.1)
        assert vehicles[1].setpoints == []
        assert fleet.least_gap > 0.0, f"they touched: {fleet.least_gap} m"
        ends_well(process)


@pytest.mark.long
@pytest.mark.parametrize("faults", [None, dict(drop=0.1, delay_s=0.1, corrupt=0.02)], ids=["good", "bad"])
def test_six_travel_in_formation(tmp_path, free_port, staya, faults):
    """In two rows of three, from places up to a metre off, over good links and such that lose, delay and damage frames."""
    (tmp_path / "formation.toml").write_text(
        """
name = "formation"
ticks = 1000
tick_s = 0.1
[terrain]
uniform = { width = 24, height = 24, classes = 1 }
cell_m = 2
[robots.formation]
rows = 2
columns = 3
spacing = [-2, -2]
start = [8, 8]
goal = [16, 16]
[radio]
range_m = 100
delay_ms = 50
[plane]
radius_m = 0.4
max_speed_mps = 2
max_acceleration_mps2 = 2
guidance = "formation"
[plane.orca]
margin_m = 0.2
"""
    )
    port = free_port()
    config = write_config(tmp_path, [port] * 6, "rover", scenario="formation.toml")
    # Where the scenario's robots start, in metres, and up to 1 m off.
    off = [(0.6, -0.4), (-0.8, 0.3), (0.2, 0.9), (-0.5, -0.7), (0.9, 0.1), (-0.3, 0.5)]
    starts = [(17.0 - 4.0 * (i % 3) + off[i][0], 17.0 - 4.0 * (i // 3) + off[i][1]) for i in range(6)]
    lines = [Line("127.0.0.1", port, Faults(**faults, seed=i) if faults else None) for i in range(6)]
    vehicles = [Vehicle(i + 1, "rover", lines[i], starts[i], mode=GUIDED, armed=True) for i in range(6)]
    with Fleet(vehicles, RADIUS) as fleet:
        process = staya("companion", config)

        def there():
            places = [(33.0 - 4.0 * (i % 3), 33.0 - 4.0 * (i // 3)) for i in range(6)]
            return all(math.hypot(v.east - x, v.north - y) < 1.5 for v, (x, y) in zip(vehicles, places))

        wait_until(there, 45, "the formation at its goal")
        assert fleet.least_gap > 0.0, f"they touched: {fleet.least_gap} m"
        ends_well(process)


def test_a_wrong_configuration_is_an_error_with_its_place(tmp_path, staya):
    config = tmp_path / "config.toml"
    config.write_text('scenario = "none.toml"\norigin = { latitude_deg = 91, longitude_deg = 0 }\n')
    process = staya("companion", config)
    assert process.wait() == 1
    assert "config.toml:2: origin: this is no place on the Earth" in process.output()
