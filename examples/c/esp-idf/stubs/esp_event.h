#ifndef STUB_ESP_EVENT_H
#define STUB_ESP_EVENT_H
#include <stddef.h>
#include <stdint.h>
typedef int esp_err_t;
#define ESP_ERROR_CHECK(action) ((void)(action))
esp_err_t esp_event_loop_create_default(void);
#endif
