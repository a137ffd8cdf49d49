#define P2P_MAX_DATA_SIZE 60
typedef struct _P2PPacket {
    uint8_t size;
    struct {
        uint8_t port;
        uint8_t rssi;
        uint8_t data[P2P_MAX_DATA_SIZE];
    };
} P2PPacket;
typedef void (*P2PCallback)(P2PPacket *packet);
void p2pRegisterCB(P2PCallback callback);
bool radiolinkSendP2PPacketBroadcast(P2PPacket *packet);
