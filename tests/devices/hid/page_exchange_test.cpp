// Pages read from and written to the firmware, over a handle that loses and spoils reports.
#include "devices/hid/page_exchange.h"

#include "devices/device_error.h"
#include "devices/hid/report_words.h"
#include "tests/catch.h"
#include "tests/devices/hid/bench/bench_firmware.h"

using namespace jnd;
using jnd::testing::BenchFirmware;
using jnd::testing::HidReport;

namespace {

constexpr PagePatience kQuick{.read_ms = 20, .write_ms = 20, .tries = 3};

template <typename Act>
std::string message_of(const Act& act) {
  try {
    act();
  } catch (const DeviceError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

jnd_force_table three_points() {
  jnd_force_table table{};
  table.points = 3;
  for (int i = 0; i < 3; ++i) {
    table.sensor_un[i] = 1'000'000 * i - 20'000;
    table.force_un[i] = 1'100'000 * i;
  }
  return table;
}

}  // namespace

TEST_CASE("every page of a fingertip device is read as the firmware has it") {
  BenchFirmware device("FT-0042", JND_THUMB);
  REQUIRE(device.sound);
  PageExchange pages(device, "FT-0042");
  const jnd_identity identity = pages.identity();
  CHECK(serial_of(identity) == "FT-0042");
  CHECK(finger_word(identity.finger) == "thumb");
  CHECK(model_word(identity.model) == "3RRS fingertip device");
  CHECK(firmware_text(identity) == "1.0.0");
  CHECK(calibration_id_of(identity).empty());
  CHECK(pages.limits().most_force_un == device.config.limits.most_force_un);
  CHECK(pages.geometry().rest_height_nm == -20'000'000);
  CHECK(pages.force_table().points == 0);
  CHECK(calibration_id_of(pages.certificate()).empty());
}

TEST_CASE("what is stored is there when it is asked again, and after a power cycle") {
  BenchFirmware device;
  {
    PageExchange pages(device, "it");
    pages.store(three_points());
    jnd_certificate certificate{};
    std::copy_n("0123456789abcdef", JND_CALIBRATION_ID_SIZE, certificate.calibration_id);
    certificate.date = 20260301;
    pages.store(certificate);
  }
  device.start();
  PageExchange pages(device, "it");
  CHECK(pages.force_table().sensor_un[2] == 1'980'000);
  CHECK(calibration_id_of(pages.identity()) == "0123456789abcdef");
  CHECK(date_text(pages.identity().calibration_date) == "2026-03-01");
}

TEST_CASE("a lost answer is asked for again, with another token; what else comes is handed on") {
  BenchFirmware device;
  int others = 0;
  PageExchange pages(
      device, "it", [&](std::span<const std::uint8_t> report) { others += report[0] == JND_REPORT_TELEMETRY ? 1 : 0; },
      kQuick);
  device.lose_answers = 2;
  CHECK(serial_of(pages.identity()) == "FT-0001");
  REQUIRE(device.written.size() == 3);
  CHECK(device.written[0] != device.written[1]);
  CHECK(others > 0);
  device.lose_answers = 3;
  CHECK(contains(message_of([&] { (void)pages.identity(); }), "did not answer 3 requests for page 0 (identity)"));
}

TEST_CASE("a queue that filled up while nobody read does not hide the answer") {
  BenchFirmware device;
  device.sleep_until_ns(500'000'000);  // 500 reports for a queue of 63
  PageExchange pages(device, "it", {}, {.read_ms = 20, .write_ms = 20, .tries = 1});
  CHECK(serial_of(pages.identity()) == "FT-0001");
}

TEST_CASE("an answer to somebody else's question is not taken") {
  BenchFirmware device;
  PageExchange pages(device, "it", {}, kQuick);
  int spoilt = 0;
  device.spoil = [&](HidReport& report) {
    jnd_answer answer{};
    if (spoilt > 0 || jnd_decode_answer(report.data(), report.size(), &answer) != JND_DECODE_OK) return;
    ++spoilt;
    answer.token ^= 1U;
    answer.data[20] = 'X';  // of another serial
    jnd_encode_answer(&answer, report.data());
  };
  CHECK(serial_of(pages.identity()) == "FT-0001");
  CHECK(spoilt == 1);
}

TEST_CASE("a damaged answer is not taken") {
  BenchFirmware device;
  PageExchange pages(device, "it", {}, kQuick);
  int spoilt = 0;
  device.spoil = [&](HidReport& report) {
    if (report[0] != JND_REPORT_PAGE || spoilt++ > 0) return;
    report[30] ^= 0x10U;
  };
  CHECK(serial_of(pages.identity()) == "FT-0001");
  CHECK(spoilt == 2);
}

TEST_CASE("other versions of the protocol are refused with both ranges") {
  BenchFirmware device;
  device.config.identity.lowest_version = 2;
  device.config.identity.highest_version = 9;
  device.start();
  PageExchange pages(device, "it", {}, kQuick);
  CHECK(contains(message_of([&] { (void)pages.identity(); }), "versions 2 to 9 of the report protocol"));
  CHECK(contains(message_of([&] { (void)pages.identity(); }), "this program speaks versions 1 to 1"));
  device.spoil = [](HidReport& report) { report[1] = 9; };
  CHECK(contains(message_of([&] { (void)pages.identity(); }), "speaks version 9 of the report protocol"));
}

TEST_CASE("refusals are told in words, and nothing is stored while the device is active") {
  BenchFirmware device;
  PageExchange pages(device, "it", {}, kQuick);
  CHECK(contains(message_of([&] { (void)pages.read(static_cast<jnd_page_number>(7)); }), "knows no page 7"));
  CHECK(contains(message_of([&] { pages.write(JND_PAGE_LIMITS, {}); }), "refuses to store page 1 (limits)"));
  PageData nonsense{};
  nonsense.fill(0xFF);
  CHECK(contains(message_of([&] { pages.write(JND_PAGE_FORCE_TABLE, nonsense); }), "not valid"));
  jnd_command command{};
  command.mode = JND_MODE_WRENCH;
  command.sequence = 1;
  HidReport report{};
  jnd_encode_command(&command, report.data());
  REQUIRE(device.write(report));
  device.sleep_until_ns(device.now_ns() + 2'000'000);
  CHECK(contains(message_of([&] { pages.store(three_points()); }), "it stores at rest only"));
  command = {};
  command.sequence = 2;
  jnd_encode_command(&command, report.data());
  REQUIRE(device.write(report));
  CHECK(pages.force_table().points == 0);
}

TEST_CASE("a device that is gone, or gives back something else, is told") {
  BenchFirmware device;
  PageExchange pages(device, "it", {}, kQuick);
  device.spoil = [](HidReport& report) {
    jnd_answer answer{};
    if (jnd_decode_answer(report.data(), report.size(), &answer) != JND_DECODE_OK) return;
    answer.data[10] ^= 1U;
    jnd_encode_answer(&answer, report.data());
  };
  CHECK(contains(message_of([&] { pages.store(three_points()); }), "gives back another page 3 (force table)"));
  device.gone = true;
  CHECK(contains(message_of([&] { (void)pages.identity(); }), "is gone (No such device)"));
}

TEST_CASE("words for what reports say") {
  CHECK(fault_words(0).empty());
  CHECK(fault_words(JND_FAULT_WATCHDOG | JND_FAULT_BUTTON) == "no commands in time (its watchdog), its stop button");
  CHECK(limit_words(JND_LIMIT_SOFT_START) == "soft start");
  CHECK(capability_words(JND_CAN_FORCE | JND_CAN_TILT) == "force, tilt");
  CHECK(state_word(JND_STATE_STOPPED) == "stopped");
  CHECK(state_word(200) == "unknown");
  CHECK(finger_word(99) == "unknown");
  CHECK(date_text(0).empty());
}
