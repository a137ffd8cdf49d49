/* An app for the Crazyflie's firmware: Staya flies the copter to a waypoint and keeps it clear of the others, which it hears by
   peer-to-peer packets. A template: it has been compiled against declarations of what it calls, not flown. Steps: docs/c.md. */

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
/* Frames that wait for the next step. */
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

/* In the radio's task. What the queue has no room for is lost, as on the air. */
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

/* On the air a packet is a frame; in an inbox a zero byte ends each. */
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
    setpoint.velocity_body = false; /* Staya's velocities are of the world */
    setpoint.attitudeRate.yaw = 0.0f;
    commanderSetSetpoint(&setpoint, 3);
}

void appMain(void)
{
    static const char *const AXES[3] = {"x", "y", "z"}, *const SPEEDS[3] = {"vx", "vy", "vz"};
    logVarId_t place[3], speed[3];
    StayaAgent *agent = NULL;
    StayaWaypoint goal = {.position_mm = {1000, 0, 500}};
    /* Each copter has its own address: its last byte is the robot's number, 1 and up. */
    const uint32_t id = (uint32_t)(configblockGetRadioAddress() & 0xFF);

    for (int axis = 0; axis < 3; axis++) {
        place[axis] = logGetVarId("stateEstimate", AXES[axis]);
        speed[axis] = logGetVarId("stateEstimate", SPEEDS[axis]);
    }
    staya_setup_defaults(&setup, id, 0.12f, TICK_MS * 1000);
    setup.boot = (uint8_t)usecTimestamp(); /* drawn: the copter has no counter of its starts */
    setup.latency_us = TICK_MS * 1000;
    setup.max_acceleration_mps2 = 2.0f;
    setup.orca.growth_mps = setup.speed_mps;
    setup.orca.margin_m = 0.05f;
    if (!is_well(staya_init(memory, sizeof memory, &setup, &agent)) ||
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
        inputs.max_speed_mps = 1.0f;
        inputs.inbox = inbox;
        inputs.inbox_bytes = fill_inbox();
        if (!is_well(staya_step(agent, &inputs, &out))) {
            return; /* without setpoints the commander lands or levels the copter */
        }
        send_outbox();
        static const float STAND[3];
        fly(out.command == STAYA_COMMAND_VELOCITY ? out.velocity_mps : STAND);
    }
}
