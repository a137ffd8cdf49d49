void debug_print(const char *format, ...);
#define DEBUG_PRINT debug_print
