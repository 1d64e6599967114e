// Does a rig say that it can present what a protocol asks? Told before anybody is invited.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "devices/external/rig_messages.h"

namespace jnd {

// What a protocol asks of a rig.
struct RigDemand {
  std::string quantity, unit;
  std::vector<double> values{};                                        // all levels and standards
  std::vector<std::map<std::string, RigParameterValue>> conditions{};  // the parameters of each
  std::vector<std::string> measures{};                                 // what is held against limits: "peak_force"
  int places = 1;                                                      // side by side
  bool answers = false;                                                // the participant answers on the rig
  bool real = false;                                                   // a model would not do
  std::optional<double> gap_s{};                                       // between two presentations of a trial
};

// What does not fit, each a sentence for people; the texts of rig and protocol in it have no control characters. Every parameter of the rig
// must be given by every condition: a rig has no silent defaults.
std::vector<std::string> rig_problems(const RigDemand& demand, const RigHello& hello);

// What fits, and yet has to be known before the rig is used: one sentence each.
std::vector<std::string> rig_cautions(const RigDemand& demand, const RigHello& hello);

// Whether a rig that was started anew is still the one that the study was checked against.
bool is_same_rig(const RigHello& before, const RigHello& now);

// The same for one presentation; empty: it fits.
std::string rig_request_problem(const RenderRequest& request, const RigHello& hello);

// "700 N/m", "0.5".
std::string rig_value_text(double value, const std::string& unit);
// "stiffness 100 to 1000 N/m".
std::string rig_range_text(const RigRange& range);

}  // namespace jnd
