// The seam between the control loop and one device that acts on a fingertip: a platform that presses the pulp, with a
// vibration motor (3RRS), or a linkage that resists the finger's flexion (McKibben finger).
//
// Device frame: z dorsal (out of the nail), the platform pushes along +z in its rest orientation; a linkage pushes
// along +z too, against flexion. The device closes its own loop; the host says how hard, along which direction, and how
// the platform should lie.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace jnd {

// One tick's command, as the governor lets it through.
struct DeviceCommand {
  double force_n = 0;            // on the finger, along normal; >= 0
  double stiffness_n_per_m = 0;  // of the contact behind it, for position-controlled modes; 0: none
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, device frame: which way the finger is pushed
  double roll_rad = 0, pitch_rad = 0;                 // platform orientation asked
  double vibration_g = 0;                             // amplitude, 0 = off
  double vibration_hz = 0;
  // The contact behind the force, for a device that works the force out itself: stiffness * penetration + damping *
  // rate, and never more than force_n, which is what the governor allows. Zero without contact.
  double penetration_m = 0, penetration_rate_m_per_s = 0;
  double damping_n_s_per_m = 0;
  Eigen::Vector3d contact_point_m = Eigen::Vector3d::Zero();  // of the proxy, from the fingertip, device frame
};

struct PlatformPose {
  double pz_m = 0, roll_rad = 0, pitch_rad = 0;
  double sin_yaw = 0, cos_yaw = 1;  // of the parasitic yaw: the tick needs no more of it
};

struct DeviceReading {
  std::int64_t time_ns = 0;  // when it was true, on the loop's clock
  double force_n = 0;        // on the finger, measured
  double vibration_g = 0;    // amplitude
  double travel = 0;         // along the device's own range: platform height in m, or joint angle in rad
  PlatformPose platform;     // at rest for a device without one
};

enum class DeviceStatus { ok, lost, stopped };  // stopped: by itself, and it says why

// Thread rule: the control loop's thread only. Nothing in read or write allocates, locks or waits.
class FingertipDevice {
 public:
  virtual ~FingertipDevice() = default;

  // Which interval begins: what a model keys its noise by, so that a resumed session feels as an undisturbed one.
  virtual void begin_interval(std::uint64_t /*part*/) noexcept {}
  // Before an interval: ready, at rest, without force.
  virtual DeviceStatus engage(std::int64_t now_ns) noexcept = 0;
  virtual DeviceStatus read(std::int64_t now_ns, DeviceReading& reading) noexcept = 0;
  virtual DeviceStatus write(const DeviceCommand& command, std::int64_t now_ns) noexcept = 0;
  // Force to zero and the platform to rest, at once. Safe at any time.
  virtual void neutral() noexcept = 0;
};

}  // namespace jnd
