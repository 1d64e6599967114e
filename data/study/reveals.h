// What a sentence or a column tells of a blinded study.
#pragma once

namespace jnd {

// Whatever is not made with `nothing` stays sealed while a study is blinded.
enum class Reveals {
  nothing,  // of conditions, stimuli, answers and the seed
  plan
};

}  // namespace jnd
