#ifndef STUB_STABILIZER_TYPES_H
#define STUB_STABILIZER_TYPES_H
typedef enum mode_e { modeDisable = 0, modeAbs, modeVelocity } stab_mode_t;
typedef struct {
    struct { float x, y, z; } position, velocity;
    struct { float roll, pitch, yaw; } attitudeRate;
    bool velocity_body;
    struct { stab_mode_t x, y, z, roll, pitch, yaw, quat; } mode;
} setpoint_t;
#endif
