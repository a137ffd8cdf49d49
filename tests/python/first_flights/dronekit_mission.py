"""The calls of DroneKit's example mission_basic: a square of waypoints with a takeoff, uploaded by
MISSION_ITEM, flown with a skipped item, and the return."""

import sys
import time

from kit import Command, LocationGlobalRelative, VehicleMode, distance, offset, vehicle
from pymavlink import mavutil

WAYPOINT, TAKEOFF = mavutil.mavlink.MAV_CMD_NAV_WAYPOINT, mavutil.mavlink.MAV_CMD_NAV_TAKEOFF
RELATIVE = mavutil.mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
FLIES = sys.argv[2] == "copter"
SIZE = 12.0

drone = vehicle()
commands = drone.commands
if FLIES:
    # Without a download the first item becomes home, as with ArduPilot.
    commands.download()
    commands.wait_ready()
here = drone.location.global_frame
commands.clear()
if FLIES:
    commands.add(Command(0, 0, 0, RELATIVE, TAKEOFF, 0, 0, 0, 0, 0, 0, 0, 0, 10))
corners = [offset(here, SIZE * north, SIZE * east) for north, east in [(1, -1), (1, 1), (-1, 1), (-1, -1)]]
for height, corner in zip([11, 12, 13, 14, 14], corners + corners[-1:]):
    commands.add(Command(0, 0, 0, RELATIVE, WAYPOINT, 0, 0, 0, 0, 0, 0, corner.lat, corner.lon, height))
commands.upload()
print("uploaded", flush=True)
while not drone.is_armable:
    time.sleep(1)
drone.mode = VehicleMode("GUIDED")
drone.armed = True
while not drone.armed:
    time.sleep(1)
if FLIES:
    drone.simple_takeoff(10)
    while drone.location.global_relative_frame.alt < 10 * 0.95:
        time.sleep(1)
drone.commands.next = 0
drone.mode = VehicleMode("AUTO")
first, last = (3, 5) if FLIES else (2, 4)
while True:
    following = drone.commands.next
    if following:
        item = drone.commands[following - 1]
        place = LocationGlobalRelative(item.x, item.y, item.z)
        print(f"{distance(drone.location.global_frame, place):.1f} m to item {following}", flush=True)
    if following == first:
        drone.commands.next = last
    if following == last:
        break
    time.sleep(0.5)
drone.mode = VehicleMode("RTL")
while distance(drone.location.global_frame, here) > 1.0:
    time.sleep(0.5)
commands.download()
commands.wait_ready()
assert commands.count == (6 if FLIES else 4), commands.count
assert abs(commands[commands.count - 1].x - corners[-1].lat) < 1e-5
drone.close()
print("done")
