#include "runner/console/session_words.h"

#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "protocols/tasks/task.h"
#include "runner/terminal/terminal.h"
#include "runner/words/words.h"

namespace jnd {

std::string name_of(const TrialOutline& outline) {
  return outline.practice ? tr("practice {}", outline.number) : tr("trial {}", outline.number);
}

std::string full_name_of(const TrialOutline& outline) {
  return tr("{} (plan no. {})", name_of(outline), outline.plan_number);
}

std::string beside_heading(const TrialOutline& outline) {
  std::vector<std::string> parts;
  if (!outline.condition_code.empty()) parts.push_back(tr("condition {}", printable(outline.condition_code)));
  if (!outline.practice)
    parts.push_back(
        tr("block {} of {}  about {} left", outline.block, outline.blocks, duration_text(outline.time_left_s)));
  if (outline.attempt > 1) parts.push_back(tr("(attempt {})", outline.attempt));
  parts.push_back(tr("plan no. {}", outline.plan_number));
  return fmt::format("{}", fmt::join(parts, "  "));
}

std::string reason_text(const std::string& reason) {
  static constexpr std::array<std::pair<const char*, const char*>, 17> kWords = {
      {{"no_answer", word("no answer in time")},
       {"no_contact", word("the sphere was not touched")},
       {"emergency_stop", word("stopped")},
       {"saturated", word("by a rule of the protocol")},  // which one would tell how stiff the object was
       {"off_prescription", word("not felt as prescribed")},
       {"repeated", word("repeated at your wish")},
       {"not_accepted", word("nothing was accepted after many settings")},
       {"paused", word("paused")},
       {"interrupted", word("interrupted")},
       {"taken_back", word("taken back")},
       {"stale_pose", word("no fresh pose from the tracker")},
       {"stale_reading", word("no fresh reading from a device")},
       {"command_gap", word("the program was held up")},
       {"non_finite", word("a value that is no number")},
       {"sensor_stuck", word("a force sensor does not follow")},
       {"device_lost", word("a device has gone")},
       {"device_fault", word("a device stopped itself")}}};
  for (const auto& [code, words] : kWords)
    if (reason == code) return std::string(translated(words));
  return printable(reason);
}

std::string shown_answer(const TaskSpec& task, int said) {
  // Those that a table of a language has to have: what the tasks call answers ("A" and "B" are the same everywhere).
  [[maybe_unused]] static constexpr std::array kOfTasks = {
      word("same"), word("different"), word("first"), word("second"), word("third"), word("no"),
      word("yes"),  word("left"),      word("right"), word("less"),   word("more"),  word("accept")};
  const std::string_view said_so = said_word(task, said);
  return std::string(task.kind == TaskKind::identify ? said_so : translated(said_so));
}

std::string usual_words(CuePlace place, const Protocol& protocol) {
  static constexpr std::array kOrdinals = {word("first"), word("second"), word("third")};
  static constexpr std::array kSpheres = {word("first sphere"), word("second sphere"), word("third sphere")};
  if (place == CuePlace::question) {
    const int classes = static_cast<int>(protocol.task.classes.size());
    if (classes == 0) return tr("which number?");
    std::string words;
    for (int i = 0; i < classes; ++i)
      words += (i == 0             ? std::string()
                : i + 1 == classes ? fmt::format(" {} ", tr("or"))
                                   : std::string(", ")) +
               shown_answer(protocol.task, i);
    return words + "?";
  }
  if (felt_intervals(protocol.task) == 1) return tr("now");
  const auto& words = protocol.rig.built_in() ? kSpheres : kOrdinals;
  return std::string(translated(words[static_cast<std::size_t>(place)]));
}

std::string interval_word(CuePlace place, const Protocol& protocol) {
  static constexpr std::array kWords = {word("FIRST"), word("SECOND"), word("THIRD")};
  return felt_intervals(protocol.task) == 1 ? tr("FEEL")
                                            : std::string(translated(kWords[static_cast<std::size_t>(place)]));
}

std::string items_text(const HandOver& what) {
  std::string text;
  for (const HandOver::Item& item : what.items)
    text += fmt::format("{}{}{}{}", text.empty() ? "" : "   ", item.place, item.place.empty() ? "" : ": ",
                        printable(item.code));
  return text;
}

}  // namespace jnd
