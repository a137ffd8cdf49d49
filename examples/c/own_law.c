/* A law of your own: robots drive east at the pace of the slowest one, which they know from payloads.
   The first one at the end tells the others to halt. How to compile it: docs/c.md. */

#include "staya.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROBOTS 3
#define TICK_US 50000
#define PROTOCOL 77 /* of this law: 64 to 255 */

typedef struct Robot {
    StayaAgent *agent;
    StayaInputs inputs;
    uint8_t own_cmps, pace_cmps, has_halted;
} Robot;

static void must(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", staya_status_name(status), staya_status_text(status));
        exit(1);
    }
}

/* The law. It runs between the halves of a step. */
static void decide(Robot *robot)
{
    StayaMessage messages[STAYA_INBOX];
    StayaNeighbor others[STAYA_NEIGHBORS];
    size_t count, message_count;
    must(staya_received(robot->agent, messages, STAYA_INBOX, &message_count));
    must(staya_neighbors(robot->agent, others, STAYA_NEIGHBORS, &count));
    const int is_first = !robot->has_halted && robot->inputs.position_mm[0] >= 2000;
    robot->has_halted |= is_first || message_count > 0; /* there is only one message */
    robot->pace_cmps = robot->own_cmps;
    for (size_t i = 0; i < count; i++) {
        const int is_peer = others[i].protocol == PROTOCOL && others[i].payload_count == 1;
        const uint8_t pace_cmps = is_peer ? others[i].payload[0] : robot->pace_cmps;
        robot->pace_cmps = pace_cmps < robot->pace_cmps ? pace_cmps : robot->pace_cmps;
        if (is_peer && is_first) {
            const uint8_t halt = 1;
            must(staya_send(robot->agent, others[i].id, &halt, 1, 1000000)); /* resent until it arrives */
        }
    }
    const uint8_t progress = robot->has_halted ? STAYA_PROGRESS_ARRIVED : STAYA_PROGRESS_GOING;
    StayaDecision decision = {.kind = STAYA_ACTION_VELOCITY, .progress = progress};
    decision.velocity_mps[0] = (float)robot->pace_cmps / 100.0f;
    must(staya_set_payload(robot->agent, &robot->own_cmps, 1));
    must(staya_decide(robot->agent, &decision));
}

int main(void)
{
    static uint64_t memory[ROBOTS][STAYA_AGENT_SIZE / 8];
    static Robot robots[ROBOTS] = {{.own_cmps = 40}, {.own_cmps = 25}, {.own_cmps = 35}};
    static StayaOutputs out;
    static uint8_t air[2 * ROBOTS * STAYA_OUTBOX]; /* the packets of this step and of the one before */
    size_t before = 0;
    int halted = 0, tick = 0;
    for (uint32_t i = 0; i < ROBOTS; i++) {
        StayaSetup setup;
        must(staya_setup_defaults(&setup, i + 1, 0.1f, TICK_US));
        must(staya_choose_law(&setup, "external"));
        setup.protocol = PROTOCOL;
        must(staya_init(memory[i], sizeof memory[i], &setup, &robots[i].agent));
        robots[i].inputs = (StayaInputs){.position_mm = {600 * (int32_t)i}, .max_speed_mps = 0.5f, .inbox = air};
    }
    for (; halted < ROBOTS && tick < 1000; tick++) {
        size_t after = 0;
        halted = 0;
        for (Robot *robot = robots; robot < robots + ROBOTS; robot++) {
            StayaInputs *inputs = &robot->inputs;
            inputs->now_us = (uint32_t)tick * TICK_US;
            inputs->inbox_bytes = before;
            must(staya_hear(robot->agent, inputs));
            decide(robot);
            must(staya_act(robot->agent, inputs, &out));
            memcpy(air + before + after, out.outbox, out.outbox_bytes);
            after += out.outbox_bytes;
            const float way_m[3] = {out.velocity_mps[0] * TICK_US * 1e-6f, 0.0f, 0.0f};
            must(staya_move(inputs->position_mm, way_m)); /* the body follows at once */
            halted += robot->has_halted;
        }
        memmove(air, air + before, after);
        before = after;
    }
    printf("%d robots halted after %.1f s at %d cm/s\n", halted, tick * TICK_US * 1e-6, robots[0].pace_cmps);
    return halted == ROBOTS && robots[0].pace_cmps == 25 ? 0 : 1;
}
