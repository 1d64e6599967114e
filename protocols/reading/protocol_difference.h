// How two protocol files differ: told where a study was made with another file than the one that is given.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace jnd {

// A value that is there in one of the two only, or in both and not the same.
struct ProtocolChange {
  std::string path;           // "$.design.participants"; places in lists are the old file's, of what is added the new's
  std::string before, after;  // the whole values as JSON; empty where there is none
};

struct ProtocolDifference {
  // The documents are equal member by member, though the bytes differ: blanks, the order of members, 1.0 for 1.
  bool same_meaning = false;
  // "$.design.participants: 18 -> 24", "$.practice: added {...}", "$.breaks[1]: removed {...}", in the order of the
  // old file, then what is new; values are shortened, control characters escaped. Items of lists are compared by their
  // "id" or "name" where all of them have one ("$.conditions: the order "S", "V" -> "V", "S"" where it changed),
  // otherwise by a longest common subsequence: an item that was inserted is one difference.
  std::vector<std::string> lines;
  std::vector<ProtocolChange> changes;  // every one, in the order of the lines
};

// limit: most lines, >= 1; where there are more differences the last line says how many. `$schema` is for editors and
// is left out. Throws InputError where one of the two is not JSON.
ProtocolDifference difference_of(std::string_view old_bytes, std::string_view new_bytes, std::size_t limit = 20);

}  // namespace jnd
