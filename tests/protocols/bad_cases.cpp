#include "tests/protocols/bad_cases.h"

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "tests/catch.h"
#include "tests/protocols/examples.h"

namespace jnd::test {
namespace {

// Replaces each \xNN by its byte.
std::string with_bytes(std::string text) {
  for (std::size_t at = text.find("\\x"); at != std::string::npos; at = text.find("\\x", at + 1))
    text.replace(at, 4, 1, static_cast<char>(std::stoi(text.substr(at + 2, 2), nullptr, 16)));
  return text;
}

// Reads "LINE:COLUMN PATH: MESSAGE", or "LINE:COLUMN MESSAGE" for an error without a path.
Diagnostic expected_error(const std::string& line) {
  const std::size_t colon = line.find(':'), space = line.find(' ');
  REQUIRE(colon < space);
  Diagnostic error{"", std::stoi(line), std::stoi(line.substr(colon + 1)), "", line.substr(space + 1), ""};
  if (error.message.front() == '$') {
    const std::size_t end = error.message.find(": ");
    REQUIRE(end != std::string::npos);
    error.path = error.message.substr(0, end);
    error.message.erase(0, end + 2);
  }
  return error;
}

// Reads one case: "case NAME[ of BASE], schema VERDICT", then edits (or the whole text), then errors.
BadCase read_case(const std::vector<std::string>& lines) {
  const std::string& head = lines.front();
  const std::size_t of = head.find(" of "), comma = head.find(", schema ");
  REQUIRE(comma != std::string::npos);
  BadCase read{head.substr(5, std::min(of, comma) - 5), "", head.substr(comma + 9), {}};
  if (of != std::string::npos)
    read.text = read_text(corpus_folder() / "good" / (head.substr(of + 4, comma - of - 4) + ".json"));
  std::string before = "\n", after = "\n";  // of the present edit, as whole lines
  std::vector<std::string> whole;
  const auto edit = [&] {
    if (before != after) read.text = replaced("\n" + read.text, before, after).substr(1);
    before = after = "\n";
  };
  for (const std::string& line : lines) {
    const std::string rest = line.substr(1);
    switch (line.front()) {
      case ' ':
        before += rest + "\n", after += rest + "\n";
        break;
      case '-':
        before += rest + "\n";
        break;
      case '+':
        after += with_bytes(rest) + "\n";
        break;
      case '@':
        edit();
        break;
      case '=':
        whole.push_back(with_bytes(rest));
        break;
      case '>':
        read.errors.push_back(expected_error(line.substr(2)));
        break;
      default:
        REQUIRE(line == head);
    }
  }
  edit();
  for (const std::string& line : whole) read.text += (&line == &whole.front() ? "" : "\n") + line;
  return read;
}

}  // namespace

std::map<std::string, BadCase> bad_cases() {
  std::map<std::string, BadCase> cases;
  for (const auto& entry : std::filesystem::directory_iterator(corpus_folder() / "bad")) {
    std::istringstream file(read_text(entry.path()) + "\n\n");
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) {
      if (!line.empty() && line.front() != '#') lines.push_back(line);
      if (!line.empty() || lines.empty()) continue;
      INFO(entry.path().filename().string() << ": " << lines.front());
      BadCase read = read_case(lines);
      REQUIRE(cases.emplace(read.name, read).second);
      lines.clear();
    }
  }
  return cases;
}

}  // namespace jnd::test
