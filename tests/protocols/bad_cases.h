// The bad protocols of tests/protocols/corpus/bad, each written as edits of a good one.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "protocols/input/input_error.h"

namespace jnd::test {

// A bad protocol. schema: refuses, accepts or unreadable. Its errors hold line, column, path and a part of the message.
struct BadCase {
  std::string name, text, schema;
  std::vector<Diagnostic> errors;
};

// All cases by name. tests/README.md says how a case is written.
std::map<std::string, BadCase> bad_cases();

}  // namespace jnd::test
