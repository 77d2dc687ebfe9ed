#include "host/cli/nearest.h"

#include <algorithm>
#include <sstream>
#include <utility>

namespace impactdic::cli {
namespace {

constexpr std::size_t kMostNames = 3;
constexpr std::size_t kShortestPart = 3;  // letters that say something of a name

// Optimal string alignment: edits that lead from one text to the other.
int distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<int>> edits(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) edits[i][0] = static_cast<int>(i);
  for (std::size_t j = 0; j <= b.size(); ++j) edits[0][j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int other = a[i - 1] == b[j - 1] ? 0 : 1;
      int best = std::min({edits[i - 1][j] + 1, edits[i][j - 1] + 1, edits[i - 1][j - 1] + other});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        best = std::min(best, edits[i - 2][j - 2] + 1);
      }
      edits[i][j] = best;
    }
  }
  return edits[a.size()][b.size()];
}

// Every part of `name` between dashes stands in `whole`.
bool has_parts(const std::string& whole, const std::string& name) {
  std::istringstream parts(name);
  std::string part;
  bool any = false;
  while (std::getline(parts, part, '-')) {
    if (part.size() < kShortestPart || whole.find(part) == std::string::npos) return false;
    any = true;
  }
  return any;
}

}  // namespace

std::vector<std::string> nearest(const std::string& name, const std::vector<std::string>& known) {
  std::vector<std::pair<int, std::string>> found;  // wrong letters, name
  for (const std::string& candidate : known) {
    const int wrong = distance(name, candidate);
    const bool near = 3 * wrong <= static_cast<int>(std::max(name.size(), candidate.size()));
    // A name of which only a part is there counts behind one that is misspelt.
    if (near) {
      found.emplace_back(wrong, candidate);
    } else if (has_parts(candidate, name)) {
      found.emplace_back(1000 + wrong, candidate);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (const auto& [wrong, candidate] : found) {
    // Much farther ones were not meant.
    if (wrong > found.front().first + 2 && wrong < 1000) continue;
    if (wrong >= 1000 && found.front().first < 1000) continue;
    if (names.size() < kMostNames) names.push_back(candidate);
  }
  return names;
}

std::string did_you_mean(const std::vector<std::string>& names, const std::string& dashes) {
  if (names.empty()) return "";
  std::string text = "did you mean ";
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
    text += dashes + names[i];
  }
  return text + "?";
}

}  // namespace impactdic::cli
