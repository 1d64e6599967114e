#include "runner/opening/readiness_buttons.h"

#include <fmt/format.h>

namespace jnd {

Check check_buttons(const ButtonBox& box) {
  const ButtonMapping& mapping = box.mapping();
  Check check;
  check.what = "buttons";
  check.found =
      fmt::format("{} ({:04x}:{:04x}), {}, mapping {}", mapping.name, mapping.vendor, mapping.product,
                  box.has(ButtonMeaning::stop) ? "same, different and stop" : "same and different", mapping.sha256);
  if (box.there()) return check;
  check.verdict = Verdict::bad;
  check.found += ": unplugged";
  check.what_to_do = "plug the button box in again, or begin without --buttons: the keys answer too";
  return check;
}

}  // namespace jnd
