/* The test swarms on a host. */

#include "platform.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

void print_row(const char *name, const Hashes *hashes, uint32_t steps)
{
    printf("%s f32 %016" PRIx64 " %016" PRIx64 " %" PRIu32 "\n", name, hashes->commands, hashes->bytes, steps);
}

void fail(const char *why)
{
    fprintf(stderr, "%s\n", why);
    exit(1);
}

int main(void)
{
    return run_swarms();
}
