#ifndef STUB_ESP_WIFI_H
#define STUB_ESP_WIFI_H
#include "esp_event.h"
typedef struct { int magic; } wifi_init_config_t;
#define WIFI_INIT_CONFIG_DEFAULT() {0}
typedef enum { WIFI_IF_STA } wifi_interface_t;
typedef enum { WIFI_MODE_STA } wifi_mode_t;
esp_err_t esp_wifi_init(const wifi_init_config_t *config);
esp_err_t esp_wifi_set_mode(wifi_mode_t mode);
esp_err_t esp_wifi_start(void);
#endif
