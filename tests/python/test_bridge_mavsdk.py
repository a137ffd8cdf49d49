"""`staya bridge` with MAVSDK: one vehicle and ten."""

import math
import time

import pytest
from bridge_client import LAT, LON
from conftest import wait_until

mavsdk = pytest.importorskip("mavsdk")

from mavsdk import ComponentType, Configuration, Mavsdk  # noqa: E402
from mavsdk.plugins.action import Action, ActionError  # noqa: E402
from mavsdk.plugins.mission import Mission, MissionItem, MissionPlan  # noqa: E402
from mavsdk.plugins.offboard import Offboard, VelocityNedYaw  # noqa: E402
from mavsdk.plugins.param import Param  # noqa: E402
from mavsdk.plugins.telemetry import Telemetry  # noqa: E402

ONE = """
name = "one"
ticks = 1000
tick_s = 0.05
[plane]
radius_m = 0.25
max_speed_mps = 2
tolerance_m = 0.1
[[plane.robots.list]]
start_m = [3, 0]
"""


@pytest.fixture
def connect(staya, free_port):
    """A function that starts a bridge and returns MAVSDK's vehicles by number."""
    opened = []

    def start(scenario, count, *options):
        port = free_port()
        process = staya("bridge", scenario, "--mavlink", f"udpout:127.0.0.1:{port}", "--speed", 3, "--quiet", *options)
        sdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
        opened.append(sdk)
        sdk.add_any_connection(f"udpin://127.0.0.1:{port}")

        def found():
            systems = [system for system in sdk.get_systems() if system.has_autopilot()]
            return systems if len(systems) == count else None

        systems = wait_until(found, 15, f"{count} vehicles; {process.output()}")
        return {system.get_system_id(): system for system in systems}

    yield start
    for sdk in opened:
        sdk.destroy()


def near(telemetry, north, east, within=0.3):
    at = telemetry.position_velocity_ned().position
    return math.hypot(at.north_m - north, at.east_m - east) < within


def degrees(north, east):
    return LAT + math.degrees(north / 6_367_500), LON + math.degrees(east / (6_388_000 * math.cos(math.radians(LAT))))


def fly(system, north, east):
    """Offboard velocity, then a goto, from the vehicle's position."""
    telemetry, action, offboard = Telemetry(system), Action(system), Offboard(system)
    wait_until(lambda: telemetry.armed() and near(telemetry, north, east), 15, "telemetry")
    place = telemetry.position()
    latitude, longitude = degrees(north, east)
    assert abs(place.latitude_deg - latitude) < 1e-6 and abs(place.longitude_deg - longitude) < 1e-6
    offboard.set_velocity_ned(VelocityNedYaw(-0.8, 0.0, 0.0, 0.0))
    offboard.start()
    wait_until(lambda: abs(telemetry.position_velocity_ned().velocity.north_m_s + 0.8) < 0.05, 15, "the velocity")
    assert offboard.is_active()
    offboard.stop()
    wait_until(lambda: abs(telemetry.position_velocity_ned().velocity.north_m_s) < 0.05, 15, "the stop")
    action.goto_location(*degrees(north - 4.0, east + 0.3), place.absolute_altitude_m, 0.0)
    wait_until(lambda: near(telemetry, north - 4.0, east + 0.3), 15, "the goto")
    return telemetry, action


def test_one_vehicle(connect, tmp_path):
    scenario = tmp_path / "one.toml"
    scenario.write_text(ONE)
    (system,) = connect(scenario, 1).values()
    telemetry, action = fly(system, 0.0, 3.0)
    wait_until(lambda: telemetry.home().latitude_deg > 47, 10, "a home")
    assert not telemetry.in_air()
    # Unsupported commands are answered.
    with pytest.raises(ActionError):
        action.takeoff()
    parameters = Param(system)
    assert parameters.get_param_float("RADIUS_M") == 0.25
    parameters.set_param_float("SPEED_MPS", 0.5)
    assert parameters.get_param_float("SPEED_MPS") == 0.5
    # A moving vehicle is not disarmed.
    wait_until(lambda: abs(telemetry.position_velocity_ned().velocity.north_m_s) < 0.01, 10, "the end of the goto")
    action.disarm()
    wait_until(lambda: not telemetry.armed(), 10, "to be disarmed")


@pytest.mark.long
def test_ten_vehicles(connect):
    systems = connect("scenarios/bridge.toml", 10)
    assert sorted(systems) == list(range(1, 11))
    # All vehicles get commands at once; each client sends its own setpoints.
    flights = {}
    for number, system in systems.items():
        telemetry, offboard = Telemetry(system), Offboard(system)
        wait_until(telemetry.armed, 15, f"telemetry of {number}")
        offboard.set_velocity_ned(VelocityNedYaw(-0.8 if number <= 5 else 0.8, 0.0, 0.0, 0.0))
        offboard.start()
        flights[number] = (telemetry, offboard, Action(system))
    for number, (telemetry, offboard, action) in flights.items():
        wanted = -0.8 if number <= 5 else 0.8
        wait_until(lambda: abs(telemetry.position_velocity_ned().velocity.north_m_s - wanted) < 0.1, 15, f"{number}")
    for _, offboard, _ in flights.values():
        offboard.stop()
    for number, (telemetry, _, action) in flights.items():
        action.goto_location(*degrees(-6.0 if number <= 5 else 12.0, 2.0 * number), 488.0, 0.0)
    for number, (telemetry, _, _) in flights.items():
        wait_until(lambda: near(telemetry, -6.0 if number <= 5 else 12.0, 2.0 * number), 25, f"goto of {number}")


def test_takeoff_and_landing(connect):
    systems = connect("scenarios/bridge-fly.toml", 4, "--disarmed")
    telemetry, action = Telemetry(systems[2]), Action(systems[2])
    wait_until(lambda: telemetry.health().is_armable and telemetry.health().is_global_position_ok, 15, "its health")
    assert not telemetry.armed()
    action.set_takeoff_altitude(4.0)
    action.arm()
    action.takeoff()
    wait_until(lambda: abs(telemetry.position().relative_altitude_m - 4.0) < 0.2 and telemetry.in_air(), 15, "the height")
    action.land()
    wait_until(lambda: not telemetry.armed() and not telemetry.in_air(), 15, "the landing")


def item(north, east, height, **wanted):
    """A mission item as in MAVSDK's examples, with a speed and no camera action."""
    latitude, longitude = degrees(north, east)
    nan = math.nan
    usual = dict(
        latitude_deg=latitude,
        longitude_deg=longitude,
        relative_altitude_m=height,
        speed_m_s=10.0,
        is_fly_through=True,
        gimbal_pitch_deg=nan,
        gimbal_yaw_deg=nan,
        camera_action=MissionItem.CameraAction.NONE,
        loiter_time_s=nan,
        camera_photo_interval_s=nan,
        acceptance_radius_m=nan,
        yaw_deg=nan,
        camera_photo_distance_m=nan,
        vehicle_action=MissionItem.VehicleAction.NONE,
    )
    return MissionItem(**{**usual, **wanted})


def fly_mission(system, plan, returns):
    """Uploads, arms, starts and waits for the end, as MAVSDK's examples do."""
    mission, action, telemetry = Mission(system), Action(system), Telemetry(system)
    wait_until(lambda: telemetry.health().is_global_position_ok, 15, "a position")
    mission.set_return_to_launch_after_mission(returns)
    mission.upload_mission(MissionPlan(plan))
    action.arm()
    mission.start_mission()
    wait_until(mission.is_mission_finished, 40, "the end of the mission")
    progress = mission.mission_progress()
    assert progress.current == progress.total == len(plan)
    return telemetry


def test_missions_with_speeds_run_to_their_end(connect, tmp_path):
    scenario = tmp_path / "one.toml"
    scenario.write_text(ONE)
    (system,) = connect(scenario, 1).values()
    # The first item is the vehicle's position: MAVSDK sends no home, and item 0 becomes home, as in
    # ArduPilot.
    plan = [item(0.0, 3.0, 0.0), item(4.0, 3.0, 0.0, loiter_time_s=0.5), item(4.0, 6.0, 0.0, is_fly_through=False)]
    telemetry = fly_mission(system, plan, False)
    assert near(telemetry, 4.0, 6.0, 1.5)


def test_a_mission_in_the_air_with_a_camera_returns(connect):
    systems = connect("scenarios/bridge-fly.toml", 4, "--disarmed")
    photo = dict(camera_action=MissionItem.CameraAction.TAKE_PHOTO, gimbal_pitch_deg=20.0, gimbal_yaw_deg=60.0)
    plan = [item(0.0, 0.0, 5.0), item(0.0, 4.0, 5.0, **photo), item(4.0, 4.0, 6.0)]
    telemetry = fly_mission(systems[1], plan, True)
    wait_until(lambda: not telemetry.armed() and not telemetry.in_air(), 40, "the landing at home")
