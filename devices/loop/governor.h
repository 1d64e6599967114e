// The only path to a device: what was asked goes in, what is safe to give comes out, with the limits that acted.
//
// A falling force and every stop pass at once; only a rising force is slowed. Whatever is not a number gives zero force
// and a fault. No force leaves a governor that is not active. The limits are those of the device's description, none of
// them above the model's hard limit (protocols/rigs/device_models.h).
//
//   unconfigured --configure--> inactive --activate--> active --trip, or a fault found--> faulted --reset--> inactive
//                                  ^------deactivate------'
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "devices/fingertip_device.h"
#include "protocols/rigs/device_description.h"
#include "protocols/vocabulary.h"

namespace jnd {

// Fastest rise of force, N/s: 0 to 4.7 N in 19 ms. Five times what the fastest planned press asks (0.05 m/s into
// 900 N/m is 45 N/s), and below what startles.
inline constexpr double kMaxForceRise_n_per_s = 250;
// The rise of one tick is counted over at most this long, so that a late tick never brings a jump.
inline constexpr std::int64_t kLongestRise_ns = 1'000'000;
// Linear ramp of the force after engaging and after any pause, ns: about a reaction time, enough to pull back.
inline constexpr std::int64_t kSoftStart_ns = 200'000'000;
// Longest uninterrupted vibration, ns: twice the burst of Chinello 2017. It is over when the host asks for none.
inline constexpr std::int64_t kMaxBurst_ns = 200'000'000;
// Oldest pose, and longest gap between commands, that force may rest on, ns: 20 periods of the loop; at 0.05 m/s the
// finger has moved 1 mm, which at 900 N/m is 0.9 N.
inline constexpr std::int64_t kMaxAge_ns = 20'000'000;

// The limits that acted on a command, as bits.
namespace limit {
inline constexpr unsigned kForceCap = 1U << 0U;
inline constexpr unsigned kForceRise = 1U << 1U;
inline constexpr unsigned kSoftStart = 1U << 2U;
inline constexpr unsigned kWorkspace = 1U << 3U;  // beyond the device's tilt or travel, or a direction that pulls
inline constexpr unsigned kPull = 1U << 4U;       // a negative force: the platform can only push
inline constexpr unsigned kVibration = 1U << 5U;  // amplitude or frequency outside the motor's range
inline constexpr unsigned kBurst = 1U << 6U;      // vibration longer than kMaxBurst_ns
inline constexpr unsigned kNotActive = 1U << 7U;

// By bit: what the log calls them.
inline constexpr std::array<std::string_view, 8> kNames = {"force_cap", "force_rise", "soft_start", "workspace",
                                                           "pull",      "vibration",  "burst",      "not_active"};
}  // namespace limit

// How often a limit acted since the activation, and what was asked and given where it took most.
struct LimitTally {
  std::int64_t ticks = 0;
  double asked = 0, given = 0;  // N; g or Hz for vibrations; rad for a tilt
};

// The pieces, as pure functions. All times ns, forces N.
double rise_limited_n(double asked, double previous, std::int64_t elapsed_ns) noexcept;
double soft_start_gain(std::int64_t since_activation_ns) noexcept;  // 0..1

struct GovernorInput {
  DeviceCommand asked;
  double travel = 0;              // where the device is along its range, of the last reading
  std::int64_t pose_time_ns = 0;  // of the finger pose that the command rests on
};

struct GovernorOutput {
  DeviceCommand given;
  unsigned limits = 0;         // bits of namespace limit
  bool force_reduced = false;  // less force is given than was asked
  bool soft_start = false;     // the ramp is not over
  Fault fault = Fault::none;   // found at this call, or the one that holds the governor
};

// One finger's. Thread rule: the control loop's thread only. Nothing allocates or throws.
class Governor {
 public:
  enum class State { unconfigured, inactive, active, faulted };

  void configure(const DeviceSpec& spec) noexcept;
  // From inactive only; returns whether the governor is active now. Soft start begins.
  bool activate(std::int64_t now_ns) noexcept;
  void deactivate() noexcept;       // active -> inactive
  void trip(Fault fault) noexcept;  // any configured state -> faulted
  void reset() noexcept;            // faulted -> inactive

  GovernorOutput govern(const GovernorInput& input, std::int64_t now_ns) noexcept;

  State state() const noexcept { return state_; }
  Fault fault() const noexcept { return fault_; }
  // By bit of namespace limit.
  const std::array<LimitTally, limit::kNames.size()>& tallies() const noexcept { return tallies_; }

 private:
  GovernorOutput refuse(const DeviceCommand& asked) noexcept;
  double govern_force(const GovernorInput& input, std::int64_t now_ns, std::int64_t elapsed_ns,
                      GovernorOutput& out) noexcept;
  void govern_tilt(const DeviceCommand& asked, GovernorOutput& out) noexcept;
  void act(unsigned bit, double asked, double given, unsigned& limits) noexcept;
  double govern_vibration(const DeviceCommand& asked, std::int64_t now_ns, unsigned& limits) noexcept;

  State state_ = State::unconfigured;
  Fault fault_ = Fault::none;
  double max_force_n_ = 0, max_roll_rad_ = 0, max_pitch_rad_ = 0;
  double lowest_travel_ = 0, highest_travel_ = 0;
  double min_vibration_g_ = 0, max_vibration_g_ = 0, min_vibration_hz_ = 0, max_vibration_hz_ = 0;
  double previous_force_n_ = 0;
  std::int64_t activated_ns_ = 0, last_call_ns_ = 0;
  std::int64_t burst_start_ns_ = 0;
  bool vibrating_ = false;
  std::array<LimitTally, limit::kNames.size()> tallies_{};
};

}  // namespace jnd
