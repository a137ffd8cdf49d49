"""The calls of DroneKit's example vehicle_state: attributes, modes, arming, observers, home,
parameters, raw messages."""

import sys
import time

from kit import VehicleMode, vehicle

drone = vehicle()
drone.wait_ready("autopilot_version")
print(drone.version, drone.capabilities.set_attitude_target, drone.capabilities.mission_float)
location, velocity = drone.location, drone.velocity
print(location.global_frame, location.global_relative_frame, location.local_frame, drone.attitude, velocity)
print(drone.gps_0, drone.gimbal, drone.battery, drone.ekf_ok, drone.last_heartbeat, drone.rangefinder)
print(drone.heading, drone.is_armable, drone.system_status.state, drone.groundspeed, drone.airspeed)
assert drone.ekf_ok and drone.is_armable and drone.gps_0.fix_type == 3
while not drone.home_location:
    commands = drone.commands
    commands.download()
    commands.wait_ready()
print("home", drone.home_location)
drone.home_location = drone.location.global_frame
drone.mode = VehicleMode("GUIDED")
while drone.mode.name != "GUIDED":
    time.sleep(1)
while not drone.is_armable:
    time.sleep(1)
drone.armed = True
while not drone.armed:
    time.sleep(1)
seen = []
drone.add_attribute_listener("mode", lambda self, name, value: seen.append(value.name))
texts = []
drone.add_message_listener("STATUSTEXT", lambda self, name, message: texts.append(message.text))
drone.mode = VehicleMode("MANUAL" if sys.argv[2] == "rover" else "STABILIZE")
time.sleep(2)
assert any("mode 0 is unsupported" in text for text in texts), texts
other = "HOLD" if sys.argv[2] == "rover" else "LOITER"
drone.mode = VehicleMode(other)
deadline = time.monotonic() + 10
while other not in seen:
    assert time.monotonic() < deadline
    time.sleep(0.1)
counted = []
drone.add_message_listener("*", lambda self, name, message: counted.append(name))
time.sleep(1.5)
assert {"HEARTBEAT", "SYS_STATUS", "EKF_STATUS_REPORT", "GLOBAL_POSITION_INT"} <= set(counted), set(counted)
print("speed", drone.parameters["SPEED_MPS"])
drone.parameters["SPEED_MPS"] = 1.5
assert drone.parameters["SPEED_MPS"] == 1.5
drone.armed = False
while drone.armed:
    time.sleep(0.5)
drone.close()
print("done")
