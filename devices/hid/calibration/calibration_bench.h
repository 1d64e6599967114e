// The readings of a calibration, taken from a real device through the governor, and what is stored in it afterwards.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "devices/hid/bench/bench_link.h"
#include "devices/hid/calibration/calibration_certificate.h"
#include "devices/hid/page_exchange.h"

namespace jnd {

// The person beside the device. Thread rule: the handle's thread.
class CalibrationOperator {
 public:
  virtual ~CalibrationOperator() = default;
  virtual void ask(const std::string& question) = 0;
  // The line that was typed since; none yet. Never waits: the device is driven meanwhile. Throws InputError where
  // the input has ended.
  virtual std::optional<std::string> answer() = 0;
  virtual void say(const std::string& text) = 0;
};

// One point to take. Not pushed: the operator puts the known force on the device, at rest.
struct CalibrationStep {
  std::optional<double> known_n{};  // none: asked for
  double pushed_n = 0;              // with what the device presses the reference
};

// Takes the readings of all steps; open_ended: then goes on asking for known forces until an empty line. former: the
// table in the device, which its telemetry went through. Throws DeviceError, BenchInterrupted and InputError; the
// device rests then.
std::vector<ForceRecord> take_forces(BenchLink& link, const ForceTable& former,
                                     const std::vector<CalibrationStep>& steps, bool open_ended,
                                     CalibrationOperator& person);

// The device renders a stiffness at five depths, up to 70 % of its largest force; the force is read through `table`.
StiffnessRecord take_stiffness(BenchLink& link, const ForceTable& former, const ForceTable& table,
                               double stiffness_n_per_m, double full_scale_n);

// Table, then certificate; each read back and compared. Where that fails the former ones are put back; DeviceError
// says so.
void store_calibration(PageExchange& pages, const ForceTable& table, const jnd_certificate& certificate);

}  // namespace jnd
