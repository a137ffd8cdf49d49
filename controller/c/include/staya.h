/* Staya's controller in C: swarm control that runs on the robot. Generated from controller/c/src;
 * docs/c.md has a tour.
 *
 * Conventions. SI units, with the unit in each name; times are microseconds of the robot's own
 * clock. World frame: x east, y north, z up. Every function returns a StayaStatus; two functions
 * give its name and text. Fields and arguments that select one of several choices are integers;
 * their enums are declared here.
 *
 * Checked by the library: null pointers, their alignment, the size of memory, the validity of
 * numbers, and that an agent exists where one is used. Required of the caller: a pointer that is
 * not null points to memory that holds what the function's types say (anything, even zeros, where
 * something is written); neither an interrupt nor another task uses this memory during the call;
 * arrays do not overlap memory that is written, except within the same argument.
 *
 * Functions do not allocate, call back, wait or panic, and have no state of their own: two robots
 * in one program are two agents.
 */

#ifndef STAYA_H
#define STAYA_H

#include <stddef.h>
#include <stdint.h>

#if defined(__cplusplus)
#define STAYA_STATIC_ASSERT(condition, text) static_assert(condition, text)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define STAYA_STATIC_ASSERT(condition, text) _Static_assert(condition, text)
#else
#define STAYA_STATIC_ASSERT(condition, text)
#endif


/**
 * Bytes that suffice for an agent in any build of the library, including its scratch memory.
 */
#define STAYA_AGENT_SIZE 10240

/**
 * Bytes that suffice for an agent if the library lacks the features `auth` and `grid`.
 */
#define STAYA_AGENT_SIZE_IN_PLANE 3584

/**
 * Alignment of the memory for agents and avoiders, bytes.
 */
#define STAYA_ALIGN 8

/**
 * Maximum number of waypoints of an agent.
 */
#define STAYA_WAYPOINTS 4

/**
 * Maximum length of a payload in bytes.
 */
#define STAYA_PAYLOAD 16

/**
 * Maximum number of neighbours of an agent.
 */
#define STAYA_NEIGHBORS 16

/**
 * Bytes that suffice for an avoider.
 */
#define STAYA_AVOIDER_SIZE 256

/**
 * Maximum number of robots that these behaviours consider: the nearest of all that are given.
 */
#define STAYA_NEARBY 16

/**
 * Maximum length of a message to one robot in bytes.
 */
#define STAYA_MESSAGE 12

/**
 * Maximum length of a message to all robots, and of an order, in bytes.
 */
#define STAYA_CONTENT 38

/**
 * Maximum number of received messages that wait for `staya_received`.
 */
#define STAYA_INBOX 4

/**
 * Maximum number of bytes that one step can send.
 */
#define STAYA_OUTBOX 256

/**
 * Maximum number of events that one step can report.
 */
#define STAYA_EVENTS 8

/**
 * Size of StayaOutputs in bytes, on every machine.
 */
#define STAYA_OUTPUTS_SIZE 444

/**
 * Number of values of a law in a setup.
 */
#define STAYA_LAW_VALUES 24

/**
 * Number of values of a safety layer in a setup.
 */
#define STAYA_LAYER_VALUES 12

/**
 * Length of a swarm's key in bytes.
 */
#define STAYA_KEY 32

/**
 * Size of a StayaSetup in bytes, on every machine.
 */
#define STAYA_SETUP_SIZE 416

/**
 * Largest `sight_cells`.
 */
#define STAYA_MAX_RADIUS 5

/**
 * Maximum number of entries in a formation's template.
 */
#define STAYA_TEMPLATE 8

/**
 * The result of a function. Unless it is `STAYA_STATUS_OK` nothing has changed, except that
 * `staya_init` then leaves no agent.
 */
enum StayaStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Success.
     */
    STAYA_STATUS_OK = 0,
    /**
     * A required pointer is null, or null with a length above 0.
     */
    STAYA_STATUS_NULL = 1,
    /**
     * A pointer is misaligned for its type; memory of agents and avoiders needs STAYA_ALIGN.
     */
    STAYA_STATUS_ALIGNMENT = 2,
    /**
     * The memory is too small: see STAYA_AGENT_SIZE and STAYA_AVOIDER_SIZE.
     */
    STAYA_STATUS_MEMORY_SIZE = 3,
    /**
     * This memory does not hold an agent or avoider: call `staya_init` or `staya_avoider_init`.
     */
    STAYA_STATUS_NOT_THERE = 4,
    /**
     * The structure was not filled by `staya_setup_defaults` of this version of the header.
     */
    STAYA_STATUS_VERSION = 5,
    /**
     * The robot's number is 0; numbers begin at 1.
     */
    STAYA_STATUS_NO_ROBOT = 6,
    /**
     * A number that must be above 0, or finite, is not.
     */
    STAYA_STATUS_NUMBER = 7,
    /**
     * A field that selects one of several choices has an invalid number.
     */
    STAYA_STATUS_CHOICE = 8,
    /**
     * The library was built without this feature.
     */
    STAYA_STATUS_NOT_BUILT = 9,
    /**
     * The guidance law does not support this order.
     */
    STAYA_STATUS_TASK = 10,
    /**
     * `sight_cells` is 0, or above STAYA_MAX_RADIUS.
     */
    STAYA_STATUS_SEARCH = 11,
    /**
     * There are more elements than fit.
     */
    STAYA_STATUS_TOO_MANY = 12,
    /**
     * The window has no width or no height, or a graph or a template is invalid.
     */
    STAYA_STATUS_SHAPE = 13,
    /**
     * The robot does not have this parameter, or the value is out of range or contradicts others.
     */
    STAYA_STATUS_PARAMETER = 14,
    /**
     * The name or number does not exist.
     */
    STAYA_STATUS_UNKNOWN = 15,
    /**
     * `staya_act` needs a `staya_hear` before.
     */
    STAYA_STATUS_NOT_HEARD = 16,
    /**
     * This build has no law or layer of this name, or the setup has chosen another one.
     */
    STAYA_STATUS_LAW = 17,
    /**
     * The chosen law and layer do not have this row; fields of the setup are not rows.
     */
    STAYA_STATUS_ROW = 18,
    /**
     * A row cannot have this value or word.
     */
    STAYA_STATUS_RANGE = 19,
    /**
     * A row without a default is not given: `staya_explain` names it.
     */
    STAYA_STATUS_NEEDED = 20,
    /**
     * Values or fields contradict each other: `staya_explain` says which.
     */
    STAYA_STATUS_CONTRADICTION = 21,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaStatus StayaStatus;
#else
typedef int32_t StayaStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The action that a law of your own decides on.
 */
enum StayaAction
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Stand without a goal: STAYA_MODE_IDLE.
     */
    STAYA_ACTION_IDLE = 0,
    /**
     * Stand.
     */
    STAYA_ACTION_STAY = 1,
    /**
     * Move with `velocity_mps`.
     */
    STAYA_ACTION_VELOCITY = 2,
    /**
     * Take the first of `moves` that leads into a free cell; only for moves from cell to cell.
     */
    STAYA_ACTION_MOVES = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaAction StayaAction;
#else
typedef uint8_t StayaAction;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How far a law of your own is with its task.
 */
enum StayaProgress
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It goes to its goal, or as its law without a goal says.
     */
    STAYA_PROGRESS_GOING = 0,
    /**
     * It is too far from its place in a formation, and goes there: STAYA_MODE_FORMING.
     */
    STAYA_PROGRESS_FORMING = 1,
    /**
     * It stands for the reason `wait`: STAYA_MODE_HOLD; beside its occupied goal
     * (STAYA_WAIT_GOAL_TAKEN) STAYA_MODE_ARRIVED.
     */
    STAYA_PROGRESS_WAITING = 2,
    /**
     * No route is open, and it stands: STAYA_MODE_HOLD.
     */
    STAYA_PROGRESS_STUCK = 3,
    /**
     * It is at its goal, and stands: STAYA_MODE_ARRIVED.
     */
    STAYA_PROGRESS_ARRIVED = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaProgress StayaProgress;
#else
typedef uint8_t StayaProgress;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Wire format; the same for all robots of a swarm.
 */
enum StayaWire
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The controller's own frames of at most 60 bytes, each followed by a zero byte.
     */
    STAYA_WIRE_POSTCARD = 0,
    /**
     * MAVLink 2 frames with Staya's dialect, `controller/mavlink/messages/staya.xml`.
     */
    STAYA_WIRE_MAVLINK = 1,
    /**
     * Like STAYA_WIRE_POSTCARD, with an authentication code (needs `key`) and replay protection.
     */
    STAYA_WIRE_SEALED = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaWire StayaWire;
#else
typedef uint8_t StayaWire;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The command to the body until the next step.
 */
enum StayaCommand
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Stop.
     */
    STAYA_COMMAND_HOLD = 0,
    /**
     * Take the first of `moves` whose cell is free and passable; stop if none is.
     */
    STAYA_COMMAND_MOVE = 1,
    /**
     * Move with `velocity_mps`.
     */
    STAYA_COMMAND_VELOCITY = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaCommand StayaCommand;
#else
typedef uint8_t StayaCommand;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The overall activity of a robot.
 */
enum StayaMode
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * No goal yet.
     */
    STAYA_MODE_IDLE = 0,
    /**
     * Taking its place in the formation.
     */
    STAYA_MODE_FORMING = 1,
    /**
     * Moving to its goal.
     */
    STAYA_MODE_CRUISE = 2,
    /**
     * Stopped, because another robot asked it to or because no route is open.
     */
    STAYA_MODE_HOLD = 3,
    /**
     * At its target.
     */
    STAYA_MODE_ARRIVED = 4,
    /**
     * Stopped, because own input is missing or wrong.
     */
    STAYA_MODE_FAULT = 5,
    /**
     * Not steered by its agent.
     */
    STAYA_MODE_PASSIVE = 6,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaMode StayaMode;
#else
typedef uint8_t StayaMode;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Why a robot with a goal does not get closer to it.
 */
enum StayaWait
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It does not wait.
     */
    STAYA_WAIT_NOTHING = 0,
    /**
     * Its leader or its followers have not arrived yet.
     */
    STAYA_WAIT_TEAM = 1,
    /**
     * Another robot asked it to stop.
     */
    STAYA_WAIT_STOPPED = 2,
    /**
     * Only land or walls block its route.
     */
    STAYA_WAIT_ROUTE = 3,
    /**
     * It does not know where others are, since it does not receive them.
     */
    STAYA_WAIT_RADIO = 4,
    /**
     * Others go first through a narrow place, such as a door.
     */
    STAYA_WAIT_TURN = 5,
    /**
     * Other robots are in its way.
     */
    STAYA_WAIT_ROBOTS = 6,
    /**
     * Another robot occupies its goal; it has arrived beside it.
     */
    STAYA_WAIT_GOAL_TAKEN = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaWait StayaWait;
#else
typedef uint8_t StayaWait;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A move from a cell: compass directions, as in `moves` and `heading`.
 */
enum StayaDir
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * (1, 0)
     */
    STAYA_DIR_EAST = 0,
    /**
     * (1, 1)
     */
    STAYA_DIR_NORTH_EAST = 1,
    /**
     * (0, 1)
     */
    STAYA_DIR_NORTH = 2,
    /**
     * (-1, 1)
     */
    STAYA_DIR_NORTH_WEST = 3,
    /**
     * (-1, 0)
     */
    STAYA_DIR_WEST = 4,
    /**
     * (-1, -1)
     */
    STAYA_DIR_SOUTH_WEST = 5,
    /**
     * (0, -1)
     */
    STAYA_DIR_SOUTH = 6,
    /**
     * (1, -1)
     */
    STAYA_DIR_SOUTH_EAST = 7,
    /**
     * (0, 0)
     */
    STAYA_DIR_STAY = 8,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaDir StayaDir;
#else
typedef uint8_t StayaDir;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * An event in a step.
 */
enum StayaEventKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The robot's mode changed: `before`, `after` (StayaMode).
     */
    STAYA_EVENT_KIND_MODE_CHANGED = 0,
    /**
     * No exit of the window can be reached.
     */
    STAYA_EVENT_KIND_NO_ROUTE = 1,
    /**
     * The target lay in an impassable cell and was moved: `before_xy`, `after_xy`.
     */
    STAYA_EVENT_KIND_TARGET_MOVED = 2,
    /**
     * `robot` did not acknowledge a message of the law in time.
     */
    STAYA_EVENT_KIND_MESSAGE_EXPIRED = 3,
    /**
     * `robot` became known.
     */
    STAYA_EVENT_KIND_NEIGHBOR_FOUND = 4,
    /**
     * `robot` was silent for too long.
     */
    STAYA_EVENT_KIND_NEIGHBOR_LOST = 5,
    /**
     * The table was full and `robot` was dropped from it.
     */
    STAYA_EVENT_KIND_NEIGHBOR_EVICTED = 6,
    /**
     * `robot` has restarted.
     */
    STAYA_EVENT_KIND_NEIGHBOR_REBOOTED = 7,
    /**
     * No robot is received any more.
     */
    STAYA_EVENT_KIND_CONTACT_LOST = 8,
    /**
     * Two robots have the number `robot`.
     */
    STAYA_EVENT_KIND_DUPLICATE_ID = 9,
    /**
     * A beacon of `robot` is implausible; `after`: 0 number, 1 radius, 2 speed, 3 position.
     */
    STAYA_EVENT_KIND_IMPLAUSIBLE = 10,
    /**
     * The robot stopped sending: its counters are used up, and it needs a new key.
     */
    STAYA_EVENT_KIND_MUTED = 11,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaEventKind StayaEventKind;
#else
typedef uint8_t StayaEventKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The shape of a static obstacle.
 */
enum StayaShape
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * A vertical wall without thickness from (`x_m`, `y_m`) to (`x2_m`, `y2_m`).
     */
    STAYA_SHAPE_WALL = 0,
    /**
     * A ball, in the plane a disc, around (`x_m`, `y_m`, `z_m`) with the radius `size_m`.
     */
    STAYA_SHAPE_BALL = 1,
    /**
     * A half-space: everything behind a plane. Its normal (`x_m`, `y_m`, `z_m`) has length 1 and
     * points away from the obstacle; the robot is `size_m` in front of it.
     */
    STAYA_SHAPE_PLANE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaShape StayaShape;
#else
typedef uint8_t StayaShape;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The controller of one robot. Its contents are private to the library.
 */
typedef struct StayaAgent StayaAgent;

/**
 * The safety layer of one robot. Its contents are private to the library.
 */
typedef struct StayaAvoider StayaAvoider;

/**
 * A cell of the grid, or the difference of two.
 */
typedef struct StayaCell {
    /**
     * To the east.
     */
    int16_t x;
    /**
     * To the north.
     */
    int16_t y;
} StayaCell;

/**
 * The place of a neighbour in the formation.
 */
typedef struct StayaPlace {
    /**
     * The neighbour's number; 0 for any robot.
     */
    uint32_t robot;
    /**
     * Its cell minus that of this robot.
     */
    struct StayaCell offset;
    /**
     * Its distance in edges of the formation's graph; 1 or more.
     */
    uint8_t hops;
} StayaPlace;

/**
 * The place of a robot in a formation, as `staya_formation_from_graph` fills it in.
 */
typedef struct StayaFormation {
    /**
     * The neighbours, `neighbor_count` of them.
     */
    struct StayaPlace neighbors[STAYA_TEMPLATE];
    /**
     * Length of `neighbors`.
     */
    uint8_t neighbor_count;
    /**
     * The robot's place: 0 for the top leader.
     */
    uint8_t slot;
    /**
     * The place's cell minus the top leader's.
     */
    struct StayaCell offset;
} StayaFormation;

/**
 * The configuration of a robot. Fill it with `staya_setup_defaults`, change fields, and choose law
 * and layer by `staya_choose_law` and `staya_choose_layer`, with values by `staya_set`.
 */
typedef struct StayaSetup {
    /**
     * Written by `staya_setup_defaults`; shows that header and library have the same version.
     */
    uint32_t version;
    /**
     * The robot's number from 1, unique in the swarm (MAVLink: up to 254; with a key: below 2^21).
     */
    uint32_t id;
    /**
     * Seed of its random decisions, together with its number.
     */
    uint64_t seed;
    /**
     * Seed of draws that all robots make alike, as of the goals of a flock: the same in all.
     */
    uint64_t common_seed;
    /**
     * Time from one step to the next, microseconds, which the caller must keep; on the grid the
     * time for a cell of impassability 1.
     */
    int32_t tick_us;
    /**
     * Time between two beacons, microseconds.
     */
    int32_t beacon_period_us;
    /**
     * Age of a beacon when it arrives, microseconds: neighbours are extrapolated by this time.
     */
    int32_t latency_us;
    /**
     * Beacons older than this are stale, microseconds: use a few beacon periods.
     */
    int32_t stale_after_us;
    /**
     * A robot that is silent for longer is lost, microseconds; at most half an hour.
     */
    int32_t lost_after_us;
    /**
     * Silence after which a lost robot counts as standing even if most robots are lost,
     * microseconds; at most ten minutes.
     */
    int32_t stands_after_us;
    /**
     * How long the robot stands and listens after its start, microseconds.
     */
    int32_t listen_us;
    /**
     * How long a message of a law across land in cells is resent at most, and how long a stop
     * lasts unless it is renewed, microseconds.
     */
    int32_t message_valid_us;
    /**
     * Time between two attempts of a message, microseconds.
     */
    int32_t retry_interval_us;
    /**
     * Number of attempts of a message.
     */
    uint8_t retry_attempts;
    /**
     * Beacons of other robots of the formation that it relays behind each of its own, 0 to 3, for
     * those that distance or land hides from each other.
     */
    uint8_t relays;
    /**
     * Must change with each start (a stored counter or random), or others take it for a replay.
     */
    uint8_t boot;
    /**
     * The robot's flock; robots of other flocks are only obstacles.
     */
    uint8_t flock;
    /**
     * Private to the library: see `staya_choose_law`.
     */
    uint8_t law;
    /**
     * Private to the library: see `staya_choose_layer`.
     */
    uint8_t layer;
    /**
     * StayaWire.
     */
    uint8_t wire;
    /**
     * Above 0: a robot that has not heard another one stands.
     */
    uint8_t expects_others;
    /**
     * With the law "external": the protocol of its payloads and messages, 64 to 255.
     */
    uint8_t protocol;
    /**
     * Other than 0: the body moves from cell to cell; commands are moves, `speed_mps` is ignored.
     */
    uint8_t on_grid;
    /**
     * Over cells: sight in each direction, 1 to STAYA_MAX_RADIUS.
     */
    uint8_t sight_cells;
    /**
     * Over cells, other than 0: a diagonal move is as long as a straight one.
     */
    uint8_t diagonals_count_as_one;
    /**
     * Over cells, other than 0: diagonal moves may pass a blocked corner.
     */
    uint8_t cuts_corners;
    /**
     * Radius of the ball around the body, metres.
     */
    float radius_m;
    /**
     * Cruising speed, m/s; limited by that of the body.
     */
    float speed_mps;
    /**
     * Highest speed of the body, m/s; 0: `speed_mps`.
     */
    float max_speed_mps;
    /**
     * Highest speed of any robot, m/s; 0: that of the body.
     */
    float fastest_mps;
    /**
     * Distance within which its waypoint counts as reached, metres.
     */
    float tolerance_m;
    /**
     * How fast the body can change its velocity, m/s^2; FLT_MAX: at once.
     */
    float max_acceleration_mps2;
    /**
     * Time constant with which the body follows a velocity command, seconds; 0: at once.
     */
    float lag_s;
    /**
     * Speed if all other robots are lost, m/s. 0: it stops until it receives a beacon; above 0:
     * only for robots that may be alone.
     */
    float alone_mps;
    /**
     * Distance within which the radio works when nothing disturbs it, metres; 0: unknown.
     */
    float reach_m;
    /**
     * Largest radius accepted in a beacon, metres; FLT_MAX: any.
     */
    float plausibility_max_radius_m;
    /**
     * Highest speed accepted in a beacon, m/s; FLT_MAX: any, and positions are not checked.
     */
    float plausibility_max_speed_mps;
    /**
     * Additional tolerance between two positions of a robot, metres.
     */
    float plausibility_slack_m;
    /**
     * How long a robot that has jumped must send consistent positions, microseconds.
     */
    int32_t plausibility_settle_us;
    /**
     * The greatest number of any robot.
     */
    uint32_t plausibility_last_id;
    /**
     * Private to the library: values of the law; NaN: not given.
     */
    float law_values[STAYA_LAW_VALUES];
    /**
     * Private to the library: values of the layer; NaN: not given.
     */
    float layer_values[STAYA_LAYER_VALUES];
    /**
     * The robot's place in a formation.
     */
    struct StayaFormation formation;
    /**
     * With STAYA_WIRE_SEALED: its count of starts, in persistent memory from 0; below 2^20.
     */
    uint32_t starts;
    /**
     * With STAYA_WIRE_SEALED: the swarm's secret. The agent keeps a copy.
     */
    uint8_t key[STAYA_KEY];
} StayaSetup;

/**
 * A static obstacle, relative to the robot's position, metres.
 */
typedef struct StayaObstacle {
    /**
     * StayaShape.
     */
    uint32_t shape;
    /**
     * A wall's first end, a ball's centre, a plane's normal.
     */
    float x_m;
    /**
     * See `x_m`.
     */
    float y_m;
    /**
     * See `x_m`.
     */
    float z_m;
    /**
     * A wall's second end.
     */
    float x2_m;
    /**
     * See `x2_m`.
     */
    float y2_m;
    /**
     * A ball's radius, or how far the robot is in front of a plane.
     */
    float size_m;
} StayaObstacle;

/**
 * The input of a step. All zeros: stationary at the origin, with nothing seen or received.
 *
 * Robots with velocities as commands need `max_speed_mps`. Robots that cross land in cells need
 * `cell` and `window`; with velocities as commands also `in_cell_x_m`, `in_cell_y_m` and `cell_m`.
 * The other fields are then ignored. With the law "external" a `window` puts the robot into cells,
 * and `cell_m` above 0 lets it move by velocities there.
 */
typedef struct StayaInputs {
    /**
     * Position in the world: east, north, up from an origin that all robots share, millimetres.
     */
    int32_t position_mm[3];
    /**
     * The robot's velocity in the world, m/s.
     */
    float velocity_mps[3];
    /**
     * The robot's clock, microseconds; it wraps after 71.6 minutes.
     */
    uint32_t now_us;
    /**
     * Highest possible speed in this place, m/s; with 0 the robot stops in STAYA_MODE_FAULT.
     */
    float max_speed_mps;
    /**
     * The robot's cell.
     */
    struct StayaCell cell;
    /**
     * Time until it may leave its cell, microseconds; only for moves from cell to cell.
     */
    int32_t busy_us;
    /**
     * Its position in its cell, metres from the cell's centre.
     */
    float in_cell_x_m;
    /**
     * See `in_cell_x_m`.
     */
    float in_cell_y_m;
    /**
     * Side of a cell, metres.
     */
    float cell_m;
    /**
     * South-west cell of the visible land.
     */
    struct StayaCell window_origin;
    /**
     * Cells from west to east.
     */
    uint16_t window_width;
    /**
     * Cells from south to north.
     */
    uint16_t window_height;
    /**
     * How hard each cell is to cross, row by row from the south-west: 1 easy, 255 hard, 0
     * impassable; width * height bytes. Null: the robot sees no land, and is in STAYA_MODE_FAULT.
     */
    const uint8_t *window;
    /**
     * Obstacles, `obstacle_count` of them, at most 32 (16 if the library was built small).
     */
    const struct StayaObstacle *obstacles;
    /**
     * Length of `obstacles`.
     */
    size_t obstacle_count;
    /**
     * `inbox_bytes` bytes from the radio since the last step, in order, with damaged frames.
     */
    const uint8_t *inbox;
    /**
     * Length of `inbox`.
     */
    size_t inbox_bytes;
} StayaInputs;

/**
 * An event.
 */
typedef struct StayaEvent {
    /**
     * The robot concerned; 0 for none.
     */
    uint32_t robot;
    /**
     * The previous cell.
     */
    struct StayaCell before_xy;
    /**
     * The present cell.
     */
    struct StayaCell after_xy;
    /**
     * StayaEventKind, which defines the fields that are used.
     */
    uint8_t kind;
    /**
     * The previous number.
     */
    uint8_t before;
    /**
     * The present number.
     */
    uint8_t after;
} StayaEvent;

/**
 * The output of a step.
 */
typedef struct StayaOutputs {
    /**
     * World velocity until the next step, m/s; with STAYA_COMMAND_VELOCITY.
     */
    float velocity_mps[3];
    /**
     * When to call again unless bytes arrive before: the robot's clock, microseconds.
     */
    uint32_t call_again_us;
    /**
     * The leader that it follows; 0 if there is none.
     */
    uint32_t leader;
    /**
     * The cell that it is heading for; with `has_target`.
     */
    struct StayaCell target;
    /**
     * Frames accepted: intact, not received before, from another robot.
     */
    uint16_t received;
    /**
     * Frames rejected: damaged, repeated, not authentic.
     */
    uint16_t rejected;
    /**
     * Of those: without a code.
     */
    uint16_t refused_unsigned;
    /**
     * Of those: with a code that does not match the key or the content.
     */
    uint16_t refused_forged;
    /**
     * Of those: replayed, or with a counter too far ahead.
     */
    uint16_t refused_replayed;
    /**
     * Of those: from senders that do not fit into the table.
     */
    uint16_t refused_no_room;
    /**
     * Beacons with a number beyond `plausibility_last_id`.
     */
    uint16_t implausible_numbers;
    /**
     * Beacons with too large a radius.
     */
    uint16_t implausible_radii;
    /**
     * Beacons with too high a speed.
     */
    uint16_t implausible_speeds;
    /**
     * Beacons with a position that the robot cannot have reached yet.
     */
    uint16_t implausible_places;
    /**
     * Length of `outbox`.
     */
    uint16_t outbox_bytes;
    /**
     * StayaCommand.
     */
    uint8_t command;
    /**
     * Moves to try in this order (StayaDir), `move_count` of them; with STAYA_COMMAND_MOVE.
     */
    uint8_t moves[8];
    /**
     * Length of `moves`.
     */
    uint8_t move_count;
    /**
     * Its activity: StayaMode.
     */
    uint8_t mode;
    /**
     * Why it waits: StayaWait.
     */
    uint8_t wait;
    /**
     * Whether it has a goal, and so a `target`.
     */
    uint8_t has_target;
    /**
     * Length of `events`.
     */
    uint8_t event_count;
    /**
     * The events; the oldest ones if there are more.
     */
    struct StayaEvent events[STAYA_EVENTS];
    /**
     * Bytes for the radio, `outbox_bytes` of them.
     */
    uint8_t outbox[STAYA_OUTBOX];
} StayaOutputs;

/**
 * A destination, which may move.
 */
typedef struct StayaWaypoint {
    /**
     * Its position at `at_us`, millimetres.
     */
    int32_t position_mm[3];
    /**
     * Its velocity since then, m/s.
     */
    float velocity_mps[3];
    /**
     * Time of the position on the robot's clock, microseconds.
     */
    uint32_t at_us;
} StayaWaypoint;

/**
 * A robot as of its last beacon.
 */
typedef struct StayaNeighbor {
    /**
     * Its number; from 2^31 on a second robot with the number reduced by 2^31.
     */
    uint32_t id;
    /**
     * Reception time on the own clock, microseconds.
     */
    uint32_t heard_us;
    /**
     * Its position at that time, millimetres.
     */
    int32_t position_mm[3];
    /**
     * Its velocity at that time, m/s.
     */
    float velocity_mps[3];
    /**
     * Radius of the ball around its body, metres.
     */
    float radius_m;
    /**
     * The number of its leader; 0 if it has none. Only robots that cross land in cells tell
     * `leader`, `cell`, `target`, `slot` and `heading`. For other robots they are 0 and
     * STAYA_DIR_STAY.
     */
    uint32_t leader;
    /**
     * The cell that it was in.
     */
    struct StayaCell cell;
    /**
     * The cell that it was heading for.
     */
    struct StayaCell target;
    /**
     * Its place in the formation.
     */
    uint8_t slot;
    /**
     * The number of its flock.
     */
    uint8_t flock;
    /**
     * Its activity: StayaMode.
     */
    uint8_t mode;
    /**
     * The move that it wanted to make next: StayaDir.
     */
    uint8_t heading;
    /**
     * Other than 0: silent for too long; only its last position still counts.
     */
    uint8_t is_lost;
    /**
     * The protocol of its law: 64 to 255 are those of users, 0 is none.
     */
    uint8_t protocol;
    /**
     * Length of `payload`.
     */
    uint8_t payload_count;
    /**
     * The payload of its law, `payload_count` bytes: the bytes of `staya_set_payload`.
     */
    uint8_t payload[STAYA_PAYLOAD];
} StayaNeighbor;

/**
 * The body of this robot. One that follows commands with a lag gives the point ahead of it, at its
 * velocity times the lag, as its position, and its last command as its velocity.
 */
typedef struct StayaBody {
    /**
     * Its number, 1 or more. If two robots are in one place, it decides which way each goes.
     */
    uint32_t id;
    /**
     * Its velocity, m/s.
     */
    float velocity_mps[3];
    /**
     * Radius of the ball around it, metres.
     */
    float radius_m;
    /**
     * Its highest possible speed in its present place, m/s.
     */
    float max_speed_mps;
    /**
     * How fast it can change its velocity, m/s^2; FLT_MAX: at once.
     */
    float max_acceleration_mps2;
    /**
     * Time from one decision to the next, seconds; more than 0.
     */
    float step_s;
} StayaBody;

/**
 * The present state of another robot.
 */
typedef struct StayaNearby {
    /**
     * Its number.
     */
    uint32_t id;
    /**
     * Its position minus that of this robot, metres.
     */
    float offset_m[3];
    /**
     * Its velocity, m/s.
     */
    float velocity_mps[3];
    /**
     * Radius of the ball around it, metres.
     */
    float radius_m;
    /**
     * 0: it does not give way, and this robot makes the whole correction.
     */
    uint8_t gives_way;
    /**
     * Other than 0: it has arrived and stays (STAYA_MODE_ARRIVED), so others do not wait for it.
     */
    uint8_t is_parked;
    /**
     * Other than 0: it belongs to another flock, and is only an obstacle.
     */
    uint8_t is_stranger;
} StayaNearby;

/**
 * The point that a flock follows, as a robot sees it.
 */
typedef struct StayaReference {
    /**
     * Its position minus that of this robot, metres.
     */
    float offset_m[3];
    /**
     * Its velocity, m/s.
     */
    float velocity_mps[3];
} StayaReference;

/**
 * Why `staya_init` refuses the law or the layer of a setup. Texts end with a zero, and are empty
 * if no row is to blame.
 */
typedef struct StayaFault {
    /**
     * StayaStatus; STAYA_STATUS_OK: the setup has no such fault.
     */
    int32_t status;
    /**
     * The row to change, as `staya_set` takes it, or the field of StayaSetup.
     */
    char row[36];
    /**
     * The fault in a few words.
     */
    char what[96];
    /**
     * How to correct it.
     */
    char remedy[96];
    /**
     * The least value that is accepted, if that is the remedy; otherwise NaN.
     */
    float least;
} StayaFault;

/**
 * A law or a safety layer. Texts end with a zero.
 */
typedef struct StayaKind {
    /**
     * The name for `staya_choose_law` or `staya_choose_layer`.
     */
    char name[20];
    /**
     * A description in a sentence.
     */
    char text[108];
} StayaKind;

/**
 * A parameter of a running robot, or a row of a setup's law or layer. Texts end with a zero.
 */
typedef struct StayaParameter {
    /**
     * The name, such as "speed_mps".
     */
    char name[20];
    /**
     * The unit; empty for a plain number.
     */
    char unit[20];
    /**
     * A description in a few words.
     */
    char text[64];
    /**
     * If the row is a choice: the words for 0, 1, ..., separated by blanks.
     */
    char words[64];
    /**
     * The least value.
     */
    float least;
    /**
     * The greatest value.
     */
    float greatest;
    /**
     * The present value.
     */
    float value;
} StayaParameter;

/**
 * The decision of a law of your own. All zeros: idle.
 */
typedef struct StayaDecision {
    /**
     * With STAYA_ACTION_VELOCITY: the preferred velocity, m/s; the safety layer may change it.
     */
    float velocity_mps[3];
    /**
     * With `has_way`: the vector to the point that the robot heads for, metres.
     */
    float way_m[3];
    /**
     * StayaAction.
     */
    uint8_t kind;
    /**
     * Other than 0: the robot heads straight for a point, and may turn aside to let others pass.
     */
    uint8_t has_way;
    /**
     * StayaProgress; does not count with STAYA_ACTION_IDLE.
     */
    uint8_t progress;
    /**
     * With STAYA_PROGRESS_WAITING, and only then: StayaWait.
     */
    uint8_t wait;
    /**
     * Other than 0: the robot carries out the action although it has arrived or waits.
     */
    uint8_t makes_way;
    /**
     * Length of `moves`, at most 8.
     */
    uint8_t move_count;
    /**
     * With STAYA_ACTION_MOVES: the moves (StayaDir), best first.
     */
    uint8_t moves[8];
} StayaDecision;

/**
 * A message or an order that the robot received.
 */
typedef struct StayaMessage {
    /**
     * The sender's number; 0 for an order.
     */
    uint32_t from;
    /**
     * Messages and orders that the robot has dropped so far, because others waited.
     */
    uint16_t dropped;
    /**
     * Other than 0: an order of the operator.
     */
    uint8_t is_order;
    /**
     * Length of `bytes`.
     */
    uint8_t count;
    /**
     * The content, `count` bytes.
     */
    uint8_t bytes[STAYA_CONTENT];
} StayaMessage;

/**
 * Two neighbouring places of a formation, by their indices.
 */
typedef struct StayaEdge {
    /**
     * One of them.
     */
    uint16_t a;
    /**
     * The other one.
     */
    uint16_t b;
} StayaEdge;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The library's version, such as "0.1.0".
 */
const char *staya_version(void);

/**
 * Size of an agent of this build in bytes: at most STAYA_AGENT_SIZE.
 */
size_t staya_agent_bytes(void);

/**
 * Creates an idle agent in the caller's memory and points `*agent` to it; null if the setup is
 * rejected. The agent lives as long as the memory, must not be moved, and need not be destroyed.
 * Temporarily needs some kilobytes of stack (docs/c.md).
 */
StayaStatus staya_init(void *memory,
                       size_t memory_bytes,
                       const struct StayaSetup *setup,
                       struct StayaAgent **agent);

/**
 * Runs one step: receive, decide, send. Call it once per `tick_us` with the robot's present clock
 * and state. Bounded work. If the inputs are rejected, the agent and `outputs` are unchanged.
 */
StayaStatus staya_step(struct StayaAgent *agent,
                       const struct StayaInputs *inputs,
                       struct StayaOutputs *outputs);

/**
 * Gives the robot the waypoint number `index`, below STAYA_WAYPOINTS. For the laws of the plane
 * except boids. The goal flock uses several waypoints, the other laws only number 0.
 */
StayaStatus staya_assign_waypoint(struct StayaAgent *agent,
                                  uint8_t index,
                                  const struct StayaWaypoint *waypoint);

/**
 * Gives the robot a target cell, for laws on land in cells. A formation only needs its leader's.
 */
StayaStatus staya_assign_cell(struct StayaAgent *agent, int16_t x, int16_t y);

/**
 * Returns the robot's activity: StayaMode.
 */
StayaStatus staya_mode(const struct StayaAgent *agent, uint8_t *mode);

/**
 * Returns the first `room` neighbours in ascending order of their numbers, and in `*count` the
 * number of all. A room of `STAYA_NEIGHBORS` always suffices.
 */
StayaStatus staya_neighbors(const struct StayaAgent *agent,
                            struct StayaNeighbor *neighbors,
                            size_t neighbor_room,
                            size_t *count);

/**
 * A hash of the agent's whole state. Agents with equal hashes behave identically on any machine.
 */
StayaStatus staya_digest(const struct StayaAgent *agent, uint64_t *digest);

/**
 * Moves a position by a vector in metres (odometry), rounded to millimetres, saturating.
 */
StayaStatus staya_move(int32_t position_mm[3], const float way_m[3]);

/**
 * Creates the safety layer that a setup has chosen, for one robot, in the caller's memory:
 * STAYA_AVOIDER_SIZE bytes aligned to STAYA_ALIGN. The setup's `seed` draws random tie-breaks;
 * robots may share it.
 */
StayaStatus staya_avoider_init(void *memory,
                               size_t memory_bytes,
                               const struct StayaSetup *setup,
                               struct StayaAvoider **avoider);

/**
 * Returns the velocity to take until the next step, m/s: the one nearest to `wish_mps` that robots
 * and obstacles permit. Call it once per `step_s`, always for the same robot.
 *
 * `way_m` is the vector to the goal, metres, or null; near the goal the robot does not turn aside.
 * Only the nearest STAYA_NEARBY robots count. A layer in the plane ignores heights and keeps that
 * of the wish.
 */
StayaStatus staya_avoider_velocity(struct StayaAvoider *avoider,
                                   const struct StayaBody *body,
                                   const float wish_mps[3],
                                   const float way_m[3],
                                   const struct StayaNearby *nearby,
                                   size_t nearby_count,
                                   const struct StayaObstacle *obstacles,
                                   size_t obstacle_count,
                                   float velocity_mps[3]);

/**
 * Returns the acceleration in an alpha flock, m/s^2, not limited by the body. The setup has chosen
 * the law "lattice". `reference` may be null.
 */
StayaStatus staya_lattice_acceleration(const struct StayaSetup *setup,
                                       const struct StayaBody *body,
                                       const struct StayaNearby *nearby,
                                       size_t nearby_count,
                                       const struct StayaObstacle *obstacles,
                                       size_t obstacle_count,
                                       const struct StayaReference *reference,
                                       float acceleration_mps2[3]);

/**
 * Returns the preferred velocity of a robot in a goal flock, m/s. The setup has chosen the law
 * "goal_flock". `goal_mm` may be null.
 */
StayaStatus staya_goal_flock_wish(const struct StayaSetup *setup,
                                  const struct StayaBody *body,
                                  const int32_t own_mm[3],
                                  const int32_t goal_mm[3],
                                  const struct StayaNearby *nearby,
                                  size_t nearby_count,
                                  float wish_mps[3]);

/**
 * Turns a boid's heading, a unit vector, to its value one step later. The setup has chosen the law
 * "boids".
 */
StayaStatus staya_boids_steer(const struct StayaSetup *setup,
                              uint32_t id,
                              const struct StayaNearby *nearby,
                              size_t nearby_count,
                              float heading[2]);

/**
 * Chooses the law of a robot by its name (`staya_law` lists all), with its defaults.
 * `STAYA_STATUS_LAW` if this build does not have it.
 */
StayaStatus staya_choose_law(struct StayaSetup *setup, const char *name);

/**
 * Chooses the safety layer of a robot by its name (`staya_layer` lists all), with its defaults.
 * `STAYA_STATUS_LAW` if this build does not have it.
 */
StayaStatus staya_choose_layer(struct StayaSetup *setup, const char *name);

/**
 * Sets a value of the chosen law and layer by the name of its row (`staya_law_row`,
 * `staya_layer_row`). If both have the row, "SECTION.ROW" sets that of one, with its section in
 * scenario files. Rows that count or choose take the nearest whole number. `STAYA_STATUS_ROW` if
 * neither has it, `STAYA_STATUS_RANGE` if it cannot have the value; `staya_init` checks whether
 * values go together.
 */
StayaStatus staya_set(struct StayaSetup *setup, const char *row, float value);

/**
 * Like `staya_set`, for a row whose values are words, such as "true" and "false".
 */
StayaStatus staya_set_word(struct StayaSetup *setup, const char *row, const char *word);

/**
 * Says why `staya_init` refuses the law or the layer of a setup.
 */
StayaStatus staya_explain(const struct StayaSetup *setup, struct StayaFault *fault);

/**
 * Writes law 0, 1, 2 and so on of this build; `STAYA_STATUS_UNKNOWN` beyond the last one.
 */
StayaStatus staya_law(uint32_t index, struct StayaKind *law);

/**
 * Writes safety layer 0, 1, 2 and so on of this build; `STAYA_STATUS_UNKNOWN` beyond the last one.
 */
StayaStatus staya_layer(uint32_t index, struct StayaKind *layer);

/**
 * Writes row 0, 1, 2 and so on of the chosen law with its present value; NaN: it depends on other
 * values, or must be given. `STAYA_STATUS_UNKNOWN` beyond the last one.
 */
StayaStatus staya_law_row(const struct StayaSetup *setup, uint32_t index, struct StayaParameter *row);

/**
 * Writes row 0, 1, 2 and so on of the chosen layer, as `staya_law_row` does.
 */
StayaStatus staya_layer_row(const struct StayaSetup *setup, uint32_t index, struct StayaParameter *row);

/**
 * The first half of a step: receives. `staya_neighbors` and `staya_received` then tell a law of
 * your own what it needs for `staya_decide`. `staya_step` is both halves, for a decision that was
 * made before. Bounded work; rejected inputs change nothing.
 */
StayaStatus staya_hear(struct StayaAgent *agent, const struct StayaInputs *inputs);

/**
 * The second half of a step, with the inputs of `staya_hear`, of which it does not read the inbox:
 * decides, avoids, sends. `STAYA_STATUS_NOT_HEARD` without a `staya_hear` since the last step.
 * Bounded work; rejected inputs change nothing.
 */
StayaStatus staya_act(struct StayaAgent *agent,
                      const struct StayaInputs *inputs,
                      struct StayaOutputs *outputs);

/**
 * Decides for the next step; before the first decision the robot is idle. A decision counts once:
 * if it is not renewed, the robot stays, so a law that hangs stops its robot. An idle robot
 * remains idle. A velocity needs `max_speed_mps`, moves need a `window` and no `cell_m`; without
 * them the robot is in STAYA_MODE_FAULT. `STAYA_STATUS_NUMBER`, `_CHOICE` or `_TOO_MANY` for an
 * invalid decision, which changes nothing. This function and those below do constant work and
 * return `STAYA_STATUS_TASK` if the agent's law is another one.
 */
StayaStatus staya_decide(struct StayaAgent *agent, const struct StayaDecision *decision);

/**
 * Sets the payload of each beacon from the next one on: the state of the law that others may know,
 * since beacons get lost. `STAYA_STATUS_TOO_MANY` above STAYA_PAYLOAD bytes.
 */
StayaStatus staya_set_payload(struct StayaAgent *agent, const uint8_t *bytes, size_t count);

/**
 * Sends a message to robot `to` in the next step: at most STAYA_MESSAGE bytes, resent until it is
 * acknowledged, for `valid_us` at most, then STAYA_EVENT_KIND_MESSAGE_EXPIRED. A newer message to
 * the robot replaces it; those to more than four robots at a time are lost. `to` 0: to all, at
 * most STAYA_CONTENT bytes, once, if it fits into the frames of the step. `STAYA_STATUS_TOO_MANY`
 * for too many bytes, or if one message to all or four others wait for the step;
 * `STAYA_STATUS_NUMBER` if `valid_us` is not above 0 and `to` is.
 */
StayaStatus staya_send(struct StayaAgent *agent,
                       uint32_t to,
                       const uint8_t *bytes,
                       size_t count,
                       int32_t valid_us);

/**
 * Takes out the oldest received messages and orders with the protocol of the law, `message_room`
 * at most, and returns their number in `*count`. STAYA_INBOX wait at most; another one replaces
 * the oldest.
 */
StayaStatus staya_received(struct StayaAgent *agent,
                           struct StayaMessage *messages,
                           size_t message_room,
                           size_t *count);

/**
 * Writes parameter 0, 1, 2 and so on of an agent; `STAYA_STATUS_UNKNOWN` beyond the last one.
 */
StayaStatus staya_parameter(struct StayaAgent *agent, uint32_t index, struct StayaParameter *parameter);

/**
 * Returns the present value of a parameter; `STAYA_STATUS_PARAMETER` if the robot lacks it.
 */
StayaStatus staya_get_parameter(struct StayaAgent *agent, const char *name, float *value);

/**
 * Changes a parameter, such as "speed_mps", from the next step on. `STAYA_STATUS_PARAMETER`, and
 * no change, if the robot lacks it, or the value is out of range or contradicts other parameters.
 */
StayaStatus staya_set_parameter(struct StayaAgent *agent, const char *name, float value);

/**
 * Fills a setup for robot `id` with defaults: the law "waypoint" at 0.5 m/s behind the layer
 * "orca", a beacon each step, no inertia, no latency. `radius_m` is that of the ball around the
 * body, `tick_us` the time between two steps. `staya_init` checks them.
 */
StayaStatus staya_setup_defaults(struct StayaSetup *setup, uint32_t id, float radius_m, int32_t tick_us);

/**
 * Fills in the place number `own` of a formation, given the cells of all places in any common
 * frame, the top leader's first, and the edges of its graph. Robots within `hops` edges become
 * neighbours; the robot at place i has the number i + 1. `STAYA_STATUS_SHAPE` for a place or edge
 * that does not exist, `STAYA_STATUS_TOO_MANY` above STAYA_TEMPLATE neighbours.
 */
StayaStatus staya_formation_from_graph(struct StayaFormation *formation,
                                       const struct StayaCell *places,
                                       size_t place_count,
                                       const struct StayaEdge *edges,
                                       size_t edge_count,
                                       size_t own,
                                       uint8_t hops);

/**
 * The name of a status, such as "STAYA_STATUS_NULL". Never null.
 */
const char *staya_status_name(int32_t status);

/**
 * The meaning of a status and its remedy, in one line. Never null.
 */
const char *staya_status_text(int32_t status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* STAYA_H */

/* The library's layout: no packed structures, IEEE 754. */
STAYA_STATIC_ASSERT(sizeof(StayaSetup) == STAYA_SETUP_SIZE, "StayaSetup is laid out otherwise than in the library");
STAYA_STATIC_ASSERT(sizeof(StayaOutputs) == STAYA_OUTPUTS_SIZE, "StayaOutputs is laid out otherwise than in the library");
STAYA_STATIC_ASSERT(sizeof(float) == 4, "float is not IEEE 754 single precision");
