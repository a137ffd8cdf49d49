/* Template of an app for the Crazyflie's firmware: the copter flies to a waypoint and avoids other
   copters, whose beacons arrive as peer-to-peer packets. It has been compiled against stub
   declarations, but not flown. Steps: docs/c.md. */

#include "FreeRTOS.h"
#include "app.h"
#include "commander.h"
#include "configblock.h"
#include "debug.h"
#include "log.h"
#include "queue.h"
#include "radiolink.h"
#include "staya.h"
#include "stabilizer_types.h"
#include "task.h"
#include "usec_time.h"

#define TICK_MS 100
#define HEIGHT_M 0.5f
#define MAX_SPEED_MPS 1.0f
/* Capacity of the queue of frames for the next step. */
#define FRAMES 16

typedef struct Frame {
    uint8_t size;
    uint8_t data[P2P_MAX_DATA_SIZE];
} Frame;

static QueueHandle_t heard;
static uint64_t memory[STAYA_AGENT_SIZE / 8];
static StayaSetup setup;
static StayaInputs inputs;
static StayaOutputs out;
static uint8_t inbox[FRAMES * (P2P_MAX_DATA_SIZE + 1)];

static int is_well(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        DEBUG_PRINT("%s: %s\n", staya_status_name(status), staya_status_text(status));
    }
    return status == STAYA_STATUS_OK;
}

/* Runs in the radio's task. If the queue is full, the packet is dropped. */
static void on_packet(P2PPacket *packet)
{
    Frame frame = {.size = packet->size};
    if (packet->size <= sizeof frame.data) {
        for (uint8_t i = 0; i < packet->size; i++) {
            frame.data[i] = packet->data[i];
        }
        xQueueSend(heard, &frame, 0);
    }
}

/* Each packet is a frame; in the inbox a zero byte ends each frame. */
static size_t fill_inbox(void)
{
    size_t used = 0;
    Frame frame;
    while (used + P2P_MAX_DATA_SIZE + 1 <= sizeof inbox && xQueueReceive(heard, &frame, 0) == pdTRUE) {
        for (uint8_t i = 0; i < frame.size; i++) {
            inbox[used++] = frame.data[i];
        }
        inbox[used++] = 0;
    }
    return used;
}

static void send_outbox(void)
{
    P2PPacket packet = {.port = 0};
    uint8_t size = 0;
    for (uint16_t i = 0; i < out.outbox_bytes; i++) {
        if (out.outbox[i] != 0 && size < sizeof packet.data) {
            packet.data[size++] = out.outbox[i];
        } else if (out.outbox[i] == 0) {
            packet.size = size;
            size = 0;
            radiolinkSendP2PPacketBroadcast(&packet);
        }
    }
}

static void fly(const float velocity_mps[3])
{
    static setpoint_t setpoint;
    setpoint.mode.x = modeVelocity;
    setpoint.mode.y = modeVelocity;
    setpoint.mode.z = modeAbs;
    setpoint.mode.yaw = modeVelocity;
    setpoint.velocity.x = velocity_mps[0];
    setpoint.velocity.y = velocity_mps[1];
    setpoint.position.z = HEIGHT_M;
    setpoint.velocity_body = false; /* Staya's velocities are in the world frame */
    setpoint.attitudeRate.yaw = 0.0f;
    commanderSetSetpoint(&setpoint, 3);
}

void appMain(void)
{
    static const char *const AXES[3] = {"x", "y", "z"}, *const SPEEDS[3] = {"vx", "vy", "vz"};
    logVarId_t place[3], speed[3];
    StayaAgent *agent = NULL;
    StayaWaypoint goal = {.position_mm = {1000, 0, 500}};
    /* The last byte of the copter's unique radio address is its robot id, 1 or more. */
    const uint32_t id = (uint32_t)(configblockGetRadioAddress() & 0xFF);

    for (int axis = 0; axis < 3; axis++) {
        place[axis] = logGetVarId("stateEstimate", AXES[axis]);
        speed[axis] = logGetVarId("stateEstimate", SPEEDS[axis]);
    }
    staya_setup_defaults(&setup, id, 0.12f, TICK_MS * 1000);
    setup.boot = (uint8_t)usecTimestamp(); /* random: the copter has no boot counter */
    setup.latency_us = TICK_MS * 1000;
    setup.max_acceleration_mps2 = 2.0f;
    setup.lag_s = 0.2f; /* measured: time until 63 % of a commanded change of velocity */
    setup.max_speed_mps = MAX_SPEED_MPS;
    if (!is_well(staya_set(&setup, "margin_m", 0.05f)) ||
        !is_well(staya_init(memory, sizeof memory, &setup, &agent)) ||
        !is_well(staya_assign_waypoint(agent, 0, &goal))) {
        return;
    }
    heard = xQueueCreate(FRAMES, sizeof(Frame));
    p2pRegisterCB(on_packet);

    TickType_t last = xTaskGetTickCount();
    for (;;) {
        vTaskDelayUntil(&last, M2T(TICK_MS));
        for (int axis = 0; axis < 3; axis++) {
            inputs.position_mm[axis] = (int32_t)(logGetFloat(place[axis]) * 1000.0f);
            inputs.velocity_mps[axis] = logGetFloat(speed[axis]);
        }
        inputs.now_us = (uint32_t)usecTimestamp();
        inputs.max_speed_mps = MAX_SPEED_MPS;
        inputs.inbox = inbox;
        inputs.inbox_bytes = fill_inbox();
        if (!is_well(staya_step(agent, &inputs, &out))) {
            return; /* without setpoints, the commander lands or levels the copter */
        }
        send_outbox();
        static const float STAND[3];
        fly(out.command == STAYA_COMMAND_VELOCITY ? out.velocity_mps : STAND);
    }
}
