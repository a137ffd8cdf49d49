/* The board as seen by the robot's loop. Complete it in board.c. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* Number of the robot, unique, and its goal, millimetres. */
#define BOARD_NUMBER 1u
#define BOARD_GOAL_X_MM 2000
#define BOARD_GOAL_Y_MM 1000

/* Sets up clocks, pins, timers, the radio's serial line and a watchdog. */
void board_init(void);
/* Microseconds since the start; may wrap. */
uint32_t board_clock_us(void);
/* Bytes received by radio since the last call, at most `room`. */
size_t board_read(uint8_t *bytes, size_t room);
/* Sends bytes without waiting; drops those that do not fit into the buffer. */
void board_send(const uint8_t *bytes, size_t count);
/* Position and velocity of the robot by its odometry: east, north. */
void board_state(int32_t position_mm[2], float velocity_mps[2]);
/* Sets the velocity until the next call; m/s east, north. */
void board_drive(const float velocity_mps[2]);
/* Resets the watchdog. */
void board_pet(void);
/* Stops the motors and restarts; `text` is the reason. */
_Noreturn void board_fail(const char *text);

#endif
