uint64_t configblockGetRadioAddress(void);
