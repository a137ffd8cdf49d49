/* Ten robots on a circle, each with its goal on the opposite side. All robots receive a packet one tick after it
 * was sent. */

#include "robot.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROBOTS = 10, TICKS = 1200, FRAMES = 256 };

static const double CIRCLE_MM = 2000.0;

static void must(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", staya_status_name(status), staya_status_text(status));
        exit(1);
    }
}

int main(void)
{
    static Robot robots[ROBOTS];
    static int32_t places_mm[ROBOTS][3];
    static float velocities_mps[ROBOTS][2];
    static uint8_t said[ROBOTS][FRAMES];
    size_t said_bytes[ROBOTS] = {0};
    double least_m = INFINITY;
    for (int i = 0; i < ROBOTS; i++) {
        const double angle = 6.283185307179586 * i / ROBOTS;
        places_mm[i][0] = (int32_t)lround(CIRCLE_MM * cos(angle));
        places_mm[i][1] = (int32_t)lround(CIRCLE_MM * sin(angle));
        const int32_t opposite_mm[2] = {-places_mm[i][0], -places_mm[i][1]};
        must(robot_init(&robots[i], (uint32_t)i + 1, opposite_mm));
    }
    for (uint32_t tick = 0; tick < TICKS; tick++) {
        int arrived = 0;
        for (int i = 0; i < ROBOTS; i++) {
            uint8_t heard[ROBOTS * FRAMES];
            size_t bytes = 0;
            for (int other = 0; other < ROBOTS; other++) {
                if (other != i) {
                    memcpy(heard + bytes, said[other], said_bytes[other]);
                    bytes += said_bytes[other];
                }
            }
            must(robot_step(&robots[i], places_mm[i], velocities_mps[i], tick * ROBOT_TICK_US, heard, bytes));
            arrived += robots[i].outputs.mode == STAYA_MODE_ARRIVED;
        }
        for (int i = 0; i < ROBOTS; i++) {
            said_bytes[i] = robots[i].outputs.outbox_bytes;
            if (said_bytes[i] > FRAMES) {
                fprintf(stderr, "more than %d bytes to send\n", FRAMES);
                return 1;
            }
            memcpy(said[i], robots[i].outputs.outbox, said_bytes[i]);
            /* A body without inertia. */
            robot_velocity(&robots[i], velocities_mps[i]);
            const float way_m[3] = {velocities_mps[i][0] * 1e-6f * ROBOT_TICK_US, velocities_mps[i][1] * 1e-6f * ROBOT_TICK_US};
            must(staya_move(places_mm[i], way_m));
        }
        for (int i = 0; i < ROBOTS; i++) {
            for (int other = 0; other < i; other++) {
                const double x = places_mm[i][0] - places_mm[other][0], y = places_mm[i][1] - places_mm[other][1];
                least_m = fmin(least_m, hypot(x, y) / 1000.0);
            }
        }
        if (arrived == ROBOTS) {
            const double gap_m = least_m - 2 * (double)ROBOT_RADIUS_M;
            printf("all %d arrived after %.1f s, smallest gap %.3f m\n", ROBOTS, tick * ROBOT_TICK_US * 1e-6, gap_m);
            return gap_m >= 0.0 ? 0 : 1;
        }
    }
    fprintf(stderr, "the robots did not arrive in time\n");
    return 1;
}
