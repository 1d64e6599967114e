/* The device of Chinello et al. 2017, as devices/specs/rrs3.json. */
#include <string.h>

#include "jnd_fingertip.h"

struct jnd_fingertip_config jnd_fingertip_default_config(const char* serial, enum jnd_finger finger) {
  struct jnd_fingertip_config config;
  memset(&config, 0, sizeof config);
  struct jnd_identity* identity = &config.identity;
  identity->lowest_version = identity->highest_version = JND_PROTOCOL_VERSION;
  identity->model = JND_MODEL_RRS3;
  identity->finger = (uint8_t)finger;
  identity->degrees_of_freedom = 3;
  identity->firmware[0] = 1;
  identity->loop_rate_hz = 1000;
  identity->capabilities =
      JND_CAN_FORCE | JND_CAN_TILT | JND_CAN_VIBRATE | JND_CAN_DAMP | JND_HAS_BUTTONS | JND_CAN_STORE_CALIBRATION;
  for (size_t i = 0; i < JND_SERIAL_SIZE && serial[i] != 0; ++i) identity->serial[i] = serial[i];
  identity->watchdog_ms = 20;

  struct jnd_limits* limits = &config.limits;
  limits->most_force_un = 4700000;
  limits->most_stiffness_mn_per_m = 2000000;
  limits->most_force_rise_mn_per_s = 500000; /* twice the host's, so that a late pair of commands is not clipped */
  limits->lowest_height_nm = -27500000;
  limits->highest_height_nm = -12500000;
  limits->most_roll_dmrad = 6283;  /* 36 degrees */
  limits->most_pitch_dmrad = 5236; /* 30 degrees */
  limits->most_joint_speed_mrad_per_s = 10472;
  limits->least_vibration_mg = 50;
  limits->most_vibration_mg = 1000;
  limits->least_vibration_dhz = 500;
  limits->most_vibration_dhz = 2400;
  limits->most_burst_ms = 250;            /* the host's own limit is 200 ms */
  limits->most_damping_cn_s_per_m = 5000; /* the most that a protocol can ask */
  limits->most_temperature_cdeg = 6000;
  limits->soft_start_ms = 200;

  struct jnd_geometry* geometry = &config.geometry;
  geometry->a_nm = 6000000;
  geometry->b_nm = 10000000;
  geometry->bh_nm = 5000000;
  geometry->bd_nm = 17320508;
  geometry->l1_nm = 12000000;
  geometry->l2_nm = 20000000;
  geometry->rest_height_nm = -20000000;
  return config;
}
