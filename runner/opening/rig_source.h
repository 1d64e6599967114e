// Where sessions get their rig: simulated devices, unless the program that was started brings its own.
#pragma once

#include <cstdint>
#include <memory>

#include "devices/clock.h"
#include "devices/rig.h"
#include "devices/rigs/rig_factory.h"
#include "devices/rigs/rig_file.h"
#include "protocols/protocol.h"

namespace jnd {

// Thread rule: may be asked from any thread; must live as long as it is set.
class RigSource {
 public:
  virtual ~RigSource() = default;
  // What the rig below says of itself, without making it: RigInfo::simulated decides which kinds of session there are.
  virtual RigInfo info(const Protocol& protocol, const RigSpec& spec) const = 0;
  // Before a study is made: looks whether the devices that the rig below needs are there, a tracker over HID too.
  // Returns whether one of them is a model in software, by its own word; a rig that info() calls simulated has nothing
  // to look for. Throws as make does.
  virtual bool look_for_devices(const Protocol& /*protocol*/, const RigDescription& /*rig*/,
                                const ParticipantProfile& /*profile*/, Clock& /*clock*/) const {
    return false;
  }
  // On the given clock, which must outlive the rig. Throws InputError where the protocol asks for what is not there,
  // DeviceError where a device does not answer.
  virtual std::unique_ptr<Rig> make(const Protocol& protocol, const RigDescription& rig,
                                    const ParticipantProfile& profile, int participant, std::uint64_t seed,
                                    Clock& clock, const RigOptions& options) const = 0;
};

// Of this process; null: simulated devices (devices/rigs/rig_factory.h). Set it before the first session.
void set_rig_source(const RigSource* source) noexcept;

// The source that is set.
const RigSource& rig_source() noexcept;

// Fingertip devices over USB HID, or that are programs, as the rig file says. Throws DeviceError where the system's HID cannot be used.
std::unique_ptr<const RigSource> make_hid_rigs(RigFile file);

// A program of the laboratory, as the rig file says.
std::unique_ptr<const RigSource> make_laboratory_rigs(ExternalSettings settings);

// Specimens in the operator's hands.
std::unique_ptr<const RigSource> make_specimen_rigs();

}  // namespace jnd
