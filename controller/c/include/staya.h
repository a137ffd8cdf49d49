/* Staya's controller in C: swarm control that runs on the robot. Generated from controller/c/src; docs/c.md has a tour.
 *
 * Conventions. SI units, the unit in each name; times are microseconds of the robot's own clock. World frame: x east, y north, z up.
 * Every function answers with a StayaStatus, whose name and text there are functions for. Fields and arguments that name one of
 * several are integers, and their enums stand here.
 *
 * What is checked: null pointers, their alignment, the size of memory, every number that must be sound, and that an agent was made
 * where one is used. What is up to you: pointers that are not null lead to memory of yours that holds what the function's types say
 * (anything, even zeros, where something is written); nobody else, neither an interrupt nor another task, uses it during the call;
 * arrays do not overlap what is written, but for the same argument.
 *
 * No function allocates, calls back, waits or panics, and none has state of its own: two robots in one program are two agents.
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
 * Bytes that are enough for an agent of any build of the library, its scratch memory included.
 */
#define STAYA_AGENT_SIZE 10240

/**
 * Bytes that are enough for one of a library without the features `auth` and `grid`.
 */
#define STAYA_AGENT_SIZE_IN_PLANE 3328

/**
 * How memory for agents and avoiders must be aligned, bytes.
 */
#define STAYA_ALIGN 8

/**
 * Waypoints that an agent has room for.
 */
#define STAYA_WAYPOINTS 4

/**
 * Neighbours that an agent knows at most.
 */
#define STAYA_NEIGHBORS 16

/**
 * Bytes that are enough for an avoider.
 */
#define STAYA_ORCA_SIZE 256

/**
 * Robots that a behaviour by itself takes into account: the nearest of all that it is told of.
 */
#define STAYA_NEARBY 16

/**
 * Bytes that one step can send.
 */
#define STAYA_OUTBOX 256

/**
 * Events that one step can report.
 */
#define STAYA_EVENTS 8

/**
 * Bytes of StayaOutputs, on every machine.
 */
#define STAYA_OUTPUTS_SIZE 444

/**
 * Bytes of a swarm's key.
 */
#define STAYA_KEY 32

/**
 * Bytes of a StayaSetup, on every machine.
 */
#define STAYA_SETUP_SIZE 400

/**
 * Entries of a formation's template.
 */
#define STAYA_TEMPLATE 8

/**
 * Largest radius of a search over a window, cells.
 */
#define STAYA_MAX_RADIUS 5

/**
 * What a function answers. Nothing has changed unless it is `STAYA_STATUS_OK`, but for `staya_init`, which then leaves no agent.
 */
enum StayaStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It is done.
     */
    STAYA_STATUS_OK = 0,
    /**
     * A pointer that is needed is null, or is null with a length above 0.
     */
    STAYA_STATUS_NULL = 1,
    /**
     * A pointer is not aligned as its type asks; memory for agents and avoiders: by STAYA_ALIGN.
     */
    STAYA_STATUS_ALIGNMENT = 2,
    /**
     * The memory is too small: see STAYA_AGENT_SIZE and STAYA_ORCA_SIZE.
     */
    STAYA_STATUS_MEMORY_SIZE = 3,
    /**
     * There is no agent, or no avoider, in this memory: call `staya_init`, or `staya_orca_init`.
     */
    STAYA_STATUS_NOT_THERE = 4,
    /**
     * The structure was not filled by `staya_setup_defaults` of this version of the header.
     */
    STAYA_STATUS_VERSION = 5,
    /**
     * The robot's number is 0, which is nobody.
     */
    STAYA_STATUS_NOBODY = 6,
    /**
     * A number that must be above 0, or finite, is not.
     */
    STAYA_STATUS_NUMBER = 7,
    /**
     * A field that names one of several has another number.
     */
    STAYA_STATUS_CHOICE = 8,
    /**
     * The library was built without it: see its features.
     */
    STAYA_STATUS_NOT_BUILT = 9,
    /**
     * The guidance law has no use for this task.
     */
    STAYA_STATUS_TASK = 10,
    /**
     * The radius of the search is above STAYA_MAX_RADIUS.
     */
    STAYA_STATUS_SEARCH = 11,
    /**
     * More of them than there is room for.
     */
    STAYA_STATUS_TOO_MANY = 12,
    /**
     * The window has no width or no height, or a graph or a template makes no sense.
     */
    STAYA_STATUS_SHAPE = 13,
    /**
     * The robot has no such parameter, or the value is out of its range, or does not go with the others.
     */
    STAYA_STATUS_PARAMETER = 14,
    /**
     * There is no such name or number.
     */
    STAYA_STATUS_UNKNOWN = 15,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaStatus StayaStatus;
#else
typedef int32_t StayaStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How a robot goes: its guidance law.
 */
enum StayaLaw
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Straight to its waypoint, `speed_mps`, until it is within `tolerance_m`.
     */
    STAYA_LAW_WAYPOINT = 0,
    /**
     * The alpha flock (R. Olfati-Saber 2006): equal distances, and waypoint 0, if there is one, as its reference.
     */
    STAYA_LAW_LATTICE = 1,
    /**
     * The goal flock (V. E. and V. V. Pavlovsky): to the middle of the waypoints together, then each to one of them.
     */
    STAYA_LAW_GOAL_FLOCK = 2,
    /**
     * Boids (V. A. Starovoitova 2018): constant speed, only headings change.
     */
    STAYA_LAW_BOIDS = 3,
    /**
     * Across land in cells (A. V. Kuznetsov 2017), by velocities.
     */
    STAYA_LAW_ROUTE = 4,
    /**
     * The same, keeping a formation.
     */
    STAYA_LAW_FORMATION = 5,
    /**
     * Across land in cells, by moves from cell to cell.
     */
    STAYA_LAW_ROUTE_ON_GRID = 6,
    /**
     * The same, keeping a formation.
     */
    STAYA_LAW_FORMATION_ON_GRID = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaLaw StayaLaw;
#else
typedef uint8_t StayaLaw;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What keeps a robot clear of others: its safety layer. Robots that move from cell to cell have none.
 */
enum StayaSafety
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Nothing.
     */
    STAYA_SAFETY_NONE = 0,
    /**
     * ORCA in the plane.
     */
    STAYA_SAFETY_ORCA = 1,
    /**
     * The same with half-planes from a table of 2 KiB.
     */
    STAYA_SAFETY_ORCA_TABLE = 2,
    /**
     * ORCA in space, for robots that fly.
     */
    STAYA_SAFETY_FLY = 3,
    /**
     * Push-out: only against where others are now.
     */
    STAYA_SAFETY_PUSH_OUT = 4,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaSafety StayaSafety;
#else
typedef uint8_t StayaSafety;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * How robots speak; the same for all of a swarm.
 */
enum StayaWire
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * The controller's own frames, at most 60 bytes, each with a zero byte behind it.
     */
    STAYA_WIRE_POSTCARD = 0,
    /**
     * MAVLink 2 frames with messages of Staya's dialect (`controller/mavlink/messages/staya.xml`).
     */
    STAYA_WIRE_MAVLINK = 1,
    /**
     * As the first, with a code that only who has the `key` can make, and with protection against replays.
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
 * What the body should do until the next step.
 */
enum StayaCommand
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Stand.
     */
    STAYA_COMMAND_HOLD = 0,
    /**
     * Take the first of `moves` whose cell is free and passable; none free: stand.
     */
    STAYA_COMMAND_MOVE = 1,
    /**
     * Go with `velocity_mps`.
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
 * What the robot is doing as a whole.
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
     * On its way.
     */
    STAYA_MODE_CRUISE = 2,
    /**
     * Standing because somebody asked or no way is open.
     */
    STAYA_MODE_HOLD = 3,
    /**
     * At its target.
     */
    STAYA_MODE_ARRIVED = 4,
    /**
     * Own input is missing or wrong; standing.
     */
    STAYA_MODE_FAULT = 5,
    /**
     * Its agent does not steer it.
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
 * What a robot that has somewhere to go and does not get on waits for.
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
     * Its leader or its followers are not there yet.
     */
    STAYA_WAIT_FORMATION = 1,
    /**
     * Somebody asked it to stop.
     */
    STAYA_WAIT_REQUEST = 2,
    /**
     * Nothing but land or walls is in its way.
     */
    STAYA_WAIT_WAY = 3,
    /**
     * It does not know where others are: they are not heard.
     */
    STAYA_WAIT_RADIO = 4,
    /**
     * At a door others go first.
     */
    STAYA_WAIT_TURN = 5,
    /**
     * Other robots are in its way.
     */
    STAYA_WAIT_OTHERS = 6,
    /**
     * Somebody stands on its goal; it has arrived beside it.
     */
    STAYA_WAIT_PLACE = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaWait StayaWait;
#else
typedef uint8_t StayaWait;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A move from a cell: compass points, as in `moves` and `heading`.
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
 * What happened in a step.
 */
enum StayaEventKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Its mode changed: `before`, `after` (StayaMode).
     */
    STAYA_EVENT_KIND_MODE_CHANGED = 0,
    /**
     * No exit of the window can be reached.
     */
    STAYA_EVENT_KIND_NO_ROUTE = 1,
    /**
     * The target lay in an impassable cell and moved: `before_xy`, `after_xy`.
     */
    STAYA_EVENT_KIND_TARGET_MOVED = 2,
    /**
     * A request to `robot` ran out of retries; `after`: 0 stop, 1 resume, 2 redirect.
     */
    STAYA_EVENT_KIND_REQUEST_EXPIRED = 3,
    /**
     * `robot` is known now.
     */
    STAYA_EVENT_KIND_NEIGHBOR_FOUND = 4,
    /**
     * `robot` was silent for too long.
     */
    STAYA_EVENT_KIND_NEIGHBOR_LOST = 5,
    /**
     * The table was full and `robot` had to go.
     */
    STAYA_EVENT_KIND_NEIGHBOR_EVICTED = 6,
    /**
     * `robot` has restarted.
     */
    STAYA_EVENT_KIND_NEIGHBOR_REBOOTED = 7,
    /**
     * Nobody is heard any more.
     */
    STAYA_EVENT_KIND_NOBODY_HEARD = 8,
    /**
     * Two robots have the number `robot`.
     */
    STAYA_EVENT_KIND_DUPLICATE_ID = 9,
    /**
     * `robot` says of itself what is beyond `claims`; `after`: 0 its number, 1 radius, 2 speed, 3 place.
     */
    STAYA_EVENT_KIND_OVERCLAIMED = 10,
    /**
     * The robot says nothing any more: its counters are used up, and a new key is needed.
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
 * What does not move and stands in the way.
 */
enum StayaShape
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * An upright wall of no thickness from (`x_m`, `y_m`) to (`x2_m`, `y2_m`).
     */
    STAYA_SHAPE_WALL = 0,
    /**
     * A ball, in the plane a disc, around (`x_m`, `y_m`, `z_m`) with the radius `size_m`.
     */
    STAYA_SHAPE_BALL = 1,
    /**
     * All that is behind a plane: (`x_m`, `y_m`, `z_m`) is its normal, of length 1 and away from the obstacle, and the robot is
     * `size_m` in front of it.
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
 * Which terms of the alpha flock act.
 */
enum StayaLatticeTerms
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Only the others.
     */
    STAYA_LATTICE_TERMS_OTHERS = 1,
    /**
     * And the reference, with a pull that grows without bound.
     */
    STAYA_LATTICE_TERMS_REFERENCE = 2,
    /**
     * And obstacles; the pull of the reference is bounded.
     */
    STAYA_LATTICE_TERMS_ALL = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaLatticeTerms StayaLatticeTerms;
#else
typedef uint8_t StayaLatticeTerms;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * What push-out makes of a step that leads too near.
 */
enum StayaPushOutModel
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * It slides along and slows down.
     */
    STAYA_PUSH_OUT_MODEL_RADIAL = 0,
    /**
     * It keeps its length and is turned.
     */
    STAYA_PUSH_OUT_MODEL_TANGENTIAL = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaPushOutModel StayaPushOutModel;
#else
typedef uint8_t StayaPushOutModel;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A number that may change while the robot runs: `staya_set_parameter`. `staya_parameter_name` and others tell its name, unit, range.
 */
enum StayaParameter
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /**
     * Radius that others keep clear of; not less than the body's, m.
     */
    STAYA_PARAMETER_RADIUS = 0,
    /**
     * Time between two beacons, s.
     */
    STAYA_PARAMETER_BEACON_PERIOD = 1,
    /**
     * Speed that it likes to go, m/s.
     */
    STAYA_PARAMETER_SPEED = 2,
    /**
     * How near counts as being there, m.
     */
    STAYA_PARAMETER_TOLERANCE = 3,
    /**
     * Time ahead without a collision with a robot, s.
     */
    STAYA_PARAMETER_HORIZON = 4,
    /**
     * Time ahead without a collision with an obstacle, s.
     */
    STAYA_PARAMETER_WALL_HORIZON = 5,
    /**
     * Own share of a correction.
     */
    STAYA_PARAMETER_SHARE = 6,
    /**
     * Distance kept on top of the radii, m.
     */
    STAYA_PARAMETER_MARGIN = 7,
    /**
     * How far to the right to lean when somebody is in the way, rad.
     */
    STAYA_PARAMETER_LEAN = 8,
    /**
     * How long a gap is left to those whose turn it is, radii.
     */
    STAYA_PARAMETER_PATIENCE_RADII = 9,
    /**
     * Least distance of two robots' centres, m.
     */
    STAYA_PARAMETER_MIN_DISTANCE = 10,
    /**
     * How far neighbours count, m.
     */
    STAYA_PARAMETER_NEIGHBORHOOD = 11,
    /**
     * Pull of the goal (K1).
     */
    STAYA_PARAMETER_GOAL_GAIN = 12,
    /**
     * Pull of the middle of the neighbours (K2).
     */
    STAYA_PARAMETER_CENTER_GAIN = 13,
    /**
     * Push of neighbours that are too near (K3).
     */
    STAYA_PARAMETER_REPULSION_GAIN = 14,
    /**
     * Distance of neighbours in the lattice (d), m.
     */
    STAYA_PARAMETER_SPACING = 15,
    /**
     * Range of interaction over spacing.
     */
    STAYA_PARAMETER_RANGE_RATIO = 16,
    /**
     * Distance from obstacles over spacing.
     */
    STAYA_PARAMETER_OBSTACLE_RATIO = 17,
    /**
     * Bound of the attraction (a).
     */
    STAYA_PARAMETER_ATTRACTION = 18,
    /**
     * Bound of the repulsion (b), not less than a.
     */
    STAYA_PARAMETER_REPULSION = 19,
    /**
     * Robots among each other, on places, 1/s^2.
     */
    STAYA_PARAMETER_ALPHA_POSITION = 20,
    /**
     * Robots among each other, on velocities, 1/s.
     */
    STAYA_PARAMETER_ALPHA_VELOCITY = 21,
    /**
     * Obstacles, on places, 1/s^2.
     */
    STAYA_PARAMETER_BETA_POSITION = 22,
    /**
     * Obstacles, on velocities, 1/s.
     */
    STAYA_PARAMETER_BETA_VELOCITY = 23,
    /**
     * The reference, on places, 1/s^2.
     */
    STAYA_PARAMETER_GAMMA_POSITION = 24,
    /**
     * The reference, on velocities, 1/s.
     */
    STAYA_PARAMETER_GAMMA_VELOCITY = 25,
    /**
     * Nearer than this a boid turns away, m.
     */
    STAYA_PARAMETER_CROWDED = 26,
    /**
     * Up to this distance a neighbour counts, m.
     */
    STAYA_PARAMETER_CLOSEST = 27,
    /**
     * Largest turn towards the others in a step, rad.
     */
    STAYA_PARAMETER_MAX_TURN = 28,
    /**
     * Turn away from one that is too near in a step, rad.
     */
    STAYA_PARAMETER_MAX_TURN_AWAY = 29,
    /**
     * Weight of travel time.
     */
    STAYA_PARAMETER_TIME_GAIN = 30,
    /**
     * What a cell with another robot costs extra, ticks.
     */
    STAYA_PARAMETER_OTHERS_GAIN = 31,
    /**
     * What a cell costs extra for each earlier visit, ticks.
     */
    STAYA_PARAMETER_VISITS_GAIN = 32,
    /**
     * Price of a cell between the window and the target, ticks.
     */
    STAYA_PARAMETER_WAY_GAIN = 33,
    /**
     * How far from its place a robot still counts as there, cells.
     */
    STAYA_PARAMETER_EPS = 34,
    /**
     * Price of a cell off the own place, ticks.
     */
    STAYA_PARAMETER_PLACE_GAIN = 35,
    /**
     * How far somebody falls behind before the leader waits, cells.
     */
    STAYA_PARAMETER_HALT_LAG = 36,
    /**
     * How near he must be before the leader goes on, cells.
     */
    STAYA_PARAMETER_RESUME_LAG = 37,
    /**
     * How far ahead of the leader the others aim, cells.
     */
    STAYA_PARAMETER_LEAD = 38,
    /**
     * Share of the others' land in the leader's price, /16.
     */
    STAYA_PARAMETER_FOOTPRINT = 39,
    /**
     * How long they wait before each goes on for itself, decisions.
     */
    STAYA_PARAMETER_PATIENCE = 40,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum StayaParameter StayaParameter;
#else
typedef uint32_t StayaParameter;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A robot's controller. What is in it is the library's own business.
 */
typedef struct StayaAgent StayaAgent;

/**
 * ORCA of one robot. What is in it is the library's own business.
 */
typedef struct StayaAvoider StayaAvoider;

/**
 * Optimal reciprocal collision avoidance (J. van den Berg and others 2011).
 */
typedef struct StayaOrca {
    /**
     * Time ahead for which no collision with a robot may happen, seconds; 1 to 5. Longer gives way earlier and slows crowds.
     * Shorter than the body needs to stop (speed / acceleration) is not safe.
     */
    float horizon_s;
    /**
     * The same for obstacles, seconds. A robot slows to (distance / this time) in front of a wall.
     */
    float wall_horizon_s;
    /**
     * Own share of a correction: 0.5 when all do the same. Less is not safe.
     */
    float share;
    /**
     * Kept on top of the radii, metres: the error of what is known of places.
     */
    float margin_m;
    /**
     * How far to the right of the wish to lean while a robot is in the way, radians; 0.4 to 0.6, 0 never.
     */
    float lean_rad;
    /**
     * For how long a gap is left to those whose turn it is: the time for so many own radii at full speed; 4 to 16.
     */
    float patience_radii;
    /**
     * How the ball of a silent robot grows, m/s: the highest speed that others can have. Less is not safe when the radio is bad.
     */
    float growth_mps;
    /**
     * How much the ball of one that stands grows at most, metres.
     */
    float growth_max_m;
    /**
     * In space: how many times as far as beside each other robots keep apart above and below; 1 or more, for quadrotors 2.5.
     */
    float downwash;
} StayaOrca;

/**
 * Push-out (V. E. and V. V. Pavlovsky).
 */
typedef struct StayaPushOut {
    /**
     * Least distance of two centres, and of a centre from an obstacle, metres; more than bodies need by a step's length.
     */
    float min_distance_m;
    /**
     * StayaPushOutModel.
     */
    uint8_t model;
    /**
     * Other than 0: only the nearest of the robots in the way is evaded.
     */
    uint8_t only_nearest;
} StayaPushOut;

/**
 * The alpha flock (R. Olfati-Saber 2006, algorithms 1 to 3). `staya_lattice_defaults` has the paper's values.
 */
typedef struct StayaLattice {
    /**
     * Distance of neighbours (d), metres; 0.01 to 100, more than two radii plus half a second's way.
     */
    float spacing_m;
    /**
     * Range of interaction over spacing; above 1, below 1.7 for an even lattice.
     */
    float range_ratio;
    /**
     * Distance from obstacles over spacing; above 0, at most 4.
     */
    float obstacle_ratio;
    /**
     * Bounds of attraction (a) and repulsion (b): 0 < a <= b.
     */
    float attraction;
    /**
     * See `attraction`.
     */
    float repulsion;
    /**
     * Gains among robots on places (1/s^2) and on velocities (1/s). Old news need small ones: see `staya_lattice_soften`.
     */
    float alpha_position;
    /**
     * See `alpha_position`.
     */
    float alpha_velocity;
    /**
     * The same for obstacles; well above the others.
     */
    float beta_position;
    /**
     * See `beta_position`.
     */
    float beta_velocity;
    /**
     * The same for the reference.
     */
    float gamma_position;
    /**
     * See `gamma_position`.
     */
    float gamma_velocity;
    /**
     * StayaLatticeTerms.
     */
    uint8_t terms;
    /**
     * Other than 0: the reference goes where its velocity takes it. Agents only.
     */
    uint8_t reference_moves;
} StayaLattice;

/**
 * The goal flock (V. E. and V. V. Pavlovsky): only the ratios of the gains matter.
 */
typedef struct StayaGoalFlock {
    /**
     * Pull of the goal (K1).
     */
    float goal_gain;
    /**
     * Pull of the middle of the neighbours (K2).
     */
    float center_gain;
    /**
     * Push of neighbours that are too near (K3).
     */
    float repulsion_gain;
    /**
     * How far neighbours are seen, metres; at least twice `min_distance_m`.
     */
    float neighborhood_m;
    /**
     * Least distance of two centres, metres; at least two radii.
     */
    float min_distance_m;
    /**
     * How near to a goal counts as being there, metres: about the neighbourhood, for a crowd needs room. Agents only.
     */
    float arrival_m;
    /**
     * Seed of the draws of goals. Agents only.
     */
    uint32_t seed;
} StayaGoalFlock;

/**
 * Boids (V. A. Starovoitova 2018).
 */
typedef struct StayaBoids {
    /**
     * Nearer than this a boid turns away, metres.
     */
    float crowded_m;
    /**
     * Up to this distance a neighbour counts, metres.
     */
    float closest_m;
    /**
     * Largest turn to the others in a step, radians.
     */
    float max_turn_rad;
    /**
     * Turn away from one that is too near in a step, radians.
     */
    float max_turn_away_rad;
} StayaBoids;

/**
 * What a route across cells costs (A. V. Kuznetsov 2017); gains are in sixteenths of a tick.
 */
typedef struct StayaRoute {
    /**
     * Weight of travel time (a0), sixteenths.
     */
    uint16_t time_gain_16ths;
    /**
     * What a cell with another robot costs extra (a1), sixteenths of a tick.
     */
    uint16_t others_gain_16ths;
    /**
     * What a cell costs extra for each earlier visit (a2), sixteenths of a tick.
     */
    uint16_t visits_gain_16ths;
    /**
     * Price of a cell between window and target (a3), sixteenths of a tick: near the time that a cell takes on a good way.
     */
    uint16_t way_gain_16ths;
    /**
     * Moves that cost so much more, in sixteenths of a tick, come first half as often; 0: the cheapest always comes first.
     */
    uint16_t halved_per_16ths;
    /**
     * Radius of the window that is searched, cells; 1 to STAYA_MAX_RADIUS.
     */
    uint8_t radius_cells;
    /**
     * Other than 0: the exit of the window lies on the ray to the target; else it is the best of all.
     */
    uint8_t exit_on_ray;
    /**
     * Other than 0: a diagonal move counts as long as a straight one.
     */
    uint8_t diagonals_count_as_one;
    /**
     * Other than 0: diagonal moves may pass a blocked corner.
     */
    uint8_t cuts_corners;
    /**
     * Other than 0: it plans anew only when something on its way has changed, for fewer searches.
     */
    uint8_t keeps_plan;
} StayaRoute;

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
 * Where a neighbour in the formation should be.
 */
typedef struct StayaPlace {
    /**
     * Which robot; 0 for anyone.
     */
    uint32_t robot;
    /**
     * Its cell minus the own one.
     */
    struct StayaCell offset;
    /**
     * How many edges of the formation's graph are between; 1 or more.
     */
    uint8_t hops;
} StayaPlace;

/**
 * Keeping a formation (A. V. Kuznetsov 2017); a unit is 1/70 of a cell. `staya_formation_from_graph` fills in the place.
 */
typedef struct StayaFormation {
    /**
     * The neighbours, `neighbor_count` of them.
     */
    struct StayaPlace neighbors[STAYA_TEMPLATE];
    /**
     * How many of `neighbors` there are.
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
    /**
     * Price of being off one's place, sixteenths of a tick per cell.
     */
    uint16_t gain_16ths;
    /**
     * How far somebody falls behind before the top leader waits, units.
     */
    uint16_t halt_lag_units;
    /**
     * How near he must have come again, units; at most `halt_lag_units`.
     */
    uint16_t resume_lag_units;
    /**
     * Decisions (in the plane seconds) for which they wait for each other.
     */
    uint16_t patience;
    /**
     * How far from its place a neighbour still counts as found, cells.
     */
    uint8_t eps_cells;
    /**
     * How far ahead of the leader the others aim, cells.
     */
    uint8_t lead_cells;
    /**
     * Share of the others' land in the leader's price, sixteenths.
     */
    uint8_t footprint_16ths;
    /**
     * Other than 0: those behind a dead robot move up.
     */
    uint8_t closes_ranks;
    /**
     * Other than 0: others are foreseen by asking what one would do in their place; dear.
     */
    uint8_t foresees_others;
    /**
     * Other than 0: a leader heads for where the others are off to instead of waiting.
     */
    uint8_t turns_back;
} StayaFormation;

/**
 * All that makes a robot what it is before it has sensed anything. Fill it by `staya_setup_defaults`, then change what differs.
 *
 * What the chosen law and layer have no use for plays no part.
 */
typedef struct StayaSetup {
    /**
     * Written by `staya_setup_defaults`: header and library are of one version.
     */
    uint32_t version;
    /**
     * The robot's number, 1 or more, its own in the swarm (MAVLink: up to 254; with a key: below 2^21).
     */
    uint32_t id;
    /**
     * Seed of what it draws at random, together with its number.
     */
    uint64_t seed;
    /**
     * Time from one step to the next, microseconds, which must then be kept; on the grid the time for a cell of impassability 1.
     */
    int32_t tick_us;
    /**
     * Time between two beacons, microseconds.
     */
    int32_t beacon_period_us;
    /**
     * How old news is when it arrives, microseconds: neighbours are taken to have gone on for so long.
     */
    int32_t latency_us;
    /**
     * News older than this is stale, microseconds: a few beacon periods.
     */
    int32_t stale_after_us;
    /**
     * Who is silent for longer is lost, microseconds; at most half an hour.
     */
    int32_t lost_after_us;
    /**
     * How long a lost one is remembered, microseconds, at most half an hour.
     */
    int32_t remember_us;
    /**
     * How long a stop stands that is not renewed, microseconds.
     */
    int32_t stop_valid_us;
    /**
     * Time between two attempts of a request, microseconds.
     */
    int32_t retry_interval_us;
    /**
     * Attempts of a request.
     */
    uint8_t retry_attempts;
    /**
     * Changes with each start (counted in lasting memory or drawn), or the others take a restarted robot for a recording.
     */
    uint8_t boot;
    /**
     * The flock that it is of; robots of other flocks are only in its way.
     */
    uint8_t flock;
    /**
     * StayaLaw.
     */
    uint8_t law;
    /**
     * StayaSafety.
     */
    uint8_t safety;
    /**
     * StayaWire.
     */
    uint8_t wire;
    /**
     * Radius of the ball around the body, metres.
     */
    float radius_m;
    /**
     * Cruising speed, m/s; the body's own limit holds too.
     */
    float speed_mps;
    /**
     * How near to its waypoint counts as being there, metres.
     */
    float tolerance_m;
    /**
     * How fast the body can change its velocity, m/s^2; FLT_MAX: at once.
     */
    float max_acceleration_mps2;
    /**
     * How fast to go when all others are lost, m/s: 0 stands until somebody speaks; above 0 only for robots that may be alone.
     */
    float alone_mps;
    /**
     * Largest radius that others are believed to have, metres; FLT_MAX: any.
     */
    float claims_max_radius_m;
    /**
     * Highest speed that they are believed to have, m/s; FLT_MAX: any, and places are not looked at.
     */
    float claims_max_speed_mps;
    /**
     * How far off two places of a robot may be besides, metres.
     */
    float claims_slack_m;
    /**
     * For how long a robot that has jumped must say consistent places, microseconds.
     */
    int32_t claims_settle_us;
    /**
     * The greatest number of any robot.
     */
    uint32_t claims_last_id;
    /**
     * ORCA, in the plane and in space.
     */
    struct StayaOrca orca;
    /**
     * Push-out.
     */
    struct StayaPushOut push_out;
    /**
     * The lattice.
     */
    struct StayaLattice lattice;
    /**
     * The goal flock.
     */
    struct StayaGoalFlock goal_flock;
    /**
     * Boids.
     */
    struct StayaBoids boids;
    /**
     * Routes.
     */
    struct StayaRoute route;
    /**
     * Formations.
     */
    struct StayaFormation formation;
    /**
     * With STAYA_WIRE_SEALED: how often the robot was started, counted in lasting memory from 0; below 2^20.
     */
    uint32_t starts;
    /**
     * With STAYA_WIRE_SEALED: the swarm's secret. The agent keeps a copy.
     */
    uint8_t key[STAYA_KEY];
} StayaSetup;

/**
 * Something that does not move, seen from the robot's own place, metres.
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
 * What a step is told. All zeros is a robot at the origin that stands, sees nothing and hears nobody.
 *
 * Robots that go by velocities need `max_speed_mps`; those that cross land in cells `cell` and `window`, and by velocities also
 * `in_cell_x_m`, `in_cell_y_m` and `cell_m`. The rest plays no part then.
 */
typedef struct StayaInputs {
    /**
     * Own place in the world: east, north, up from an origin that all share, millimetres.
     */
    int32_t position_mm[3];
    /**
     * Own velocity in the world, m/s.
     */
    float velocity_mps[3];
    /**
     * The robot's clock, microseconds; it wraps after 71.6 minutes.
     */
    uint32_t now_us;
    /**
     * How fast the body can go where it is, m/s. With 0 the robot is in STAYA_MODE_FAULT, and stands.
     */
    float max_speed_mps;
    /**
     * Own cell.
     */
    struct StayaCell cell;
    /**
     * Time until it may leave its cell, microseconds; only for moves from cell to cell.
     */
    int32_t busy_us;
    /**
     * Where in its cell it is, metres from the cell's centre.
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
     * South-west cell of what it sees of the land.
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
     * How hard each cell is to cross, row by row from the south-west: 1 easy, 255 hard, 0 impassable; width * height bytes. Null: it
     * sees no land, and is in STAYA_MODE_FAULT.
     */
    const uint8_t *window;
    /**
     * What stands in the way, `obstacle_count` of them, at most 32 (16 if the library was built small).
     */
    const struct StayaObstacle *obstacles;
    /**
     * How many of `obstacles` there are.
     */
    size_t obstacle_count;
    /**
     * What the radio delivered since the last step, `inbox_bytes` of it, in order: whole frames, damaged ones, those of others.
     */
    const uint8_t *inbox;
    /**
     * How many bytes of `inbox` there are.
     */
    size_t inbox_bytes;
} StayaInputs;

/**
 * Something that happened.
 */
typedef struct StayaEvent {
    /**
     * Which robot it is about; 0 for none.
     */
    uint32_t robot;
    /**
     * A cell before.
     */
    struct StayaCell before_xy;
    /**
     * A cell now.
     */
    struct StayaCell after_xy;
    /**
     * StayaEventKind, which says what of the rest counts.
     */
    uint8_t kind;
    /**
     * A number before.
     */
    uint8_t before;
    /**
     * A number now.
     */
    uint8_t after;
} StayaEvent;

/**
 * What a step gives.
 */
typedef struct StayaOutputs {
    /**
     * World velocity to go with until the next step, m/s; with STAYA_COMMAND_VELOCITY.
     */
    float velocity_mps[3];
    /**
     * When to call again if nothing arrives before: the robot's clock, microseconds.
     */
    uint32_t call_again_us;
    /**
     * Whom it follows; 0 for nobody.
     */
    uint32_t leader;
    /**
     * The cell that it is going to; with `has_target`.
     */
    struct StayaCell target;
    /**
     * Frames that were heard: sound, not seen before, of somebody else.
     */
    uint16_t received;
    /**
     * Frames that were refused: damaged, repeated, not authentic.
     */
    uint16_t rejected;
    /**
     * Of those: without a code.
     */
    uint16_t refused_unsigned;
    /**
     * Of those: with a code of another key or of another content.
     */
    uint16_t refused_forged;
    /**
     * Of those: recorded, repeated, or too far ahead.
     */
    uint16_t refused_replayed;
    /**
     * Of those: of senders for whom there is no room.
     */
    uint16_t refused_no_room;
    /**
     * Beacons with a number beyond `claims_last_id`.
     */
    uint16_t overclaimed_numbers;
    /**
     * Beacons with too large a radius.
     */
    uint16_t overclaimed_radii;
    /**
     * Beacons with too high a speed.
     */
    uint16_t overclaimed_speeds;
    /**
     * Beacons of places where the robot cannot be yet.
     */
    uint16_t overclaimed_places;
    /**
     * Bytes of `outbox`.
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
     * How many of `moves` there are.
     */
    uint8_t move_count;
    /**
     * What it is doing: StayaMode.
     */
    uint8_t mode;
    /**
     * What it waits for: StayaWait.
     */
    uint8_t wait;
    /**
     * Whether it has a goal, and so a `target`.
     */
    uint8_t has_target;
    /**
     * How many of `events` there are.
     */
    uint8_t event_count;
    /**
     * What happened; the oldest ones when there are more.
     */
    struct StayaEvent events[STAYA_EVENTS];
    /**
     * Bytes for the radio, `outbox_bytes` of them.
     */
    uint8_t outbox[STAYA_OUTBOX];
} StayaOutputs;

/**
 * A place to go to, which may move.
 */
typedef struct StayaWaypoint {
    /**
     * Where it was, millimetres.
     */
    int32_t position_mm[3];
    /**
     * Its velocity since, m/s.
     */
    float velocity_mps[3];
    /**
     * When it was there, the robot's clock, microseconds.
     */
    uint32_t at_us;
} StayaWaypoint;

/**
 * A robot as it was heard last.
 */
typedef struct StayaNeighbor {
    /**
     * Who it is; from 2^31 on a second robot of the number below.
     */
    uint32_t id;
    /**
     * When it was heard, the own clock, microseconds.
     */
    uint32_t heard_us;
    /**
     * Where it was then, millimetres.
     */
    int32_t position_mm[3];
    /**
     * Its velocity then, m/s.
     */
    float velocity_mps[3];
    /**
     * Radius of the ball around its body, metres.
     */
    float radius_m;
    /**
     * Its leader; 0 for nobody.
     */
    uint32_t leader;
    /**
     * The cell that it was in.
     */
    struct StayaCell cell;
    /**
     * The cell that it was going to.
     */
    struct StayaCell target;
    /**
     * Its place in the formation, or its flock.
     */
    uint8_t slot;
    /**
     * What it was doing: StayaMode.
     */
    uint8_t mode;
    /**
     * The move that it wanted next: StayaDir.
     */
    uint8_t heading;
    /**
     * Silent for too long: only where it was still counts.
     */
    uint8_t is_lost;
} StayaNeighbor;

/**
 * The own body.
 */
typedef struct StayaBody {
    /**
     * Own number, 1 or more: when two are in one place it says who goes which way.
     */
    uint32_t id;
    /**
     * Own velocity, m/s.
     */
    float velocity_mps[3];
    /**
     * Radius of the ball around it, metres.
     */
    float radius_m;
    /**
     * How fast it can go where it is, m/s.
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
 * Another robot, as it is right now.
 */
typedef struct StayaNearby {
    /**
     * Who it is.
     */
    uint32_t id;
    /**
     * Its place minus the own one, metres.
     */
    float offset_m[3];
    /**
     * Its velocity, m/s.
     */
    float velocity_mps[3];
    /**
     * Radius of the ball that it is in, metres.
     */
    float radius_m;
    /**
     * 0: it does not make way, and all of a correction is one's own.
     */
    uint8_t gives_way;
    /**
     * Other than 0: it stands at its place and will stay (STAYA_MODE_ARRIVED), so others need not wait for it.
     */
    uint8_t is_parked;
    /**
     * Other than 0: of another flock, and only in the way.
     */
    uint8_t is_stranger;
} StayaNearby;

/**
 * Where a flock should be, as a robot sees it.
 */
typedef struct StayaReference {
    /**
     * Its place minus the own one, metres.
     */
    float offset_m[3];
    /**
     * Its velocity, m/s.
     */
    float velocity_mps[3];
} StayaReference;

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
 * Bytes that an agent of this build takes: at most STAYA_AGENT_SIZE.
 */
size_t staya_agent_bytes(void);

/**
 * Makes an agent in memory of the caller's: idle, without a goal, knowing nobody. `*agent` is where it is, which is `memory`; it is
 * there for as long as the memory is, must not be moved, and needs no end. It is null if the setup is refused.
 *
 * Needs some kilobytes of stack for a moment (docs/c.md).
 */
StayaStatus staya_init(void *memory,
                       size_t memory_bytes,
                       const struct StayaSetup *setup,
                       struct StayaAgent **agent);

/**
 * One step: hear, decide, speak. To be called once a `tick_us`, with the robot's clock and state as they are.
 *
 * Bounded work; the agent and `outputs` are unchanged when the inputs are refused.
 */
StayaStatus staya_step(struct StayaAgent *agent,
                       const struct StayaInputs *inputs,
                       struct StayaOutputs *outputs);

/**
 * Gives the robot a waypoint, number `index` below STAYA_WAYPOINTS: for the laws of the plane but boids. The goal flock takes
 * several, the others number 0.
 */
StayaStatus staya_assign_waypoint(struct StayaAgent *agent,
                                  uint8_t index,
                                  const struct StayaWaypoint *waypoint);

/**
 * Gives the robot a cell to go to: for the laws that cross land in cells. In a formation the top leader's cell is enough.
 */
StayaStatus staya_assign_cell(struct StayaAgent *agent,
                              int16_t x,
                              int16_t y);

/**
 * What the robot is doing: StayaMode.
 */
StayaStatus staya_mode(const struct StayaAgent *agent, uint8_t *mode);

/**
 * Whom the robot knows, by rising number: the first `room` of them; `*count` is how many there are, which may be more.
 * `STAYA_NEIGHBORS` is always room enough.
 */
StayaStatus staya_neighbors(const struct StayaAgent *agent,
                            struct StayaNeighbor *neighbors,
                            size_t neighbor_room,
                            size_t *count);

/**
 * A fingerprint of the agent's whole state: agents with equal ones have the same future; the same on every machine.
 */
StayaStatus staya_digest(const struct StayaAgent *agent,
                         uint64_t *digest);

/**
 * Moves a place by a way in metres, rounded to millimetres, saturating: for odometry, and for bodies in a simulation.
 */
StayaStatus staya_move(int32_t position_mm[3],
                       const float way_m[3]);

/**
 * The parameters of ORCA that suit most robots.
 */
StayaStatus staya_orca_defaults(struct StayaOrca *orca);

/**
 * Makes ORCA for one robot in memory of the caller's, STAYA_ORCA_SIZE bytes aligned by STAYA_ALIGN: in the plane, or with `in_space`
 * other than 0 in space. `seed` is of the draws that end ties; robots may have the same.
 */
StayaStatus staya_orca_init(void *memory,
                            size_t memory_bytes,
                            const struct StayaOrca *orca,
                            uint8_t in_space,
                            uint64_t seed,
                            struct StayaAvoider **avoider);

/**
 * The velocity to take until the next step, m/s: the nearest to `wish_mps` that robots and obstacles permit. To be called once a
 * `step_s` for the same robot.
 *
 * `way_m` is the way to the goal, metres, null without one: near it nobody swerves. Of the robots the nearest STAYA_NEARBY count, in
 * any order. In the plane heights play no part, and the answer has the height of the wish.
 */
StayaStatus staya_orca_velocity(struct StayaAvoider *avoider,
                                const struct StayaBody *body,
                                const float wish_mps[3],
                                const float way_m[3],
                                const struct StayaNearby *nearby,
                                size_t nearby_count,
                                const struct StayaObstacle *obstacles,
                                size_t obstacle_count,
                                float velocity_mps[3]);

/**
 * What a robot of an alpha flock should do to its velocity, m/s^2; not bounded by what the body can do. `reference` may be null.
 */
StayaStatus staya_lattice_acceleration(const struct StayaLattice *lattice,
                                       const struct StayaBody *body,
                                       const struct StayaNearby *nearby,
                                       size_t nearby_count,
                                       const struct StayaObstacle *obstacles,
                                       size_t obstacle_count,
                                       const struct StayaReference *reference,
                                       float acceleration_mps2[3]);

/**
 * The velocity that a robot of a goal flock wishes for, m/s. Places are in millimetres; `goal_mm` may be null.
 */
StayaStatus staya_goal_flock_wish(const struct StayaGoalFlock *goal_flock,
                                  float speed_mps,
                                  const struct StayaBody *body,
                                  const int32_t own_mm[3],
                                  const int32_t goal_mm[3],
                                  const struct StayaNearby *nearby,
                                  size_t nearby_count,
                                  float wish_mps[3]);

/**
 * Turns a boid's heading, a unit vector, to what it is one step later.
 */
StayaStatus staya_boids_steer(const struct StayaBoids *boids,
                              uint32_t id,
                              const struct StayaNearby *nearby,
                              size_t nearby_count,
                              float heading[2]);

/**
 * The velocity nearest to `wish_mps` by the rules of push-out, m/s, for the next `step_s`.
 */
StayaStatus staya_push_out_velocity(const struct StayaPushOut *params,
                                    const struct StayaBody *body,
                                    const float wish_mps[3],
                                    const struct StayaNearby *nearby,
                                    size_t nearby_count,
                                    const struct StayaObstacle *obstacles,
                                    size_t obstacle_count,
                                    float velocity_mps[3]);

/**
 * The name of a parameter, such as "horizon_s"; null if there is no such number. From 0 up, all are told.
 */
const char *staya_parameter_name(uint32_t parameter);

/**
 * The unit of a parameter, empty for a plain number; null if there is no such number.
 */
const char *staya_parameter_unit(uint32_t parameter);

/**
 * The least and the greatest value that a parameter takes.
 */
StayaStatus staya_parameter_range(uint32_t parameter, float *least, float *greatest);

/**
 * What a parameter (StayaParameter) is now. `STAYA_STATUS_PARAMETER` when this robot's law and layer have no such one.
 */
StayaStatus staya_get_parameter(const struct StayaAgent *agent,
                                uint32_t parameter,
                                float *value);

/**
 * Changes a parameter (StayaParameter) from the next step on. `STAYA_STATUS_PARAMETER` when this robot has no such one, the value is
 * out of range or does not go with the other parameters; then nothing has changed.
 */
StayaStatus staya_set_parameter(struct StayaAgent *agent,
                                uint32_t parameter,
                                float value);

/**
 * Fills a setup for robot `id` with what robots can do with: straight to waypoints at 0.5 m/s behind ORCA, a beacon each step, no
 * inertia, no latency. Lengths of the other laws follow from the radius.
 *
 * `radius_m` is that of the ball around the body, metres; `tick_us` the time from one step to the next, microseconds. They are
 * judged by `staya_init`.
 */
StayaStatus staya_setup_defaults(struct StayaSetup *setup,
                                 uint32_t id,
                                 float radius_m,
                                 int32_t tick_us);

/**
 * The paper's values of the lattice for a spacing, metres: as in a setup's defaults.
 */
StayaStatus staya_lattice_defaults(struct StayaLattice *lattice, float spacing_m);

/**
 * Softens the gains as far as news ask that are `delay_s` old when they arrive and come `rate_hz` times a second: stiffer ones swing
 * the lattice apart.
 */
StayaStatus staya_lattice_soften(struct StayaLattice *lattice,
                                 float delay_s,
                                 float rate_hz);

/**
 * Fills in the place number `own` of a formation: its cells in any common frame, the top leader's first, and the edges of its graph.
 * Who is within `hops` edges becomes a neighbour; the robot at place i has the number i + 1.
 *
 * `STAYA_STATUS_SHAPE` for a place or an edge that does not exist, `STAYA_STATUS_TOO_MANY` for more than STAYA_TEMPLATE neighbours.
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
 * What a status means and what to do about it, in a line. Never null.
 */
const char *staya_status_text(int32_t status);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* STAYA_H */

/* As the library was compiled: no packed structures, IEEE 754. */
STAYA_STATIC_ASSERT(sizeof(StayaSetup) == STAYA_SETUP_SIZE, "StayaSetup is laid out otherwise than in the library");
STAYA_STATIC_ASSERT(sizeof(StayaOutputs) == STAYA_OUTPUTS_SIZE, "StayaOutputs is laid out otherwise than in the library");
STAYA_STATIC_ASSERT(sizeof(float) == 4, "float is not IEEE 754 single precision");
