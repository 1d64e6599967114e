#include "tests/devices/hid/firmware/codec_vector_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace jnd::codec {

namespace {

std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  if (hex.size() % 2 != 0) throw std::runtime_error("half a byte: " + hex);
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    unsigned value = 0;
    const auto [end, error] = std::from_chars(hex.data() + i, hex.data() + i + 2, value, 16);
    if (error != std::errc() || end != hex.data() + i + 2) throw std::runtime_error("no byte: " + hex);
    bytes.push_back(static_cast<std::uint8_t>(value));
  }
  return bytes;
}

Vector vector_of(const std::string& line) {
  std::istringstream words(line);
  Vector vector;
  std::string hex, word;
  words >> vector.kind;
  if (vector.kind == "refuse") words >> vector.reason;
  words >> vector.name >> hex;
  vector.bytes = bytes_of(hex);
  while (words >> word) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) throw std::runtime_error("no key=value: " + line);
    if (!vector.members.emplace(word.substr(0, equals), word.substr(equals + 1)).second)
      throw std::runtime_error("a key twice: " + line);
  }
  if (!vector.reason.empty()) {
    if (vector.members.size() != 1) throw std::runtime_error("kind=KIND and nothing else: " + line);
    vector.kind = vector.members.at("kind");
    vector.members.clear();
  }
  return vector;
}

std::vector<Vector> chosen(const std::string& kind, bool right) {
  static const std::vector<Vector> all = read_vectors();
  std::vector<Vector> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found),
               [&](const Vector& one) { return one.kind == kind && one.reason.empty() == right; });
  return found;
}

}  // namespace

std::vector<Vector> read_vectors() {
  const std::string path = std::string(JND_SOURCE_DIR) + "/devices/hid/vectors.txt";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<Vector> vectors;
  for (std::string line; std::getline(file, line);)
    if (!line.empty() && line[0] != '#') vectors.push_back(vector_of(line));
  return vectors;
}

std::vector<Vector> right_vectors(const std::string& kind) {
  return chosen(kind, true);
}

std::vector<Vector> wrong_vectors(const std::string& kind) {
  return chosen(kind, false);
}

}  // namespace jnd::codec
