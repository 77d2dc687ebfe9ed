#include "host/impact/evidence/contact_guess.h"

#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "host/base/statistics.h"

namespace impactdic::impact {

double noise_of(const std::vector<double>& values) {
  std::vector<double> bends;
  bends.reserve(values.size());
  for (std::size_t i = 0; i + 2 < values.size(); ++i) {
    bends.push_back(std::abs(values[i] - 2 * values[i + 1] + values[i + 2]));
  }
  return kSdOfMad * upper_median(finite(std::move(bends))) / std::sqrt(6.0);
}

namespace {

// A contact ends where the acceleration has fallen to this part of its peak for so many frames.
constexpr double kFaint = 0.03;
constexpr int kFaintFrames = 3;
constexpr std::size_t kLargestBlock = 16;
constexpr std::size_t kFewestBlocks = 12;

double at(const std::vector<double>& v, std::ptrdiff_t i) {
  return i >= 0 && i < static_cast<std::ptrdiff_t>(v.size()) ? v[static_cast<std::size_t>(i)]
                                                             : kNotMeasured;
}

// Median of the steps within `reach`: a single bad frame does not show.
std::vector<double> smoothed(const std::vector<double>& steps, std::ptrdiff_t reach) {
  std::vector<double> result(steps.size(), kNotMeasured);
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(steps.size()); ++i) {
    std::vector<double> near;
    for (std::ptrdiff_t k = i - reach; k <= i + reach; ++k) near.push_back(at(steps, k));
    result[static_cast<std::size_t>(i)] = upper_median(finite(near));
  }
  return result;
}

// Acceleration about the instant between steps i - 1 and i, over `reach` steps on each side.
double acceleration(const std::vector<double>& v, std::ptrdiff_t i, std::ptrdiff_t reach) {
  return (at(v, i + reach - 1) - at(v, i - reach)) / static_cast<double>(2 * reach - 1);
}

ContactGuess guess_in(const std::vector<double>& steps, double gravity_n) {
  ContactGuess guess;
  const std::vector<double> v = smoothed(steps, 2);
  guess.step_noise = noise_of(steps);
  const auto count = static_cast<std::ptrdiff_t>(v.size());
  // The sharpest turn from towards the surface to away from it.
  std::ptrdiff_t turn = -1;
  double sharpest = 0;
  for (std::ptrdiff_t i = 1; i < count; ++i) {
    if (!(at(v, i - 1) < 0) || !(at(v, i) >= 0)) continue;
    const double rise = acceleration(v, i, 3);
    if (rise > sharpest) sharpest = rise, turn = i;
  }
  if (turn < 0) return guess;
  guess.turn = static_cast<double>(turn);
  guess.peak_acceleration = sharpest - gravity_n;
  const double quiet =
      std::max(kFaint * guess.peak_acceleration, 2 * guess.step_noise / std::sqrt(5.0));
  if (guess.peak_acceleration < 2 * quiet) return guess;
  const auto edge = [&](std::ptrdiff_t direction) {
    int faint = 0;
    std::ptrdiff_t i = turn;
    for (; i > 0 && i < count && faint < kFaintFrames; i += direction) {
      faint = acceleration(v, i, 3) - gravity_n < quiet ? faint + 1 : 0;
    }
    return std::clamp<std::ptrdiff_t>(i - direction * faint, 0, count - 1);
  };
  guess.first = static_cast<std::size_t>(edge(-1));
  guess.last = static_cast<std::size_t>(edge(1));
  guess.found = true;
  guess.faint = quiet / guess.peak_acceleration;
  return guess;
}

// Steps of `block` frames: sums of those that were measured, or between means of centres.
std::vector<double> coarse_steps(const ImpactSeries& series, std::size_t block) {
  const std::vector<double>& fine = series.from_circle ? series.position_n : series.step_n;
  std::vector<double> means;
  for (std::size_t first = 0; first + block <= fine.size(); first += block) {
    double sum = 0, count = 0;
    for (std::size_t i = first; i < first + block; ++i) {
      if (std::isfinite(fine[i])) sum += fine[i], ++count;
    }
    means.push_back(sum / count);
  }
  if (!series.from_circle) {
    for (double& mean : means) mean *= static_cast<double>(block);
    return means;
  }
  for (std::size_t i = 0; i + 1 < means.size(); ++i) means[i] = means[i + 1] - means[i];
  if (!means.empty()) means.back() = kNotMeasured;
  return means;
}

// A coarse guess in frames of the track.
ContactGuess refined(ContactGuess guess, const ImpactSeries& series, std::size_t block) {
  const auto frames = static_cast<double>(block);
  const double shift = series.from_circle ? (frames - 1) / 2 : 0;
  guess.turn = guess.turn * frames + shift;
  guess.peak_acceleration /= frames * frames;
  guess.step_noise = noise_of(series.step_n);
  // The surface acts for longer than its force stands out of the noise: as long as a half sine.
  const double first = static_cast<double>(guess.first) * frames + shift;
  const double last = static_cast<double>(guess.last) * frames + shift;
  const double hidden = 2 * std::asin(guess.faint) / kPi;
  const double more = (last - first) * hidden / (1 - hidden) / 2;
  const auto end = static_cast<double>(series.size() - 1);
  guess.first = static_cast<std::size_t>(std::clamp(first - more, 0.0, end));
  guess.last = static_cast<std::size_t>(std::clamp(last + more, 0.0, end));
  return guess;
}

}  // namespace

ContactGuess guess_contact(const ImpactSeries& series, double gravity_n) {
  const ContactGuess fine = guess_in(series.step_n, gravity_n);
  if (fine.found) return series.from_circle ? refined(fine, series, 1) : fine;
  for (std::size_t block = 2; block <= kLargestBlock && series.size() >= kFewestBlocks * block;
       block *= 2) {
    const auto frames = static_cast<double>(block);
    const ContactGuess guess = guess_in(coarse_steps(series, block), gravity_n * frames * frames);
    if (guess.found) return refined(guess, series, block);
  }
  return fine;
}

std::size_t guard_of(const ContactGuess& guess, std::size_t last_row) {
  std::size_t guard = std::max(kLeastGuard, (guess.last - guess.first) * 3 / 20);
  // In a short clip rather a shorter guard than no flight.
  while (guard > 2 && (guess.first < guard + 2 * kFewestFlightFrames ||
                       guess.last + guard + 2 * kFewestFlightFrames > last_row)) {
    --guard;
  }
  return guard;
}

FlightRange trimmed(const ImpactSeries& series, const ContactGuess& guess, FlightRange flight,
                    bool before, double gravity_n) {
  constexpr std::size_t kBlock = 10;
  const auto level = [&](std::size_t first) {  // of the block that starts so far from the contact
    std::vector<double> steps;
    for (std::size_t k = first; k < first + kBlock; ++k) {
      const std::size_t i = before ? flight.last - 1 - k : flight.first + k;
      steps.push_back(series.step_n[i] - gravity_n * (static_cast<double>(i) - flight.at));
    }
    return upper_median(finite(steps));
  };
  const std::size_t count = flight.last - flight.first;
  for (std::size_t first = kBlock; first + kBlock <= count; first += kBlock) {
    const double near = level(first - kBlock), far = level(first);
    if (std::isnan(far) || std::abs(far - near) <= 8 * guess.step_noise + 0.05 * std::abs(near)) {
      continue;
    }
    (before ? flight.first : flight.last) = before ? flight.last - first : flight.first + first;
    break;
  }
  return flight;
}

}  // namespace impactdic::impact
