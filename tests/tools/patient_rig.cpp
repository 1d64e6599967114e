// An external rig that has ten minutes for everything that its rig file does not limit and no KEY names, so that a busy
// machine voids none of its presentations.
// Usage: patient_rig RIG-FILE [KEY=SECONDS...]                what jnd device test external --json says of it
//        patient_rig RIG-FILE [KEY=SECONDS...] run WORDS...   jnd run --rig RIG-FILE WORDS...
// KEY: a time of RigTimeOuts
#include <cstdlib>
#include <map>
#include <string>

#include "runner/command_line.h"
#include "runner/device_commands/command_device_external.h"
#include "runner/opening/rig_source.h"

int main(int count, char** words) {
  if (count < 2) return 2;
  jnd::ExternalSettings settings = jnd::external_settings_of(words[1], "");
  jnd::RigTimeOuts& limits = settings.time_outs;
  const std::map<std::string, double*> times = {{"silent_s", &limits.silent_s},
                                                {"presenting_silent_s", &limits.presenting_silent_s},
                                                {"stop_s", &limits.stop_s},
                                                {"bye_s", &limits.bye_s},
                                                {"late_s", &limits.late_s}};
  for (const auto& [name, seconds] : times) *seconds = 600;
  int at = 2;
  for (; at < count && std::string(words[at]) != "run"; ++at) {
    const std::string word = words[at];
    const std::size_t place = word.find('=');
    *times.at(word.substr(0, place)) = std::strtod(word.c_str() + place + 1, nullptr);
  }
  if (at == count) return jnd::external_rig_test(settings, true, false);
  const auto rigs = jnd::make_laboratory_rigs(settings);
  jnd::set_rig_source(rigs.get());
  return jnd::run_command_line(count - at + 1, words + at - 1);
}
