/* What a program of these tests asks of the machine that it runs on. */

#ifndef PLATFORM_H
#define PLATFORM_H

#include <stddef.h>
#include <stdint.h>

/* Prints `name f32 hash steps`. */
void print_row(const char *name, uint64_t hash, uint32_t steps);

/* Prints why, and ends the program as failed. */
void fail(const char *why);

/* The canned swarms; 0 when they came to their end. */
int run_swarms(void);

#endif
