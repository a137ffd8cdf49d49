/* Declarations of what the program calls, to compile it where ESP-IDF is not: names and types as in ESP-IDF 5. */
#ifndef STUB_FREERTOS_H
#define STUB_FREERTOS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
typedef uint32_t TickType_t;
typedef int BaseType_t;
typedef void *QueueHandle_t;
#define pdTRUE 1
#define pdMS_TO_TICKS(milliseconds) ((TickType_t)(milliseconds))
#define CONFIG_STAYA_ROBOT 1
#endif
