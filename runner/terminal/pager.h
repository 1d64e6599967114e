// Text that is longer than the terminal goes through the reader's pager.
#pragma once

#include <string>

namespace jnd {

// Prints the text on standard output. Where that is a terminal with fewer lines than the text, through $JND_PAGER, else
// $PAGER, else less where it is installed ("cat" or an empty name: none). A reader who leaves the pager early
// misses the rest; a pager that cannot be started is done without.
void print_paged(const std::string& text);

}  // namespace jnd
