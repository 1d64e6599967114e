// One thing that was looked at, and what came of it: of this machine, of a rig and its devices, of what a session needs.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/numerics/words.h"

namespace jnd {

enum class Verdict {
  ok,
  warn,
  bad,        // failed; a real session would be refused or endangered
  not_judged  // said only, such as a force that met nothing
};
constexpr std::string_view to_string(Verdict verdict) noexcept {
  constexpr auto kWords = words<Verdict>(
      {{"ok", Verdict::ok}, {"warn", Verdict::warn}, {"bad", Verdict::bad}, {"not judged", Verdict::not_judged}});
  return word_of(kWords, verdict);
}

struct Check {
  std::string what;  // was checked: "processor frequency"
  Verdict verdict = Verdict::ok;
  std::string found{};       // or measured, with its unit
  std::string what_to_do{};  // empty where there is nothing to do
  std::string limit{};       // or what was expected; empty where what_to_do says it
  std::string device{};      // whose; the rig's name for what its devices do together; empty: of the machine

  bool passed() const noexcept { return verdict != Verdict::bad; }
};
using Checks = std::vector<Check>;

// A measurement that has to be within a limit.
inline Check measured(std::string what, std::string found, std::string limit, bool ok) {
  return {.what = std::move(what),
          .verdict = ok ? Verdict::ok : Verdict::bad,
          .found = std::move(found),
          .limit = std::move(limit)};
}

}  // namespace jnd
