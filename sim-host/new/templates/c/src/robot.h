/* The robot of my-swarm: the code shared by this computer and the microcontroller. */
#ifndef ROBOT_H
#define ROBOT_H

#include "staya.h"

/* Time between two steps, microseconds. */
#define ROBOT_TICK_US 50000u
/* Radius of the body, metres. */
#define ROBOT_RADIUS_M 0.12f

typedef struct {
    _Alignas(STAYA_ALIGN) unsigned char memory[STAYA_AGENT_SIZE];
    StayaAgent *agent;
    StayaInputs inputs;
    StayaOutputs outputs;
} Robot;

/* Initialises robot `number` (from 1, unique) with a goal in millimetres east and north. The robot must not be
 * moved in memory. */
StayaStatus robot_init(Robot *robot, uint32_t number, const int32_t goal_mm[2]);

/* Runs one step with position, velocity, time and the bytes received by radio. Then `robot_velocity` returns the
 * commanded velocity, and `robot->outputs.outbox` contains the bytes to send. */
StayaStatus robot_step(Robot *robot, const int32_t position_mm[2], const float velocity_mps[2], uint32_t now_us,
                       const uint8_t *heard, size_t heard_bytes);

/* Velocity until the next step, m/s east and north. */
void robot_velocity(const Robot *robot, float velocity_mps[2]);

#endif
