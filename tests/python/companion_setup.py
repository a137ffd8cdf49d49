"""Scenarios, configurations and shutdown of `staya companion` for tests."""

from fake_autopilot import ORIGIN


AUTOPILOTS = {"rover": "ardupilot-rover", "copter": "ardupilot-copter", "px4": "px4-copter"}
# Tick of all scenarios.
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


def rate(vehicle, since, until):
    return sum(since <= at < until for at, *_ in vehicle.setpoints) / (until - since)


def ends_well(process):
    """Stops the companion with Ctrl-C. Returns its output."""
    assert process.interrupt() == 130, process.output()
    return process.output()
