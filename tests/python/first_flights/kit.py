"""DroneKit as it is installed. Python removed the names that it takes from `collections`."""

import collections
import collections.abc
import math
import sys

collections.MutableMapping = collections.abc.MutableMapping

from dronekit import Command, LocationGlobal, LocationGlobalRelative, VehicleMode, connect  # noqa: E402,F401


def vehicle():
    """The vehicle at the address of the command line."""
    return connect(sys.argv[1], wait_ready=True)


def offset(location, north, east, kind=LocationGlobal):
    """A place at metres from another one."""
    latitude = location.lat + math.degrees(north / 6_378_137.0)
    longitude = location.lon + math.degrees(east / (6_378_137.0 * math.cos(math.radians(location.lat))))
    return kind(latitude, longitude, location.alt)


def distance(a, b):
    """Metres between two places."""
    return math.hypot(a.lat - b.lat, a.lon - b.lon) * 1.113195e5
