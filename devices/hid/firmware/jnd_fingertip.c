#include "jnd_fingertip.h"

#include <math.h>
#include <string.h>

#include "jnd_fingertip_state.h"
#include "jnd_forward.h"
#include "jnd_pages.h"

/* Slack of the platform's range: one that rests on its stop is inside, with the rounding of single precision. */
static const float height_slack_m = 2e-6F;
/* The platform may lie so far beyond its largest tilt, as it does where the finger twists it; further out torques are
 * not to be trusted. */
static const float tilt_slack_rad = 0.05F;

/* -- actuation --------------------------------------------------------------------------------------------------- */

static void let_go(struct jnd_fingertip* self) {
  struct jnd_actuation none;
  memset(&none, 0, sizeof none);
  self->force_n = 0;
  self->hardware.actuate(self->hardware.context, &none);
}

/* No force, the platform to its rest pose. */
static void rest(struct jnd_fingertip* self) {
  struct jnd_actuation out;
  memset(&out, 0, sizeof out);
  for (int leg = 0; leg < 3; ++leg) out.joint_rad[leg] = self->rest_joint_rad[leg];
  self->force_n = 0;
  self->hardware.actuate(self->hardware.context, &out);
}

static void stop(struct jnd_fingertip* self, uint16_t faults) {
  self->faults = (uint16_t)(self->faults | faults);
  self->state = JND_STATE_STOPPED;
  let_go(self);
}

static bool in_workspace(const struct jnd_fingertip* self) {
  const struct jnd_coordinates* xi = &self->here.xi;
  return xi->pz_m >= self->own.lowest_m - height_slack_m && xi->pz_m <= self->own.highest_m + height_slack_m &&
         fabsf(xi->roll_rad) <= self->own.most_roll_rad + tilt_slack_rad &&
         fabsf(xi->pitch_rad) <= self->own.most_pitch_rad + tilt_slack_rad;
}

static void act(struct jnd_fingertip* self, uint64_t now_us, float elapsed_s) {
  struct jnd_actuation out;
  struct jnd_target target;
  const struct jnd_law_input input = {self->force_n, elapsed_s, now_us - self->active_us, in_workspace(self)};
  memset(&out, 0, sizeof out);
  memset(&target, 0, sizeof target);
  target.mode = (enum jnd_mode)self->command.mode;
  target.most_pull_n = self->own.most_force_n;
  target.most_moment_n_m = self->own.most_force_n * self->linkage.b_m; /* the largest force at the platform's edge */
  jnd_law_tilt(&self->own, &self->command, &target.roll_rad, &target.pitch_rad, &self->limits);
  target.force_n = jnd_law_force(&self->own, &self->command, &input, &self->limits);
  if (target.force_n > 0) {
    target.stiffness_n_per_m = jnd_law_stiffness(&self->own, &self->command, &self->limits);
    jnd_law_normal(&self->command, target.normal, &self->limits);
    jnd_render(&self->linkage, &self->here, &target, &out);
  }
  out.roll_rad = target.roll_rad;
  out.pitch_rad = target.pitch_rad;
  if (!jnd_tilted_joints(&self->linkage, &self->here, target.roll_rad, target.pitch_rad, out.joint_rad))
    self->limits |= JND_LIMIT_TILT;
  jnd_burst_step(&self->burst, &self->own, &self->command, now_us, &out.vibration_g, &out.vibration_hz, &self->limits);
  if (!isfinite(out.torque_n_m[0]) || !isfinite(out.torque_n_m[1]) || !isfinite(out.torque_n_m[2])) {
    stop(self, JND_FAULT_INTERNAL);
    return;
  }
  self->force_n = target.force_n;
  self->hardware.actuate(self->hardware.context, &out);
}

/* -- power-up ---------------------------------------------------------------------------------------------------- */

/* Whether the pages that a host would read hold together. */
static bool pages_hold(const struct jnd_fingertip_config* config) {
  uint8_t data[JND_PAGE_SIZE];
  struct jnd_identity identity;
  struct jnd_limits limits;
  struct jnd_geometry geometry;
  jnd_encode_identity(&config->identity, data);
  if (!jnd_decode_identity(data, &identity) || identity.watchdog_ms == 0) return false;
  jnd_encode_limits(&config->limits, data);
  if (!jnd_decode_limits(data, &limits)) return false;
  jnd_encode_geometry(&config->geometry, data);
  return jnd_decode_geometry(data, &geometry);
}

/* The rest pose, which every device must be able to hold. */
static bool rest_pose(const struct jnd_linkage* linkage, struct jnd_here* here) {
  here->xi.pz_m = linkage->rest_z_m;
  here->xi.roll_rad = here->xi.pitch_rad = 0;
  return jnd_configuration_at(linkage, &here->xi, &here->configuration) &&
         jnd_differential_at(linkage, &here->configuration, &here->differential);
}

bool jnd_fingertip_init(struct jnd_fingertip* self, const struct jnd_fingertip_config* config,
                        const struct jnd_hardware* hardware) {
  memset(self, 0, sizeof *self);
  self->config = *config;
  self->hardware = *hardware;
  self->own = jnd_own_limits_of(&config->limits, config->identity.watchdog_ms);
  self->linkage = jnd_linkage_of(&config->geometry);
  self->sensors.temperature_c = NAN;
  self->sensors.battery_percent = JND_BATTERY_NONE;
  jnd_calibration_load(&self->calibration, hardware);
  self->sound = pages_hold(config) && rest_pose(&self->linkage, &self->here);
  if (!self->sound) {
    memset(&self->here, 0, sizeof self->here);
    self->state = JND_STATE_STOPPED;
    self->faults = self->standing = JND_FAULT_INTERNAL;
    return false;
  }
  jnd_joint_angles(&self->here.configuration, self->rest_joint_rad);
  self->state = JND_STATE_REST;
  return true;
}

/* -- what comes -------------------------------------------------------------------------------------------------- */

static bool overdue(const struct jnd_fingertip* self, uint64_t now_us) {
  return self->state == JND_STATE_ACTIVE && now_us - self->command_us >= self->own.watchdog_us;
}

static void go_to_rest(struct jnd_fingertip* self) {
  self->faults = self->standing; /* what is still the case is not cleared */
  if (!self->sound || self->state == JND_STATE_REST) return;
  self->state = JND_STATE_REST;
  rest(self);
}

static void take_command(struct jnd_fingertip* self, const struct jnd_command* command, uint64_t now_us) {
  /* The difference of serial numbers, without relying on the conversion of large unsigned ones. */
  const uint32_t newer = command->sequence - self->command.sequence;
  const bool resting = command->mode == JND_MODE_REST;
  if (!resting && (newer == 0 || newer > (uint32_t)INT32_MAX)) {
    ++self->rejected;
    return;
  }
  self->command = *command;
  self->command_us = now_us;
  self->commanded = true;
  jnd_burst_command(&self->burst, command);
  if (resting) {
    go_to_rest(self);
  } else if (self->state == JND_STATE_REST && self->faults == 0) {
    self->state = JND_STATE_ACTIVE;
    self->active_us = now_us;
  }
}

static void take_request(struct jnd_fingertip* self, const struct jnd_request* request) {
  struct jnd_answer answer;
  jnd_answer_request(&self->config, &self->hardware, &self->calibration, self->state == JND_STATE_REST, request,
                     &answer);
  jnd_encode_answer(&answer, self->answer);
  self->answer_waits = !self->hardware.send(self->hardware.context, self->answer);
}

void jnd_fingertip_receive(struct jnd_fingertip* self, const uint8_t* bytes, size_t count) {
  const uint64_t now_us = self->hardware.time_us(self->hardware.context);
  struct jnd_command command;
  struct jnd_request request;
  if (count == 0) return;
  /* Where the loop itself was held up: a command that comes too late does not revive the old force. */
  if (overdue(self, now_us)) stop(self, JND_FAULT_WATCHDOG);
  if (bytes[0] == JND_REPORT_REQUEST) {
    if (jnd_decode_request(bytes, count, &request) == JND_DECODE_OK) take_request(self, &request);
  } else if (bytes[0] == JND_REPORT_COMMAND) {
    if (jnd_decode_command(bytes, count, &command) == JND_DECODE_OK)
      take_command(self, &command, now_us);
    else
      ++self->rejected;
  }
}

/* -- each step --------------------------------------------------------------------------------------------------- */

/* Where the platform is. False where its joints stand for no pose that can be reached from the last one. */
static bool locate(struct jnd_fingertip* self) {
  const float* joint_rad = self->sensors.joint_rad;
  struct jnd_here* here = &self->here;
  struct jnd_here again;
  if (jnd_forward(&self->linkage, joint_rad, &here->xi, &here->configuration, &here->differential)) return true;
  /* A platform that force rests on cannot have gone elsewhere within a step; any other is looked for from rest. */
  if (self->state == JND_STATE_ACTIVE || !rest_pose(&self->linkage, &again)) return false;
  if (!jnd_forward(&self->linkage, joint_rad, &again.xi, &again.configuration, &again.differential)) return false;
  *here = again;
  return true;
}

static void sense(struct jnd_fingertip* self) {
  struct jnd_sensors sensors;
  memset(&sensors, 0, sizeof sensors);
  self->hardware.read(self->hardware.context, &sensors);
  uint16_t faults = jnd_sensor_faults(&self->own, &sensors);
  const bool plausible = (faults & JND_FAULT_SENSOR) == 0;
  if (!plausible) { /* tell the last figures that were some; buttons and battery have no other sensor to doubt */
    for (int leg = 0; leg < 3; ++leg) sensors.joint_rad[leg] = self->sensors.joint_rad[leg];
    sensors.force_n = self->sensors.force_n;
    sensors.vibration_g = self->sensors.vibration_g;
    if (sensors.battery_percent > 100) sensors.battery_percent = JND_BATTERY_NONE;
  }
  self->sensors = sensors;
  if (!self->sound || (plausible && !locate(self))) faults |= JND_FAULT_INTERNAL;
  self->standing = faults;
  self->faults = (uint16_t)(self->faults | faults);
}

static void tell(struct jnd_fingertip* self) {
  uint8_t report[JND_REPORT_SIZE];
  if (self->answer_waits) self->answer_waits = !self->hardware.send(self->hardware.context, self->answer);
  ++self->sequence; /* also where there is no room: the host sees the gap */
  const struct jnd_telemetry telemetry = jnd_telemetry_of(self);
  jnd_encode_telemetry(&telemetry, report);
  self->hardware.send(self->hardware.context, report);
}

void jnd_fingertip_step(struct jnd_fingertip* self) {
  const uint64_t now_us = self->hardware.time_us(self->hardware.context);
  const bool backwards = self->stepped && now_us < self->step_us;
  const uint64_t since_us = self->stepped ? now_us - self->step_us : 0;
  /* A loop that was held up for longer than the watchdog's time gains nothing by it. */
  const uint32_t elapsed_us = since_us < self->own.watchdog_us ? (uint32_t)since_us : self->own.watchdog_us;
  self->step_us = now_us;
  self->stepped = true;
  self->limits = 0;
  sense(self);
  if (backwards) self->faults |= JND_FAULT_INTERNAL; /* a clock that no watchdog can rest on */
  if (overdue(self, now_us)) self->faults |= JND_FAULT_WATCHDOG;
  if (self->state == JND_STATE_ACTIVE && self->faults != 0)
    stop(self, 0);
  else if (self->state == JND_STATE_STOPPED)
    let_go(self);
  else if (self->state == JND_STATE_REST)
    rest(self);
  else
    act(self, now_us, (float)elapsed_us * 1e-6F);
  tell(self);
}
