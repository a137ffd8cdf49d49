/* The functions that these tests need from the machine. */

#ifndef PLATFORM_H
#define PLATFORM_H

#include <stddef.h>
#include <stdint.h>

/* Hashes of a swarm's commands and of its packets. */
typedef struct Hashes {
    uint64_t commands, bytes;
} Hashes;

/* Prints `name f32 commands bytes steps`. */
void print_row(const char *name, const Hashes *hashes, uint32_t steps);

/* Prints the reason and ends the program as failed. */
void fail(const char *why);

/* Runs the test swarms; returns 0 when they are complete. */
int run_swarms(void);

#endif
