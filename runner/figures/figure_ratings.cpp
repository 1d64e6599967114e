// How often each level of a scale was given: bars that part at the middle of the scale.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kRatingNames = 200, kRatingPlot = 520, kRatingBar = 20, kRatingGap = 6, kQuestionGap = 36,
                 kRatingTop = 30, kRatingBelow = 56;
constexpr int kMostLevels = 11;

// Answers to one question in one condition, by level.
struct RatingBar {
  std::string name;
  std::vector<int> counts;
  int n = 0;
};

struct RatedScale {
  std::string title;
  const Question* question = nullptr;
  std::vector<RatingBar> bars;
};

int levels_of(const Question& question) {
  return static_cast<int>(std::lround(question.max - question.min)) + 1;
}

const Question* question_of(const OutcomeComparison& outcome, const Protocol& protocol) {
  const auto found = std::find_if(protocol.questions.begin(), protocol.questions.end(),
                                  [&](const Question& one) { return one.id == outcome.outcome; });
  return found == protocol.questions.end() ? nullptr : &*found;
}

// Each participant's rating, of several the mean, at the nearest level.
RatedScale rated_scale(const OutcomeComparison& outcome, const Question& question, const Protocol& protocol) {
  RatedScale scale{outcome.title, &question, {}};
  const int levels = levels_of(question);
  for (std::size_t place = 0; place < protocol.conditions.size() && place < outcome.table.k; ++place) {
    RatingBar bar{condition_text(protocol, static_cast<int>(place)), std::vector<int>(static_cast<std::size_t>(levels)),
                  0};
    for (const ParticipantValues& one : outcome.everyone) {
      if (!std::isfinite(one.values[place])) continue;
      const auto level = static_cast<int>(std::lround(one.values[place] - question.min));
      ++bar.counts[static_cast<std::size_t>(std::clamp(level, 0, levels - 1))];
      ++bar.n;
    }
    scale.bars.push_back(std::move(bar));
  }
  return scale;
}

std::vector<RatedScale> rated_scales(const StudyResults& results, const Protocol& protocol) {
  std::vector<RatedScale> scales;
  for (const OutcomeComparison& outcome : results.comparisons) {
    const Question* const question = outcome.question ? question_of(outcome, protocol) : nullptr;
    if (question == nullptr || question->kind != Question::Kind::rating || outcome.everyone.empty()) continue;
    if (question->max <= question->min || levels_of(*question) > kMostLevels) continue;
    scales.push_back(rated_scale(outcome, *question, protocol));
  }
  return scales;
}

// Stronger towards the ends of the scale: below its middle the one colour (vermilion), above it the other (sky blue).
// The same on light and dark paper, and so light that dark numbers can be read on all of them.
std::string level_fill(int level, int levels) {
  constexpr std::array<int, 3> kBelow = {0xd5, 0x5e, 0x00}, kAbove = {0x56, 0xb4, 0xe9};
  constexpr double kLightest = 0.35;
  constexpr int kWhite = 0xff;
  const double middle = 0.5 * (levels - 1), side = level - middle;
  if (side == 0) return "#c9c9c9";
  const double strength = kLightest + (1 - kLightest) * std::abs(side) / middle;
  std::string fill = "#";
  for (const int part : side < 0 ? kBelow : kAbove)
    fill += fmt::format("{:02x}", static_cast<int>(std::lround(kWhite + strength * (part - kWhite))));
  return fill;
}

// Shares below and above the middle; of an odd scale half of the middle level belongs to each.
std::pair<double, double> sides_of(const RatingBar& bar) {
  const auto levels = static_cast<int>(bar.counts.size());
  double below = 0, above = 0;
  for (int level = 0; level < levels; ++level) {
    const double share = bar.n > 0 ? static_cast<double>(bar.counts[static_cast<std::size_t>(level)]) / bar.n : 0;
    const int side = 2 * level - (levels - 1);
    below += side < 0 ? share : side == 0 ? 0.5 * share : 0;
    above += side > 0 ? share : side == 0 ? 0.5 * share : 0;
  }
  return {below, above};
}

void draw_rating_bar(Svg& svg, const RatingBar& bar, const Scale& x, double top, const Question& question) {
  svg.text(kRatingNames - 12, top + 0.7 * kRatingBar,
           fitted(fmt::format("{}  n = {}", bar.name, bar.n), kLabel.size, kRatingNames - 24), anchored(kLabel, "end"));
  if (bar.n == 0) return;
  double from = -sides_of(bar).first;
  for (std::size_t level = 0; level < bar.counts.size(); ++level) {
    const int count = bar.counts[level];
    if (count == 0) continue;
    const double to = from + static_cast<double>(count) / bar.n;
    const double left = x.at(from), right = x.at(to);
    const std::string fill = level_fill(static_cast<int>(level), static_cast<int>(bar.counts.size()));
    svg.begin("",
              fmt::format("{}: {} of {} gave {:g}", bar.name, count, bar.n, question.min + static_cast<double>(level)));
    svg.rectangle(left, top, right - left, kRatingBar,
                  {.css_class = "bar", .fill = fill, .stroke = "#ffffff", .stroke_width = 1, .dash = {}});
    const std::string text = std::to_string(count);
    if (right - left > text_width(text, kMuted.size) + 6)
      svg.text((left + right) / 2, top + 0.7 * kRatingBar, text,
               {.css_class = "on-bar", .fill = "#1a1a1a", .size = kMuted.size, .anchor = "middle"});
    svg.end();
    from = to;
  }
}

// The levels of a scale with their colours, up to `right`; returns where they begin.
double draw_levels(Svg& svg, const Question& question, double right, double baseline) {
  constexpr double kSwatch = 20, kSwatchHeight = 15;
  const int levels = levels_of(question);
  const double left = right - kSwatch * levels;
  for (int level = 0; level < levels; ++level) {
    const std::string fill = level_fill(level, levels);
    const double at = left + kSwatch * level;
    svg.rectangle(at, baseline - kSwatchHeight + 4, kSwatch, kSwatchHeight,
                  {.css_class = "bar", .fill = fill, .stroke = "#ffffff", .stroke_width = 1, .dash = {}});
    svg.text(at + kSwatch / 2, baseline, fmt::format("{:g}", question.min + level),
             {.css_class = "on-bar", .fill = "#1a1a1a", .size = kMuted.size, .anchor = "middle"});
  }
  return left;
}

double height_of(const RatedScale& scale) {
  return static_cast<double>(scale.bars.size()) * (kRatingBar + kRatingGap) + kQuestionGap;
}

std::string words_of(const RatedScale& scale) {
  std::string words = fmt::format("{}: ", scale.title);
  for (const RatingBar& bar : scale.bars) {
    const auto [below, above] = sides_of(bar);
    words += fmt::format("{} {:.0f} % below and {:.0f} % above the middle of {} answers; ", bar.name, 100 * below,
                         100 * above, bar.n);
  }
  return words;
}

}  // namespace

std::vector<Figure> rating_bar_figures(const StudyResults& results, const Protocol& protocol) {
  const std::vector<RatedScale> scales = rated_scales(results, protocol);
  if (scales.empty()) return {};
  double most = 0.5, height = 0;
  std::string description;
  for (const RatedScale& scale : scales) {
    height += height_of(scale);
    description += words_of(scale);
    for (const RatingBar& bar : scale.bars) most = std::max({most, sides_of(bar).first, sides_of(bar).second});
  }
  most = std::ceil(10 * most) / 10;
  const Scale x{-most, most, kRatingNames, kRatingNames + kRatingPlot};
  const std::string title = "Ratings, level by level";
  const double bottom = kRatingTop + height - kRatingGap;
  Svg svg("figure-ratings", kRatingNames + kRatingPlot + 24, bottom + kRatingBelow, title, description);
  const Panel panel{x.low_pixel, kRatingTop - 10, x.high_pixel, bottom};
  for (const double share : ticks_of(x, 8)) {
    svg.line(x.at(share), panel.top, x.at(share), panel.bottom, share == 0 ? kRule : kGrid);
    svg.text(x.at(share), bottom + 18, fmt::format("{:.0f} %", 100 * std::abs(share)), anchored(kMuted, "middle"));
  }
  double top = kRatingTop;
  for (const RatedScale& scale : scales) {
    const Question& question = *scale.question;
    const double levels_from = draw_levels(svg, question, x.high_pixel, top + 6);
    svg.text(12, top + 6, fitted(scale.title, kLabel.size, levels_from - 24), strong(kLabel));
    top += kQuestionGap - 18;
    for (const RatingBar& bar : scale.bars) {
      draw_rating_bar(svg, bar, x, top, question);
      top += kRatingBar + kRatingGap;
    }
    top += 18;
  }
  svg.text(x.at(0) - 14, bottom + 42, "← below the middle of the scale", anchored(kLabel, "end"));
  svg.text(x.at(0) + 14, bottom + 42, "above it →", kLabel);
  return {
      {"ratings", title,
       "Share of the participants who gave each level of a scale, stronger towards its ends, with their number where "
       "there is room. Bars part at the middle of the scale; half of those who gave the middle level stand at "
       "either side of it. Who rated more than once stands at the level nearest to their mean.",
       std::move(svg)}};
}

}  // namespace jnd
