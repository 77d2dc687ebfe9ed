#include "host/impact/evidence/more_impacts.h"

#include <algorithm>
#include <cstddef>

namespace impactdic::impact {
namespace {

// Two flights of six rows, the rows between them and the contact.
constexpr std::size_t kFewestRows = 18;
constexpr std::size_t kMostImpacts = 100;

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
  Bounces(const TrackRows& rows, const ImpactOptions& options) : rows_(rows), options_(options) {}

  // In rows begin … end - 1.
  void look(std::size_t begin, std::size_t end) {
    if (end < begin + kFewestRows || found_.size() >= kMostImpacts) return;
    ImpactAnalysis impact = impact_on_this_side(rows_.part(begin, end), options_);
    if (!is_found(impact)) return;
    shift(impact, begin);
    const std::size_t last_before = impact.before.last, first_after = impact.after.first;
    look(begin, last_before + 1);
    found_.push_back(std::move(impact));
    look(first_after, end);
  }

  std::vector<ImpactAnalysis> take() { return std::move(found_); }

 private:
  TrackRows rows_;
  const ImpactOptions& options_;
  std::vector<ImpactAnalysis> found_;
};

}  // namespace

std::vector<ImpactAnalysis> other_impacts(const TrackRows& rows, const ImpactOptions& options,
                                          const ImpactAnalysis& known) {
  if (!is_found(known)) return {};
  Bounces bounces(rows, options);
  bounces.look(0, known.before.last + 1);
  bounces.look(known.after.first, rows.size());
  return bounces.take();
}

}  // namespace impactdic::impact
