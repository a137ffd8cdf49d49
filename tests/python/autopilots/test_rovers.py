"""Rovers of ArduPilot's simulator, without failures."""

import math
import time

import pytest
from conftest import wait_until
from flight import GOALS, STARTS, arrive, figures, fly, least, moving, needs, rates  # noqa: F401

pytestmark = needs("rover")


def test_six_rovers_exchange_their_places(fly, free_port):
    with fly.vehicles("rover", STARTS, free_port) as simulation:
        companion = fly.companion(fly.example("six-rovers-crossing.toml"))
        begun = moving(simulation, time.time())
        ended = arrive(simulation, GOALS, 120)
        words, pace = least(simulation, begun), simulation.pace()
        report = companion.finish()
        found = rates(companion, simulation, ended)
        figures(f"all there in {ended - begun:.1f} s, {words}, {min(found):.1f} to {max(found):.1f} setpoints a second each; "
                f"the simulation went at {pace:.2f} of real time")
        assert all(19.0 <= each <= 21.0 for each in found), found
        assert all(vehicle["neighbors"] == 5 and vehicle["restarts"] == 0 for vehicle in report["vehicles"]), report


def test_a_dry_run_shows_velocities_and_moves_nothing(fly, free_port):
    with fly.vehicles("rover", STARTS[:1], free_port) as simulation:
        begun = time.time()
        process = fly.staya("companion", fly.example("one-rover.toml", lambda text: text.replace('multicast = "239.255.77.1:14999"', 'tunnel = true')), "--dry-run", "--seconds", "8")
        assert process.wait() == 0, process.output()
        shown = [line for line in process.output().splitlines() if "SET_POSITION_TARGET_LOCAL_NED" in line]
        rover = simulation[1]
        assert 3 <= len(shown) <= 12, process.output()
        assert not rover.is_armed and rover.mode == rover.modes["MANUAL"] and max(truth.speed for truth in rover.between(begun)) < 0.1
        figures(f"{len(shown)} velocities shown in 8 s, nothing moved")


@pytest.mark.parametrize("model", ["rover-skid", "rover"])
def test_two_rovers_head_on_pass_each_other(fly, free_port, model):
    extra = ["rover-skid.parm"] if model == "rover-skid" else []
    starts = [(0.0, 0.0), (30.0, 0.0)]
    with fly.vehicles("rover", starts, free_port, model=model, defaults=extra) as simulation:
        simulation[2].heading = -90
        companion = fly.companion(fly.config(fly.scenario(zip(starts, starts[::-1])), "ardupilot-rover", 'entry = "once"\narm = true'))
        begun = moving(simulation, time.time())
        ended = arrive(simulation, starts[::-1], 90)
        distance, *_ = simulation.nearest(begun, ended)
        companion.finish()
        figures(f"{model}: past each other and there in {ended - begun:.1f} s, nearest {distance:.2f} m, with 2 m between their discs' centres that touch and 0.5 m of margin each")
        assert distance > 2.0


@pytest.mark.parametrize("model", ["rover-skid", "rover"])
def test_stationary_rovers_keep_their_heading(fly, free_port, model):
    """Includes rovers that turn on the spot: ArduRover interprets a zero velocity as north."""
    extra = ["rover-skid.parm"] if model == "rover-skid" else []
    starts, goals = [(0.0, 0.0), (14.0, 0.0)], [(14.0, -6.0), (0.0, -6.0)]
    with fly.vehicles("rover", starts, free_port, model=model, defaults=extra) as simulation:
        companion = fly.companion(fly.config(fly.scenario(zip(starts, goals)), "ardupilot-rover", 'entry = "once"\narm = true'))
        begun = moving(simulation, time.time())
        ended = arrive(simulation, goals, 90)
        time.sleep(20.0)
        words = least(simulation, begun, ended)
        turned, drifted = [], []
        for vehicle in simulation.vehicles:
            stood = vehicle.between(ended + 1.0)
            turned.append(max(abs(math.degrees(math.remainder(truth.yaw - stood[0].yaw, 2 * math.pi))) for truth in stood))
            drifted.append(max(math.dist((truth.east, truth.north), (stood[0].east, stood[0].north)) for truth in stood))
        companion.finish()
        figures(f"{model}: there in {ended - begun:.1f} s, {words}; in 20 s standing they turned by {max(turned):.1f} degrees and went {max(drifted):.2f} m at most")
        assert max(turned) < 10.0 and max(drifted) < 0.5, (turned, drifted)



# In a complete formation every vehicle is within a metre of its place relative to the leader.
FORMED_S, WANTED_ERROR_M, WANTED_SHARE = 10.0, 1.0, 1.2


def test_six_rovers_hold_their_formation(fly, free_port):
    """Two rows of three with 8 m between them, 160 m to the north-east; the origin is the
    example's."""
    places = [(-8.0 * (i % 3), -8.0 * (i // 3)) for i in range(6)]
    starts = [(x, y) for x, y in places]
    goals = [(x + 160.0, y + 160.0) for x, y in starts]
    with fly.vehicles("rover", starts, free_port) as simulation:
        companion = fly.companion(fly.example("six-rovers-formation.toml"))
        begun = moving(simulation, time.time())
        ended = None
        try:
            ended = arrive(simulation, goals, 300, within=2.0)
        finally:
            until = ended or time.time()
            errors = {number: [] for number in range(2, 7)}
            for step in range(int((until - begun - FORMED_S) * 5)):
                at = begun + FORMED_S + step / 5
                now = [vehicle.place(at) for vehicle in simulation.vehicles]
                if None in now:
                    continue
                for number in errors:
                    wanted = [now[0][axis] + places[number - 1][axis] for axis in (0, 1)]
                    errors[number].append(math.dist(now[number - 1][:2], wanted))
            worst = {number: max(error) for number, error in errors.items()}
            # A single rover moves straight at its highest speed.
            alone = math.dist(starts[0], goals[0]) / 2.0
            share = (until - begun) / alone
            distance, *_ = simulation.nearest(begun, until)
            said = f"in {until - begun:.0f} s" if ended else f"not there after {until - begun:.0f} s"
            figures(f"formation: {said} ({share:.2f} times alone), {max(worst.values()):.2f} m off its place at most after the first {FORMED_S:.0f} s "
                    f"(by robot {({n: round(e, 1) for n, e in worst.items()})}), nearest pair {distance:.2f} m; wanted: 1 m, 1.2 times")
        companion.finish()
        assert distance > 2.0
        assert max(worst.values()) <= WANTED_ERROR_M and share <= WANTED_SHARE
