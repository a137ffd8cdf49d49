uint64_t usecTimestamp(void);
