/* The robot's loop on a Cortex-M4F, with start-up code that needs no vendor library. */

#include "board.h"
#include "robot.h"

extern uint32_t stack_top, bss_start, bss_end, data_start, data_end, data_in_flash;

static void must(StayaStatus status)
{
    if (status != STAYA_STATUS_OK) {
        board_fail(staya_status_text(status));
    }
}

static _Noreturn void run(void)
{
    static Robot robot;
    static uint8_t heard[1024];
    const int32_t goal_mm[2] = {BOARD_GOAL_X_MM, BOARD_GOAL_Y_MM};
    board_init();
    must(robot_init(&robot, BOARD_NUMBER, goal_mm));
    uint32_t due_us = board_clock_us();
    size_t heard_bytes = 0;
    for (;;) {
        heard_bytes += board_read(heard + heard_bytes, sizeof heard - heard_bytes);
        const uint32_t now_us = board_clock_us();
        if ((int32_t)(now_us - due_us) < 0) {
            continue;
        }
        due_us += ROBOT_TICK_US;
        int32_t position_mm[2];
        float velocity_mps[2];
        board_state(position_mm, velocity_mps);
        must(robot_step(&robot, position_mm, velocity_mps, now_us, heard, heard_bytes));
        heard_bytes = 0;
        board_send(robot.outputs.outbox, robot.outputs.outbox_bytes);
        robot_velocity(&robot, velocity_mps);
        board_drive(velocity_mps);
        board_pet();
    }
}

void reset(void)
{
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20; /* CPACR: enable the FPU */
    __asm__ volatile("dsb\nisb" ::: "memory");
    const uint32_t *from = &data_in_flash;
    for (uint32_t *to = &data_start; to < &data_end;) {
        *to++ = *from++;
    }
    for (uint32_t *to = &bss_start; to < &bss_end;) {
        *to++ = 0;
    }
    run();
}

static void fault(void)
{
    board_fail("processor exception");
}

union vector {
    const uint32_t *stack;
    void (*handler)(void);
};

/* Add the interrupts of peripherals here if board.c uses any. */
__attribute__((section(".vectors"), used)) static const union vector VECTORS[16] = {
    {.stack = &stack_top}, {.handler = reset},  {.handler = fault}, {.handler = fault}, {.handler = fault}, {.handler = fault},
    {.handler = fault},    {0},                 {0},                {0},                {0},                {.handler = fault},
    {.handler = fault},    {0},                 {.handler = fault}, {.handler = fault},
};
