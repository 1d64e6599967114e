// The same work on many numbered places, by several threads, whose ends are taken in the order of the places.
#pragma once

#include <functional>

namespace jnd {

enum class Work { finished, nothing_to_do, interrupted };

// Calls work(place) for 1..places on several threads, and done(place) on the calling thread for those whose work
// finished: in order, up to the first that was interrupted. meanwhile: called by the calling thread several times a second.
// The first exception stops the rest and is thrown here.
void work_in_order(int places, int threads, const std::function<Work(int)>& work, const std::function<void(int)>& done,
                   const std::function<void()>& meanwhile = {});

}  // namespace jnd
