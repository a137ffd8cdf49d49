"""Failures while six ArduPilot rovers cross: pilots act, autopilots restart, GPS and companions
fail."""

import os
import signal
import time

from conftest import wait_until
from flight import GOALS, LINE, STARTS, arrive, figures, fly, least, moving, needs  # noqa: F401

pytestmark = needs("rover")
# The affected vehicle, and the delay after the start, when it is on its way to the others.
ONE, AFTER_S = 3, 4.0
OTHERS = [number for number in range(1, 7) if number != ONE]


def test_the_pilots_hold_is_respected_until_guided_is_chosen_again(fly, free_port):
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        companion = fly.companion(fly.example("six-rovers-crossing.toml"))
        begun = moving(simulation, time.time())
        time.sleep(AFTER_S)
        held = simulation[ONE].choose("HOLD")
        companion.wait_for(f"robot {ONE}: pilot has control")
        others = arrive(simulation, GOALS, 120, numbers=OTHERS, within=4.0)
        time.sleep(5.0)
        assert simulation[ONE].mode == simulation[ONE].modes["HOLD"], "it was taken back"
        still = simulation[ONE].between(held + 5.0)
        guided = simulation[ONE].choose("GUIDED")
        companion.wait_for(f"robot {ONE}: arrived", 60)
        there = arrive(simulation, GOALS, 60)
        words = least(simulation, begun)
        companion.finish()
        # Times in the companion's log.
        beat = next(at for at, m in companion.messages() if m.get_type() == "HEARTBEAT" and m.get_srcSystem() == ONE and m.custom_mode == 4)
        times = [at for at, _ in companion.setpoints(ONE)]
        last = max(at for at in times if at < guided - 0.5)
        again = min(at for at in times if at > last)
        figures(f"last setpoint {1e3 * (beat - last):.0f} ms before the first heartbeat with HOLD; none for {again - last:.1f} s, then {1e3 * (again - guided):.0f} ms after "
                f"GUIDED; the others were there after {others - begun:.1f} s, it {there - guided:.1f} s after GUIDED, {words}")
        assert last <= beat + 0.001, f"a setpoint {last - beat} s after the heartbeat"
        assert max(truth.speed for truth in still) < 0.2


def test_an_autopilot_that_restarts_waits_for_its_pilot(fly, free_port):
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        companion = fly.companion(fly.example("six-rovers-crossing.toml"))
        begun = moving(simulation, time.time())
        time.sleep(AFTER_S)
        one = simulation[ONE]
        os.kill(one.process.child.pid, signal.SIGKILL)
        killed = time.time()
        last = one.truth[-1]
        # The simulation restarts at the vehicle's position.
        one.start = (last.east, last.north)
        one.process.wait()
        one.switch_on(speedup=1)
        others = arrive(simulation, GOALS, 150, numbers=OTHERS, within=4.0)
        companion.wait_for("the autopilot has restarted", 60)
        simulation.ready([one])
        time.sleep(2.0)
        assert not one.is_armed and one.mode != one.modes["GUIDED"]
        one.choose("GUIDED")
        one.arm()
        guided = time.time()
        there = arrive(simulation, GOALS, 90)
        words = least(simulation, begun)
        report = companion.finish()
        times = [at for at, _ in companion.setpoints(ONE)]
        # The companion does not notice before the link timeout.
        pause = [at for at in times if killed + 3.5 < at < guided - 1.0]
        figures(f"the others were there after {others - begun:.1f} s; setpoints to it ended {max(at for at in times if at < killed + 3.5) - killed:.1f} s after its death and "
                f"began again when its pilot had armed; it was there {there - guided:.1f} s later, {words}")
        assert pause == [], f"{len(pause)} setpoints without its pilot"
        assert report["vehicles"][ONE - 1]["restarts"] == 1


def test_a_vehicle_without_gps_stops_and_reports_it(fly, free_port):
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        companion = fly.companion(fly.example("six-rovers-crossing.toml"))
        begun = moving(simulation, time.time())
        time.sleep(AFTER_S)
        one = simulation[ONE]
        one.set("SIM_GPS1_ENABLE", 0)
        lost = time.time()
        companion.wait_for(f"robot {ONE}: position not trusted", 10)
        told = time.time()
        wait_until(lambda: one.truth[-1].speed < 0.2, 10, "standing")
        stood = time.time()
        others = arrive(simulation, GOALS, 150, numbers=OTHERS, within=14.0)
        rolled = one.place(stood - 0.2)
        words = least(simulation, begun)
        near, *_ = simulation.nearest(stood, time.time(), only=ONE)
        companion.finish()
        after = [m for at, m in companion.setpoints(ONE) if at > told + 0.1]
        figures(f"said so {told - lost:.2f} s after GPS ended, stood after {stood - lost:.1f} s; the others stood after {others - begun:.1f} s, {words}, {near:.2f} m to it then")
        assert all((m.vx, m.vy, m.vz) == (0.0, 0.0, 0.0) for m in after)
        # True position, while the vehicle's own estimate drifts.
        assert rolled is not None and abs(one.truth[-1].east - rolled[0]) < 2.0


def test_a_vehicle_with_a_second_receiver_continues_when_the_first_fails(fly, free_port):
    second = "SIM_GPS2_ENABLE 1\nGPS2_TYPE 1\nGPS_AUTO_SWITCH 1\n"
    with fly.vehicles("rover", [(0.0, 0.0)], free_port, parameters=second) as simulation:
        one = simulation[1]
        goal = (30.0, 0.0)
        companion = fly.companion(fly.config(fly.scenario([((0.0, 0.0), goal)]), "ardupilot-rover", 'entry = "once"\narm = true'))
        begun = moving(simulation, time.time())
        time.sleep(AFTER_S)
        one.set("SIM_GPS1_ENABLE", 0)
        ended = arrive(simulation, [goal], 60)
        companion.finish()
        doubts = [line for line in companion.process.output().splitlines() if "not trusted" in line]
        first, other = one.last["GPS_RAW_INT"][1].fix_type, one.last["GPS2_RAW"][1].fix_type
        figures(f"its first receiver (fix type {first}) fails on the way, its second has fix type {other}: there in {ended - begun:.1f} s, doubts: {doubts or 'none'}")
        assert first < 3 <= other and not any("GPS lost its fix" in line for line in doubts)


def test_others_keep_clear_of_a_vehicle_whose_companion_dies(fly, free_port):
    """Each companion has its own process; one is killed, as by a power failure."""
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        companions = in_two_processes(fly, free_port)
        begun = moving(simulation, time.time())
        time.sleep(AFTER_S)
        one = simulation[ONE]
        os.kill(companions[0].process.child.pid, signal.SIGKILL)
        killed, at, speed = time.time(), one.truth[-1], one.truth[-1].speed
        wait_until(lambda: one.truth[-1].speed < 0.1, 15, "standing")
        stood = time.time()
        rolled = ((one.truth[-1].east - at.east) ** 2 + (one.truth[-1].north - at.north) ** 2) ** 0.5
        time.sleep(30.0)
        near, *_ = simulation.nearest(killed, time.time(), only=ONE)
        companions[1].finish()
        figures(f"killed at {speed:.2f} m/s it continued for {rolled:.1f} m and {stood - killed:.1f} s; {near:.2f} m to it from then on; "
                f"30 s later the others are {[round(simulation[n].off(GOALS[n - 1])) for n in OTHERS]} m from their goals")
        least(simulation, begun)


def test_a_companion_continues_after_a_pause(fly, free_port):
    """The companion of one vehicle pauses, in its own process; the others keep clear of it."""
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        companions = in_two_processes(fly, free_port)
        begun = moving(simulation, time.time())
        time.sleep(AFTER_S)
        paused = pause(companions[0], [simulation[ONE]])
        ended = arrive(simulation, GOALS, 120)
        words = least(simulation, begun)
        for companion in companions:
            companion.finish()
        figures(f"its companion stopped for 5 s, at the end of which it stood ({paused:.2f} m/s); all there in {ended - begun:.1f} s, {words}")
        assert paused < 0.3


def test_vehicles_without_a_controller_stop_and_continue_later(fly, free_port):
    """A single process for all is stopped for 5 s. For 3 of these, no controller separates the
    vehicles, so distances are not judged."""
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        companion = fly.companion(fly.example("six-rovers-crossing.toml"))
        begun = moving(simulation, time.time())
        time.sleep(AFTER_S)
        paused = pause(companion, simulation.vehicles)
        distance, *_ = simulation.nearest(begun, time.time())
        ended = arrive(simulation, GOALS, 150)
        companion.finish()
        figures(f"all stopped for 5 s in the middle: they stood by then ({paused:.2f} m/s at most), {distance:.2f} m apart at least; all there in {ended - begun:.1f} s")
        assert paused < 0.3


def pause(companion, vehicles):
    """Stops the process for 5 s. Returns the highest speed at the end of that time."""
    os.kill(companion.process.child.pid, signal.SIGSTOP)
    try:
        time.sleep(5.0)
        return max(vehicle.truth[-1].speed for vehicle in vehicles)
    finally:
        os.kill(companion.process.child.pid, signal.SIGCONT)


def in_two_processes(fly, free_port):
    """One companion for vehicle `ONE` and one for the others, connected by UDP."""
    lan, companions = [free_port(), free_port()], []
    scenario = fly.scenario(LINE)
    for mine, numbers in ((0, [ONE]), (1, OTHERS)):
        air = f'[air]\nbind = "127.0.0.1:{lan[mine]}"\npeers = ["127.0.0.1:{lan[1 - mine]}"]'
        config = fly.config(scenario, "ardupilot-rover", 'entry = "once"\narm = true', air, numbers)
        companions.append(fly.companion(config))
    return companions
