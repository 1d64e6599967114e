// The style sheet of the report's page: on screen, in dark mode and in print.
#pragma once

#include <string_view>

namespace jnd {

// CSS without any url(): the page fetches nothing.
std::string_view report_style() noexcept;

}  // namespace jnd
