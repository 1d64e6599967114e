// Two cues together against what they would come to if they were combined optimally.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/numerics/moments.h"
#include "data/results/cue_combination.h"
#include "runner/drawing/figure_axis.h"
#include "runner/drawing/figure_style.h"
#include "runner/figures/figure.h"
#include "runner/results/result_format.h"

namespace jnd {

namespace {

constexpr double kCombinationLeft = 66, kCombinationTop = 16, kCombinationSide = 360, kCombinationRight = 30,
                 kCombinationBelow = 54;

std::vector<const CombinedParticipant*> with_both(const CueCombination& combination) {
  std::vector<const CombinedParticipant*> complete;
  for (const CombinedParticipant& one : combination.participants)
    if (one.predicted && one.observed) complete.push_back(&one);
  return complete;
}

double geometric_mean(const std::vector<const CombinedParticipant*>& people,
                      std::optional<double> CombinedParticipant::*value) {
  double sum = 0;
  for (const CombinedParticipant* one : people) sum += std::log(*(one->*value));
  return std::exp(sum / static_cast<double>(people.size()));
}

std::string ratio_text(const MeanEstimate& log_ratio) {
  std::string text = number_text(std::exp(log_ratio.mean), 2);
  if (std::isfinite(log_ratio.ci_low))
    text += fmt::format(" ({})", range_text(std::exp(log_ratio.ci_low), std::exp(log_ratio.ci_high), 2));
  return text;
}

void draw_group(Svg& svg, const CueCombination& combination, const std::vector<const CombinedParticipant*>& people,
                const Scale& x, const Scale& y) {
  const double predicted = geometric_mean(people, &CombinedParticipant::predicted);
  const double observed = geometric_mean(people, &CombinedParticipant::observed);
  const MeanEstimate& ratio = combination.log_ratio;
  svg.begin("mean", fmt::format("geometric means: observed / predicted {}, n = {}", ratio_text(ratio), ratio.n));
  if (std::isfinite(ratio.ci_low)) {
    const double low = y.clipped(predicted * std::exp(ratio.ci_low));
    const double high = y.clipped(predicted * std::exp(ratio.ci_high));
    svg.line(x.clipped(predicted), low, x.clipped(predicted), high, kInk);
    for (const double end : {low, high}) svg.line(x.clipped(predicted) - 5, end, x.clipped(predicted) + 5, end, kInk);
  }
  svg.circle(x.clipped(predicted), y.clipped(observed), 5, kInkFill);
  svg.end();
}

// Up to where the axes go: to the largest JND, unless it is so far off that it would squeeze the others together.
double most_shown(const std::vector<const CombinedParticipant*>& people) {
  constexpr double kFar = 4;  // medians
  std::vector<double> values;
  for (const CombinedParticipant* one : people) values.insert(values.end(), {*one->predicted, *one->observed});
  const double limit = kFar * median_of(values);
  double most = 0;
  for (const double value : values)
    if (value <= limit) most = std::max(most, value);
  return most;
}

// At the edge where it lies beyond the axes, with its name.
void draw_combined(Svg& svg, const CombinedParticipant& one, int condition, const Scale& x, const Scale& y) {
  const double at_x = x.clipped(*one.predicted), at_y = y.clipped(*one.observed);
  const std::string words =
      fmt::format("predicted {}, observed {}", size_text(*one.predicted), size_text(*one.observed));
  svg.begin("", fmt::format("{}: {}", one.participant, words));
  draw_marker(svg, condition, at_x, at_y, 4.5, condition_hollow(condition));
  if (!x.inside(*one.predicted) || !y.inside(*one.observed)) {
    const bool right = at_x > (x.low_pixel + x.high_pixel) / 2;
    svg.text(at_x + (right ? -10 : 10), std::max(at_y + 4, y.high_pixel + 14),
             fmt::format("{}: {}", one.participant, words), anchored(kMuted, right ? "end" : "start"));
  }
  svg.end();
}

Figure combination_figure(const CueCombination& combination, std::size_t number, bool several,
                          const Protocol& protocol) {
  const std::string a = condition_text(protocol, combination.a), b = condition_text(protocol, combination.b);
  const std::string both = condition_text(protocol, combination.both);
  const std::vector<const CombinedParticipant*> people = with_both(combination);
  const Range range = round_range(0, most_shown(people), 5);
  const Panel panel{kCombinationLeft, kCombinationTop, kCombinationLeft + kCombinationSide,
                    kCombinationTop + kCombinationSide};
  const Scale x{range.low, range.high, panel.left, panel.right};
  const Scale y{range.low, range.high, panel.bottom, panel.top};
  const std::string id = several ? fmt::format("combination-{}", number) : "combination";
  const std::string title = fmt::format("{} against {} and {} combined", both, a, b);
  std::string description =
      fmt::format("Observed / predicted, geometric mean: {}. ", ratio_text(combination.log_ratio));
  for (const CombinedParticipant* one : people)
    description += fmt::format("{}: predicted {}, observed {}. ", one->participant, size_text(*one->predicted),
                               size_text(*one->observed));
  Svg svg("figure-" + id, panel.right + kCombinationRight, panel.bottom + kCombinationBelow, title, description);
  draw_grid_rows(svg, panel, y, 5);
  draw_grid_columns(svg, panel, x, 5);
  svg.rectangle(panel.left, panel.top, panel.width(), panel.height(), kFrame);
  svg.line(panel.left, panel.bottom, panel.right, panel.top, kRule);
  draw_x_axis(svg, panel, x, fmt::format("JND predicted from {} and {} ({})", a, b, unit_of(protocol)), 5);
  draw_y_axis(svg, panel, y, fmt::format("JND observed in {} ({})", both, unit_of(protocol)), 5);
  for (const CombinedParticipant* one : people) draw_combined(svg, *one, combination.both, x, y);
  draw_group(svg, combination, people, x, y);
  std::string missing, far;
  for (const CombinedParticipant& one : combination.participants) {
    if (!one.predicted || !one.observed)
      missing += (missing.empty() ? "" : ", ") + one.participant;
    else if (!x.inside(*one.predicted) || !y.inside(*one.observed))
      far += (far.empty() ? "" : ", ") + one.participant;
  }
  return {
      id, title,
      fmt::format("Each participant's JND in {0} against the one that an optimal combination of {1} and {2} would "
                  "have (independent noise: 1 / JND² adds; Ernst and Banks 2002, Nature 415:429). On the dotted "
                  "line both are equal, above it the cues together are worse than optimal. The full mark: geometric "
                  "means, with the 95 % confidence interval (Student t of the logarithms) of observed / predicted, "
                  "{3}.{4}{5}",
                  both, a, b, ratio_text(combination.log_ratio),
                  far.empty() ? "" : fmt::format(" Off the scale, at its edge: {}.", far),
                  missing.empty() ? "" : fmt::format(" Without a JND in one of the three: {}.", missing)),
      std::move(svg)};
}

}  // namespace

std::vector<Figure> combination_figures(const StudyResults& results, const Protocol& protocol) {
  std::vector<CueCombination> combinations = results.combinations;
  std::erase_if(combinations, [](const CueCombination& one) { return one.log_ratio.n == 0; });
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < combinations.size(); ++i)
    figures.push_back(combination_figure(combinations[i], i + 1, combinations.size() > 1, protocol));
  return figures;
}

}  // namespace jnd
