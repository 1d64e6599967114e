/* The firmware on the processor that it is for: the codec's vectors, and the firmware pressing a finger. Prints what it
 * finds; its exit status is 0 where all is well. */
#include <math.h>
#include <string.h>

#include "../jnd_fingertip_state.h"
#include "plant.h"
#include "semihosting.h"
#include "vectors.h"

/* As a maker would have it: nothing on a heap, nothing on the stack. */
static struct jnd_fingertip device;
static struct plant plant;
static uint32_t sequence;
static unsigned failures;

static volatile uint32_t* const systick = (uint32_t*)0xE000E010U; /* control, reload, current */
enum { SYSTICK_MOST = 0xFFFFFF, SYSTICK_ON = 5 };

static void check(const char* what, bool holds) {
  if (holds) return;
  ++failures;
  semihosting_write("FAILED: ");
  semihosting_write(what);
  semihosting_write("\n");
}

static void report(const char* what, long value, const char* unit) {
  semihosting_write(what);
  semihosting_write(": ");
  semihosting_number(value);
  semihosting_write(unit);
  semihosting_write("\n");
}

static void power_up(void) {
  struct jnd_fingertip_config config = jnd_fingertip_default_config("ARM-TEST", JND_INDEX);
  const struct jnd_hardware hardware = plant_hardware(&plant);
  check("power-up", jnd_fingertip_init(&device, &config, &hardware));
}

static void give(const struct jnd_command* command) {
  uint8_t bytes[JND_REPORT_SIZE];
  jnd_encode_command(command, bytes);
  jnd_fingertip_receive(&device, bytes, sizeof bytes);
}

static void rest(void) {
  struct jnd_command command;
  memset(&command, 0, sizeof command);
  command.sequence = ++sequence;
  give(&command);
}

static void step(void) {
  jnd_fingertip_step(&device);
  check("the platform stays in reach", plant_advance(&plant));
}

/* Half a second against 600 N/m, 2 mm deep. The force on the finger at its end, uN. */
static int32_t press(enum jnd_mode mode, int16_t roll_dmrad) {
  struct jnd_command command;
  memset(&command, 0, sizeof command);
  rest();
  step();
  for (int i = 0; i < 500; ++i) {
    const float roll = 1e-4F * (float)roll_dmrad;
    command.sequence = ++sequence;
    command.mode = (uint8_t)mode;
    command.touching = true;
    command.normal[1] = (int32_t)lroundf(-sinf(roll) * (float)JND_NORMAL_ONE);
    command.normal[2] = (int32_t)lroundf(cosf(roll) * ((float)JND_NORMAL_ONE - 64));
    command.penetration_nm = 2000000;
    command.stiffness_mn_per_m = 600000;
    command.most_force_un = 4700000;
    command.roll_dmrad = roll_dmrad;
    give(&command);
    step();
  }
  return plant.telemetry.force_un;
}

static bool about(int32_t value, int32_t expected) {
  const int32_t off = value > expected ? value - expected : expected - value;
  return off <= expected / 100;
}

static void check_forces(void) {
  const int32_t wrench = press(JND_MODE_WRENCH, 0), tilted = press(JND_MODE_WRENCH, 3000);
  const int32_t pd = press(JND_MODE_PD, 0), literal = press(JND_MODE_PD_LITERAL, 0);
  report("force of 600 N/m, 2 mm deep, in mode wrench", wrench, " uN");
  report("the same, tilted by 0.3 rad", tilted, " uN");
  report("in mode pd, against a pulp of 1000 N/m", pd, " uN");
  report("in mode pd_literal", literal, " uN");
  check("mode wrench renders f", about(wrench, 1200000));
  check("tilted too", about(tilted, 1200000));
  check("mode pd renders kS kf / (kS + kf)", about(pd, 750000));
  check("mode pd_literal is within 5 % of it", literal > 712500 && literal < 787500);
}

static void check_watchdog(void) {
  int silent = 0;
  press(JND_MODE_WRENCH, 0);
  while (silent < 100 && plant.telemetry.state == JND_STATE_ACTIVE) {
    step();
    ++silent;
  }
  report("silent until the watchdog stopped it", silent, " ms");
  check("watchdog after 20 ms", silent >= 20 && silent <= 21);
  check("it lets go",
        plant.actuation.torque_n_m[0] == 0 && plant.actuation.torque_n_m[1] == 0 && plant.actuation.torque_n_m[2] == 0);
  check("and says why", plant.telemetry.faults == JND_FAULT_WATCHDOG);
  rest();
  step();
  check("mode rest clears it", plant.telemetry.state == JND_STATE_REST && plant.telemetry.faults == 0);
}

static void check_calibration(void) {
  struct jnd_force_table table = {2, {0, 1000000}, {0, 1100000}};
  struct jnd_request request = {JND_WRITE_PAGE, JND_PAGE_FORCE_TABLE, 7, {0}};
  uint8_t bytes[JND_REPORT_SIZE];
  jnd_encode_force_table(&table, request.data);
  jnd_encode_request(&request, bytes);
  rest();
  jnd_fingertip_receive(&device, bytes, sizeof bytes);
  power_up();
  check("the calibration survives power-down", about(press(JND_MODE_WRENCH, 0), 1320000));
}

/* Of a command and a step. With `-icount shift=0` the emulator's clock of 25 MHz ticks once in 40 instructions. */
static uint32_t ticks_of_step(void) {
  struct jnd_command command = device.command;
  command.sequence = ++sequence;
  systick[0] = 0;
  systick[1] = SYSTICK_MOST;
  systick[2] = 0;
  systick[0] = SYSTICK_ON;
  give(&command);
  jnd_fingertip_step(&device);
  return SYSTICK_MOST - systick[2];
}

static void report_ticks(const char* what, uint32_t ticks, uint32_t most) {
  if (ticks > 100000) { /* the emulator's clock is then the host's */
    semihosting_write("not timed: that needs -icount shift=0\n");
    return;
  }
  report(what, (long)ticks * 40, " instructions");
  check("a step is in time", ticks <= most);
}

static void time_steps(enum jnd_mode mode, const char* what) {
  enum { STEPS = 100 };
  uint32_t ticks = 0;
  press(mode, 1000);
  for (int i = 0; i < STEPS; ++i) {
    ticks += ticks_of_step();
    check("the platform stays in reach", plant_advance(&plant));
  }
  report_ticks(what, ticks / STEPS, 500); /* 20000 instructions: a fifth of a millisecond of 100 MHz */
}

/* Joints that jump elsewhere while force is given, where no pose may be found: the search must end soon. */
static void time_lost_poses(void) {
  uint32_t most = 0;
  const struct jnd_sensors healthy = plant.sensors;
  for (int i = 0; i < 64; ++i) {
    plant.sensors = healthy;
    press(JND_MODE_WRENCH, 0);
    for (int leg = 0; leg < 3; ++leg)
      plant.sensors.joint_rad[leg] = -1.5F + (float)(i >> (2 * leg) & 3); /* -1.5, -0.5, 0.5, 1.5 */
    const uint32_t ticks = ticks_of_step();
    if (ticks > most) most = ticks;
  }
  report_ticks("at most, where the joints stand for no pose", most, 2500); /* a millisecond of 100 MHz */
}

int main(void) {
  const unsigned failed = check_vectors();
  report("vectors", (long)vectors_count, "");
  report("of which fail", (long)failed, "");
  check("vectors are there", vectors_count > 100);
  failures += failed;
  plant_begin(&plant,
              &(const struct jnd_geometry){6000000, 10000000, 5000000, 17320508, 12000000, 20000000, -20000000});
  power_up();
  check_forces();
  check_watchdog();
  check_calibration();
  check("every report is one of the protocol's", plant.damaged == 0 && plant.told > 3000);
  time_steps(JND_MODE_WRENCH, "a command and a step in mode wrench");
  time_steps(JND_MODE_PD_LITERAL, "in mode pd_literal");
  time_lost_poses();
  report("memory of a device", (long)sizeof device, " bytes");
  report("stack at its deepest", (long)stack_used(), " bytes");
  semihosting_write(failures == 0 ? "PASSED\n" : "NOT PASSED\n");
  return failures == 0 ? 0 : 1;
}
