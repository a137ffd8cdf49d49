void esp_log(const char *tag, const char *format, ...);
#define ESP_LOGE esp_log
