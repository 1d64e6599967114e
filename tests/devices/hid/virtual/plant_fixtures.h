// What the tests of the plant share: the shipped 3RRS device and the firmware on its model board.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <unistd.h>

#include "devices/hid/firmware/jnd_fingertip_state.h"
#include "devices/hid/virtual/plant_hardware.h"
#include "devices/hid/virtual/virtual_device.h"
#include "protocols/rigs/device_description.h"

namespace jnd::testing {

inline DeviceSpec plant_rrs3() {
  return load_device_spec(std::filesystem::path(JND_SOURCE_DIR) / "devices/specs/rrs3.json");
}

using Report = std::array<std::uint8_t, JND_REPORT_SIZE>;

inline Report report_of(const jnd_command& command) {
  Report bytes{};
  jnd_encode_command(&command, bytes.data());
  return bytes;
}

inline jnd_command press_command(std::uint32_t sequence, double stiffness_n_per_m, double depth_m) {
  jnd_command command{};
  command.sequence = sequence;
  command.mode = JND_MODE_WRENCH;
  command.touching = true;
  command.normal[2] = JND_NORMAL_ONE;
  command.penetration_nm = static_cast<std::uint32_t>(1e9 * depth_m + 0.5);
  command.stiffness_mn_per_m = static_cast<std::uint32_t>(1e3 * stiffness_n_per_m + 0.5);
  command.most_force_un = 4'700'000;
  return command;
}

// The firmware on the board, without a cable: a step acts first and the plant then moves, as in Rrs3Device.
struct FirmwareOnPlant {
  explicit FirmwareOnPlant(double pulp_n_per_m = 1000)
      : config(jnd_fingertip_default_config("TEST-1", JND_INDEX)),
        board(plant_spec_of(config), pulp_n_per_m, [this](std::span<const std::uint8_t, JND_REPORT_SIZE> report) {
          (void)jnd_decode_telemetry(report.data(), report.size(), &telemetry);
          return true;
        }) {
    const jnd_hardware functions = board.functions();
    sound = jnd_fingertip_init(&firmware, &config, &functions);
  }
  FirmwareOnPlant(const FirmwareOnPlant&) = delete;
  FirmwareOnPlant& operator=(const FirmwareOnPlant&) = delete;

  void receive(const jnd_command& command) {
    const Report bytes = report_of(command);
    jnd_fingertip_receive(&firmware, bytes.data(), bytes.size());
  }
  void step() {
    jnd_fingertip_step(&firmware);
    board.advance();
    time_us += 1000;
    board.set_time_us(time_us);
  }

  jnd_fingertip_config config;
  jnd_telemetry telemetry{};
  PlantHardware board;
  jnd_fingertip firmware{};
  std::uint64_t time_us = 0;
  bool sound = false;
};

// A cable that keeps what comes.
struct Cable {
  std::vector<std::vector<std::uint8_t>> reports;
  bool open = true;
  InputReport end() {
    return [this](std::span<const std::uint8_t> report) {
      if (open) reports.emplace_back(report.begin(), report.end());
      return open;
    };
  }
  template <typename Record, typename Decode>
  std::vector<Record> decoded(std::uint8_t id, Decode decode) const {
    std::vector<Record> records;
    for (const auto& report : reports) {
      Record record{};
      if (report[0] == id && decode(report.data(), report.size(), &record) == JND_DECODE_OK) records.push_back(record);
    }
    return records;
  }
  std::vector<jnd_telemetry> telemetry() const {
    return decoded<jnd_telemetry>(JND_REPORT_TELEMETRY, jnd_decode_telemetry);
  }
  std::vector<jnd_pose> poses() const { return decoded<jnd_pose>(JND_REPORT_TRACKER, jnd_decode_pose); }
  std::vector<jnd_answer> answers() const { return decoded<jnd_answer>(JND_REPORT_PAGE, jnd_decode_answer); }
};

// A folder that is gone afterwards.
struct TemporaryFolder {
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "jnd-plant-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::filesystem::path path;
};

}  // namespace jnd::testing
