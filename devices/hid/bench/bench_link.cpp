#include "devices/hid/bench/bench_link.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "devices/device_error.h"
#include "devices/hid/report_words.h"

namespace jnd {

namespace {

using Report = std::array<std::uint8_t, JND_REPORT_SIZE>;

constexpr double kNano = 1e-9, kTenthMilli = 1e-4, kDeci = 1e-1;

}  // namespace

DeviceSpec spec_of(const jnd_limits& limits, const jnd_geometry& geometry, double most_force_n) {
  DeviceSpec spec;
  spec.model = DeviceModel::rrs3;
  spec.max_force_n = std::min(kMicro * limits.most_force_un, most_force_n);
  spec.max_stiffness = kMilli * limits.most_stiffness_mn_per_m;
  spec.lowest_travel = kNano * limits.lowest_height_nm;
  spec.highest_travel = kNano * limits.highest_height_nm;
  spec.stroke_m = spec.highest_travel - spec.lowest_travel;
  spec.max_roll_rad = kTenthMilli * limits.most_roll_dmrad;
  spec.max_pitch_rad = kTenthMilli * limits.most_pitch_dmrad;
  spec.max_joint_speed_rad_per_s = kMilli * limits.most_joint_speed_mrad_per_s;
  spec.min_vibration_g = kMilli * limits.least_vibration_mg;
  spec.max_vibration_g = kMilli * limits.most_vibration_mg;
  spec.min_vibration_hz = kDeci * limits.least_vibration_dhz;
  spec.max_vibration_hz = kDeci * limits.most_vibration_dhz;
  spec.a_m = kNano * geometry.a_nm;
  spec.b_m = kNano * geometry.b_nm;
  spec.bh_m = kNano * geometry.bh_nm;
  spec.bd_m = kNano * geometry.bd_nm;
  spec.l1_m = kNano * geometry.l1_nm;
  spec.l2_m = kNano * geometry.l2_nm;
  spec.rest_z_m = kNano * geometry.rest_height_nm;
  return spec;
}

BenchLink::BenchLink(HidHandle& handle, Clock& clock, const DeviceSpec& spec, const std::atomic<bool>& interrupted)
    : handle_(handle), clock_(clock), spec_(spec), interrupted_(interrupted), next_tick_ns_(clock.now_ns()) {
  governor_.configure(spec);
}

BenchLink::~BenchLink() {
  Report report{};
  const jnd_command command = rest_command();
  jnd_encode_command(&command, report.data());
  (void)handle_.write(report);  // whether it is still there no longer matters
}

void BenchLink::wait() {
  // A late tick skips what it missed: two commands at once would not help.
  next_tick_ns_ = std::max(next_tick_ns_ + kTick_ns, clock_.now_ns());
  clock_.sleep_until_ns(next_tick_ns_);
  if (interrupted_) throw BenchInterrupted();
}

void BenchLink::hear() {
  Report report{};
  constexpr int kMostWaiting = 256;
  for (int i = 0; i < kMostWaiting; ++i) {
    const int count = handle_.read(report, 0);
    if (count == kHidTimeOut) return;
    if (count == kHidGone)
      throw DeviceError(fmt::format("the device is gone ({}); look at its cable", handle_.error()));
    BenchSample sample{.arrival_ns = clock_.now_ns(), .telemetry = {}};
    const jnd_decode_result result =
        jnd_decode_telemetry(report.data(), static_cast<std::size_t>(count), &sample.telemetry);
    if (result == JND_DECODE_ID) continue;  // an answer to a request before
    if (result != JND_DECODE_OK) {
      ++damaged_;
      continue;
    }
    if (!counter_.take(sample.telemetry.sequence)) continue;
    newest_ = sample;
    if (look_) look_(sample);
  }
}

void BenchLink::look_for_faults() noexcept {
  if (governor_.state() != Governor::State::active) return;
  if (clock_.now_ns() - newest_.arrival_ns > kMaxAge_ns) governor_.trip(Fault::stale_reading);
  if (newest_.telemetry.state == JND_STATE_STOPPED) governor_.trip(Fault::device_fault);
}

void BenchLink::write(std::span<const std::uint8_t> report) {
  if (!handle_.write(report))
    throw DeviceError(fmt::format("the device takes no commands ({}); connect it again", handle_.error()));
}

void BenchLink::write(const jnd_command& command) {
  Report report{};
  jnd_encode_command(&command, report.data());
  write(report);
}

const GovernorOutput& BenchLink::tick(const DeviceCommand& asked) {
  wait();
  hear();
  look_for_faults();
  const std::int64_t now = clock_.now_ns();
  out_ = governor_.govern(
      {.asked = asked, .travel = kNano * newest_.telemetry.height_nm, .pose_time_ns = newest_.arrival_ns}, now);
  if (out_.fault == Fault::none && governor_.state() == Governor::State::active) write(next_command(out_.given));
  return out_;
}

void BenchLink::silence() {
  wait();
  hear();
}

void BenchLink::send_raw(std::span<const std::uint8_t> report) {
  wait();
  hear();
  write(report);
}

bool BenchLink::rest(int patience_ms) {
  governor_.reset();
  governor_.deactivate();
  write(rest_command());
  const std::int64_t end_ns = clock_.now_ns() + std::int64_t{patience_ms} * kTick_ns;
  do {
    silence();
    if (heard() && telemetry().command_sequence == sequence_ && telemetry().state == JND_STATE_REST) return true;
  } while (clock_.now_ns() < end_ns);
  return false;
}

bool BenchLink::make_ready() {
  if (!rest() || telemetry().faults != 0) return false;
  governor_.activate(clock_.now_ns());
  for (std::int64_t i = 0; i <= kSoftStart_ns / kTick_ns; ++i)
    if (tick(push(0)).fault != Fault::none) return false;
  return telemetry().state == JND_STATE_ACTIVE;
}

std::string BenchLink::trouble() const {
  const std::string faults = fault_words(telemetry().faults);
  return (fault() == Fault::none ? fmt::format("did not become active: {}", state_word(telemetry().state))
                                 : fmt::format("ended by {}", to_string(fault()))) +
         (faults.empty() ? "" : ", faults: " + faults);
}

DeviceCommand BenchLink::push(double force_n) {
  constexpr double kContact_n_per_m = 1000;
  DeviceCommand command;
  command.force_n = force_n;
  if (force_n > 0) {
    command.stiffness_n_per_m = kContact_n_per_m;
    command.penetration_m = force_n / kContact_n_per_m;
  }
  return command;
}

jnd_command BenchLink::next_command(const DeviceCommand& asked) {
  jnd_command command{};
  (void)to_report(asked, RenderingMode::wrench, command);  // what is no number becomes a command of mode rest
  command.sequence = ++sequence_;
  return command;
}

jnd_command BenchLink::rest_command() {
  jnd_command command{};
  command.mode = JND_MODE_REST;
  command.sequence = ++sequence_;
  return command;
}

}  // namespace jnd
