"""The calls of DroneKit's guide for vehicles on the ground: guided places and velocities, home."""

import time

from kit import LocationGlobalRelative, VehicleMode, distance, offset, vehicle
from pymavlink import mavutil

rover = vehicle()
while not rover.is_armable:
    time.sleep(1)
rover.mode = VehicleMode("GUIDED")
while rover.mode.name != "GUIDED":
    time.sleep(0.2)
rover.armed = True
while not rover.armed:
    time.sleep(1)
commands = rover.commands
commands.download()
commands.wait_ready()
home = rover.home_location
print("home", home.lat, home.lon, flush=True)
goal = offset(rover.location.global_relative_frame, 15.0, 8.0, LocationGlobalRelative)
rover.simple_goto(goal)
while distance(rover.location.global_relative_frame, goal) > 1.0:
    time.sleep(0.2)
print("there", flush=True)
for _ in range(3):
    message = rover.message_factory.set_position_target_local_ned_encode(
        0, 0, 0, mavutil.mavlink.MAV_FRAME_LOCAL_NED, 0b0000111111000111, 0, 0, 0, -2.0, 0, 0, 0, 0, 0, 0, 0
    )
    rover.send_mavlink(message)
    time.sleep(1)
assert rover.velocity[0] < -1.0, rover.velocity
rover.mode = VehicleMode("RTL")
while distance(rover.location.global_frame, home) > 1.0:
    time.sleep(0.2)
rover.mode = VehicleMode("HOLD")
while rover.groundspeed > 0.02:
    time.sleep(0.2)
rover.armed = False
while rover.armed:
    time.sleep(0.5)
rover.close()
print("done")
