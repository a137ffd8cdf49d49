/* Declarations that the program needs, with the names and types of ESP-IDF 5, so that it compiles
   without ESP-IDF. */
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
