#include "runner/study_commands/recovery_words.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "data/fields/number_text.h"
#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

namespace {

using Json = nlohmann::ordered_json;
using Align = TextTable::Align;

constexpr std::size_t kToTheSecond = 19;  // of an ISO 8601 time
constexpr std::size_t kShortName = 8;     // of a session's 32 digits: enough to find it in the table

// Where something of the file is missing, or may be, an open session may have had more events than were found.
bool in_doubt(const RecoveryReport& report) {
  return !report.doubts.empty() || report.unreadable > 0;
}

bool may_have_lost_its_end(const RecoveryReport& report, const RecoveredChain& chain) {
  return chain.events > 0 && !chain.cut && !chain.closed && in_doubt(report);
}

bool is_whole(const RecoveryReport& report, const RecoveredChain& chain) {
  return chain.events > 0 && !chain.cut && chain.telemetry_lost == 0 && !may_have_lost_its_end(report, chain);
}

std::string_view fate_of(const RecoveryReport& report, const RecoveredChain& chain) {
  if (chain.events == 0) return "lost";
  if (chain.cut) return "its end is lost";
  if (may_have_lost_its_end(report, chain)) return "open, and its end may be lost";
  return chain.closed ? "whole" : "open";
}

std::string fate_text(const RecoveryReport& report, const RecoveredChain& chain) {
  std::string text(fate_of(report, chain));
  if (chain.unchained > 0) text += fmt::format("; {} behind the gap left out", counted(chain.unchained, "event"));
  if (chain.telemetry_lost > 0) text += fmt::format("; ticks of {} lost", counted(chain.telemetry_lost, "interval"));
  return text;
}

std::string last_event(const RecoveredChain& chain) {
  if (chain.events == 0) return "-";
  return fmt::format("{}, {} UTC", chain.last_kind, chain.last_utc.substr(0, kToTheSecond));
}

// In sentences; the table has the whole of a session's name.
std::string name_of(const RecoveredChain& chain) {
  const std::string session = fmt::format("session {}", chain.session.substr(0, kShortName));
  return chain.participant.empty() ? session : fmt::format("{} ({})", chain.participant, session);
}

std::string table_of(const RecoveryReport& report) {
  TextTable table({"session", "participant", "kind", "events", "trials", "last event", "what became of it"},
                  {Align::left, Align::left, Align::left, Align::right, Align::right, Align::left, Align::left});
  for (const RecoveredChain& chain : report.sessions)
    table.add({printable(chain.session), printable(chain.participant), printable(chain.kind),
               std::to_string(chain.events), chain.trials ? std::to_string(*chain.trials) : "-",
               printable(last_event(chain)), fate_text(report, chain)});
  return table.text();
}

// A session of which something is missing, in a sentence.
std::string what_is_gone(const RecoveredChain& chain) {
  const std::string name = name_of(chain);
  if (chain.events == 0 && chain.unchained == 0)
    return fmt::format("all of {}, which was complete by the study's own events", name);
  if (chain.events == 0)
    return fmt::format("all of {}: its first event is lost, so that the {} found of it prove nothing", name,
                       counted(chain.unchained, "event"));
  if (chain.unchained > 0)
    return fmt::format(
        "of {} everything after event {}: event {} is missing or changed, so that those behind "
        "it, up to event {}, prove nothing and were left out",
        name, chain.events, chain.events + 1, chain.last_found);
  return fmt::format("of {} everything after event {}; how much that was is not known", name, chain.events);
}

std::vector<std::string> losses(const RecoveryReport& report) {
  std::vector<std::string> gone = report.doubts;
  if (report.unreadable > 0)
    gone.push_back(fmt::format("the disk did not give {}", counted(report.unreadable, "byte")));
  for (const RecoveredChain& chain : report.sessions) {
    if (chain.cut || chain.events == 0) gone.push_back(what_is_gone(chain));
    if (may_have_lost_its_end(report, chain))
      gone.push_back(fmt::format("perhaps what came in {} after event {}", name_of(chain), chain.events));
    if (chain.telemetry_lost > 0)
      gone.push_back(fmt::format("of {} the ticks of {} (the trials themselves are there)", name_of(chain),
                                 counted(chain.telemetry_lost, "interval")));
  }
  if (in_doubt(report)) gone.emplace_back("perhaps sessions of which nothing was found: they are not in the table");
  if (report.own.unchained > 0)
    gone.push_back(
        fmt::format("{} of the study itself could be read but not proved: exclusions, notes or an unblinding "
                    "may be among them; study.recovered keeps their text",
                    counted(report.own.unchained, "event")));
  return gone;
}

template <typename Asked>
std::vector<std::string> names_where(const RecoveryReport& report, Asked asked) {
  std::vector<std::string> names;
  for (const RecoveredChain& chain : report.sessions)
    if (asked(chain)) names.push_back(name_of(chain));
  return names;
}

std::vector<std::string> next_steps(const RecoveryFiles& files, const RecoveryReport& report) {
  const std::string to = shell_word(files.to);
  if (report.whole())
    return {fmt::format("Go on with {}, and keep {} until the new study has a backup.", files.to, files.damaged)};
  std::vector<std::string> steps = {fmt::format("Keep {}{}.", files.damaged,
                                                report.unreadable > 0 || report.pages_missing > 0
                                                    ? ", and copy it to another disk: this one may fail further"
                                                    : "")};
  if (const auto damaged = names_where(report, [&](const RecoveredChain& chain) { return !is_whole(report, chain); });
      !damaged.empty())
    steps.push_back(
        fmt::format("Look into the latest backup (jnd status BACKUP): it may have more of {}. A session can be taken "
                    "from one of the two files only: jnd merge refuses it twice.",
                    fmt::join(damaged, ", ")));
  else
    steps.emplace_back("Look into the latest backup (jnd status BACKUP): it may have sessions that are missing here.");
  if (const auto open = names_where(
          report,
          [&](const RecoveredChain& chain) { return chain.events > 0 && !chain.closed && !is_whole(report, chain); });
      !open.empty())
    steps.push_back(
        fmt::format("Open in the new study, after their last event above: {}. Take each up with jnd run "
                    "--study {}, or leave the participant out with jnd exclude {}.",
                    fmt::join(open, ", "), to, to));
  if (report.own.cut)
    steps.push_back(
        fmt::format("Compare with the lab book what was noted, excluded or unblinded, and say again what "
                    "is missing: jnd note, jnd exclude and jnd unblind {}.",
                    to));
  steps.push_back(fmt::format("Look through the new study: jnd verify {} --deep", to));
  return steps;
}

void add_paragraph(std::string& text, std::string_view mark, const std::string& words, std::size_t columns) {
  const std::string indent(mark.size(), ' ');
  const std::size_t room = columns > 2 * mark.size() ? columns - mark.size() : words.size() + 1;
  std::string_view before = mark;
  for (const std::string& line : wrapped_words(printable(words), std::max<std::size_t>(room, 1))) {
    text += fmt::format("{}{}\n", before, line);
    before = indent;
  }
}

std::int64_t trials_of(const RecoveryReport& report) {
  std::int64_t trials = 0;
  for (const RecoveredChain& chain : report.sessions) trials += chain.trials.value_or(0);
  return trials;
}

std::string summary(const RecoveryReport& report) {
  const auto whole = std::count_if(report.sessions.begin(), report.sessions.end(),
                                   [&](const RecoveredChain& chain) { return is_whole(report, chain); });
  std::string text = fmt::format(
      "{}{} with {}; {} of {} {} whole", counted(report.events_found, "event"),
      report.events_added && *report.events_added > report.events_found ? fmt::format(" of {}", *report.events_added)
                                                                        : "",
      counted(trials_of(report), "trial"), whole, counted(static_cast<std::int64_t>(report.sessions.size()), "session"),
      whole == 1 ? "is" : "are");
  if (report.pages)
    text += fmt::format("; {} of {} of the file were there", *report.pages - report.pages_missing,
                        counted(*report.pages, "page"));
  return text + ".";
}

Json chain_json(const RecoveryReport& report, const RecoveredChain& chain) {
  Json last;  // null where none is left
  if (chain.events > 0) last = {{"seq", chain.events}, {"kind", chain.last_kind}, {"utc", chain.last_utc}};
  return {{"session", chain.session},
          {"participant", chain.participant},
          {"kind", chain.kind},
          {"events", chain.events},
          {"trials", chain.trials ? Json(*chain.trials) : Json()},
          {"last_event", last},
          {"last_found", chain.last_found},
          {"unchained", chain.unchained},
          {"telemetry", chain.telemetry},
          {"telemetry_lost", chain.telemetry_lost},
          {"closed", chain.closed},
          {"cut", chain.cut},
          {"fate", std::string(fate_of(report, chain))}};
}

}  // namespace

std::string recovery_text(const RecoveryFiles& files, const RecoveryReport& report,
                          const std::vector<std::string>& problems, std::size_t columns) {
  std::string text =
      fmt::format("{}: {}\n", bold(printable(files.to)),
                  report.whole() ? "everything that is known of was recovered" : "what could be read was recovered");
  add_paragraph(text, "  ", summary(report), columns);
  text += table_of(report);
  if (const std::vector<std::string> gone = losses(report); !gone.empty()) {
    text += fmt::format("{}\n", warn("Lost, or in doubt:"));
    for (const std::string& one : gone) add_paragraph(text, "  - ", one, columns);
  }
  for (const std::string& problem : problems) add_paragraph(text, "problem: ", problem, columns);
  text += "What to do next:\n";
  for (const std::string& step : next_steps(files, report)) add_paragraph(text, "  - ", step, columns);
  return text;
}

Json recovery_json(const RecoveryFiles& files, const RecoveryReport& report, const std::vector<std::string>& problems) {
  Json out = {{"to", files.to},
              {"whole", report.whole()},
              {"unreadable_bytes", report.unreadable},
              {"pages", report.pages ? Json(*report.pages) : Json()},
              {"pages_missing", report.pages ? Json(report.pages_missing) : Json()},
              {"events_added", report.events_added ? Json(*report.events_added) : Json()},
              {"events_found", report.events_found},
              {"study_events", report.own.events},
              {"study_events_unchained", report.own.unchained},
              {"study_events_cut", report.own.cut},
              {"sessions", Json::array()},
              {"doubts", report.doubts},
              {"problems", problems}};
  for (const RecoveredChain& chain : report.sessions) out["sessions"].push_back(chain_json(report, chain));
  return out;
}

}  // namespace jnd
