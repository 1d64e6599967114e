// Curves of power over the designs of a power study, as an SVG picture.
#pragma once

#include "runner/drawing/svg.h"
#include "runner/power/power_result.h"

namespace jnd {

// A column for each contrast; a row for each of the designs that differ in more than what stands on the x axis, which is
// the longest list of the question: participants, trials or effects. Bars are exact 95 % intervals; the dashed line
// is the wanted power.
Svg power_figure(const PowerResult& result);

}  // namespace jnd
