"""The calls of MAVSDK-Python's example offboard_velocity_ned, with shorter pauses."""

import asyncio
import sys

from mavsdk_grpc.offboard import VelocityNedYaw
from sdk import connected, fly

FLIES = sys.argv[2] == "copter"


async def moves(drone, north, east, down):
    """Waits until the vehicle has a velocity."""
    async for state in drone.telemetry.position_velocity_ned():
        velocity = state.velocity
        if max(abs(velocity.north_m_s - north), abs(velocity.east_m_s - east), abs(velocity.down_m_s - down)) < 0.2:
            return


async def run():
    drone = await connected()
    async for health in drone.telemetry.health():
        if health.is_global_position_ok and health.is_home_position_ok:
            break
    await drone.action.arm()
    await drone.offboard.set_velocity_ned(VelocityNedYaw(0.0, 0.0, 0.0, 0.0))
    await drone.offboard.start()
    up = [(0.0, 0.0, -2.0, 0.0)] if FLIES else []
    for north, east, down, yaw in up + [(2.0, 0.0, 0.0, 90.0), (-2.0, 0.0, 0.0, 270.0), (0.0, -2.0, 0.0, 90.0), (0.0, 2.0, 0.0, 90.0)]:
        await drone.offboard.set_velocity_ned(VelocityNedYaw(north, east, down, yaw))
        await asyncio.wait_for(moves(drone, north, east, down), 15)
        await asyncio.sleep(1)
        print("velocity", north, east, down, flush=True)
    await drone.offboard.set_velocity_ned(VelocityNedYaw(0.0, 0.0, 0.0, 180.0))
    await asyncio.wait_for(moves(drone, 0.0, 0.0, 0.0), 15)
    await drone.offboard.stop()
    if FLIES:
        await drone.action.land()
    print("done")


fly(run)
