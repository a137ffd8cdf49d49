/* The test swarms on an STM32F405 in QEMU: start-up without a vendor's library, output over
   semihosting. */

#include "platform.h"

extern uint32_t stack_top, bss_start, bss_end, data_start, data_end, data_in_flash;

/* Calls the emulator by Arm's semihosting. */
static uint32_t ask(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void print(const char *text)
{
    static uint32_t out;
    if (out == 0) {
        const uint32_t standard_output[3] = {(uint32_t)":tt", 4, 3};
        out = ask(0x01, standard_output); /* SYS_OPEN, to write */
    }
    uint32_t bytes = 0;
    while (text[bytes] != 0) {
        bytes++;
    }
    const uint32_t write[3] = {out, (uint32_t)text, bytes};
    ask(0x05, write); /* SYS_WRITE */
}

static void end(uint32_t code)
{
    const uint32_t reason[2] = {0x20026, code}; /* ADP_Stopped_ApplicationExit */
    ask(0x20, reason); /* SYS_EXIT_EXTENDED */
    for (;;) {
    }
}

void fail(const char *why)
{
    print(why);
    print("\n");
    end(1);
}

/* A space, the number, and the end of the line. */
static void print_number(uint32_t number)
{
    char decimal[13];
    int at = 12;
    decimal[at] = 0;
    decimal[--at] = '\n';
    do {
        decimal[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number != 0);
    decimal[--at] = ' ';
    print(&decimal[at]);
}

/* A space and the hash. */
static void print_hash(uint64_t hash)
{
    char digits[18];
    digits[0] = ' ';
    for (int i = 0; i < 16; i++) {
        digits[i + 1] = "0123456789abcdef"[(hash >> (60 - 4 * i)) & 15];
    }
    digits[17] = 0;
    print(digits);
}

void print_row(const char *name, const Hashes *hashes, uint32_t steps)
{
    print(name);
    print(" f32");
    print_hash(hashes->commands);
    print_hash(hashes->bytes);
    print_number(steps);
}

/* Fills the memory of the stack; where it is intact, the stack was never used. */
#define UNTOUCHED 0xA55AA55Au

static void print_deepest_stack(void)
{
    const uint32_t *lowest = &bss_end;
    while (lowest < &stack_top && *lowest == UNTOUCHED) {
        lowest++;
    }
    print("stack");
    print_number((uint32_t)&stack_top - (uint32_t)lowest);
}

void reset(void)
{
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20; /* CPACR: the FPU is on */
    __asm__ volatile("dsb\nisb" ::: "memory");
    const uint32_t *from = &data_in_flash;
    for (uint32_t *to = &data_start; to < &data_end;) {
        *to++ = *from++;
    }
    for (uint32_t *to = &bss_start; to < &bss_end;) {
        *to++ = 0;
    }
    uint32_t *here;
    __asm__ volatile("mov %0, sp" : "=r"(here));
    for (uint32_t *to = &bss_end; to < here - 32; to++) {
        *(volatile uint32_t *)to = UNTOUCHED;
    }
    const int result = run_swarms();
    print_deepest_stack();
    end((uint32_t)result);
}

static void fault(void)
{
    fail("the processor has met an exception");
}

union vector {
    const uint32_t *stack;
    void (*handler)(void);
};

__attribute__((section(".vectors"), used)) static const union vector VECTORS[16] = {
    {.stack = &stack_top}, {.handler = reset}, {.handler = fault}, {.handler = fault},
    {.handler = fault},    {.handler = fault}, {.handler = fault},
};
