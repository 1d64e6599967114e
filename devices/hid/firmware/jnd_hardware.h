/* What a board has to offer to the fingertip firmware: the one file to fill in for new hardware. */
#ifndef JND_HARDWARE_H
#define JND_HARDWARE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct jnd_sensors {
  float joint_rad[3];      /* of the three actuated joints, as in devices/rrs3/rrs3_kinematics.h */
  float force_n;           /* on the finger, by the sensor's own figure, before calibration */
  float vibration_g;       /* amplitude that the motor runs at */
  float temperature_c;     /* of the warmest part; NAN: not measured */
  uint8_t battery_percent; /* 0..100; 255: runs on the cable */
  uint8_t buttons;         /* bit 0..7, 1 = pressed */
  bool stop_button;
  bool ok; /* every sensor answered */
};

struct jnd_actuation {
  float torque_n_m[3];       /* of the joints, for the force */
  float hold_n_per_m;        /* above 0: the servos hold the platform's position with this gain along its normal */
  float roll_rad, pitch_rad; /* how the platform should lie */
  float joint_rad[3];        /* the same as joint angles, at the present height */
  float vibration_g, vibration_hz; /* 0: off */
};

/* Called from jnd_fingertip_step and jnd_fingertip_receive only (load: from jnd_fingertip_init), with `context` as
 * given here. load and store may be null where there is no memory: what is written is then refused. */
struct jnd_hardware {
  void* context;
  uint64_t (*time_us)(void* context); /* since power-up, never backwards */
  void (*read)(void* context, struct jnd_sensors* sensors);
  void (*actuate)(void* context, const struct jnd_actuation* actuation); /* at once; all zero, joints too: let go */
  bool (*send)(void* context, const uint8_t report[64]);                 /* an input report; false: no room */
  bool (*load)(void* context, void* bytes, size_t count);                /* what store kept; false: nothing yet */
  bool (*store)(void* context, const void* bytes, size_t count);         /* survives power-down; may take long */
};

#ifdef __cplusplus
}
#endif

#endif
