#include "data/log/trial_body.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

// simdjson's headers do not compile cleanly under our warnings.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#include <simdjson.h>
#pragma GCC diagnostic pop

#include "analysis/numerics/special_values.h"
#include "data/log/storage_error.h"
#include "protocols/course/prescription.h"

namespace jnd {

namespace {

namespace od = simdjson::ondemand;

constexpr std::array<std::string_view, 4> kNeeded = {"series_place", "condition_place", "target", "answer"};

// null is a number that could not be computed.
double number(od::value value) {
  double result = kNaN;
  return value.get(result) == simdjson::SUCCESS ? result : kNaN;
}

// The key as it is written: ours hold no escapes, and one that does matches none of them.
std::string_view raw_key(od::field& field) {
  const char* begin = field.key().raw();
  return {begin, static_cast<std::size_t>(std::strchr(begin, '"') - begin)};
}

struct Mean {
  double sum = 0;
  int n = 0;
  void add(double value) noexcept {
    if (std::isnan(value)) return;
    sum += value;
    ++n;
  }
  double value() const noexcept { return n > 0 ? sum / n : kNaN; }
};

}  // namespace

struct TrialBodyReader::Impl {
  std::string stiffness;
  od::parser parser;
  std::vector<char> padded;

  IntervalCues interval(od::value presentation) const;
  // Returns the bit of a field that no trial can do without, 0 for the others.
  unsigned field(std::string_view key, od::value value, CountedTrial& trial) const;
};

IntervalCues TrialBodyReader::Impl::interval(od::value presentation) const {
  Mean fitted, work, dwell;
  double peak = kNaN;
  for (od::field entry : presentation.get_object()) {
    if (raw_key(entry) != "fingers") continue;
    for (auto finger : entry.value().get_array()) {
      for (od::field member : finger.get_object()) {
        const std::string_view key = raw_key(member);
        if (key == stiffness) {
          fitted.add(number(member.value()));
        } else if (key == "peak_force_n") {
          peak = std::fmax(peak, number(member.value()));
        } else if (key == "work_j") {
          work.add(number(member.value()));
        } else if (key == "dwell_s") {
          dwell.add(number(member.value()));
        }
      }
    }
  }
  return {fitted.value(), peak, work.value(), dwell.value()};
}

unsigned TrialBodyReader::Impl::field(std::string_view key, od::value value, CountedTrial& trial) const {
  const auto whole = [&value] {
    const std::int64_t number = value.get_int64();
    if (!std::in_range<int>(number)) throw simdjson::simdjson_error(simdjson::NUMBER_OUT_OF_RANGE);
    return static_cast<int>(number);
  };
  const auto is = [&value](std::string_view word) { return std::string_view(value.get_string()) == word; };
  if (key == kNeeded[0]) return trial.series = whole(), 1U;
  if (key == kNeeded[1]) return trial.condition = whole(), 2U;
  if (key == kNeeded[2]) return trial.target = value.is_null() ? -1 : whole(), 4U;
  if (key == kNeeded[3]) {
    if (value.type() == od::json_type::number) trial.number = value.get_double().value();
    return 8U;
  }
  if (key == "said") {
    trial.said = whole();
  } else if (key == "sureness") {
    trial.sureness = whole();
  } else if (key.starts_with("stimulus_")) {
    const std::size_t interval = key.size() > 9 ? static_cast<std::size_t>(key[9] - '1') : kMostIntervals;
    if (interval < kMostIntervals) {
      while (trial.asked.size() <= interval) trial.asked.push_back(kNaN);
      trial.asked[interval] = number(value);
    }
  } else if (key == "standard") {
    trial.standard = number(value);
  } else if (key == "standard_place") {
    trial.standard_place = whole();
  } else if (key == "index") {
    trial.index = whole();
  } else if (key == "practice") {
    trial.practice = value.get_bool();
  } else if (key == "entered_by") {
    trial.by_participant = is(to_string(EnteredBy::participant));
  } else if (key == "response_time_s") {
    trial.response_time_s = number(value);
  } else if (key == "duration_s") {
    trial.duration_s = number(value);
  } else if (key == "saturated_share") {
    trial.saturated_share = number(value);
  } else if (key == "breach") {
    trial.off_prescription = breaks_limit(value.get_string());
  } else if (key == "presentations") {
    std::size_t place = 0;
    for (auto presentation : value.get_array()) {
      if (place < trial.cues.size()) trial.cues[place] = interval(presentation.value());
      ++place;
    }
  }
  return 0;
}

TrialBodyReader::TrialBodyReader(Unit unit) : impl_(std::make_unique<Impl>()) {
  const std::string suffix(name_suffix(unit));
  impl_->stiffness = "stiffness_" + suffix;
}

TrialBodyReader::~TrialBodyReader() = default;

CountedTrial TrialBodyReader::read(std::string_view body) {
  std::vector<char>& padded = impl_->padded;
  if (padded.size() < body.size() + simdjson::SIMDJSON_PADDING)
    padded.resize(2 * body.size() + simdjson::SIMDJSON_PADDING);
  std::memcpy(padded.data(), body.data(), body.size());
  CountedTrial trial;
  trial.cues.fill({kNaN, kNaN, kNaN, kNaN});
  trial.asked = Intervals({});
  try {
    od::document document =
        impl_->parser.iterate(simdjson::padded_string_view(padded.data(), body.size(), padded.size()));
    unsigned seen = 0;
    for (od::field member : document.get_object()) seen |= impl_->field(raw_key(member), member.value(), trial);
    for (std::size_t i = 0; i < kNeeded.size(); ++i)
      if ((seen >> i & 1U) == 0) throw StorageError(fmt::format("a completed trial has no {}", kNeeded[i]));
  } catch (const simdjson::simdjson_error& error) {
    throw StorageError(fmt::format("a completed trial cannot be read: {}", error.what()));
  }
  return trial;
}

}  // namespace jnd
