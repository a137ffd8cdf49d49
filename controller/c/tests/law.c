/* A robot alone with a law that is chosen by name: the law's rows, and the circle that it drives.
 * `cargo xtask law` writes law.inc, the lines of docs/laws.md. */

#include "staya.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { TICK_US = 100000, TICKS = 600, SHOWN = 100 };

static void must(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", staya_status_name(status), staya_status_text(status));
        exit(1);
    }
}

int main(void)
{
    static uint64_t memory[STAYA_AGENT_SIZE / 8];
    StayaSetup setup;
    StayaAgent *agent = NULL;
    must(staya_setup_defaults(&setup, 1, 0.2f, TICK_US));
#include "law.inc"
    unsigned rows = 0;
    StayaParameter row;
    while (staya_law_row(&setup, rows, &row) == STAYA_STATUS_OK) {
        rows++;
    }
    must(staya_init(memory, sizeof memory, &setup, &agent));
    StayaInputs inputs = {0};
    StayaOutputs outputs = {0};
    inputs.max_speed_mps = setup.speed_mps;
    double farthest_m = 0.0, nearest_m = 1e9, turned = 0.0;
    for (unsigned tick = 1; tick <= TICKS; tick++) {
        inputs.now_us = tick * TICK_US;
        must(staya_step(agent, &inputs, &outputs));
        double x_m = inputs.position_mm[0] / 1000.0, y_m = inputs.position_mm[1] / 1000.0;
        float way_m[3] = {0};
        for (int axis = 0; axis < 3; axis++) {
            inputs.velocity_mps[axis] = outputs.command == STAYA_COMMAND_VELOCITY ? outputs.velocity_mps[axis] : 0.0f;
            way_m[axis] = inputs.velocity_mps[axis] * 1e-6f * TICK_US;
        }
        must(staya_move(inputs.position_mm, way_m));
        if (tick > TICKS - SHOWN) {
            double distance_m = sqrt(x_m * x_m + y_m * y_m);
            nearest_m = fmin(nearest_m, distance_m);
            farthest_m = fmax(farthest_m, distance_m);
            turned += x_m * (double)way_m[1] - y_m * (double)way_m[0];
        }
    }
    StayaKind kind;
    must(staya_law(setup.law, &kind));
    if (farthest_m - nearest_m > 0.1) {
        printf("between %.2f and %.2f m\n", nearest_m, farthest_m);
        return 1;
    }
    printf("%s, %u rows: %.1f m, %s\n", kind.name, rows, farthest_m, turned < 0.0 ? "right" : "left");
    return 0;
}
