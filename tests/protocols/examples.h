// Protocols for tests: shipped files, corpus files, and small ones made in code.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocols/protocol.h"

namespace jnd::test {

std::filesystem::path protocols_folder();
std::vector<std::filesystem::path> shipped_files();  // the protocols in it, and in its folder of studies
Protocol shipped_protocol(const std::string& name);
std::filesystem::path corpus_folder();
std::string read_text(const std::filesystem::path& path);
// All *.json files of a folder except the schema, sorted.
std::vector<std::filesystem::path> json_files(const std::filesystem::path& folder);
// Replaces the only occurrence of `old`; fails the test where there is not exactly one.
std::string replaced(std::string text, const std::string& old, const std::string& with);

// `series` series (400 + 50 i, 900) named s0.. and `conditions` conditions named c0..; made in code, not linted.
Protocol small_protocol(int series, int conditions, int trials_per_cell, Sampling sampling);

}  // namespace jnd::test
