"""Copters of ArduPilot's simulator."""

import time

from conftest import wait_until
from flight import GOALS, STARTS, arrive, figures, fly, least, moving, needs, rates  # noqa: F401

pytestmark = needs("copter")
# Four of the example's six vehicles; each still crosses the paths of others.
FOUR = STARTS[:4]
HEIGHT = 10.0


def heights(simulation, companion, until):
    """Lowest and highest position under control."""
    found = []
    for vehicle in simulation.vehicles:
        found += [truth.up for truth in vehicle.between(companion.setpoints(vehicle.number)[0][0], until)]
    return min(found), max(found)


def test_copters_cross_at_their_pilots_takeoff_height(fly, free_port):
    def waits(text):
        return text.replace('entry = "once"\narm = true\ntakeoff = true\naltitude_m = 10\n', 'entry = "wait"\n')

    with fly.vehicles("copter", FOUR, free_port) as simulation:
        config = fly.example("six-copters-crossing.toml", waits)
        assert 'entry = "wait"' in config.read_text()
        companion = fly.companion(config)
        companion.wait_for("robot 4: pilot has control")
        for vehicle in simulation.vehicles:
            vehicle.choose("GUIDED")
        for vehicle in simulation.vehicles:
            vehicle.arm()
        for vehicle in simulation.vehicles:
            vehicle.take_off(HEIGHT)
        begun = moving(simulation, time.time(), 60)
        ended = arrive(simulation, GOALS, 120)
        words = least(simulation, begun)
        companion.finish()
        low, high = heights(simulation, companion, ended)
        firsts = [companion.setpoints(vehicle.number)[0][0] for vehicle in simulation.vehicles]
        climbed = [vehicle.place(at)[2] for vehicle, at in zip(simulation.vehicles, firsts)]
        figures(f"steered from {min(climbed):.1f} m up; crossed at {low:.1f} to {high:.1f} m; all there in {ended - begun:.1f} s, {words}")
        assert min(climbed) > HEIGHT - 1.0 and HEIGHT - 1.5 < low and high < HEIGHT + 1.5


def test_copters_take_off_cross_and_arrive(fly, free_port):
    with fly.vehicles("copter", FOUR, free_port) as simulation:
        started = time.time()
        companion = fly.companion(fly.example("six-copters-crossing.toml"))
        begun = moving(simulation, started, 90)
        ended = arrive(simulation, GOALS, 120)
        words, pace = least(simulation, begun), simulation.pace()
        companion.finish()
        (low, high), found = heights(simulation, companion, ended), rates(companion, simulation, ended)
        figures(f"on their way {begun - started:.1f} s after the start, there {ended - begun:.1f} s later at {low:.1f} to {high:.1f} m, {words}, "
                f"{min(found):.1f} to {max(found):.1f} setpoints a second; the simulation went at {pace:.2f} of real time")
        assert HEIGHT - 1.5 < low and high < HEIGHT + 1.5 and all(19.0 <= each <= 21.0 for each in found), found


def test_copters_cross_in_wind_of_8_m_per_s(fly, free_port):
    with fly.vehicles("copter", FOUR, free_port) as simulation:
        for vehicle in simulation.vehicles:
            vehicle.set("SIM_WIND_DIR", 180)
            vehicle.set("SIM_WIND_SPD", 8)
        started = time.time()
        companion = fly.companion(fly.example("six-copters-crossing.toml"))
        begun = moving(simulation, started, 90)
        ended = arrive(simulation, GOALS, 120)
        words = least(simulation, begun)
        companion.finish()
        figures(f"wind of 8 m/s from the south: there {ended - begun:.1f} s after setting off, {words}")


def test_the_pilots_loiter_is_respected(fly, free_port):
    with fly.vehicles("copter", FOUR, free_port) as simulation:
        companion = fly.companion(fly.example("six-copters-crossing.toml"))
        begun = moving(simulation, time.time(), 90)
        time.sleep(4.0)
        one = simulation[2]
        held = one.choose("BRAKE")
        companion.wait_for("robot 2: pilot has control")
        arrive(simulation, GOALS, 150, numbers=[1, 3, 4], within=6.0)
        assert one.mode == one.modes["BRAKE"], "it was taken back"
        words = least(simulation, begun)
        companion.finish()
        beat = next(at for at, m in companion.messages() if m.get_type() == "HEARTBEAT" and m.get_srcSystem() == 2 and m.custom_mode == 17)
        late = [at for at, _ in companion.setpoints(2) if at > beat]
        last = max(at for at, _ in companion.setpoints(2))
        figures(f"BRAKE: last setpoint {1e3 * (beat - last):.0f} ms before the heartbeat that says so, none after; {words}")
        assert late == [], f"{len(late)} setpoints after {held}"


def test_copters_fly_to_goals_at_their_heights(fly, free_port):
    """`safety = "fly"`: after the takeoff to 8 m, heights follow the scenario's goals (5 and 20 m)
    and ORCA."""
    starts, goals = [(0.0, 0.0, 8.0), (20.0, 0.0, 8.0)], [(20.0, 0.0, 5.0), (0.0, 0.0, 20.0)]
    heights_m = [height for _, _, height in goals]
    with fly.vehicles("copter", [start[:2] for start in starts], free_port) as simulation:
        scenario = fly.scenario(zip(starts, goals), 'safety = "fly"')
        companion = fly.companion(fly.config(scenario, "ardupilot-copter", 'entry = "once"\narm = true\ntakeoff = true\naltitude_m = 8'))
        begun = moving(simulation, time.time(), 90)
        ended = arrive(simulation, goals, 120)
        wait_until(lambda: all(abs(v.truth[-1].up - h) < 1.5 for v, h in zip(simulation.vehicles, heights_m)), 30, "their heights")
        time.sleep(5.0)
        found = [vehicle.truth[-1].up for vehicle in simulation.vehicles]
        words = least(simulation, begun)
        companion.finish()
        figures(f"goals at 5 and 20 m: at {found[0]:.1f} and {found[1]:.1f} m, {ended - begun:.1f} s after setting off, {words}")
        assert all(abs(a - b) < 1.5 for a, b in zip(found, heights_m))
