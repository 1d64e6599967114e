// A board for the fingertip firmware: its clock, sensors, memory and USB are what the test says, and everything that it
// does is kept.
#pragma once

#include <array>
#include <cstring>
#include <functional>
#include <optional>
#include <vector>

#include "devices/hid/firmware/jnd_fingertip_state.h"
#include "devices/rrs3/rrs3_kinematics.h"

namespace jnd::testing {

using ReportBytes = std::array<std::uint8_t, JND_REPORT_SIZE>;

// The C++ model with the lengths of the pages, which are whole nanometres.
inline Rrs3Kinematics model_of(const jnd_geometry& geometry) {
  return Rrs3Kinematics({.a_m = 1e-9 * geometry.a_nm,
                         .b_m = 1e-9 * geometry.b_nm,
                         .bh_m = 1e-9 * geometry.bh_nm,
                         .bd_m = 1e-9 * geometry.bd_nm,
                         .l1_m = 1e-9 * geometry.l1_nm,
                         .l2_m = 1e-9 * geometry.l2_nm,
                         .rest_z_m = 1e-9 * geometry.rest_height_nm});
}

inline std::optional<Eigen::Vector3d> joints_at(const Rrs3Kinematics& model, const Rrs3Coordinates& xi) {
  const auto at = model.configuration(xi);
  if (!at) return std::nullopt;
  return model.joint_angles(*at);
}

inline jnd_sensors sensors_at(const Eigen::Vector3d& joints) {
  jnd_sensors sensors{};
  for (int leg = 0; leg < 3; ++leg) sensors.joint_rad[leg] = static_cast<float>(joints[leg]);
  sensors.temperature_c = 30;
  sensors.battery_percent = 80;
  sensors.ok = true;
  return sensors;
}

inline bool lets_go(const jnd_actuation& actuation) {
  return actuation.torque_n_m[0] == 0 && actuation.torque_n_m[1] == 0 && actuation.torque_n_m[2] == 0 &&
         actuation.hold_n_per_m == 0 && actuation.vibration_g == 0;
}

// A command of the wrench mode that presses straight up.
inline jnd_command pressing(std::uint32_t sequence, double stiffness_n_per_m = 600, double penetration_m = 0.002) {
  jnd_command command{};
  command.sequence = sequence;
  command.mode = JND_MODE_WRENCH;
  command.touching = true;
  command.normal[2] = JND_NORMAL_ONE;
  command.penetration_nm = static_cast<std::uint32_t>(penetration_m * 1e9);
  command.stiffness_mn_per_m = static_cast<std::uint32_t>(stiffness_n_per_m * 1e3);
  command.most_force_un = 10'000'000;
  return command;
}

class Board {
 public:
  explicit Board(const jnd_fingertip_config& config = jnd_fingertip_default_config("TEST-1", JND_INDEX))
      : config(config), model(model_of(config.geometry)) {
    sensors = sensors_at(*joints_at(model, {.pz_m = model.geometry().rest_z_m}));
  }
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  bool power_up() {
    const jnd_hardware hardware{.context = this,
                                .time_us = [](void* self) { return static_cast<Board*>(self)->now_us; },
                                .read = [](void* self, jnd_sensors* out) { *out = static_cast<Board*>(self)->sensors; },
                                .actuate = actuate,
                                .send = send,
                                .load = load,
                                .store = store};
    return jnd_fingertip_init(&device, &config, &hardware);
  }

  void give(const std::uint8_t* bytes, std::size_t count) { jnd_fingertip_receive(&device, bytes, count); }
  void give(const ReportBytes& bytes) { give(bytes.data(), bytes.size()); }
  void give(const jnd_command& command) {
    ReportBytes bytes{};
    jnd_encode_command(&command, bytes.data());
    give(bytes);
  }
  void give_rest(std::uint32_t sequence) {
    jnd_command command{};
    command.sequence = sequence;
    give(command);
  }
  // The answer to a request, if one came at once.
  std::optional<jnd_answer> ask(std::uint8_t page, const std::uint8_t* write = nullptr) {
    jnd_request request{};
    request.operation = write != nullptr ? JND_WRITE_PAGE : JND_READ_PAGE;
    request.page = page;
    request.token = ++token;
    if (write != nullptr) std::memcpy(request.data, write, JND_PAGE_SIZE);
    ReportBytes bytes{};
    jnd_encode_request(&request, bytes.data());
    sent.clear();
    give(bytes);
    return last_answer();
  }
  std::optional<jnd_answer> last_answer() const {
    jnd_answer answer{};
    for (const ReportBytes& report : sent)
      if (jnd_decode_answer(report.data(), report.size(), &answer) == JND_DECODE_OK) return answer;
    return std::nullopt;
  }

  // One step, after so much time; the telemetry that it sent, or nothing where there was no room.
  std::optional<jnd_telemetry> step(std::uint64_t elapsed_us = 1000) {
    now_us += elapsed_us;
    sent.clear();
    jnd_fingertip_step(&device);
    jnd_telemetry telemetry{};
    for (const ReportBytes& report : sent)
      if (jnd_decode_telemetry(report.data(), report.size(), &telemetry) == JND_DECODE_OK) return telemetry;
    return std::nullopt;
  }

  // The platform lies there from now on.
  void place(const Rrs3Coordinates& xi) { sensors = sensors_at(*joints_at(model, xi)); }

  jnd_fingertip_config config;
  Rrs3Kinematics model;
  jnd_fingertip device{};
  std::uint64_t now_us = 5'000'000;
  jnd_sensors sensors{};
  jnd_actuation given{};
  int actuations = 0;
  std::function<void(const jnd_actuation&)> watch{};  // every actuation, as it happens
  std::vector<ReportBytes> sent{};                    // since the last step began
  bool room = true;                                   // for reports
  std::vector<std::uint8_t> memory{};
  bool memory_works = true;
  int stored = 0;
  std::uint32_t token = 0;

 private:
  static void actuate(void* self, const jnd_actuation* actuation) {
    Board& board = *static_cast<Board*>(self);
    board.given = *actuation;
    ++board.actuations;
    if (board.watch) board.watch(*actuation);
  }
  static bool send(void* self, const std::uint8_t report[64]) {
    Board& board = *static_cast<Board*>(self);
    if (!board.room) return false;
    ReportBytes bytes{};
    std::memcpy(bytes.data(), report, bytes.size());
    board.sent.push_back(bytes);
    return true;
  }
  static bool load(void* self, void* bytes, std::size_t count) {
    const Board& board = *static_cast<Board*>(self);
    if (board.memory.size() != count) return false;
    std::memcpy(bytes, board.memory.data(), count);
    return true;
  }
  static bool store(void* self, const void* bytes, std::size_t count) {
    Board& board = *static_cast<Board*>(self);
    if (!board.memory_works) return false;
    const auto* first = static_cast<const std::uint8_t*>(bytes);
    board.memory.assign(first, first + count);
    ++board.stored;
    return true;
  }
};

}  // namespace jnd::testing
