// Which processors there are, as Linux writes them, and which one a real-time thread takes.
#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "devices/realtime.h"

namespace jnd {

namespace {

constexpr int kMostProcessors = 8192;  // Linux's own largest NR_CPUS

bool read_number(std::string_view& text, int& number) noexcept {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || number < 0 || number >= kMostProcessors) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return true;
}

}  // namespace

std::vector<int> parse_processor_list(std::string_view text) {
  const auto last = text.find_last_not_of(" \n\t");
  text = text.substr(0, last == std::string_view::npos ? 0 : last + 1);
  std::vector<int> processors;
  while (!text.empty()) {
    int from = 0;
    if (!read_number(text, from)) return {};
    int to = from;
    if (text.starts_with('-')) {
      text.remove_prefix(1);
      if (!read_number(text, to) || to < from) return {};
    }
    for (int processor = from; processor <= to; ++processor) processors.push_back(processor);
    if (text.empty()) break;
    if (!text.starts_with(',') || text.size() == 1) return {};
    text.remove_prefix(1);
  }
  std::sort(processors.begin(), processors.end());
  processors.erase(std::unique(processors.begin(), processors.end()), processors.end());
  return processors;
}

std::string processor_list_text(const std::vector<int>& processors) {
  std::string text;
  for (std::size_t i = 0; i < processors.size();) {
    std::size_t end = i + 1;
    while (end < processors.size() && processors[end] == processors[end - 1] + 1) ++end;
    if (!text.empty()) text += ',';
    text += end - i == 1 ? std::to_string(processors[i]) : fmt::format("{}-{}", processors[i], processors[end - 1]);
    i = end;
  }
  return text;
}

std::optional<int> choose_processor(const std::vector<int>& allowed, const std::vector<int>& isolated) noexcept {
  if (!isolated.empty()) return isolated.back();
  if (allowed.size() < 2) return std::nullopt;
  return allowed.back();
}

}  // namespace jnd
