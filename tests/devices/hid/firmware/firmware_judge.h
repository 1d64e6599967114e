// The judge of what the firmware asks of its actuators: keeps its own books of what was accepted, knows the torques'
// effect from the C++ model, and fails a rapidcheck property at the first actuation that the device's limits forbid.
#pragma once

#include <algorithm>
#include <cmath>

#include <rapidcheck.h>

#include "devices/rrs3/rrs3_kinematics.h"
#include "devices/rrs3/rrs3_statics.h"
#include "tests/devices/hid/firmware/firmware_fixtures.h"

namespace jnd::testing {

class Judge {
 public:
  explicit Judge(Board& board) : board_(board), limits_(board.config.limits) {
    board.watch = [this](const jnd_actuation& actuation) { judge(actuation); };
  }

  // Hands over a report and notes what the protocol says about it.
  void give(const std::uint8_t* bytes, std::size_t count) {
    jnd_command command{};
    const bool decoded = jnd_decode_command(bytes, count, &command) == JND_DECODE_OK;
    const std::uint32_t ahead = command.sequence - last_;
    const bool rest = command.mode == JND_MODE_REST;
    if (decoded && (rest || (ahead != 0 && ahead < 0x80000000U))) {
      last_ = command.sequence;
      accepted_us_ = board_.now_us;
      commanded_ = true;
      if (rest) {
        rested_us_ = board_.now_us;
        envelope_n_ = 0;
      }
      resting_ = rest;
      command_ = command;
    }
    board_.give(bytes, count);
  }
  void step(std::uint64_t elapsed_us) {
    const std::uint64_t before = stepped_us_;
    stepped_us_ = board_.now_us + elapsed_us;
    const double elapsed_s = before == 0 || stepped_us_ < before ? 0 : 1e-6 * static_cast<double>(stepped_us_ - before);
    envelope_n_ =
        std::min(envelope_n_ + 1e-3 * limits_.most_force_rise_mn_per_s * elapsed_s, 1e-6 * limits_.most_force_un);
    if (!command_.touching) envelope_n_ = 0;
    stepping_ = true;
    board_.step(elapsed_us);
    stepping_ = false;
    for (const ReportBytes& report : board_.sent) judge(report);
  }
  std::uint32_t last() const { return last_; }
  long pressed() const { return pressed_; }
  long buzzed() const { return buzzed_; }
  double hardest_n() const { return hardest_n_; }
  double largest_n_m() const { return largest_n_m_; }

 private:
  void judge(const jnd_actuation& actuation) {
    const double all[] = {actuation.torque_n_m[0], actuation.torque_n_m[1], actuation.torque_n_m[2],
                          actuation.hold_n_per_m,  actuation.roll_rad,      actuation.pitch_rad,
                          actuation.joint_rad[0],  actuation.joint_rad[1],  actuation.joint_rad[2],
                          actuation.vibration_g,   actuation.vibration_hz};
    for (const double number : all) RC_ASSERT(std::isfinite(number));
    RC_ASSERT(std::abs(actuation.roll_rad) <= 1e-4 * limits_.most_roll_dmrad + 1e-6);
    RC_ASSERT(std::abs(actuation.pitch_rad) <= 1e-4 * limits_.most_pitch_dmrad + 1e-6);
    RC_ASSERT(actuation.hold_n_per_m >= 0);
    RC_ASSERT(actuation.hold_n_per_m <= 1e-3 * limits_.most_stiffness_mn_per_m * (1 + 1e-6));
    const bool quiet = lets_go(actuation);
    // Only in a step, only for a host that has just spoken, and never after mode rest.
    const std::uint64_t age = board_.now_us - accepted_us_;
    if (!stepping_ || !commanded_ || resting_ || age >= std::uint64_t{1000} * board_.config.identity.watchdog_ms)
      RC_ASSERT(quiet);
    judge_vibration(actuation);
    judge_force(actuation);
  }
  void judge_vibration(const jnd_actuation& actuation) {
    if (actuation.vibration_g == 0) {
      buzzing_ = false;
      return;
    }
    ++buzzed_;
    if (!buzzing_) buzz_us_ = board_.now_us;
    buzzing_ = true;
    RC_ASSERT(actuation.vibration_g >= 1e-3 * limits_.least_vibration_mg - 1e-6);
    RC_ASSERT(actuation.vibration_g <= 1e-3 * limits_.most_vibration_mg + 1e-6);
    RC_ASSERT(actuation.vibration_hz >= 0.1 * limits_.least_vibration_dhz - 1e-3);
    RC_ASSERT(actuation.vibration_hz <= 0.1 * limits_.most_vibration_dhz + 1e-3);
    RC_ASSERT(board_.now_us - buzz_us_ < std::uint64_t{1000} * limits_.most_burst_ms);
  }
  void judge_force(const jnd_actuation& actuation) {
    const Eigen::Vector3d torques(actuation.torque_n_m[0], actuation.torque_n_m[1], actuation.torque_n_m[2]);
    if (torques.isZero(0)) {
      if (actuation.hold_n_per_m == 0) envelope_n_ = 0;
      return;
    }
    ++pressed_;
    // Where the platform really is, by the model; it must be in its range.
    const jnd_coordinates& near = board_.device.here.xi;
    const Eigen::Vector3d q(board_.sensors.joint_rad[0], board_.sensors.joint_rad[1], board_.sensors.joint_rad[2]);
    const auto xi = forward_kinematics(board_.model, q,
                                       {.pz_m = near.pz_m, .roll_rad = near.roll_rad, .pitch_rad = near.pitch_rad});
    RC_ASSERT(xi.has_value());
    RC_ASSERT(xi->pz_m >= 1e-9 * limits_.lowest_height_nm - 3e-6);
    RC_ASSERT(xi->pz_m <= 1e-9 * limits_.highest_height_nm + 3e-6);
    const auto at = board_.model.configuration(*xi);
    const auto rates = board_.model.differential(*at);
    RC_ASSERT(rates.has_value());
    const double force = force_along(*rates, torques, at->rotation.col(2));
    hardest_n_ = std::max(hardest_n_, force);
    // The cap; the host's own; the soft start, which cannot have begun before the last mode rest; the rise, from zero.
    const double cap = 1e-6 * limits_.most_force_un;
    const double soft = cap * static_cast<double>(board_.now_us - rested_us_) / (1000.0 * limits_.soft_start_ms);
    const double most = std::min({cap, 1e-6 * command_.most_force_un, soft, envelope_n_});
    RC_ASSERT(force <= most * (1 + 1e-3) + 1e-5);
    RC_ASSERT(force >= -cap * (1 + 1e-3));
    RC_ASSERT(command_.touching);
    largest_n_m_ = std::max(largest_n_m_, torques.cwiseAbs().maxCoeff());
    RC_ASSERT(torques.cwiseAbs().maxCoeff() < kLargestTorque_n_m);
  }
  void judge(const ReportBytes& report) const {
    jnd_telemetry telemetry{};
    jnd_answer answer{};
    RC_ASSERT(jnd_decode_telemetry(report.data(), report.size(), &telemetry) == JND_DECODE_OK ||
              jnd_decode_answer(report.data(), report.size(), &answer) == JND_DECODE_OK);
    if (report[0] != JND_REPORT_TELEMETRY) return;
    RC_ASSERT(telemetry.command_sequence == (commanded_ ? last_ : 0));
    if (telemetry.state != JND_STATE_ACTIVE || telemetry.faults != 0) RC_ASSERT(lets_go(board_.given));
    if (telemetry.state == JND_STATE_ACTIVE) RC_ASSERT(telemetry.faults == 0);
  }

  // Twice what the worst of 20000 runs took: a pose near a singularity would ask for any amount.
  static constexpr double kLargestTorque_n_m = 0.12;

  Board& board_;
  const jnd_limits& limits_;
  jnd_command command_{};
  std::uint32_t last_ = 0;
  bool commanded_ = false, resting_ = true, stepping_ = false, buzzing_ = false;
  std::uint64_t accepted_us_ = 0, rested_us_ = 0, stepped_us_ = 0, buzz_us_ = 0;
  double envelope_n_ = 0;
  long pressed_ = 0, buzzed_ = 0;
  double hardest_n_ = 0, largest_n_m_ = 0;
};

}  // namespace jnd::testing
