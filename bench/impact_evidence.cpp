// Whether the search for an impact tells one from none: simulated tracks of balls that meet no
// surface and of balls that do, with errors as a camera and as a coder of video make them.
//   impact_evidence [EACH [FIRST]]
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "tests/support/tracks/path_tracks.h"

namespace impactdic::bench {
namespace {

void without(int each, int first) {
  for (const testing::FreePath kind : testing::kFreePaths) {
    std::map<std::string, int> found;
    std::string wrong;
    for (int i = first; i < first + each; ++i) {
      const testing::FreeTrack track = testing::free_track(kind, static_cast<std::uint64_t>(i));
      const ImpactAnalysis analysis = impact::analyse_impact(track.rows, track.options);
      ++found[to_string(analysis.status)];
      if (analysis.status != ImpactStatus::kNone) wrong += ' ' + std::to_string(i);
    }
    std::printf("%-8s", testing::name_of(kind));
    for (const auto& [status, count] : found) std::printf("  %s %d", status.c_str(), count);
    std::printf("%s\n", wrong.empty() ? "" : (" :" + wrong).c_str());
  }
}

void with(int each, int first) {
  // By length of the contact, frames.
  constexpr double kLengths[] = {3, 10, 30, 1000};
  double from = 0;
  for (const double to : kLengths) {
    std::map<std::string, int> found;
    std::string missed, off;
    int all = 0, measured = 0, within_two = 0, within_three = 0;
    for (int i = first; i < first + each; ++i) {
      const testing::ImpactTrack track = testing::impact_track(static_cast<std::uint64_t>(i));
      const double length = track.truth.end - track.truth.start;
      if (length < from || length >= to) continue;
      ++all;
      const ImpactAnalysis analysis = impact::analyse_impact(track.rows, track.options);
      ++found[to_string(analysis.status)];
      if (analysis.status != ImpactStatus::kFound &&
          analysis.status != ImpactStatus::kNotResolved) {
        missed += ' ' + std::to_string(i);
        continue;
      }
      const Measured& e = analysis.restitution;
      const double error = std::abs(e.value - track.truth.restitution) / e.sd;
      ++measured;
      within_two += error < 2, within_three += error < 3;
      if (!(error < 3)) off += ' ' + std::to_string(i);
    }
    std::printf("contact %3.0f to %4.0f: %d;", from, to, all);
    for (const auto& [status, count] : found) std::printf("  %s %d", status.c_str(), count);
    std::printf("; e within 2 sd %.1f %%, 3 sd %.1f %%\n", 100.0 * within_two / measured,
                100.0 * within_three / measured);
    if (!missed.empty()) std::printf("  missed:%s\n", missed.c_str());
    if (!off.empty()) std::printf("  off:%s\n", off.c_str());
    from = to;
  }
}

}  // namespace
}  // namespace impactdic::bench

int main(int argc, char** argv) {
  const int each = argc > 1 ? std::atoi(argv[1]) : 400, first = argc > 2 ? std::atoi(argv[2]) : 1;
  impactdic::bench::without(each / 7 + 1, first);
  impactdic::bench::with(each, first);
}
