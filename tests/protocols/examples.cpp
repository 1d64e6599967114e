#include "tests/protocols/examples.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "protocols/reading/protocol_json.h"
#include "tests/catch.h"

namespace jnd::test {

std::filesystem::path protocols_folder() {
  return std::filesystem::path(JND_SOURCE_DIR) / "protocols";
}
std::filesystem::path corpus_folder() {
  return std::filesystem::path(JND_SOURCE_DIR) / "tests/protocols/corpus";
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  REQUIRE(stream.good());
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::vector<std::filesystem::path> json_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".json" && name.find(".schema.") == std::string::npos)
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::filesystem::path> shipped_files() {
  std::vector<std::filesystem::path> files = json_files(protocols_folder());
  const std::vector<std::filesystem::path> studies = json_files(protocols_folder() / "studies");
  files.insert(files.end(), studies.begin(), studies.end());
  return files;
}

Protocol shipped_protocol(const std::string& name) {
  for (const std::filesystem::path& file : shipped_files())
    if (file.stem() == name) return load_protocol(file);
  FAIL("no protocol is called " << name);
  return {};
}

std::string replaced(std::string text, const std::string& old, const std::string& with) {
  const std::size_t at = text.find(old);
  REQUIRE(at != std::string::npos);
  REQUIRE(text.find(old, at + 1) == std::string::npos);
  return text.replace(at, old.size(), with);
}

Protocol small_protocol(int series, int conditions, int trials_per_cell, Sampling sampling) {
  Protocol protocol;
  protocol.stimulus.reference = 900;
  for (int s = 0; s < series; ++s) protocol.series.push_back({"s" + std::to_string(s), {400.0 + 50 * s, 900.0}});
  for (int c = 0; c < conditions; ++c) {
    Condition condition;
    condition.name = "c" + std::to_string(c);
    condition.cues = {true, c % 2 == 1};
    protocol.conditions.push_back(condition);
  }
  protocol.design.trials_per_cell = trials_per_cell;
  protocol.design.sampling = sampling;
  return protocol;
}

}  // namespace jnd::test
