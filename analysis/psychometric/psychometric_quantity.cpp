#include "analysis/psychometric/psychometric_quantity.h"

#include <cmath>

#include "analysis/psychometric/psychometric_likelihood.h"

namespace jnd {

namespace {

bool logarithmic(const PsychometricData& data) noexcept {
  return data.function == PsychometricFunction::weibull;
}

// u at which F is 0.5 and 0.75, and G' at the first.
struct Anchors {
  double u50, u75, g50;
  explicit Anchors(PsychometricFunction function) noexcept
      : u50(psychometric_shape_quantile(function, 0.5)),
        u75(psychometric_shape_quantile(function, 0.75)),
        g50(psychometric_shape(function, u50).first) {}
};

// The x with c0 + c1 t(x) = u.
QuantityValue level_at(const PsychometricData& data, double u, double c0, double c1) noexcept {
  const double t = (u - c0) / c1;
  if (!logarithmic(data)) return {data.shift + data.scale * t, -data.scale / c1, -data.scale * t / c1};
  const double x = std::exp(data.shift + t);
  return {x, -x / c1, -x * t / c1};
}

QuantityValue second_at(const PsychometricData& data, double c1) noexcept {
  if (data.function == PsychometricFunction::gaussian) return {data.scale / c1, 0, -data.scale / (c1 * c1)};
  return {c1 / data.scale, 0, 1 / data.scale};
}

// exp(shift): the level that t = 0 stands for, of a logarithmic axis.
double unit(const PsychometricData& data) noexcept {
  return logarithmic(data) ? std::exp(data.shift) : data.scale;
}

}  // namespace

QuantityValue quantity_at(PsychometricQuantity quantity, const PsychometricData& data, double c0, double c1) noexcept {
  const Anchors anchor(data.function);
  switch (quantity) {
    case PsychometricQuantity::location:
      return level_at(data, 0, c0, c1);
    case PsychometricQuantity::second:
      return second_at(data, c1);
    case PsychometricQuantity::pse:
      return level_at(data, anchor.u50, c0, c1);
    case PsychometricQuantity::jnd: {
      const double distance = data.scale * (anchor.u75 - anchor.u50) / c1;
      if (!logarithmic(data)) return {distance, 0, -distance / c1};
      const QuantityValue low = level_at(data, anchor.u50, c0, c1), high = level_at(data, anchor.u75, c0, c1);
      return {low.value * std::expm1((anchor.u75 - anchor.u50) / c1), high.by_c0 - low.by_c0, high.by_c1 - low.by_c1};
    }
    case PsychometricQuantity::slope: {
      if (!logarithmic(data)) return {anchor.g50 * c1 / data.scale, 0, anchor.g50 / data.scale};
      const QuantityValue low = level_at(data, anchor.u50, c0, c1);
      const double slope = anchor.g50 * c1 / low.value;
      return {slope, -slope * low.by_c0 / low.value, slope * (1 / c1 - low.by_c1 / low.value)};
    }
    case PsychometricQuantity::lapse:
    case PsychometricQuantity::guess:
      break;
  }
  return {};
}

double to_search_scale(PsychometricQuantity quantity, const PsychometricData& data, double value) noexcept {
  switch (quantity) {
    case PsychometricQuantity::location:
    case PsychometricQuantity::pse:
      return ((logarithmic(data) ? std::log(value) : value) - data.shift) / data.scale;
    case PsychometricQuantity::second:
      if (data.function == PsychometricFunction::gaussian) return std::log(data.scale / value);
      return std::log(value * data.scale);
    case PsychometricQuantity::jnd:
      return std::log(value / unit(data));
    case PsychometricQuantity::slope:
      return std::log(value * unit(data));
    case PsychometricQuantity::lapse:
    case PsychometricQuantity::guess:
      return value;
  }
  return 0;
}

double from_search_scale(PsychometricQuantity quantity, const PsychometricData& data, double z) noexcept {
  switch (quantity) {
    case PsychometricQuantity::location:
    case PsychometricQuantity::pse:
      return logarithmic(data) ? std::exp(data.shift + z) : data.shift + data.scale * z;
    case PsychometricQuantity::second:
      return data.function == PsychometricFunction::gaussian ? data.scale * std::exp(-z) : std::exp(z) / data.scale;
    case PsychometricQuantity::jnd:
      return std::exp(z) * unit(data);
    case PsychometricQuantity::slope:
      return std::exp(z) / unit(data);
    case PsychometricQuantity::lapse:
    case PsychometricQuantity::guess:
      return z;
  }
  return 0;
}

SharedCurve shared_curve(PsychometricQuantity quantity, const PsychometricData& data, double z, double c1) noexcept {
  const Anchors anchor(data.function);
  SharedCurve curve;
  switch (quantity) {
    case PsychometricQuantity::location:
      curve.h = -c1 * z;
      curve.h1 = -z;
      return curve;
    case PsychometricQuantity::pse:
      curve.h = anchor.u50 - c1 * z;
      curve.h1 = -z;
      return curve;
    case PsychometricQuantity::second:
      curve.fixes_c1 = true;
      curve.c1 = std::exp(z);
      return curve;
    case PsychometricQuantity::jnd: {
      const double width = anchor.u75 - anchor.u50;
      if (!logarithmic(data)) {
        curve.fixes_c1 = true;
        curve.c1 = width * std::exp(-z);
        return curve;
      }
      // exp(t75) - exp(t50) = exp(z) with t = (u - c0) / c1 gives c0 = u50 + c1 (ln(exp(w) - 1) - z), w = width / c1.
      const double w = width / c1, rest = -std::expm1(-w);  // 1 - exp(-w)
      const double log_growth = w + std::log(rest);
      curve.h = anchor.u50 + c1 * (log_growth - z);
      curve.h1 = log_growth - z - w / rest;
      curve.h2 = -w * w * std::exp(-w) / (c1 * rest * rest);
      return curve;
    }
    case PsychometricQuantity::slope:
      if (!logarithmic(data)) {
        curve.fixes_c1 = true;
        curve.c1 = std::exp(z) / anchor.g50;
        return curve;
      }
      // g50 c1 / exp(t50) = exp(z) gives c0 = u50 - c1 (ln(g50 c1) - z).
      curve.h = anchor.u50 - c1 * (std::log(anchor.g50 * c1) - z);
      curve.h1 = -(std::log(anchor.g50 * c1) - z) - 1;
      curve.h2 = -1 / c1;
      return curve;
    case PsychometricQuantity::lapse:
    case PsychometricQuantity::guess:
      break;
  }
  return curve;
}

}  // namespace jnd
