"""The calls of MAVSDK-Python's examples mission and geofence."""

import asyncio
import math
import sys

from mavsdk_grpc.geofence import FenceType, GeofenceData, GeofenceError, Point, Polygon
from mavsdk_grpc.mission import MissionItem, MissionPlan
from sdk import connected, fly

FLIES = sys.argv[2] == "copter"
NAN = float("nan")
TEXTS = []


def item(latitude, longitude, height):
    none = MissionItem.CameraAction.NONE
    return MissionItem(latitude, longitude, height, 10, True, NAN, NAN, none, NAN, NAN, NAN, NAN, NAN, MissionItem.VehicleAction.NONE)


async def listen(drone):
    async for text in drone.telemetry.status_text():
        TEXTS.append(text.text)


async def progress(drone):
    async for mission in drone.mission.mission_progress():
        print(f"item {mission.current} of {mission.total}", flush=True)


async def run():
    drone = await connected()
    tasks = [asyncio.ensure_future(listen(drone)), asyncio.ensure_future(progress(drone))]
    async for place in drone.telemetry.position():
        lat, lon = place.latitude_deg, place.longitude_deg
        break
    corners = [Point(lat + dlat, lon + dlon) for dlat, dlon in [(-1e-3, -1e-3), (1e-3, -1e-3), (1e-3, 1e-3), (-1e-3, 1e-3)]]
    try:
        await drone.geofence.upload_geofence(GeofenceData([Polygon(corners, FenceType.INCLUSION)], []))
        raise AssertionError("the fence is not stored")
    except GeofenceError as error:
        print("geofence:", error, flush=True)
    for _ in range(50):
        if any("geofences are unsupported" in text for text in TEXTS):
            break
        await asyncio.sleep(0.1)
    else:
        raise AssertionError(TEXTS)
    await drone.mission.set_return_to_launch_after_mission(True)
    plan = [item(lat, lon, 20), item(lat + 2e-4, lon, 20), item(lat + 2e-4, lon + 2e-4, 25)]
    await drone.mission.upload_mission(MissionPlan(plan))
    async for health in drone.telemetry.health():
        if health.is_global_position_ok and health.is_home_position_ok:
            break
    await drone.action.arm()
    await drone.mission.start_mission()
    was_away = False
    async for place in drone.telemetry.position():
        metres = math.hypot(place.latitude_deg - lat, place.longitude_deg - lon) * 1.1e5
        was_away |= metres > 20
        if was_away and metres < 1.0:
            break
    if FLIES:
        async for is_in_air in drone.telemetry.in_air():
            if not is_in_air:
                break
        async for is_armed in drone.telemetry.armed():
            if not is_armed:
                break
    assert await drone.mission.is_mission_finished()
    for task in tasks:
        task.cancel()
    print("done")


fly(run)
