/* Robots on a circle change places with the opposite ones: collision avoidance alone, on plain
   arrays, without agents and radio. C version of orca_circle.rs. How to compile it: docs/c.md. */

#include "staya.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define ROBOTS 24
#define RADIUS_M 0.25f
#define SPEED_MPS 1.0f
#define STEP_S 0.1f

static void must(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", staya_status_name(status), staya_status_text(status));
        exit(1);
    }
}

static float distance(const float a[3], const float b[3])
{
    return hypotf(a[0] - b[0], a[1] - b[1]);
}

int main(void)
{
    static uint64_t memory[ROBOTS][STAYA_AVOIDER_SIZE / 8];
    static float place[ROBOTS][3], goal[ROBOTS][3], velocity[ROBOTS][3], chosen[ROBOTS][3];
    StayaAvoider *avoider[ROBOTS];
    StayaSetup setup;
    must(staya_setup_defaults(&setup, 1, RADIUS_M, (int32_t)(STEP_S * 1e6f)));
    setup.speed_mps = SPEED_MPS;
    setup.seed = 1;
    must(staya_choose_layer(&setup, "orca"));
    must(staya_set(&setup, "horizon_s", 2.0f)); /* a crowd on a circle meets in its middle */
    for (int i = 0; i < ROBOTS; i++) {
        const float angle = 6.2831853f * (float)i / ROBOTS;
        must(staya_avoider_init(memory[i], sizeof memory[i], &setup, &avoider[i]));
        place[i][0] = 5.0f * cosf(angle);
        place[i][1] = 5.0f * sinf(angle);
        goal[i][0] = -place[i][0];
        goal[i][1] = -place[i][1];
    }
    float least_gap_m = FLT_MAX;
    int steps = 0;
    for (int arrived = 0; arrived < ROBOTS; steps++) {
        for (int i = 0; i < ROBOTS; i++) {
            StayaNearby nearby[ROBOTS];
            size_t count = 0;
            for (int j = 0; j < ROBOTS; j++) {
                if (j == i) {
                    continue;
                }
                StayaNearby *other = &nearby[count++];
                *other = (StayaNearby){.id = (uint32_t)j + 1, .radius_m = RADIUS_M, .gives_way = 1};
                for (int axis = 0; axis < 3; axis++) {
                    other->offset_m[axis] = place[j][axis] - place[i][axis];
                    other->velocity_mps[axis] = velocity[j][axis];
                }
                least_gap_m = fminf(least_gap_m, distance(place[i], place[j]) - 2.0f * RADIUS_M);
            }
            const StayaBody body = {
                .id = (uint32_t)i + 1,
                .velocity_mps = {velocity[i][0], velocity[i][1], 0.0f},
                .radius_m = RADIUS_M,
                .max_speed_mps = SPEED_MPS,
                .max_acceleration_mps2 = FLT_MAX, /* no inertia */
                .step_s = STEP_S,
            };
            /* The preferred velocity reaches the goal in one step; ORCA takes the nearest permitted one. */
            const float way_m[3] = {goal[i][0] - place[i][0], goal[i][1] - place[i][1], 0.0f};
            const float wish_mps[3] = {way_m[0] / STEP_S, way_m[1] / STEP_S, 0.0f};
            must(staya_avoider_velocity(avoider[i], &body, wish_mps, way_m, nearby, count, NULL, 0, chosen[i]));
        }
        /* All robots have decided; now all move. */
        arrived = 0;
        for (int i = 0; i < ROBOTS; i++) {
            for (int axis = 0; axis < 3; axis++) {
                velocity[i][axis] = chosen[i][axis];
                place[i][axis] += velocity[i][axis] * STEP_S;
            }
            arrived += distance(place[i], goal[i]) < 0.05f;
        }
        if (steps > 1000) {
            fprintf(stderr, "a robot never arrives\n");
            return 1;
        }
    }
    printf("all %d arrived after %.1f s\n", ROBOTS, (double)((float)steps * STEP_S));
    printf("the least gap between two of them was %.1f mm\n", (double)least_gap_m * 1000.0);
    return least_gap_m > 0.0f ? 0 : 1;
}
