#include "devices/hid/virtual/virtual_fingertip.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "devices/hid/virtual/virtual_device.h"
#include "protocols/input/input_error.h"

namespace jnd {

namespace {

constexpr std::array<std::string_view, 3> kStates = {"rest", "active", "stopped"};
constexpr std::array<std::string_view, 7> kFaults = {"watchdog", "sensor", "actuator", "temperature",
                                                     "battery",  "button", "internal"};

std::string fault_words(std::uint16_t faults) {
  std::string words;
  for (std::size_t bit = 0; bit < kFaults.size(); ++bit)
    if ((faults & (1U << bit)) != 0) words += fmt::format("{}\"{}\"", words.empty() ? "" : ",", kFaults[bit]);
  return "[" + words + "]";
}

jnd_fingertip_config config_of(const FingertipOptions& options) {
  const bool printable =
      std::all_of(options.serial.begin(), options.serial.end(), [](char c) { return c > ' ' && c < 0x7F; });
  if (options.serial.empty() || options.serial.size() > JND_SERIAL_SIZE || !printable)
    throw InputError(fmt::format("--serial \"{}\": give 1 to {} printable characters without blanks", options.serial,
                                 int{JND_SERIAL_SIZE}));
  if (options.rate_hz < 1 || options.rate_hz > 1000 || 1000 % options.rate_hz != 0)
    throw InputError(fmt::format("--rate {}: give a divisor of 1000, such as 1000, 500 or 200", options.rate_hz));
  jnd_fingertip_config config = jnd_fingertip_default_config(options.serial.c_str(), options.finger);
  config.identity.loop_rate_hz = static_cast<std::uint16_t>(options.rate_hz);
  config.identity.capabilities |= JND_IS_MODEL;
  return config;
}

}  // namespace

VirtualFingertip::VirtualFingertip(const FingertipOptions& options, const InputReport& port, EventLog& log)
    : options_(options),
      config_(config_of(options)),
      log_(log),
      outlet_(JND_REPORT_TELEMETRY, port),
      hardware_(
          plant_spec_of(config_), options.pulp_n_per_m, [this](auto report) { return told(report); }, options.memory) {
  power_up();
}

HidDescription VirtualFingertip::description() const {
  return {.name = "jnd fingertip device (virtual)",
          .phys = "virtual/" + options_.serial,
          .serial = options_.serial,
          .vendor = kVirtualVendor,
          .product = kVirtualProduct,
          .report_descriptor = fingertip_descriptor()};
}

void VirtualFingertip::power_up() {
  powered_ = true;
  power_up_ns_ = timer_ns_;
  ahead_ns_ = 0;
  accepted_ns_ = -1;
  state_ = JND_STATE_REST;
  told_faults_ = 0;
  telemetry_ = {};
  hardware_.set_time_us(0);
  const jnd_hardware functions = hardware_.functions();
  if (!jnd_fingertip_init(&firmware_, &config_, &functions))
    throw InputError("the firmware refuses its own configuration");
}

std::uint64_t VirtualFingertip::clock_us(std::int64_t timer_ns) const noexcept {
  return static_cast<std::uint64_t>((timer_ns - power_up_ns_ + ahead_ns_) / 1000);
}

double VirtualFingertip::since_command_ms(std::int64_t timer_ns) const noexcept {
  return accepted_ns_ < 0 ? -1 : 1e-6 * static_cast<double>(timer_ns - accepted_ns_);
}

void VirtualFingertip::step(std::int64_t timer_ns, bool frozen) {
  timer_ns_ = timer_ns;
  hardware_.advance();
  if (frozen || !powered_ || timer_ns % (1'000'000'000 / options_.rate_hz) != 0) return;
  hardware_.set_time_us(clock_us(timer_ns));
  jnd_fingertip_step(&firmware_);
  ++steps_;
  notice(timer_ns);
}

void VirtualFingertip::receive(std::span<const std::uint8_t> report, std::int64_t timer_ns) {
  if (!powered_ || report.empty()) return;
  (report[0] == JND_REPORT_COMMAND ? commands_ : requests_) += 1;
  hardware_.set_time_us(clock_us(timer_ns));
  jnd_fingertip_receive(&firmware_, report.data(), report.size());
}

bool VirtualFingertip::told(std::span<const std::uint8_t, JND_REPORT_SIZE> report) {
  (void)jnd_decode_telemetry(report.data(), report.size(), &telemetry_);
  return outlet_.send(report);
}

// After a step: what has changed.
void VirtualFingertip::notice(std::int64_t timer_ns) {
  if (telemetry_.command_age_us != JND_COMMAND_AGE_NONE)
    accepted_ns_ = timer_ns - 1000 * std::int64_t{telemetry_.command_age_us};
  const std::string now = fmt::format("\"force_n\":{:.6f},\"push_n\":{:.6f},\"since_command_ms\":{:.3f}",
                                      hardware_.force_n(), hardware_.push_n(), since_command_ms(timer_ns));
  if (telemetry_.state != state_ || telemetry_.faults != told_faults_) {
    log_.write("state", fmt::format("\"from\":\"{}\",\"to\":\"{}\",\"faults\":{},{}", kStates[state_],
                                    kStates[telemetry_.state], fault_words(telemetry_.faults), now));
    state_ = telemetry_.state;
    told_faults_ = telemetry_.faults;
  }
  const bool pushes = hardware_.push_n() != 0;
  if (pushes == pushes_) return;
  pushes_ = pushes;
  if (!pushes) let_go_real_ns_ = monotonic_ns();
  log_.write(pushes ? "push" : "let_go", now);
}

bool VirtualFingertip::obey(const DeviceOrder& order) {
  switch (order.kind) {
    case OrderKind::stuck_sensor:
      hardware_.set_fault(&BoardFaults::stuck_sensor, order.on);
      return true;
    case OrderKind::nan_sensor:
      hardware_.set_fault(&BoardFaults::nan_sensor, order.on);
      return true;
    case OrderKind::hot:
      hardware_.set_fault(&BoardFaults::hot, order.on);
      return true;
    case OrderKind::low_battery:
      hardware_.set_fault(&BoardFaults::low_battery, order.on);
      return true;
    case OrderKind::stop_button:
      hardware_.set_fault(&BoardFaults::stop_button, order.on);
      return true;
    case OrderKind::button:
      hardware_.set_button(order.button, order.on);
      return true;
    default:
      return outlet_.obey(order);
  }
}

void VirtualFingertip::plugged(bool is_plugged) {
  if (!options_.bus_powered || is_plugged == powered_) return;
  if (is_plugged) {
    power_up();
    return;
  }
  powered_ = false;
  hardware_.let_go();
  if (pushes_) {
    pushes_ = false;
    let_go_real_ns_ = monotonic_ns();
    log_.write("let_go", "\"why\":\"no power\"");
  }
}

std::string VirtualFingertip::status() const {
  return fmt::format(
      "\"kind\":\"fingertip\",\"serial\":{},\"state\":\"{}\",\"faults\":{},\"force_n\":{:.6f},\"push_n\":{:.6f},"
      "\"since_command_ms\":{:.3f},\"let_go_s\":{:.9f},\"steps\":{},\"sent\":{},\"dropped\":{},\"damaged\":{},"
      "\"answered\":{},\"commands\":{},\"requests\":{},\"rejected\":{},\"impossible\":{}",
      json_text(options_.serial), kStates[state_], fault_words(told_faults_), hardware_.force_n(), hardware_.push_n(),
      since_command_ms(timer_ns_), 1e-9 * static_cast<double>(let_go_real_ns_), steps_, outlet_.sent(),
      outlet_.dropped(), outlet_.damaged(), outlet_.answered(), commands_, requests_, telemetry_.rejected,
      hardware_.impossible());
}

}  // namespace jnd
