// Runs every file of the corpora through its target, as the fuzzers do.
//
// Usage: fuzz_replay CORPUS_FOLDER
#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

extern "C" {
int fuzz_protocol(const std::uint8_t* data, std::size_t size);
int fuzz_profile(const std::uint8_t* data, std::size_t size);
int fuzz_csv(const std::uint8_t* data, std::size_t size);
int fuzz_trials(const std::uint8_t* data, std::size_t size);
int fuzz_trace(const std::uint8_t* data, std::size_t size);
int fuzz_events(const std::uint8_t* data, std::size_t size);
int fuzz_keys(const std::uint8_t* data, std::size_t size);
int fuzz_report(const std::uint8_t* data, std::size_t size);
int fuzz_rig_line(const std::uint8_t* data, std::size_t size);
}

namespace {

struct Target {
  const char* name;
  int (*run)(const std::uint8_t* data, std::size_t size);
};

constexpr std::array kTargets = {
    Target{"protocol", fuzz_protocol}, Target{"profile", fuzz_profile}, Target{"csv", fuzz_csv},
    Target{"trials", fuzz_trials},     Target{"trace", fuzz_trace},     Target{"events", fuzz_events},
    Target{"keys", fuzz_keys},         Target{"report", fuzz_report},   Target{"rig_line", fuzz_rig_line}};

// Returns how many files there were; a property that does not hold aborts.
int replay(const Target& target, const std::filesystem::path& corpora) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(corpora / target.name)) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    std::fprintf(stderr, "%s\n", entry.path().c_str());  // the last one is the one that failed
    const std::vector<std::uint8_t> input(bytes.begin(), bytes.end());
    target.run(input.data(), input.size());
    ++files;
  }
  return files;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  try {
    for (const Target& target : kTargets) {
      const int files = replay(target, arguments[1]);
      std::printf("%s: %d files\n", target.name, files);
      if (files == 0) return 1;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_replay: %s\n", error.what());
    return 1;
  }
  return 0;
}
