#include "devices/hid/virtual/descriptors.h"

#include "devices/hid/firmware/jnd_report.h"

namespace jnd {

namespace {

constexpr std::uint8_t kInput = 0x81, kOutput = 0x91;

struct NumberedReport {
  std::uint8_t id, item;
};

std::vector<std::uint8_t> vendor_descriptor(std::uint8_t usage, const std::vector<NumberedReport>& reports) {
  std::vector<std::uint8_t> bytes = {
      0x06,
      JND_USAGE_PAGE & 0xFF,
      JND_USAGE_PAGE >> 8,  // Usage Page (vendor)
      0x09,
      usage,  // Usage
      0xA1,
      0x01,  // Collection (Application)
      0x15,
      0x00,  // Logical Minimum (0)
      0x26,
      0xFF,
      0x00,  // Logical Maximum (255)
      0x75,
      0x08,  // Report Size (8)
      0x95,
      JND_REPORT_SIZE - 1,  // Report Count (63)
  };
  for (const NumberedReport& report : reports)  // Report ID, Usage, Input or Output (Data, Variable, Absolute)
    bytes.insert(bytes.end(), {0x85, report.id, 0x09, report.id, report.item, 0x02});
  bytes.push_back(0xC0);  // End Collection
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> fingertip_descriptor() {
  return vendor_descriptor(JND_USAGE_FINGERTIP, {{JND_REPORT_COMMAND, kOutput},
                                                 {JND_REPORT_REQUEST, kOutput},
                                                 {JND_REPORT_TELEMETRY, kInput},
                                                 {JND_REPORT_PAGE, kInput}});
}

std::vector<std::uint8_t> tracker_descriptor() {
  return vendor_descriptor(JND_USAGE_TRACKER,
                           {{JND_REPORT_REQUEST, kOutput}, {JND_REPORT_PAGE, kInput}, {JND_REPORT_TRACKER, kInput}});
}

std::vector<std::uint8_t> gamepad_descriptor() {
  return {
      0x05, 0x01,        // Usage Page (Generic Desktop)
      0x09, 0x05,        // Usage (Game Pad)
      0xA1, 0x01,        // Collection (Application)
      0x15, 0x00,        //   Logical Minimum (0)
      0x26, 0xFF, 0x00,  //   Logical Maximum (255)
      0x75, 0x08,        //   Report Size (8)
      0x95, 0x02,        //   Report Count (2)
      0x09, 0x30,        //   Usage (X)
      0x09, 0x31,        //   Usage (Y)
      0x81, 0x02,        //   Input (Data, Variable, Absolute)
      0x05, 0x09,        //   Usage Page (Button)
      0x19, 0x01,        //   Usage Minimum (1)
      0x29, 0x08,        //   Usage Maximum (8)
      0x25, 0x01,        //   Logical Maximum (1)
      0x75, 0x01,        //   Report Size (1)
      0x95, 0x08,        //   Report Count (8)
      0x81, 0x02,        //   Input (Data, Variable, Absolute)
      0xC0,              // End Collection
  };
}

}  // namespace jnd
