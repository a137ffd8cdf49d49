#include "robot.h"

StayaStatus robot_init(Robot *robot, uint32_t number, const int32_t goal_mm[2])
{
    StayaSetup setup;
    StayaStatus status = staya_setup_defaults(&setup, number, ROBOT_RADIUS_M, ROBOT_TICK_US);
    if (status != STAYA_STATUS_OK) {
        return status;
    }
    /* Settings that differ from the defaults; see docs/c.md in Staya's repository. */
    setup.speed_mps = 0.5f;
    setup.latency_us = ROBOT_TICK_US;
    status = staya_init(robot->memory, sizeof robot->memory, &setup, &robot->agent);
    if (status != STAYA_STATUS_OK) {
        return status;
    }
    robot->inputs = (StayaInputs){.max_speed_mps = setup.speed_mps};
    robot->outputs = (StayaOutputs){0};
    const StayaWaypoint goal = {.position_mm = {goal_mm[0], goal_mm[1], 0}};
    return staya_assign_waypoint(robot->agent, 0, &goal);
}

StayaStatus robot_step(Robot *robot, const int32_t position_mm[2], const float velocity_mps[2], uint32_t now_us,
                       const uint8_t *heard, size_t heard_bytes)
{
    for (int axis = 0; axis < 2; axis++) {
        robot->inputs.position_mm[axis] = position_mm[axis];
        robot->inputs.velocity_mps[axis] = velocity_mps[axis];
    }
    robot->inputs.now_us = now_us;
    robot->inputs.inbox = heard;
    robot->inputs.inbox_bytes = heard_bytes;
    return staya_step(robot->agent, &robot->inputs, &robot->outputs);
}

void robot_velocity(const Robot *robot, float velocity_mps[2])
{
    const int goes = robot->outputs.command == STAYA_COMMAND_VELOCITY;
    velocity_mps[0] = goes ? robot->outputs.velocity_mps[0] : 0.0f;
    velocity_mps[1] = goes ? robot->outputs.velocity_mps[1] : 0.0f;
}
