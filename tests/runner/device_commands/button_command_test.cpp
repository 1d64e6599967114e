// What the commands say where buttons are asked for and cannot be had.
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "runner/command_line.h"
#include "runner/terminal/exit_code.h"
#include "tests/catch.h"

namespace jnd {
namespace {

struct Folder {
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return (path / name).string();
  }
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("jnd-buttons-" + std::to_string(getpid()));
};

int jnd(std::vector<std::string> words) {
  words.insert(words.begin(), "jnd");
  std::vector<const char*> arguments;
  for (const std::string& word : words) arguments.push_back(word.c_str());
  return run_command_line(static_cast<int>(arguments.size()), arguments.data());
}

// Of a make that does not exist.
const char* const kNobodys = R"({"format": 1, "vendor": "0xfffe", "product": "0xfffe", "usage_page": "0xfffe",
  "usage": "0x0001", "name": "Nobody's", "report_id": null, "report_bytes": 1,
  "buttons": [{"meaning": "same", "byte": 0, "mask": 1, "pressed": 1},
              {"meaning": "different", "byte": 0, "mask": 2, "pressed": 2}]})";

TEST_CASE("jnd run --buttons refuses what it cannot have, and makes no study") {
  const Folder folder;
  const std::string study = (folder.path / "s.sqlite").string();
  const auto run = [&](const std::string& mapping) {
    return jnd(
        {"run", "tutorial", "--study", study, "--participant", "P01", "--plain", "--fast", "--buttons", mapping});
  };
  CHECK(run((folder.path / "missing.json").string()) == exit_code::kInvalidInput);
  CHECK(run(folder.file("wrong.json", R"({"format": 1})")) == exit_code::kInvalidInput);
  const std::string nobodys = folder.file("nobodys.json", kNobodys);
  CHECK(run(nobodys) == exit_code::kDevice);
  CHECK(jnd({"run", "tutorial", "--study", study, "--responder", "chinello2017", "--buttons", nobodys}) ==
        exit_code::kUsage);
  CHECK_FALSE(std::filesystem::exists(study));
}

TEST_CASE("jnd device learn-buttons writes over nothing, and leaves nothing behind where it cannot learn") {
  const Folder folder;
  const std::string there = folder.file("there.json", "{}"), fresh = (folder.path / "new.json").string();
  CHECK(jnd({"device", "learn-buttons"}) == exit_code::kUsage);
  CHECK(jnd({"device", "learn-buttons", "--to", there}) == exit_code::kUsage);
  CHECK(jnd({"device", "learn-buttons", "--to", (folder.path / "no/where.json").string()}) == exit_code::kStorage);
  CHECK(jnd({"device", "learn-buttons", "--to", fresh, "--debounce", "1000"}) == exit_code::kUsage);
  CHECK(jnd({"device", "learn-buttons", "--to", fresh, "--device", "/dev/no-such-device"}) == exit_code::kDevice);
  CHECK_FALSE(std::filesystem::exists(fresh));
  CHECK(std::filesystem::file_size(there) == 2);
}

}  // namespace
}  // namespace jnd
