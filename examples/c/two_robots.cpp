// Agents from C++: two robots change places and exchange nothing but bytes. How to compile it:
// docs/c.md.

#include "staya.h"
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

void must(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        std::fprintf(stderr, "%s: %s\n", staya_status_name(status), staya_status_text(status));
        std::exit(1);
    }
}

constexpr std::int32_t TICK_US = 50'000;

class Robot {
public:
    Robot(std::uint32_t id, std::int32_t from_mm, std::int32_t to_mm) : inputs{}
    {
        StayaSetup setup;
        must(staya_setup_defaults(&setup, id, 0.1f, TICK_US));
        setup.latency_us = TICK_US;
        must(staya_init(memory, sizeof memory, &setup, &agent));
        StayaWaypoint goal{};
        goal.position_mm[0] = to_mm;
        must(staya_assign_waypoint(agent, 0, &goal));
        inputs.position_mm[0] = from_mm;
        inputs.max_speed_mps = setup.speed_mps;
    }
    // Not copyable: the agent lives in `memory`.
    Robot(const Robot &) = delete;
    Robot &operator=(const Robot &) = delete;

    // Runs one step of the agent; returns the packets that it sends.
    std::vector<std::uint8_t> step(std::uint32_t now_us, const std::vector<std::uint8_t> &heard)
    {
        inputs.now_us = now_us;
        inputs.inbox = heard.data();
        inputs.inbox_bytes = heard.size();
        must(staya_step(agent, &inputs, &outputs));
        return {outputs.outbox, outputs.outbox + outputs.outbox_bytes};
    }

    // A body without inertia follows the command at once.
    void move()
    {
        float way_m[3] = {};
        for (int axis = 0; axis < 3; axis++) {
            inputs.velocity_mps[axis] = outputs.command == STAYA_COMMAND_VELOCITY ? outputs.velocity_mps[axis] : 0.0f;
            way_m[axis] = inputs.velocity_mps[axis] * 1e-6f * TICK_US;
        }
        must(staya_move(inputs.position_mm, way_m));
    }

    bool has_arrived() const { return outputs.mode == STAYA_MODE_ARRIVED; }
    double x_m() const { return inputs.position_mm[0] / 1000.0; }
    double y_m() const { return inputs.position_mm[1] / 1000.0; }

private:
    alignas(STAYA_ALIGN) unsigned char memory[STAYA_AGENT_SIZE];
    StayaAgent *agent = nullptr;
    StayaInputs inputs;
    StayaOutputs outputs{};
};

} // namespace

int main()
{
    static Robot east{1, -1500, 1500}, west{2, 1500, -1500};
    std::vector<std::uint8_t> from_east, from_west;
    double least_m = 1e9;
    std::uint32_t tick = 0;
    for (; !(east.has_arrived() && west.has_arrived()); tick++) {
        // Packets arrive one tick after they were sent.
        auto said_east = east.step(tick * TICK_US, from_west);
        auto said_west = west.step(tick * TICK_US, from_east);
        from_east = said_east;
        from_west = said_west;
        east.move();
        west.move();
        least_m = std::fmin(least_m, std::hypot(east.x_m() - west.x_m(), east.y_m() - west.y_m()));
        if (tick > 1000) {
            std::fprintf(stderr, "they never arrive\n");
            return 1;
        }
    }
    std::printf("both arrived after %.1f s, never nearer than %.3f m\n", tick * TICK_US * 1e-6, least_m);
    return least_m >= 0.2 ? 0 : 1;
}
