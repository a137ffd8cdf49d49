"""`staya companion` with a fake autopilot, see fake_autopilot.py."""

import json
import math
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from companion_setup import RADIUS, STAND, ends_well, rate, write_config, write_scenario
from conftest import wait_until
from fake_autopilot import GUIDED, ORIGIN, PILOT, Fleet, Vehicle
from fake_line import Faults, Line, Server


@pytest.fixture
def one(tmp_path, free_port, staya):
    """A vehicle with a goal 6 m to the east; `(vehicle, fleet to enter, function that starts the
    companion)`."""

    def make(kind="rover", rules="", faults=None, goal=(6.0, 0.0), **options):
        port = free_port()
        write_scenario(tmp_path, [((0.0, 0.0), goal)])
        config = write_config(tmp_path, [port], kind, rules)
        vehicle = Vehicle(1, kind, Line("127.0.0.1", port, faults), **options)
        return vehicle, Fleet([vehicle], RADIUS), lambda *arguments: staya("companion", config, *arguments)

    return make


@pytest.mark.parametrize("kind", ["rover", "copter", "px4"])
def test_a_vehicle_reaches_its_goal_in_the_pilots_mode(one, kind):
    vehicle, fleet, start = one(kind, armed=True, airborne=kind != "rover")
    with fleet:
        process = start()
        process.wait_for("pilot has control")
        # At first it listens for another vehicle with this system id.
        time.sleep(4.0)
        # PX4 needs zero setpoints, or it would refuse the mode.
        assert all(setpoint[1:] == STAND for setpoint in vehicle.setpoints)
        assert (kind == "px4") == bool(vehicle.setpoints)
        assert {command for _, command in vehicle.commands} == {511}, "it asked for telemetry only"
        vehicle.pilot(GUIDED)
        process.wait_for("robot 1: companion has control")
        begun = time.monotonic()
        process.wait_for("arrived")
        found = rate(vehicle, begun + 0.5, begun + 2.5)
        assert 15 <= found <= 22, f"{found} setpoints a second"
        time.sleep(0.7)
        assert math.hypot(vehicle.east - 6.0, vehicle.north) < 0.35
        # A vehicle that has gone too far comes back; only a velocity of zero means north.
        assert kind != "rover" or vehicle.heading != 0.0, "it turned where it stands"
        beats = [at for at, what, source in vehicle.heard if what == "HEARTBEAT" and source == (1, 191)]
        gaps = [b - a for a, b in zip(beats, beats[1:])]
        assert max(gaps) < 2.0 and 0.8 < sum(gaps) / len(gaps) < 1.2, gaps
        output = ends_well(process)
        assert "companion has control, arrived, at" in output
        assert [setpoint[1:] for setpoint in vehicle.setpoints[-3:]] == [STAND] * 3, "it ends with zeros"


@pytest.mark.parametrize("kind", ["rover", "copter", "px4"])
def test_the_entry_requests_the_mode_arms_and_takes_off(one, kind):
    rules = 'entry = "once"\narm = true' + ("\ntakeoff = true\naltitude_m = 3" if kind != "rover" else "")
    vehicle, fleet, start = one(kind, rules, goal=(2.0, 0.0), position_after=1.5)
    with fleet:
        process = start()
        process.wait_for("robot 1: companion has control", 30)
        assert vehicle.mode == GUIDED and vehicle.armed
        assert kind == "rover" or vehicle.up > 2.3
        process.wait_for("arrived")
        if kind != "rover":
            wait_until(lambda: abs(vehicle.up - 3.0) < 0.3, 10, "its height")
        # A takeoff may be requested again until the vehicle has left the ground.
        asked = list(dict.fromkeys(command for _, command in vehicle.commands if command != 511))
        assert asked == {"rover": [176, 400], "copter": [176, 400, 22], "px4": [176, 400]}[kind], asked
        ends_well(process)


def test_the_pilots_takeoff_is_not_interrupted(one):
    vehicle, fleet, start = one("copter", goal=(4.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start()
        process.wait_for("waits: on the ground")
        time.sleep(0.5)
        with fleet.lock:
            assert vehicle.take_off(5.0)
        process.wait_for("robot 1: companion has control")
        assert abs(vehicle.up - 5.0) < 0.2, "the takeoff was broken off"
        process.wait_for("arrived")
        ends_well(process)


def test_the_companion_waits_for_a_late_position(one):
    vehicle, fleet, start = one(position_after=4.0, mode=GUIDED, armed=True)
    with fleet:
        process = start()
        process.wait_for("waits: no position")
        time.sleep(2.0)
        assert not vehicle.setpoints
        process.wait_for("robot 1: companion has control")
        assert vehicle.is_ready
        ends_well(process)


def test_stale_telemetry_stops_and_fresh_telemetry_resumes(one):
    vehicle, fleet, start = one(goal=(30.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start()
        process.wait_for("robot 1: companion has control")
        wait_until(lambda: vehicle.velocity[0] > 1.0, what="motion")
        vehicle.mute_position = True
        at = time.monotonic()
        process.wait_for("position stale")
        assert 0.8 < time.monotonic() - at < 2.5
        wait_until(lambda: abs(vehicle.velocity[0]) < 0.05, 5, "standing")
        since = time.monotonic()
        time.sleep(1.0)
        assert rate(vehicle, since, since + 1.0) > 15, "it says so again and again"
        assert all(setpoint[1:] == STAND for setpoint in vehicle.setpoints if setpoint[0] >= since)
        vehicle.mute_position = False
        wait_until(lambda: vehicle.velocity[0] > 1.0, 5, "motion again")
        ends_well(process)


@pytest.mark.parametrize("kind", ["rover", "px4"])
def test_a_vehicle_without_gps_stops_and_resumes_later(one, kind):
    # PX4 leaves OFFBOARD without setpoints.
    mode = GUIDED if kind == "rover" else PILOT
    vehicle, fleet, start = one(kind, 'entry = "once"', goal=(60.0, 0.0), mode=mode, armed=True, airborne=kind == "px4")
    with fleet:
        process = start("--json")
        wait_until(lambda: vehicle.velocity[0] > 1.0, what="motion")
        with fleet.lock:
            vehicle.gps_lost = True
        wait_until(lambda: abs(vehicle.velocity[0]) < 0.05, 4, "standing")
        process.wait_for("position not trusted: GPS lost its fix")
        since = time.monotonic()
        with fleet.lock:
            vehicle.gps_lost = False
        wait_until(lambda: vehicle.velocity[0] > 0.5, 10, "motion again")
        assert time.monotonic() - since > 4.0
        assert any("not trusted" in text for _, text in vehicle.texts), vehicle.texts
        ends_well(process)
    assert '"doubts": 1' in process.output()


def test_a_lost_link_ends_setpoints_and_the_vehicle_stops(one):
    vehicle, fleet, start = one(goal=(40.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start()
        wait_until(lambda: vehicle.velocity[0] > 1.0, what="motion")
        vehicle.line.is_cut = True
        process.wait_for("no heartbeat", 10)
        wait_until(lambda: abs(vehicle.velocity[0]) < 0.05, 6, "standing")
        vehicle.line.is_cut = False
        process.wait_for("heartbeat back")
        wait_until(lambda: vehicle.velocity[0] > 1.0, 5, "motion again")
        ends_well(process)


@pytest.mark.parametrize("kind", ["rover", "px4"])
@pytest.mark.parametrize("entry", ["wait", "once"])
def test_the_pilot_takes_over_permanently(one, kind, entry):
    vehicle, fleet, start = one(
        kind, f'entry = "{entry}"', goal=(60.0, 0.0), armed=True, airborne=kind == "px4", mode=PILOT if entry == "once" else GUIDED
    )
    with fleet:
        # PX4 leaves OFFBOARD at once without setpoints.
        process = start()
        if kind == "px4" and entry == "wait":
            wait_until(lambda: vehicle._has_stream(time.monotonic()), what="a stream")
            vehicle.pilot(GUIDED)
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        with fleet.lock:
            vehicle.pilot()
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


def test_a_lost_ground_station_counts_as_a_hand_over(one):
    vehicle, fleet, start = one(goal=(60.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start()
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        # The last heartbeat of a ground station is old; the companion's own do not count.
        vehicle.ground_station = time.monotonic() - 4.0
        process.wait_for("handed over", 10)
        at = time.monotonic()
        time.sleep(2.0)
        assert rate(vehicle, at + 0.1, at + 2.0) == 0.0
        ends_well(process)


def test_a_restarted_autopilot_belongs_to_the_pilot(one):
    vehicle, fleet, start = one(rules='entry = "once"\narm = true', goal=(60.0, 0.0))
    with fleet:
        process = start()
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        with fleet.lock:
            # It restarts in the mode and armed, which no pilot has chosen.
            vehicle.reboot(0.5, GUIDED)
            vehicle.armed = True
            vehicle.commands.clear()
        process.wait_for("restarted: select the mode again", 10)
        at = time.monotonic()
        time.sleep(2.0)
        assert rate(vehicle, at + 0.1, at + 2.0) == 0.0
        assert {command for _, command in vehicle.commands} == {511}, "telemetry is asked for again, and nothing else"
        told = process.output().count("pilot has control")
        vehicle.pilot()
        wait_until(lambda: process.output().count("pilot has control") > told, 5, "the pilot's turn")
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


def test_a_broken_tcp_link_reconnects(tmp_path, free_port, staya):
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


def test_a_refused_connection_is_reported(tmp_path, free_port, staya):
    port = free_port()
    write_scenario(tmp_path, [((0.0, 0.0), (40.0, 0.0))])
    config = write_config(tmp_path, [port], "rover")
    config.write_text(config.read_text().replace("udpin", "tcpout"))
    process = staya("companion", config, "--seconds", "2")
    assert process.wait() == 0
    told = [line for line in process.output().splitlines() if "refused" in line and f"tcpout:127.0.0.1:{port}" in line]
    assert len(told) == 2 and "no connection" in told[0], process.output()


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
def test_waiting_needs_little_processor_time(one):
    vehicle, fleet, start = one(armed=True)
    with fleet:
        process = start()
        process.wait_for("pilot has control")
        time.sleep(3.0)
        # User and system time in clock ticks: proc_pid_stat(5).
        times = Path(f"/proc/{process.child.pid}/stat").read_text().rsplit(")", 1)[1].split()[11:13]
        seconds = sum(map(int, times)) / os.sysconf("SC_CLK_TCK")
        assert seconds < 1.5, f"{seconds} s of processor time in 3 s"
        ends_well(process)


def test_dry_run_shows_and_sends_nothing(one):
    vehicle, fleet, start = one(rules='entry = "once"\narm = true', armed=True)
    with fleet:
        process = start("--dry-run", "--seconds", "5.5")
        assert process.wait() == 0
        time.sleep(0.2)
        assert vehicle.heard == []
    output = process.output()
    assert "COMMAND_LONG SET_MESSAGE_INTERVAL GLOBAL_POSITION_INT 10.0 Hz" in output
    assert "COMMAND_LONG DO_SET_MODE 15" in output and "COMPONENT_ARM_DISARM: arm" in output
    assert 'STATUSTEXT "staya: companion has control"' in output
    speeds = [float(east) for east in re.findall(r"m/s north, (\S+) m/s east", output)]
    assert 2 <= len(speeds) <= 5 and max(speeds) > 0.1, output
    assert "nothing was sent" in process.output()


def test_log_is_read_by_pymavlink(one, tmp_path, dialect):
    from pymavlink import mavutil

    vehicle, fleet, start = one(mode=GUIDED, armed=True)
    log = tmp_path / "flight.tlog"
    with fleet:
        assert start("--seconds", "5.5", "--tlog", log).wait() == 0
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
    assert "staya: companion has control" in text


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs Linux's /dev/full")
def test_a_full_disk_does_not_end_control(one):
    vehicle, fleet, start = one(goal=(40.0, 0.0), mode=GUIDED, armed=True)
    with fleet:
        process = start("--tlog", "/dev/full")
        process.wait_for("cannot write /dev/full")
        wait_until(lambda: vehicle.velocity[0] > 1.0, what="motion")
        since = time.monotonic()
        time.sleep(1.0)
        assert rate(vehicle, since, since + 1.0) > 15
        assert any("log cannot be written" in text for _, text in vehicle.texts), vehicle.texts
        output = ends_well(process)
        assert [setpoint[1:] for setpoint in vehicle.setpoints[-3:]] == [STAND] * 3, "it ends with zeros"
    assert "the log is incomplete" in output


def test_signed_links_accept_the_right_key_only(one, tmp_path):
    key = bytes(range(32))
    file = tmp_path / "link.key"
    file.write_text(key.hex() + "\n")
    file.chmod(0o600)
    vehicle, fleet, start = one(mode=GUIDED, armed=True, key=key)
    with fleet:
        process = start("--link-key", file)
        wait_until(lambda: vehicle.velocity[0] > 0.5, what="motion")
        ends_well(process)
    vehicle, fleet, start = one(mode=GUIDED, armed=True, key=key)
    with fleet:
        process = start()
        process.wait_for("messages are signed")
        ends_well(process)
    for other in (bytes(32), None):
        vehicle, fleet, start = one(mode=GUIDED, armed=True, key=other)
        with fleet:
            process = start("--link-key", file, "--json", "--seconds", "2.5")
            assert process.wait() == 0
            told, report = process.output().split("{", 1)
            report = json.loads("{" + report)
            assert report["links"][0]["refused"] >= 2 and told.count("not signed with the key") == 1
            assert report["vehicles"][0]["state"] == "silent" and vehicle.setpoints == []


def test_a_wrong_configuration_is_an_error_with_its_place(tmp_path, staya):
    config = tmp_path / "config.toml"
    config.write_text('scenario = "none.toml"\norigin = { latitude_deg = 91, longitude_deg = 0 }\n')
    process = staya("companion", config)
    assert process.wait() == 1
    assert "config.toml:2:10: origin: not a position on the Earth" in process.output()
