/* Declarations that the app needs, with the names and types of crazyflie-firmware, so that it
   compiles without the firmware. */
#ifndef STUB_FREERTOS_H
#define STUB_FREERTOS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
typedef uint32_t TickType_t;
typedef long BaseType_t;
typedef void *QueueHandle_t;
#define pdTRUE 1
#define M2T(milliseconds) ((TickType_t)(milliseconds))
#endif
