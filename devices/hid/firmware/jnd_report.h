/* The reports that a fingertip device, a tracker and the host exchange: version 1 of the report protocol, as
 * devices/hid/PROTOCOL.md describes it. Bytes to numbers and back, nothing else: no heap, no clock, no hardware, so
 * that firmware, host and virtual device use the very same lines.
 *
 * Every report has 64 bytes: its id first, its CRC-32 (IEEE 802.3, over bytes 0..59) in bytes 60..63. Numbers are
 * little-endian fixed point; the names below carry their units. A decoder accepts a report only where length, id,
 * version, CRC and every field's range are right, and leaves the structure untouched otherwise.
 */
#ifndef JND_REPORT_H
#define JND_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { JND_REPORT_SIZE = 64, JND_PROTOCOL_VERSION = 1 };

/* HID usages: how a host knows a device of ours, whatever its vendor and product numbers. */
enum { JND_USAGE_PAGE = 0xFF4A, JND_USAGE_FINGERTIP = 0x01, JND_USAGE_TRACKER = 0x02 };

/* Report ids: 0x0x from the host, 0x1x from the device. */
enum jnd_report_id {
  JND_REPORT_COMMAND = 0x01,
  JND_REPORT_REQUEST = 0x02,
  JND_REPORT_TELEMETRY = 0x11,
  JND_REPORT_PAGE = 0x12,
  JND_REPORT_TRACKER = 0x13
};

enum jnd_decode_result {
  JND_DECODE_OK = 0,
  JND_DECODE_LENGTH,  /* not 64 bytes */
  JND_DECODE_ID,      /* another report */
  JND_DECODE_VERSION, /* another version of the protocol */
  JND_DECODE_CRC,
  JND_DECODE_RANGE /* a field holds what the protocol does not allow */
};

/* -- 0x01, host to device: what the device should do now ---------------------------------------------------------- */

enum jnd_mode { JND_MODE_REST = 0, JND_MODE_WRENCH = 1, JND_MODE_PD = 2, JND_MODE_PD_LITERAL = 3 };

enum { JND_NORMAL_ONE = 1 << 30 }; /* a component of 1 of a unit vector or quaternion */

struct jnd_command {
  uint32_t sequence;                 /* one more than in the command before */
  uint8_t mode;                      /* enum jnd_mode */
  bool touching;                     /* the contact below holds; otherwise it is zero */
  int32_t contact_point_nm[3];       /* of the proxy, device frame */
  int32_t normal[3];                 /* of the surface, out of it; unit vector in 2^-30, device frame */
  uint32_t penetration_nm;           /* along the normal */
  int32_t penetration_rate_um_per_s; /* above 0 while the finger goes deeper */
  uint32_t stiffness_mn_per_m;       /* 0.001 N/m */
  uint32_t most_force_un;            /* 0.000001 N: what the host's own limits allow just now */
  uint16_t damping_cn_s_per_m;       /* 0.01 N s/m */
  int16_t roll_dmrad, pitch_dmrad;   /* 0.0001 rad: how the platform should lie */
  uint16_t vibration_mg;             /* 0.001 g, amplitude; 0: off */
  uint16_t vibration_dhz;            /* 0.1 Hz */
};

/* -- 0x11, device to host: how it is --------------------------------------------------------------------------------
 */

enum jnd_state { JND_STATE_REST = 0, JND_STATE_ACTIVE = 1, JND_STATE_STOPPED = 2 };

/* Why the device stopped itself, and what else is wrong. Latched until a command of mode rest. */
enum jnd_fault_bit {
  JND_FAULT_WATCHDOG = 1 << 0,    /* no valid command within the watchdog's time */
  JND_FAULT_SENSOR = 1 << 1,      /* a sensor does not answer, or tells what cannot be */
  JND_FAULT_ACTUATOR = 1 << 2,    /* an actuator does not follow */
  JND_FAULT_TEMPERATURE = 1 << 3, /* beyond its highest */
  JND_FAULT_BATTERY = 1 << 4,     /* too low to go on */
  JND_FAULT_BUTTON = 1 << 5,      /* the stop button on the device */
  JND_FAULT_INTERNAL = 1 << 6     /* a number that is none, or a pose out of reach */
};
enum { JND_FAULT_BITS = 0x7F };

/* Which of its own limits acted in the last step. */
enum jnd_limit_bit {
  JND_LIMIT_FORCE = 1 << 0,     /* the law asked more than the device's cap, or than most_force */
  JND_LIMIT_RISE = 1 << 1,      /* the force rises no faster */
  JND_LIMIT_TILT = 1 << 2,      /* roll or pitch */
  JND_LIMIT_DIRECTION = 1 << 3, /* the normal is no unit vector, or does not push: no force */
  JND_LIMIT_WORKSPACE = 1 << 4, /* the platform is out of its range: no force */
  JND_LIMIT_VIBRATION = 1 << 5, /* amplitude or frequency */
  JND_LIMIT_BURST = 1 << 6,     /* vibration for too long */
  JND_LIMIT_STIFFNESS = 1 << 7, /* stiffness or damping above the device's own */
  JND_LIMIT_SOFT_START = 1 << 8 /* the force is let in over the first moments of being active */
};
enum { JND_LIMIT_BITS = 0x1FF };

enum { JND_COMMAND_AGE_NONE = 0xFFFF, JND_TEMPERATURE_NONE = -32768, JND_BATTERY_NONE = 255 };

struct jnd_telemetry {
  uint8_t state;             /* enum jnd_state */
  uint8_t buttons;           /* bit 0..7, 1 = pressed */
  uint32_t sequence;         /* one more than in the telemetry before */
  uint32_t command_sequence; /* of the last command that was accepted; 0: none since power-up */
  uint64_t time_us;          /* device clock: when the readings were true */
  int32_t joint_urad[3];     /* 0.000001 rad */
  int32_t force_un;          /* 0.000001 N: on the finger, measured, calibrated */
  int32_t height_nm;         /* of the platform, pz */
  int16_t roll_dmrad, pitch_dmrad, yaw_dmrad;
  uint16_t vibration_mg;
  uint16_t faults;          /* jnd_fault_bit */
  uint16_t limits;          /* jnd_limit_bit */
  uint16_t rejected;        /* commands refused so far, modulo 65536 */
  uint16_t command_age_us;  /* from the arrival of that command to time_us; JND_COMMAND_AGE_NONE: more, or none yet */
  int16_t temperature_cdeg; /* 0.01 degree Celsius; JND_TEMPERATURE_NONE: not measured */
  uint8_t battery_percent;  /* 0..100; JND_BATTERY_NONE: runs on the cable */
};

/* -- 0x13, device to host: where a finger is ------------------------------------------------------------------------
 */

enum jnd_finger { JND_FINGER_ANY = 0, JND_THUMB, JND_INDEX, JND_MIDDLE, JND_RING, JND_LITTLE };

struct jnd_pose {
  uint8_t finger; /* enum jnd_finger, not ANY */
  bool seen;      /* the tracker sees it; otherwise the pose is zero */
  bool has_flexion;
  uint32_t sequence;      /* one more than in the pose before, whichever finger that was of */
  uint64_t time_us;       /* device clock: when the pose was true */
  int32_t position_nm[3]; /* of the fingertip, tracker frame */
  int32_t orientation[4]; /* w, x, y, z of the unit quaternion that turns the device frame into the tracker's, 2^-30 */
  int32_t flexion_urad;
};

/* -- 0x02 and 0x12: pages of description, asked for and answered ----------------------------------------------------
 */

enum jnd_operation { JND_READ_PAGE = 0, JND_WRITE_PAGE = 1 };
enum jnd_page_result { JND_PAGE_OK = 0, JND_PAGE_UNKNOWN, JND_PAGE_REFUSED, JND_PAGE_INVALID };
enum { JND_PAGE_SIZE = 52 };

enum jnd_page_number {
  JND_PAGE_IDENTITY = 0,
  JND_PAGE_LIMITS = 1,
  JND_PAGE_GEOMETRY = 2,
  JND_PAGE_FORCE_TABLE = 3, /* writable at rest */
  JND_PAGE_CERTIFICATE = 4  /* writable at rest */
};

struct jnd_request {
  uint8_t operation; /* enum jnd_operation */
  uint8_t page;
  uint32_t token; /* comes back with the answer */
  uint8_t data[JND_PAGE_SIZE];
};

struct jnd_answer {
  uint8_t result; /* enum jnd_page_result */
  uint8_t page;
  uint32_t token;
  uint8_t data[JND_PAGE_SIZE];
};

enum jnd_model { JND_MODEL_RRS3 = 1, JND_MODEL_TRACKER = 2 };

enum jnd_capability {
  JND_CAN_FORCE = 1 << 0,
  JND_CAN_TILT = 1 << 1,
  JND_CAN_VIBRATE = 1 << 2,
  JND_CAN_DAMP = 1 << 3,
  JND_CAN_TRACK = 1 << 4,
  JND_HAS_BUTTONS = 1 << 5,
  JND_CAN_STORE_CALIBRATION = 1 << 6,
  JND_IS_MODEL = 1 << 7 /* a model in software: what is felt with it is no real data */
};
enum { JND_CAPABILITY_BITS = 0xFF };

enum { JND_SERIAL_SIZE = 16, JND_CALIBRATION_ID_SIZE = 16 };

struct jnd_identity {
  uint8_t lowest_version, highest_version; /* of the report protocol that it speaks */
  uint8_t model;                           /* enum jnd_model */
  uint8_t finger;                          /* enum jnd_finger that it is made for */
  uint8_t degrees_of_freedom;
  uint8_t firmware[3]; /* major, minor, patch */
  uint16_t loop_rate_hz;
  uint16_t capabilities;                        /* jnd_capability */
  char serial[JND_SERIAL_SIZE];                 /* printable ASCII, filled up with zeros */
  char calibration_id[JND_CALIBRATION_ID_SIZE]; /* the same; empty: never calibrated */
  uint32_t calibration_date;                    /* yyyymmdd; 0: never */
  uint16_t watchdog_ms;
};

struct jnd_limits {
  uint32_t most_force_un;
  uint32_t most_stiffness_mn_per_m;
  uint32_t most_force_rise_mn_per_s; /* 0.001 N/s */
  int32_t lowest_height_nm, highest_height_nm;
  uint16_t most_roll_dmrad, most_pitch_dmrad;
  uint16_t most_joint_speed_mrad_per_s;
  uint16_t least_vibration_mg, most_vibration_mg;
  uint16_t least_vibration_dhz, most_vibration_dhz;
  uint16_t most_burst_ms;
  uint16_t most_damping_cn_s_per_m;
  int16_t most_temperature_cdeg;
  uint16_t soft_start_ms;
};

struct jnd_geometry {
  uint32_t a_nm, b_nm, bh_nm, bd_nm, l1_nm, l2_nm; /* Chinello et al. 2017, section 3 */
  int32_t rest_height_nm;
};

/* The force on the finger by the sensor's own figure: straight lines between points, the first and the last drawn on.
 * Fewer than two points: as the sensor says. Both columns rise. */
enum { JND_FORCE_POINTS = 6 };
struct jnd_force_table {
  uint8_t points; /* 0, or 2..6 */
  int32_t sensor_un[JND_FORCE_POINTS];
  int32_t force_un[JND_FORCE_POINTS];
};

struct jnd_certificate {
  char calibration_id[JND_CALIBRATION_ID_SIZE];
  uint32_t date; /* yyyymmdd */
};

/* CRC-32 as of IEEE 802.3 and zlib: polynomial 0x04C11DB7 reflected, begins with and is xored by 0xFFFFFFFF. */
uint32_t jnd_crc32(const uint8_t* bytes, size_t count);

/* Encoders write all 64 (or, of pages, 52) bytes. Values out of the protocol's range are the caller's mistake: they
 * are written as they are, and a decoder refuses them. */
void jnd_encode_command(const struct jnd_command* command, uint8_t bytes[JND_REPORT_SIZE]);
void jnd_encode_telemetry(const struct jnd_telemetry* telemetry, uint8_t bytes[JND_REPORT_SIZE]);
void jnd_encode_pose(const struct jnd_pose* pose, uint8_t bytes[JND_REPORT_SIZE]);
void jnd_encode_request(const struct jnd_request* request, uint8_t bytes[JND_REPORT_SIZE]);
void jnd_encode_answer(const struct jnd_answer* answer, uint8_t bytes[JND_REPORT_SIZE]);

enum jnd_decode_result jnd_decode_command(const uint8_t* bytes, size_t count, struct jnd_command* command);
enum jnd_decode_result jnd_decode_telemetry(const uint8_t* bytes, size_t count, struct jnd_telemetry* telemetry);
enum jnd_decode_result jnd_decode_pose(const uint8_t* bytes, size_t count, struct jnd_pose* pose);
enum jnd_decode_result jnd_decode_request(const uint8_t* bytes, size_t count, struct jnd_request* request);
enum jnd_decode_result jnd_decode_answer(const uint8_t* bytes, size_t count, struct jnd_answer* answer);

/* The contents of pages: jnd_request::data and jnd_answer::data. Decoders return false for what is not allowed. */
void jnd_encode_identity(const struct jnd_identity* identity, uint8_t data[JND_PAGE_SIZE]);
void jnd_encode_limits(const struct jnd_limits* limits, uint8_t data[JND_PAGE_SIZE]);
void jnd_encode_geometry(const struct jnd_geometry* geometry, uint8_t data[JND_PAGE_SIZE]);
void jnd_encode_force_table(const struct jnd_force_table* table, uint8_t data[JND_PAGE_SIZE]);
void jnd_encode_certificate(const struct jnd_certificate* certificate, uint8_t data[JND_PAGE_SIZE]);

bool jnd_decode_identity(const uint8_t data[JND_PAGE_SIZE], struct jnd_identity* identity);
bool jnd_decode_limits(const uint8_t data[JND_PAGE_SIZE], struct jnd_limits* limits);
bool jnd_decode_geometry(const uint8_t data[JND_PAGE_SIZE], struct jnd_geometry* geometry);
bool jnd_decode_force_table(const uint8_t data[JND_PAGE_SIZE], struct jnd_force_table* table);
bool jnd_decode_certificate(const uint8_t data[JND_PAGE_SIZE], struct jnd_certificate* certificate);

#ifdef __cplusplus
}
#endif

#endif
