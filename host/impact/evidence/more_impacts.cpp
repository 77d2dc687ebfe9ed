#include "host/impact/evidence/more_impacts.h"

#include <algorithm>
#include <cstddef>

namespace impactdic::impact {
namespace {

// Two flights of six rows, the rows between them and the contact.
constexpr std::size_t kFewestRows = 18;
constexpr std::size_t kMostImpacts = 100;
// A fall is plain beyond so many deviations; two falls differ beyond so many, and this share.
constexpr double kPlain = 10, kUnlike = 4, kUnlikeShare = 0.3;

// Flights of one clip fall alike: a ball that a hand leads does not.
bool falls_as(const Measured& known, const Measured& fall) {
  if (!(known.value > kPlain * known.sd) || !std::isfinite(fall.value)) return true;
  const double off = std::abs(fall.value - known.value);
  return off <= std::max(kUnlike * std::hypot(fall.sd, known.sd), kUnlikeShare * known.value);
}

// From instants of a part of the track that starts at row `begin` to those of the whole.
void shift(ImpactAnalysis& impact, std::size_t begin) {
  const auto frames = static_cast<double>(begin);
  for (Measured* instant :
       {&impact.start.instant, &impact.turn, &impact.end.instant, &impact.crossing}) {
    instant->value += frames;
  }
  for (FlightMotion* flight : {&impact.before, &impact.after}) {
    flight->first += begin, flight->last += begin;
  }
}

class Bounces {
 public:
  Bounces(const TrackRows& rows, const ImpactOptions& options, const Measured& fall)
      : rows_(rows), options_(options), fall_(fall) {}

  // In rows begin … end - 1.
  void look(std::size_t begin, std::size_t end) {
    if (end < begin + kFewestRows || found_.size() >= kMostImpacts) return;
    ImpactAnalysis impact = impact_on_this_side(rows_.part(begin, end), options_);
    if (!is_found(impact)) return;
    shift(impact, begin);
    const std::size_t last_before = impact.before.last, first_after = impact.after.first;
    look(begin, last_before + 1);
    if (falls_as(fall_, impact.fall)) found_.push_back(std::move(impact));
    look(first_after, end);
  }

  std::vector<ImpactAnalysis> take() { return std::move(found_); }

 private:
  TrackRows rows_;
  const ImpactOptions& options_;
  Measured fall_;  // of the impact that is known, px/frame^2
  std::vector<ImpactAnalysis> found_;
};

}  // namespace

std::vector<ImpactAnalysis> other_impacts(const TrackRows& rows, const ImpactOptions& options,
                                          const ImpactAnalysis& known) {
  if (!is_found(known)) return {};
  Bounces bounces(rows, options, known.fall);
  bounces.look(0, known.before.last + 1);
  bounces.look(known.after.first, rows.size());
  return bounces.take();
}

}  // namespace impactdic::impact
