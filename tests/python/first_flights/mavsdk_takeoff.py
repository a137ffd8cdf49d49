"""The calls of MAVSDK-Python's examples takeoff_and_land and telemetry_takeoff_and_land."""

import asyncio

from sdk import connected, fly


async def tell(drone, stream, shown):
    async for value in stream:
        shown.append(value)


async def landed(drone):
    was_in_air = False
    async for is_in_air in drone.telemetry.in_air():
        was_in_air |= is_in_air
        if was_in_air and not is_in_air:
            return


async def run():
    drone = await connected()
    heights, modes = [], []
    tasks = [
        asyncio.ensure_future(tell(drone, drone.telemetry.position(), heights)),
        asyncio.ensure_future(tell(drone, drone.telemetry.flight_mode(), modes)),
    ]
    ends = asyncio.ensure_future(landed(drone))
    async for health in drone.telemetry.health():
        if health.is_global_position_ok and health.is_home_position_ok:
            break
    async for is_ok in drone.telemetry.health_all_ok():
        if is_ok:
            print("healthy", flush=True)
            break
    await drone.action.arm()
    await drone.action.set_takeoff_altitude(10.0)
    await drone.action.takeoff()
    async for position in drone.telemetry.position():
        if position.relative_altitude_m > 9.5:
            break
    await drone.action.hold()
    await drone.action.land()
    await ends
    for task in tasks:
        task.cancel()
    assert max(position.relative_altitude_m for position in heights) > 9.5
    print("done", sorted({str(mode) for mode in modes}))


fly(run)
