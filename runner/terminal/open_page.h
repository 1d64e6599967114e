// A page in the user's browser.
#pragma once

#include <filesystem>

namespace jnd {

// Through $BROWSER where that is set, else xdg-open; does not wait for it. False where it cannot be started.
bool open_page(const std::filesystem::path& page);

}  // namespace jnd
