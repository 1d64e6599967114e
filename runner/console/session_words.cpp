#include "runner/console/session_words.h"

#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/tasks/task.h"
#include "runner/terminal/terminal.h"

namespace jnd {

std::string name_of(const TrialOutline& outline) {
  return fmt::format("{} {}", outline.practice ? "practice" : "trial", outline.number);
}

std::string full_name_of(const TrialOutline& outline) {
  return fmt::format("{} (plan no. {})", name_of(outline), outline.plan_number);
}

std::string beside_heading(const TrialOutline& outline) {
  std::vector<std::string> parts;
  if (!outline.condition_code.empty()) parts.push_back(fmt::format("condition {}", printable(outline.condition_code)));
  if (!outline.practice)
    parts.push_back(fmt::format("block {} of {}  about {} left", outline.block, outline.blocks,
                                duration_text(outline.time_left_s)));
  if (outline.attempt > 1) parts.push_back(fmt::format("(attempt {})", outline.attempt));
  parts.push_back(fmt::format("plan no. {}", outline.plan_number));
  return fmt::format("{}", fmt::join(parts, "  "));
}

std::string reason_text(const std::string& reason) {
  static constexpr std::array<std::pair<const char*, const char*>, 17> kWords = {
      {{"no_answer", "no answer in time"},
       {"no_contact", "the sphere was not touched"},
       {"emergency_stop", "stopped"},
       {"saturated", "by a rule of the protocol"},  // which one would tell how stiff the object was
       {"off_prescription", "not felt as prescribed"},
       {"repeated", "repeated at your wish"},
       {"not_accepted", "nothing was accepted after many settings"},
       {"paused", "paused"},
       {"interrupted", "interrupted"},
       {"taken_back", "taken back"},
       {"stale_pose", "no fresh pose from the tracker"},
       {"stale_reading", "no fresh reading from a device"},
       {"command_gap", "the program was held up"},
       {"non_finite", "a value that is no number"},
       {"sensor_stuck", "a force sensor does not follow"},
       {"device_lost", "a device has gone"},
       {"device_fault", "a device stopped itself"}}};
  for (const auto& [code, words] : kWords)
    if (reason == code) return words;
  return printable(reason);
}

std::string usual_words(CuePlace place, const Protocol& protocol) {
  static constexpr std::array kOrdinals = {"first", "second", "third"};
  if (place == CuePlace::question) {
    const std::vector<std::string>& classes = protocol.task.classes;
    if (classes.empty()) return "which number?";
    std::string words;
    for (std::size_t i = 0; i < classes.size(); ++i)
      words += (i == 0 ? "" : i + 1 == classes.size() ? " or " : ", ") + classes[i];
    return words + "?";
  }
  if (felt_intervals(protocol.task) == 1) return "now";
  const std::string ordinal = kOrdinals[static_cast<std::size_t>(place)];
  return protocol.rig.built_in() ? ordinal + " sphere" : ordinal;
}

std::string interval_word(CuePlace place, const Protocol& protocol) {
  static constexpr std::array kWords = {"FIRST", "SECOND", "THIRD"};
  return felt_intervals(protocol.task) == 1 ? "FEEL" : kWords[static_cast<std::size_t>(place)];
}

std::string items_text(const HandOver& what) {
  std::string text;
  for (const HandOver::Item& item : what.items)
    text += fmt::format("{}{}{}{}", text.empty() ? "" : "   ", item.place, item.place.empty() ? "" : ": ",
                        printable(item.code));
  return text;
}

}  // namespace jnd
