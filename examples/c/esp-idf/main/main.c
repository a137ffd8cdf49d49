/* Template of a robot on an ESP32-C6 or -C3: a decision every 100 ms, packets over ESP-NOW. Write
   `read_odometry` and `drive` for your robot. It has been compiled against stub declarations, but
   not run on a part. Steps: docs/c.md. */

#include "esp_event.h"
#include "esp_log.h"
#include "esp_netif.h"
#include "esp_now.h"
#include "esp_timer.h"
#include "esp_wifi.h"
#include "freertos/FreeRTOS.h"
#include "freertos/queue.h"
#include "freertos/task.h"
#include "nvs_flash.h"
#include "staya.h"

#define TICK_MS 100
#define FRAMES 16
#define FRAME_BYTES 64

typedef struct Frame {
    uint8_t size;
    uint8_t data[FRAME_BYTES];
} Frame;

static const char *const TAG = "staya";
static const uint8_t EVERYBODY[6] = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
static QueueHandle_t heard;
static uint64_t memory[STAYA_AGENT_SIZE / 8];
static StayaSetup setup;
static StayaInputs inputs;
static StayaOutputs out;
static uint8_t inbox[FRAMES * (FRAME_BYTES + 1)];

/* To be written: position and velocity in the world frame that all robots share. */
static void read_odometry(int32_t position_mm[3], float velocity_mps[3])
{
    (void)position_mm;
    (void)velocity_mps;
}

/* To be written: move with this velocity in the world frame until the next call. */
static void drive(const float velocity_mps[3])
{
    (void)velocity_mps;
}

static int is_well(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        ESP_LOGE(TAG, "%s: %s", staya_status_name(status), staya_status_text(status));
    }
    return status == STAYA_STATUS_OK;
}

/* Runs in Wi-Fi's task. If the queue is full, the packet is dropped. */
static void on_packet(const esp_now_recv_info_t *from, const uint8_t *data, int size)
{
    (void)from;
    Frame frame = {.size = (uint8_t)size};
    if (size > 0 && size <= FRAME_BYTES) {
        for (int i = 0; i < size; i++) {
            frame.data[i] = data[i];
        }
        xQueueSend(heard, &frame, 0);
    }
}

/* Each packet is a frame; in the inbox a zero byte ends each frame. */
static size_t fill_inbox(void)
{
    size_t used = 0;
    Frame frame;
    while (used + FRAME_BYTES + 1 <= sizeof inbox && xQueueReceive(heard, &frame, 0) == pdTRUE) {
        for (uint8_t i = 0; i < frame.size; i++) {
            inbox[used++] = frame.data[i];
        }
        inbox[used++] = 0;
    }
    return used;
}

static void send_outbox(void)
{
    size_t begin = 0;
    for (size_t i = 0; i < out.outbox_bytes; i++) {
        if (out.outbox[i] == 0) {
            esp_now_send(EVERYBODY, out.outbox + begin, i - begin);
            begin = i + 1;
        }
    }
}

static void start_radio(void)
{
    const wifi_init_config_t config = WIFI_INIT_CONFIG_DEFAULT();
    esp_now_peer_info_t peer = {.ifidx = WIFI_IF_STA};
    ESP_ERROR_CHECK(nvs_flash_init());
    ESP_ERROR_CHECK(esp_netif_init());
    ESP_ERROR_CHECK(esp_event_loop_create_default());
    ESP_ERROR_CHECK(esp_wifi_init(&config));
    ESP_ERROR_CHECK(esp_wifi_set_mode(WIFI_MODE_STA));
    ESP_ERROR_CHECK(esp_wifi_start());
    ESP_ERROR_CHECK(esp_now_init());
    for (int i = 0; i < 6; i++) {
        peer.peer_addr[i] = EVERYBODY[i];
    }
    ESP_ERROR_CHECK(esp_now_add_peer(&peer));
    ESP_ERROR_CHECK(esp_now_register_recv_cb(on_packet));
}

void app_main(void)
{
    StayaAgent *agent = NULL;
    const StayaWaypoint goal = {.position_mm = {2000, 0, 0}};
    static const float STAND[3];

    staya_setup_defaults(&setup, CONFIG_STAYA_ROBOT, 0.1f, TICK_MS * 1000);
    setup.boot = (uint8_t)esp_timer_get_time(); /* better: a boot counter in NVS */
    setup.latency_us = TICK_MS * 1000;
    if (!is_well(staya_init(memory, sizeof memory, &setup, &agent)) ||
        !is_well(staya_assign_waypoint(agent, 0, &goal))) {
        return;
    }
    heard = xQueueCreate(FRAMES, sizeof(Frame));
    start_radio();

    TickType_t last = xTaskGetTickCount();
    for (;;) {
        vTaskDelayUntil(&last, pdMS_TO_TICKS(TICK_MS));
        read_odometry(inputs.position_mm, inputs.velocity_mps);
        inputs.now_us = (uint32_t)esp_timer_get_time();
        inputs.max_speed_mps = setup.speed_mps;
        inputs.inbox = inbox;
        inputs.inbox_bytes = fill_inbox();
        if (!is_well(staya_step(agent, &inputs, &out))) {
            drive(STAND);
            return;
        }
        send_outbox();
        drive(out.command == STAYA_COMMAND_VELOCITY ? out.velocity_mps : STAND);
    }
}
