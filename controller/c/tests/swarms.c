/* The test swarms of the plane and of space (hil/cases), driven through the C interface. The
   numbers must equal those of Rust, bit for bit. Prints a row for each, in the format of
   tests/golden/cases.txt without the digests of the agents. The same file runs on a host and on a
   part. */

#include "platform.h"
#include "staya.h"

#define MAX_ROBOTS 5
#define TICK_US 100000
#define SAID 144
#define INBOX 576

/* FNV-1a hashes of the present swarm. */
static Hashes hashes;

static void hash_bytes(uint64_t *hash, const void *bytes, size_t count)
{
    const uint8_t *from = (const uint8_t *)bytes;
    for (size_t i = 0; i < count; i++) {
        *hash = (*hash ^ from[i]) * UINT64_C(0x00000100000001B3);
    }
}

static void hash_word(uint64_t *hash, uint64_t word)
{
    hash_bytes(hash, &word, sizeof word); /* all supported machines are little-endian */
}

static void hash_outputs(const StayaOutputs *out)
{
    const uint8_t kind = out->command;
    hash_bytes(&hashes.commands, &kind, 1);
    if (kind == STAYA_COMMAND_VELOCITY) {
        for (int i = 0; i < 3; i++) {
            union { float number; uint32_t bits; } component = { out->velocity_mps[i] };
            hash_word(&hashes.commands, component.bits);
        }
    }
    hash_word(&hashes.commands, out->call_again_us);
    hash_bytes(&hashes.bytes, &out->received, sizeof out->received);
    hash_bytes(&hashes.bytes, &out->rejected, sizeof out->rejected);
    hash_bytes(&hashes.bytes, out->outbox, out->outbox_bytes);
}

/* A static obstacle in the world, millimetres. */
typedef struct Solid {
    uint8_t shape;
    int32_t a[3];
    int32_t b[2];
    int32_t size;
} Solid;

typedef struct Case {
    const char *name, *law, *layer;
    uint8_t robots, goals, solids, fades;
    uint16_t ticks;
    float max_speed_mps;
    const int32_t (*starts)[3];
    const int32_t (*targets)[3];
    Solid solid[2];
} Case;

static const int32_t PENTAGON[5][3] = {{1500, 0, 0}, {464, 1427, 0}, {-1214, 882, 0}, {-1214, -885, 0}, {464, -1420, 0}};
static const int32_t ACROSS[5][3] = {{-1500, 0, 0}, {-464, -1427, 0}, {1214, -882, 0}, {1214, 885, 0}, {-464, 1420, 0}};
static const int32_t ROOMS[4][3] = {{-1500, 0, 0}, {-2500, 300, 0}, {1500, 100, 0}, {2500, -300, 0}};
static const int32_t ROOMS_ACROSS[4][3] = {{2500, 300, 0}, {1500, 0, 0}, {-2500, -300, 0}, {-1500, 100, 0}};
static const int32_t SPHERE[5][3] = {
    {1500, 0, 1000}, {464, 1427, 1400}, {-1214, 882, 1800}, {-1214, -885, 1200}, {464, -1420, 1600}};
static const int32_t SPHERE_ACROSS[5][3] = {
    {-1500, 0, 1800}, {-464, -1427, 1400}, {1214, -882, 1000}, {1214, 885, 1600}, {-464, 1420, 1200}};
static const int32_t CROSSING[3][3] = {{-2000, 150, 0}, {2000, 900, 0}, {-300, -2000, 0}};
static const int32_t CROSSED[3][3] = {{2000, 100, 0}, {-2000, 1100, 0}, {400, 1300, 0}};
static const int32_t CROWD[5][3] = {{0, 0, 0}, {0, 700, 0}, {600, 300, 0}, {-500, -400, 0}, {700, -500, 0}};
static const int32_t REFERENCE[1][3] = {{1000, 0, 0}};
static const int32_t GOALS[2][3] = {{9000, 4000, 0}, {9000, -4000, 0}};

static const Case CASES[] = {
    {"orca_analytic", "waypoint", "orca", 5, 0, 0, 0, 400, 0.5f, PENTAGON, ACROSS, {{0}}},
    {"orca_template_2k", "waypoint", "template_2k", 5, 0, 0, 0, 400, 0.5f, PENTAGON, ACROSS, {{0}}},
    {"doorway", "waypoint", "orca", 4, 0, 2, 1, 400, 0.5f, ROOMS, ROOMS_ACROSS,
     {{STAYA_SHAPE_WALL, {0, -9000, 0}, {0, -250}, 0}, {STAYA_SHAPE_WALL, {0, 250, 0}, {0, 9000}, 0}}},
    {"fly", "waypoint", "fly", 5, 0, 2, 0, 400, 0.5f, SPHERE, SPHERE_ACROSS,
     {{STAYA_SHAPE_PLANE, {0, 0, 0}, {0, 0}, 0}, {STAYA_SHAPE_BALL, {0, 0, 1500}, {0, 0}, 200}}},
    {"push_out", "waypoint", "push_out", 3, 0, 2, 0, 400, 0.5f, CROSSING, CROSSED,
     {{STAYA_SHAPE_BALL, {0, 0, 0}, {0, 0}, 300}, {STAYA_SHAPE_WALL, {-3000, 1900, 0}, {3000, 1900}, 0}}},
    {"lattice", "lattice", "none", 5, 1, 1, 0, 400, 1.0f, CROWD, REFERENCE,
     {{STAYA_SHAPE_BALL, {6000, 900, 0}, {0, 0}, 500}, {0}}},
    {"goal_flock", "goal_flock", "push_out", 5, 2, 0, 0, 400, 1.0f, CROWD, GOALS, {{0}}},
    {"boids", "boids", "none", 5, 0, 0, 0, 400, 1.0f, CROWD, NULL, {{0}}},
};

/* A robot with its body, and the bytes that it sends. */
typedef struct Robot {
    StayaAgent *agent;
    int32_t position_mm[3];
    float velocity_mps[3];
    uint8_t said[SAID], next[SAID];
    size_t said_bytes, next_bytes;
} Robot;

static uint64_t memory[MAX_ROBOTS][STAYA_AGENT_SIZE / 8];
static Robot robots[MAX_ROBOTS];
static StayaSetup setup;
static StayaInputs inputs;
static StayaOutputs out;
static uint8_t inbox[INBOX];

static void must(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        fail(staya_status_name(status));
    }
}

static int is(const char *text, const char *other)
{
    while (*text != 0 && *text == *other) {
        text++;
        other++;
    }
    return *text == *other;
}

/* A value of a law or a layer. */
typedef struct Row {
    const char *kind, *name;
    float value;
} Row;

static const Row ROWS[] = {
    {"orca", "horizon_s", 2.0f}, {"template_2k", "horizon_s", 2.0f}, {"fly", "horizon_s", 2.0f},
    {"orca", "inflation_mps", 0.5f}, {"template_2k", "inflation_mps", 0.5f}, {"fly", "inflation_mps", 0.5f},
    {"orca", "inflation_m", 0.3f}, {"template_2k", "inflation_m", 0.3f}, {"fly", "inflation_m", 0.3f},
    {"lattice", "spacing_m", 1.0f}, {"lattice", "c1_alpha", 1.0f}, {"lattice", "c1_beta", 4.0f},
    {"lattice", "c1_gamma", 0.5f},
    {"goal_flock", "goal_flock.min_distance_m", 0.5f}, {"goal_flock", "tolerance_m", 1.0f},
    {"boids", "crowded_m", 0.3f}, {"boids", "closest_m", 30.0f}, {"boids", "max_turn", 0.05f},
    {"boids", "max_turn_away", 0.02f},
};

static void set_up(const Case *scene, uint32_t id)
{
    must(staya_setup_defaults(&setup, id, 0.15f, TICK_US));
    setup.seed = 11;
    setup.common_seed = 3;
    setup.latency_us = TICK_US; /* beacons are one step old */
    setup.speed_mps = is(scene->law, "goal_flock") ? 1.0f : 0.5f;
    setup.tolerance_m = 0.03f;
    must(staya_choose_law(&setup, scene->law));
    must(staya_choose_layer(&setup, scene->layer));
    for (size_t i = 0; i < sizeof ROWS / sizeof ROWS[0]; i++) {
        if (is(ROWS[i].kind, scene->law) || is(ROWS[i].kind, scene->layer)) {
            must(staya_set(&setup, ROWS[i].name, ROWS[i].value));
        }
    }
    if (is(scene->layer, "push_out")) {
        must(staya_set(&setup, "push_out.min_distance_m", is(scene->law, "goal_flock") ? 0.35f : 0.4f));
    }
}

static void start(const Case *scene)
{
    static const float WAYS[MAX_ROBOTS][2] = {{0.5f, 0.0f}, {0.4f, 0.3f}, {0.3f, -0.4f}, {0.0f, 0.5f}, {0.4f, -0.3f}};
    for (uint8_t i = 0; i < scene->robots; i++) {
        Robot *robot = &robots[i];
        set_up(scene, i + 1u);
        must(staya_init(memory[i], sizeof memory[i], &setup, &robot->agent));
        robot->said_bytes = robot->next_bytes = 0;
        for (int axis = 0; axis < 3; axis++) {
            robot->position_mm[axis] = scene->starts[i][axis];
            robot->velocity_mps[axis] = is(scene->law, "boids") && axis < 2 ? WAYS[i][axis] : 0.0f;
        }
        uint8_t goals = scene->goals;
        if (is(scene->law, "waypoint")) {
            goals = 1;
        }
        for (uint8_t goal = 0; goal < goals; goal++) {
            StayaWaypoint waypoint = {{0, 0, 0}, {0.0f, 0.0f, 0.0f}, 0};
            const int32_t *place = scene->targets[is(scene->law, "waypoint") ? i : goal];
            for (int axis = 0; axis < 3; axis++) {
                waypoint.position_mm[axis] = place[axis];
            }
            if (is(scene->law, "lattice")) {
                waypoint.velocity_mps[0] = 0.25f;
            }
            must(staya_assign_waypoint(robot->agent, goal, &waypoint));
        }
    }
}

static float metres(int32_t millimetres)
{
    return (float)millimetres / 1000.0f;
}

/* A solid as a robot sees it. */
static StayaObstacle seen(const Solid *solid, const int32_t from[3])
{
    StayaObstacle obstacle = {solid->shape, 0, 0, 0, 0, 0, 0};
    if (solid->shape == STAYA_SHAPE_PLANE) {
        obstacle.z_m = 1.0f;
        obstacle.size_m = metres(from[2] - solid->size);
        return obstacle;
    }
    obstacle.x_m = metres(solid->a[0] - from[0]);
    obstacle.y_m = metres(solid->a[1] - from[1]);
    if (solid->shape == STAYA_SHAPE_WALL) {
        obstacle.x2_m = metres(solid->b[0] - from[0]);
        obstacle.y2_m = metres(solid->b[1] - from[1]);
    } else {
        obstacle.z_m = metres(solid->a[2] - from[2]);
        obstacle.size_m = metres(solid->size);
    }
    return obstacle;
}

static void append(uint8_t *to, size_t *used, size_t room, const uint8_t *from, size_t count)
{
    if (count <= room - *used) {
        for (size_t i = 0; i < count; i++) {
            to[(*used)++] = from[i];
        }
    }
}

static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

#define GOLDEN UINT64_C(0x9E3779B97F4A7C15)

/* The controller's random numbers (controller/src/rand.rs) with the radio's seed of hil/cases. */
static uint64_t keyed(uint32_t purpose, uint32_t way, uint32_t tick)
{
    const uint64_t seed = mix(7 + GOLDEN);
    return mix((mix((seed ^ ((uint64_t)purpose << 32 | way)) + GOLDEN) ^ tick) + GOLDEN);
}

static int happens(uint64_t *random, uint32_t chance)
{
    *random += GOLDEN;
    return (uint32_t)(mix(*random) >> 32) < chance;
}

/* The radio: as many whole frames as fit; each ends with a zero byte. With `random`, one in 16 is
   lost; each draws four numbers there. */
static void append_frames(uint8_t *to, size_t *used, size_t room, const uint8_t *from, size_t count, uint64_t *random)
{
    size_t begin = 0;
    for (size_t i = 0; i < count; i++) {
        if (from[i] == 0) {
            const int is_lost = random != NULL && happens(random, UINT32_MAX >> 4);
            append(to, used, room, from + begin, is_lost ? 0 : i + 1 - begin);
            begin = i + 1;
            for (int other = 0; random != NULL && other < 3; other++) {
                happens(random, 0);
            }
        }
    }
}

static void step(const Case *scene, uint8_t own, uint32_t tick)
{
    StayaObstacle obstacles[2];
    Robot *robot = &robots[own];
    size_t heard = 0;
    for (uint8_t other = 0; other < scene->robots; other++) {
        const uint32_t way = (uint32_t)other << 8 | own;
        uint64_t link = keyed(0x66616465 /* "fade" */, way, tick / 20), random = keyed(0x63616972 /* "cair" */, way, tick);
        if (other != own && !(scene->fades && happens(&link, UINT32_MAX / 5))) {
            append_frames(inbox, &heard, INBOX, robots[other].said, robots[other].said_bytes,
                          scene->fades ? &random : NULL);
        }
    }
    for (uint8_t i = 0; i < scene->solids; i++) {
        obstacles[i] = seen(&scene->solid[i], robot->position_mm);
    }
    for (int axis = 0; axis < 3; axis++) {
        inputs.position_mm[axis] = robot->position_mm[axis];
        inputs.velocity_mps[axis] = robot->velocity_mps[axis];
    }
    inputs.now_us = tick * TICK_US;
    inputs.max_speed_mps = scene->max_speed_mps;
    inputs.obstacles = obstacles;
    inputs.obstacle_count = scene->solids;
    inputs.inbox = inbox;
    inputs.inbox_bytes = heard;
    must(staya_step(robot->agent, &inputs, &out));
    hash_outputs(&out);
    robot->next_bytes = 0;
    append_frames(robot->next, &robot->next_bytes, SAID, out.outbox, out.outbox_bytes, NULL);
    for (int axis = 0; axis < 3; axis++) {
        robot->velocity_mps[axis] = out.command == STAYA_COMMAND_VELOCITY ? out.velocity_mps[axis] : 0.0f;
    }
}

/* Moves all robots after all have decided. Returns whether all have arrived. */
static int move(const Case *scene)
{
    uint8_t arrived = 0;
    for (uint8_t i = 0; i < scene->robots; i++) {
        Robot *robot = &robots[i];
        const float step_s = 0.1f;
        float way_m[3];
        for (int axis = 0; axis < 3; axis++) {
            way_m[axis] = robot->velocity_mps[axis] * step_s;
        }
        must(staya_move(robot->position_mm, way_m));
        hash_bytes(&hashes.commands, robot->position_mm, sizeof robot->position_mm);
        for (size_t byte = 0; byte < robot->next_bytes; byte++) {
            robot->said[byte] = robot->next[byte];
        }
        robot->said_bytes = robot->next_bytes;
        uint8_t mode = 0;
        must(staya_mode(robot->agent, &mode));
        arrived += mode == STAYA_MODE_ARRIVED;
    }
    return arrived == scene->robots;
}

int run_swarms(void)
{
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        const Case *scene = &CASES[i];
        uint32_t steps = 0;
        int is_over = 0;
        hashes.commands = hashes.bytes = UINT64_C(0xCBF29CE484222325);
        start(scene);
        for (uint32_t tick = 0; tick < scene->ticks && !is_over; tick++) {
            for (uint8_t robot = 0; robot < scene->robots; robot++) {
                step(scene, robot, tick);
                steps++;
            }
            is_over = move(scene);
        }
        print_row(scene->name, &hashes, steps);
    }
    return 0;
}
