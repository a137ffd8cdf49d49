"""The calls of DroneKit's example simple_goto: arm, take off, two places, return."""

import time

from kit import LocationGlobalRelative, VehicleMode, distance, offset, vehicle

drone = vehicle()
while not drone.is_armable:
    time.sleep(1)
drone.mode = VehicleMode("GUIDED")
drone.armed = True
while not drone.armed:
    time.sleep(1)
drone.simple_takeoff(10)
while drone.location.global_relative_frame.alt < 10 * 0.95:
    time.sleep(1)
print("off", flush=True)
start = drone.location.global_relative_frame
drone.airspeed = 3
for north, east, how in [(20.0, 0.0, {}), (20.0, 25.0, {"groundspeed": 10})]:
    goal = offset(start, north, east, LocationGlobalRelative)
    goal.alt = 20
    drone.simple_goto(goal, **how)
    while distance(drone.location.global_relative_frame, goal) > 1.0 or abs(drone.location.global_relative_frame.alt - 20) > 1:
        time.sleep(0.5)
    print("there", flush=True)
drone.mode = VehicleMode("RTL")
while drone.armed:
    time.sleep(0.5)
assert distance(drone.location.global_relative_frame, start) < 1.0
drone.close()
print("done")
