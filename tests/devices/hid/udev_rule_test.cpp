// The udev rule that is shipped, printed and explained is one and the same; and what doctor says of trackers.
#include "devices/hid/udev_rule.h"

#include <fstream>
#include <set>
#include <string>

#include "tests/catch.h"

using namespace jnd;

TEST_CASE("a rule names bus, vendor and product in capital digits") {
  CHECK(udev_rule(0x1209, 0x5afe) ==
        "KERNEL==\"hidraw*\", SUBSYSTEM==\"hidraw\", KERNELS==\"0003:1209:5AFE.*\", MODE=\"0660\", "
        "GROUP=\"plugdev\", TAG+=\"uaccess\"");
  CHECK(udev_rule(0x46d, 0xb, 5).find("\"0005:046D:000B.*\"") != std::string::npos);
}

TEST_CASE("the shipped file holds the rules of the virtual devices and nothing else") {
  const std::string name = std::string(kUdevRulesPath).substr(std::string(kUdevRulesPath).rfind('/') + 1);
  CHECK(name < "73-seat-late.rules");  // which acts on uaccess
  std::ifstream file(std::string(JND_SOURCE_DIR) + "/devices/hid/" + name);
  REQUIRE(file);
  std::set<std::string> rules;
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line[0] != '#') rules.insert(line);
  CHECK(rules == std::set<std::string>{udev_rule(0x1209, 0x5AFE), udev_rule(0x1209, 0x5AFF)});
}
