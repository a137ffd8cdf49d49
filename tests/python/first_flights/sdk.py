"""MAVSDK-Python with a server of its own per script, which ends with the script."""

import asyncio
import signal
import sys

from mavsdk_grpc import System

SERVERS = []


async def connected():
    """The vehicle at the address of the command line; the last argument is the server's port."""
    drone = System(port=int(sys.argv[-1]))
    SERVERS.append(drone)
    await drone.connect(system_address=sys.argv[1])
    async for state in drone.core.connection_state():
        if state.is_connected:
            return drone


def fly(run):
    """Runs a flight for 80 s at most."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    try:
        asyncio.run(asyncio.wait_for(run(), 80))
    finally:
        for drone in SERVERS:
            drone._stop_mavsdk_server()
