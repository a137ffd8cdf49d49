/* The robot of my-swarm: what is the same on this computer and on the part. */
#ifndef ROBOT_H
#define ROBOT_H

#include "staya.h"

/* From one step to the next, microseconds. */
#define ROBOT_TICK_US 50000u
/* Radius of the body, metres. */
#define ROBOT_RADIUS_M 0.12f

typedef struct {
    _Alignas(STAYA_ALIGN) unsigned char memory[STAYA_AGENT_SIZE];
    StayaAgent *agent;
    StayaInputs inputs;
    StayaOutputs outputs;
} Robot;

/* Makes robot `number` (1 or more, each its own), which is to go to a place; millimetres east and north. The robot must stay where it
 * is in memory. */
StayaStatus robot_init(Robot *robot, uint32_t number, const int32_t goal_mm[2]);

/* One step: where it is and how it moves, the clock, and the bytes that the radio has brought. Afterwards `robot_velocity` is how to
 * move, and `robot->outputs.outbox` what to send. */
StayaStatus robot_step(Robot *robot, const int32_t position_mm[2], const float velocity_mps[2], uint32_t now_us,
                       const uint8_t *heard, size_t heard_bytes);

/* How to move until the next step, m/s east and north. */
void robot_velocity(const Robot *robot, float velocity_mps[2]);

#endif
