/* FILL IN with the vendor's headers or registers: until then the robot does not move. */

#include "board.h"

void board_init(void) {}

uint32_t board_clock_us(void)
{
    /* Replace this by a timer that counts microseconds, or by the cycle counter. */
    static uint32_t calls;
    return calls++;
}

size_t board_read(uint8_t *bytes, size_t room)
{
    (void)bytes;
    (void)room;
    return 0;
}

void board_send(const uint8_t *bytes, size_t count)
{
    (void)bytes;
    (void)count;
}

void board_state(int32_t position_mm[2], float velocity_mps[2])
{
    position_mm[0] = position_mm[1] = 0;
    velocity_mps[0] = velocity_mps[1] = 0.0f;
}

void board_drive(const float velocity_mps[2])
{
    (void)velocity_mps;
}

void board_pet(void) {}

_Noreturn void board_fail(const char *text)
{
    (void)text;
    *(volatile uint32_t *)0xE000ED0C = 0x05FA0004; /* AIRCR: restart */
    for (;;) {
    }
}
