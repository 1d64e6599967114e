// Which of our fingertip devices are connected, and which of them a protocol's fingers wear.
#pragma once

#include <string>
#include <vector>

#include "devices/hid/hid_bus.h"
#include "devices/rigs/rig_file.h"

namespace jnd {

struct FoundFingertip {
  std::string path;
  std::string serial;   // empty: it could not be asked
  std::string finger;   // that it is made for; "any"
  std::string trouble;  // why it could not be asked
};

// Asks every one; waits for answers, so never in the loop. A device that another link uses may be asked meanwhile.
std::vector<FoundFingertip> find_fingertips(HidBus& bus);

// "RRS3-0001 (thumb), /dev/hidraw3: ..."; "none of ours" for none.
std::string text_of(const std::vector<FoundFingertip>& found);

// The serial of each finger's device, by the rig file or, where that leaves it open, the only one made for the finger;
// empty: it is not there. Throws InputError where the rig file names other fingers than the protocol, DeviceError where
// several would fit.
std::vector<std::string> serials_for(const std::vector<std::string>& fingers, const RigFile& rig,
                                     const std::vector<FoundFingertip>& found);

}  // namespace jnd
