/* What the robot's loop asks of the board. board.c is to be filled in. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* The robot's number, each its own, and where it is to go; millimetres. */
#define BOARD_NUMBER 1u
#define BOARD_GOAL_X_MM 2000
#define BOARD_GOAL_Y_MM 1000

/* Clocks, pins, timers, the radio's serial line; a watchdog. */
void board_init(void);
/* Microseconds since the start; they may wrap. */
uint32_t board_clock_us(void);
/* Bytes that the radio has brought since the last call, at most `room`. */
size_t board_read(uint8_t *bytes, size_t room);
/* Sends bytes, or as many as there is room for; does not wait. */
void board_send(const uint8_t *bytes, size_t count);
/* Where the robot is, by its odometry, and how it moves: east, north. */
void board_state(int32_t position_mm[2], float velocity_mps[2]);
/* Moves so until it is told otherwise; m/s east, north. */
void board_drive(const float velocity_mps[2]);
/* Tells the watchdog that all is well. */
void board_pet(void);
/* What was wrong is in `text`: stops the motors and starts anew. */
_Noreturn void board_fail(const char *text);

#endif
