// The figures of a study's report, each one SVG picture with the words around it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/raw_trials/press_traces.h"
#include "data/results/study_results.h"
#include "protocols/protocol.h"
#include "runner/drawing/svg.h"

namespace jnd {

struct Figure {
  std::string id;       // of a-z, 0-9 and '-': "jnd", "slopes-2"; the name of its file too
  std::string title;    // "JND by condition"
  std::string caption;  // plain sentences: what the marks are, who is not among them
  Svg svg;
  std::optional<Svg> narrow{};  // the same with its panels below one another, for the width of a phone
};

// A figure of more participants than one picture can hold goes on in further ones.
struct FigurePage {
  std::string id, title;  // "slopes-2", "d' against the difference (2 of 3)"; as they are where there is one page
  std::size_t from = 0, to = 0;  // of what is shown: from..to-1
};
// Of every participant a panel or a line: so many in a figure, and in all.
inline constexpr std::size_t kPeopleInFigure = 24, kMostPeopleDrawn = 96;
// count things, at most per_page (> 0) of them on each page, at least one page.
std::vector<FigurePage> figure_pages(std::string_view id, std::string_view title, std::size_t count,
                                     std::size_t per_page);
// " The first 96 of 120 participants.": what a caption ends with where not everyone is drawn; otherwise empty.
std::string first_of(std::size_t shown, std::size_t everyone);

// Each function returns no figure where there is nothing to draw. protocol: the study's.

// Figure 5 of the paper: mean and 95 % interval by condition, with every participant, the within-subject interval and
// the published values. Who has no JND stands at the edges, counted.
std::vector<Figure> jnd_figures(const StudyResults& results, const Protocol& protocol);
// The registered outcome of every other task by condition, in the same form.
std::vector<Figure> outcome_figures(const StudyResults& results, const Protocol& protocol);

// Where the conditions differ in one number, such as a delay: the registered outcome against it, and of tasks that
// compare something else the JND.
std::vector<Figure> parameter_figures(const StudyResults& results, const Protocol& protocol);
// Where a condition has the cues of two others together: its JND against that of an optimal combination of the two.
std::vector<Figure> combination_figures(const StudyResults& results, const Protocol& protocol);

// d' against the stiffness difference with the fitted line, a panel for every participant, 24 a figure; for more than
// 96 participants a panel for every condition instead, with everyone in it.
std::vector<Figure> slope_figures(const StudyResults& results, const Protocol& protocol);

// Hit rate against false-alarm rate with lines of equal d', a panel for every condition and series. For at most five
// conditions.
std::vector<Figure> roc_figures(const StudyResults& results, const Protocol& protocol);
// Each registered contrast with its interval, on the scale on which it is tested.
std::vector<Figure> contrast_figures(const StudyResults& results, const Protocol& protocol);
// Of the hierarchical model, where it was added to the results: each participant's separate JND joined to the shrunken
// one, beside the group's; and every ratio of two conditions.
std::vector<Figure> hierarchical_figures(const StudyResults& results, const Protocol& protocol);
std::vector<Figure> ratio_figures(const StudyResults& results, const Protocol& protocol);
// The same model's posterior predictive check: the share of "different" over the differences, beside what it draws.
std::vector<Figure> predictive_figures(const StudyResults& results, const Protocol& protocol);
// Where the answers set the levels: the levels of every track, a panel for every participant.
std::vector<Figure> track_figures(const StudyResults& results, const Protocol& protocol);

// Every counted answer of every participant in the order in which it was given: what was said, and whether it was right.
std::vector<Figure> raster_figures(const StudyResults& results, const Protocol& protocol);

// The share of an answer over the levels of a task, with the fitted curve.
std::vector<Figure> curve_figures(const StudyResults& results, const Protocol& protocol);

std::vector<Figure> time_figures(const StudyResults& results, const Protocol& protocol);
// One for each rating question that was compared over the conditions.
std::vector<Figure> rating_figures(const StudyResults& results, const Protocol& protocol);
// How often each level of the rating scales was given, by condition.
std::vector<Figure> rating_bar_figures(const StudyResults& results, const Protocol& protocol);
// The effect of the order of the two objects, the preference for an answer, the change within blocks, by condition and
// participant.
std::vector<Figure> behaviour_figures(const StudyResults& results, const Protocol& protocol);
// The median JND under every model, method and correction.
std::vector<Figure> sensitivity_figures(const StudyResults& results, const Protocol& protocol);

// Force against depth of some trials, a panel each.
std::vector<Figure> press_figures(const ShownPresses& presses, const Protocol& protocol);
inline constexpr std::size_t kMostPresses = 12;  // more are not shown

// All of them, in the order in which they are read. presses: trials whose ticks were kept; may be none.
std::vector<Figure> study_figures(const StudyResults& results, const Protocol& protocol,
                                  const ShownPresses& presses = {});

}  // namespace jnd
