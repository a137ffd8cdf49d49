/* The functions that these tests need from the machine. */

#ifndef PLATFORM_H
#define PLATFORM_H

#include <stddef.h>
#include <stdint.h>

/* Prints `name f32 hash steps`. */
void print_row(const char *name, uint64_t hash, uint32_t steps);

/* Prints the reason and ends the program as failed. */
void fail(const char *why);

/* Runs the test swarms; returns 0 when they are complete. */
int run_swarms(void);

#endif
