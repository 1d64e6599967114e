#include "runner/terminal/plot_axis.h"

#include <cctype>
#include <cstdlib>

#include <fmt/format.h>
#include <unistd.h>

#include "runner/terminal/terminal.h"
#include "runner/terminal/text_table.h"

namespace jnd {

Canvas canvas_of_terminal() {
  Canvas canvas{.columns = std::clamp(terminal_width() - 1, kNarrowestPlot, kWidestPlot)};
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(variable);
    if (value == nullptr || *value == '\0') continue;
    std::string locale(value);
    std::transform(locale.begin(), locale.end(), locale.begin(),
                   [](unsigned char character) { return static_cast<char>(std::tolower(character)); });
    canvas.unicode = locale.find("utf-8") != std::string::npos || locale.find("utf8") != std::string::npos;
    break;
  }
  canvas.unicode = canvas.unicode && is_terminal(STDOUT_FILENO);
  return canvas;
}

std::vector<double> axis_ticks(double low, double high, int wanted) {
  std::vector<double> ticks;
  if (!(high > low) || !std::isfinite(high - low)) return ticks;
  const double rough = (high - low) / std::max(1, wanted);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= rough * (1 - 1e-9)) {
      step = digit * power;
      break;
    }
  const double slack = 1e-9 * step;
  // NOLINTNEXTLINE(cert-flp30-c)
  for (double index = std::ceil((low - slack) / step); index * step <= high + slack; ++index)
    ticks.push_back(index * step);
  return ticks;
}

std::string tick_text(double value, double step) {
  if (std::abs(value) < 1e-9 * step) value = 0;
  return fmt::format("{:.6g}", value);
}

std::vector<double> ticks_of(const Axis& axis, int wanted) {
  if (!axis.logarithmic) return axis_ticks(axis.low, axis.high, wanted);
  std::vector<double> ticks, decades;
  for (int exponent = static_cast<int>(std::floor(std::log10(axis.low))); std::pow(10.0, exponent) <= axis.high;
       ++exponent)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double tick = digit * std::pow(10.0, exponent);
      if (tick < axis.low * (1 - 1e-9) || tick > axis.high * (1 + 1e-9)) continue;
      ticks.push_back(tick);
      if (digit == 1.0) decades.push_back(tick);
    }
  if (static_cast<int>(ticks.size()) > 2 * wanted) return decades;
  return ticks;
}

std::string padded_left(const std::string& text, std::size_t width) {
  return std::string(width - std::min(width, display_width(text)), ' ') + text;
}

XAxisText x_axis(const Axis& axis, int columns, bool unicode) {
  const std::vector<double> ticks = ticks_of(axis, std::max(2, columns / 12));
  const double step = ticks.size() > 1 ? std::abs(ticks[1] - ticks[0]) : 1;
  std::vector<std::string> rule(static_cast<std::size_t>(columns), unicode ? "─" : "-");
  std::string labels;
  for (const double tick : ticks) {
    const auto at = static_cast<std::size_t>(place(axis.share(tick), columns));
    rule[at] = unicode ? "┬" : "+";
    const std::string text = tick_text(tick, step);
    if (text.size() > rule.size()) continue;
    // Under its tick, but never past either end of the axis.
    const std::size_t centred = at >= text.size() / 2 ? at - text.size() / 2 : 0;
    const std::size_t begin = std::min(centred, rule.size() - text.size());
    if (!labels.empty() && begin < labels.size() + 2) continue;
    labels += std::string(begin - labels.size(), ' ') + text;
  }
  XAxisText text{.rule = {}, .labels = labels};
  for (const std::string& character : rule) text.rule += character;
  return text;
}

std::string centred_under(const std::string& label, std::size_t gutter, int columns) {
  const auto width = static_cast<std::size_t>(columns);
  const std::size_t before = gutter + (width > label.size() ? (width - label.size()) / 2 : 0);
  return std::string(before, ' ') + label + "\n";
}

}  // namespace jnd
