TickType_t xTaskGetTickCount(void);
void vTaskDelayUntil(TickType_t *last, TickType_t span);
